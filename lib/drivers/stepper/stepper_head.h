// SPDX-License-Identifier: LGPL-2.1-or-later
// A pan-tilt head of one or two stepper motors on digital lines (the driver stepper-gpio). The position is counted from
// the executed steps and reported as feedback. A stop brakes and switches the motors off; so do the end of the process
// and a chip that goes away, as far as a program can. What must be off when this process is killed needs resistors at
// the enable lines (docs/manual/wiring.md).
#pragma once

#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include "drivers/helper/head_device.h"
#include "drivers/stepper/line_port.h"
#include "drivers/stepper/stepper_axis.h"
#include "drivers/stepper/stepper_options.h"

namespace cerberus::drivers {

class StepperHead final : public HeadDevice {
 public:
  // record: a file to which each step is written as "pan COUNT PLANNED EXECUTED", nanoseconds; nullptr: none.
  StepperHead(StepperOptions options, std::unique_ptr<LinePort> port, std::FILE* record = nullptr);
  ~StepperHead() override;

  std::string check() const override;
  std::string open(const HeadSetup& setup, Time now) override;
  HeadAbilities abilities() const override;
  void move(const motion::AxisCommand& pan, const motion::AxisCommand& tilt, Time now) override;
  void limit(const motion::Limits& limits, Time now) override;
  void stop(Time now) noexcept override;
  void leave(Time now) noexcept override;
  void release(Time now) noexcept override;
  bool busy() const override;
  bool stopping() const override;
  void watch(std::vector<pollfd>&) const override {}
  Time tick(Time now) override;
  std::optional<PoseLine> take_pose(Time now) override;
  std::string fault() const override { return fault_; }

  static constexpr std::chrono::milliseconds kReportMoving{40}, kReportResting{200};
  static constexpr std::chrono::milliseconds kReopen{1000};
  // Between two looks at the chip of a head at rest, which sets no line. derived: its loss is reported within 1 s
  static constexpr std::chrono::milliseconds kProbe{500};
  static constexpr double kRate = 50;  // commands a second

 private:
  std::string open_lines();
  std::optional<StepperAxis> make_axis(const char* name, const StepperAxisOptions& options,
                                       std::size_t first_output, std::size_t& inputs);
  Time run(std::optional<StepperAxis>& axis, Time now);
  bool rests() const;
  int error_of_axes() const;
  void lose(int error, Time now);

  StepperOptions options_;
  std::unique_ptr<LinePort> port_;
  std::FILE* record_;
  std::optional<StepperAxis> pan_, tilt_;
  motion::AxisState still_pan_, still_tilt_;  // of an axis that the head has not
  Time next_report_{}, next_open_{}, next_probe_{};
  bool gone_ = false, new_pose_ = false;
  std::string fault_, gone_text_;
};

}  // namespace cerberus::drivers
