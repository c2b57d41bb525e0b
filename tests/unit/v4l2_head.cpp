// SPDX-License-Identifier: LGPL-2.1-or-later
// The V4L2 driver on cameras of the test's own.
#include "drivers/v4l2/v4l2_head.h"

#include <algorithm>
#include <cerrno>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "support/says.h"
#include "support/suite.h"
#include "support/text.h"

using namespace cerberus::drivers;
using namespace std::chrono_literals;
using cerberus::sensing::degrees;
using cerberus::sensing::radians;
using cerberus::tests::assert_text;
using Kind = cerberus::motion::AxisCommand::Kind;
using Mode = V4l2Options::Mode;
namespace id = camera_control;

namespace {

struct Camera {
  std::map<std::uint32_t, ControlRange> ranges;
  std::map<std::uint32_t, std::int32_t> values;
  std::vector<std::pair<std::uint32_t, std::int32_t>> sets;
  int open_error = 0, set_error = 0;
  std::optional<std::int32_t> refuses;  // this value, once
  std::set<std::uint32_t> unread;       // controls that cannot be read
  std::uint32_t stuck = 0;              // a control that takes values and keeps its own
  std::map<std::uint32_t, int> reads;
};

class FakeControls final : public CameraControls {
 public:
  explicit FakeControls(Camera& camera) : camera_(camera) {}
  int open(const std::string&) override { return camera_.open_error; }
  void close() noexcept override {}
  std::optional<ControlRange> query(std::uint32_t control) override {
    const auto found = camera_.ranges.find(control);
    return found == camera_.ranges.end() ? std::nullopt : std::optional(found->second);
  }
  int get(std::uint32_t control, std::int32_t& value) noexcept override {
    if (camera_.unread.contains(control) || !camera_.ranges.contains(control)) return EINVAL;
    value = camera_.values[control];
    ++camera_.reads[control];
    return 0;
  }
  int set(std::uint32_t control, std::int32_t value) noexcept override {
    if (camera_.set_error != 0) return camera_.set_error;
    if (camera_.refuses == value) return camera_.refuses.reset(), EIO;
    const ControlRange range = camera_.ranges.at(control);
    // As the kernel: what is beyond is clamped.
    value = std::clamp(value, range.least, range.most);
    if (control != camera_.stuck) camera_.values[control] = value;
    camera_.sets.emplace_back(control, value);
    return 0;
  }
  int probe() noexcept override { return camera_.open_error; }

 private:
  Camera& camera_;
};

constexpr ControlRange kPan{-468000, 468000, 3600}, kTilt{-324000, 324000, 3600};  // of an OBSBOT Tiny SE

struct Bench {
  Camera camera;
  V4l2Options options;
  std::unique_ptr<V4l2Head> head;
  Time now{};
  HeadSetup setup;

  Bench() {
    options.device = "/dev/video9";
    setup.limits.pan = {radians(-120), radians(120), radians(60), radians(600)};
    setup.limits.tilt = {radians(-40), radians(40), radians(60), radians(600)};
  }
  std::string open() {
    head = std::make_unique<V4l2Head>(options, std::make_unique<FakeControls>(camera));
    return head->open(setup, now);
  }
  void run(Time length) {
    for (const Time end = now + length; now < end;) {
      const Time next = head->tick(now);
      ck_assert(next > now);
      now = std::min(end, next);
    }
  }
};

Camera with_angles() {
  Camera camera;
  camera.ranges = {{id::kPanAbsolute, kPan}, {id::kTiltAbsolute, kTilt}};
  return camera;
}

Camera with_speeds(std::int32_t least) {
  Camera camera = with_angles();
  camera.ranges[id::kPanSpeed] = {least, 160, 1};
  camera.ranges[id::kTiltSpeed] = {least, 120, 1};
  return camera;
}

}  // namespace

START_TEST(angles_go_in_arc_seconds_on_the_cameras_grid_along_the_plan) {
  Bench bench;
  bench.camera = with_angles();
  assert_text(bench.open(), "");
  ck_assert(bench.head->mode() == Mode::absolute);
  ck_assert(bench.head->abilities().position && bench.head->abilities().feedback);
  bench.head->move({Kind::position, radians(30.2), radians(60)}, {Kind::position, radians(-10), 1}, 0s);
  std::int32_t last = 0;
  bench.run(2s);
  for (const auto& [control, value] : bench.camera.sets) {
    if (control != id::kPanAbsolute) continue;
    ck_assert_int_eq(value % 3600, 0);
    ck_assert(value - last >= 0 &&
              value - last <= 4 * 3600);  // 60 degrees a second x 50 ms = 3, and rounding
    last = value;
  }
  ck_assert_int_eq(bench.camera.values[id::kPanAbsolute], 30 * 3600);
  ck_assert_int_eq(bench.camera.values[id::kTiltAbsolute], -10 * 3600);
  const auto pose = bench.head->take_pose(bench.now);
  ck_assert(pose);
  ck_assert_double_eq_tol(degrees(pose->pan.position), 30, 1e-9);
}
END_TEST

START_TEST(a_stop_leaves_little_to_stop) {
  Bench bench;
  bench.camera = with_angles();
  bench.open();
  bench.head->move({Kind::velocity, radians(60), 0}, {}, 0s);
  bench.run(1s);
  bench.head->stop(bench.now);
  const std::int32_t there = bench.camera.values[id::kPanAbsolute];
  ck_assert(there > 40 * 3600 && there < 62 * 3600);
  bench.run(1s);
  ck_assert_int_eq(bench.camera.values[id::kPanAbsolute], there);
}
END_TEST

START_TEST(limits_between_two_steps_are_not_passed) {
  Bench bench;
  bench.camera = with_angles();
  bench.setup.limits.pan.to = radians(10.7);
  bench.open();
  bench.head->move({Kind::velocity, radians(60), 0}, {}, 0s);
  bench.run(2s);
  ck_assert_int_eq(bench.camera.values[id::kPanAbsolute], 10 * 3600);
}
END_TEST

START_TEST(speeds_are_shares_of_the_fastest_and_a_camera_at_its_limit_stops) {
  Bench bench;
  bench.camera = with_speeds(-160);
  bench.camera.ranges[id::kTiltSpeed].least = -120;
  bench.options.pan_speed = 80;
  bench.options.tilt_speed = 60;
  assert_text(bench.open(), "");
  ck_assert(bench.head->mode() == Mode::speed);
  ck_assert(bench.head->abilities().velocity && !bench.head->abilities().position);
  bench.head->move({Kind::velocity, radians(-20), 0}, {Kind::velocity, radians(30), 0}, 0s);
  ck_assert_int_eq(bench.camera.values[id::kPanSpeed], -40);
  ck_assert_int_eq(bench.camera.values[id::kTiltSpeed], 60);
  bench.camera.values[id::kPanAbsolute] = -120 * 3600;
  bench.run(100ms);
  ck_assert_int_eq(bench.camera.values[id::kPanSpeed], 0);
  ck_assert_int_eq(bench.camera.values[id::kTiltSpeed], 60);
  bench.head->stop(bench.now);
  ck_assert_int_eq(bench.camera.values[id::kTiltSpeed], 0);
  ck_assert(!bench.head->stopping());
}
END_TEST

namespace {

// A camera that has `most` speeds either way and reports no position; its fastest ones are 80 degrees a second.
Bench bench_with_steps(std::int32_t most) {
  Bench bench;
  bench.camera = with_angles();
  bench.camera.ranges[id::kPanSpeed] = bench.camera.ranges[id::kTiltSpeed] = {-most, most, 1};
  bench.camera.unread = {id::kPanAbsolute, id::kTiltAbsolute};
  bench.options.pan_speed = bench.options.tilt_speed = 80;
  bench.options.mode = Mode::speed;
  return bench;
}

}  // namespace

START_TEST(a_speed_is_the_nearest_step_that_is_no_faster_than_the_limit) {
  Bench bench = bench_with_steps(4);  // 20 degrees a second each
  bench.setup.limits.pan.speed = radians(50);
  bench.open();
  for (const auto& [degrees, step] :
       {std::pair{50., 2}, {35, 2}, {29, 1}, {9, 0}, {-50, -2}, {-35, -2}, {-9, 0}}) {
    bench.head->move({Kind::velocity, radians(degrees), 0}, {}, 0s);
    ck_assert_int_eq(bench.camera.values[id::kPanSpeed], step);
  }
}
END_TEST

START_TEST(a_camera_without_positions_reports_its_speeds_and_stops_at_its_limits_by_them) {
  Bench bench = bench_with_steps(1);
  assert_text(bench.open(), "");
  ck_assert(!bench.head->abilities().feedback);
  bench.head->take_speeds(bench.now);
  bench.head->move({Kind::velocity, radians(50), 0}, {Kind::velocity, radians(20), 0}, 0s);
  const auto speeds = bench.head->take_speeds(bench.now + 10ms);
  ck_assert(speeds);
  ck_assert_double_eq_tol(degrees(speeds->speed.pan), 80, 1e-9);  // and not 50
  ck_assert_double_eq(speeds->speed.tilt, 0);                     // too slow for its only step
  ck_assert_double_eq_tol(speeds->age, .01, 1e-9);
  ck_assert(!bench.head->take_speeds(bench.now));
  bench.run(1500ms);  // at 120 degrees, where its pipeline stops it
  ck_assert_int_eq(bench.camera.values[id::kPanSpeed], 1);
  bench.run(100ms);  // beyond 122
  ck_assert_int_eq(bench.camera.values[id::kPanSpeed], 0);
  const auto rest = bench.head->take_speeds(bench.now);
  ck_assert(rest && rest->speed.pan == 0);
  ck_assert(rest->age >= 0 && rest->age <= .1);
  bench.head->move({Kind::velocity, radians(50), 0}, {}, bench.now);
  ck_assert_int_eq(bench.camera.values[id::kPanSpeed], 0);
  bench.head->move({Kind::velocity, radians(-50), 0}, {}, bench.now);
  ck_assert_int_eq(bench.camera.values[id::kPanSpeed], -1);
}
END_TEST

START_TEST(a_stop_that_is_refused_is_set_again) {
  Bench bench;
  bench.camera = with_speeds(-160);
  bench.camera.ranges[id::kTiltSpeed].least = -120;
  bench.options.pan_speed = bench.options.tilt_speed = 80;
  bench.open();
  bench.head->move({Kind::velocity, radians(-20), 0}, {}, 0s);
  bench.camera.set_error = EBUSY;
  bench.head->stop(bench.now);
  ck_assert(bench.head->stopping());
  bench.run(100ms);
  bench.camera.set_error = 0;
  bench.run(100ms);
  ck_assert(!bench.head->stopping());
  ck_assert_int_eq(bench.camera.values[id::kPanSpeed], 0);
}
END_TEST

// Whatever the camera did not take: it may still turn at the speed before.
START_TEST(a_camera_that_refuses_a_speed_is_stopped_before_it_is_given_up) {
  Bench bench;
  bench.camera = with_speeds(-160);
  bench.camera.ranges[id::kTiltSpeed].least = -120;
  bench.options.pan_speed = bench.options.tilt_speed = 80;
  bench.open();
  bench.head->move({Kind::velocity, radians(-20), 0}, {}, 0s);
  ck_assert_int_eq(bench.camera.values[id::kPanSpeed], -40);
  bench.camera.refuses = -80;  // one write fails, the next ones do not
  bench.head->move({Kind::velocity, radians(-40), 0}, {}, bench.now);
  bench.run(50ms);
  ck_assert(!bench.head->fault().empty());
  ck_assert_int_eq(bench.camera.values[id::kPanSpeed], 0);
  ck_assert(!bench.head->stopping());
}
END_TEST

START_TEST(a_camera_that_may_turn_and_is_gone_is_stopped_as_soon_as_it_is_back) {
  Bench bench;
  bench.camera = with_speeds(-160);
  bench.camera.ranges[id::kTiltSpeed].least = -120;
  bench.options.pan_speed = bench.options.tilt_speed = 80;
  bench.open();
  bench.head->move({Kind::velocity, radians(-20), 0}, {}, 0s);
  bench.run(100ms);
  bench.camera.set_error = bench.camera.open_error = EIO;
  bench.head->move({Kind::velocity, radians(-40), 0}, {}, bench.now);
  bench.run(500ms);
  ck_assert(bench.head->stopping());  // the process does not end before it has stopped the camera
  bench.camera.set_error = bench.camera.open_error = 0;
  bench.run(200ms);
  ck_assert_int_eq(bench.camera.values[id::kPanSpeed], 0);
  ck_assert(!bench.head->stopping());
  assert_text(bench.head->fault(), "");
}
END_TEST

START_TEST(an_axis_that_ceases_to_report_makes_no_pose) {
  for (const bool speed : {false, true}) {
    Bench bench;
    bench.camera = speed ? with_speeds(-160) : with_angles();
    if (speed) bench.camera.ranges[id::kTiltSpeed].least = -120;
    bench.options.pan_speed = bench.options.tilt_speed = 80;
    assert_text(bench.open(), "");
    bench.run(100ms);
    ck_assert(bench.head->take_pose(bench.now));
    bench.camera.unread = {id::kTiltAbsolute};
    bench.run(100ms);
    ck_assert(!bench.head->take_pose(bench.now));
    ck_assert(!bench.head->fault().empty());
    bench.run(2s);
    ck_assert(!bench.head->take_pose(bench.now));
    ck_assert(!bench.head->fault().empty());
    bench.camera.unread.clear();
    bench.run(1100ms);
    assert_text(bench.head->fault(), "");
    ck_assert(bench.head->take_pose(bench.now));
  }
}
END_TEST

START_TEST(a_camera_that_never_reports_one_of_its_axes_has_no_feedback) {
  Bench bench;
  bench.camera = with_speeds(-160);
  bench.camera.ranges[id::kTiltSpeed].least = -120;
  bench.camera.unread = {id::kTiltAbsolute};
  bench.options.pan_speed = bench.options.tilt_speed = 80;
  assert_text(bench.open(), "");
  ck_assert(!bench.head->abilities().feedback);
  // The axis that reports keeps its limits nevertheless.
  bench.head->move({Kind::velocity, radians(20), 0}, {}, 0s);
  bench.camera.values[id::kPanAbsolute] = 120 * 3600;
  bench.run(100ms);
  ck_assert(!bench.head->take_pose(bench.now));
  ck_assert_int_eq(bench.camera.values[id::kPanSpeed], 0);
  assert_text(bench.head->fault(), "");
}
END_TEST

START_TEST(a_speed_whose_minimum_is_wrong_is_not_used) {
  for (const std::int32_t least : {0, 1, -1}) {
    Bench bench;
    bench.camera = with_speeds(least);
    bench.options.pan_speed = bench.options.tilt_speed = 80;
    assert_text(bench.open(), "");
    ck_assert(bench.head->mode() == Mode::absolute);
    bench.options.mode = Mode::speed;
    ck_assert(bench.open().find("reports a wrong minimum of the pan or tilt speed of /dev/video9") !=
              std::string::npos);
  }
}
END_TEST

START_TEST(relative_moves_add_up) {
  Bench bench;
  bench.camera.ranges = {{id::kPanRelative, {-36000, 36000, 900}}, {id::kTiltRelative, {-36000, 36000, 900}}};
  assert_text(bench.open(), "");
  ck_assert(bench.head->mode() == Mode::relative);
  ck_assert(!bench.head->abilities().feedback);
  bench.head->move({Kind::position, radians(-25), radians(60)}, {}, 0s);
  bench.run(2s);
  long sum = 0;
  for (const auto& [control, value] : bench.camera.sets) sum += control == id::kPanRelative ? value : 0;
  ck_assert_int_eq(sum, -25 * 3600);
}
END_TEST

START_TEST(the_zoom_is_a_share_of_its_range) {
  Bench bench;
  bench.camera = with_angles();
  bench.camera.ranges[id::kZoomAbsolute] = {100, 500, 1};
  bench.camera.values[id::kZoomAbsolute] = 200;
  assert_text(bench.open(), "");
  ck_assert(!bench.head->take_zoom());
  bench.run(100ms);
  ck_assert_double_eq(bench.head->take_zoom().value_or(-1), .25);
  bench.camera.unread = {id::kZoomAbsolute};
  bench.head->take_zoom();
  bench.run(1s);
  ck_assert(!bench.head->take_zoom());
  assert_text(bench.head->fault(), "");  // it turns all the same
}
END_TEST

START_TEST(a_locked_zoom_is_set_and_kept) {
  Bench bench;
  bench.camera = with_angles();
  bench.camera.ranges[id::kZoomAbsolute] = {100, 500, 10};
  bench.options.zoom = .5;
  assert_text(bench.open(), "");
  bench.run(100ms);
  ck_assert_int_eq(bench.camera.values[id::kZoomAbsolute], 300);
  bench.camera.values[id::kZoomAbsolute] = 420;  // by hand
  bench.run(600ms);
  ck_assert_int_eq(bench.camera.values[id::kZoomAbsolute], 300);
  ck_assert_double_eq(bench.head->take_zoom().value_or(-1), .5);
  // What is reported is what the camera has, also where that is not what it was asked for.
  bench.camera.values[id::kZoomAbsolute] = 420;
  bench.camera.set_error = EBUSY;
  bench.run(600ms);
  ck_assert_double_eq(bench.head->take_zoom().value_or(-1), .8);
  bench.camera.set_error = 0;
  bench.camera.stuck = id::kZoomAbsolute;
  bench.run(600ms);
  ck_assert_double_eq(bench.head->take_zoom().value_or(-1), .8);
  bench.options.zoom = 1.5;
  ck_assert(says(bench.open(), "is kept at 0 to 1 of its range (lock-zoom), not at 1.5"));
  bench.options.zoom = .5;
  bench.camera.ranges.erase(id::kZoomAbsolute);
  ck_assert(says(bench.open(), "/dev/video9 has no zoom to lock"));
}
END_TEST

START_TEST(a_zoom_that_is_ordered_is_set_at_once) {
  Bench bench;
  bench.camera = with_angles();
  assert_text(bench.open(), "");
  ck_assert(!bench.head->abilities().zoom);
  bench.camera.ranges[id::kZoomAbsolute] = {100, 500, 10};
  bench.camera.values[id::kZoomAbsolute] = 100;
  assert_text(bench.open(), "");
  ck_assert(bench.head->abilities().zoom);
  bench.head->zoom(.5, 0s);
  ck_assert_int_eq(bench.camera.values[id::kZoomAbsolute], 300);
  bench.run(600ms);
  ck_assert_double_eq(bench.head->take_zoom().value_or(-1), .5);
  bench.head->zoom(1.5, 0s);  // the control has no digital zoom
  ck_assert_int_eq(bench.camera.values[id::kZoomAbsolute], 500);
  bench.options.zoom = .5;
  assert_text(bench.open(), "");
  ck_assert(!bench.head->abilities().zoom);  // it is locked
}
END_TEST

START_TEST(the_zoom_is_read_twice_a_second) {
  Bench bench;
  bench.camera = with_angles();
  bench.camera.ranges[id::kZoomAbsolute] = {100, 500, 10};
  assert_text(bench.open(), "");
  bench.run(10s);
  ck_assert_int_ge(bench.camera.reads[id::kZoomAbsolute], 19);
  ck_assert_int_le(bench.camera.reads[id::kZoomAbsolute], 21);
}
END_TEST

START_TEST(what_cannot_be_is_named) {
  Bench bench;
  assert_text(bench.open(),
              "the camera /dev/video9 has no controls for pan and tilt (v4l2-ctl -L lists them)");
  bench.camera.open_error = ENOENT;
  assert_text(bench.open(), "there is no camera /dev/video9 (v4l2-ctl --list-devices lists them)");
  bench.camera.open_error = EACCES;
  assert_text(bench.open(), "no permission to use /dev/video9: add the user to the group video");
  bench.camera = with_angles();
  bench.setup.limits.pan.to = radians(170);
  assert_text(bench.open(),
              "pan-min -120 and pan-max 170 are beyond what the camera /dev/video9 reaches, -130 to 130: set "
              "pan-min and pan-max");
  bench.camera = with_speeds(-160);
  bench.camera.ranges[id::kTiltSpeed].least = -120;
  bench.options.mode = Mode::speed;
  ck_assert(bench.open().find("the speeds of /dev/video9 have no unit") == 0);
}
END_TEST

START_TEST(a_camera_that_goes_away_is_reported_and_used_again) {
  Bench bench;
  bench.camera = with_angles();
  bench.open();
  bench.head->move({Kind::velocity, radians(20), 0}, {}, 0s);
  bench.run(500ms);
  bench.camera.set_error = ENODEV;
  bench.camera.open_error = ENOENT;
  bench.run(200ms);
  ck_assert(bench.head->fault().find("the camera /dev/video9 does not obey any more") == 0);
  bench.run(3s);
  bench.camera.set_error = bench.camera.open_error = 0;
  bench.run(1200ms);
  assert_text(bench.head->fault(), "");
  const auto there = bench.camera.values[id::kPanAbsolute];
  bench.run(1s);
  ck_assert_int_eq(bench.camera.values[id::kPanAbsolute], there);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "v4l2_head",
      {angles_go_in_arc_seconds_on_the_cameras_grid_along_the_plan, a_stop_leaves_little_to_stop,
       limits_between_two_steps_are_not_passed,
       speeds_are_shares_of_the_fastest_and_a_camera_at_its_limit_stops,
       a_speed_is_the_nearest_step_that_is_no_faster_than_the_limit,
       a_camera_without_positions_reports_its_speeds_and_stops_at_its_limits_by_them,
       a_stop_that_is_refused_is_set_again, a_camera_that_refuses_a_speed_is_stopped_before_it_is_given_up,
       a_camera_that_may_turn_and_is_gone_is_stopped_as_soon_as_it_is_back,
       an_axis_that_ceases_to_report_makes_no_pose,
       a_camera_that_never_reports_one_of_its_axes_has_no_feedback,
       a_speed_whose_minimum_is_wrong_is_not_used, relative_moves_add_up, the_zoom_is_a_share_of_its_range,
       a_locked_zoom_is_set_and_kept, a_zoom_that_is_ordered_is_set_at_once, the_zoom_is_read_twice_a_second,
       what_cannot_be_is_named, a_camera_that_goes_away_is_reported_and_used_again});
}
