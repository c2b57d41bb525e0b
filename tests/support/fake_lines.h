// SPDX-License-Identifier: LGPL-2.1-or-later
// Lines that record their edges with the test's own time, and motors that follow them: an oracle that knows stepper
// motors from their data sheets and not from the driver's tables.
#pragma once

#include <cerrno>
#include <cmath>
#include <string>
#include <vector>

#include "drivers/stepper/line_port.h"

namespace cerberus::tests {

struct LineEdge {
  motion::Time time{};
  std::size_t line{};
  bool level = false;
};

// What the test and the driver share; outlives the driver.
struct FakeLines {
  motion::Time now{};
  std::vector<bool> levels;  // of the outputs
  std::vector<bool> inputs;
  std::vector<LineEdge> edges;
  int set_error = 0, get_error = 0, probe_error = 0;
  std::string open_error;
  bool open = false;
  std::vector<motion::Time> pauses;
};

class FakePort final : public drivers::LinePort {
 public:
  explicit FakePort(FakeLines& lines) : lines_(lines) {}
  std::string open(const std::vector<std::string>& outputs, const std::vector<bool>& initial,
                   const std::vector<std::string>& inputs) override {
    if (!lines_.open_error.empty()) return lines_.open_error;
    lines_.levels = initial;
    lines_.levels.resize(outputs.size(), false);
    lines_.inputs.resize(inputs.size(), false);
    lines_.open = true;
    return {};
  }
  void close() noexcept override { lines_.open = false; }
  int set(std::size_t output, bool level) noexcept override {
    if (lines_.set_error != 0) return lines_.set_error;
    if (!lines_.open || output >= lines_.levels.size()) return EBADF;
    lines_.levels[output] = level;
    lines_.edges.push_back({lines_.now, output, level});
    return 0;
  }
  int get(std::size_t input, bool& level) noexcept override {
    if (lines_.get_error != 0) return lines_.get_error;
    if (!lines_.open || input >= lines_.inputs.size()) return EBADF;
    level = lines_.inputs[input];
    return 0;
  }
  int probe() noexcept override { return lines_.probe_error; }
  void pause(motion::Time time) noexcept override { lines_.pauses.push_back(time); }

 private:
  FakeLines& lines_;
};

// A unipolar motor: the rotor turns to the middle of the coils that are on, which lie 90 electrical degrees apart. It
// follows jumps of less than half a period and counts in eighths of it; without current it stays.
class CoilMotor {
 public:
  explicit CoilMotor(std::size_t first = 0) : first_(first) {}
  void follow(const FakeLines& lines) {
    double x = 0, y = 0;
    for (std::size_t k = 0; k < 4; ++k)
      if (lines.levels[first_ + k]) {
        x += std::round(std::cos(static_cast<double>(k) * 1.5707963267948966));
        y += std::round(std::sin(static_cast<double>(k) * 1.5707963267948966));
      }
    if (x == 0 && y == 0) return;
    const double eighth = std::atan2(y, x) / 0.7853981633974483;  // 0 .. 8
    half_steps_ += static_cast<int>(std::lround(std::remainder(eighth - half_steps_, 8.0)));
  }
  int half_steps() const { return half_steps_; }

 private:
  std::size_t first_;
  int half_steps_ = 0;
};

// A STEP / DIR driver: counts rising edges of STEP while it is enabled (EN low).
class StepMotor {
 public:
  explicit StepMotor(std::size_t first = 0) : first_(first) {}
  void follow(const FakeLines& lines, const LineEdge& edge) {
    if (edge.line != first_ || !edge.level || lines.levels[first_ + 2]) return;
    steps_ += lines.levels[first_ + 1] ? 1 : -1;
  }
  int steps() const { return steps_; }

 private:
  std::size_t first_;
  int steps_ = 0;
};

}  // namespace cerberus::tests
