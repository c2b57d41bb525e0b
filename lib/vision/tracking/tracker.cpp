// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/tracking/tracker.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "vision/tracking/tracking_parameters.h"

namespace cerberus::vision {
namespace {

constexpr double kDefaultSeconds = 1.0 / 25;  // until a frame distance is known
constexpr std::size_t kMaximumTracks = 128;
constexpr std::size_t kMaximumRegions = 256;  // the largest; more is not a scene with objects in it
// Capacity at first. When it is exceeded it is doubled, up to the maximum.
constexpr std::size_t kUsualTracks = 8, kUsualRegions = 16;

}  // namespace

struct Tracker::State {
  const TrackingParameters parameters;
  TrackOptions options;
  std::vector<TrackHypothesis> tracks;
  std::vector<Region> regions;
  std::vector<Track> published;
  double seconds = kDefaultSeconds;
  Size frame;
  DataAssociation association{parameters.association};
  LifeCycle life_cycle{parameters.life};
  OrientationEstimate orientation;
  RegionAppearances appearances{parameters.search, parameters.appearance};
  bool turning = false;  // the camera moved since the last frame

  explicit State(const TrackingParameters& numbers = {}) : parameters(numbers) {
    preallocate(kUsualTracks, kUsualRegions);
  }
  void preallocate(std::size_t track_count, std::size_t region_count);
  void take(std::span<const Region> input);
  void predict(const Transform& motion);
  void associate();
  void correct(TrackHypothesis& track);
  void learn_standing(TrackHypothesis& track, bool fits);
  void remove_lost() {
    std::erase_if(tracks, [](const TrackHypothesis& t) { return t.is(TrackPhase::lost); });
  }
  void start_tracks();
  void publish();
};

// Keeps the contents.
void Tracker::State::preallocate(std::size_t track_count, std::size_t region_count) {
  tracks.reserve(track_count);
  published.reserve(track_count);
  regions.reserve(region_count);
  appearances.reserve(region_count);
  association.reserve(track_count, region_count);
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
    if (t.is(TrackPhase::off_screen))
      t.predict_off_screen(seconds, orientation.gaze());
    else if (!t.predict(seconds, turning) || !t.carry(motion, frame))
      LifeCycle::lose(t);
  }
  remove_lost();
  for (TrackHypothesis& t : tracks) {
    t.there = t.left = false;
    const Sight& sight = appearances.sight();
    if (!sight.known()) continue;
    if (turning) t.standing.carry(motion.rescaled(frame, sight.luma.size()));
    if (!t.standing.known()) continue;
    const bool holds = t.standing.holds(appearances.in_sight(t.box()));
    t.left = holds ? t.standing.left(sight.luma) : !sight.background.empty();
    t.there = holds && !t.left && !turning;
  }
}

// Corrects all tracks that have a region, region by region: tracks that were corrected before count with their new
// boxes where a region is asked about its other tracks.
void Tracker::State::associate() {
  association.associate(tracks, regions, appearances, {frame, seconds, options.maximum_speed});
  for (std::size_t i = 0; i < tracks.size(); ++i) tracks[i].match = association.matches()[i];
  for (int j = 0; j < static_cast<int>(regions.size()); ++j) {
    for (TrackHypothesis& t : tracks)
      if (t.match.region == j && t.match.merged) LifeCycle::lose(t);
    for (TrackHypothesis& t : tracks)
      if (t.match.region == j && !t.is(TrackPhase::lost)) correct(t);
  }
  remove_lost();
}

void Tracker::State::correct(TrackHypothesis& t) {
  const auto j = static_cast<std::size_t>(t.match.region);
  const Region& region = regions[j];
  const bool alone =
      t.match.sharers == 1 && !t.match.occluded && !association.others_expected(tracks, t, region.box, frame);
  if (t.is(TrackPhase::off_screen)) LifeCycle::come_back(t, region.box);
  const bool in_blob = !alone && association.is_larger(region.box, t.box());
  const auto found = in_blob ? appearances.find(t, region.box) : std::nullopt;
  t.correct(region, alone, seconds, frame, found);
  if (t.in_view()) LifeCycle::see(t);
  const bool fits = alone && t.fit.misfit == 0;
  learn_standing(t, fits);
  t.shared.unlocated = alone || found ? 0 : t.shared.unlocated + seconds;
  t.shared.time = alone ? 0 : t.shared.time + seconds;
  if (fits && appearances.of(j).known())
    t.remember(appearances.of(j), seconds, !association.crowded(tracks, t, region.box));
}

// The background model has not absorbed an object that has only just begun to stand. fits: the region is all of it, and of
// nothing else.
void Tracker::State::learn_standing(TrackHypothesis& t, bool fits) {
  const Sight& sight = appearances.sight();
  StandingPlace& standing = t.standing;
  const Box box = appearances.in_sight(t.box());
  if (t.slow == 0 && !standing.holds(box)) standing.forget();
  if (!fits || t.slow == 0 || sight.background.empty()) return;
  if (!standing.holds(box)) standing.begin(box, sight.background);
  standing.learn(sight.luma);
}

void Tracker::State::start_tracks() {
  for (std::size_t j = 0; j < regions.size(); ++j) {
    if (!association.is_new(j) || tracks.size() >= kMaximumTracks) continue;
    if (tracks.size() == tracks.capacity()) preallocate(2 * tracks.size(), regions.capacity());
    tracks.push_back(TrackHypothesis::first_seen(regions[j], parameters.track));
    tracks.back().match.region = static_cast<int>(j);
  }
}

void Tracker::State::publish() {
  published.clear();
  for (const TrackHypothesis& t : tracks) {
    const auto state = life_cycle.published(t);
    if (!state) continue;
    const Box box = inside(t.box(), frame);
    if (box.width < 1 || box.height < 1) continue;
    published.push_back({t.id, box, t.x.velocity, t.y.velocity, t.top_speed, t.age,
                         std::clamp(t.confidence, 0.0, 1.0), *state, t.kind});
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

void Tracker::set_parameters(const TrackingParameters& parameters) {
  const TrackOptions options = state_->options;
  state_ = std::make_unique<State>(parameters);
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
  s.frame = frame;
  if (s.orientation.update(camera, motion, frame)) {  // angles have another origin now
    for (TrackHypothesis& t : s.tracks)
      if (t.is(TrackPhase::off_screen)) LifeCycle::lose(t);
    s.remove_lost();
  }
  s.turning = !motion.is_identity();
  s.take(regions);
  s.appearances.update(input, s.regions, motion, frame);
  s.predict(motion);
  s.associate();
  s.start_tracks();
  s.life_cycle.advance(s.tracks, {frame, s.seconds, s.turning, s.orientation.gaze(), s.orientation.turns()},
                       s.options);
  s.remove_lost();
  s.publish();
  s.appearances.done();
  return s.published;
}

}  // namespace cerberus::vision
