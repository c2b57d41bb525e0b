// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/slip.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace cerberus::control {

namespace {

using sensing::radians;

constexpr double kMostGain = 1.4, kLeastGain = 0.7;       // a head that follows
constexpr double kSlipGain = 0.2, kReversedGain = -0.45;  // at most
constexpr double kSameScale = 0.15;                       // gains of one fault differ by this share at most
constexpr double kStirs = radians(1);                     // a second: a picture that jerks
constexpr double kStirsOfChange =
    0.05;                              // additional stir allowed for each unit of change of head and picture
constexpr double kLongestFrame = 0.5;  // seconds: frames further apart are not compared
constexpr double kMostTurn = radians(360);  // of a head between two frames; larger values are invalid
constexpr int kLongestEpisode = 5;  // pairs: a speed that keeps changing is split into several episodes
constexpr double kRounding = 1e-3;  // seconds, of a sum of frame distances
constexpr double kSeenShare = 0.5;  // of a bin: the measured share that it needs

}  // namespace

void SlipWatch::Episode::see(Bin& seen) {
  bin[static_cast<unsigned>(bins++)] = seen;
  travel += std::exchange(seen.travel, 0);
}

void SlipWatch::Episode::add(const Bin& now, const Bin& before) {
  ++pairs;
  const double d = now.picture - before.picture;
  for (unsigned i = 0; i < kLags; ++i) {
    const double e = now.head[i] - before.head[i];
    de[i] += d * e, ee[i] += e * e;
    largest = std::max(largest, std::abs(e));
  }
}

double SlipWatch::Episode::stir(unsigned lag) const {
  double lowest = HUGE_VAL, highest = -HUGE_VAL;
  for (const Bin& b : std::span(bin).first(static_cast<unsigned>(bins))) {
    const double rest = b.picture - gain(lag) * b.head[lag];
    lowest = std::min(lowest, rest);
    highest = std::max(highest, rest);
  }
  return highest - lowest;
}

// Returns the lag with the least stir. Lags at which the head's speed hardly changes are skipped: their gain is
// undetermined.
unsigned SlipWatch::Episode::lag() const {
  const auto most = std::ranges::max_element(ee);
  auto best = static_cast<unsigned>(most - ee.begin());
  for (unsigned i = 0; i < kLags; ++i)
    if (ee[i] >= *most / 4 && (stir(i) < stir(best) || (stir(i) == stir(best) && i < best))) best = i;
  return best;
}

bool SlipWatch::Run::goes_on(SlipFault next, double gain) const {
  if (episodes == 0 || fault != next) return false;
  return fault != SlipFault::scale || std::abs(gain * episodes / gains - 1) < kSameScale;
}

void SlipWatch::forget_frames() {
  bin_count_ = 0;
  episode_ = {};
  span_ = seen_ = picture_ = travel_ = 0;
  head_ = {};
  commanded_count_ = 1;
  commanded_[newest_] = {};
}

// Interpolates linearly between frames; before the oldest frame, returns its value.
double SlipWatch::commanded_at(double time) const {
  Commanded after = commanded_[newest_];
  for (unsigned n = 0; n < commanded_count_; ++n) {
    const Commanded& before = commanded_[(newest_ + kCommanded - n) % kCommanded];
    if (before.time < time && after.time > before.time)
      return before.head + (after.head - before.head) * (time - before.time) / (after.time - before.time);
    after = before;
  }
  return after.head;
}

std::optional<SlipFinding> SlipWatch::add(double seconds, double picture, double head) {
  if (!(seconds > 0 && seconds <= kLongestFrame) || !(std::abs(head) <= kMostTurn)) {
    forget_frames();
    return std::nullopt;
  }
  const Commanded before = commanded_[newest_];
  const double now = before.time + seconds;
  newest_ = (newest_ + 1) % kCommanded;
  commanded_[newest_] = {now, before.head + head};
  commanded_count_ = std::min(commanded_count_ + 1, kCommanded);
  span_ += seconds;
  if (std::isfinite(picture)) {
    seen_ += seconds;
    picture_ += picture;
    for (unsigned i = 0; i < kLags; ++i)
      head_[i] += commanded_at(now - i * kLag) - commanded_at(before.time - i * kLag);
    travel_ += std::abs(head);
  }
  if (span_ < kBin - kRounding) return std::nullopt;
  return close_bin();
}

std::optional<SlipFinding> SlipWatch::close_bin() {
  if (seen_ < kSeenShare * span_) {
    forget_frames();
    return std::nullopt;
  }
  std::ranges::move_backward(bins_.begin(), bins_.end() - 1, bins_.end());
  for (double& head : head_) head /= seen_;
  bins_[0] = {picture_ / seen_, head_, travel_};
  bin_count_ = std::min(bin_count_ + 1, static_cast<int>(bins_.size()));
  span_ = seen_ = picture_ = travel_ = 0;
  head_ = {};
  if (bin_count_ < 3) return std::nullopt;

  bool changes = false;
  for (unsigned i = 0; i < kLags; ++i)
    changes = changes || std::abs(bins_[0].head[i] - bins_[2].head[i]) >= kLeastChange;
  if (!changes && episode_.pairs == 0) return std::nullopt;
  if (episode_.pairs == 0)  // an episode includes the bins before it
    for (int i = bin_count_ - 1; i > 0; --i) episode_.see(bins_[static_cast<unsigned>(i)]);
  episode_.see(bins_[0]);
  if (changes) episode_.add(bins_[0], bins_[2]);
  if (changes && episode_.pairs < kLongestEpisode) return std::nullopt;
  return close_episode();
}

// Returns the fault of an episode; nullopt if it is no evidence.
std::optional<SlipFault> SlipWatch::judge(const Episode& e, unsigned lag) {
  const double gain = e.gain(lag);
  if (gain >= kLeastGain && gain <= kMostGain) return SlipFault::none;
  if (gain <= kReversedGain) return SlipFault::reversed;
  if (gain < -kSlipGain) return std::nullopt;
  if (e.stir(lag) > kStirs + kStirsOfChange * e.largest * std::max(1.0, gain)) return std::nullopt;
  return std::abs(gain) > kSlipGain ? SlipFault::scale : SlipFault::slips;
}

std::optional<SlipFinding> SlipWatch::close_episode() {
  const Episode episode = std::exchange(episode_, {});
  const unsigned lag = episode.lag();
  const auto verdict = judge(episode, lag);
  if (!verdict) return std::nullopt;
  if (!run_.goes_on(*verdict, episode.gain(lag))) run_ = {*verdict};
  ++run_.episodes;
  run_.gains += episode.gain(lag);
  run_.travel += episode.travel;
  if (run_.episodes < least_episodes(run_.fault) || run_.travel < kLeastTravel || run_.fault == fault_)
    return std::nullopt;
  fault_ = run_.fault;
  if (fault_ == SlipFault::none) return std::nullopt;
  return SlipFinding{fault_, run_.gains / run_.episodes, run_.travel};
}

}  // namespace cerberus::control
