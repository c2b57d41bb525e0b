// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/slip.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

namespace cerberus::control {

namespace {

using sensing::radians;

constexpr int kLeastEpisodes = 3, kLeastEpisodesOfScale = 5;  // of evidence, as well as kLeastTravel
constexpr double kMostGain = 1.4, kLeastGain = 0.7;           // a head that follows
constexpr double kSlipGain = 0.2, kReversedGain = -0.45;      // at most
constexpr double kAbrupt = radians(150);                      // a second squared
constexpr double kStirs = radians(1);                         // a second: a picture that jerks
constexpr double kLongestFrame = 0.5;    // seconds: between frames further apart too much can happen
constexpr int kLongestEpisode = 5;       // pairs: a speed that changes all the time is several episodes
constexpr double kRounding = 1e-3;       // seconds, of a sum of frame distances
constexpr double kSeenShare = 0.5;       // of a bin, that it counts
constexpr double kStirsOfChange = 0.03;  // how much a picture may stir more when the head changes more
constexpr double kLateShare = 0.35;      // of the picture's own change, when that comes a little late

}  // namespace

void SlipWatch::Episode::see(Bin& seen) {
  bin[static_cast<unsigned>(bins++)] = seen;
  travel += std::exchange(seen.travel, 0);
  abrupt = abrupt || seen.abrupt;
}

void SlipWatch::Episode::add(double d, double e) {
  ++pairs;
  de += d * e, ee += e * e;
  largest = std::max(largest, std::abs(e));
}

double SlipWatch::Episode::stir(double gain) const {
  double lowest = HUGE_VAL, highest = -HUGE_VAL;
  for (const Bin& b : std::span(bin).first(static_cast<unsigned>(bins))) {
    lowest = std::min(lowest, b.picture - gain * b.head);
    highest = std::max(highest, b.picture - gain * b.head);
  }
  return highest - lowest;
}

void SlipWatch::forget_frames() {
  bin_count_ = 0;
  episode_ = {};
  span_ = seen_ = picture_ = head_ = travel_ = 0;
  abrupt_ = has_rate_ = false;
}

std::optional<SlipFinding> SlipWatch::add(double seconds, double picture, double head) {
  if (!(seconds > 0 && seconds <= kLongestFrame) || !std::isfinite(head)) {
    forget_frames();
    return std::nullopt;
  }
  const double rate = head / seconds;
  abrupt_ = abrupt_ || (has_rate_ && std::abs(rate - head_rate_) > kAbrupt * seconds);
  head_rate_ = rate;
  has_rate_ = true;
  span_ += seconds;
  if (std::isfinite(picture)) {
    seen_ += seconds;
    picture_ += picture;
    head_ += head;
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
  bins_[0] = {picture_ / seen_, head_ / seen_, travel_, abrupt_};
  bin_count_ = std::min(bin_count_ + 1, static_cast<int>(bins_.size()));
  span_ = seen_ = picture_ = head_ = travel_ = 0;
  abrupt_ = false;
  if (bin_count_ < 3) return std::nullopt;

  const double e = bins_[0].head - bins_[2].head, d = bins_[0].picture - bins_[2].picture;
  const bool changes = std::abs(e) >= kLeastChange;
  if (!changes && episode_.pairs == 0) return std::nullopt;
  if (episode_.pairs == 0)  // with what was before it
    for (int i = bin_count_ - 1; i > 0; --i) episode_.see(bins_[static_cast<unsigned>(i)]);
  episode_.see(bins_[0]);
  if (changes) episode_.add(d, e);
  if (changes && episode_.pairs < kLongestEpisode) return std::nullopt;
  return close_episode();
}

// Nothing: cannot be told.
std::optional<SlipFault> SlipWatch::judge(const Episode& e) {
  const double gain = e.de / e.ee;
  if (gain >= kLeastGain && gain <= kMostGain) return SlipFault::none;
  if (gain <= kReversedGain) return SlipFault::reversed;
  if (gain < -kSlipGain) return std::nullopt;
  const double late = e.abrupt ? kLateShare * std::abs(gain) : 0;
  if (e.stir(gain) > kStirs + (kStirsOfChange + late) * e.largest) return std::nullopt;
  return std::abs(gain) > kSlipGain ? SlipFault::scale : SlipFault::slips;
}

std::optional<SlipFinding> SlipWatch::close_episode() {
  const Episode episode = std::exchange(episode_, {});
  const auto verdict = judge(episode);
  if (!verdict) return std::nullopt;
  const double gain = episode.de / episode.ee;
  if (run_.episodes == 0 || run_.fault != *verdict) run_ = {*verdict};
  ++run_.episodes;
  run_.gains += gain;
  run_.travel += episode.travel;
  const int least = run_.fault == SlipFault::scale ? kLeastEpisodesOfScale : kLeastEpisodes;
  if (run_.episodes < least || run_.travel < kLeastTravel || run_.fault == fault_) return std::nullopt;
  fault_ = run_.fault;
  if (fault_ == SlipFault::none) return std::nullopt;
  return SlipFinding{fault_, run_.gains / run_.episodes, run_.travel};
}

}  // namespace cerberus::control
