// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/frame_history.h"

#include <algorithm>

namespace cerberus::vision {
namespace {

double seconds_between(FrameHistory::Time from, FrameHistory::Time to) {
  return static_cast<double>((to - from).count()) / 1e9;
}

FrameHistory::Time duration(double seconds) {
  return FrameHistory::Time(static_cast<FrameHistory::Time::rep>(seconds * 1e9));
}

}  // namespace

void FrameHistory::lose() {
  if (++lost_ > parameters_.lost_pictures) drop();
}

std::optional<FrameHistory::Repeated> FrameHistory::repeat(std::optional<Time> time, double nominal,
                                                           bool damaged, bool confirmed) {
  if (!any_) return std::nullopt;
  ++repeats_;
  damage_ |= damaged;
  const double even = usual_ > 0 ? usual_ : nominal > 0 ? nominal : parameters_.unknown_distance;
  if (is_outlier(time, even, confirmed)) time = *shown_ + duration(even);
  shown_ = time;
  if (time && previous_ && *time > *previous_) {
    const double seconds = seconds_between(*previous_, *time);
    held_ =
        std::max(held_, std::min(seconds, damaged ? parameters_.longest_damage : parameters_.longest_repeat));
    return Repeated{seconds, time};
  }
  return Repeated{repeats_ * even, time};
}

void FrameHistory::begin_picture(std::optional<Time> time) {
  any_ = true;
  lost_ = repeats_ = 0;
  held_ = 0;
  damage_ = false;
  previous_ = shown_ = time;
}

// Decides whether the time of this frame is wrong by itself. Counts such frames in a row: call it once for each frame.
// rhythm: usual distance of the stream's frames, seconds. known_right: the source or a clock says so.
bool FrameHistory::is_outlier(std::optional<Time> time, double rhythm, bool known_right) {
  const double step = any_ && shown_ && time ? seconds_between(*shown_, *time) : 0;
  const double gap = std::max(parameters_.gap_seconds, parameters_.gap_factor * rhythm);
  const double least = distrusted_ ? gap : parameters_.outlier_factor * rhythm;
  const bool far =
      !known_right && (step > std::max(distrusted_ ? gap : parameters_.outlier_forwards, least) ||
                       -step > std::max(distrusted_ ? gap : parameters_.outlier_backwards, least));
  outliers_ = far ? outliers_ + 1 : 0;
  if (outliers_ <= parameters_.outliers) return far;
  outliers_ = 0;
  return false;
}

// Where the times go on from before a time that has ended the scene, that one was wrong, and more like it are to be
// expected. What was learnt from it is forgotten.
void FrameHistory::take_back(std::optional<Time> time) {
  if (!ended_) return;
  const double even = ended_->usual > 0 ? ended_->usual : parameters_.unknown_distance;
  const double since = time ? seconds_between(ended_->at, *time) : 0;
  const bool on = since > 0 && since <= std::max(parameters_.gap_seconds, parameters_.gap_factor * even);
  if (on) {
    distrusted_ = true;
    usual_ = ended_->usual;
    previous_ = shown_ = stamp_ = clock_ = *time - duration(even);
    late_ = 0;
  }
  if (on || ++ended_->frames > parameters_.outliers) ended_.reset();
}

// A frame whose time is an outlier.
FrameHistory::Step FrameHistory::pass_over(Time time, double even) {
  Step step;
  step.fresh = false;
  step.backwards = stamp_ && time < *stamp_;
  step.previous = previous_;
  step.time = *shown_ + duration((1 + lost_) * even);
  step.seconds = previous_ ? seconds_between(*previous_, *step.time) : (1 + lost_ + repeats_) * even;
  clock_ += duration(step.seconds);
  begin_picture(step.time);
  return step;
}

FrameHistory::Step FrameHistory::next(std::optional<Time> time, double nominal, bool marked, bool confirmed) {
  if (!any_) usual_ = 0;  // the rhythm of a new scene is learnt anew
  if (!any_ || marked) ended_.reset();
  take_back(time);
  const double rhythm = usual_ > 0 ? usual_ : nominal;
  const double even = rhythm > 0 ? rhythm : parameters_.unknown_distance;
  if (is_outlier(time, even, marked || confirmed)) return pass_over(*time, even);
  const std::optional<Ended> last = shown_ ? std::optional(Ended{*shown_, usual_}) : std::nullopt;
  Step step;
  step.time = time;
  step.backwards = any_ && time && stamp_ && *time < *stamp_;
  if (step.backwards &&
      seconds_between(*time, *stamp_) > std::max(parameters_.gap_seconds, parameters_.gap_factor * rhythm))
    usual_ = 0;
  else if (any_)
    follow(step, time, rhythm);
  step.broken = any_ && step.fresh;
  if (step.broken) ended_ = last;
  ordered_ = time && (step.fresh || (ordered_ && !step.backwards && late_ == 0));
  step.repeatable = !step.fresh && ordered_ && step.seconds <= parameters_.longest_repeat;
  if (step.fresh) {
    stamp_.reset();
    late_ = 0;
  }
  begin_picture(time);
  if (!time) return step;
  stamp_ = time;
  if (late_ == 0) clock_ = *time;
  return step;
}

// A stream without timestamps, one that loses them, and one whose stamps step back a little are taken as evenly spaced:
// there is no other information. After a step back the clock advances by the assumed steps, so that they add up to the
// time of the stamps once these are in order again.
void FrameHistory::follow(Step& step, std::optional<Time> time, double rhythm) {
  const double even = (1 + lost_ + repeats_) * rhythm;
  step.fresh = false;
  step.previous = previous_;
  step.seconds = even;
  if (!time || !previous_) {
    late_ = 0;
    return;
  }
  const double seconds = *time > clock_ ? seconds_between(clock_, *time) : 0;
  if (seconds <= std::max(parameters_.least_seconds, late_ > 0 ? even / 4 : 0)) {
    clock_ += duration(even);
    if (++late_ > parameters_.late_frames) late_ = 0;
    return;
  }
  step.seconds = seconds;
  step.fresh = rhythm > 0 && (seconds - held_) / (1 + lost_) >
                                 std::max(parameters_.gap_seconds, parameters_.gap_factor * rhythm);
  if (step.fresh) {
    usual_ = seconds;  // caps that promise more frames than come must not make every frame a gap
    step.seconds = 0;
    step.previous.reset();
  } else if (late_ == 0 && !damage_) {  // the distance across damage is not the stream's own
    if (usual_ <= 0) usual_ = rhythm > 0 ? rhythm : seconds;
    // Faster is believed at once, so that a long distance learnt from a gap does not excuse the next gap.
    usual_ = seconds * parameters_.gap_factor < usual_ ? seconds
                                                       : usual_ + parameters_.smoothing * (seconds - usual_);
  }
  late_ = 0;
}

bool FrameHistory::misses_frames(std::optional<Time> time, double nominal) const {
  if (!any_ || !time || !shown_ || *time < *shown_) return false;
  const double expected = nominal > 0 ? nominal : usual_;
  return expected > 0 && seconds_between(*shown_, *time) > parameters_.missing_factor * expected;
}

}  // namespace cerberus::vision
