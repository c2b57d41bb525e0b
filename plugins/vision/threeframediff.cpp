// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-threeframediff
 *
 * Attaches what changed between three consecutive frames once the camera's own motion is taken out: the planes
 * `difference` and `previous-difference` and the histogram of the first. The frame goes through untouched.
 * Without `cameramotion` upstream the camera stands still and the luma plane is made here. Both differences are zero
 * until three frames of the scene were seen.
 *
 * ## Example
 * |[
 * gst-launch-1.0 videotestsrc num-buffers=60 pattern=ball ! threeframediff ! fuzzythreshold ! fakesink
 * ]|
 *
 * Since: 0.1
 */
// Paper Eq. 1 and 2: D(k) = |F(k) - F(k-1)|, D(k-1) = |F(k-1) - F(k-2)|. The printed elements of Eq. 2 are one index
// late; Eq. 3 has it right. Deviations: both differences stand in frame k's coordinates (F(k-1) and F(k-2) are warped
// there, never an old difference), a 3x3 blur goes before (`blur`), a change of light of the whole picture is taken out
// (`compensate-light`), and what is not visible in all three frames does not move. See
// lib/vision/three_frame_difference.h.
#include <optional>

#include "analysis_base.hpp"
#include "elements.hpp"
#include "properties.hpp"
#include "stages.hpp"

GST_DEBUG_CATEGORY_STATIC(threeframediff_debug);
#define GST_CAT_DEFAULT threeframediff_debug

namespace cerberus::plugin {
namespace {

struct Settings {
  bool blur = vision::DifferenceOptions{}.blur > 1;
  bool compensate_light = vision::DifferenceOptions{}.compensate_light;
};

const Property<Settings> kProperties[] = {
    property("blur", &Settings::blur,
             "Average 3 x 3 pixels before the difference is taken: quieter, and blind to single pixels"),
    property(
        "compensate-light", &Settings::compensate_light,
        "Take a change of brightness and contrast of the whole picture out before the difference is taken"),
};

struct Private final : Analyser {
  CerberusAnalysis* base = nullptr;
  Adjustable<Settings> settings;
  std::optional<DifferenceStage> stage;

  bool start() override {
    stage.emplace();
    settings.refresh();
    return true;
  }
  void stop() override { stage.reset(); }
  bool analyse(Frame& frame) override {
    if (const auto s = settings.changes()) stage->set_options({s->blur ? 3 : 1, s->compensate_light});
    stage->luma().set_analysis_width(cerberus_analysis_width(base));
    return stage->run(frame);
  }
};

CERBERUS_DEFINE_TYPE(CerberusThreeFrameDiff, cerberus_three_frame_diff, CerberusAnalysis,
                     cerberus_analysis_get_type(), Private)

void set_property(GObject* object, guint id, const GValue* value, GParamSpec*) {
  cerberus_three_frame_diff_self(object)->priv->settings.set(kProperties, id, value);
}

void get_property(GObject* object, guint id, GValue* value, GParamSpec*) {
  cerberus_three_frame_diff_self(object)->priv->settings.get(kProperties, id, value);
}

void cerberus_three_frame_diff_init(CerberusThreeFrameDiff* self) {
  self->priv->base = &self->parent;
  cerberus_analysis_init_with(&self->parent, self->priv);
}

void cerberus_three_frame_diff_class_init(CerberusThreeFrameDiffClass* klass) {
  GObjectClass* object = G_OBJECT_CLASS(klass);
  object->set_property = set_property;
  object->get_property = get_property;
  Adjustable<Settings>::install(object, kProperties);
  gst_element_class_set_static_metadata(
      GST_ELEMENT_CLASS(klass), "Three-frame difference", "Filter/Analyzer/Video",
      "Differences of three consecutive frames with the camera's motion taken out",
      "The Cerberus developers");
}

}  // namespace

GType threeframediff_type() {
  return cerberus_three_frame_diff_get_type();
}

}  // namespace cerberus::plugin

CERBERUS_REGISTER_ELEMENT(threeframediff, GST_RANK_NONE, cerberus::plugin::cerberus_three_frame_diff,
                          threeframediff_debug, "registered differences of three frames")
