// SPDX-License-Identifier: LGPL-2.1-or-later
// The interface to a pan-tilt head: a driver executes, it does not think. One thread calls at a time; calls may block
// (a serial line), except close() and stop(), which only do what is in their power. Texts are for a user and name the
// device; empty = good. Time is a parameter: running time of the pipeline, never going back.
#pragma once

#include <memory>
#include <string>

#include "motion/pose.h"

namespace cerberus::drivers {

using motion::Time;

struct HeadSetup {
  motion::Limits limits;     // have passed motion::check()
  Time latency{};            // from a command until the head obeys
  double step = 0;           // radians; it rests at multiples of it. 0: anywhere
  double backlash = 0;       // radians of play between motor and camera
  double noise = 0;          // radians, standard deviation of what it says of its own position
  unsigned seed = 0;         // of the noise
  double pan = 0, tilt = 0;  // where it looks at the start
  std::string script;        // of scripted_head.h
  std::string command;       // of the driver external: the helper, run by /bin/sh
  std::string helper;        // the program that drives real heads
  std::string device;        // of a real head: serial:/dev/ttyUSB0, udp:HOST:PORT, tcp:HOST:PORT
  std::string options;       // of its driver: "baud=38400 address=2"
  Time helper_timeout = std::chrono::milliseconds(500);  // silence after which a helper stops its head
};

struct HeadCommand {
  Time time{};  // when it was given; earlier than the last one: stale, refused
  motion::AxisCommand pan, tilt;
};

class Head {
 public:
  virtual ~Head() = default;
  virtual std::string open(const HeadSetup& setup) = 0;
  virtual void close() noexcept = 0;         // stops; safe at any time and any number of times
  virtual void stop(Time now) noexcept = 0;  // brakes as hard as permitted and stays; as close()
  virtual std::string command(const HeadCommand& command) = 0;
  // From `now` on (as a command) other limits, which have passed motion::check(): what was commanded last goes on
  // within them. Who is beyond them returns, and goes no further out.
  virtual std::string limit(Time now, const motion::Limits& limits) = 0;
  // Where it looks (or will look, as far as it is known: until the latency has passed nothing new can change it).
  // `pose` is the piece that holds at `time`: pose.from = time.
  virtual std::string state(Time time, motion::Pose& pose) = 0;
  // True: it has no clock of its own and lives in the time that it is told, however slow or fast that runs.
  virtual bool simulated() const { return false; }
  // False: every call returns at once, so that it needs no thread of its own.
  virtual bool blocks() const { return true; }
};

// "simulated", "scripted", "external", "visca", "pelco-d"; nullptr for a name that is no driver's.
std::unique_ptr<Head> make_head(std::string_view driver);
// All names, for error messages: "simulated, scripted, external, visca, pelco-d".
std::string head_drivers();

}  // namespace cerberus::drivers
