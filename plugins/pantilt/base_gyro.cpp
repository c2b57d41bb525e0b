// SPDX-License-Identifier: LGPL-2.1-or-later
#include "base_gyro.hpp"

#include <cerberus/cerberus.h>

#include "cerberus/private/messages.hpp"
#include "shared/camera_mount.hpp"
#include "shared/clock_times.hpp"

namespace cerberus::plugin {

namespace {

void report(GstBaseSink* sink, const drivers::SensorError& error, bool final) {
  if (final)
    CERBERUS_ELEMENT_ERROR(sink, RESOURCE, OPEN_READ, (error.text), (error.detail));
  else if (error)
    CERBERUS_ELEMENT_WARNING(
        sink, RESOURCE, READ,
        ("%s The base's rate is that of the picture until it works again.", error.text.c_str()),
        (error.detail));
  else
    CERBERUS_ELEMENT_INFO(sink, RESOURCE, READ, ("The base's gyro works again."), (nullptr));
}

}  // namespace

bool BaseGyro::start(GstBaseSink* sink, const std::string& which) {
  if (which.empty()) return true;
  drivers::GyroSetup setup;
  if (const std::string wrong = drivers::parse_gyro(which, setup); !wrong.empty()) {
    CERBERUS_ELEMENT_ERROR(sink, RESOURCE, SETTINGS, (wrong + " (base-gyro)."), (nullptr));
    return false;
  }
  sink_ = sink;
  bias_.reset();
  runner_.start(setup, {.on_rate = [this](double rate) { publish(rate); },
                        .on_change = [sink](const auto& error, bool final) { report(sink, error, final); }});
  return true;
}

void BaseGyro::stop() {
  runner_.stop();
  sink_ = nullptr;
}

void BaseGyro::publish(double measured) {
  const auto now = clock_now(sink_);
  if (!now) return;
  std::optional<double> rate;
  {
    const std::lock_guard guard(lock_);
    rate = bias_.add(*now, measured);
  }
  if (!rate) return;
  CerberusBase base;
  cerberus_base_init(&base);
  base.yaw_rate = degrees(*rate);
  base.valid_from = clock_time(*now);
  gst_pad_push_event(GST_BASE_SINK_PAD(sink_), cerberus_event_new_base(&base));
}

void BaseGyro::on_frame(GstBuffer* buffer, std::optional<control::PictureMotion> motion,
                        const vision::Lens& lens, motion::Time taken) {
  if (!sink_) return;
  const CerberusPose* pose = cerberus_buffer_peek_pose(buffer);
  const auto look = look_of(buffer, clock_time(taken)).value_or(motion::PanTilt{});
  if (motion) motion->base_yaw = 0;  // it is asked whether the base stands
  const auto turn = motion ? control::head_turn(*motion, lens, look) : std::nullopt;
  const std::lock_guard guard(lock_);
  bias_.frame(taken, turn, !pose || !pose->moving);
}

void BaseGyro::on_event(GstEvent* event) {
  g_autoptr(CerberusBase) base = sink_ ? cerberus_event_parse_base(event) : nullptr;
  if (!base) return;
  const std::lock_guard guard(lock_);
  bias_.robot(time_of(base->valid_from), radians(base->yaw_rate));
}

}  // namespace cerberus::plugin
