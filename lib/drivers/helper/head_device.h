// SPDX-License-Identifier: LGPL-2.1-or-later
// What a helper process drives: one real head behind a protocol or a bus. serve_head() (helper_loop.h) calls it from one
// thread. No call blocks for longer than a few milliseconds; what takes longer is done in steps by tick(), or on another
// thread (head/threaded_device.h). Time is CLOCK_MONOTONIC as a parameter. Texts are for a user and name the device;
// empty = good.
#pragma once

#include <string>
#include <vector>

#include <poll.h>

#include "drivers/helper/head_lines.h"

namespace cerberus::drivers {

class HeadDevice {
 public:
  virtual ~HeadDevice() = default;
  // What open() refuses of the options alone, without a look at any device.
  virtual std::string check() const { return {}; }
  virtual std::string open(const HeadSetup& setup, Time now) = 0;
  virtual HeadAbilities abilities() const = 0;
  // Commands as HeadLines has them; what abilities() does not list is never asked for.
  virtual void move(const motion::AxisCommand& pan, const motion::AxisCommand& tilt, Time now) = 0;
  virtual void limit(const motion::Limits& limits, Time now) = 0;
  // Stops both axes. A device that acknowledges is sent Stop again by tick() until it has.
  virtual void stop(Time now) noexcept = 0;
  // Stops as stop() does when the pipeline is silent or has ended: motors that a commanded stop keeps on are switched
  // off as soon as they stand.
  virtual void leave(Time now) noexcept { stop(now); }
  // Switches the motors off at once, where the device can; else stops them. Safe at any time.
  virtual void release(Time now) noexcept { stop(now); }
  // True while it moves without a command (homing): silence stops that, too.
  virtual bool busy() const { return false; }
  // True while a stop is not acknowledged: the process does not end before, or before kStopPatience is over.
  virtual bool stopping() const = 0;
  // Descriptors to wait on.
  virtual void watch(std::vector<pollfd>& fds) const = 0;
  // Reads what has come, sends what is due. Returns when it must be called again at the latest.
  virtual Time tick(Time now) = 0;
  // The position since the last call, if there is a new one.
  virtual std::optional<PoseLine> take_pose(Time now) = 0;
  // True while an emergency stop keeps the motors off.
  virtual bool emergency() const { return false; }
  // Of a device without feedback: the oldest change of the speeds in force, in which its steps are counted, that was not
  // taken yet. Called until there is none.
  virtual std::optional<SpeedsLine> take_speeds(Time) { return std::nullopt; }
  // The position of the zoom (head_lines.h) since the last call, if it was read anew.
  virtual std::optional<double> take_zoom() { return std::nullopt; }
  // Goes to a position of the zoom (abilities().zoom). One that was not sent yet is dropped by a stop.
  virtual void zoom(double, Time) {}
  // Begins to look for the reference (abilities().home); any other command ends it.
  virtual void home(Time) {}
  // Once: the reference was found, and the device stands there.
  virtual std::optional<HomedLine> take_homed(Time) { return std::nullopt; }
  // What is wrong with the device now; empty: nothing.
  virtual std::string fault() const = 0;
};

}  // namespace cerberus::drivers
