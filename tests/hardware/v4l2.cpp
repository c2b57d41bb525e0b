// SPDX-License-Identifier: LGPL-2.1-or-later
// cerberus-head with a camera of the kernel's own (vivid), whose controls are those of renamed_controls.h. The first
// argument is cerberus-head; CERBERUS_RENAMED_CONTROLS names what is preloaded into it. The controls are read beside it,
// through a file of its own. Ends with 77 where the kernel has no such camera.
#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <thread>

#include "drivers/helper/helper_head.h"
#include "helper.h"
#include "renamed_controls.h"
#include "simulated.h"

using namespace simulated;
using Kind = cerberus::motion::AxisCommand::Kind;

namespace {

constexpr char kCamera[] = "/dev/video0";

class Camera {
 public:
  Camera() : fd_(::open(kCamera, O_RDWR | O_CLOEXEC)) { must(fd_ >= 0, kCamera); }
  ~Camera() { ::close(fd_); }
  Camera(const Camera&) = delete;
  int get(std::uint32_t control) const {
    v4l2_control asked{control, 0};
    must(::ioctl(fd_, VIDIOC_G_CTRL, &asked) == 0, "VIDIOC_G_CTRL");
    return asked.value;
  }
  void set(std::uint32_t control, int value) const {
    v4l2_control wanted{control, value};
    must(::ioctl(fd_, VIDIOC_S_CTRL, &wanted) == 0, "VIDIOC_S_CTRL");
  }
  int pan() const { return get(kPan); }
  // Waits until a control has not changed for a second. Returns when it changed last.
  Clock::time_point rest(std::uint32_t control = kPan) const {
    auto changed = Clock::now();
    for (int last = get(control); Clock::now() - changed < 1s; std::this_thread::sleep_for(2ms))
      if (const int now = get(control); now != last) {
        last = now;
        changed = Clock::now();
      }
    return changed;
  }

 private:
  int fd_;
};

HeadSetup camera_setup() {
  HeadSetup setup;
  setup.limits.pan = {radians(-170), radians(170), radians(60), radians(600)};
  return setup;
}

Helper helper_of(const std::string& more = "--mode=absolute") {
  return Helper({"v4l2", std::string("--device=") + kCamera, more}, camera_setup());
}

// 128 steps to each side, the fastest of 60 degrees a second.
constexpr char kSpeeds[] = "mode=speed pan-speed=60 tilt-speed=60";
Helper helper_of_speeds() {
  return Helper(
      {"v4l2", std::string("--device=") + kCamera, "--mode=speed", "--pan-speed=60", "--tilt-speed=60"},
      camera_setup());
}

void unplug() {
  write_text("/sys/bus/platform/drivers/vivid/unbind", "vivid.0");
}
void plug() {
  write_text("/sys/bus/platform/drivers/vivid/bind", "vivid.0");
}

}  // namespace

START_TEST(a_move_of_90_degrees_arrives_and_never_turns_back) {
  const Camera camera;
  camera.set(kPan, 0);
  Helper helper = helper_of();
  helper.send("move to 90 60 hold\n");
  int last = 0, parts = 0;
  for (const auto end = Clock::now() + 60s; last != 90 * kDegree && Clock::now() < end;) {
    const int now = camera.pan();
    ck_assert_int_ge(now, last);
    ck_assert_int_le(now, 90 * kDegree);
    parts += now != last;
    last = now;
    helper.send("alive\n");
    std::this_thread::sleep_for(2ms);
  }
  ck_assert_int_eq(last, 90 * kDegree);
  ck_assert_int_ge(parts, 1);
  helper.arrive(90);
}
END_TEST

START_TEST(a_stop_leaves_it_on_its_way) {
  const Camera camera;
  camera.set(kPan, 0);
  Helper helper = helper_of();
  helper.send("move to -170 10 hold\n");
  while (camera.pan() > -5 * kDegree) helper.expect("pose");
  helper.send("stop\n");
  camera.rest();
  ck_assert_int_gt(camera.pan(), -170 * kDegree);
}
END_TEST

START_TEST(a_tilt_of_20_degrees_arrives_on_the_cameras_grid) {
  const Camera camera;
  camera.set(kTilt, kMiddle);
  Helper helper = helper_of();
  helper.send("move hold to 19.7 60\n");
  for (const auto end = Clock::now() + 60s; camera.get(kTilt) != kMiddle + 20 && Clock::now() < end;)
    helper.expect("pose");
  ck_assert_int_eq(camera.get(kTilt), kMiddle + 20);
}
END_TEST

START_TEST(a_speed_is_a_step_of_the_camera_until_the_stop) {
  const Camera camera;
  Helper helper = helper_of_speeds();
  helper.send("move at -30 hold\n");
  for (const auto end = Clock::now() + 60s; camera.get(kPanSpeed) != -64 && Clock::now() < end;)
    helper.expect("pose");
  ck_assert_int_eq(camera.get(kPanSpeed), -64);
  helper.send("stop\n");
  camera.rest(kPanSpeed);
  ck_assert_int_eq(camera.get(kPanSpeed), 0);
}
END_TEST

START_TEST(a_camera_that_turns_at_a_speed_stands_when_the_pipeline_is_killed) {
  const Camera camera;
  std::vector<Clock::duration> times;
  for (int round = 0; round < kills(); ++round) {
    HelperHead head("v4l2");
    const auto drive = [&] {
      HeadSetup setup = camera_setup();
      setup.helper = program;
      setup.device = kCamera;
      setup.options = kSpeeds;
      setup.helper_timeout = 10s;
      return head.open(setup).empty() && head.command({0s, {Kind::velocity, radians(20), 0}, {}}).empty();
    };
    const pid_t pipeline = pipeline_that_drives(drive, [&] { return camera.get(kPanSpeed) != 0; });
    std::this_thread::sleep_for(std::chrono::milliseconds(37 * round % 400));
    ::kill(pipeline, SIGKILL);
    const auto killed = Clock::now();
    ck_assert_int_eq(::waitpid(pipeline, nullptr, 0), pipeline);
    times.push_back(std::max(Clock::duration::zero(), camera.rest(kPanSpeed) - killed));
    ck_assert_int_eq(camera.get(kPanSpeed), 0);
  }
  ck_assert(report_kills("camera at a speed stands", times));
}
END_TEST

START_TEST(it_stands_when_the_pipeline_is_killed) {
  const Camera camera;
  std::vector<Clock::duration> times;
  for (int round = 0; round < kills(); ++round) {
    camera.set(kPan, 0);
    HelperHead head("v4l2");
    const auto drive = [&] {
      HeadSetup setup = camera_setup();
      setup.helper = program;
      setup.device = kCamera;
      setup.helper_timeout = 10s;  // the end of its input stops it, and no silence
      return head.open(setup).empty() && head.command({0s, {Kind::velocity, radians(2), 0}, {}}).empty();
    };
    const pid_t pipeline = pipeline_that_drives(drive, [&] { return camera.pan() != 0; });
    std::this_thread::sleep_for(std::chrono::milliseconds(37 * round % 400));
    ::kill(pipeline, SIGKILL);
    const auto killed = Clock::now();
    ck_assert_int_eq(::waitpid(pipeline, nullptr, 0), pipeline);
    times.push_back(std::max(Clock::duration::zero(), camera.rest() - killed));
    ck_assert_int_lt(camera.pan(), 170 * kDegree);
  }
  ck_assert(report_kills("camera stands", times));
}
END_TEST

START_TEST(a_locked_zoom_is_set) {
  const Camera camera;
  camera.set(kZoom, 10);
  Helper helper = helper_of("--zoom=0.2");
  assert_text(helper.expect("zoom"), "zoom 0.2");
  ck_assert_int_eq(camera.get(kZoom), 51);
}
END_TEST

START_TEST(a_camera_that_is_unplugged_is_reported_and_used_again) {
  Helper helper = helper_of();
  helper.send("move at 5 hold\n");
  helper.expect("pose");
  unplug();
  const std::string fault = helper.expect("fault");
  ck_assert_msg(fault.find("/dev/video0 does not obey any more") != std::string::npos, "'%s'", fault.c_str());
  plug();
  helper.expect("recovered");
  const Camera camera;
  const int there = camera.pan();
  helper.send("move at 5 hold\n");
  while (camera.pan() <= there) helper.expect("pose");
}
END_TEST

START_TEST(a_camera_without_positions_that_is_unplugged_at_rest_is_reported_and_used_again) {
  must(::setenv("CERBERUS_CAMERA", "speeds", 1) == 0, "setenv");
  Helper helper = helper_of_speeds();
  helper.send("stop\n");
  unplug();
  const auto pulled = Clock::now();
  const std::string fault = helper.expect("fault");
  std::printf("camera unplugged at rest: said after %.0f ms\n", milliseconds(Clock::now() - pulled));
  ck_assert_msg(fault.find("/dev/video0 does not obey any more") != std::string::npos, "'%s'", fault.c_str());
  plug();
  helper.expect("recovered");
  const Camera camera;
  ck_assert_int_eq(camera.get(kPanSpeed), 0);
  helper.send("move at 30 hold\n");
  while (camera.get(kPanSpeed) != 64) helper.expect("speeds");
}
END_TEST

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  program = argv[1];
  if (::access(kCamera, F_OK) != 0) {
    std::printf("skipped: the kernel has no test camera (vivid)\n");
    return 77;
  }
  const char* controls = std::getenv("CERBERUS_RENAMED_CONTROLS");
  must(controls != nullptr && ::setenv("LD_PRELOAD", controls, 1) == 0, "CERBERUS_RENAMED_CONTROLS");
  return cerberus::tests::run_suite(
      "hardware_v4l2",
      {a_move_of_90_degrees_arrives_and_never_turns_back, a_stop_leaves_it_on_its_way,
       a_tilt_of_20_degrees_arrives_on_the_cameras_grid, a_speed_is_a_step_of_the_camera_until_the_stop,
       it_stands_when_the_pipeline_is_killed,
       a_camera_that_turns_at_a_speed_stands_when_the_pipeline_is_killed, a_locked_zoom_is_set,
       a_camera_that_is_unplugged_is_reported_and_used_again,
       a_camera_without_positions_that_is_unplugged_at_rest_is_reported_and_used_again},
      120 + 8 * kills());
}
