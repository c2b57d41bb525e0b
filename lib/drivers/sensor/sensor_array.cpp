// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/sensor/sensor_array.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "drivers/sensor/sensor_runner.h"

namespace cerberus::drivers {

using sensing::kNever;

SensorArray::SensorArray() = default;
SensorArray::~SensorArray() = default;

SensorError SensorArray::open(std::unique_ptr<Sensor> sensor, const SensorSetup& setup,
                              const sensing::PirOptions& options, Time heartbeat, Patience patience,
                              std::function<void()> refused) {
  close();
  const auto count = static_cast<std::size_t>(std::clamp(setup.sensors, 1, sensing::kMaxSensors));
  options_ = options;
  models_.assign(count, sensing::PirModel(options));
  faults_.assign(count, sensing::PirFault::none);
  edges_.reserve(1024);
  heartbeat_ = std::max(heartbeat, Time(1));
  volts_.fill(std::numeric_limits<float>::quiet_NaN());
  recorded_ = sensor->recorded();
  if (sensor->opens_at_once(setup)) {
    error_ = sensor->open(setup);
    if (!error_) begin(std::move(sensor));
  } else {
    opening_ = std::make_unique<SensorRunner>();
    opening_->begin(std::move(sensor), setup, std::move(refused));
    opening_->opened(patience);
    opened();
  }
  if (!error_) return {};
  SensorError error = error_;
  close();
  return error;
}

bool SensorArray::opened() {
  if (!opening_) return true;
  if (!opening_->opened()) return false;
  auto runner = std::move(opening_);
  error_ = runner->error();
  if (error_) return true;
  if (auto recording = runner->recording())
    begin(std::move(recording));
  else
    begin(std::move(runner));
  return true;
}

void SensorArray::begin(std::unique_ptr<Sensor> sensor) {
  sensor_ = std::move(sensor);
  recorded_ = sensor_->recorded();
  // The last line of a recording takes effect only after the debounce time.
  end_ = sensor_->end();
  if (end_ < kNever) end_ += models_.front().options().debounce;
  if (recorded_) seek(start_);
}

SensorError SensorArray::error() const {
  return opening_ && opening_->opened() ? opening_->error() : error_;
}

std::optional<std::string> SensorArray::outage_change() {
  std::string now = sensor_ ? sensor_->outage() : std::string();
  if (now == outage_) return std::nullopt;
  outage_ = now;
  return now;
}

int SensorArray::fd() const {
  if (opening_) return opening_->fd();
  return sensor_ ? sensor_->fd() : -1;
}

void SensorArray::close() noexcept {
  opening_.reset();
  if (sensor_) sensor_->close();
  sensor_.reset();
  recorded_ = false;
  start_ = {};
  models_.clear();
  faults_.clear();
  edges_.clear();
  next_edge_ = 0;
  last_ = {};
  error_ = {};
  outage_.clear();
  beat_ = {};
  report_samples_ = sampled_ = false;
  begun_ = false;
}

// From now on nothing is known of the line. A sensor that restarts warms up again.
void SensorArray::begin_again(sensing::PirModel& model, bool restarts) const {
  sensing::PirOptions options = options_;
  // The warm-up of a recorded sensor is over where its recorded readings are valid.
  if (recorded_) options.warm_up = Time();
  if (restarts || recorded_)
    model = sensing::PirModel(options);
  else
    model.forget_level();
}

Time SensorArray::deadline() const {
  Time due = kNever;
  for (const auto& model : models_) due = std::min(due, model.deadline());
  return due;
}

Time SensorArray::due() const {
  if (!sensor_ && !opening_) return kNever;
  const Time queued = next_edge_ < edges_.size() ? edges_[next_edge_].time : kNever;
  const Time recorded = sensor_ ? sensor_->next() : kNever;
  return std::max(last_.time, std::min({queued, recorded, deadline(), beat_}));
}

void SensorArray::let_pass(Time until) {
  for (; next_edge_ < edges_.size() && edges_[next_edge_].time <= until; ++next_edge_) {
    const SensorEdge& edge = edges_[next_edge_];
    if (edge.sensor < 0 || edge.sensor >= count()) continue;
    sensing::PirModel& model = models_[static_cast<std::size_t>(edge.sensor)];
    if (edge.known)
      model.edge(edge.time, edge.level);
    else
      begin_again(model, edge.restarts);
    if (edge.known && std::isnan(edge.volts)) continue;
    volts_[static_cast<std::size_t>(edge.sensor)] = edge.known ? edge.volts : std::nan("");
    sampled_ = true;
  }
  if (next_edge_ == edges_.size()) {
    edges_.clear();
    next_edge_ = 0;
  }
  for (auto& model : models_) model.poll(until);
}

// Takes the models' state as the reading of `time`. True: it is news.
bool SensorArray::look(Time time, SensorReading& reading) {
  reading = {};
  reading.time = std::max(time, last_.time);
  reading.volts = volts_;
  for (std::size_t i = 0; i < models_.size(); ++i) {
    const auto bit = static_cast<sensing::SensorBits>(1U << i);
    reading.presence[i] = models_[i].presence();
    if (models_[i].doubtful()) reading.doubtful |= bit;
    if (models_[i].fault() != faults_[i]) reading.faulty |= bit;
  }
  reading.changed = !begun_ || reading.presence != last_.presence || reading.doubtful != last_.doubtful ||
                    reading.faulty != 0;
  return reading.changed;
}

// Reports all sensors as invalid after a read error, so that a head does not search a sector for ever.
SensorArray::Step SensorArray::fail(SensorError error, Time now, SensorReading& reading) {
  error_ = std::move(error);
  if (!begun_) return Step::failed;
  reading = {};
  reading.time = std::max(now, last_.time);
  reading.presence.fill(sensing::Presence::invalid);
  reading.volts.fill(std::numeric_limits<float>::quiet_NaN());
  reading.changed = true;
  return Step::reading;
}

SensorArray::Step SensorArray::next(Time now, SensorReading& reading) {
  const bool open = opened();
  if (error_ || (open && !sensor_)) return Step::failed;
  if (open)
    if (SensorError error = sensor_->read(now, edges_)) return fail(std::move(error), now, reading);
  if (!begun_) {
    let_pass(now);  // edges before the first reading are not reported
    beat_ = now;
  }
  for (;;) {
    const Time time = due();
    if (open && recorded() && begun_ && time > end_) return now >= end_ ? Step::ended : Step::wait;
    if (time > now) return Step::wait;
    let_pass(time);
    const bool sampled = std::exchange(sampled_, false) && report_samples_;
    if (!look(time, reading) && time < beat_ && !sampled) continue;
    if (time >= beat_)
      beat_ += ((now - beat_) / heartbeat_ + 1) * heartbeat_;  // those that were missed are not made up for
    begun_ = true;
    last_ = reading;
    for (std::size_t i = 0; i < models_.size(); ++i) faults_[i] = models_[i].fault();
    if (!reading.changed || !open) return Step::reading;
    SensorError error = sensor_->show(std::span(reading.presence).first(models_.size()));
    return error ? fail(std::move(error), now, reading) : Step::reading;
  }
}

void SensorArray::seek(Time start) {
  if (!recorded()) return;
  start_ = start;  // if they are being opened
  if (!sensor_) return;
  sensor_->rewind();
  for (auto& model : models_) model = sensing::PirModel(options_);
  std::ranges::fill(faults_, sensing::PirFault::none);
  edges_.clear();
  next_edge_ = 0;
  volts_.fill(std::numeric_limits<float>::quiet_NaN());
  last_ = {};
  last_.time = beat_ = start;
  error_ = {};
  begun_ = sampled_ = false;
}

void SensorArray::base(Time time, const sensing::Geometry& geometry, const sensing::BodyMotion& motion) {
  const int known = std::min(count(), geometry.count());
  for (int i = 0; i < known; ++i)
    models_[static_cast<std::size_t>(i)].base(time, sensing::passing_rate(geometry.sector(i), motion));
}

}  // namespace cerberus::drivers
