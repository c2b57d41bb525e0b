// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/helper/helper_watch.h"

#include <algorithm>
#include <utility>

#include "text/numbers.h"

namespace cerberus::drivers {
namespace {

std::string span(Time time) {
  return text::significant(motion::seconds(time), 3).string() + " s";
}

}  // namespace

void HelperWatch::begin(Time now) {
  *this = HelperWatch(parameters_);
  last_ = now;
}

void HelperWatch::take(const HelperLine& line) {
  if (const auto* ready = std::get_if<ReadyLine>(&line)) {
    ready_ = true;
    alive_ = ready->abilities.alive;
    feedback_ = ready->abilities.feedback && !alive_;
    asked_ = false;  // what was sent before may have been skipped
    waited_ = {};
  } else if (std::get_if<AliveLine>(&line)) {
    asked_ = false;
    waited_ = {};
  } else if (!alive_ && std::get_if<PoseLine>(&line)) {
    owes_ = false;
    waited_ = {};
  }
}

std::string HelperWatch::judge(Time now, bool turning) {
  owes_ = owes_ || turning;
  const Time step = std::min(now - std::exchange(last_, now), Time(kMostStep));
  if (!waits()) waited_ = {};
  if (waits()) waited_ += step;
  if (!ready_ && waited_ > parameters_.start) return "it has not become ready for " + span(parameters_.start);
  if (alive_ && waited_ > parameters_.answer)
    return "it has not answered `alive` for " + span(parameters_.answer);
  if (feedback_ && waited_ > parameters_.feedback)
    return "it has sent no `pose` for " + span(parameters_.feedback) +
           (turning ? " while its head was to turn" : " after its head was to turn");
  return {};
}

}  // namespace cerberus::drivers
