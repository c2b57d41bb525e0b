// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-motiondetect
 *
 * Finds moving people (or vehicles) in video from a camera that may turn itself: `cameramotion`, `threeframediff`,
 * `fuzzythreshold`, `motionregions` and `motiontrack` in one element, with their properties and presets. The frame goes
 * through untouched and is never copied; what was found rides on it as metadata (see those elements), and
 * `cerberus-motion` messages tell when motion started and ended.
 *
 * Every property that the application sets wins over `preset`, whichever was set first. Settings with which nothing can
 * ever be found are warned of by the stage that they are for.
 *
 * Timestamps may be missing: the frames are taken as evenly spaced then. Timestamps may step back a little: such a
 * frame is taken to follow the one before it at the usual distance, and the third of them brings a warning, once a
 * stream. A step by more than three times that distance, and more than a quarter of a second, begins a new scene,
 * whether it is backwards or forwards. A buffer without its picture is passed on with the flag CORRUPTED and one
 * warning, and ends no scene unless more than five come in a row.
 *
 * Pads: one sink, one src, raw progressive video in system memory, 32x32 to 8192x8192.
 *
 * ## Example
 * |[
 * gst-launch-1.0 videotestsrc num-buffers=60 pattern=ball ! motiondetect ! fakesink
 * ]|
 * |[
 * gst-launch-1.0 -m videotestsrc num-buffers=60 pattern=ball ! motiondetect preset=paper area=all ! fakesink
 * ]|
 *
 * Since: 0.1
 */
// The bin adds nothing to the five: it gives what the chain gives, byte for byte.
#include <gst/gst.h>

#include <cerberus/caps.h>

#include <array>
#include <bitset>
#include <iterator>
#include <mutex>

#include "cerberus/private/element.hpp"
#include "elements.hpp"
#include "shared/enums.hpp"
#include "shared/single_fields.hpp"

GST_DEBUG_CATEGORY_STATIC(motiondetect_debug);
#define GST_CAT_DEFAULT motiondetect_debug

namespace cerberus::plugin {
namespace {

enum Stage { CAMERA, DIFFERENCE, THRESHOLD, REGIONS, TRACK, STAGES };

constexpr const char* kStageNames[STAGES] = {"cameramotion", "threeframediff", "fuzzythreshold",
                                             "motionregions", "motiontrack"};

GType stage_type(Stage stage) {
  static constexpr GType (*types[STAGES])() = {cameramotion_get_type, threeframediff_get_type,
                                               fuzzythreshold_get_type, motionregions_get_type,
                                               motiontrack_get_type};
  return types[stage]();
}

// The properties taken over: name and blurb, range and default are the stage's.
struct Taken {
  const char* name;
  Stage stage;
  Stage also = STAGES;  // a second stage that must agree
  Stage too = STAGES;   // and one more
};

constexpr Taken kTaken[] = {
    {"analysis-width", CAMERA},
    {"model", CAMERA},
    {"blur", DIFFERENCE},
    {"compensate-light", DIFFERENCE},
    {"weighting", THRESHOLD},
    {"extremes", THRESHOLD},
    {"order", THRESHOLD},
    {"clip", THRESHOLD},
    {"area", THRESHOLD},
    {"noise-floor", THRESHOLD},
    {"memory", THRESHOLD},
    {"burnt-in", THRESHOLD},
    {"closing", REGIONS},
    {"people", REGIONS},
    {"minimum-area", REGIONS},
    {"zones", REGIONS},
    {"minimum-width", REGIONS},
    {"maximum-width", REGIONS},
    {"minimum-height", REGIONS},
    {"maximum-height", REGIONS},
    {"minimum-width-metres", REGIONS},
    {"maximum-width-metres", REGIONS},
    {"minimum-height-metres", REGIONS},
    {"maximum-height-metres", REGIONS},
    {"keep-planes", REGIONS},
    {"head", CAMERA},
    {"horizontal-fov", REGIONS, TRACK, CAMERA},
    {"mounting-height", REGIONS, TRACK},
    {"tilt", REGIONS, TRACK},
    {"confirm-time", TRACK},
    {"coast-time", TRACK},
    {"away-time", TRACK},
    {"hold-stopped", TRACK},
    {"hold-time", TRACK},
    {"minimum-speed", TRACK},
    {"maximum-speed", TRACK},
    {"minimum-speed-metres", TRACK},
    {"maximum-speed-metres", TRACK},
};
constexpr guint kPropPreset = std::size(kTaken) + 1;

// All presets: what differs from the stages' defaults.
struct PresetValue {
  Preset preset;
  const char* property;
  const char* value;
};

constexpr PresetValue kPresets[] = {
    // The literal method: Eq. 1 to 10 as printed, the moving area M(k), nothing learnt, nothing held near the noise.
    {PRESET_PAPER, "blur", "false"},
    {PRESET_PAPER, "compensate-light", "false"},
    {PRESET_PAPER, "weighting", "linear"},
    {PRESET_PAPER, "extremes", "subset"},
    {PRESET_PAPER, "order", "1"},
    {PRESET_PAPER, "clip", "false"},
    {PRESET_PAPER, "area", "leading"},
    {PRESET_PAPER, "noise-floor", "false"},
    {PRESET_PAPER, "memory", "false"},
    {PRESET_PAPER, "burnt-in", "false"},
    {PRESET_PAPER, "people", "false"},
    // Vehicles are no people: no learnt height, no human gate.
    {PRESET_TRAFFIC, "people", "false"},
    {PRESET_TRAFFIC, "minimum-width-metres", "0"},
    {PRESET_TRAFFIC, "maximum-width-metres", "0"},
    {PRESET_TRAFFIC, "minimum-height-metres", "0"},
    {PRESET_TRAFFIC, "maximum-height-metres", "0"},
    {PRESET_TRAFFIC, "minimum-speed-metres", "0"},
    {PRESET_TRAFFIC, "maximum-speed-metres", "0"},
};

struct Private {
  // Held while a property or a preset is on its way to the stages (see Setting), so that no preset overwrites what
  // another thread chose meanwhile. Taken before `lock`.
  std::mutex setting;
  std::mutex lock;  // of `preset` and `chosen`
  int preset = PRESET_DEFAULT;
  std::bitset<std::size(kTaken)> chosen;     // properties that the application set itself
  std::array<GstElement*, STAGES> stages{};  // owned by the bin
};

CERBERUS_DEFINE_TYPE(CerberusMotionDetect, cerberus_motion_detect, GstBin, GST_TYPE_BIN, Private)

// Alone with the stages' properties. The stages notify when it is over: whoever is notified may set properties too, in
// whichever thread.
class Setting {
 public:
  explicit Setting(Private& priv) : priv_(priv) {
    for (GstElement* stage : priv_.stages) g_object_freeze_notify(G_OBJECT(stage));
    priv_.setting.lock();
  }
  ~Setting() {
    priv_.setting.unlock();
    for (GstElement* stage : priv_.stages) g_object_thaw_notify(G_OBJECT(stage));
  }
  Setting(const Setting&) = delete;
  Setting& operator=(const Setting&) = delete;

 private:
  Private& priv_;
};

void forward(const Private& priv, const Taken& taken, const GValue* value) {
  g_object_set_property(G_OBJECT(priv.stages[taken.stage]), taken.name, value);
  for (const Stage also : {taken.also, taken.too})
    if (also != STAGES) g_object_set_property(G_OBJECT(priv.stages[also]), taken.name, value);
}

// Sets everything that the application left alone to what the preset says, or to the stage's default.
void apply_preset(const Private& priv, Preset preset, const std::bitset<std::size(kTaken)>& chosen) {
  for (guint i = 0; i < std::size(kTaken); ++i) {
    if (chosen[i]) continue;
    GObject* stage = G_OBJECT(priv.stages[kTaken[i].stage]);
    GParamSpec* spec = g_object_class_find_property(G_OBJECT_GET_CLASS(stage), kTaken[i].name);
    GValue value = G_VALUE_INIT;
    g_value_init(&value, G_PARAM_SPEC_VALUE_TYPE(spec));
    g_param_value_set_default(spec, &value);
    for (const PresetValue& entry : kPresets)
      if (entry.preset == preset && g_str_equal(entry.property, kTaken[i].name))
        gst_value_deserialize(&value, entry.value);
    forward(priv, kTaken[i], &value);
    g_value_unset(&value);
  }
}

// The same property for another class.
GParamSpec* copy_of(GParamSpec* spec) {
  const char* name = g_param_spec_get_name(spec);
  const char* nick = g_param_spec_get_nick(spec);
  const char* blurb = g_param_spec_get_blurb(spec);
  const GParamFlags flags = spec->flags;
  if (auto* s = G_IS_PARAM_SPEC_BOOLEAN(spec) ? G_PARAM_SPEC_BOOLEAN(spec) : nullptr)
    return g_param_spec_boolean(name, nick, blurb, s->default_value, flags);
  if (auto* s = G_IS_PARAM_SPEC_INT(spec) ? G_PARAM_SPEC_INT(spec) : nullptr)
    return g_param_spec_int(name, nick, blurb, s->minimum, s->maximum, s->default_value, flags);
  if (auto* s = G_IS_PARAM_SPEC_UINT64(spec) ? G_PARAM_SPEC_UINT64(spec) : nullptr)
    return g_param_spec_uint64(name, nick, blurb, s->minimum, s->maximum, s->default_value, flags);
  if (auto* s = G_IS_PARAM_SPEC_DOUBLE(spec) ? G_PARAM_SPEC_DOUBLE(spec) : nullptr)
    return g_param_spec_double(name, nick, blurb, s->minimum, s->maximum, s->default_value, flags);
  if (auto* s = G_IS_PARAM_SPEC_ENUM(spec) ? G_PARAM_SPEC_ENUM(spec) : nullptr)
    return g_param_spec_enum(name, nick, blurb, G_PARAM_SPEC_VALUE_TYPE(spec), s->default_value, flags);
  if (auto* s = G_IS_PARAM_SPEC_STRING(spec) ? G_PARAM_SPEC_STRING(spec) : nullptr)
    return g_param_spec_string(name, nick, blurb, s->default_value, flags);
  g_assert_not_reached();
}

void set_property(GObject* object, guint id, const GValue* value, GParamSpec*) {
  Private& priv = *cerberus_motion_detect_self(object)->priv;
  const Setting alone(priv);
  std::unique_lock guard(priv.lock);
  if (id == kPropPreset) {
    priv.preset = g_value_get_enum(value);
    const auto preset = static_cast<Preset>(priv.preset);
    const auto chosen = priv.chosen;
    guard.unlock();
    apply_preset(priv, preset, chosen);
    return;
  }
  priv.chosen.set(id - 1);
  guard.unlock();
  forward(priv, kTaken[id - 1], value);
}

void get_property(GObject* object, guint id, GValue* value, GParamSpec*) {
  Private& priv = *cerberus_motion_detect_self(object)->priv;
  if (id == kPropPreset) {
    const std::lock_guard guard(priv.lock);
    g_value_set_enum(value, priv.preset);
    return;
  }
  const Taken& taken = kTaken[id - 1];
  g_object_get_property(G_OBJECT(priv.stages[taken.stage]), taken.name, value);
}

void add_ghost_pad(CerberusMotionDetect* self, GstElement* stage, const char* name) {
  GstPad* target = gst_element_get_static_pad(stage, name);
  GstPadTemplate* pad_template = gst_element_class_get_pad_template(GST_ELEMENT_GET_CLASS(self), name);
  GstPad* pad = gst_ghost_pad_new_from_template(name, target, pad_template);
  GST_PAD_SET_ACCEPT_INTERSECT(pad);  // as the stages: it is they who say what is wrong with caps
  gst_element_add_pad(GST_ELEMENT(self), pad);
  gst_object_unref(target);
}

void cerberus_motion_detect_init(CerberusMotionDetect* self) {
  auto& stages = self->priv->stages;
  for (int i = 0; i < STAGES; ++i) {
    // By the factory where it is registered (it is, except in a program that links single elements).
    stages[i] = gst_element_factory_make(kStageNames[i], kStageNames[i]);
    if (!stages[i])
      stages[i] =
          GST_ELEMENT(g_object_new(stage_type(static_cast<Stage>(i)), "name", kStageNames[i], nullptr));
    gst_bin_add(GST_BIN(self), stages[i]);
    if (i > 0) gst_element_link(stages[i - 1], stages[i]);
  }
  add_ghost_pad(self, stages[CAMERA], "sink");
  add_ghost_pad(self, stages[TRACK], "src");
}

void cerberus_motion_detect_class_init(CerberusMotionDetectClass* klass) {
  GObjectClass* object = G_OBJECT_CLASS(klass);
  object->set_property = set_property;
  object->get_property = get_property;
  for (guint i = 0; i < std::size(kTaken); ++i) {
    auto* stage = static_cast<GObjectClass*>(g_type_class_ref(stage_type(kTaken[i].stage)));
    g_object_class_install_property(object, i + 1,
                                    copy_of(g_object_class_find_property(stage, kTaken[i].name)));
    g_type_class_unref(stage);
  }
  g_object_class_install_property(
      object, kPropPreset,
      g_param_spec_enum(
          "preset", nullptr,
          "What the properties that are not set one by one are set to: people (default), the literal method "
          "(paper) or vehicles (traffic)",
          preset_type(), PRESET_DEFAULT,
          static_cast<GParamFlags>(G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS | GST_PARAM_MUTABLE_PLAYING)));

  static GstStaticPadTemplate sink = GST_STATIC_PAD_TEMPLATE(
      "sink", GST_PAD_SINK, GST_PAD_ALWAYS, GST_STATIC_CAPS(ANALYSED_VIDEO_AND_SINGLE_FIELDS_CAPS));
  static GstStaticPadTemplate src =
      GST_STATIC_PAD_TEMPLATE("src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(ANALYSED_VIDEO_CAPS));
  GstElementClass* element = GST_ELEMENT_CLASS(klass);
  gst_element_class_add_static_pad_template(element, &sink);
  gst_element_class_add_static_pad_template(element, &src);
  gst_element_class_set_static_metadata(
      element, "Motion detector", "Filter/Analyzer/Video",
      "Finds moving people or vehicles in video from a camera that may turn itself",
      "The Cerberus developers");
}

}  // namespace
}  // namespace cerberus::plugin

CERBERUS_REGISTER_ELEMENT(motiondetect, GST_RANK_NONE, cerberus::plugin::cerberus_motion_detect,
                          motiondetect_debug, "the motion detector")
