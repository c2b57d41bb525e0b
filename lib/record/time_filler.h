// SPDX-License-Identifier: LGPL-2.1-or-later
// Gives units that come without a time stamp the place after the one before, at the usual distance. Times are those of one
// stream, in the order of arrival. Not thread-safe.
#pragma once

#include <optional>

#include "record/unit.h"

namespace cerberus::record {

class TimeFiller {
 public:
  struct Parameters {
    // So many units without a time, from the first one on, are a stream without times. Chosen: four seconds at 25 a second. Guarded
    // by the test of a stream in which none ever comes.
    int patience = 100;
  };
  struct Times {
    std::optional<Time> presentation, decode, duration;
  };
  enum class Result {
    timed,     // it has a time of its own
    placed,    // `decode` and `presentation` are filled in, as far as the one before had them
    left_out,  // nothing tells its time
    hopeless,  // no unit of the stream has had a time, for too long
  };

  TimeFiller() : TimeFiller(Parameters{}) {}
  explicit TimeFiller(const Parameters& parameters) : parameters_(parameters) {}

  // The distance of units by the stream's format; nullopt: not known.
  void set_distance(std::optional<Time> distance) { nominal_ = distance; }
  Result fill(Times& times) {
    if (times.presentation || times.decode) {
      note(times);
      return Result::timed;
    }
    const std::optional<Time> step = distance();
    if (!step) {
      if (order(last_)) return Result::left_out;  // times come; the next one tells the distance
      return ++missed_ < parameters_.patience ? Result::left_out : Result::hopeless;
    }
    if (last_.presentation) times.presentation = *last_.presentation + *step;
    if (last_.decode) times.decode = *last_.decode + *step;
    const std::optional<Time> measured = measured_;
    note(times);
    measured_ = measured;
    return Result::placed;
  }
  // Whether units came, and none had a time.
  bool lacks_times() const { return missed_ > 0 && !order(last_); }
  // Another stream begins; its format stays.
  void reset() {
    last_ = {};
    measured_.reset();
    missed_ = 0;
  }

 private:
  static std::optional<Time> order(const Times& times) {
    return times.decode ? times.decode : times.presentation;
  }
  std::optional<Time> distance() const {
    if (!order(last_)) return std::nullopt;
    if (last_.duration && *last_.duration > Time::zero()) return last_.duration;
    return nominal_ ? nominal_ : measured_;
  }
  void note(const Times& times) {
    const std::optional<Time> before = order(last_), now = order(times);
    if (before && *now > *before) measured_ = *now - *before;
    const std::optional<Time> duration = times.duration ? times.duration : last_.duration;
    last_ = times;
    last_.duration = duration;
    missed_ = 0;
  }

  Parameters parameters_;
  std::optional<Time> nominal_, measured_;
  Times last_;
  int missed_ = 0;  // before the first time
};

}  // namespace cerberus::record
