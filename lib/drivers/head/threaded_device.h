// SPDX-License-Identifier: LGPL-2.1-or-later
// A device whose calls may wait for its hardware, as controls of a camera over USB do, on a thread of its own: no call here
// waits, but open() for `patience` and the destructor for a moment. So the helper goes on answering `alive`.
//
// Commands do not queue up. Of those that come while the device is in a call the newest limits, the strongest stop, and the
// newest move or home after it and the newest zoom are carried out, in this order; a stop cancels the moves and zooms before it. A device that has been
// in its calls for kHangs is at fault, which ends when all that it was given is carried out. One that never returns keeps
// its thread.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "drivers/helper/head_device.h"
#include "drivers/worker.h"

namespace cerberus::drivers {

class ThreadedDevice final : public HeadDevice {
 public:
  // name: of the device, for faults: "the camera /dev/video0".
  ThreadedDevice(std::unique_ptr<HeadDevice> device, std::string name, Patience patience = kPatience);
  ~ThreadedDevice() override;

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
  void watch(std::vector<pollfd>& fds) const override;
  Time tick(Time now) override;
  std::optional<PoseLine> take_pose(Time now) override;
  bool emergency() const override;
  std::optional<SpeedsLine> take_speeds(Time now) override;
  std::optional<double> take_zoom() override;
  void zoom(double position, Time now) override;
  void home(Time now) override;
  std::optional<HomedLine> take_homed(Time now) override;
  std::string fault() const override;
  // Whether all commands were carried out.
  bool idle() const;

  // derived: six controls of a camera that takes 300 ms for each, the time after which older kernels give a control up.
  static constexpr std::chrono::seconds kHangs{2};
  // derived: less than the 5 s after which a helper that is not ready is killed, which would name no device.
  static constexpr std::chrono::seconds kPatience{4};

 private:
  struct Core;
  void post_stop(int strength, Time now) noexcept;

  std::shared_ptr<Core> core_;
  std::optional<Worker> worker_;
  std::string name_;
  Patience patience_;
};

}  // namespace cerberus::drivers
