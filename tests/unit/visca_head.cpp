// SPDX-License-Identifier: LGPL-2.1-or-later
// The VISCA driver against an emulated camera: serial, UDP, TCP, and what cameras do wrong. A served head is the whole
// helper, joined by a socket pair as in its process. What needs no real line runs in the test's own time.
#include "drivers/visca/visca_head.h"

#include <sys/socket.h>

#include <future>
#include <string>
#include <thread>

#include "drivers/helper/helper_loop.h"
#include "drivers/pelco/pelco_head.h"
#include "support/stepped_helper.h"
#include "support/visca_camera.h"

#include "support/suite.h"
#include "support/text.h"
#include "support/time_bounds.h"

using namespace cerberus::drivers;
using namespace std::chrono_literals;
using cerberus::tests::assert_text;
using cerberus::tests::SteppedHelper;
using cerberus::tests::ViscaCamera;
using cerberus::tests::ViscaFaults;
using cerberus::tests::ViscaPlant;
using Clock = std::chrono::steady_clock;

namespace {

ViscaOptions options_for(const ViscaCamera& camera, bool header = true) {
  ViscaOptions options;
  options.device = camera.device();
  options.header = header;
  return options;
}

// A helper that serves `head` until the pipeline's end of the line is closed.
class Served {
 public:
  explicit Served(ViscaOptions options, const char* timeout = "5") : head_(std::move(options)) {
    if (::socketpair(AF_UNIX, SOCK_STREAM, 0, ends_) != 0) std::abort();
    status_ = std::async(std::launch::async, [this] { return serve_head(ends_[1], ends_[1], head_); });
    say(std::string("cerberus-head 1 timeout ") + timeout +
        " limits -170 170 -45 45 speed 90 90 acceleration 600 600 start 0 0");
  }
  ~Served() {
    hang_up();
    if (status_.valid()) status_.wait();
    ::close(ends_[1]);
  }
  void say(std::string line) {
    line += '\n';
    if (::write(ends_[0], line.data(), line.size()) < 0) std::abort();
  }
  void hang_up() {
    if (ends_[0] >= 0) ::close(ends_[0]);
    ends_[0] = -1;
  }
  // Keeps the line alive until the condition holds; false after 60 s.
  template <typename Condition>
  bool until(Condition holds, const std::string& line = "alive") {
    for (const auto end = Clock::now() + 60s; Clock::now() < end; std::this_thread::sleep_for(10ms)) {
      if (holds()) return true;
      say(line);
    }
    return false;
  }
  // Reads until a line begins like this.
  std::string line(const std::string& begin) {
    const auto end = Clock::now() + 60s;
    while (Clock::now() < end) {
      while (const auto text = lines_.take())
        if (text->starts_with(begin)) return *text;
      char bytes[512];
      const ssize_t got = ::recv(ends_[0], bytes, sizeof bytes, MSG_DONTWAIT);
      if (got > 0)
        lines_.append({bytes, static_cast<std::size_t>(got)});
      else
        std::this_thread::sleep_for(2ms);
      if (got <= 0) say("alive");
    }
    return {};
  }
  int status() { return status_.get(); }

 private:
  ViscaHead head_;
  int ends_[2];
  LineBuffer lines_;
  std::future<int> status_;
};

// In the test's own time, over UDP, without positions.
struct Rig {
  ViscaPlant plant;
  ViscaCamera& camera = plant.camera;
  SteppedHelper served;
  explicit Rig(const ViscaFaults& faults) : plant(faults), served(plant) {}
};

constexpr ViscaCamera::Line kLines[] = {ViscaCamera::Line::serial, ViscaCamera::Line::udp,
                                        ViscaCamera::Line::tcp};

}  // namespace

START_TEST(a_camera_turns_reports_and_stops_on_every_line) {
  ViscaCamera camera(kLines[_i]);
  Served served(options_for(camera));
  assert_text(served.line("ready"), "ready 1 velocity feedback alive zoom rate 20");
  served.say("move at 45 hold");
  ck_assert(served.until([&] { return camera.pan() > 5; }));
  ck_assert_double_eq(camera.speed(), 45);
  ck_assert(served.line("pose").starts_with("pose "));
  served.say("move hold hold");
  ck_assert(served.until([&] { return camera.speed() == 0; }));
}
END_TEST

START_TEST(a_camera_that_is_slow_to_answer_at_first_is_one_with_positions) {
  ViscaFaults faults;
  faults.delay =
      260ms;  // of each answer: longer than kAnswerTime, the first one for the Stop of the beginning
  faults.acknowledges = false;
  ViscaCamera camera(ViscaCamera::Line::tcp, faults);
  Served served(options_for(camera));
  assert_text(served.line("ready"), "ready 1 velocity feedback alive zoom rate 20");
}
END_TEST

START_TEST(silence_and_the_end_of_the_pipeline_stop_the_camera_within_half_a_second) {
  for (const bool silent : {true, false}) {
    ViscaCamera camera(kLines[_i]);
    Served served(options_for(camera), silent ? "0.2" : "5");
    served.line("ready");
    served.say("move at -45 hold");
    ck_assert(served.until([&] { return camera.speed() == -45; }, "move at -45 hold"));
    const auto last_word = Clock::now();
    if (!silent) served.hang_up();
    while (camera.speed() != 0 && Clock::now() - last_word < 60s) std::this_thread::sleep_for(2ms);
    ck_assert(camera.speed() == 0);
    ck_assert(cerberus::tests::in_time(camera.stopped() - last_word, 500ms));
  }
}
END_TEST

START_TEST(a_stop_is_sent_until_the_camera_obeys) {
  Rig rig({.swallows_stops = 4});  // the first is sent at the start
  ck_assert(rig.served.until([&] { return rig.camera.speed() == 45; }, "move at 45 hold"));
  rig.served.hang_up();
  ck_assert_int_eq(rig.served.status(), 0);
  ck_assert_double_eq(rig.camera.speed(), 0);
}
END_TEST

START_TEST(cameras_that_never_acknowledge_are_driven_all_the_same) {
  Rig rig({.acknowledges = false, .reports = false});
  ck_assert(rig.served.until([&] { return rig.camera.speed() == 15; }, "move at 15 hold"));
  ck_assert(rig.served.until([&] { return rig.camera.speed() == 0; }, "move hold hold"));
}
END_TEST

START_TEST(what_a_full_camera_refused_is_sent_again) {
  ViscaFaults faults;
  faults.refuses = 3;
  faults.loses_answers = 1;
  ViscaCamera camera(ViscaCamera::Line::serial, faults);
  Served served(options_for(camera));
  served.line("ready");
  served.say("move at 9 hold");
  ck_assert(served.until([&] { return camera.speed() == 9; }));
}
END_TEST

START_TEST(a_lost_move_is_sent_again) {
  Rig rig({.swallows_moves = 2});
  rig.served.say("move at 25 hold");
  ck_assert(rig.served.until([&] { return rig.camera.speed() == 25; }));
}
END_TEST

START_TEST(a_camera_that_acknowledges_and_reports_nothing_is_no_fault) {
  Rig rig({.reports = false});
  assert_text(rig.served.line("ready"), "ready 1 velocity home alive rate 20");
  rig.served.say("move at 9 hold");
  ck_assert(rig.served.until([&] { return rig.camera.pan() > 12; }));  // 1.3 s without anything to say
  ck_assert_double_eq(rig.camera.speed(), 9);
}
END_TEST

// It is stopped so early that it stands before 10 degrees, though its position is old when it arrives; then it moves
// inwards only.
START_TEST(a_camera_at_its_limit_is_stopped) {
  ViscaCamera camera(ViscaCamera::Line::udp);
  Served served(options_for(camera));
  served.line("ready");
  served.say("limits -10 10 -10 10");
  served.say("move at 45 hold");
  ck_assert(served.until([&] { return camera.pan() > 3 && camera.speed() == 0; }, "move at 45 hold"));
  ck_assert_double_lt(camera.pan(), 20);  // a busy machine sees it late
  ck_assert(served.until([&] { return camera.speed() == -45; }, "move at -45 hold"));
}
END_TEST

START_TEST(a_camera_without_the_header_of_visca_over_ip_is_understood) {
  ViscaFaults faults;
  faults.header = false;
  ViscaCamera camera(ViscaCamera::Line::udp, faults);
  Served served(options_for(camera, false));
  assert_text(served.line("ready"), "ready 1 velocity feedback alive zoom rate 20");
  served.say("move at 25 hold");
  ck_assert(served.until([&] { return camera.speed() == 25; }));
}
END_TEST

START_TEST(a_camera_that_goes_away_is_reported_and_used_again_at_rest) {
  ViscaCamera camera(ViscaCamera::Line::tcp);
  Served served(options_for(camera));
  served.line("ready");
  ck_assert(served.until([&] { return camera.speed() == 45; }, "move at 45 hold"));
  const auto pulled = Clock::now();
  camera.hang_up();
  const std::string fault = served.line("fault");
  ck_assert(cerberus::tests::in_time(Clock::now() - pulled, 1s));
  ck_assert_msg(fault.find("is gone") != std::string::npos, "%s", fault.c_str());
  assert_text(served.line("recovered"), "recovered");
  ck_assert(served.until([&] { return camera.speed() == 0; }));  // it does not run away
}
END_TEST

// The camera obeys the move only after the stop was sent; the answer to the move must not end the stop's repetition.
START_TEST(the_answer_to_a_move_is_not_taken_for_that_to_the_stop) {
  for (const bool numbered : {false, true}) {
    // Three stops are swallowed, that of the start is one. The answer to the move arrives after the stop was sent.
    Rig rig({.header = numbered, .swallows_stops = 3, .delay = 150ms});
    ck_assert(rig.served.until([&] { return rig.camera.speed() == 45; }, "move at 45 hold"));
    rig.served.say("stop");
    ck_assert(rig.served.until([&] { return rig.camera.speed() == 0; }));
  }
}
END_TEST

START_TEST(a_camera_that_counts_is_driven_after_its_reset_was_lost) {
  ViscaFaults faults;
  faults.strict = true;
  ViscaCamera camera(ViscaCamera::Line::udp, faults);
  {
    Served before(options_for(camera));  // leaves the camera in the middle of its count
    before.line("ready");
  }
  camera.drop_reset();
  Served served(options_for(camera));
  served.line("ready");
  ck_assert(served.until([&] { return camera.speed() == 25; }, "move at 25 hold"));
  ck_assert(served.until([&] { return camera.speed() == 0; }, "stop"));
}
END_TEST

constexpr ViscaFaults kCountsNot[] = {
    {.most_number = 3}, {.answers_number = 1}, {.answers_number = 200}, {.bare_answers = true}};

START_TEST(cameras_that_do_not_count_are_driven_by_a_fixed_number) {
  for (const ViscaFaults& faults : kCountsNot) {
    std::string warning;
    ViscaPlant plant(faults, false, 0U, [&](const std::string& text) { warning = text; });
    SteppedHelper served(plant);
    for (int round = 0; round < 5; ++round) {
      ck_assert(served.until([&] { return plant.camera.speed() == 45; }, "move at 45 hold"));
      served.say("stop");
      served.run(200ms);
      ck_assert_double_eq(plant.camera.speed(), 0);
      ck_assert(!plant.device().stopping());  // acknowledged: not sent again and again
    }
    assert_text(plant.device().fault(), "");
    assert_text(warning, "");
  }
}
END_TEST

START_TEST(a_camera_that_does_not_count_is_stopped_and_the_user_told_of_the_fixed_number) {
  for (const ViscaFaults& faults : kCountsNot) {
    int warnings = 0;
    ViscaPlant plant(faults, false, std::nullopt, [&](const std::string& text) {
      ck_assert_msg(text.ends_with("give sequence=0"), "%s", text.c_str());
      ++warnings;
    });
    SteppedHelper served(plant);
    for (int round = 0; round < 20; ++round) {
      ck_assert(served.until([&] { return plant.camera.speed() == 45; }, "move at 45 hold"));
      served.say("stop");
      ck_assert(served.until([&] { return plant.camera.speed() == 0; }));
      served.run(300ms);
    }
    ck_assert_int_eq(warnings, faults.bare_answers ? 0 : 1);
  }
}
END_TEST

// 19 degrees a second is a step of the camera; 20 is none. The age is of the line, far below a second.
START_TEST(a_camera_without_positions_reports_the_speeds_of_its_steps) {
  ViscaFaults faults;
  faults.reports = false;
  ViscaCamera camera(ViscaCamera::Line::udp, faults);
  Served served(options_for(camera));
  served.line("ready");
  served.say("move at 20 at -6.5");
  const std::string speeds = served.line("speeds");
  ck_assert_msg(speeds.starts_with("speeds 19 -6 "), "%s", speeds.c_str());
  served.say("stop");
  ck_assert(served.line("speeds").starts_with("speeds 0 0 "));
}
END_TEST

START_TEST(a_camera_finds_its_home_and_says_so) {
  Rig rig({.reports = false});
  assert_text(rig.served.line("ready"), "ready 1 velocity home alive rate 20");
  ck_assert(rig.served.until([&] { return rig.camera.pan() > 5; }, "move at 45 hold"));
  rig.served.say("home");
  assert_text(rig.served.line("homed"), "homed 0 0");
  ck_assert_double_eq(rig.camera.pan(), 0);
  ck_assert_int_eq(rig.camera.homes(), 1);
}
END_TEST

// A pipeline that is wrong, or another program: this one would drive on at 25 degrees a second for ever.
START_TEST(a_camera_without_positions_is_stopped_a_little_beyond_its_limits) {
  Rig rig({.reports = false});
  rig.served.say("limits -5 5 -5 5");
  rig.served.say("move at 25 hold");
  ck_assert(rig.served.until([&] { return rig.camera.pan() > 5 && rig.camera.speed() == 0; }));
  ck_assert_double_lt(rig.camera.pan(), 5 + 2 + 0.5);  // the slack, and the period of the driver
  ck_assert(rig.served.until([&] { return rig.camera.speed() == -25; }, "move at -25 hold"));
}
END_TEST

// The camera goes on for four times 100 ms at 25 degrees a second: 10 degrees.
START_TEST(a_camera_without_positions_is_reckoned_to_turn_on_while_its_stops_are_lost) {
  for (const bool numbered : {true, false}) {
    Rig rig({.reports = false, .header = numbered});
    rig.served.say("limits -5 40 -5 5");
    ck_assert(rig.served.until([&] { return rig.camera.pan() > 10; }, "move at 25 hold"));
    rig.camera.swallow_stops(4);
    rig.served.say("move hold hold");
    ck_assert(rig.served.until([&] { return rig.camera.speed() == 0; }));
    ck_assert_double_gt(rig.camera.pan(), 10 + 25 * .35);
    rig.served.run(1s);
    ck_assert(rig.served.until([&] { return rig.camera.speed() > 24; }, "move at 25 hold"));
    ck_assert(rig.served.until([&] { return rig.camera.speed() == 0; }, "move at 25 hold"));
    ck_assert_double_eq_tol(rig.camera.pan(), 40 + 2, 25 * .05);
  }
}
END_TEST

START_TEST(a_camera_without_positions_that_vanishes_while_it_turns_is_reported_within_a_second) {
  for (const bool numbered : {true, false}) {
    Rig rig({.reports = false, .header = numbered});
    ck_assert(rig.served.until([&] { return rig.camera.pan() > 10; }, "move at 25 hold"));
    rig.camera.set_power(false);
    const Time pulled = rig.served.now();
    const std::string fault = rig.served.line("fault");
    ck_assert_msg(fault.find("does not answer") != std::string::npos, "'%s'", fault.c_str());
    ck_assert_int_le((rig.served.now() - pulled).count(), Time(1s).count());
  }
}
END_TEST

// Its stop is lost, because it has no power for 20 s: at 25 degrees a second it would be beyond the limit of 170 degrees.
START_TEST(a_camera_that_was_out_of_reach_is_not_reckoned_to_have_turned_all_the_time) {
  for (const bool numbered : {true, false}) {
    Rig rig({.reports = false, .header = numbered});
    ck_assert(rig.served.until([&] { return rig.camera.pan() > 10; }, "move at 25 hold"));
    rig.camera.set_power(false);
    rig.served.say("move hold hold");
    ck_assert(!rig.served.line("fault").empty());
    rig.served.run(20s);
    rig.camera.set_power(true);
    assert_text(rig.served.line("recovered"), "recovered");
    ck_assert(rig.served.until([&] { return rig.camera.speed() > 24; }, "move at 25 hold"));
  }
}
END_TEST

// Stop is sent again after 100 ms; the answer that comes after 150 is that to the first one.
START_TEST(a_camera_that_acknowledges_late_is_not_reckoned_to_have_turned_on) {
  for (const bool numbered : {true, false}) {
    Rig rig({.reports = false, .header = numbered, .delay = 150ms});
    rig.served.say("limits -5 40 -5 5");
    for (int at = 4; at <= 20; at += 4) {
      ck_assert(rig.served.until([&] { return rig.camera.pan() > at; }, "move at 25 hold"));
      rig.served.say("move hold hold");
      ck_assert(rig.served.until([&] { return rig.camera.speed() == 0; }));
      rig.served.run(1s);
    }
    ck_assert(rig.served.until([&] { return rig.camera.speed() > 24; }, "move at 25 hold"));
    ck_assert(rig.served.until([&] { return rig.camera.speed() == 0; }, "move at 25 hold"));
    ck_assert_double_eq_tol(rig.camera.pan(), 40 + 2, 25 * .2);  // .15 of it the delay
  }
}
END_TEST

// What it sends at rest is an inquiry that every camera should answer; one that never has is not expected to.
START_TEST(a_camera_without_positions_that_vanishes_at_rest_is_reported_within_a_second) {
  for (const bool acknowledges : {true, false}) {
    Rig rig({.acknowledges = acknowledges, .reports = false, .versions = true});
    rig.served.line("ready");
    ck_assert(rig.served.until([&] { return rig.camera.speed() == 45; }, "move at 45 hold"));
    ck_assert(rig.served.until([&] { return rig.camera.speed() == 0; }, "stop"));
    assert_text(rig.served.line("fault"), "");  // in 10 s
    rig.camera.set_power(false);
    const Time pulled = rig.served.now();
    const std::string fault = rig.served.line("fault");
    ck_assert_msg(fault.find("does not answer") != std::string::npos, "'%s'", fault.c_str());
    ck_assert_int_le((rig.served.now() - pulled).count(), Time(1s).count());
    rig.camera.set_power(true);
    assert_text(rig.served.line("recovered"), "recovered");
    ck_assert_double_eq(rig.camera.speed(), 0);
    ck_assert(rig.served.until([&] { return rig.camera.speed() == -25; }, "move at -25 hold"));
  }
  Rig mute({.reports = false});
  mute.served.line("ready");
  assert_text(mute.served.line("fault"), "");
}
END_TEST

START_TEST(a_camera_that_answers_nothing_but_its_version_turns_without_a_fault) {
  Rig rig({.acknowledges = false, .reports = false, .versions = true});
  rig.served.line("ready");
  ck_assert(rig.served.until([&] { return rig.camera.speed() == 15; }, "move at 15 hold"));
  const Time begin = rig.served.now();
  while (rig.served.now() - begin < 3s) {
    rig.served.say("move at 15 hold");
    rig.served.run(10ms);
    ck_assert_double_eq(rig.camera.speed(), 15);
  }
  assert_text(rig.served.line("fault"), "");
}
END_TEST

START_TEST(the_position_of_the_zoom_is_reported) {
  ViscaCamera camera(ViscaCamera::Line::serial, {.zooms = true});
  camera.set_zoom(0x2000);
  Served served(options_for(camera));
  assert_text(served.line("zoom"), "zoom 0.5");
  camera.set_zoom(0x4000);
  assert_text(served.line("zoom"), "zoom 1");
}
END_TEST

// Its first inquiries came while the camera started, or were lost.
START_TEST(a_zoom_that_is_not_reported_at_first_is_asked_for_again) {
  ViscaPlant plant({.reports = false}, true);
  SteppedHelper served(plant);
  assert_text(served.line("zoom"), "");  // for 10 s
  plant.camera.set_zoom(0x2000);
  std::string zoom = served.line("zoom");
  if (zoom.empty()) zoom = served.line("zoom");
  assert_text(zoom, "zoom 0.5");
}
END_TEST

START_TEST(a_zoom_that_is_ordered_is_set_while_the_camera_turns) {
  for (const bool acknowledges : {true, false}) {
    ViscaCamera camera(ViscaCamera::Line::udp, {.acknowledges = acknowledges, .zooms = true});
    Served served(options_for(camera));
    ck_assert(served.until([&] { return camera.speed() == 45; }, "move at 45 hold"));
    served.say("zoom 0.25");
    ck_assert(served.until([&] { return camera.zoom() == 0x1000; }));
    ck_assert_double_eq(camera.speed(), 45);
    ck_assert(served.until([&] { return camera.speed() == 19; }, "move at 20 hold"));
  }
}
END_TEST

// A stop takes back an order of the zoom that was not sent yet.
START_TEST(after_a_stop_no_zoom_follows) {
  ViscaPlant plant({.zooms = true}, true);
  SteppedHelper served(plant);
  plant.camera.swallow_stops(1000);
  served.say("stop");
  served.say("zoom 0.5");  // waits for the answer to the stop
  served.say("stop");
  plant.camera.swallow_stops(0);
  for (int k = 0; k < 300; ++k) {
    served.say("alive");
    served.run(10ms);
  }
  ck_assert_int_eq(plant.camera.zoom(), 0);
}
END_TEST

START_TEST(a_zoom_beyond_the_lens_is_refused) {
  const ViscaCamera camera(ViscaCamera::Line::udp);
  ViscaOptions options = options_for(camera);
  options.zoom = 2;
  assert_text(ViscaHead(options).open({}, 0s),
              "the zoom of a VISCA camera is kept at 0 to 1.92 (lock-zoom), not at 2");
}
END_TEST

START_TEST(a_locked_zoom_is_set_at_the_begin) {
  for (const bool acknowledges : {true, false}) {
    ViscaCamera camera(ViscaCamera::Line::udp, {.acknowledges = acknowledges, .zooms = true});
    ViscaOptions options = options_for(camera);
    options.zoom = .25;
    Served served(options);
    ck_assert(served.until([&] { return camera.zoom() == 0x1000; }));
  }
}
END_TEST

// A refusal of its zoom counts for no move and no stop.
START_TEST(a_camera_without_a_zoom_turns_and_stops_all_the_same) {
  ViscaCamera camera(ViscaCamera::Line::serial);
  ViscaOptions options = options_for(camera);
  options.zoom = .25;
  Served served(options);
  ck_assert(served.until([&] { return camera.pan() > 3; }, "move at 20 hold"));
  served.say("stop");
  ck_assert(served.until([&] { return camera.speed() == 0; }));
}
END_TEST

START_TEST(a_camera_is_driven_at_its_address_on_a_serial_line_and_no_other_is) {
  ViscaCamera camera(ViscaCamera::Line::serial, {.address = 2});
  ViscaOptions options = options_for(camera);
  {
    Served first(options);
    assert_text(first.line("ready"),
                "ready 1 velocity home alive zoom rate 20");  // address 1 answers nothing
    first.say("move at 45 hold");
  }
  options.address = 2;
  Served second(options);
  assert_text(second.line("ready"), "ready 1 velocity feedback alive zoom rate 20");
  ck_assert_double_eq(camera.pan(), 0);
  ck_assert(second.until([&] { return camera.speed() == 45; }, "move at 45 hold"));
  ck_assert(second.until([&] { return camera.speed() == 0; }, "stop"));
}
END_TEST

START_TEST(answers_of_another_baud_rate_are_an_error_and_none_at_all_are_a_warning) {
  ViscaCamera garbled(ViscaCamera::Line::serial, {.garbles = true});
  ViscaHead unread(options_for(garbled));
  const std::string expected =
      "what the VISCA camera at " + garbled.device() + " sends is no VISCA: check baud=9600 and address=";
  assert_text(unread.open({}, 0s), expected.c_str());
  ViscaCamera silent(ViscaCamera::Line::serial, {.acknowledges = false, .reports = false});
  std::string warned;
  ViscaOptions options = options_for(silent);
  options.warn = [&](const std::string& text) { warned = text; };
  ViscaHead driven(options);
  assert_text(driven.open({}, 0s), "");
  ck_assert_msg(warned.starts_with("the VISCA camera at " + silent.device() + " answers nothing"), "%s",
                warned.c_str());
  ck_assert_msg(warned.ends_with("baud=9600 and address="), "%s", warned.c_str());
}
END_TEST

START_TEST(what_cannot_be_opened_is_named) {
  const auto refusal = [](const char* device, int baud = 9600) {
    ViscaOptions options;
    options.device = device;
    options.baud = baud;
    return ViscaHead(options).open({}, 0s);
  };
  assert_text(refusal("serial:/dev/no-such-port"),
              "the serial port /dev/no-such-port cannot be opened: No such file or directory (cerberus-heads "
              "list names "
              "those that are there)");
  assert_text(refusal("serial:/dev/null"), "/dev/null is no serial port");
  ck_assert(refusal("/dev/ttyUSB0").find("write serial:/dev/ttyUSB0") != std::string::npos);
  ck_assert(refusal("udp:127.0.0.1").find("names no port") != std::string::npos);
  ck_assert(refusal("tcp:127.0.0.1:1").find("cannot be reached: Connection refused") != std::string::npos);
  const ViscaCamera camera(ViscaCamera::Line::serial);
  ck_assert(refusal(camera.device().c_str(), 12345).find("no baud rate 12345") != std::string::npos);
}
END_TEST

START_TEST(a_serial_port_has_one_program_and_the_second_one_is_told_which) {
  const ViscaCamera camera(ViscaCamera::Line::serial);
  const std::string path = camera.device().substr(std::string("serial:").size());
  PelcoOptions pelco;
  pelco.device = camera.device();
  const std::string here = "another program (process " + std::to_string(::getpid());
  {
    ViscaHead first(options_for(camera));
    assert_text(first.open({}, 0s), "");
    const std::string wrong = PelcoHead(pelco).open({}, 0s);
    ck_assert_msg(wrong.starts_with("the serial port " + path +
                                    " cannot be opened: Device or resource busy: " + here) &&
                      wrong.ends_with(") has it open; end that first"),
                  "%s", wrong.c_str());
  }
  assert_text(PelcoHead(pelco).open({}, 0s), "");  // it is free again
}
END_TEST

int main() {
  Suite* suite = suite_create("visca_head");
  TCase* cases = tcase_create("visca_head");
  tcase_set_timeout(cases, 200);
  for (const TTest* test : {a_camera_turns_reports_and_stops_on_every_line,
                            silence_and_the_end_of_the_pipeline_stop_the_camera_within_half_a_second})
    tcase_add_loop_test(cases, test, 0, std::size(kLines));
  for (const TTest* test :
       {cameras_that_never_acknowledge_are_driven_all_the_same,
        a_camera_finds_its_home_and_says_so,
        a_camera_that_is_slow_to_answer_at_first_is_one_with_positions,
        a_stop_is_sent_until_the_camera_obeys,
        what_a_full_camera_refused_is_sent_again,
        a_lost_move_is_sent_again,
        a_camera_that_acknowledges_and_reports_nothing_is_no_fault,
        a_camera_at_its_limit_is_stopped,
        a_camera_without_the_header_of_visca_over_ip_is_understood,
        a_camera_that_goes_away_is_reported_and_used_again_at_rest,
        the_answer_to_a_move_is_not_taken_for_that_to_the_stop,
        a_camera_that_counts_is_driven_after_its_reset_was_lost,
        cameras_that_do_not_count_are_driven_by_a_fixed_number,
        a_camera_that_does_not_count_is_stopped_and_the_user_told_of_the_fixed_number,
        a_camera_without_positions_reports_the_speeds_of_its_steps,
        a_camera_without_positions_is_stopped_a_little_beyond_its_limits,
        a_camera_without_positions_is_reckoned_to_turn_on_while_its_stops_are_lost,
        a_camera_without_positions_that_vanishes_while_it_turns_is_reported_within_a_second,
        a_camera_that_was_out_of_reach_is_not_reckoned_to_have_turned_all_the_time,
        a_camera_that_acknowledges_late_is_not_reckoned_to_have_turned_on,
        a_camera_without_positions_that_vanishes_at_rest_is_reported_within_a_second,
        a_camera_that_answers_nothing_but_its_version_turns_without_a_fault,
        the_position_of_the_zoom_is_reported,
        a_locked_zoom_is_set_at_the_begin,
        a_zoom_that_is_not_reported_at_first_is_asked_for_again,
        a_zoom_that_is_ordered_is_set_while_the_camera_turns,
        after_a_stop_no_zoom_follows,
        a_zoom_beyond_the_lens_is_refused,
        a_camera_without_a_zoom_turns_and_stops_all_the_same,
        a_camera_is_driven_at_its_address_on_a_serial_line_and_no_other_is,
        answers_of_another_baud_rate_are_an_error_and_none_at_all_are_a_warning,
        what_cannot_be_opened_is_named,
        a_serial_port_has_one_program_and_the_second_one_is_told_which})
    tcase_add_test(cases, test);
  suite_add_tcase(suite, cases);
  SRunner* runner = srunner_create(suite);
  srunner_run_all(runner, CK_ENV);
  const int failed = srunner_ntests_failed(runner);
  srunner_free(runner);
  return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
