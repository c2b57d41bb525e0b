// SPDX-License-Identifier: LGPL-2.1-or-later
// The Pelco-D driver against a head on a pseudo-terminal, which reads frames by the manual and not by our decoder.
#include "drivers/pelco/pelco_head.h"

#include <pty.h>
#include <unistd.h>

#include <memory>
#include <string>
#include <thread>

#include "support/suite.h"
#include "support/text.h"

using namespace cerberus::drivers;
using namespace std::chrono_literals;
using cerberus::sensing::radians;
using cerberus::tests::assert_text;
using Kind = cerberus::motion::AxisCommand::Kind;

namespace {

// The far end of the line: what has come of it, frame by frame, and a way to answer.
class Line {
 public:
  Line() {
    char name[128];
    if (::openpty(&fd_, &slave_, name, nullptr, nullptr) != 0) std::abort();
    device_ = std::string("serial:") + name;
  }
  ~Line() {
    ::close(fd_);
    ::close(slave_);
  }
  const std::string& device() const { return device_; }
  // The newest frame; waits until one has come.
  std::array<std::uint8_t, 7> frame() {
    std::array<std::uint8_t, 7> last{};
    pollfd wait{fd_, POLLIN, 0};
    for (int timeout = 5000; ::poll(&wait, 1, timeout) == 1; timeout = 0) {
      ck_assert_int_eq(::read(fd_, last.data(), last.size()), 7);
      ck_assert_uint_eq(last[0], 0xff);
      ck_assert_uint_eq(last[6], (last[1] + last[2] + last[3] + last[4] + last[5]) & 255);
      ++frames_;
    }
    return last;
  }
  bool silent() {
    pollfd wait{fd_, POLLIN, 0};
    return ::poll(&wait, 1, 20) == 0;
  }
  void answer(const std::array<std::uint8_t, 7>& frame) {
    ck_assert_int_eq(::write(fd_, frame.data(), frame.size()), 7);
    pollfd wait{slave_, POLLIN, 0};
    ck_assert_int_eq(::poll(&wait, 1, 5000), 1);
  }
  int frames() const { return frames_; }

 private:
  int fd_ = -1, slave_ = -1, frames_ = 0;
  std::string device_;
};

PelcoOptions options_for(const Line& line, bool feedback = false) {
  PelcoOptions options;
  options.device = line.device();
  options.feedback = feedback;
  return options;
}

}  // namespace

START_TEST(speeds_become_steps_and_are_sent_again) {
  Line line;
  PelcoHead head(options_for(line));
  assert_text(head.open({}, 0s), "");
  ck_assert_uint_eq(line.frame()[3], 0);  // it stands from the start
  head.move({Kind::velocity, radians(20), 0}, {Kind::velocity, radians(-20), 0}, 1s);
  const auto drive = line.frame();
  ck_assert_uint_eq(drive[3], 0x12);  // right and down
  ck_assert_uint_eq(drive[4], 32);    // half of 40 degrees a second: 31.5 of 63
  ck_assert_uint_eq(drive[5], 63);
  head.tick(1s + 100ms);
  ck_assert(line.silent());
  head.tick(1s + 200ms);
  ck_assert(line.frame() == drive);
}
END_TEST

START_TEST(a_stop_is_sent_five_times) {
  Line line;
  PelcoHead head(options_for(line));
  head.open({}, 0s);
  head.move({Kind::velocity, 1, 0}, {}, 1s);
  line.frame();
  const int before = line.frames();
  head.move({}, {}, 2s);
  for (Time t = 2s; t < 3s; t += 10ms) {
    head.tick(t);
    if (!line.silent()) ck_assert_uint_eq(line.frame()[3], 0);
  }
  ck_assert_int_eq(line.frames() - before, 5);
  ck_assert(!head.stopping());
}
END_TEST

START_TEST(positions_are_asked_for_and_a_head_at_its_limit_stops) {
  Line line;
  PelcoHead head(options_for(line, true));
  HeadSetup setup;
  setup.limits.pan = {radians(-50), radians(40), 1, 1};
  head.open(setup, 0s);
  for (Time t = 0s; t < 300ms; t += 50ms) head.tick(t);
  line.frame();
  head.move({Kind::velocity, 0.3, 0}, {}, 1s);
  ck_assert_uint_eq(line.frame()[3], 0x02);
  head.tick(1s + 100ms);
  const auto query = line.frame();
  ck_assert(query[3] == 0x51 || query[3] == 0x53);
  line.answer({0xff, 1, 0, 0x5b, 0, 0, 0x5c});
  line.answer({0xff, 1, 0, 0x59, 0x0b, 0xb8, 0x1d});  // 30 degrees
  head.tick(1s + 110ms);
  const auto pose = head.take_pose(1s + 110ms);
  ck_assert(pose);
  ck_assert_double_eq_tol(pose->pan.position, radians(30), 1e-9);
  ck_assert(!head.take_pose(1s + 110ms));
  line.answer({0xff, 1, 0, 0x59, 0x0f, 0xa0, 0x09});  // 40 degrees: the limit
  head.tick(1s + 120ms);
  ck_assert_uint_eq(line.frame()[3], 0);
  ck_assert(head.stopping());
}
END_TEST

START_TEST(the_zoom_of_a_head_with_feedback_is_asked_for_and_ordered_and_a_stop_takes_the_order_back) {
  Line line;
  PelcoHead head(options_for(line, true));
  ck_assert(head.abilities().zoom && !PelcoHead(options_for(line)).abilities().zoom);
  head.open({}, 0s);
  Time now = 0s;
  line.answer({0xff, 1, 0, 0x59, 0, 0, 0x5a});
  head.tick(now);
  // The first frame of this command within two seconds.
  const auto sends = [&](std::uint8_t command) {
    for (const Time end = now + 2s; now < end;) {
      now += 50ms;
      head.tick(now);
      if (line.silent()) continue;
      if (const auto frame = line.frame(); frame[3] == command) return std::optional(frame);
    }
    return std::optional<std::array<std::uint8_t, 7>>();
  };
  ck_assert(sends(0x55));
  line.answer({0xff, 1, 0, 0x5d, 0x80, 0x00, 0xde});
  head.tick(now);
  ck_assert_double_eq_tol(head.take_zoom().value_or(-1), .5, 1e-4);
  ck_assert(!head.take_zoom());
  head.zoom(.25, now);
  const auto order = sends(0x4f);
  ck_assert(order && (*order)[4] == 0x40 && (*order)[5] == 0);
  ck_assert(!sends(0x4f));  // once
  head.zoom(.75, now);
  head.stop(now);
  ck_assert(!sends(0x4f));
}
END_TEST

START_TEST(an_axis_that_ceases_to_report_makes_no_pose_and_stops_the_head) {
  constexpr std::array<std::uint8_t, 7> kPanAnswer{0xff, 1, 0, 0x59, 0x0b, 0xb8, 0x1d};
  constexpr std::array<std::uint8_t, 7> kTiltAnswer{0xff, 1, 0, 0x5b, 0, 0, 0x5c};
  Line line;
  PelcoHead head(options_for(line, true));
  head.open({}, 0s);
  line.answer(kTiltAnswer);
  line.answer(kPanAnswer);
  head.tick(100ms);
  ck_assert(head.take_pose(100ms));
  head.move({Kind::velocity, 0.3, 0}, {}, 200ms);
  for (Time t = 300ms; t <= 1s; t += 100ms) {  // pan reports on, tilt does not
    line.answer(kPanAnswer);
    head.tick(t);
    const auto pose = head.take_pose(t);
    if (pose) ck_assert_double_eq_tol(pose->age, cerberus::motion::seconds(t - 100ms), 1e-9);
    if (t > 500ms) ck_assert(!pose);  // 400 ms after tilt's
  }
  assert_text(head.fault(), "");
  line.answer(kPanAnswer);
  head.tick(1200ms);
  ck_assert(head.fault().find("does not answer") != std::string::npos);
  ck_assert(head.stopping());
}
END_TEST

// Where it stands then is not known: it must not go on by what it reported before.
START_TEST(a_head_that_returns_and_reports_no_more_is_a_fault) {
  constexpr std::array<std::uint8_t, 7> kPanAnswer{0xff, 1, 0, 0x59, 0x0b, 0xb8, 0x1d};
  constexpr std::array<std::uint8_t, 7> kTiltAnswer{0xff, 1, 0, 0x5b, 0, 0, 0x5c};
  const std::string link = "/tmp/cerberus-pelco-" + std::to_string(getpid());
  auto line = std::make_unique<Line>();
  ck_assert_int_eq(::symlink(line->device().substr(7).c_str(), link.c_str()), 0);
  PelcoOptions options = options_for(*line, true);
  options.device = "serial:" + link;
  PelcoHead head(options);
  head.open({}, 0s);
  line->answer(kTiltAnswer);
  line->answer(kPanAnswer);
  head.tick(100ms);
  ck_assert(head.take_pose(100ms));
  line.reset();
  ::unlink(link.c_str());
  line = std::make_unique<Line>();
  ck_assert_int_eq(::symlink(line->device().substr(7).c_str(), link.c_str()), 0);
  Time t = 200ms;  // connecting takes a thread of its own
  for (; line->silent() && t < 30s; t += 100ms) head.tick(t);
  ::unlink(link.c_str());
  ck_assert(!line->silent());
  assert_text(head.fault(), "");
  for (const Time end = t + 1500ms; t < end; t += 100ms) head.tick(t);
  ck_assert_msg(head.fault().find("does not answer") != std::string::npos, "%s", head.fault().c_str());
}
END_TEST

START_TEST(a_head_with_feedback_that_never_reports_is_a_fault_with_what_to_check) {
  Line line;
  PelcoHead head(options_for(line, true));
  assert_text(head.open({}, 0s), "");
  Time now{};
  for (; now < 500ms; now += 50ms) head.tick(now);
  assert_text(head.fault(), "");
  for (; now < 2s; now += 50ms) head.tick(now);
  const std::string expected = "the Pelco-D head at " + line.device() +
                               " does not answer: check baud, address and wiring, or leave out feedback";
  assert_text(head.fault(), expected.c_str());
}
END_TEST

START_TEST(what_cannot_be_is_named) {
  Line line;
  PelcoOptions options = options_for(line);
  options.address = 0;
  assert_text(PelcoHead(options).open({}, 0s), "a Pelco-D address is 1 to 255");
  options = options_for(line);
  options.pan_speed = 0;
  assert_text(PelcoHead(options).open({}, 0s), "pan-speed and tilt-speed must be more than 0");
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "pelco_head",
      {speeds_become_steps_and_are_sent_again, a_stop_is_sent_five_times,
       positions_are_asked_for_and_a_head_at_its_limit_stops,
       the_zoom_of_a_head_with_feedback_is_asked_for_and_ordered_and_a_stop_takes_the_order_back,
       an_axis_that_ceases_to_report_makes_no_pose_and_stops_the_head,
       a_head_that_returns_and_reports_no_more_is_a_fault,
       a_head_with_feedback_that_never_reports_is_a_fault_with_what_to_check, what_cannot_be_is_named});
}
