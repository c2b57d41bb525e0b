// SPDX-License-Identifier: LGPL-2.1-or-later
// What a head's driver acts on, in real time and outside of the helper process: emulated cameras, files in place of a PWM
// chip, and memory that is shared with a helper whose GPIO lines or camera controls are emulated.
#pragma once

#include <fcntl.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include "drivers/head/head.h"
#include "support/pelco_camera.h"
#include "support/visca_camera.h"
#if HAVE_ONVIF
#include "support/onvif_camera.h"
#endif

namespace cerberus::bench {

using Clock = std::chrono::steady_clock;

inline long now_ns() {
  return static_cast<long>(Clock::now().time_since_epoch().count());
}

class FarSide {
 public:
  virtual ~FarSide() = default;
  virtual drivers::HeadSetup setup() const = 0;
  virtual int actions() = 0;  // moves that have arrived
  // Whether it moves, and when that changed last. Looks at the hardware: called often.
  virtual bool turns() = 0;
  virtual Clock::time_point stopped() = 0;
};

class ViscaSide final : public FarSide {
 public:
  explicit ViscaSide(tests::ViscaCamera::Line line) : camera_(line) {}
  drivers::HeadSetup setup() const override {
    drivers::HeadSetup setup;
    setup.device = camera_.device();
    return setup;
  }
  int actions() override { return camera_.moves(); }
  bool turns() override { return camera_.speed() != 0; }
  Clock::time_point stopped() override { return camera_.stopped(); }

 private:
  tests::ViscaCamera camera_;
};

class PelcoSide final : public FarSide {
 public:
  drivers::HeadSetup setup() const override {
    drivers::HeadSetup setup;
    setup.device = camera_.device();
    return setup;
  }
  int actions() override { return camera_.frames(); }
  bool turns() override { return camera_.speed() != 0; }
  Clock::time_point stopped() override { return camera_.stopped(); }

 private:
  tests::PelcoCamera camera_;
};

#if HAVE_ONVIF
class OnvifSide final : public FarSide {
 public:
  drivers::HeadSetup setup() const override {
    drivers::HeadSetup setup;
    setup.device = camera_.device();
    setup.options = "pan-speed=100 tilt-speed=50 no-absolute";
    return setup;
  }
  int actions() override { return camera_.count("ContinuousMove"); }
  bool turns() override { return camera_.speed() != 0; }
  Clock::time_point stopped() override { return camera_.stopped(); }

 private:
  // It ignores its Timeout, so that only Stop stops it.
  tests::OnvifCamera camera_{{.ignores_timeout = true}};
};
#endif

// Moves as long as its value changes.
class ChangingSide : public FarSide {
 public:
  int actions() override {
    look();
    return changes_;
  }
  bool turns() override {
    look();
    return Clock::now() - changed_ < std::chrono::milliseconds(150);  // three parts of the driver v4l2
  }
  Clock::time_point stopped() override { return changed_; }

 protected:
  virtual long value() = 0;

 private:
  void look() {
    const long now = value();
    if (now == last_) return;
    if (last_ != -1) ++changes_, changed_ = Clock::now();
    last_ = now;
  }
  long last_ = -1;
  int changes_ = 0;
  Clock::time_point changed_{};
};

class ServoSide final : public ChangingSide {
 public:
  ServoSide() {
    char name[] = "/tmp/cerberus-pwm-XXXXXX";
    folder_ = ::mkdtemp(name);
    ::mkdir((folder_ + "/pwm0").c_str(), 0755);
    for (const char* file : {"/period", "/duty_cycle", "/enable"})
      std::ofstream(folder_ + "/pwm0" + file) << "0\n";
    width_ = ::open((folder_ + "/pwm0/duty_cycle").c_str(), O_RDONLY | O_CLOEXEC);
  }
  ~ServoSide() override {
    ::close(width_);
    std::filesystem::remove_all(folder_);
  }
  drivers::HeadSetup setup() const override {
    drivers::HeadSetup setup;
    setup.device = folder_;
    setup.options = "pan='channel=0 pulse=500,2500 range=-180,180'";
    return setup;
  }

 protected:
  long value() override {
    char text[32] = {};
    const long width = ::pread(width_, text, sizeof text - 1, 0) > 0 ? std::atol(text) : 0;
    return pulse_ = width > 0 ? width : pulse_;  // the end of the pulses turns nothing
  }

 private:
  std::string folder_;
  long pulse_ = 0;
  int width_ = -1;
};

// Written by a helper whose hardware is emulated in its own process.
struct SharedHardware {
  std::atomic<long> value{0};    // changes with each action
  std::atomic<long> changed{0};  // nanoseconds of the steady clock, of the last one
  std::atomic<bool> on{false};   // coils are energised
  void act(long to) {
    changed = now_ns();
    value = to;
  }
  static SharedHardware* map(const std::string& file) {
    const int fd = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (fd < 0 || ::ftruncate(fd, sizeof(SharedHardware)) != 0) std::abort();
    void* memory = ::mmap(nullptr, sizeof(SharedHardware), PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    ::close(fd);
    if (memory == MAP_FAILED) std::abort();
    return static_cast<SharedHardware*>(memory);
  }
};

// program: this one, which serves `kind` when it is run as "PROGRAM --serve KIND FILE".
class SharedSide final : public FarSide {
 public:
  SharedSide(const std::string& program, const std::string& kind)
      : file_("/tmp/cerberus-hardware-" + std::to_string(::getpid())),
        command_("'" + program + "' --serve " + kind + " " + file_),
        coils_(kind == "stepper-gpio"),
        hardware_(SharedHardware::map(file_)) {
    hardware_->value = hardware_->changed = 0;
    hardware_->on = false;
  }
  ~SharedSide() override {
    ::munmap(hardware_, sizeof(SharedHardware));
    ::unlink(file_.c_str());
  }
  drivers::HeadSetup setup() const override {
    drivers::HeadSetup setup;
    setup.command = command_;
    return setup;
  }
  int actions() override {
    if (const long now = hardware_->value; now != seen_) {
      seen_ = now;
      ++count_;
    }
    return count_;
  }
  bool turns() override {
    return coils_ ? hardware_->on.load() : now_ns() - hardware_->changed < 150'000'000;
  }
  Clock::time_point stopped() override { return Clock::time_point(Clock::duration(hardware_->changed)); }

 private:
  std::string file_, command_;
  bool coils_;
  SharedHardware* hardware_;
  long seen_ = 0;
  int count_ = 0;
};

}  // namespace cerberus::bench
