// SPDX-License-Identifier: LGPL-2.1-or-later
// An input device of the kernel (/dev/input/event3): the part of evdev that sensors need. Functions that can fail
// return errno, 0 = no error.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "drivers/sensor/sensor_setup.h"

namespace cerberus::drivers {

// A key or switch, or what else an event names: numbers of linux/input-event-codes.h.
struct InputCode {
  std::uint16_t type = 0, code = 0;
  bool operator==(const InputCode&) const = default;
};

struct InputEvent {
  Time time{};  // CLOCK_MONOTONIC, the kernel's stamp
  InputCode code;
  int value = 0;  // of a key 0, 1 (2: repeated), of a switch 0, 1
};

class InputDevice {
 public:
  InputDevice() = default;
  ~InputDevice() { close(); }
  InputDevice(const InputDevice&) = delete;
  InputDevice& operator=(const InputDevice&) = delete;

  int open(const std::string& path);
  void close() noexcept;
  int fd() const { return fd_; }  // readable when there are events; -1: not open
  // Properties of the open device.
  std::string name() const;
  std::vector<InputCode> codes() const;  // of all its keys and switches
  // The levels of these keys and switches now.
  int levels(const std::vector<InputCode>& codes, std::vector<bool>& levels) const;
  // Appends pending events, oldest first, 64 at most; never blocks.
  int read(std::vector<InputEvent>& events);

 private:
  int fd_ = -1;
};

// The paths of all input devices, in the order of their numbers.
std::vector<std::string> input_devices();

}  // namespace cerberus::drivers
