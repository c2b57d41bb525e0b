// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-motiondetect
 *
 * Finds moving people (or vehicles) in video from a camera that may turn itself: `cameramotion`, `threeframediff`,
 * `fuzzythreshold`, `motionregions` and `motiontrack` in one element, with their properties and presets. The frame goes
 * through untouched and is never copied; what was found rides on it as metadata (see those elements);
 * `cerberus-motion` messages say when motion started and ended, `cerberus-track` messages what each track did.
 *
 * A camera that is carried, shakes or drives past near things sees motion everywhere. There only what clearly moves by itself
 * is published, people who stand or move little are missed, and an info message says so, once a stream: put
 * `personverify` in front or behind, which knows people by their shape, or another person detector in front. See `motiontrack`.
 *
 * Every property that the application sets wins over `preset`, whichever was set first. Settings with which nothing can
 * ever be found are warned of by the stage that they are for.
 *
 * `preset=paper` is the paper's method: three frames, the threshold by fuzziness alone, the moving area M(k), no memory of
 * the scene. Where the paper leaves a choice it takes the one that finds people: counts weigh by their logarithm, and what
 * belongs to a person is joined. With `weighting=linear people=false closing=9` it is taken literally, and finds hardly anybody.
 *
 * Timestamps may be missing: the frames are taken as evenly spaced then. Timestamps may step back a little: such a
 * frame is taken to follow the one before it at the usual distance, and the third of them brings a warning, once a
 * stream. A step by more than three times that distance, and more than a quarter of a second, begins a new scene,
 * whether it is backwards or forwards. By more than 10 s forwards or one backwards, without the flag DISCONT, it is taken
 * for a wrong timestamp: one or two such frames in a row follow at the usual distance, the third begins a new scene.
 * Once a smaller step has proved to be a wrong timestamp, later ones are judged in the same way. A buffer without its
 * picture is passed on with the flag CORRUPTED and one warning, and ends no scene unless more than five come in a row.
 *
 * A buffer with the flag GAP repeats the last picture, as duplicates of `videorate` do, and carries its result on: see
 * `motiontrack`. Elements in between may take the flag off (`videoscale` of GStreamer 1.22): a frame whose analysed
 * picture (of `analysis-width`) equals the last one in every pixel, where that one differed from its predecessor, gets
 * the flag, for at most half a second. Where
 * nothing differs for longer, or from the start, the scene is still and is analysed.
 *
 * Formats of 10 to 16 bits whose pictures use less than a quarter of their range, as those of thermal cameras (GRAY16) do,
 * are stretched for the analysis: what occurs fills two thirds of 8 bits, 1/64 of the range at the least. The stretch stays
 * while it fits, and follows slowly.
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
// One vision::Detector does what the five stage elements do one after another, and gives what their chain gives, byte
// for byte.
#include <bitset>
#include <mutex>
#include <variant>

#include "detection.hpp"

GST_DEBUG_CATEGORY_STATIC(motiondetect_debug);
#define GST_CAT_DEFAULT motiondetect_debug

namespace cerberus::plugin {
namespace {

// Side of the closing that joins the edges of a person in M(k), pixels.
constexpr int kPaperClosing = 15;

DetectSettings settings_of(int preset) {
  DetectSettings s;
  switch (preset) {
    case PRESET_PAPER:
      // Eq. 1 to 10 and the moving area M(k); no background model, no noise floor. Counts as they are (linear) put Th at 1 to
      // 3 grey levels, and nobody is found. The "post treatment", which the paper leaves open, makes one region of a person's
      // leading edges. Swept: closing 9 to 21 with and without `people`, order 1 to 3; guard: bench-paper.
      s.blur = s.compensate_light = s.clip = s.noise_floor = s.memory = s.burnt_in = false;
      s.weighting = static_cast<int>(vision::Weighting::log);
      s.closing = kPaperClosing;
      s.extremes = static_cast<int>(vision::Extremes::subset);
      s.order = 1;
      s.area = static_cast<int>(vision::Area::leading);
      break;
    case PRESET_TRAFFIC:
      // Vehicles: no learnt height of a person, no limits of human size and speed.
      s.people = false;
      s.minimum_width_metres = s.maximum_width_metres = s.minimum_height_metres = s.maximum_height_metres = 0;
      s.minimum_speed_metres = s.maximum_speed_metres = 0;
      break;
    default:
      break;
  }
  return s;
}

// A property that the application has set wins over the preset, whichever was set first.
class PresetSettings : public Adjustable<DetectSettings> {
 public:
  void set(Table table, guint id, const GValue* value) {
    const std::lock_guard guard(lock_);
    Adjustable::set(table, id, value);
    if (table[id - 1].choices != preset_type) {
      chosen_.set(id);
      return;
    }
    adjust([&](DetectSettings& settings) {
      const DetectSettings preset = settings_of(settings.preset);
      for (guint other = 1; other < id; ++other)  // the preset is the last of the table
        if (!chosen_[other])
          std::visit([&](auto member) { settings.*member = preset.*member; }, table[other - 1].member);
    });
  }

 private:
  std::mutex lock_;
  std::bitset<kDetectProperties.size() + 1> chosen_;  // by the application
};

constexpr AnalysisInfo kInfo{"CerberusMotionDetect", "Motion detector",
                             "Finds moving people or vehicles in video from a camera that may turn itself"};

}  // namespace

GType motiondetect_get_type() {
  return analysis_type<StageElement<vision::Stage::camera, vision::Stage::tracks, PresetSettings>,
                       kDetectProperties, kInfo>();
}

}  // namespace cerberus::plugin

CERBERUS_REGISTER_ELEMENT(motiondetect, GST_RANK_NONE, cerberus::plugin::motiondetect, motiondetect_debug,
                          "the motion detector")
