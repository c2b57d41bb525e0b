// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "drivers/v4l2/camera_controls.h"

namespace cerberus::drivers {

// Those of a V4L2 device such as /dev/video0.
class V4l2Controls final : public CameraControls {
 public:
  ~V4l2Controls() override { close(); }
  int open(const std::string& device) override;
  void close() noexcept override;
  std::optional<ControlRange> query(std::uint32_t control) override;
  int get(std::uint32_t control, std::int32_t& value) noexcept override;
  int set(std::uint32_t control, std::int32_t value) noexcept override;
  int probe() noexcept override;

 private:
  int fd_ = -1;
};

}  // namespace cerberus::drivers
