// SPDX-License-Identifier: LGPL-2.1-or-later
// What every head driver promises, whatever it drives. A new driver adds a line to kDrivers. Drivers of real heads run
// in the test's own time, both ends of the line protocol and an emulated head included.
#include "drivers/head/head.h"

#include <cmath>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>
#include <type_traits>

#include "support/stepped_head.h"
#if HAVE_ONVIF
#include "support/onvif_plant.h"
#endif

#include "support/text.h"  // behind the others: check.h has a macro fail()

using namespace cerberus::motion;
using namespace cerberus::drivers;
using namespace std::chrono_literals;
using cerberus::sensing::degrees;
using cerberus::sensing::radians;
using cerberus::tests::assert_text;
using cerberus::tests::CameraPlant;
using cerberus::tests::HeadPlant;
using cerberus::tests::InvertedPlant;
using cerberus::tests::PelcoPlant;
using cerberus::tests::ServoPlant;
using cerberus::tests::SteppedHead;
using cerberus::tests::StepperPlant;
using cerberus::tests::ViscaPlant;
#if HAVE_ONVIF
using cerberus::tests::OnvifPlant;
#endif
using Kind = AxisCommand::Kind;

namespace {

using Made = std::unique_ptr<Head>;

template <typename Plant>
Made stepped() {
  return std::make_unique<SteppedHead>([](const HeadSetup& setup) -> std::unique_ptr<HeadPlant> {
    const auto dead_time = std::chrono::duration_cast<std::chrono::milliseconds>(setup.latency);
    if constexpr (std::is_same_v<Plant, CameraPlant>)
      return std::make_unique<Plant>(degrees(setup.pan), degrees(setup.tilt));
    else if constexpr (std::is_constructible_v<Plant, std::chrono::milliseconds>)
      return std::make_unique<Plant>(dead_time);
    else
      return std::make_unique<Plant>();
  });
}

struct Driver {
  const char* name;
  Made (*make)();
  double precision = 0;  // degrees: of the published pose, and of the head where one is emulated
};

// Precision: a half step of the stepper, a step of the camera with angles; 1.5 degrees for heads that only turn at speeds
// and report no position.
constexpr Driver kDrivers[] = {
    {"simulated", [] { return make_head("simulated"); }},
    {"scripted", [] { return make_head("scripted"); }},
    {"external", [] { return make_head("external"); }},
    {"stepper-gpio", stepped<StepperPlant>, 0.0883},
    {"servo-pwm", stepped<ServoPlant>, 0.01},
    {"v4l2", stepped<CameraPlant>, 0.1},
    {"pelco-d", stepped<PelcoPlant>, 1.5},
    {"visca", stepped<ViscaPlant>, 1.5},
    {"pelco-d inverted", stepped<InvertedPlant<PelcoPlant>>, 1.5},
    {"visca inverted", stepped<InvertedPlant<ViscaPlant>>, 1.5},
#if HAVE_ONVIF
    {"onvif", stepped<OnvifPlant>, 1.5},
    {"onvif inverted", stepped<InvertedPlant<OnvifPlant>>, 1.5},
#endif
};
constexpr int kFirstEmulated = 3;

HeadSetup setup() {
  HeadSetup setup;
  setup.latency = 60ms;
  setup.command = "sh -c 'read hello; echo ready 1 position velocity; cat >/dev/null'";  // of external
  return setup;
}

struct Opened {
  std::unique_ptr<Head> head;
  SteppedHead* stepped;  // nullptr: it has no hardware
  double slack;          // radians, beside what each test allows
  explicit Opened(int driver, const HeadSetup& with = setup())
      : head(kDrivers[driver].make()),
        stepped(dynamic_cast<SteppedHead*>(head.get())),
        slack(radians(kDrivers[driver].precision)) {
    ck_assert_ptr_nonnull(head.get());
    const std::string wrong = head->open(with);
    ck_assert_str_eq(wrong.c_str(), "");
  }
  void command(Time time, const AxisCommand& pan, const AxisCommand& tilt = {}) {
    const std::string wrong = head->command({time, pan, tilt});
    ck_assert_str_eq(wrong.c_str(), "");
  }
  Pose at(Time time) {
    if (stepped) stepped->advance(time);
    Pose pose;
    const std::string wrong = head->state(time, pose);
    ck_assert_str_eq(wrong.c_str(), "");
    ck_assert_int_eq(pose.from.count(), time.count());
    ck_assert(pose.until > time);
    return pose;
  }
  // Where it looks: the emulated hardware, or else what it publishes; radians.
  PanTilt where(Time time) {
    const Pose pose = at(time);
    if (!stepped) return {pose.pan.position, pose.tilt.position};
    return {radians(stepped->plant().pan()), radians(stepped->plant().tilt())};
  }
};

bool is_within(double position, const AxisLimits& limits, double slack) {
  return position >= limits.from - slack && position <= limits.to + slack;
}

}  // namespace

START_TEST(a_head_starts_at_rest_at_the_given_position) {
  HeadSetup there = setup();
  there.pan = 0.5;
  there.tilt = -0.25;
  Opened head(_i, there);
  const Pose pose = head.at(0s);
  ck_assert_double_eq_tol(pose.pan.position, 0.5, 1e-12 + head.slack);
  ck_assert_double_eq_tol(pose.tilt.position, -0.25, 1e-12 + head.slack);
  ck_assert(!pose.moving());
  ck_assert(pose.settled);
}
END_TEST

START_TEST(a_head_goes_where_it_is_sent_and_settles) {
  Opened head(_i);
  head.command(1s, {Kind::position, 1, 1}, {Kind::position, -0.5, 1});
  const Pose pose = head.at(30s);
  ck_assert_double_eq_tol(pose.pan.position, 1, 1e-6 + head.slack);
  ck_assert_double_eq_tol(pose.tilt.position, -0.5, 1e-6 + head.slack);
  ck_assert(pose.settled);
}
END_TEST

START_TEST(a_velocity_ends_at_the_stop_at_the_latest) {
  Opened head(_i);
  head.command(0s, {Kind::velocity, -100, 0}, {Kind::velocity, 100, 0});
  const Pose pose = head.at(600s);
  ck_assert_double_eq_tol(pose.pan.position, setup().limits.pan.from, 1e-6 + head.slack);
  ck_assert_double_eq_tol(pose.tilt.position, setup().limits.tilt.to, 1e-6 + head.slack);
}
END_TEST

START_TEST(no_command_leads_beyond_a_limit) {
  Opened head(_i);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(-20, 20);
  for (int k = 0; k < 500; ++k) {
    const Time now = k * 70ms;
    head.command(now, {static_cast<Kind>(k % 3), number(random), number(random)},
                 {static_cast<Kind>(k / 3 % 3), number(random), number(random)});
    for (Time t = now; t < now + 70ms; t += 10ms) {
      const Pose pose = head.at(t);
      ck_assert(is_within(pose.pan.position, setup().limits.pan, head.slack));
      ck_assert(is_within(pose.tilt.position, setup().limits.tilt, head.slack));
      ck_assert(is_within(head.where(t).pan, setup().limits.pan, head.slack));
      ck_assert(is_within(head.where(t).tilt, setup().limits.tilt, head.slack));
    }
  }
}
END_TEST

START_TEST(what_was_commanded_goes_on_within_other_limits) {
  for (const AxisCommand& command : {AxisCommand{Kind::position, 2, 1}, AxisCommand{Kind::velocity, 1, 0}}) {
    Opened head(_i);
    head.command(0s, command, command);
    Limits narrow;
    narrow.pan.to = 0.5;
    narrow.tilt.to = 0.25;
    for (const Time later : {1s, 31s}) {  // on the way, or at the stop; and once more
      ck_assert(head.head->limit(later, narrow).empty());
      ck_assert_double_eq_tol(head.at(later + 29s).pan.position, 0.5, 1e-9 + head.slack);
      ck_assert_double_eq_tol(head.at(later + 29s).tilt.position, 0.25, 1e-9 + head.slack);
    }
    ck_assert(head.head->limit(61s, {}).empty());
    ck_assert_double_eq_tol(head.at(90s).pan.position, command.kind == Kind::position ? 2 : Limits{}.pan.to,
                            1e-9 + head.slack);
  }
}
END_TEST

START_TEST(a_head_beyond_a_new_limit_returns_to_it) {
  for (const double side : {-1.0, 1.0}) {
    Opened head(_i);
    head.command(0s, {Kind::position, side * 2, 5}, {Kind::position, side * 0.6, 5});
    head.head->stop(10s);
    const Limits narrow{.pan = {-0.5, 0.5, 1, 2}, .tilt = {-0.25, 0.25, 1, 2}};
    ck_assert(head.head->limit(20s, narrow).empty());
    PanTilt last = head.where(20s);
    for (Time t = 20s; t < 30s; t += 10ms) {
      const PanTilt now = head.where(t);
      ck_assert(std::abs(now.pan) <= std::max(std::abs(last.pan), 0.5 + head.slack) + 1e-12);
      ck_assert(std::abs(now.tilt) <= std::max(std::abs(last.tilt), 0.25 + head.slack) + 1e-12);
      last = now;
    }
    ck_assert_double_eq_tol(last.pan, side * 0.5, 1e-9 + head.slack);
    ck_assert_double_eq_tol(last.tilt, side * 0.25, 1e-9 + head.slack);
  }
}
END_TEST

START_TEST(new_limits_make_no_command_stale_that_comes_with_them) {
  Opened head(_i);
  ck_assert(head.head->limit(5s, {}).empty());
  ck_assert(head.head->limit(4s, {}).empty());                                    // late, and safe
  ck_assert(!head.head->command({4500ms, {Kind::position, -1, 1}, {}}).empty());  // stale
  head.command(5s, {Kind::position, 1, 1});
  ck_assert_double_eq_tol(head.at(30s).pan.position, 1, 1e-6 + head.slack);
}
END_TEST

START_TEST(numbers_that_are_none_move_nothing) {
  HeadSetup there = setup();
  there.pan = 0.5;
  Opened head(_i, there);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double value : {nan, HUGE_VAL, -HUGE_VAL})
    for (const Kind kind : {Kind::position, Kind::velocity}) {
      head.command(1s, {kind, value, 1});
      ck_assert_double_eq_tol(head.at(60s).pan.position, 0.5, 1e-9 + head.slack);
    }
}
END_TEST

START_TEST(stop_stops_and_may_be_repeated) {
  Opened head(_i);
  head.command(0s, {Kind::velocity, 0.5, 0});
  head.head->stop(1s);
  head.head->stop(1s);
  head.head->stop(0s);  // late, and safe
  // What is stale stays so.
  ck_assert(!head.head->command({500ms, {Kind::position, 1, 1}, {}}).empty());
  const Pose pose = head.at(20s);
  ck_assert(!pose.moving());
  ck_assert_double_eq_tol(head.at(90s).pan.position, pose.pan.position, 1e-12 + head.slack);
  head.command(100s, {Kind::position, 0, 1});  // and it obeys again
  ck_assert_double_eq_tol(head.at(190s).pan.position, 0, 1e-6 + head.slack);
}
END_TEST

// Of an emulated head.

START_TEST(a_move_of_90_degrees_arrives_at_the_head_itself) {
  Opened head(_i);
  Time begin{};
  for (const double target : {90.0, -45.0, 0.0}) {
    head.command(begin += 20s, {Kind::position, radians(target), radians(40)},
                 {Kind::position, radians(target / 3), radians(20)});
    const Pose pose = head.at(begin + 15s);
    ck_assert_double_eq_tol(head.stepped->plant().pan(), target, kDrivers[_i].precision);
    ck_assert_double_eq_tol(head.stepped->plant().tilt(), target / 3, kDrivers[_i].precision);
    ck_assert_double_eq_tol(degrees(pose.pan.position), head.stepped->plant().pan(), kDrivers[_i].precision);
  }
}
END_TEST

START_TEST(the_hardware_gets_a_command_within_five_milliseconds) {
  Opened head(_i);
  for (int k = 1; k <= 20; ++k) {
    const Time begin = 10s * k + 7300us * k;  // at any moment of the driver's own period
    head.at(begin);
    const std::size_t before = head.stepped->plant().actions();
    head.command(begin, {k % 2 ? Kind::position : Kind::velocity, k % 4 < 2 ? 0.5 : -0.5, radians(40)});
    head.at(begin + 5ms);
    ck_assert_msg(head.stepped->plant().actions() > before, "%s, command %d", kDrivers[_i].name, k);
    head.command(begin + 5s, {});
  }
}
END_TEST

START_TEST(a_silent_pipeline_stops_the_head_within_half_a_second_more) {
  Opened head(_i);
  head.command(1s, {Kind::velocity, radians(20), 0});
  head.at(4s);
  ck_assert_double_gt(head.stepped->plant().pan(), 20);
  head.stepped->fall_silent();
  head.at(5s);  // 500 ms of silence, and as long to stop
  const double there = head.stepped->plant().pan();
  head.at(15s);
  ck_assert_double_eq(head.stepped->plant().pan(), there);
}
END_TEST

// With a position, a speed, and one given while the camera is away. A Pelco-D head that answers nothing is never known to
// be away.
START_TEST(after_an_outage_a_head_stands_until_the_next_command) {
  if (std::string(kDrivers[_i].name).starts_with("pelco-d")) return;
  const AxisCommand orders[] = {{Kind::position, radians(150), radians(40)},
                                {Kind::velocity, radians(40), 0},
                                {Kind::position, radians(-150), radians(40)}};
  for (const AxisCommand& order : orders) {
    Opened opened(_i);
    HeadPlant& plant = opened.stepped->plant();
    opened.command(100ms, order);
    opened.stepped->advance(1s);
    ck_assert_double_gt(std::abs(plant.pan()), 5);
    plant.unplug();
    opened.stepped->advance(2s);
    const std::string fault = opened.head->command({2s, order, {}});  // refused, and not kept
    ck_assert_msg(!fault.empty(), "%s", kDrivers[_i].name);
    opened.stepped->advance(5s);  // a camera that had its power has ended its move by then
    const double there = plant.pan();
    plant.plug();
    opened.stepped->advance(15s);
    ck_assert_msg(std::abs(plant.pan() - there) <= kDrivers[_i].precision,
                  "%s goes on, from %.1f to %.1f degrees", kDrivers[_i].name, there, plant.pan());
    opened.command(15s, {Kind::position, 0, radians(40)});
    opened.stepped->advance(25s);
    ck_assert_double_gt(std::abs(plant.pan() - there), 10);  // and obeys that
  }
}
END_TEST

START_TEST(a_stale_command_is_refused_and_changes_nothing) {
  Opened head(_i);
  head.command(2s, {Kind::position, 1, 1});
  const std::string refusal = head.head->command({1s, {Kind::position, -1, 1}, {}});
  ck_assert_msg(refusal.find("stale") != std::string::npos, "'%s'", refusal.c_str());
  ck_assert_double_eq_tol(head.at(60s).pan.position, 1, 1e-6 + head.slack);
}
END_TEST

START_TEST(limits_that_exclude_zero_are_refused) {
  const auto head = kDrivers[_i].make();
  HeadSetup wrong = setup();
  wrong.limits.pan.from = radians(10);
  ck_assert(head->open(wrong).find("exclude 0") != std::string::npos);
  wrong = setup();
  wrong.tilt = wrong.limits.tilt.to + 0.1;
  ck_assert(head->open(wrong).find("start-tilt") == 0);
  wrong = setup();
  wrong.pan = radians(175);
  assert_text(head->open(wrong), "start-pan 175 is not between pan-min -170 and pan-max 170");
  Pose pose;
  ck_assert(!head->state(0s, pose).empty());
}
END_TEST

START_TEST(a_head_that_is_not_open_is_safe_and_returns_an_error) {
  const auto head = kDrivers[_i].make();
  head->stop(0s);
  head->close();
  Pose pose;
  ck_assert(head->command({}).find("not open") != std::string::npos);
  ck_assert(head->limit(0s, {}).find("not open") != std::string::npos);
  ck_assert(head->state(0s, pose).find("not open") != std::string::npos);
  assert_text(head->open(setup()), "");
  head->close();
  head->close();
  head->stop(0s);
  ck_assert(!head->command({}).empty());
  assert_text(head->open(setup()), "");  // and again
  assert_text(head->command({}), "");
}
END_TEST

START_TEST(drivers_are_known_by_their_names) {
  ck_assert_ptr_null(make_head("nonsense").get());
  ck_assert_ptr_null(make_head("").get());
  for (const Driver& driver : kDrivers) {
    const std::string row = driver.name, name = row.substr(0, row.find(' '));  // without how it is mounted
    ck_assert(head_drivers().find(name) != std::string::npos);
  }
}
END_TEST

int main() {
  Suite* suite = suite_create("head_contract");
  TCase* cases = tcase_create("each driver");
  for (const TTest* test :
       {a_head_starts_at_rest_at_the_given_position, a_head_goes_where_it_is_sent_and_settles,
        a_velocity_ends_at_the_stop_at_the_latest, no_command_leads_beyond_a_limit,
        what_was_commanded_goes_on_within_other_limits, a_head_beyond_a_new_limit_returns_to_it,
        new_limits_make_no_command_stale_that_comes_with_them, numbers_that_are_none_move_nothing,
        stop_stops_and_may_be_repeated, a_stale_command_is_refused_and_changes_nothing,
        limits_that_exclude_zero_are_refused, a_head_that_is_not_open_is_safe_and_returns_an_error})
    tcase_add_loop_test(cases, test, 0, std::size(kDrivers));
  for (const TTest* test :
       {a_move_of_90_degrees_arrives_at_the_head_itself, the_hardware_gets_a_command_within_five_milliseconds,
        a_silent_pipeline_stops_the_head_within_half_a_second_more,
        after_an_outage_a_head_stands_until_the_next_command})
    tcase_add_loop_test(cases, test, kFirstEmulated, std::size(kDrivers));
  tcase_add_test(cases, drivers_are_known_by_their_names);
  suite_add_tcase(suite, cases);
  SRunner* runner = srunner_create(suite);
  srunner_run_all(runner, CK_ENV);
  const int failed = srunner_ntests_failed(runner);
  srunner_free(runner);
  return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
