// SPDX-License-Identifier: LGPL-2.1-or-later
#include "head_settings.hpp"

#include "drivers/helper/passwords.h"
#include "helper_program.hpp"
#include "shared/choices.hpp"
#include "shared/stamps.hpp"
#include "shared/times.hpp"
#include "text/numbers.h"

namespace cerberus::plugin {

using sensing::radians;

namespace {

constexpr double kMostDegrees = 3600;
constexpr double kLeast = 0.001;  // degrees a second: motion::check() refuses a head that cannot move

GType target_type() {
  static const GType type = register_target_choice("CerberusPanTiltTarget");
  return type;
}

GType response_type() {
  using control::Response;
  static const GEnumValue values[] = {
      {static_cast<int>(Response::calm), "Moves least, lags most", "calm"},
      {static_cast<int>(Response::normal), "Follows a walker within one and a half degrees", "normal"},
      {static_cast<int>(Response::fast), "Follows closest, passes on more noise", "fast"},
      {0, nullptr, nullptr}};
  static const GType type = g_enum_register_static("CerberusPanTiltResponse", values);
  return type;
}

const Property<HeadSettings> kProperties[] = {
    property("driver", &HeadSettings::driver,
             "What drives the head: simulated, scripted, external, visca, pelco-d, onvif, stepper-gpio, "
             "servo-pwm or v4l2")
        .read_at_start(),
    property("head", &HeadSettings::head, "Name of the head, in pose events and messages; one sink a name")
        .read_at_start(),
    property("script", &HeadSettings::script,
             "What the scripted driver does, for tests: parts like 'record 7; command 3 fail no power; stop "
             "wait 8' with file descriptors")
        .read_at_start(),
    property("device", &HeadSettings::device,
             "The real head, as serial:/dev/ttyUSB0, udp:HOST:PORT, tcp:HOST:PORT, http://HOST, gpiochip0, "
             "pwmchip0 or /dev/video0; never with a password")
        .read_at_start(),
    property("device-options", &HeadSettings::device_options,
             "Options of the real head's driver, as 'baud=38400 address=2'")
        .read_at_start(),
    property(
        "command", &HeadSettings::command,
        "The helper program of driver=external, run by /bin/sh, which implements the line protocol of heads")
        .read_at_start(),
    property(
        "calibration", &HeadSettings::calibration,
        "File of `cerberus-heads calibrate` with this head's speeds, dead time (in place of latency) and "
        "backlash")
        .read_at_start(),
    property("base-gyro", &HeadSettings::base_gyro,
             "IIO gyro on the body that carries the head, by name or id, and which of its axes points up, as "
             "'mpu6050 axis=-y' (z): its yaw rate is sent upstream as the base's")
        .read_at_start(),
    property(
        "base-turn", &HeadSettings::base_turn, 0, 360,
        "Degrees a second for which the body below the head is asked at most (messages "
        "cerberus-base-request) while a person whom the head follows is near its stops or beyond; 0 = it "
        "is not asked"),
    property(
        "keep-size", &HeadSettings::keep_size,
        "The zoom slowly keeps a followed person at a third of the picture's height: of a visca, pelco-d "
        "(feedback), onvif, v4l2, external or simulated head with a zoom-table")
        .read_at_start(),
    property("helper-timeout", &HeadSettings::helper_timeout,
             "Nanoseconds of silence, 1 ms to 10 s, after which the helper process of a real head stops it")
        .read_at_start(),
    property("horizontal-fov", &HeadSettings::horizontal_fov, 0, 179,
             "Angle in degrees that the lens sees over the frame's whole width; 0 = unknown, then nothing "
             "can be tracked"),
    property("zoom-table", &HeadSettings::zoom_table,
             "What a head with a zoom sees: positions (0 = widest, 1 = longest) and degrees over the frame's "
             "width, '0 60; 0.5 20; 1 3.2'; it then takes the place of horizontal-fov; empty = not known")
        .read_at_start(),
    property(
        "lock-zoom", &HeadSettings::lock_zoom, -1, motion::kMostZoom,
        "Position at which the zoom of a visca, onvif or v4l2 camera is kept, 0 = widest, 1 = longest; -1 = "
        "it is left alone")
        .read_at_start(),
    property("pan-min", &HeadSettings::pan_min, -kMostDegrees, kMostDegrees,
             "How far the head turns to the left, degrees, at most 0"),
    property("pan-max", &HeadSettings::pan_max, -kMostDegrees, kMostDegrees,
             "How far the head turns to the right, degrees, at least 0"),
    property("tilt-min", &HeadSettings::tilt_min, -kMostDegrees, kMostDegrees,
             "How far the head looks down, degrees, at most 0; as tilt-max 0: it does not tilt"),
    property("tilt-max", &HeadSettings::tilt_max, -kMostDegrees, kMostDegrees,
             "How far the head looks up, degrees, at least 0"),
    property("start-pan", &HeadSettings::start_pan, -kMostDegrees, kMostDegrees,
             "Where a simulated head looks at the start, degrees, positive to the right")
        .read_at_start(),
    property("start-tilt", &HeadSettings::start_tilt, -kMostDegrees, kMostDegrees,
             "Where a simulated head looks at the start, degrees, positive up")
        .read_at_start(),
    property(
        "turn-speed", &HeadSettings::turn_speed, 0, kMostDegrees,
        "Degrees a second at which the head searches and returns to zero; it turns to a known direction at "
        "max-speed; 0 = the default"),
    property("max-speed", &HeadSettings::max_speed, kLeast, sensing::degrees(motion::kMostSpeed),
             "Highest speed of the head in degrees a second"),
    property("max-acceleration", &HeadSettings::max_acceleration, kLeast,
             sensing::degrees(motion::kMostAcceleration),
             "Highest acceleration of the head in degrees a second squared"),
    property("response", &HeadSettings::response, response_type,
             "How a target is followed: calm moves least and lags most, fast follows closest and passes on "
             "more noise"),
    property("latency", &HeadSettings::latency,
             "Nanoseconds from a command until it takes effect, at most 5 s")
        .read_at_start(),
    property("step-size", &HeadSettings::step_size, 0, 90,
             "A simulated head rests at multiples of this many degrees; 0 = anywhere")
        .read_at_start(),
    property("backlash", &HeadSettings::backlash, 0, 90,
             "Play in degrees between a simulated head's motor and camera")
        .read_at_start(),
    property("noise", &HeadSettings::noise, 0, 90,
             "Standard deviation in degrees of a simulated head's position feedback")
        .read_at_start(),
    property("seed", &HeadSettings::seed, 0, G_MAXINT, "Seed of the noise: equal seeds give equal runs")
        .read_at_start(),
    property("target", &HeadSettings::target, target_type,
             "Which track to follow when none is followed yet, without pirfusion upstream"),
    property("return-delay", &HeadSettings::return_delay,
             "Nanoseconds without a track after which the head returns to zero, without pirfusion upstream"),
    property(
        "hold-stopped", &HeadSettings::hold_stopped,
        "Nanoseconds for which a stopped track is kept as the target at least, without pirfusion upstream"),
    property("watchdog-timeout", &HeadSettings::watchdog_timeout,
             "Nanoseconds without a frame after which the head stops; 0 = never"),
    property("manual-timeout", &HeadSettings::manual_timeout,
             "Nanoseconds after which an order by hand that is not repeated becomes a stop, for orders from "
             "afar; 0 = "
             "moves never; `turn` after 500 ms at most"),
    property("camera-name", &HeadSettings::camera_name, kCameraNameBlurb).read_at_start(),
};

}  // namespace

std::span<const Property<HeadSettings>> head_properties() {
  return kProperties;
}

motion::Limits head_limits(const HeadSettings& s) {
  const double speed = radians(s.max_speed), acceleration = radians(s.max_acceleration);
  return {.pan = {radians(s.pan_min), radians(s.pan_max), speed, acceleration},
          .tilt = {radians(s.tilt_min), radians(s.tilt_max), speed, acceleration}};
}

void hide_passwords(HeadSettings& s) {
  for (const auto setting : {&HeadSettings::device, &HeadSettings::device_options})
    s.*setting = drivers::without_password(s.*setting);
}

void copy_limits(const HeadSettings& from, HeadSettings& to) {
  for (const auto limit :
       {&HeadSettings::pan_min, &HeadSettings::pan_max, &HeadSettings::tilt_min, &HeadSettings::tilt_max,
        &HeadSettings::max_speed, &HeadSettings::max_acceleration})
    to.*limit = from.*limit;
}

control::LawOptions law_options(const HeadSettings& s) {
  return {.limits = head_limits(s),
          .base_turn = radians(s.base_turn),
          .turn_speed = radians(s.turn_speed),
          .response = static_cast<control::Response>(s.response)};
}

fusion::FuserOptions fuser_options(const HeadSettings& s) {
  return {.choice = static_cast<fusion::TargetChoice>(s.target),
          .return_delay = time_of(s.return_delay),
          .hold_stopped = time_of(s.hold_stopped)};
}

drivers::HeadSetup head_setup(const HeadSettings& s) {
  return {.limits = head_limits(s),
          .latency = time_of(s.latency),
          .step = radians(s.step_size),
          .backlash = radians(s.backlash),
          .noise = radians(s.noise),
          .seed = static_cast<unsigned>(s.seed),
          .pan = radians(s.start_pan),
          .tilt = radians(s.start_tilt),
          .play = {},  // of a calibration file, as the speeds
          .pan_speeds = {},
          .tilt_speeds = {},
          .zoom_table = {},  // parsed when the head is opened
          .lock_zoom = s.lock_zoom >= 0 ? std::optional(s.lock_zoom) : std::nullopt,
          .moves_zoom = s.keep_size,
          .script = s.script,
          .command = s.command,
          .helper = helper_program(),
          .device = s.device,
          .options = s.lock_zoom >= 0 ? s.device_options + " zoom=" + text::rounded(s.lock_zoom, 4).string()
                                      : s.device_options,
          .helper_timeout = time_of(s.helper_timeout)};
}

}  // namespace cerberus::plugin
