// SPDX-License-Identifier: LGPL-2.1-or-later
// The interface to a pan-tilt head. A driver executes commands and makes no decisions. One thread calls at a time;
// calls may block (a serial line), except close() and stop(), which only try. Returned texts are errors for the user
// and name the device; empty = no error. Time is a parameter: running time of the pipeline, never going back.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "motion/pan_tilt.h"
#include "motion/pose.h"
#include "motion/speed_map.h"
#include "motion/zoom_table.h"

namespace cerberus::drivers {

using motion::Time;

struct HeadSetup {
  motion::Limits limits;                     // have passed motion::check()
  Time latency{};                            // from a command until it takes effect
  double step = 0;                           // radians; the head rests at multiples of it. 0: anywhere
  double backlash = 0;                       // radians of play between motor and camera
  double noise = 0;                          // radians, standard deviation of the position feedback
  unsigned seed = 0;                         // of the noise
  double pan = 0, tilt = 0;                  // radians, position at the start
  motion::PanTilt play;                      // radians, of a real head, as calibrated
  motion::SpeedMap pan_speeds, tilt_speeds;  // of a calibration: what the head makes of commanded speeds
  motion::ZoomTable zoom_table{};            // what a real head sees at the positions of its zoom
  std::optional<double> lock_zoom{};         // the position at which a real head's zoom is kept
  bool moves_zoom = false;                   // commands have a zoom: a head without one is refused
  std::string script;                        // of scripted_head.h
  std::string command;                       // of the driver external: the helper, run by /bin/sh
  std::string helper;                        // the program that drives real heads
  std::string device;   // of a real head: serial:/dev/ttyUSB0, udp:HOST:PORT, tcp:HOST:PORT
  std::string options;  // of its driver: "baud=38400 address=2"
  Time helper_timeout = std::chrono::milliseconds(500);  // silence after which a helper stops its head
};

struct HeadCommand {
  Time time{};  // time of the command; one earlier than the last one is stale and refused
  motion::AxisCommand pan, tilt;
  // Both axes hold, and the device also ends what it does without a command, as homing. A plain hold does not end that.
  bool stop = false;
  unsigned order = 0;  // number of the order by hand that it is, which a failure names; 0: none
  // The position that the zoom goes to (motion/zoom_table.h); nothing: it is left as it is.
  std::optional<double> zoom{};
};

class Head {
 public:
  virtual ~Head() = default;
  // What open() refuses of the settings alone, without a look at any device. open() asks it first.
  virtual std::string check(const HeadSetup&) const { return {}; }
  virtual std::string open(const HeadSetup& setup) = 0;
  virtual void close() noexcept = 0;         // stops; safe at any time and any number of times
  virtual void stop(Time now) noexcept = 0;  // brakes as hard as permitted and stays; as close()
  virtual std::string command(const HeadCommand& command) = 0;
  // Sets other limits, which have passed motion::check(), from `now` on (a time as of a command): the last command
  // continues within them. A head beyond them returns, and turns no further out.
  virtual std::string limit(Time now, const motion::Limits& limits) = 0;
  // What the head was found to make of commanded speeds, from now on. Only a head that is told speeds needs it.
  virtual void learn(const motion::SpeedMap& /*pan*/, const motion::SpeedMap& /*tilt*/) {}
  // Begins to look for the head's reference, and obeys no command until it was found; the poses are then measured for a
  // moment. The error of a head that has no way to find it leaves it as it was.
  virtual std::string home(Time) { return "the head has no way to find its reference"; }
  // Returns in `pose` the piece of the trajectory at `time`, with pose.from = time. A time ahead by up to the latency
  // is final: a new command cannot change it.
  virtual std::string state(Time time, motion::Pose& pose) = 0;
  // True while the device's emergency stop is pressed, and once after it was pressed between two calls.
  virtual bool emergency() { return false; }
  // True once after the head's reports have parted from its commands. It was stopped, and refuses all commands until this
  // was called; the next command that moves it after that ends the fault.
  virtual bool parted() { return false; }
  // What is wrong with the device now, also at rest, where no command would report it; empty: nothing. Not the emergency
  // stop.
  virtual std::string fault() { return {}; }
  // True: the head has no clock of its own and follows the times that are passed, whatever their rate.
  virtual bool simulated() const { return false; }
  // False: every call returns at once, and the head needs no thread of its own.
  virtual bool blocks() const { return true; }
};

// "simulated", "scripted", "external", and the real ones in heads.cpp; nullptr for an unknown name.
std::unique_ptr<Head> make_head(std::string_view driver);
// All names, for error messages: "simulated, scripted, ...".
std::string head_drivers();

}  // namespace cerberus::drivers
