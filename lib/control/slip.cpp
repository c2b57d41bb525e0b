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
constexpr double kStirsOfChange = 0.05;     // how much it may stir more when head and picture change more
constexpr double kLongestFrame = 0.5;       // seconds: between frames further apart too much can happen
constexpr double kMostTurn = radians(360);  // of a head between two frames; what is more is no number
constexpr int kLongestEpisode = 5;          // pairs: a speed that changes all the time is several episodes
constexpr double kRounding = 1e-3;          // seconds, of a sum of frame distances
constexpr double kSeenShare = 0.5;          // of a bin, that it counts

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

// Only those count in whose time the head changed its speed as well: in the others there is nothing to divide by.
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
  told_count_ = 1;
  told_[newest_] = {};
}

// Between frames as straight as between two points; before the oldest one as there.
double SlipWatch::told_at(double time) const {
  Told after = told_[newest_];
  for (unsigned n = 0; n < told_count_; ++n) {
    const Told& before = told_[(newest_ + kTold - n) % kTold];
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
  const Told before = told_[newest_];
  const double now = before.time + seconds;
  newest_ = (newest_ + 1) % kTold;
  told_[newest_] = {now, before.head + head};
  told_count_ = std::min(told_count_ + 1, kTold);
  span_ += seconds;
  if (std::isfinite(picture)) {
    seen_ += seconds;
    picture_ += picture;
    for (unsigned i = 0; i < kLags; ++i)
      head_[i] += told_at(now - i * kLag) - told_at(before.time - i * kLag);
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
  if (episode_.pairs == 0)  // with what was before it
    for (int i = bin_count_ - 1; i > 0; --i) episode_.see(bins_[static_cast<unsigned>(i)]);
  episode_.see(bins_[0]);
  if (changes) episode_.add(bins_[0], bins_[2]);
  if (changes && episode_.pairs < kLongestEpisode) return std::nullopt;
  return close_episode();
}

// Nothing: cannot be told.
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
