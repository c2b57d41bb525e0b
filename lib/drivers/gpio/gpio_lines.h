// SPDX-License-Identifier: LGPL-2.1-or-later
// Lines of one GPIO chip: one interface to the part of libgpiod that sensors and motors need, for libgpiod 1.6
// (gpio_lines_v1.cpp) and 2.x (gpio_lines_v2.cpp), which differ in every call. The build selects one of the two by the
// library's version. Functions that can fail return errno, 0 = no error.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "drivers/sensor/sensor_setup.h"

namespace cerberus::drivers {

struct GpioEdge {
  Time time{};         // CLOCK_MONOTONIC, the kernel's stamp
  std::size_t line{};  // index in the request
  bool level = false;
};

class GpioLines {
 public:
  GpioLines();
  ~GpioLines();

  int open(const std::string& path);
  void close() noexcept;  // releases everything; safe at any time and any number of times

  // Properties of the open chip.
  std::string name() const;   // "gpiochip0"
  std::string label() const;  // the kernel driver's label
  unsigned count() const;
  int find(const std::string& line) const;  // offset of a line by its name; -1: no such line
  std::string user(unsigned offset) const;  // the line's consumer; empty: none, or unknown

  // May be called once each. Inputs report both edges. initial: levels at which the outputs begin; empty: low.
  int request_inputs(std::span<const unsigned> offsets, LineBias bias);
  int request_outputs(std::span<const unsigned> offsets, const std::vector<bool>& initial = {});

  int fd() const;  // readable when an input line had an edge; -1: nothing requested
  // Appends the pending edges, oldest first of each line; never blocks.
  int read(std::vector<GpioEdge>& edges);
  int levels(std::vector<bool>& levels);     // of the input lines
  int set(const std::vector<bool>& levels);  // of the output lines
  // Of one line, by its index in the request. Allocates nothing.
  int set(std::size_t output, bool level) noexcept;
  int level(std::size_t input, bool& level) noexcept;
  // Reads one of the requested lines, to learn whether the chip is still there. Changes none.
  int probe() noexcept;

 private:
  struct Handles;
  std::unique_ptr<Handles> handles_;
};

}  // namespace cerberus::drivers
