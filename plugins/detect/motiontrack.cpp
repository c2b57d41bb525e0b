// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-motiontrack
 *
 * Gives the regions of interest a stable identity, a velocity with the camera's motion taken out, an age and a state:
 * seen, coasted (carried on without evidence) or stopped (stands where it was last seen). The regions on the frame are
 * replaced by the tracked ones; the frame goes through untouched. Who leaves the picture because the camera turns keeps
 * the identity for `away-time`: place and motion are kept by angle, from the head's pose on the frames where
 * `horizontal-fov` is known, else from the camera's own motion. People who meet are told apart by how bright coat and
 * legs are, where the planes of the stages reach this element (nothing converts or scales the picture between
 * `motionregions` and it). Without `motionregions` upstream the regions are found here with the defaults. With
 * `horizontal-fov` each object also gets a bearing (degrees, positive to the right of the camera's axis, wherever the
 * head looks) and, where its feet are seen, a distance (metres); the camera's `tilt` counts for it, or that of a head's
 * pose on the frame. Limits of speed that contradict each other and a `confirm-time` above an hour are warned of.
 *
 * Posts `cerberus-motion` element messages: `state=started` with the objects when the first appears, `state=ended` when
 * none was there for `hold-time`, at the end of the stream and when
 * the element stops, with the objects of the last frame that had any.
 *
 * ## Example
 * |[
 * gst-launch-1.0 -m videotestsrc num-buffers=60 pattern=ball ! motiontrack hold-time=500000000 ! fakesink
 * ]|
 *
 * Since: 0.1
 */
// The paper tracks one target and says no more; see lib/vision/tracking/tracker.h for the method. Its limits of speed, 0.1 to 4
// m/s (III), are the defaults in metres a second and count only while `horizontal-fov` is known.
#include <cerberus/cerberus.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "analysis_element.hpp"
#include "elements.hpp"
#include "settings_conflict.hpp"
#include "shared/camera_mount.hpp"
#include "shared/clock_times.hpp"
#include "shared/stages.hpp"
#include "vision/tracking/motion_events.h"
#include "vision/tracking/tracker.h"

GST_DEBUG_CATEGORY_STATIC(motiontrack_debug);
#define GST_CAT_DEFAULT motiontrack_debug

namespace cerberus::plugin {
namespace {

constexpr GstClockTime clock_time(double seconds) {
  return static_cast<GstClockTime>(seconds * GST_SECOND + 0.5);
}
constexpr double seconds(GstClockTime time) {
  return static_cast<double>(time) / GST_SECOND;
}

struct Settings {
  guint64 confirm_time = clock_time(vision::TrackOptions{}.confirm_time);
  guint64 coast_time = clock_time(vision::TrackOptions{}.coast_time);
  guint64 hold_stopped = clock_time(vision::TrackOptions{}.hold_stopped);
  guint64 away_time = clock_time(vision::TrackOptions{}.away_time);
  guint64 hold_time = 2 * GST_SECOND;
  double minimum_speed = 0, maximum_speed = 0;
  double minimum_speed_metres = vision::human_speed().metres.least;
  double maximum_speed_metres = vision::human_speed().metres.most;
  double horizontal_fov = 0;
  double mounting_height = kDefaultMountingHeight;
  double tilt = 0;
};

const Property<Settings> kProperties[] = {
    property("confirm-time", &Settings::confirm_time,
             "Nanoseconds for which an object must be seen, and move, before it is published: longer drops "
             "flicker and answers later; 0 = every region is one in the frame in which it is first seen"),
    property("coast-time", &Settings::coast_time,
             "Nanoseconds for which a moving object is carried on without being seen; 0 = it ends at once"),
    property("hold-stopped", &Settings::hold_stopped,
             "Nanoseconds for which an object that stopped moving is held where it stands (with "
             "fuzzythreshold's memory, which tells that it is still there); 0 = it ends at once"),
    property("away-time", &Settings::away_time,
             "Nanoseconds for which a moving object that the camera has turned away from keeps its identity; "
             "0 = it ends "
             "at once"),
    property(
        "hold-time", &Settings::hold_time,
        "Nanoseconds without any object after which the message that motion ended is posted; 0 = at once"),
    property(
        "minimum-speed", &Settings::minimum_speed, 0, 1e6,
        "Objects that never were as fast as this, in frame pixels a second, are not published; 0 = no limit"),
    property("maximum-speed", &Settings::maximum_speed, 0, 1e6,
             "Objects faster than this, in frame pixels a second, are not published, and no jump wider than "
             "it allows is "
             "taken for the same object; 0 = no limit"),
    property("minimum-speed-metres", &Settings::minimum_speed_metres, 0, 1000,
             "Objects that never were as fast as this, in metres a second, are not published where their "
             "distance is known (horizontal-fov); 0 = no limit"),
    property("maximum-speed-metres", &Settings::maximum_speed_metres, 0, 1000,
             "Objects faster than this, in metres a second, are not published where their distance is known "
             "(horizontal-fov); 0 = no limit"),
    property("horizontal-fov", &Settings::horizontal_fov, 0, kMaximumFieldOfView, kFieldOfViewBlurb),
    property("mounting-height", &Settings::mounting_height, 0, kMaximumMountingHeight, kMountingHeightBlurb),
    property("tilt", &Settings::tilt, -kMaximumTilt, kMaximumTilt, kTiltBlurb),
};

using vision::MotionEvents;

constexpr std::optional<MotionEvents::Time> known(GstClockTime time) {
  if (!GST_CLOCK_TIME_IS_VALID(time)) return std::nullopt;
  return time_of(time);
}

// What is seen for so long is no motion.
constexpr GstClockTime kLongestConfirmTime = 3600 * GST_SECOND;

std::string why_nothing(const Settings& s, const vision::SpeedLimits& gate) {
  if (s.confirm_time > kLongestConfirmTime)
    return "confirm-time is longer than an hour: nothing can be found. Make it shorter.";
  // The lower limit is for the highest speed ever, the upper one for the speed now.
  constexpr char kResult[] = "only who was as fast once and is slower now is found";
  std::string why = contradiction("speed", gate.pixels, 0, kResult);
  if (why.empty() && s.horizontal_fov > 0) why = contradiction("speed-metres", gate.metres, 0, kResult);
  return why;
}

struct State {
  std::optional<RegionStage> regions;  // where no motionregions is upstream
  vision::Tracker tracker;
  std::vector<vision::Region> found;  // what the tracker is fed with
  std::vector<CerberusRegion> published;
  std::vector<CerberusRegion> last;  // of the last frame with any
  MotionEvents presence;
  Settings settings;
  vision::SpeedLimits gate;
  NothingFound nothing;
};

struct Private final : StatefulAnalyser<Settings, State> {
  void stop() override {
    end_of_stream();
    StatefulAnalyser::stop();
  }
  void end_of_stream() override {
    if (!state) return;
    const auto last = state->presence.last();
    announce(state->presence.end(), last ? static_cast<GstClockTime>(last->count()) : GST_CLOCK_TIME_NONE);
  }
  bool analyse(Frame& frame) override;
  bool reads_sight() const override { return true; }

 private:
  void track(const Frame& frame);
  void apply(const Settings& s);
  void read_regions(GstBuffer* buffer);
  void publish(const Frame& frame, const vision::Lens& lens, std::span<const vision::Track> tracks);
  void announce(MotionEvents::Change change, GstClockTime running_time);
};

void Private::apply(const Settings& s) {
  vision::TrackOptions options;
  options.confirm_time = seconds(s.confirm_time);
  options.coast_time = seconds(s.coast_time);
  options.hold_stopped = seconds(s.hold_stopped);
  options.away_time = seconds(s.away_time);
  options.maximum_speed = s.maximum_speed;
  state->tracker.set_options(options);
  state->gate.pixels = {s.minimum_speed, s.maximum_speed};
  state->gate.metres = {s.minimum_speed_metres, s.maximum_speed_metres};
  state->settings = s;
  state->nothing.tell(GST_ELEMENT(base), why_nothing(s, state->gate));
}

void Private::read_regions(GstBuffer* buffer) {
  state->found.clear();
  g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(buffer);
  for (guint i = 0; i < regions->len; ++i) {
    const auto* region = static_cast<const CerberusRegion*>(g_ptr_array_index(regions, i));
    vision::Region& r = state->found.emplace_back();
    r.box = {region->x, region->y, region->width, region->height};
    r.confidence = region->confidence;
  }
}

// Where the head looked, if a pose on the frame says so.
std::optional<vision::CameraOrientation> gaze(const Frame& frame, const vision::Lens& lens) {
  if (!frame.look || !lens.known()) return std::nullopt;
  return vision::CameraOrientation{lens, frame.look->pan, frame.look->tilt};
}

bool Private::analyse(Frame& frame) {
  if (const auto changed = settings.changes()) apply(*changed);
  if (!regions_known(frame.buffer)) {
    if (!state->regions) state->regions.emplace();
    state->regions->luma().set_analysis_width(cerberus_analysis_width(base));
    if (!state->regions->run(frame)) {
      drop_sight(frame.buffer);
      return false;
    }
  }
  read_regions(frame.buffer);
  if (frame.fresh) state->tracker.reset();
  track(frame);
  drop_sight(frame.buffer);
  const bool present = !state->published.empty();
  if (present) state->last = state->published;
  announce(state->presence.update(present, known(frame.running_time), time_of(clock_time(frame.seconds)),
                                  time_of(state->settings.hold_time)),
           frame.running_time);
  return true;
}

void Private::track(const Frame& frame) {
  const MappedPlane luma = MappedPlane::read(frame.buffer, CERBERUS_PLANE_LUMA);
  const MappedPlane mask = MappedPlane::read(frame.buffer, CERBERUS_PLANE_MASK);
  const vision::Sight sight{luma.view<std::uint8_t>(), mask.view<std::uint8_t>()};
  const vision::Lens lens(radians(state->settings.horizontal_fov), frame.size());
  publish(frame, lens,
          state->tracker.update(state->found, frame.motion.transform, frame.seconds, frame.size(),
                                gaze(frame, lens), sight));
}

static_assert(static_cast<int>(vision::TrackState::coasted) == CERBERUS_REGION_COASTED &&
              static_cast<int>(vision::TrackState::stopped) == CERBERUS_REGION_STOPPED);

void Private::publish(const Frame& frame, const vision::Lens& lens, std::span<const vision::Track> tracks) {
  cerberus_buffer_remove_regions(frame.buffer);
  state->published.clear();
  const Settings& s = state->settings;
  for (const vision::Track& track : tracks) {
    const vision::Placement place =
        lens.place(track.box, 0, frame.look ? frame.look->tilt : radians(s.tilt), s.mounting_height);
    const double speed = std::hypot(track.vx, track.vy);
    if (!vision::passes(state->gate, speed, track.top_speed, place)) continue;
    CerberusRegion& out = state->published.emplace_back();
    cerberus_region_init(&out);
    out.id = track.id;
    out.tracked = TRUE;
    out.x = track.box.x;
    out.y = track.box.y;
    out.width = track.box.width;
    out.height = track.box.height;
    out.confidence = track.confidence;
    out.vx = track.vx;
    out.vy = track.vy;
    out.age = clock_time(track.age);
    out.state = static_cast<CerberusRegionState>(track.state);
    out.bearing = degrees(place.bearing);
    out.distance = place.distance;
    cerberus_buffer_add_region(frame.buffer, &out);
  }
}

void Private::announce(MotionEvents::Change change, GstClockTime running_time) {
  if (change == MotionEvents::Change::none) return;
  CerberusStamp stamp;
  cerberus_stamp_init(&stamp);
  stamp.running_time = running_time;
  g_autoptr(CerberusMotion) motion = cerberus_motion_new();
  motion->state = change == MotionEvents::Change::started ? CERBERUS_MOTION_STARTED : CERBERUS_MOTION_ENDED;
  for (const CerberusRegion& region : state->last) cerberus_motion_add_region(motion, &region);
  gst_element_post_message(GST_ELEMENT(base), cerberus_message_new_motion(GST_OBJECT(base), &stamp, motion));
}

constexpr AnalysisInfo kInfo{"CerberusMotionTrack", "Motion tracks",
                             "Stable identities and velocities for the regions, camera motion taken out"};

}  // namespace

GType motiontrack_get_type() {
  return analysis_type<Private, kProperties, kInfo>();
}

}  // namespace cerberus::plugin

CERBERUS_REGISTER_ELEMENT(motiontrack, GST_RANK_NONE, cerberus::plugin::motiontrack, motiontrack_debug,
                          "identities and velocities of moving objects")
