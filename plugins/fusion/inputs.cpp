// SPDX-License-Identifier: LGPL-2.1-or-later
#include "inputs.hpp"

#include <algorithm>
#include <utility>

#include "pir_pad.hpp"
#include "settings.hpp"

namespace cerberus::plugin {
namespace {

// A PIR file is not read into memory as a whole: it stays so far ahead of the video at most.
constexpr Time kAhead = std::chrono::seconds(10);
constexpr Time kLongest = std::chrono::hours(24 * 365);  // the clock's own time must not overflow

bool is_missing(GstPad* pad, Time time) {
  const PirPad& pir = pir_pad(pad);
  return pir.linked && !pir.given_up && !pir.history.covers(time);
}

// What a pad counts as whose caps nobody has told, or a number that no pad
// has. It says nothing, so where it looks and how wide does not matter.
Reading unknown_sensor() {
  static const auto array = [] {
    auto one = std::make_shared<SensorArray>();
    one->count = 1;
    one->field_of_view = 1;
    return std::shared_ptr<const SensorArray>(std::move(one));
  }();
  Reading reading{.array = array, .values = {}};
  reading.values.fill(kInvalid);
  return reading;
}

int places_of(const PirPad& pir) {
  return std::max(pir.sensors, 1);
}

}  // namespace

bool is_named(const CerberusPose& pose, const std::string& head) {
  return head.empty() || head == pose.head;
}

void Inputs::set(bool& flag, bool value) {
  const std::lock_guard guard(lock_);
  flag = value;
  news_.notify_all();
}

void Inputs::begin_video() {
  const std::lock_guard guard(lock_);
  video_ended_ = false;
  video_ = Time::zero();
  for (GstPad* pad : pads_) pir_pad(pad).spoken.reset();
}

bool Inputs::frame_came(Time time, std::optional<guint64> max_wait, std::vector<SilentPad>& silent) {
  std::unique_lock guard(lock_);
  video_ = time;
  news_.notify_all();
  if (!max_wait || *max_wait == 0) return true;
  const auto ready = [&] {
    return flushing_ || std::ranges::none_of(pads_, [&](GstPad* pad) { return is_missing(pad, time); });
  };
  if (*max_wait == GST_CLOCK_TIME_NONE) {
    news_.wait(guard, ready);
  } else if (!news_.wait_for(guard, std::min(time_of(*max_wait), kLongest), ready)) {
    for (GstPad* pad : pads_)
      if (is_missing(pad, time)) {
        pir_pad(pad).given_up = true;
        silent.push_back({GST_PAD_NAME(pad), false});
      }
  }
  return !flushing_;
}

void Inputs::give_up_silent(Time heard, Time patience, std::vector<SilentPad>& silent) {
  const std::lock_guard guard(lock_);
  for (GstPad* pad : pads_) {
    PirPad& pir = pir_pad(pad);
    if (!pir.linked || pir.given_up || pir.live == false) continue;
    if (!pir.spoken) pir.spoken = heard;  // patience begins with the first frame
    if (heard - *pir.spoken <= patience) continue;
    pir.given_up = true;
    silent.push_back({GST_PAD_NAME(pad), pir.history.ended()});
  }
}

// The lock is held.
void Inputs::hear_sensors(Time heard, SensorSnapshot& moment) {
  moment.count = 0;
  moment.told = true;
  guint number = 0;
  for (GstPad* pad : pads_) {
    PirPad& pir = pir_pad(pad);
    for (; number < pir.index; ++number) {
      moment.add(unknown_sensor());
      moment.told = false;
    }
    ++number;
    Reading reading = pir.history.at(heard);
    pir.history.forget_before(heard);
    if (!reading.array) {
      reading = unknown_sensor();
      moment.told = false;
    }
    if (!pir.linked || pir.given_up) reading.values.fill(kInvalid);
    moment.add(reading);
  }
}

bool Inputs::flushing() {
  const std::lock_guard guard(lock_);
  return flushing_;
}

void Inputs::listen(Time heard, Time frame_time, const std::string& head, SensorSnapshot& moment) {
  const std::lock_guard guard(lock_);
  hear_sensors(heard, moment);
  const auto* pose = poses_.entry_at(heard);
  if (pose && is_named(pose->value, head) && (pose->time > frame_time || !moment.pan_on_frame))
    cerberus_pose_evaluate(&pose->value, clock_time(heard), &moment.pan_degrees, nullptr);
  if (const auto rate = base_.at(heard)) moment.base_degrees = *rate;
}

SensorSnapshot Inputs::at(Time time, Time heard, const std::string& head, bool by_event, GstBuffer* frame) {
  SensorSnapshot moment;
  const CerberusPose* on_frame = cerberus_buffer_peek_pose(frame);
  const CerberusBase* seen = cerberus_buffer_peek_base(frame);
  const std::lock_guard guard(lock_);
  hear_sensors(heard, moment);
  moment.stranger = stranger_;

  const CerberusPose* pose = on_frame && is_named(*on_frame, head) ? on_frame : nullptr;
  moment.pan_on_frame = pose != nullptr;
  if (!pose && by_event) {
    pose = poses_.at(time) ? poses_.at(time) : poses_.first();  // before the first one: where it begins
    if (pose && !is_named(*pose, head)) pose = nullptr;
  }
  if (pose) cerberus_pose_evaluate(pose, clock_time(time), &moment.pan_degrees, nullptr);
  if (const auto rate = base_.at(time)) {
    moment.base_degrees = *rate;
    moment.base_heard = true;
  } else if (seen) {
    moment.base_degrees = seen->yaw_rate;
  }
  poses_.forget_before(time);
  base_.forget_before(time);
  return moment;
}

void Inputs::hear(const CerberusPose& pose) {
  const std::lock_guard guard(lock_);
  if (poses_.last() && poses_.last()->value.head != pose.head) poses_.clear();
  poses_.insert(time_of(pose.valid_from), pose);
}

void Inputs::hear_stranger(const CerberusPose& pose) {
  const std::lock_guard guard(lock_);
  stranger_ = pose.head;
}

void Inputs::hear_base(double degrees_a_second, Time from) {
  const std::lock_guard guard(lock_);
  base_.hear(from, degrees_a_second);
}

GstPad* Inputs::add_pad(const char* name, GstPadTemplate* pad_template) {
  const std::lock_guard guard(lock_);
  const auto taken = [&](guint64 index) {
    return std::ranges::any_of(pads_, [&](GstPad* pad) { return pir_pad(pad).index == index; });
  };
  guint64 index = 0;
  if (name && g_str_has_prefix(name, "pir_") &&
      g_ascii_string_to_unsigned(name + 4, 10, 0, G_MAXUINT, &index, nullptr)) {
    if (taken(index)) return nullptr;
  } else {
    for (index = 0; taken(index);) ++index;
  }
  if (index >= sensing::kMaxSensors) return nullptr;
  GstPad* pad = pir_pad_new(("pir_" + std::to_string(index)).c_str(), pad_template, this);
  pir_pad(pad).index = static_cast<guint>(index);
  const auto after = std::ranges::find_if(pads_, [&](GstPad* each) { return pir_pad(each).index > index; });
  pads_.insert(after, pad);
  return pad;
}

void Inputs::drop_pad(GstPad* pad) {
  const std::lock_guard guard(lock_);
  std::erase(pads_, pad);
  news_.notify_all();
}

std::vector<GstPad*> Inputs::pads() {
  const std::lock_guard guard(lock_);
  std::vector<GstPad*> pads = pads_;
  for (GstPad* pad : pads) gst_object_ref(pad);
  return pads;
}

void Inputs::forget() {
  const std::lock_guard guard(lock_);
  for (GstPad* pad : pads_) pir_pad(pad).reset();
  poses_.clear();
  base_.clear();
  stranger_ = nullptr;
  video_ = Time::zero();
  video_ended_ = false;
}

void Inputs::tell(PirPad& pad, Time until) {
  pad.spoken = until;
  pad.given_up = false;
  news_.notify_all();
}

void Inputs::end(PirPad& pad) {
  pad.history.end();
  if (pad.live == false) pad.given_up = false;
  news_.notify_all();
}

int Inputs::places_besides(const PirPad& pad) const {
  int sum = 0, number = 0;
  for (GstPad* each : pads_) {
    const PirPad& pir = pir_pad(each);
    sum += static_cast<int>(pir.index) - std::exchange(number, static_cast<int>(pir.index) + 1);
    if (&pir != &pad) sum += places_of(pir);
  }
  return sum;
}

bool Inputs::wait_for_video(std::unique_lock<std::mutex>& guard, const PirPad& pad, Time time) {
  news_.wait(guard, [&] { return pad.flushing || video_ended_ || time - video_ < kAhead; });
  return !video_ended_;
}

}  // namespace cerberus::plugin
