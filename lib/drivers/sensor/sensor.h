// SPDX-License-Identifier: LGPL-2.1-or-later
// The interface to a set of PIR sensors. A driver reports the edges of its lines; sensing::PirModel does polarity,
// debounce and the rest. One thread calls at a time. A default SensorError = no error. Calls may block, so a device has
// a thread of its own (sensor_runner.h), and so has the opening of a recording, whose other calls do not block.
//
// A device has a clock of its own, CLOCK_MONOTONIC: wait for fd(), then read(). A recording follows the times that are
// passed, 0 = its begin, whatever their rate: read() when next() has come.
#pragma once

#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/sensor/sensor_setup.h"

namespace cerberus::drivers {

struct SensorEdge {
  Time time{};  // a device: CLOCK_MONOTONIC, the kernel's own stamp where it has one
  int sensor = 0;
  bool level = false;                                     // of the line, before polarity; may repeat
  float volts = std::numeric_limits<float>::quiet_NaN();  // what was measured; NaN: nothing is
  bool known = true;      // false: from now on nothing is known of the line, until its next edge
  bool restarts = false;  // where nothing is known: the sensor may have lost its supply, and warms up again
};

class Sensor {
 public:
  virtual ~Sensor() = default;
  // What open() refuses of the settings alone, without a look at any device. open() asks it first.
  virtual SensorError check(const SensorSetup&) const { return {}; }
  virtual SensorError open(const SensorSetup& setup) = 0;
  // Opening takes no time, and what is opened is a recording.
  virtual bool opens_at_once(const SensorSetup&) const { return false; }
  virtual void close() noexcept = 0;  // LEDs off, lines free; safe at any time and any number of times
  virtual void stop() noexcept = 0;   // LEDs off; as close()

  // Readable when read() has something; -1: a recording, or not open.
  virtual int fd() const { return -1; }
  // Appends what happened until `now`, oldest first. The first edge of each sensor is the level that it began with.
  // An error is final: close. (What may pass is an outage.)
  virtual SensorError read(Time now, std::vector<SensorEdge>& edges) = 0;
  // Lights the LEDs: red while a sensor detects, blue while it does not, none while its reading is invalid.
  virtual SensorError show(std::span<const sensing::Presence>) { return {}; }

  // Where a sensor is connected, for messages: "line 17 of gpiochip0".
  virtual std::string place(int sensor) const = 0;
  // Why nothing is known of the sensors for now, a sentence for a user without its point; the driver goes on trying.
  // Empty: it works. Changes in read() only.
  virtual std::string outage() const { return {}; }
  // Every edge has its volts, and there is one for each sample.
  virtual bool measures() const { return false; }
  virtual bool recorded() const { return false; }        // what it is before open() may change with that
  virtual Time next() const { return sensing::kNever; }  // of a recording: time of the next edge
  virtual void rewind() {}                               // a recording begins again
  virtual Time end() const { return sensing::kNever; }   // of a recording: the end of its data
};

// "evdev", "external", "gpio", "iio", "replay", "scripted"; nullptr for an unknown name. A driver that was left out of the build exists,
// and its open() returns that as an error.
std::unique_ptr<Sensor> make_sensor(std::string_view driver);
std::string sensor_drivers();             // all names, for error messages
bool is_device(std::string_view driver);  // it reads hardware, so it is live

}  // namespace cerberus::drivers
