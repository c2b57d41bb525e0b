// SPDX-License-Identifier: LGPL-2.1-or-later
// The option `invert`; head_contract.cpp runs the drivers behind it.
#include "drivers/head/inverted_head.h"
#include "drivers/head/reach.h"

#include <optional>
#include <utility>

#include "support/suite.h"
#include "support/text.h"

using namespace cerberus::drivers;
using namespace std::chrono_literals;
using cerberus::motion::AxisCommand;
using cerberus::motion::Limits;
using cerberus::tests::assert_text;
using Kind = AxisCommand::Kind;

namespace {

// Keeps what it was sent, and reports what it was given.
struct Noting final : HeadDevice {
  HeadSetup setup;
  AxisCommand pan, tilt;
  Limits limits;
  std::optional<PoseLine> pose;
  std::optional<SpeedsLine> speeds;
  std::optional<HomedLine> homed;
  int stops = 0, homes = 0;

  std::string open(const HeadSetup& with, Time) override {
    setup = with;
    return "what it says";
  }
  HeadAbilities abilities() const override { return {.velocity = true}; }
  void move(const AxisCommand& p, const AxisCommand& t, Time) override { pan = p, tilt = t; }
  void limit(const Limits& to, Time) override { limits = to; }
  void stop(Time) noexcept override { ++stops; }
  bool stopping() const override { return stops > 0; }
  void watch(std::vector<pollfd>&) const override {}
  Time tick(Time now) override { return now + 1s; }
  std::optional<PoseLine> take_pose(Time) override { return std::exchange(pose, std::nullopt); }
  std::optional<SpeedsLine> take_speeds(Time) override { return std::exchange(speeds, std::nullopt); }
  void home(Time) override { ++homes; }
  std::optional<HomedLine> take_homed(Time) override { return std::exchange(homed, std::nullopt); }
  std::string fault() const override { return "its fault"; }
};

Limits uneven() {
  Limits limits;
  limits.pan.from = -2, limits.pan.to = 1;
  limits.tilt.from = -.25, limits.tilt.to = .5;
  return limits;
}

}  // namespace

START_TEST(commands_limits_and_the_start_of_an_inverted_axis_are_negated) {
  const bool pan = _i & 1, tilt = _i & 2;
  const auto turned = [](bool inverted, double value) { return inverted ? -value : value; };
  Noting device;
  InvertedHead head(device, {pan, tilt});
  HeadSetup setup;
  setup.limits = uneven();
  setup.pan = .5;
  setup.tilt = .125;
  assert_text(head.open(setup, 0s), "what it says");
  ck_assert(device.setup.pan == turned(pan, .5) && device.setup.tilt == turned(tilt, .125));
  head.limit(uneven(), 1s);
  for (const Limits& limits : {device.setup.limits, device.limits}) {
    ck_assert(limits.pan.from == (pan ? -1 : -2) && limits.pan.to == (pan ? 2 : 1));
    ck_assert(limits.tilt.from == (tilt ? -.5 : -.25) && limits.tilt.to == (tilt ? .25 : .5));
  }
  head.move({Kind::position, 1.5, .75}, {Kind::velocity, -.25, 0}, 2s);
  ck_assert(device.pan == (AxisCommand{Kind::position, turned(pan, 1.5), .75}));
  ck_assert(device.tilt == (AxisCommand{Kind::velocity, turned(tilt, -.25), 0}));
  head.move({}, {}, 3s);
  ck_assert(device.pan.kind == Kind::hold && device.tilt.kind == Kind::hold);
}
END_TEST

START_TEST(reports_of_an_inverted_axis_are_negated_too) {
  const bool pan = _i & 1, tilt = _i & 2;
  const auto turned = [](bool inverted, double value) { return inverted ? -value : value; };
  Noting device;
  InvertedHead head(device, {pan, tilt});
  device.pose = PoseLine{{1, .5, 0}, {-.5, -.25, 0}, .125};
  const auto pose = head.take_pose(0s);
  ck_assert(pose && pose->age == .125);
  ck_assert(pose->pan.position == turned(pan, 1) && pose->pan.speed == turned(pan, .5));
  ck_assert(pose->tilt.position == turned(tilt, -.5) && pose->tilt.speed == turned(tilt, -.25));
  device.speeds = SpeedsLine{{1, -2}, .5};
  const auto speeds = head.take_speeds(0s);
  ck_assert(speeds && speeds->age == .5 && speeds->speed.pan == turned(pan, 1) &&
            speeds->speed.tilt == turned(tilt, -2));
  device.homed = HomedLine{{.5, .25}};
  const auto homed = head.take_homed(0s);
  ck_assert(homed && homed->at.pan == turned(pan, .5) && homed->at.tilt == turned(tilt, .25));
  ck_assert(!head.take_pose(0s) && !head.take_speeds(0s) && !head.take_homed(0s));
  device.homed = HomedLine{};
  assert_text(homed_line(*head.take_homed(0s)), "homed 0 0");
}
END_TEST

START_TEST(what_has_no_direction_goes_through) {
  Noting device;
  InvertedHead head(device, {true, true});
  head.stop(0s);
  head.home(0s);
  ck_assert(device.stops == 1 && device.homes == 1 && head.stopping());
  assert_text(head.fault(), "its fault");
  ck_assert(head.abilities().velocity && head.tick(2s) == 3s);
}
END_TEST

START_TEST(the_axes_are_named_or_both) {
  const struct {
    const char* word;
    bool pan, tilt;
  } good[] = {{"invert", true, true},
              {"invert=pan", true, false},
              {"invert=tilt", false, true},
              {"invert=pan,tilt", true, true}};
  for (const auto& one : good) {
    Inverted inverted;
    assert_text(parse_inverted(option_word(one.word), inverted), "");
    ck_assert(inverted.pan == one.pan && inverted.tilt == one.tilt);
  }
  Inverted two;
  for (const char* word : {"invert=pan", "invert=tilt"})
    assert_text(parse_inverted(option_word(word), two), "");
  ck_assert(two.pan && two.tilt);
  for (const char* word : {"invert=", "invert=yes", "invert=pan,", "invert=Pan"}) {
    Inverted inverted;
    ck_assert(parse_inverted(option_word(word), inverted).find("invert=pan") != std::string::npos);
    ck_assert(!inverted.any());
  }
}
END_TEST

// The range is the camera's own: -30 is 30 where it hangs upside down.
START_TEST(limits_are_compared_with_the_range_of_the_camera_as_it_hangs) {
  Limits limits = uneven();
  limits.tilt.from = cerberus::sensing::radians(-80), limits.tilt.to = cerberus::sensing::radians(20);
  const auto beyond = [&](const char* options) {
    return beyond_reach("onvif", option_words(options), limits);
  };
  assert_text(beyond("range=-170,170,-90,90"), "");
  assert_text(beyond("range=-170,170,-30,90 invert"), "");
  assert_text(beyond("invert=tilt range=-170,170,-30,90"), "");
  for (const char* options : {"range=-170,170,-30,90", "range=-170,170,-30,90 invert=pan"})
    assert_text(beyond(options),
                "tilt-min -80 and tilt-max 20 are beyond what the camera reaches, -30 to 90 (range): set "
                "tilt-min and tilt-max");
  ck_assert(beyond("range=-100,170,-90,90").starts_with("pan-min"));
  for (const char* options : {"range=-170,170,x,-30,90", "range=-170,170,-30", "range=90,-90,-30,30", ""})
    assert_text(beyond(options), "");
  assert_text(beyond_reach("visca", option_words("range=-1,1,-1,1"), limits), "");
}
END_TEST

int main() {
  Suite* suite = suite_create("inverted_head");
  TCase* tests = tcase_create("inverted_head");
  tcase_add_loop_test(tests, commands_limits_and_the_start_of_an_inverted_axis_are_negated, 0, 4);
  tcase_add_loop_test(tests, reports_of_an_inverted_axis_are_negated_too, 0, 4);
  tcase_add_test(tests, what_has_no_direction_goes_through);
  tcase_add_test(tests, the_axes_are_named_or_both);
  tcase_add_test(tests, limits_are_compared_with_the_range_of_the_camera_as_it_hangs);
  suite_add_tcase(suite, tests);
  SRunner* runner = srunner_create(suite);
  srunner_run_all(runner, CK_ENV);
  const int failed = srunner_ntests_failed(runner);
  srunner_free(runner);
  return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
