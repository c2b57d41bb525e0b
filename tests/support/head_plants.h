// SPDX-License-Identifier: LGPL-2.1-or-later
// Drivers of real heads with a plant each, in a test's own time: the plant derives the head's angles from what was
// written to the hardware (edges of lines, pulse widths, controls) or sent to the emulated camera.
#pragma once

#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "drivers/head/inverted_head.h"
#include "drivers/pelco/pelco_head.h"
#include "drivers/servo/servo_head.h"
#include "drivers/stepper/stepper_head.h"
#include "drivers/v4l2/v4l2_head.h"
#include "drivers/visca/visca_head.h"
#include "support/fake_lines.h"
#include "support/pelco_camera.h"
#include "support/stepped_time.h"
#include "support/visca_camera.h"

namespace cerberus::tests {

using motion::Time;

struct HeadPlant {
  virtual ~HeadPlant() = default;
  virtual drivers::HeadDevice& device() = 0;
  virtual void elapse(Time now) = 0;        // the hardware's own motion until `now`
  virtual double pan() const = 0;           // degrees
  virtual double tilt() const = 0;          // degrees
  virtual double precision() const = 0;     // degrees: how near a move ends to its target
  virtual bool powered() const = 0;         // something moves pan, or could
  virtual std::size_t actions() const = 0;  // edges, writes or messages that arrived at the hardware
  virtual void unplug() {}                  // the hardware is gone until plug()
  virtual void plug() {}
};

inline void must(const std::string& wrong) {
  if (wrong.empty()) return;
  std::fprintf(stderr, "%s\n", wrong.c_str());
  std::abort();
}

struct StepperPlant final : HeadPlant {
  FakeLines lines, replayed;
  CoilMotor motor, tilt_motor{4};
  std::size_t seen = 0;
  std::optional<drivers::StepperHead> head;
  StepperPlant() {
    drivers::StepperOptions options;
    options.chip = "chip0";
    must(drivers::parse_stepper_axis("lines=1,2,3,4", options.pan));
    must(drivers::parse_stepper_axis("lines=5,6,7,8", options.tilt));
    head.emplace(options, std::make_unique<FakePort>(lines));
  }
  drivers::HeadDevice& device() override { return *head; }
  void elapse(Time now) override {
    for (; seen < lines.edges.size(); ++seen) {
      replayed.levels.resize(8);
      replayed.levels[lines.edges[seen].line] = lines.edges[seen].level;
      const bool last_one =
          seen + 1 == lines.edges.size() || lines.edges[seen + 1].time != lines.edges[seen].time;
      if (last_one) motor.follow(replayed);
      if (last_one) tilt_motor.follow(replayed);
    }
    lines.now = now;
  }
  double pan() const override { return motor.half_steps() * 360 / 4075.7728395; }
  double tilt() const override { return tilt_motor.half_steps() * 360 / 4075.7728395; }
  double precision() const override { return 0.0883; }
  std::size_t actions() const override { return lines.edges.size(); }
  bool powered() const override { return std::count(lines.levels.begin(), lines.levels.end(), true) > 0; }
  void unplug() override {
    lines.set_error = lines.get_error = lines.probe_error = ENODEV;
    lines.open_error = "There is no GPIO chip \"chip0\"";
  }
  void plug() override {
    lines.set_error = lines.get_error = lines.probe_error = 0;
    lines.open_error.clear();
  }
};

struct ServoPlant final : HeadPlant {
  std::string folder;
  std::optional<drivers::ServoHead> head;
  double angle = 0, tilt_angle = 0;
  int pan_width_fd = -1, tilt_width_fd = -1, pan_enable_fd = -1, tilt_enable_fd = -1;
  std::size_t changes = 0;
  long widths = 0;
  ServoPlant() {
    char name[] = "/tmp/cerberus-pwm-XXXXXX";
    folder = ::mkdtemp(name);
    ServoPlant::plug();
    drivers::ServoOptions options;
    options.chip = folder;
    must(drivers::parse_servo_axis("channel=0 pulse=500,2500 range=-180,180", options.pan));
    must(drivers::parse_servo_axis("channel=1 pulse=1000,2000 range=-90,90", options.tilt));
    head.emplace(options);
  }
  ~ServoPlant() override {
    head.reset();
    ServoPlant::unplug();
  }
  void plug() override {
    ::mkdir(folder.c_str(), 0755);
    for (const char* channel : {"/pwm0", "/pwm1"}) {
      ::mkdir((folder + channel).c_str(), 0755);
      for (const char* file : {"/period", "/duty_cycle", "/enable"})
        std::ofstream(folder + channel + file) << "0\n";
    }
    const auto open = [this](const char* file) {
      return ::open((folder + file).c_str(), O_RDONLY | O_CLOEXEC);
    };
    pan_width_fd = open("/pwm0/duty_cycle");
    tilt_width_fd = open("/pwm1/duty_cycle");
    pan_enable_fd = open("/pwm0/enable");
    tilt_enable_fd = open("/pwm1/enable");
  }
  void unplug() override {
    for (int* fd : {&pan_width_fd, &tilt_width_fd, &pan_enable_fd, &tilt_enable_fd})
      ::close(std::exchange(*fd, -1));
    std::filesystem::remove_all(folder);
  }
  static long read(int fd) {
    char text[32] = {};
    return ::pread(fd, text, sizeof text - 1, 0) > 0 ? std::atol(text) : 0;
  }
  drivers::HeadDevice& device() override { return *head; }
  void elapse(Time) override {
    const long width = read(pan_width_fd), tilt_width = read(tilt_width_fd);
    if (read(pan_enable_fd) == 1 && width > 0) angle = static_cast<double>(width - 1500000) * 180 / 1e6;
    if (read(tilt_enable_fd) == 1 && tilt_width > 0)
      tilt_angle = static_cast<double>(tilt_width - 1500000) * 90 / 5e5;
    if (std::exchange(widths, width + tilt_width) != width + tilt_width) ++changes;
  }
  double pan() const override { return angle; }
  double tilt() const override { return tilt_angle; }
  std::size_t actions() const override { return changes; }
  double precision() const override { return 0.01; }
  bool powered() const override { return read(pan_enable_fd) == 1; }
};

// A camera that goes to angles at 100 degrees a second; tests/unit/v4l2_head.cpp has what cameras do wrong.
struct CameraPlant final : HeadPlant, drivers::CameraControls {
  struct Axis {
    std::int32_t wanted = 0;  // arc-seconds
    double angle = 0;
  };
  struct Coming {
    Time due{};
    Axis* axis;
    std::int32_t value;
  };
  Axis pan_axis, tilt_axis;
  Time at{}, delay;
  std::deque<Coming> coming;  // written, and not obeyed yet
  std::size_t writes = 0;
  bool reports = true;  // its positions can be read
  bool gone = false;
  std::optional<drivers::V4l2Head> head;
  struct Lent final : drivers::CameraControls {
    CameraPlant& plant;
    explicit Lent(CameraPlant& p) : plant(p) {}
    int open(const std::string& name) override { return plant.open(name); }
    void close() noexcept override {}
    std::optional<drivers::ControlRange> query(std::uint32_t id) override { return plant.query(id); }
    int get(std::uint32_t id, std::int32_t& value) noexcept override { return plant.get(id, value); }
    int set(std::uint32_t id, std::int32_t value) noexcept override { return plant.set(id, value); }
    int probe() noexcept override { return plant.probe(); }
  };
  // Looks along these angles (degrees) at the start. dead_time: from a write until it is obeyed.
  explicit CameraPlant(double pan = 0, double tilt = 0, Time dead_time = {}) : delay(dead_time) {
    for (const auto& [axis, angle] : {std::pair{&pan_axis, pan}, std::pair{&tilt_axis, tilt}}) {
      axis->wanted = static_cast<std::int32_t>(std::lround(angle * 10)) * 360;
      axis->angle = axis->wanted;
    }
    drivers::V4l2Options options;
    options.device = "/dev/video9";
    head.emplace(options, std::make_unique<Lent>(*this));
  }
  int open(const std::string&) override { return gone ? ENOENT : 0; }
  int probe() noexcept override { return gone ? ENODEV : 0; }
  void unplug() override { gone = true; }
  void plug() override { gone = false; }
  void close() noexcept override {}
  std::optional<drivers::ControlRange> query(std::uint32_t id) override {
    if (id == drivers::camera_control::kPanAbsolute || id == drivers::camera_control::kTiltAbsolute)
      return drivers::ControlRange{-648000, 648000, 360};
    return std::nullopt;
  }
  Axis& axis(std::uint32_t id) { return id == drivers::camera_control::kPanAbsolute ? pan_axis : tilt_axis; }
  int get(std::uint32_t id, std::int32_t& value) noexcept override {
    if (gone || !reports) return gone ? ENODEV : EACCES;
    value = static_cast<std::int32_t>(std::lround(axis(id).angle));
    return 0;
  }
  int set(std::uint32_t id, std::int32_t value) noexcept override {
    if (gone) return ENODEV;
    coming.push_back({at + delay, &axis(id), value});
    obey(at);
    ++writes;
    return 0;
  }
  drivers::HeadDevice& device() override { return *head; }
  void obey(Time now) {
    for (; !coming.empty() && coming.front().due <= now; coming.pop_front())
      coming.front().axis->wanted = coming.front().value;
  }
  void elapse(Time now) override {
    obey(now);
    const double most = motion::seconds(now - at) * 100 * 3600;
    for (Axis* axis : {&pan_axis, &tilt_axis})
      axis->angle += std::clamp(axis->wanted - axis->angle, -most, most);
    at = now;
  }
  double pan() const override { return pan_axis.angle / 3600; }
  double tilt() const override { return tilt_axis.angle / 3600; }
  double precision() const override { return 0.1; }
  std::size_t actions() const override { return writes; }
  bool powered() const override { return std::lround(pan_axis.angle) != pan_axis.wanted; }
};

// Heads that only turn at speeds, behind their protocols on loopback.
struct PelcoPlant final : HeadPlant {
  SteppedTime time;
  mutable PelcoCamera camera;
  std::optional<drivers::PelcoHead> head;
  explicit PelcoPlant(std::chrono::milliseconds dead_time = {}) : camera(dead_time, time) {
    drivers::PelcoOptions options;
    options.device = camera.device();
    head.emplace(options);
  }
  drivers::HeadDevice& device() override { return *head; }
  void elapse(Time now) override {
    camera.step();
    time.set(now);
  }
  double pan() const override { return camera.pan(); }
  double tilt() const override { return camera.tilt(); }
  double precision() const override { return 1.5; }
  std::size_t actions() const override { return static_cast<std::size_t>(camera.frames()); }
  bool powered() const override { return camera.speed() != 0; }
};

struct ViscaPlant final : HeadPlant {
  SteppedTime time;
  mutable ViscaCamera camera;
  std::optional<drivers::ViscaHead> head;
  explicit ViscaPlant(std::chrono::milliseconds dead_time = {})
      : ViscaPlant(ViscaFaults{.reports = false, .dead_time = dead_time}) {}
  // Without position inquiries: the driver would wait for the first answer in real time.
  explicit ViscaPlant(const ViscaFaults& faults, bool feedback = false,
                      std::optional<std::uint32_t> sequence = {},
                      std::function<void(const std::string&)> warn = {})
      : camera(ViscaCamera::Line::udp, faults, &time) {
    drivers::ViscaOptions options;
    options.device = camera.device();
    options.header = faults.header;
    options.feedback = feedback;
    options.sequence = sequence;
    options.warn = std::move(warn);
    head.emplace(options);
  }
  drivers::HeadDevice& device() override { return *head; }
  void elapse(Time now) override {
    camera.step();
    time.set(now);
    camera.step();
  }
  double pan() const override { return camera.pan(); }
  double tilt() const override { return camera.tilt(); }
  double precision() const override { return 1.5; }
  std::size_t actions() const override { return static_cast<std::size_t>(camera.moves()); }
  void unplug() override { camera.set_power(false); }
  void plug() override { camera.set_power(true); }
  bool powered() const override { return camera.speed() != 0; }
};

// The same device mounted upside down, behind the driver's option `invert`.
template <typename Plant>
struct InvertedPlant final : HeadPlant {
  Plant plant;
  drivers::InvertedHead head{plant.device(), {.pan = true, .tilt = true}};
  explicit InvertedPlant(std::chrono::milliseconds dead_time = {}) : plant(dead_time) {}
  drivers::HeadDevice& device() override { return head; }
  void elapse(Time now) override { plant.elapse(now); }
  double pan() const override { return -plant.pan(); }
  double tilt() const override { return -plant.tilt(); }
  double precision() const override { return plant.precision(); }
  std::size_t actions() const override { return plant.actions(); }
  bool powered() const override { return plant.powered(); }
  void unplug() override { plant.unplug(); }
  void plug() override { plant.plug(); }
};

}  // namespace cerberus::tests
