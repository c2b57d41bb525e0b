// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-motionregions
 *
 * Turns the moving area into regions of interest: cleans the mask, labels it, joins one person's fragments, parts two
 * people side by side, and attaches every region that passes `zones` and the limits of size as a
 * #GstVideoRegionOfInterestMeta of type `motion` (see #CerberusRegion). The frame goes
 * through untouched. Stages that are missing upstream are done here with their defaults. No
 * region is published until three frames of a scene were seen. Limits of size that contradict
 * each other or the frame, and zones that leave no part of the picture, are warned of.
 *
 * A limit in metres judges only what has a distance: `horizontal-fov` and `mounting-height` are known, and the feet are
 * in the picture and below the horizon. The rest passes, for who cannot be measured may be somebody; limits in pixels
 * and zones are for what flies and shines up there.
 *
 * The stages' planes are taken off the frame once they are read, so that frames waiting in queues hold none, unless an
 * element downstream (motionview) asks for them. `keep-planes` says otherwise: `always` leaves them there, and with
 * `never` nobody who asks is heard. Where `motiontrack` follows, the small picture and
 * the mask stay on as far as there, whatever `keep-planes` says.
 *
 * ## Example
 * |[
 * gst-launch-1.0 videotestsrc num-buffers=60 pattern=ball ! \
 *     motionregions zones="include 0,0 1,0 1,0.5 0,0.5" ! fakesink
 * ]|
 *
 * Since: 0.1
 */
// The paper calls this step "post treatment" (II.B) and leaves it open. Ours: see lib/vision/detection/regions.h. Limits in
// metres use the body width of 48 cm (III) and count only while `horizontal-fov` is known.
#include <cerberus/cerberus.h>

#include <string>

#include "analysis_element.hpp"
#include "cerberus/private/messages.hpp"
#include "elements.hpp"
#include "settings_conflict.hpp"
#include "shared/camera_mount.hpp"
#include "shared/enums.hpp"
#include "shared/stages.hpp"

GST_DEBUG_CATEGORY_STATIC(motionregions_debug);
#define GST_CAT_DEFAULT motionregions_debug

namespace cerberus::plugin {
namespace {

constexpr double kMaximumPixels = 8192, kMaximumMetres = 100;

struct Settings {
  int closing = vision::RegionOptions{}.closing;
  bool people = vision::RegionOptions{}.people;
  double minimum_area = vision::RegionOptions{}.minimum_area;
  std::string zones;
  double minimum_width = 0, maximum_width = 0, minimum_height = 0, maximum_height = 0;
  double minimum_width_metres = vision::human_size().metres_wide.least;
  double maximum_width_metres = vision::human_size().metres_wide.most;
  double minimum_height_metres = vision::human_size().metres_high.least;
  double maximum_height_metres = vision::human_size().metres_high.most;
  double horizontal_fov = 0;
  double mounting_height = kDefaultMountingHeight;
  double tilt = 0;
  int keep_planes = KEEP_PLANES_AUTO;
};

const Property<Settings> kProperties[] = {
    property("closing", &Settings::closing, 0, 63,
             "Side of the closing that fills holes and joins fragments, in pixels of an analysis picture 320 "
             "wide (it grows "
             "with the picture): larger joins what is farther apart; 0 or 1 = none"),
    property("people", &Settings::people,
             "Join fragments and part groups by the height of a person, learnt from the scene; off: one "
             "region for each "
             "connected part of the mask"),
    property("minimum-area", &Settings::minimum_area, 0, 1e6,
             "Moving pixels of the analysis picture that a region needs: larger drops small objects; 0 = "
             "chosen from the "
             "picture's size"),
    property("zones", &Settings::zones,
             "Where motion counts: polygons as `include X,Y X,Y X,Y ...; exclude X,Y ...` in fractions of "
             "the picture from "
             "its top left corner; empty = everywhere"),
    property("minimum-width", &Settings::minimum_width, 0, kMaximumPixels,
             "Least width in frame pixels of a region as found; 0 = no limit"),
    property("maximum-width", &Settings::maximum_width, 0, kMaximumPixels,
             "Greatest width in frame pixels of a region as found; 0 = no limit"),
    property("minimum-height", &Settings::minimum_height, 0, kMaximumPixels,
             "Least height in frame pixels of a region as found; 0 = no limit"),
    property("maximum-height", &Settings::maximum_height, 0, kMaximumPixels,
             "Greatest height in frame pixels of a region as found; 0 = no limit"),
    property(
        "minimum-width-metres", &Settings::minimum_width_metres, 0, kMaximumMetres,
        "Least width in metres of a region as found, where horizontal-fov tells its distance; 0 = no limit"),
    property("maximum-width-metres", &Settings::maximum_width_metres, 0, kMaximumMetres,
             "Greatest width in metres of a region as found, where horizontal-fov tells its distance; 0 = no "
             "limit"),
    property(
        "minimum-height-metres", &Settings::minimum_height_metres, 0, kMaximumMetres,
        "Least height in metres of a region as found, where horizontal-fov tells its distance; 0 = no limit"),
    property("maximum-height-metres", &Settings::maximum_height_metres, 0, kMaximumMetres,
             "Greatest height in metres of a region as found, where horizontal-fov tells its distance; 0 = "
             "no limit"),
    property("horizontal-fov", &Settings::horizontal_fov, 0, kMaximumFieldOfView, kFieldOfViewBlurb),
    property("mounting-height", &Settings::mounting_height, 0, kMaximumMountingHeight, kMountingHeightBlurb),
    property("tilt", &Settings::tilt, -kMaximumTilt, kMaximumTilt, kTiltBlurb),
    property("keep-planes", &Settings::keep_planes, keep_planes_type,
             "Whether the stages' planes stay on the frame after they were read here"),
};

struct Private final : StatefulAnalyser<Settings, RegionStage> {
  KeepPlanes keep = KEEP_PLANES_AUTO;
  vision::SizeLimits gate;
  bool in_metres = false;  // they count
  double minimum_area = 0;
  std::string zones;  // as last read
  NothingFound nothing;
  // For what it was asked last why nothing can be found.
  vision::Size judged_size, judged_mask;
  bool judged_nowhere = false, judge = true;
  Answer<KeepPlanes> answer;

  bool start() override;
  Planes planes() override;
  bool analyse(Frame& frame) override;
  void apply(const Settings& s);
  void read_zones(const std::string& text);
  void judge_settings(vision::Size frame);
  std::string why_nothing(vision::Size frame);
};

void Private::apply(const Settings& s) {
  state->set_options({s.closing, s.people, s.minimum_area});
  gate.width = {s.minimum_width, s.maximum_width};
  gate.height = {s.minimum_height, s.maximum_height};
  gate.metres_wide = {s.minimum_width_metres, s.maximum_width_metres};
  gate.metres_high = {s.minimum_height_metres, s.maximum_height_metres};
  state->set_gate(gate, radians(s.horizontal_fov), s.mounting_height, radians(s.tilt));
  in_metres = s.horizontal_fov > 0;
  minimum_area = s.minimum_area;
  keep = static_cast<KeepPlanes>(s.keep_planes);
  if (answer.outdated_by(keep)) cerberus_analysis_answer_anew(base);
  judge = true;
}

Planes Private::planes() {
  const KeepPlanes told = answer.give(static_cast<KeepPlanes>(settings.snapshot().keep_planes));
  if (told == KEEP_PLANES_AUTO) return Planes::as_asked;
  return told == KEEP_PLANES_ALWAYS ? Planes::wanted : Planes::unwanted;
}

// Zones that cannot be read stop the start; a typo while playing keeps the zones that were there.
bool Private::start() {
  StatefulAnalyser::start();
  nothing = {};
  zones = settings.snapshot().zones;
  const std::string wrong = state->zones().parse(zones);
  if (wrong.empty()) return true;
  CERBERUS_ELEMENT_ERROR(base, RESOURCE, SETTINGS, (wrong), ("the property zones cannot be used"));
  return false;
}

void Private::read_zones(const std::string& text) {
  zones = text;
  if (const std::string wrong = state->zones().parse(text); !wrong.empty())
    CERBERUS_ELEMENT_WARNING(base, RESOURCE, SETTINGS, (wrong), ("the zones that were there stay"));
}

std::string Private::why_nothing(vision::Size frame) {
  if (state->zones().nowhere())
    return "The property zones leaves no part of the picture: nothing can be found. Make what it includes "
           "larger, or "
           "what it excludes smaller.";
  std::string why = contradiction("width", gate.width, frame.width);
  if (why.empty()) why = contradiction("height", gate.height, frame.height);
  const vision::Size mask = state->size();
  if (why.empty()) why = contradiction("area", {minimum_area, 0}, 1.0 * mask.width * mask.height);
  if (why.empty() && in_metres) why = contradiction("width-metres", gate.metres_wide);
  if (why.empty() && in_metres) why = contradiction("height-metres", gate.metres_high);
  return why;
}

void Private::judge_settings(vision::Size frame) {
  const bool nowhere = state->zones().nowhere();
  if (!judge && frame == judged_size && state->size() == judged_mask && nowhere == judged_nowhere) return;
  judge = false;
  judged_size = frame;
  judged_mask = state->size();
  judged_nowhere = nowhere;
  nothing.tell(GST_ELEMENT(base), why_nothing(frame));
}

bool Private::analyse(Frame& frame) {
  if (const auto changed = settings.changes()) {
    apply(*changed);
    if (changed->zones != zones) read_zones(changed->zones);
  }
  state->luma().set_analysis_width(cerberus_analysis_width(base));
  frame.planes_wanted = keep == KEEP_PLANES_ALWAYS || (keep == KEEP_PLANES_AUTO && frame.planes_wanted);
  const bool found = state->run(frame);
  if (!frame.planes_wanted) leave_sight(frame);
  if (found) judge_settings(frame.size());
  return found;
}

constexpr AnalysisInfo kInfo{"CerberusMotionRegions", "Motion regions",
                             "Regions of interest from the moving area"};

}  // namespace

GType motionregions_get_type() {
  return analysis_type<Private, kProperties, kInfo>();
}

}  // namespace cerberus::plugin

CERBERUS_REGISTER_ELEMENT(motionregions, GST_RANK_NONE, cerberus::plugin::motionregions, motionregions_debug,
                          "regions of interest from the moving area")
