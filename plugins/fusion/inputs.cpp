// SPDX-License-Identifier: LGPL-2.1-or-later
#include "inputs.hpp"

#include <cmath>

#include "pir_pad.hpp"
#include "shared/camera_mount.hpp"
#include "shared/clock_times.hpp"

namespace cerberus::plugin {

static_assert(sensing::kBaseLifetime == std::chrono::nanoseconds(CERBERUS_BASE_LIFETIME));

bool is_named(const CerberusPose& pose, const std::string& head) {
  return head.empty() || head == pose.head;
}

namespace {

void read_pose(const CerberusPose& pose, Time time, SensorSnapshot& snapshot) {
  cerberus_pose_evaluate(&pose, clock_time(time), &snapshot.pan_degrees, nullptr);
  snapshot.lens = field_of_view_of(pose);
}

}  // namespace

void Inputs::listen(Time sensor_time, Time frame_time, const std::string& head, SensorSnapshot& snapshot) {
  const std::lock_guard guard(lock_);
  read(sensor_time, snapshot);
  const auto* pose = poses_.entry_at(sensor_time);
  if (pose && is_named(pose->value, head) && (pose->time > frame_time || !snapshot.pan_on_frame))
    read_pose(pose->value, sensor_time, snapshot);
  if (const auto rate = base_rates_.at(sensor_time)) snapshot.base_degrees = *rate;
  snapshot.base_speed = base_speeds_.at(sensor_time).value_or(fusion::kUnknown);
}

SensorSnapshot Inputs::at(Time time, Time sensor_time, const std::string& head, bool by_event,
                          GstBuffer* frame) {
  SensorSnapshot snapshot;
  const CerberusPose* on_frame = cerberus_buffer_peek_pose(frame);
  const CerberusBase* seen = cerberus_buffer_peek_base(frame);
  const std::lock_guard guard(lock_);
  read(sensor_time, snapshot);
  snapshot.other_head = other_head_;

  const CerberusPose* pose = on_frame && is_named(*on_frame, head) ? on_frame : nullptr;
  snapshot.pan_on_frame = pose != nullptr;
  // A repeated picture shows the scene as it was when the last new picture was taken.
  if (!GST_BUFFER_FLAG_IS_SET(frame, GST_BUFFER_FLAG_GAP) || taken_ > time) taken_ = time;
  if (!pose && by_event) {
    pose = poses_.at(taken_) ? poses_.at(taken_) : poses_.first();  // before the first one: where it begins
    if (pose && !is_named(*pose, head)) pose = nullptr;
  }
  if (pose) read_pose(*pose, taken_, snapshot);
  if (const auto rate = base_rates_.at(time)) {
    snapshot.base_degrees = *rate;
    snapshot.base_received = true;
  } else if (seen) {
    snapshot.base_degrees = seen->yaw_rate;
  }
  snapshot.base_speed = base_speeds_.at(time).value_or(seen ? seen->speed : fusion::kUnknown);
  poses_.forget_before(taken_);
  base_rates_.forget_before(time);
  base_speeds_.forget_before(time);
  return snapshot;
}

void Inputs::add_pose(const CerberusPose& pose) {
  const std::lock_guard guard(lock_);
  if (poses_.last() && poses_.last()->value.head != pose.head) poses_.clear();
  poses_.insert(time_of(pose.valid_from), pose);
}

void Inputs::add_other_head(const CerberusPose& pose) {
  const std::lock_guard guard(lock_);
  other_head_ = pose.head;
}

void Inputs::add_base(double degrees_a_second, double speed, Time from) {
  const std::lock_guard guard(lock_);
  if (std::isfinite(degrees_a_second)) base_rates_.add(from, degrees_a_second);
  if (std::isfinite(speed)) base_speeds_.add(from, speed);
}

GstPad* Inputs::add_pad(const char* name, GstPadTemplate* pad_template) {
  const std::lock_guard guard(lock_);
  guint64 number = 0;
  const bool numbered = name && g_str_has_prefix(name, "pir_") &&
                        g_ascii_string_to_unsigned(name + 4, 10, 0, G_MAXUINT, &number, nullptr);
  const auto index = free_place(numbered ? std::optional<std::uint64_t>(number) : std::nullopt);
  if (!index) return nullptr;
  GstPad* pad = pir_pad_new(*index, pad_template, this);
  add(pir_pad(pad));
  return pad;
}

void Inputs::drop_pad(GstPad* pad) {
  const std::lock_guard guard(lock_);
  drop(pir_pad(pad));
}

std::vector<GstPad*> Inputs::pads() {
  const std::lock_guard guard(lock_);
  std::vector<GstPad*> pads;
  for (fusion::SensorSource* source : sources_)
    pads.push_back(GST_PAD(gst_object_ref(static_cast<PirPad*>(source)->pad)));
  return pads;
}

void Inputs::forget() {
  const std::lock_guard guard(lock_);
  for (fusion::SensorSource* source : sources_) static_cast<PirPad*>(source)->reset();
  poses_.clear();
  base_rates_.clear();
  base_speeds_.clear();
  other_head_ = nullptr;
  SensorInputs::forget();
}

}  // namespace cerberus::plugin
