// SPDX-License-Identifier: LGPL-2.1-or-later
// A camera that turns by V4L2 controls (the driver v4l2): UVC conference cameras. Three ways, in this order:
//
//   speed      PAN_SPEED and TILT_SPEED, where the options name what their fastest step means: the unit is the camera's
//   absolute   PAN_ABSOLUTE and TILT_ABSOLUTE, arc-seconds
//   relative   PAN_RELATIVE and TILT_RELATIVE, arc-seconds
//
// Of a camera that reports no position the speeds in force are reported, which are steps of its controls, and it is
// stopped at its limits by them.
//
// Angles are sent in small parts along a planned motion, so that a stop has little left to stop: a camera has no stop
// for them.
//
// Kernels before December 2025 report the minimum of a UVC speed wrongly (1 or 0 in place of -max), and a negative speed is
// then clamped to a crawl in the other direction: speeds are used only where the minimum is -max.
//
// A camera that refuses a speed may still turn at the one before: it is stopped before its device is closed, and until it
// has taken the stop the device is opened again every kStopAgain.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "drivers/helper/head_device.h"
#include "drivers/helper/speed_reckoning.h"
#include "drivers/v4l2/camera_controls.h"

namespace cerberus::drivers {

struct V4l2Options {
  enum class Mode { automatic, speed, absolute, relative };
  std::string device;  // /dev/video0
  Mode mode = Mode::automatic;
  double pan_speed = 0, tilt_speed = 0;  // degrees a second of the fastest step; 0: not known
  double zoom = -1;  // the position of the zoom to keep, 0 to 1 of its range; negative: whatever it is
};

class V4l2Head final : public HeadDevice {
 public:
  V4l2Head(V4l2Options options, std::unique_ptr<CameraControls> controls)
      : options_(std::move(options)), controls_(std::move(controls)) {}
  ~V4l2Head() override;

  std::string check() const override;
  std::string open(const HeadSetup& setup, Time now) override;
  HeadAbilities abilities() const override;
  void move(const motion::AxisCommand& pan, const motion::AxisCommand& tilt, Time now) override;
  void limit(const motion::Limits& limits, Time now) override;
  void stop(Time now) noexcept override;
  bool stopping() const override { return stop_owed_; }
  void watch(std::vector<pollfd>&) const override {}
  Time tick(Time now) override;
  std::optional<PoseLine> take_pose(Time now) override;
  std::optional<SpeedsLine> take_speeds(Time now) override;
  std::optional<double> take_zoom() override { return std::exchange(zoom_, std::nullopt); }
  void zoom(double position, Time now) override;
  std::string fault() const override { return fault_; }
  V4l2Options::Mode mode() const { return mode_; }  // the one in use, once it is open

  static constexpr std::chrono::milliseconds kPeriod{50};  // between two positions that are sent or read
  static constexpr std::chrono::milliseconds kZoomPeriod{
      500};  // between two looks at the zoom; a control takes 2 to 30 ms over USB
  // Between two looks at a camera that reports no position. derived: its loss is reported within 1 s
  static constexpr std::chrono::milliseconds kProbe{500};
  static constexpr std::chrono::milliseconds kReopen{1000};
  static constexpr std::chrono::milliseconds kStopAgain{200};  // while a camera that is gone may turn

 private:
  using Mode = V4l2Options::Mode;
  struct Axis {
    std::uint32_t speed = 0, absolute = 0, relative = 0;  // controls
    const char* name = "";
    motion::AxisLimits limits;
    std::optional<ControlRange> speeds, angles, ways;
    double fastest = 0;   // radians a second of speeds.most
    double position = 0;  // radians: read, or what was commanded
    motion::AxisCommand command;
    motion::Plan plan;                 // but for speeds
    bool moves = false;                // the plan, or its end was not sent yet
    bool reads = false;                // the camera reports its position
    std::optional<std::int32_t> sent;  // speed or angle in force
  };
  static Axis axis(const char* name, std::uint32_t speed, std::uint32_t absolute, std::uint32_t relative) {
    Axis made;
    made.name = name;
    made.speed = speed;
    made.absolute = absolute;
    made.relative = relative;
    return made;
  }
  void plan(Axis& axis, const motion::AxisCommand& command, Time now);
  void send_angle(Axis& axis, double angle);
  std::string connect(Time now);
  void disconnect(Time now) noexcept;
  bool reconnect(Time now);
  std::string choose_mode();
  std::string no_unit() const;
  bool drives(const Axis& axis) const;
  std::string check_range(const Axis& axis) const;
  void set_speed(Axis& axis, double speed);
  void set_speeds(const motion::PanTilt& speed, Time now);
  double speed_of(const Axis& axis) const;  // in force, radians a second
  void note_speeds(Time now) noexcept;
  bool read_position(Axis& axis) noexcept;
  void lose(int error);
  void check_zoom(Time now);
  std::int32_t zoom_value(double position) const;
  void probe(Time now);
  void check(int error) {
    if (error != 0) lose(error);
  }

  V4l2Options options_;
  std::unique_ptr<CameraControls> controls_;
  Axis pan_ =
      axis("pan", camera_control::kPanSpeed, camera_control::kPanAbsolute, camera_control::kPanRelative);
  Axis tilt_ =
      axis("tilt", camera_control::kTiltSpeed, camera_control::kTiltAbsolute, camera_control::kTiltRelative);
  Mode mode_ = Mode::automatic;
  bool reads_ = false;  // the camera reports the positions of all axes that it drives
  bool connected_ = false;
  bool stop_owed_ = false;  // the camera may turn at a speed
  bool lost_ = false;       // it does not obey, or does not report any more
  bool new_pose_ = false;
  SpeedReckoning reckoned_;  // of the speeds in force
  std::optional<ControlRange> zooms_;
  std::optional<double> zoom_;  // read, and not taken yet
  Time next_{}, next_open_{}, next_zoom_{}, next_probe_{};
  std::string fault_;
};

// "speed", "absolute", "relative", "auto"; nothing for another word.
std::optional<V4l2Options::Mode> v4l2_mode(const std::string& word);

}  // namespace cerberus::drivers
