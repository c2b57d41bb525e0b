// SPDX-License-Identifier: LGPL-2.1-or-later
// A head that turns the other way round than its device on one axis or both: a camera that hangs upside down, or swapped
// wires. Commands, limits, the start, reported positions and speeds, and the place where a reference was found are
// negated alike; what a driver's own options say of the device (range=) stays in the device's angles.
#pragma once

#include <string>

#include "drivers/helper/head_device.h"
#include "drivers/helper/option_words.h"

namespace cerberus::drivers {

struct Inverted {
  bool pan = false, tilt = false;
  bool any() const { return pan || tilt; }
};
// Adds the axes of a word: invert=pan, invert=tilt, invert=pan,tilt, or invert for both. Returns what is wrong; then
// `inverted` is unchanged.
std::string parse_inverted(const OptionWord& word, Inverted& inverted);

class InvertedHead final : public HeadDevice {
 public:
  InvertedHead(HeadDevice& device, Inverted inverted) : device_(device), inverted_(inverted) {}

  std::string check() const override { return device_.check(); }
  std::string open(const HeadSetup& setup, Time now) override;
  HeadAbilities abilities() const override { return device_.abilities(); }
  void move(const motion::AxisCommand& pan, const motion::AxisCommand& tilt, Time now) override;
  void limit(const motion::Limits& limits, Time now) override;
  void stop(Time now) noexcept override { device_.stop(now); }
  void leave(Time now) noexcept override { device_.leave(now); }
  void release(Time now) noexcept override { device_.release(now); }
  bool busy() const override { return device_.busy(); }
  bool stopping() const override { return device_.stopping(); }
  void watch(std::vector<pollfd>& fds) const override { device_.watch(fds); }
  Time tick(Time now) override { return device_.tick(now); }
  std::optional<PoseLine> take_pose(Time now) override;
  bool emergency() const override { return device_.emergency(); }
  std::optional<SpeedsLine> take_speeds(Time now) override;
  std::optional<double> take_zoom() override { return device_.take_zoom(); }
  void zoom(double position, Time now) override { device_.zoom(position, now); }
  void home(Time now) override { device_.home(now); }
  std::optional<HomedLine> take_homed(Time now) override;
  std::string fault() const override { return device_.fault(); }

 private:
  motion::Limits negated(motion::Limits limits) const;
  motion::PanTilt negated(const motion::PanTilt& at) const;

  HeadDevice& device_;
  Inverted inverted_;
};

}  // namespace cerberus::drivers
