// SPDX-License-Identifier: LGPL-2.1-or-later
// The ONVIF driver against an emulated camera: moves, stops, positions. Most of it in the test's own time; over loopback
// HTTP and in real time what needs both.
#include "sensing/angles.h"
#include "support/onvif_plant.h"
#include "support/onvif_rig.h"
#include "support/stepped_head.h"
#include "support/stepped_helper.h"

#include "support/suite.h"
#include "support/text.h"
#include "support/time_bounds.h"

using namespace cerberus::drivers;
using namespace cerberus::tests;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

namespace {

// In the test's own time.
struct Rig {
  OnvifPlant plant;
  OnvifCamera& camera = plant.camera;
  SteppedHelper served;

  explicit Rig(OnvifFaults faults = {}, const std::function<void(OnvifOptions&)>& adjust = {})
      : plant(std::move(faults), adjust, 2ms), served(plant) {}

  // Drives the camera to the right until its driver stops it. Returns the pan angle at which it stands.
  double stopped_at_its_limit() {
    served.run(3s);  // whatever was lost is over
    ck_assert(served.until([&] { return camera.speed() > 19; }, "move at 20 hold"));
    ck_assert(served.until([&] { return camera.speed() == 0; }, "move at 20 hold"));
    return camera.pan();
  }
};

// With the position range of the emulated camera, so that it has positions.
void with_range(OnvifOptions& options) {
  options.mechanics.least = onvif::Angles{-OnvifCamera::kPanEnd, -OnvifCamera::kTiltEnd};
  options.mechanics.most = onvif::Angles{OnvifCamera::kPanEnd, OnvifCamera::kTiltEnd};
}

}  // namespace

START_TEST(a_camera_turns_and_stops) {
  OnvifCamera camera;
  OnvifRig rig(camera);
  assert_text(rig.served.line("ready"), "ready 1 velocity alive rate 10");
  rig.served.say("move at 45 hold");
  ck_assert(rig.served.until([&] { return camera.pan() > 5; }));
  ck_assert_double_eq_tol(camera.speed(), 45, 1e-9);
  ck_assert_double_eq(camera.tilt(), 0);
  rig.served.say("move hold hold");
  ck_assert(rig.served.until([&] { return camera.speed() == 0; }));
}
END_TEST

START_TEST(pan_is_positive_to_the_right_and_tilt_up) {
  Rig rig;
  rig.served.line("ready");
  rig.served.say("move at -20 at 10");
  ck_assert(rig.served.until([&] { return rig.camera.pan() < -1 && rig.camera.tilt() > .5; }));
}
END_TEST

START_TEST(a_move_has_a_timeout_and_is_sent_again_before_it_is_over) {
  Rig rig;
  rig.served.line("ready");
  rig.served.say("move at 20 hold");
  ck_assert(rig.served.until([&] { return rig.camera.pan() > 30; }));  // 1.5 s: longer than the Timeout
  assert_text(rig.camera.timeout(), "PT1S");
  ck_assert_double_eq_tol(rig.camera.speed(), 20, 1e-9);
  ck_assert_int_le(rig.camera.count("ContinuousMove"), 5);
}
END_TEST

// A pipeline that is wrong, or cerberus-heads move: this one would drive on for ever.
START_TEST(a_camera_without_positions_is_stopped_a_little_beyond_its_limits_by_the_speeds_that_it_was_sent) {
  Rig rig;
  assert_text(rig.served.line("ready"), "ready 1 velocity alive rate 10");
  rig.served.say("limits -5 5 -5 5");
  rig.served.say("move at 20 hold");
  ck_assert(rig.served.until([&] { return rig.camera.pan() > 5 && rig.camera.speed() == 0; }));
  ck_assert_double_lt(rig.camera.pan(),
                      5 + 2 + 20 * .05);  // the slack, and 50 ms of the driver and the camera
  rig.served.say("move at 20 at 10");
  ck_assert(rig.served.until([&] { return rig.camera.tilt() > 4; }));
  ck_assert_double_eq(rig.camera.speed(), 0);  // the other axis turns
  ck_assert(rig.served.until([&] { return rig.camera.pan() < -4; }, "move at -20 hold"));
  ck_assert(rig.served.until([&] { return rig.camera.speed() == 0; }, "move at -20 hold"));
  ck_assert_double_gt(rig.camera.pan(), -5 - 2 - 20 * .05);
}
END_TEST

// The camera ignores its Timeout, so that only Stop stops it.
START_TEST(silence_and_the_end_of_the_pipeline_stop_the_camera_within_half_a_second) {
  for (const bool silent : {true, false}) {
    OnvifCamera camera({.ignores_timeout = true});
    OnvifRig rig(onvif_options(camera), {}, silent ? "0.2" : "5");
    rig.served.line("ready");
    rig.served.say("move at -45 hold");
    ck_assert(rig.served.until([&] { return camera.speed() < -44; }, "move at -45 hold"));
    const auto last_word = Clock::now();
    if (!silent) rig.served.hang_up();
    while (camera.speed() != 0 && Clock::now() - last_word < 60s) std::this_thread::sleep_for(2ms);
    ck_assert(camera.speed() == 0);
    ck_assert(cerberus::tests::in_time(camera.stopped() - last_word, 500ms));
  }
}
END_TEST

START_TEST(the_camera_stops_by_its_own_timeout_when_the_helper_is_gone) {
  Rig rig;
  ck_assert(rig.served.until([&] { return rig.camera.speed() > 44; }, "move at 45 hold"));
  const Time killed = rig.served.now();  // from now on the helper does nothing
  rig.plant.elapse(killed + 900ms);
  ck_assert_double_gt(rig.camera.speed(), 44);
  rig.plant.elapse(killed + 1s);  // the Timeout
  ck_assert_double_eq(rig.camera.speed(), 0);
}
END_TEST

START_TEST(a_stop_is_sent_until_the_camera_acknowledges_it) {
  Rig rig({.ignores_timeout = true});
  ck_assert(rig.served.until([&] { return rig.camera.speed() > 44; }, "move at 45 hold"));
  rig.camera.lose_stops(3);
  rig.served.hang_up();
  rig.served.run(500ms);
  ck_assert_double_eq(rig.camera.speed(), 0);
  ck_assert_int_eq(rig.served.status(), 0);
}
END_TEST

// The camera goes on for three times 150 ms at 20 degrees a second: 9 degrees. Without them it would be stopped 9 degrees
// beyond its limit of 40, with a slack of 2.
START_TEST(a_camera_without_positions_is_reckoned_to_turn_on_while_its_stops_are_lost) {
  Rig rig;
  rig.served.say("limits -5 40 -5 5");
  ck_assert(rig.served.until([&] { return rig.camera.pan() > 10; }, "move at 20 hold"));
  rig.camera.lose_stops(3);
  rig.served.say("move hold hold");
  ck_assert(rig.served.until([&] { return rig.camera.speed() == 0; }));
  ck_assert_double_gt(rig.camera.pan(), 10 + 20 * .4);
  ck_assert_double_eq_tol(rig.stopped_at_its_limit(), 40 + 2, 20 * .05);
}
END_TEST

// Nothing but its own Timeout ends the move, .5 to 1 s later: it has turned by 10 to 20 degrees.
START_TEST(a_camera_that_cannot_be_reached_is_reckoned_to_turn_until_its_timeout_is_over) {
  Rig rig;
  rig.served.say("limits -5 60 -5 5");
  ck_assert(rig.served.until([&] { return rig.camera.pan() > 10; }, "move at 20 hold"));
  rig.camera.lose_stops(1000);
  rig.served.say("move hold hold");
  assert_text(rig.served.line("fault").substr(0, 5), "fault");
  rig.served.run(1s);
  ck_assert_double_eq(rig.camera.speed(), 0);
  ck_assert_double_gt(rig.camera.pan(), 10 + 20 * .4);
  rig.camera.lose_stops(0);
  assert_text(rig.served.line("recovered"), "recovered");
  ck_assert_double_eq_tol(rig.stopped_at_its_limit(), 60 + 2, 20 * .05);
}
END_TEST

// MoveStatus is the only sign that the camera still moves.
START_TEST(a_camera_that_acknowledges_stop_and_goes_on_is_stopped_again) {
  Rig rig({.ignores_timeout = true, .swallows_stops = 2});
  rig.served.line("ready");
  rig.served.say("move at 45 hold");
  ck_assert(rig.served.until([&] { return rig.camera.pan() > 30; }));
  rig.served.hang_up();
  ck_assert_int_eq(rig.served.status(), 0);
  ck_assert_double_eq(rig.camera.speed(), 0);
}
END_TEST

START_TEST(a_move_that_the_camera_obeys_after_the_stop_is_stopped_as_well) {
  Rig rig({.ignores_timeout = true, .move_delay = 400ms});
  rig.served.line("ready");
  rig.served.say("move at 45 hold");
  rig.served.run(100ms);  // it is on its way
  rig.served.hang_up();
  ck_assert_int_eq(rig.served.status(), 0);
  rig.served.run(500ms);  // the move is obeyed, whatever has ended before
  ck_assert_double_eq(rig.camera.speed(), 0);
  ck_assert_int_ge(rig.camera.count("ContinuousMove"), 1);
}
END_TEST

START_TEST(the_newest_move_waits_for_the_answer_to_the_last_one) {
  Rig rig({.delay = 150ms});
  rig.served.line("ready");
  const int before = rig.camera.count("ContinuousMove");
  for (int k = 1; k <= 40; ++k) {  // 0.4 s
    rig.served.say("move at " + std::to_string(k) + " hold");
    rig.served.run(10ms);
  }
  ck_assert(rig.served.until([&] { return std::abs(rig.camera.speed() - 40) < 1e-9; }));
  ck_assert_int_le(rig.camera.count("ContinuousMove") - before, 6);
}
END_TEST

START_TEST(positions_are_reported_and_a_camera_at_its_limit_is_stopped) {
  Rig rig({}, with_range);
  assert_text(rig.served.line("ready"), "ready 1 velocity feedback alive rate 10");
  rig.served.say("limits -10 10 -10 10");
  ck_assert(
      rig.served.until([&] { return rig.camera.pan() > 8 && rig.camera.speed() == 0; }, "move at 45 hold"));
  ck_assert_double_le(rig.camera.pan(), 10.5);
  const std::string pose = rig.served.line("pose");
  ck_assert_msg(pose.starts_with("pose "), "%s", pose.c_str());
  ck_assert(rig.served.until([&] { return rig.camera.speed() < -40; }, "move at -45 hold"));
}
END_TEST

START_TEST(a_camera_with_absolute_moves_goes_to_an_angle) {
  Rig rig({.degrees = true}, [](OnvifOptions& options) { options.absolute = true; });
  assert_text(rig.served.line("ready"), "ready 1 position velocity feedback alive rate 10");
  rig.served.line("pose");
  rig.served.say("move to 30 60 to -5 20");
  ck_assert(rig.served.until(
      [&] { return std::abs(rig.camera.pan() - 30) < .01 && std::abs(rig.camera.tilt() + 5) < .01; }));
  ck_assert_int_eq(rig.camera.count("AbsoluteMove"), 1);
  // The first turn is made at a speed, until a report shows it: the next ones are not.
  const int moves = rig.camera.count("ContinuousMove");
  rig.served.say("move to -30 60 to 5 20");
  ck_assert(rig.served.until(
      [&] { return std::abs(rig.camera.pan() + 30) < .01 && std::abs(rig.camera.tilt() - 5) < .01; }));
  ck_assert_int_eq(rig.camera.count("AbsoluteMove"), 2);
  ck_assert_int_eq(rig.camera.count("ContinuousMove"), moves);
}
END_TEST

START_TEST(a_camera_that_claims_absolute_moves_and_refuses_them_is_turned_at_speeds) {
  Rig rig({.degrees = true, .refuses_absolute = true},
          [](OnvifOptions& options) { options.absolute = true; });
  assert_text(rig.served.line("ready"), "ready 1 position velocity feedback alive rate 10");
  rig.served.say("move to 30 60 to -5 20");
  ck_assert(rig.served.until(
      [&] { return std::abs(rig.camera.pan() - 30) < .6 && std::abs(rig.camera.tilt() + 5) < .6; }));
  ck_assert(rig.served.until([&] { return rig.camera.speed() == 0; }));
  ck_assert_int_eq(rig.camera.count("AbsoluteMove"), 0);
}
END_TEST

// Where its motors are when it is switched on is not where it says that it is.
START_TEST(a_camera_that_always_reports_zero_is_not_turned_at_the_start) {
  for (const bool degrees : {false, true}) {
    OnvifFaults faults;
    faults.degrees = degrees;
    faults.status_at_zero = true;
    OnvifPlant plant(
        faults,
        [](OnvifOptions& options) {
          with_range(options);
          options.absolute = true;
        },
        2ms);
    plant.camera.look(40, 10);
    SteppedHelper served(plant);
    served.line("pose");
    served.run(3s);
    ck_assert(plant.camera.pan() == 40 && plant.camera.tilt() == 10);
    for (const char* move : {"ContinuousMove", "AbsoluteMove", "RelativeMove", "GotoPreset"})
      ck_assert_int_eq(plant.camera.count(move), 0);
  }
}
END_TEST

START_TEST(positions_that_do_not_follow_the_camera_are_not_believed) {
  for (const bool absolute : {false, true}) {
    std::string warning;
    OnvifFaults faults;
    faults.status_at_zero = true;
    OnvifPlant plant(
        faults,
        [&](OnvifOptions& options) {
          with_range(options);
          options.absolute = absolute;
          options.warn = [&](const std::string& text) { warning = text; };
        },
        2ms);
    SteppedHelper served(plant);
    served.line("ready");
    served.say("move at 10 hold");
    ck_assert(served.until([&] { return !warning.empty(); }));
    ck_assert_msg(
        warning.ends_with(
            "turns and reports the same position all the time: its positions are not used (no-feedback)"),
        "%s", warning.c_str());
    ck_assert_double_le(plant.camera.pan(), 20);
    // From now on the pipeline reckons, and so does the driver: to a limit, and to an angle.
    const std::string speeds = served.line("speeds");
    ck_assert_msg(speeds.starts_with("speeds 10 0 "), "%s", speeds.c_str());
    served.say("limits -60 60 -10 10");
    served.run(100ms);
    ck_assert(served.until([&] { return plant.camera.speed() == 0; }, "move at 20 hold"));
    ck_assert_double_eq_tol(plant.camera.pan(), 60, 3);
    if (absolute) {
      ck_assert(
          served.until([&] { return std::abs(plant.camera.pan() + 30) < 3 && plant.camera.speed() == 0; },
                       "move to -30 40 to 0 20"));
      ck_assert_int_eq(plant.camera.count("AbsoluteMove"), 0);
    }
    assert_text(plant.device().fault(), "");
    // A camera whose reports move after all is believed again.
    plant.camera.release_status();
    ck_assert(served.until([&] { return plant.camera.speed() < -9; }, "move at -10 hold"));
    std::string pose;
    for (int i = 0; i < 100 && !pose.starts_with("pose -"); ++i) pose = served.line("pose");
    ck_assert_msg(pose.starts_with("pose -"), "%s", pose.c_str());
  }
}
END_TEST

// The whole way from the pipeline's commands to the camera: to an angle, and as far as a limit.
START_TEST(a_head_with_false_positions_goes_where_it_is_sent_and_not_beyond_its_limits) {
  using cerberus::motion::AxisCommand;
  using cerberus::sensing::radians;
  using Kind = AxisCommand::Kind;
  for (const bool absolute : {false, true}) {
    SteppedHead head([&](const HeadSetup& setup) -> std::unique_ptr<HeadPlant> {
      OnvifFaults faults;
      faults.status_at_zero = true;
      faults.dead_time = std::chrono::duration_cast<std::chrono::milliseconds>(setup.latency);
      return std::make_unique<OnvifPlant>(
          faults,
          [&](OnvifOptions& options) {
            with_range(options);
            options.absolute = absolute;
          },
          20ms);
    });
    HeadSetup setup;
    setup.latency = 200ms;
    setup.limits.pan = {radians(-70), radians(70), radians(90), radians(600)};
    assert_text(head.open(setup), "");
    double most = 0;
    const auto run = [&](Time from, Time to) {
      for (Time now = from; now < to; now += 20ms) {
        head.advance(now);
        most = std::max(most, std::abs(head.plant().pan()));
      }
    };
    assert_text(head.command({100ms, {Kind::position, radians(60), radians(90)}, {}}), "");
    run(100ms, 6s);
    ck_assert_double_eq_tol(head.plant().pan(), 60, 10);
    ck_assert_double_le(most, 86);  // its dead time at 80 degrees a second
    assert_text(head.command({6s, {Kind::velocity, radians(-80), 0}, {}}), "");
    run(6s, 12s);
    ck_assert_double_eq_tol(head.plant().pan(), -70, 10);
    ck_assert_double_le(most, 86);  // its dead time at 80 degrees a second
    assert_text(head.fault(), "");
  }
}
END_TEST

START_TEST(a_camera_that_refuses_a_timeout_by_any_fault_is_driven_without) {
  for (const char* code :
       {"TimeoutNotSupported", "InvalidArgs", "InvalidVelocity", "ActionNotSupported", "Oops", "HTTP"}) {
    std::string warning;
    OnvifFaults faults;
    faults.refuses_timeout = code;
    Rig rig(faults,
            [&](OnvifOptions& options) { options.warn = [&](const std::string& text) { warning = text; }; });
    rig.served.line("ready");
    ck_assert(
        rig.served.until([&] { return rig.camera.speed() > 44 && !warning.empty(); }, "move at 45 hold"));
    assert_text(rig.camera.timeout(), "");
    ck_assert_msg(
        warning.ends_with("takes no Timeout in a move: if cerberus-head is killed, nothing stops it"), "%s",
        warning.c_str());
    assert_text(rig.plant.device().fault(), "");
    // The camera's own default may end a move: it is sent again.
    const int moves = rig.camera.count("ContinuousMove");
    for (int i = 0; i < 200; ++i) {
      rig.served.say("move at 45 hold");
      rig.served.run(10ms);
    }
    ck_assert_int_ge(rig.camera.count("ContinuousMove"), moves + 3);
    rig.served.say("stop");
    ck_assert(rig.served.until([&] { return rig.camera.speed() == 0; }));
    // Silence stops it as any camera.
    ck_assert(rig.served.until([&] { return rig.camera.speed() > 44; }, "move at 45 hold"));
    rig.served.run(6s);
    ck_assert_double_eq(rig.camera.speed(), 0);
  }
}
END_TEST

START_TEST(a_camera_that_refuses_moves_for_another_reason_keeps_its_timeout) {
  OnvifFaults faults;
  faults.refuses_moves = true;
  Rig rig(faults);
  rig.served.line("ready");
  rig.served.say("move at 45 hold");
  ck_assert(!rig.served.line("fault").empty());
  rig.camera.allow_moves();
  ck_assert(!rig.served.line("recovered").empty());
  ck_assert(rig.served.until([&] { return rig.camera.speed() > 44; }, "move at 45 hold"));
  assert_text(rig.camera.timeout(), "PT1S");
}
END_TEST

START_TEST(limits_beyond_the_range_are_refused) {
  Rig rig({}, [](OnvifOptions& options) {
    options.mechanics.least = onvif::Angles{-170, -30};
    options.mechanics.most = onvif::Angles{170, 90};
  });
  const std::string fault = rig.served.line("fault");
  ck_assert_msg(
      fault.find("tilt-min -45 and tilt-max 45 are beyond what the ONVIF camera at ") != std::string::npos &&
          fault.ends_with("reaches, -30 to 90 (range): set tilt-min and tilt-max"),
      "%s", fault.c_str());
}
END_TEST

START_TEST(a_range_is_used_or_said_not_to_be) {
  const struct {
    const char* why;  // nothing: it is used
    OnvifFaults faults;
    bool feedback = true;
  } cases[] = {
      {nullptr, {}},
      {nullptr, {.position_space = "none"}},
      {nullptr, {.position_space = "none", .refuses_options = true}},
      {"reports its position in degrees", {.degrees = true}},
      {"reports no position", {.positions = false}},
      {"reports its position in a space of its own (urn:steps)", {.position_space = "urn:steps"}},
      {"has no-feedback", {}, false},
  };
  for (const auto& one : cases) {
    std::string warnings;
    Rig rig(one.faults, [&](OnvifOptions& options) {
      with_range(options);
      options.feedback = one.feedback;
      options.warn = [&](const std::string& text) { warnings += text; };
    });
    const bool reports = !one.why || one.faults.degrees;
    assert_text(rig.served.line("ready"),
                reports ? "ready 1 velocity feedback alive rate 10" : "ready 1 velocity alive rate 10");
    if (one.why)
      ck_assert_msg(warnings.ends_with(std::string(one.why) + ": range= is not used"), "%s",
                    warnings.c_str());
    else
      assert_text(warnings, "");
    if (!reports) continue;
    ck_assert(rig.served.until([&] { return rig.camera.pan() > 34; }, "move at 20 hold"));
    ck_assert(rig.served.until([&] { return rig.camera.speed() == 0; }, "stop"));
    rig.served.run(1s);
    std::string pose;
    for (int i = 0; i < 20; ++i) pose = rig.served.line("pose");
    ck_assert_double_eq_tol(std::stod(pose.substr(5)), rig.camera.pan(), .1);
  }
}
END_TEST

START_TEST(a_profile_without_a_ptz_configuration_is_used_where_it_or_its_node_is_named) {
  for (const char* name : {"still", "main", "moving", "node0", "dome"})
    for (const bool nodes : {true, false}) {
      const bool is_node = *name == 'n' || *name == 'd';
      OnvifFaults faults;
      faults.no_ptz_profile = faults.moves_any_profile = true;
      faults.no_nodes = !nodes;
      Rig rig(faults, [&](OnvifOptions& options) {
        with_range(options);
        options.login.profile = name;
      });
      if (is_node && !nodes) {
        const std::string fault = rig.served.line("fault");
        ck_assert_msg(fault.find("it has still, moving") != std::string::npos, "%s", fault.c_str());
        continue;
      }
      assert_text(rig.served.line("ready"), "ready 1 velocity feedback alive rate 10");
      ck_assert(rig.served.until([&] { return rig.camera.speed() > 44; }, "move at 45 hold"));
      const std::string profile = *name == 'm' ? "moving" : "still";
      ck_assert(rig.camera.requests().back().find("<ProfileToken>" + profile + "</ProfileToken>") !=
                std::string::npos);
    }
}
END_TEST

START_TEST(a_camera_without_positions_finds_its_reference_by_a_preset) {
  using MoveStatus = OnvifFaults::MoveStatus;
  for (const char* preset : {"home", "ahead"}) {
    OnvifFaults faults;
    faults.positions = false;
    faults.move_status = *preset == 'h' ? MoveStatus::alive : MoveStatus::absent;
    Rig rig(faults, [preset](OnvifOptions& options) {
      options.home = *preset == 'h';
      if (!options.home) options.login.preset = preset;
      options.home_time = 1s;
    });
    assert_text(rig.served.line("ready"), "ready 1 velocity home alive rate 10");
    ck_assert(rig.served.until([&] { return rig.camera.pan() > 20; }, "move at 80 hold"));
    rig.served.say("home");
    assert_text(rig.served.line("homed"), "homed 0 0");
    ck_assert_double_eq_tol(rig.camera.pan(), 0, .01);
    ck_assert(rig.served.until([&] { return rig.camera.speed() < 0; }, "move at -45 hold"));
  }
}
END_TEST

START_TEST(a_preset_that_is_not_there_is_a_fault) {
  OnvifFaults faults;
  faults.positions = false;
  OnvifCamera camera(faults);
  OnvifOptions options = onvif_options(camera);
  options.login.preset = "gone";  // listed, and not there
  OnvifRig rig(options);
  rig.served.line("ready");
  rig.served.say("home");
  const std::string fault = rig.served.line("fault");
  ck_assert_msg(fault.find("NoToken: no such preset") != std::string::npos, "%s", fault.c_str());
}
END_TEST

START_TEST(a_preset_that_is_not_listed_is_named_with_those_that_are) {
  OnvifCamera camera;
  OnvifOptions options = onvif_options(camera);
  options.login.preset = "door";
  OnvifRig rig(options);
  const std::string fault = rig.served.line("fault");
  ck_assert_msg(fault.ends_with("has no preset \"door\"; it has 1 (ahead), 2 (gone)"), "%s", fault.c_str());
}
END_TEST

START_TEST(a_locked_zoom_is_set_at_the_start_and_again_while_the_head_stands) {
  OnvifFaults faults;
  faults.zooms = true;
  Rig rig(faults, [](OnvifOptions& options) { options.login.zoom = .25; });
  ck_assert_double_eq(rig.camera.zoom(), .25);
  assert_text(rig.served.line("zoom"), "zoom 0.25");
  ck_assert_double_eq(rig.camera.pan(), 0);
  // By hand, while the head turns: an AbsoluteMove might end its move.
  ck_assert(rig.served.until([&] { return rig.camera.speed() > 9; }, "move at 10 hold"));
  rig.camera.set_zoom(.5);
  assert_text(rig.served.line("zoom"), "zoom 0.5");
  for (int k = 0; k < 600; ++k) {
    rig.served.say("move at 10 hold");
    rig.served.run(10ms);
  }
  ck_assert_double_eq(rig.camera.zoom(), .5);
  rig.served.say("stop");
  ck_assert(rig.served.until([&] { return rig.camera.zoom() == .25; }));
}
END_TEST

START_TEST(a_zoom_that_is_ordered_is_set_while_the_head_stands_and_dropped_while_it_turns) {
  OnvifFaults faults;
  faults.zooms = true;
  faults.widest = 1;
  faults.longest = 21;
  Rig rig(faults, [](OnvifOptions&) {});
  ck_assert(rig.served.line("ready").find(" zoom ") != std::string::npos);
  ck_assert(rig.served.until([&] { return rig.camera.zoom() == .25; }, "zoom 0.25"));
  assert_text(rig.served.line("zoom 0.25"), "zoom 0.25");
  ck_assert(rig.served.until([&] { return rig.camera.speed() > 9; }, "move at 10 hold"));
  rig.served.say("zoom 0.5");
  for (int k = 0; k < 100; ++k) {
    rig.served.say("move at 10 hold");
    rig.served.run(10ms);
  }
  rig.served.say("move hold hold");
  for (int k = 0; k < 200; ++k) {
    rig.served.say("alive");
    rig.served.run(10ms);
  }
  ck_assert_double_eq(rig.camera.zoom(), .25);
}
END_TEST

START_TEST(a_zoom_of_another_range_is_a_share_of_it) {
  OnvifFaults faults;
  faults.zooms = true;
  faults.widest = 1;
  faults.longest = 21;
  Rig rig(faults, [](OnvifOptions& options) { options.login.zoom = .25; });
  ck_assert_double_eq(rig.camera.zoom(), .25);
  assert_text(rig.served.line("zoom"), "zoom 0.25");
}
END_TEST

// The second login begins after some answers that are no SOAP.
START_TEST(a_zoom_that_cannot_be_kept_any_more_is_a_warning_and_the_head_turns) {
  for (const bool options_fail : {false, true}) {
    OnvifFaults faults;
    faults.zooms = true;
    std::string warned;
    Rig rig(faults, [&](OnvifOptions& options) {
      options.login.zoom = .25;
      options.warn = [&](const std::string& text) { warned = text; };
    });
    assert_text(rig.served.line("ready").substr(0, 5), "ready");
    if (options_fail)
      rig.camera.refuse_options();
    else
      rig.camera.refuse_zoom();
    assert_text(warned, "");
    rig.camera.set_garbage(5);
    ck_assert(!rig.served.line("fault").empty());
    assert_text(rig.served.line("recovered"), "recovered");
    ck_assert(rig.served.until([&] { return rig.camera.speed() > 9; }, "move at 10 hold"));
    const char* words = options_fail
                            ? "does not answer GetConfigurationOptions (NotNow: no options)"
                            : "does not keep its zoom where lock-zoom has it (SpaceNotSupported: no zoom)";
    ck_assert_msg(warned.find(words) != std::string::npos, "%s", warned.c_str());
  }
}
END_TEST

START_TEST(a_zoom_that_cannot_be_kept_is_an_error) {
  for (const bool claims : {false, true}) {
    OnvifFaults faults;
    faults.zooms = claims;
    faults.refuses_zoom = true;
    Rig rig(faults, [](OnvifOptions& options) { options.login.zoom = 0; });
    const std::string fault = rig.served.line("fault");
    const char* words = claims ? "does not keep its zoom where lock-zoom has it (SpaceNotSupported: no zoom)"
                               : "has no absolute zoom in the profile \"moving\": its zoom cannot be kept";
    ck_assert_msg(fault.find(words) != std::string::npos, "%s", fault.c_str());
  }
}
END_TEST

START_TEST(a_camera_whose_options_fail_is_refused_with_its_own_fault) {
  OnvifFaults faults;
  faults.zooms = faults.refuses_options = true;
  Rig rig(faults, [](OnvifOptions& options) { options.login.zoom = 0; });
  const std::string fault = rig.served.line("fault");
  const char* words = "does not answer GetConfigurationOptions (NotNow: no options)";
  ck_assert_msg(fault.find(words) != std::string::npos, "%s", fault.c_str());
}
END_TEST

// Seven requests of .18 s take longer than the login may.
START_TEST(a_camera_that_is_too_slow_for_a_whole_login_is_driven_by_what_is_known) {
  OnvifCamera camera({.delay = 180ms});
  OnvifOptions options = onvif_options_with_range(camera);
  options.login_time = 900ms;
  OnvifRig rig(options);
  assert_text(rig.served.line("ready"), "ready 1 velocity alive rate 10");
  ck_assert(rig.served.until([&] { return camera.speed() > 44; }, "move at 45 hold"));
}
END_TEST

// 9 degrees before the limit of 10 a velocity of 45 is free; 2 degrees before it is 2 / .4 = 5; within half a degree,
// 0.
START_TEST(a_velocity_falls_before_a_limit_and_towards_an_angle) {
  using cerberus::motion::AxisCommand;
  using Kind = AxisCommand::Kind;
  using cerberus::sensing::radians;
  const cerberus::motion::AxisLimits limits{radians(-10), radians(10), radians(90), radians(600)};
  const AxisCommand right{Kind::velocity, radians(20), 0}, to{Kind::position, radians(30), radians(12)};
  ck_assert_double_eq_tol(onvif::approach(right, limits, 1, true), 20, 1e-9);
  ck_assert_double_eq_tol(onvif::approach(right, limits, 8, true), 5, 1e-9);
  ck_assert_double_eq(onvif::approach(right, limits, 9.6, true), 0);
  ck_assert_double_eq(onvif::approach(right, limits, 50, true), 0);
  ck_assert_double_eq_tol(onvif::approach({Kind::velocity, radians(-20), 0}, limits, 50, true), -20, 1e-9);
  ck_assert_double_eq(onvif::approach(right, limits, std::nullopt, true), 0);
  ck_assert_double_eq_tol(onvif::approach(right, limits, std::nullopt, false), 20, 1e-9);
  ck_assert_double_eq_tol(onvif::approach(to, limits, 0, true), 12,
                          1e-9);  // to the limit: 2 * 10, at most 12
  ck_assert_double_eq_tol(onvif::approach(to, limits, 7, true), 6, 1e-9);
  ck_assert_double_eq(onvif::approach(to, limits, 9.7, true), 0);
  ck_assert_double_eq(onvif::approach({}, limits, 0, true), 0);
}
END_TEST

int main() {
  return run_suite(
      "onvif_head",
      {a_camera_turns_and_stops,
       pan_is_positive_to_the_right_and_tilt_up,
       a_camera_without_positions_is_stopped_a_little_beyond_its_limits_by_the_speeds_that_it_was_sent,
       a_move_has_a_timeout_and_is_sent_again_before_it_is_over,
       silence_and_the_end_of_the_pipeline_stop_the_camera_within_half_a_second,
       the_camera_stops_by_its_own_timeout_when_the_helper_is_gone,
       a_stop_is_sent_until_the_camera_acknowledges_it,
       a_camera_without_positions_is_reckoned_to_turn_on_while_its_stops_are_lost,
       a_camera_that_cannot_be_reached_is_reckoned_to_turn_until_its_timeout_is_over,
       a_camera_that_acknowledges_stop_and_goes_on_is_stopped_again,
       a_move_that_the_camera_obeys_after_the_stop_is_stopped_as_well,
       the_newest_move_waits_for_the_answer_to_the_last_one,
       positions_are_reported_and_a_camera_at_its_limit_is_stopped,
       a_camera_with_absolute_moves_goes_to_an_angle,
       a_camera_that_claims_absolute_moves_and_refuses_them_is_turned_at_speeds,
       a_camera_that_always_reports_zero_is_not_turned_at_the_start,
       positions_that_do_not_follow_the_camera_are_not_believed,
       a_head_with_false_positions_goes_where_it_is_sent_and_not_beyond_its_limits,
       a_camera_that_refuses_a_timeout_by_any_fault_is_driven_without,
       a_camera_that_refuses_moves_for_another_reason_keeps_its_timeout,
       limits_beyond_the_range_are_refused,
       a_range_is_used_or_said_not_to_be,
       a_profile_without_a_ptz_configuration_is_used_where_it_or_its_node_is_named,
       a_camera_without_positions_finds_its_reference_by_a_preset,
       a_preset_that_is_not_there_is_a_fault,
       a_preset_that_is_not_listed_is_named_with_those_that_are,
       a_locked_zoom_is_set_at_the_start_and_again_while_the_head_stands,
       a_zoom_that_is_ordered_is_set_while_the_head_stands_and_dropped_while_it_turns,
       a_zoom_of_another_range_is_a_share_of_it,
       a_zoom_that_cannot_be_kept_any_more_is_a_warning_and_the_head_turns,
       a_zoom_that_cannot_be_kept_is_an_error,
       a_camera_whose_options_fail_is_refused_with_its_own_fault,
       a_camera_that_is_too_slow_for_a_whole_login_is_driven_by_what_is_known,
       a_velocity_falls_before_a_limit_and_towards_an_angle},
      200);
}
