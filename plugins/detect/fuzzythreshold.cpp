// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-fuzzythreshold
 *
 * Chooses the threshold of the registered differences by the indices of fuzziness, binarises both with it and attaches
 * the moving area as the plane `mask` (0 or 255) and a #CerberusThreshold. The frame goes through untouched. Stages
 * that are missing upstream are done here with their defaults. The mask is empty, and the threshold not `ready`, until
 * three frames of the scene were seen; and for two when `area` is changed from `all` while frames flow, as what the
 * other areas need of the third frame is not kept for `all`.
 *
 * What the camera writes into its own pictures is learnt and left out (`burnt-in`). An info message with the boxes in
 * frame pixels says what was found.
 *
 * ## Example
 * |[
 * gst-launch-1.0 videotestsrc num-buffers=60 pattern=ball ! threeframediff ! fuzzythreshold area=leading ! fakesink
 * ]|
 *
 * Since: 0.1
 */
// Paper Eq. 3 (d = 1 where the difference is above Th), M(k-1) = D(k) and D(k-1), M(k) = D(k) - M(k-1); Eq. 4 to 10 for
// Th, in the reading of Tobias and Seara (IEEE Trans. Image Processing 11(12), 2002), from where the paper has them:
// Eq. 8 and 9 both print the factor 2 / n^(1/k), which belongs once, and Eq. 8 needs the absolute value. See
// lib/vision/change/fuzzy_threshold.h and background/foreground_mask.h. Deviations of the defaults, each a property: Th is held near the
// measured noise (`noise-floor`), lone bright pixels do not count (`clip`), and a
// registered memory of the scene completes what two neighbouring frames cannot
// see (`memory`, of D(k) alone: M(k) and M(k-1) are sets of the two differences).

#include <cmath>
#include <cstdio>
#include <span>
#include <string>

#include "analysis_element.hpp"
#include "cerberus/private/messages.hpp"
#include "elements.hpp"
#include "shared/enums.hpp"
#include "shared/stages.hpp"

GST_DEBUG_CATEGORY_STATIC(fuzzythreshold_debug);
#define GST_CAT_DEFAULT fuzzythreshold_debug

namespace cerberus::plugin {
namespace {

struct Settings {
  int weighting = static_cast<int>(vision::FuzzyThresholdOptions{}.weighting);
  int extremes = static_cast<int>(vision::FuzzyThresholdOptions{}.extremes);
  int order = vision::FuzzyThresholdOptions{}.order;
  bool clip = vision::FuzzyThresholdOptions{}.clip;
  int area = static_cast<int>(vision::ForegroundMaskOptions{}.area);
  bool noise_floor = vision::ForegroundMaskOptions{}.noise_floor;
  bool memory = vision::ForegroundMaskOptions{}.background_model;
  bool burnt_in = true;
};

const Property<Settings> kProperties[] = {
    property(
        "weighting", &Settings::weighting, weighting_type,
        "How the histogram's counts weigh: log lets a small object count beside a large background; with "
        "noise-floor it chooses within the range that the noise leaves"),
    property("extremes", &Settings::extremes, extremes_type,
             "Between which levels the membership function of a fuzzy subset runs; with noise-floor it "
             "chooses within the range that the noise leaves"),
    property(
        "order", &Settings::order, 1, 16,
        "Order k of the index of fuzziness (Eq. 8 and 9): 1 is linear, 2 quadratic, higher ones follow "
        "the largest distances alone; with noise-floor it chooses within the range that the noise leaves"),
    property("clip", &Settings::clip,
             "Let the few brightest levels of the histogram not count (weighting=log only); with noise-floor "
             "it chooses within the range that the noise leaves"),
    property("area", &Settings::area, area_type,
             "Which moving area goes out: all that moves, or what an object newly covers (leading), or what "
             "it covered in the frame before too (common); these two are sets of the differences alone, and "
             "the memory is not used"),
    property(
        "noise-floor", &Settings::noise_floor,
        "Hold the threshold between one and one and a half times the floor that the measured noise sets"),
    property("memory", &Settings::memory,
             "Use a memory of the scene, moved along with the camera, where it knows better than two "
             "neighbouring frames; with area=all only"),
    property(
        "burnt-in", &Settings::burnt_in,
        "Leave out what the camera writes into its own pictures (clock, name, logo), learnt within seconds "
        "from what keeps its place while the scene moves and from what changes in place"),
};

vision::ForegroundMaskOptions options(const Settings& s) {
  vision::ForegroundMaskOptions options;
  options.threshold.weighting = static_cast<vision::Weighting>(s.weighting);
  options.threshold.extremes = static_cast<vision::Extremes>(s.extremes);
  options.threshold.order = s.order;
  options.threshold.clip = s.clip;
  options.area = static_cast<vision::Area>(s.area);
  options.noise_floor = s.noise_floor;
  options.background_model = s.memory;
  return options;
}

bool spares_previous(const Settings& s) {
  return options(s).area == vision::Area::all;
}

struct Private final : StatefulAnalyser<Settings, MaskStage> {
  Answer<bool> answer;

  void tell_burnt_in(std::span<const vision::Box> boxes);

  bool spares_previous() override { return answer.give(plugin::spares_previous(settings.snapshot())); }
  Planes planes() override { return spares_previous() ? Planes::as_asked : Planes::wanted; }
  bool analyse(Frame& frame) override {
    if (const auto changed = settings.changes()) {
      state->set_options(options(*changed));
      state->learn_burnt_in(changed->burnt_in);
      if (answer.outdated_by(plugin::spares_previous(*changed))) cerberus_analysis_answer_anew(base);
    }
    state->luma().set_analysis_width(cerberus_analysis_width(base));
    const bool ran = state->run(frame);
    tell_burnt_in(state->burnt_in_news());
    return ran;
  }
};

void Private::tell_burnt_in(std::span<const vision::Box> boxes) {
  if (boxes.empty()) return;
  std::string text;
  for (const vision::Box& b : boxes) {
    char box[80];
    std::snprintf(box, sizeof box, "%s%ldx%ld+%ld+%ld", text.empty() ? "" : ", ", std::lround(b.width),
                  std::lround(b.height), std::lround(b.x), std::lround(b.y));
    text += box;
  }
  CERBERUS_ELEMENT_INFO(
      base, STREAM, DECODE,
      ("The camera writes into its pictures; left out: %s (frame pixels, width x height + left + top).",
       text.c_str()),
      ("burnt-in=false turns this off"));
}

constexpr AnalysisInfo kInfo{"CerberusFuzzyThreshold", "Fuzzy threshold",
                             "Moving area by a threshold that the indices of fuzziness choose"};

}  // namespace

GType fuzzythreshold_get_type() {
  return analysis_type<Private, kProperties, kInfo>();
}

}  // namespace cerberus::plugin

CERBERUS_REGISTER_ELEMENT(fuzzythreshold, GST_RANK_NONE, cerberus::plugin::fuzzythreshold,
                          fuzzythreshold_debug, "threshold and moving area")
