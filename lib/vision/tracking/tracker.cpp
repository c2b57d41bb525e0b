// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/tracking/tracker.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "vision/tracking/data_association.h"
#include "vision/tracking/identity_swap.h"
#include "vision/tracking/region_appearances.h"
#include "vision/tracking/track_hypothesis.h"

namespace cerberus::vision {
namespace {

using TrackPhase = TrackHypothesis::State;

constexpr double kDefaultSeconds = 1.0 / 25;  // until a frame distance is known
constexpr std::size_t kMaximumTracks = 128;
constexpr std::size_t kMaximumRegions = 256;  // the largest; more is not a scene with objects in it
// Capacity at first. When it is exceeded it is doubled, up to the maximum.
constexpr std::size_t kUsualTracks = 8, kUsualRegions = 16;

// Where no origin stands the value was chosen by hand on vtest.avi and davis_tennis. Guard: boxes on vtest.avi
// (precision .84, recall .83), MOTA 56 on PETS09-S2L1, tests/unit (tracker, standing, straight, turning).
struct Parameters {
  // Confirmation.
  double least_travel =
      0.12;  // S that an object has moved. The uncovered place of an object that belonged to the
             // background model, and a lamp that was switched on, never move.
  double newly_visible =
      0.5;  // s until what the camera has turned to counts as seen for a while: foreground there
            // moves, as no object can have left a hole in a model that did not exist
  double newly_visible_share = 0.5;  // of a region outside the established view
  int least_hits = 3;                // frames with a region,
  int slow_least_hits = 2;           // or these, at a low frame rate: after slow_confirm x confirm-time
  double slow_confirm = 3;           // times confirm-time
  double confirm_slack = 0.99;       // of confirm-time: rounding of the frame distances adds up
  double hit_share = 0.6;            // of the frames in which a tentative track has a region
  double tentative_coast = 0.5;      // of confirm-time that it is kept without
  // Coasting.
  double coast_share = 0.5;   // of the time for which the object was seen
  double border_coast = 0.3;  // of the coast time, at the picture's edge
  double proven = 3;          // times confirm-time for which a coasted track was seen before it is published
  double certain = 0.4;  // of the box's width: standard deviation up to which a coasted track is published
  double occluded_coast = 0.3;  // s for which an occluded track is published
  double crossing = 3;          // s for which two tracks may overlap
  // Stopping: the object was well seen, slower and slower.
  double still = 0.3;         // s of standing, or nearly
  double fitted = 0.5;        // s of regions of its extent
  double stop_travel = 0.45;  // S that it came
  double seen = 1.5;          // s for which it was seen
  double covered = 0.2;       // of its box that another track covers: it may be behind that one
  // Off-screen.
  double off_screen_fit = 0.5;      // s of regions of its extent
  double off_screen_travel = 0.45;  // S
  // Blobs that have come apart, and two tracks on one object.
  double hollow_inside =
      0.6;  // of a region's area that lies in a track without region: the track was a blob of
  double hollow_part = 0.1;       // several, if two regions of this share of its area do
  double duplicate = 0.7;         // intersection over union
  double duplicate_shared = 1.0;  // s in one region after which one of the two ends
  double duplicate_unseen = 0.5;  // s, the same where one has no region
};

}  // namespace

struct Tracker::State {
  Parameters parameters;
  TrackParameters track_parameters;
  TrackOptions options;
  std::vector<TrackHypothesis> tracks;
  std::vector<Region> regions;
  std::vector<Track> published;
  std::uint32_t last_id = 0;
  double seconds = kDefaultSeconds;
  Size frame;
  DataAssociation association;
  OrientationEstimate orientation;
  RegionAppearances appearances;
  Box established;       // part of the picture that has been in view for a while
  bool turning = false;  // the camera moved since the last frame

  State() { preallocate(kUsualTracks, kUsualRegions); }
  void preallocate(std::size_t track_count, std::size_t region_count);
  void update_view(const Transform& motion);
  void take(std::span<const Region> input);
  void predict(const Transform& motion);
  void associate();
  void correct(TrackHypothesis& track);
  void remove_hollow();
  void remove_lost() {
    std::erase_if(tracks, [](const TrackHypothesis& t) { return t.state == TrackPhase::lost; });
  }
  void start_tracks();
  void advance();
  void advance_tentative(TrackHypothesis& track);
  void advance_off_screen(TrackHypothesis& track);
  void advance_unseen(TrackHypothesis& track);
  bool is_confirmed(const TrackHypothesis& track) const;
  bool are_duplicates(const TrackHypothesis& a, const TrackHypothesis& b) const;
  void remove_duplicates();
  bool is_published(const TrackHypothesis& track) const;
  void publish();
  bool covered(const TrackHypothesis& track) const;
  bool left_place(const TrackHypothesis& track) const;
  bool has_stopped(const TrackHypothesis& track) const;
};

// Keeps the contents.
void Tracker::State::preallocate(std::size_t track_count, std::size_t region_count) {
  tracks.reserve(track_count);
  published.reserve(track_count);
  regions.reserve(region_count);
  appearances.reserve(region_count);
  association.reserve(track_count, region_count);
}

// The established view moves with the scene, and new parts of the scene belong to it after about newly_visible.
void Tracker::State::update_view(const Transform& motion) {
  turning = !motion.is_identity();
  const Box whole{0, 0, static_cast<double>(frame.width), static_cast<double>(frame.height)};
  if (!turning && established.area() == whole.area()) return;
  const Point low = motion.apply({established.x, established.y});
  const Point high = motion.apply({established.right(), established.bottom()});
  const double gain = std::min(1.0, seconds / parameters.newly_visible);
  const auto side = [&](double at, double edge, double most) {
    const double inside = std::clamp(std::isfinite(at) ? at : edge, 0.0, most);
    return inside + gain * (edge - inside);
  };
  const double x0 = side(low.x, 0, whole.width), x1 = side(high.x, whole.width, whole.width);
  const double y0 = side(low.y, 0, whole.height), y1 = side(high.y, whole.height, whole.height);
  established = {x0, y0, std::max(0.0, x1 - x0), std::max(0.0, y1 - y0)};
}

// Copies the valid regions, the largest kMaximumRegions at most.
void Tracker::State::take(std::span<const Region> input) {
  regions.clear();
  if (input.size() > regions.capacity())
    preallocate(tracks.capacity(), std::min(std::bit_ceil(input.size()), kMaximumRegions));
  for (const Region& r : input) {
    if (!(r.box.width > 0 && r.box.height > 0) || !std::isfinite(r.box.x + r.box.y + r.box.area())) continue;
    if (regions.size() < kMaximumRegions) {
      regions.push_back(r);
      continue;
    }
    const auto area = [](const Region& region) { return region.box.area(); };
    const auto smallest = std::ranges::min_element(regions, {}, area);
    if (area(*smallest) < area(r)) *smallest = r;
  }
}

void Tracker::State::predict(const Transform& motion) {
  for (TrackHypothesis& t : tracks) {
    if (t.state == TrackPhase::off_screen)
      t.predict_off_screen(seconds, orientation.gaze());
    else if (!t.predict(seconds) || !t.carry(motion, frame))
      t.lose();
  }
  remove_lost();
  for (TrackHypothesis& t : tracks) {
    AppearanceModel& place = t.appearance.place;
    if (turning) place = {};  // the background around the object is another one now
    t.appearance.place_change =
        t.in_view() && place.known() ? appearance_distance(place, appearances.place(t.box())) : -1;
  }
}

// Corrects all tracks that have a region, region by region: tracks that were corrected before count with their new
// boxes where a region is asked about its other tracks.
void Tracker::State::associate() {
  association.associate(tracks, regions, appearances, {frame, seconds, options.maximum_speed});
  for (std::size_t i = 0; i < tracks.size(); ++i) tracks[i].match = association.matches()[i];
  for (int j = 0; j < static_cast<int>(regions.size()); ++j) {
    for (TrackHypothesis& t : tracks)
      if (t.match.region == j && t.match.merged) t.lose();
    for (TrackHypothesis& t : tracks)
      if (t.match.region == j && t.state != TrackPhase::lost) correct(t);
  }
  remove_lost();
}

void Tracker::State::correct(TrackHypothesis& t) {
  const auto j = static_cast<std::size_t>(t.match.region);
  const Region& region = regions[j];
  const bool alone =
      t.match.sharers == 1 && !t.match.occluded && !association.others_expected(tracks, t, region.box, frame);
  if (t.state == TrackPhase::off_screen) t.come_back(region.box);
  const bool in_blob = !alone && association.is_larger(region.box, t.box());
  const auto found = in_blob ? appearances.find(t, region.box) : std::nullopt;
  t.correct(region, alone, seconds, frame, found);
  const bool fits = alone && t.misfit.time == 0;
  t.learn_place(fits && t.slow > 0 ? appearances.place(t.box()) : AppearanceModel{}, seconds);
  t.unlocated = alone || found ? 0 : t.unlocated + seconds;
  t.shared = alone ? 0 : t.shared + seconds;
  if (fits && appearances.of(j).known())
    t.remember(appearances.of(j), seconds, !association.crowded(tracks, t, region.box));
  else if (!alone)
    t.touch();
}

// A track without region whose box holds several regions was the blob that they have come out of.
void Tracker::State::remove_hollow() {
  for (TrackHypothesis& t : tracks) {
    if (t.match.region >= 0 || !t.in_view()) continue;
    const Box box = t.box();
    const auto inside = std::count_if(regions.begin(), regions.end(), [&](const Region& r) {
      return overlap_area(r.box, box) > parameters.hollow_inside * r.box.area() &&
             r.box.area() > parameters.hollow_part * box.area();
    });
    if (inside > 1) t.lose();
  }
  remove_lost();
}

void Tracker::State::start_tracks() {
  for (std::size_t j = 0; j < regions.size(); ++j) {
    if (!association.is_new(j) || tracks.size() >= kMaximumTracks) continue;
    if (tracks.size() == tracks.capacity()) preallocate(2 * tracks.size(), regions.capacity());
    const Box& box = regions[j].box;
    tracks.push_back(TrackHypothesis::first_seen(regions[j], track_parameters));
    tracks.back().match.region = static_cast<int>(j);
    tracks.back().newly_visible =
        overlap_area(box, established) < parameters.newly_visible_share * box.area();
  }
}

// Does another track, one with a region, lie in front of it?
bool Tracker::State::covered(const TrackHypothesis& t) const {
  const Box box = t.box();
  return std::any_of(tracks.begin(), tracks.end(), [&](const TrackHypothesis& o) {
    return &o != &t && o.id != 0 && o.match.region >= 0 &&
           overlap_area(o.box(), box) > parameters.covered * box.area();
  });
}

// Is it at the picture's edge, and its place looks otherwise?
bool Tracker::State::left_place(const TrackHypothesis& t) const {
  return t.appearance.place_change >= 0 && !t.stays() && t.at_border(frame);
}

// Has the object ceased to move, rather than left or gone behind another one? It was well seen before, slower and
// slower until nothing moved any more, uncovered; at the picture's edge its place must look as before.
bool Tracker::State::has_stopped(const TrackHypothesis& t) const {
  if (t.slow < parameters.still || t.fitted < parameters.fitted || t.travelled < parameters.stop_travel ||
      t.age - t.unseen < parameters.seen || t.leaving)
    return false;
  return !left_place(t) && !covered(t);
}

bool Tracker::State::is_confirmed(const TrackHypothesis& t) const {
  const Parameters& q = parameters;
  if (options.confirm_time <= 0) return true;
  const bool enough = t.hits >= q.least_hits ||
                      (t.hits >= q.slow_least_hits && t.age >= q.slow_confirm * options.confirm_time);
  return enough && (t.newly_visible || t.travelled >= q.least_travel) &&
         t.age >= q.confirm_slack * options.confirm_time && t.hits >= q.hit_share * t.frames;
}

// Without region.
void Tracker::State::advance_tentative(TrackHypothesis& t) {
  if (t.unseen > parameters.tentative_coast * options.confirm_time &&
      t.hits < parameters.hit_share * t.frames)
    t.lose();
}

void Tracker::State::advance_off_screen(TrackHypothesis& t) {
  TrackHypothesis::OffScreen& data = t.off_screen;
  if (t.expected_in(frame)) data.absent += seconds;
  const double longest = data.stopped ? options.hold_stopped : options.away_time;
  const double absent = data.absent;
  if (data.stopped && absent > 0) t.resume_stop();
  if (t.unseen > longest || absent > options.coast_time) t.lose();
}

// A track in view without region coasts, stops, goes off-screen or ends.
void Tracker::State::advance_unseen(TrackHypothesis& t) {
  const Parameters& q = parameters;
  const bool outside =
      t.x.position < 0 || t.y.position < 0 || t.x.position > frame.width || t.y.position > frame.height;
  if (t.state != TrackPhase::stopped && has_stopped(t)) t.stop();
  const bool stopped = t.state == TrackPhase::stopped;
  const double coast = std::min(options.coast_time, q.coast_share * (t.age - t.unseen));
  const double limit = stopped ? options.hold_stopped : t.at_border(frame) ? q.border_coast * coast : coast;
  constexpr double kLeastTime = 1e-3;  // s: options may be 0
  t.confidence *=
      std::exp(-seconds / std::max(stopped ? options.hold_stopped : options.coast_time, kLeastTime));
  // A stopped object at the edge whose place looks otherwise, and which is not covered, has left.
  const bool left = stopped && left_place(t) && !covered(t);
  t.stop_data.absent = left ? t.stop_data.absent + seconds : 0;
  if (!outside && t.unseen <= limit && t.stop_data.absent <= q.border_coast * coast) return;
  if (turning && (outside || t.at_border(frame)) && t.unseen < options.away_time &&
      t.longest_fit >= q.off_screen_fit && t.travelled >= q.off_screen_travel)
    t.leave(orientation.gaze());
  else
    t.lose();
}

void Tracker::State::advance() {
  for (TrackHypothesis& t : tracks) {
    if (t.match.region >= 0) {
      if (t.state == TrackPhase::tentative && is_confirmed(t)) t.confirm(++last_id);
      continue;
    }
    t.miss(seconds);
    if (t.state == TrackPhase::tentative)
      advance_tentative(t);
    else if (t.state == TrackPhase::off_screen)
      advance_off_screen(t);
    else
      advance_unseen(t);
  }
  remove_lost();
}

// Two tracks in view on one object?
bool Tracker::State::are_duplicates(const TrackHypothesis& a, const TrackHypothesis& b) const {
  const Parameters& q = parameters;
  if (intersection_over_union(a.box(), b.box()) < q.duplicate) return false;
  const bool different = look_different(a, b);
  if (a.match.region == b.match.region && a.match.region >= 0) {
    if (different && std::max(a.unlocated, b.unlocated) < q.crossing) return false;
    return std::max(a.shared, b.shared) >= (went_apart(a, b) ? q.crossing : q.duplicate_shared);
  }
  if (a.match.region >= 0 && b.match.region >= 0) return false;
  // One passes in front of the other, which stands there.
  if ((a.stands() || b.stands()) && (different || went_apart(a, b))) return false;
  return std::max(a.unseen, b.unseen) >= q.duplicate_unseen;
}

// Of two tracks on one object the one without region, or else the younger, ends.
void Tracker::State::remove_duplicates() {
  for (std::size_t i = 0; i < tracks.size(); ++i)
    for (std::size_t j = i + 1; j < tracks.size(); ++j) {
      TrackHypothesis &a = tracks[i], &b = tracks[j];
      if (!a.in_view() || !b.in_view() || !are_duplicates(a, b)) continue;
      TrackHypothesis& weaker =
          a.unseen != b.unseen ? (a.unseen > b.unseen ? a : b) : (a.age < b.age ? a : b);
      weaker.lose();
    }
  remove_lost();
}

bool Tracker::State::is_published(const TrackHypothesis& t) const {
  const Parameters& q = parameters;
  if (!t.in_view() || (t.match.occluded && t.unlocated > q.occluded_coast)) return false;
  if (t.match.region >= 0) return true;
  if (t.unlocated >= q.crossing) return false;
  if (t.state == TrackPhase::stopped) return true;
  // A coasted track: while its position is certain; away from the picture's edge, where it probably has left; and if it
  // was seen for long enough not to be noise.
  return std::sqrt(t.x.pp) <= q.certain * t.width() && !t.at_border(frame) &&
         t.age - t.unseen >= q.proven * options.confirm_time;
}

void Tracker::State::publish() {
  published.clear();
  for (const TrackHypothesis& t : tracks) {
    if (!is_published(t)) continue;
    const Box box = t.box();
    const double x0 = std::clamp(box.x, 0.0, static_cast<double>(frame.width));
    const double y0 = std::clamp(box.y, 0.0, static_cast<double>(frame.height));
    const double x1 = std::clamp(box.right(), 0.0, static_cast<double>(frame.width));
    const double y1 = std::clamp(box.bottom(), 0.0, static_cast<double>(frame.height));
    if (x1 - x0 < 1 || y1 - y0 < 1) continue;
    published.push_back({t.id,
                         {x0, y0, x1 - x0, y1 - y0},
                         t.x.velocity,
                         t.y.velocity,
                         t.top_speed,
                         t.age,
                         std::clamp(t.confidence, 0.0, 1.0),
                         t.state == TrackPhase::stopped ? TrackState::stopped
                         : t.match.region >= 0          ? TrackState::seen
                                                        : TrackState::coasted,
                         t.kind});
  }
  std::sort(published.begin(), published.end(), [](const Track& a, const Track& b) { return a.id < b.id; });
}

bool outlasts(TrackState state, double seconds, const TrackOptions& options) {
  return seconds <= (state == TrackState::stopped ? options.hold_stopped : options.coast_time);
}

Tracker::Tracker() : state_(std::make_unique<State>()) {}
Tracker::~Tracker() = default;
Tracker::Tracker(Tracker&&) noexcept = default;
Tracker& Tracker::operator=(Tracker&&) noexcept = default;

void Tracker::set_options(const TrackOptions& options) {
  state_->options = options;
}

void Tracker::reset() {
  state_->tracks.clear();
  state_->published.clear();
  state_->seconds = kDefaultSeconds;
  state_->orientation.reset();
  state_->appearances.reset();
  state_->frame = {};
}

std::size_t Tracker::bytes() const {
  const State& s = *state_;
  const auto of = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
  return sizeof s + of(s.tracks) + of(s.regions) + of(s.published) + s.association.bytes() +
         s.appearances.bytes();
}

std::span<const Track> Tracker::update(std::span<const Region> regions, const Transform& motion,
                                       double seconds, Size frame,
                                       const std::optional<CameraOrientation>& camera, const Sight& input) {
  State& s = *state_;
  if (seconds > 0 && std::isfinite(seconds)) s.seconds = seconds;
  if (frame.width != s.frame.width || frame.height != s.frame.height)
    s.established = {0, 0, static_cast<double>(frame.width), static_cast<double>(frame.height)};
  s.frame = frame;
  if (s.orientation.update(camera, motion, frame))  // angles have another origin now
    std::erase_if(s.tracks, [](const TrackHypothesis& t) { return t.state == TrackPhase::off_screen; });
  s.update_view(motion);
  s.take(regions);
  s.appearances.update(input, s.regions, motion, frame);
  s.predict(motion);
  s.associate();
  s.remove_hollow();
  undo_identity_swaps(s.tracks);
  s.start_tracks();
  s.advance();
  s.remove_duplicates();
  s.publish();
  s.appearances.done();
  return s.published;
}

}  // namespace cerberus::vision
