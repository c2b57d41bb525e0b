// SPDX-License-Identifier: LGPL-2.1-or-later
// Heads that a helper process drives. The helpers here are shell scripts that record what they read, and the example
// that is shipped.
#include "drivers/helper/helper_head.h"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "sensing/angles.h"
#include "support/children.h"
#include "support/suite.h"
#include "support/text.h"
#include "support/time_bounds.h"

using namespace cerberus::drivers;
using namespace std::chrono_literals;
using cerberus::motion::Pose;
using cerberus::sensing::degrees;
using cerberus::sensing::radians;
using cerberus::tests::assert_text;
using Clock = std::chrono::steady_clock;
using Kind = cerberus::motion::AxisCommand::Kind;

namespace {

// A helper that answers `ready` and writes every line that it reads, and at last `eof`, to a file. obeys: what the shell
// does with each `line` after that.
class Recorder {
 public:
  explicit Recorder(const std::string& abilities, const std::string& obeys = "") {
    file_ = "/tmp/cerberus-helper-" + std::to_string(::getpid()) + ".log";
    std::remove(file_.c_str());
    command_ = "sh -c 'read line; echo \"$line\" >>" + file_ + "; echo ready 1 " + abilities +
               "; while read line; do echo \"$line\" >>" + file_ + "; " + obeys + " done; echo eof >>" +
               file_ + "'";
  }
  ~Recorder() { std::remove(file_.c_str()); }
  const std::string& command() const { return command_; }
  std::vector<std::string> lines() const {
    std::ifstream in(file_);
    std::vector<std::string> all;
    for (std::string line; std::getline(in, line);) all.push_back(line);
    return all;
  }
  // The lines but `alive`, once there are `least` and the last of them is `last`.
  std::vector<std::string> until(const std::string& last, std::size_t least = 1) const {
    for (const auto end = Clock::now() + 60s; Clock::now() < end; std::this_thread::sleep_for(5ms)) {
      std::vector<std::string> all = lines();
      std::erase(all, "alive");
      if (all.size() >= least && all.back() == last) return all;
    }
    ck_abort_msg("the helper never read '%s'", last.c_str());
  }

 private:
  std::string file_, command_;
};

HeadSetup setup_with(const std::string& command) {
  HeadSetup setup;
  setup.command = command;
  return setup;
}

std::string refusal_of(const std::string& command) {
  HelperHead head("external");
  return head.open(setup_with(command));
}

}  // namespace

START_TEST(the_shipped_example_goes_where_it_is_sent_and_reports_it) {
  HelperHead head("external");
  const std::string example = std::string(std::getenv("CERBERUS_SOURCE")) + "/pipelines/heads/example.py";
  assert_text(head.open(setup_with("python3 " + example)), "");
  const auto begin = Clock::now();
  assert_text(head.command({0s, {Kind::position, radians(20), radians(90)}, {}}), "");
  Pose pose;
  while (Clock::now() < begin + 60s) {
    assert_text(head.state(Clock::now() - begin, pose), "");
    if (pose.measured && pose.settled && std::abs(degrees(pose.pan.position) - 20) < 0.1) break;
    std::this_thread::sleep_for(20ms);
  }
  ck_assert(pose.measured);
  ck_assert_double_eq_tol(degrees(pose.pan.position), 20, 0.1);
}
END_TEST

START_TEST(a_helper_receives_the_command) {
  const Recorder helper("position velocity");
  HelperHead head("external");
  assert_text(head.open(setup_with(helper.command())), "");
  assert_text(
      head.command({0s, {Kind::position, radians(10), radians(40)}, {Kind::velocity, radians(-5), 0}}), "");
  assert_text(
      head.command({1s, {Kind::position, radians(10), radians(40)}, {Kind::velocity, radians(-5), 0}}), "");
  head.stop(2s);
  head.close();
  const auto lines = helper.until("eof");
  ck_assert_uint_eq(lines.size(), 6);
  ck_assert(lines[0].starts_with("cerberus-head 1 timeout 0.5 limits -170 170 -45 45 "));
  assert_text(lines[1], "move to 10 40 at -5");  // once, though it was commanded twice
  assert_text(lines[2], "stop");
  assert_text(lines[3], "stop");
  assert_text(lines[4], "quit");
}
END_TEST

// A hold does not end homing, which a stop does.
START_TEST(a_stop_is_sent_as_the_stop_of_the_protocol_and_a_hold_is_not) {
  const Recorder helper("position velocity");
  HelperHead head("external");
  assert_text(head.open(setup_with(helper.command())), "");
  assert_text(head.command({0s, {}, {}}), "");
  assert_text(head.command({1s, {}, {}, true}), "");
  assert_text(head.command({2s, {}, {}}), "");
  head.close();
  const auto lines = helper.until("eof");
  ck_assert_uint_eq(lines.size(), 7);
  assert_text(lines[1], "move hold hold");
  assert_text(lines[2], "stop");
  assert_text(lines[3], "move hold hold");
}
END_TEST

START_TEST(a_head_that_found_its_reference_is_there_and_measured_for_a_moment) {
  HelperHead head("external");
  assert_text(
      head.open(setup_with("sh -c 'read hello; echo ready 1 velocity home; while read line; do case $line in "
                           "home) echo homed 5 -3;; esac; done'")),
      "");
  const auto begin = Clock::now();
  assert_text(head.command({0s, {Kind::velocity, radians(20), 0}, {}}), "");
  assert_text(head.home(1ms), "");
  Pose pose;
  do {
    std::this_thread::sleep_for(5ms);
    assert_text(head.state(Clock::now() - begin, pose), "");
  } while (!pose.measured && Clock::now() - begin < 60s);
  ck_assert(pose.measured);
  ck_assert_double_eq_tol(degrees(pose.pan.position), 5, 1e-9);
  ck_assert_double_eq_tol(degrees(pose.tilt.position), -3, 1e-9);
}
END_TEST

START_TEST(a_head_without_a_reference_says_so) {
  HelperHead head("external");
  assert_text(head.open(setup_with("sh -c 'read hello; echo ready 1 velocity; cat >/dev/null'")), "");
  assert_text(head.home(0s), "the head has no way to find its reference");
}
END_TEST

START_TEST(a_helper_receives_a_line_well_within_its_timeout) {
  const Recorder helper("position");
  HelperHead head("external");
  HeadSetup setup = setup_with(helper.command());
  setup.helper_timeout = 200ms;
  assert_text(head.open(setup), "");
  std::this_thread::sleep_for(1s);
  const auto all = helper.lines();
  ck_assert_int_ge(std::count(all.begin(), all.end(), "alive"), 10);  // of 20
}
END_TEST

START_TEST(a_helper_that_cannot_open_its_head_reports_the_reason) {
  assert_text(refusal_of("sh -c 'echo fault no port /dev/ttyUSB9: permission denied; cat >/dev/null'"),
              "no port /dev/ttyUSB9: permission denied");
  const char* ended =
      "the head's helper `false` did not become ready: it ended (its standard error may say why)";
  assert_text(refusal_of("false"), ended);
  assert_text(refusal_of("false --password=secret"), ended);
  assert_text(refusal_of(""), "the driver external needs a helper to run (command=)");
}
END_TEST

// It has moved nothing: it is killed, and no other one is started.
START_TEST(a_helper_that_does_not_become_ready_is_killed) {
  const std::string length = "8." + std::to_string(::getpid());
  std::string sleeping = "sleep";
  (sleeping += '\0') += length;
  assert_text(
      refusal_of("sleep " + length),
      "the head's helper `sleep` does not answer with `ready 1 ...`: it has not become ready for 5 s. It "
      "was killed");
  ck_assert_int_eq(cerberus::tests::running(sleeping), 0);
}
END_TEST

START_TEST(settings_that_the_start_refuses_are_refused_by_the_check) {
  HeadSetup setup = setup_with("cat");
  assert_text(HelperHead("external").check(setup), "");
  setup.latency = 6s;
  assert_text(HelperHead("external").check(setup), "latency must be 0 to 5 s, and is 6 s");
}
END_TEST

START_TEST(an_emergency_stop_between_two_looks_is_seen) {
  HelperHead head("external");
  const std::string command =
      "sh -c 'read a; echo ready 1 position; while read b; do case $b in move*) echo emergency pressed; echo "
      "emergency released; echo fault done;; esac; done'";
  assert_text(head.open(setup_with(command)), "");
  ck_assert(!head.emergency());
  assert_text(head.command({0s, {Kind::position, 0.1, 1}, {}}), "");
  Time time = 0s;
  for (const auto end = Clock::now() + 60s;
       Clock::now() < end && head.command({time += 1ms, {}, {}}).empty();)
    std::this_thread::sleep_for(5ms);
  ck_assert(head.emergency());
  ck_assert(!head.emergency());
}
END_TEST

START_TEST(a_helper_that_ended_is_reported_and_started_again) {
  HelperHead head("external");
  const std::string command =
      "sh -c 'read a; echo ready 1 position; while read b; do case $b in move*) exit 1;; esac; done'";
  assert_text(head.open(setup_with(command)), "");
  assert_text(head.command({0s, {Kind::position, 0.1, 1}, {}}), "");
  std::string wrong;
  Time time = 0s;
  const auto end = Clock::now() + 60s;
  while (wrong.empty() && Clock::now() < end) {
    std::this_thread::sleep_for(10ms);
    wrong = head.command({time += 1ms, {}, {}});
  }
  ck_assert_msg(wrong.find("is gone") != std::string::npos, "%s", wrong.c_str());
  while (!wrong.empty() && Clock::now() < end) {
    std::this_thread::sleep_for(10ms);
    wrong = head.command({time += 1ms, {}, {}});
  }
  assert_text(wrong, "");
}
END_TEST

// It may have left its head turning: another one is started, if only to stop it.
START_TEST(a_helper_that_ended_just_before_the_end_is_replaced_by_one_that_stops_the_head) {
  const Recorder helper("velocity", "case $line in *at*) exit 1;; esac;");
  HelperHead head("external");
  assert_text(head.open(setup_with(helper.command())), "");
  assert_text(head.command({0s, {Kind::velocity, radians(5), 0}, {}}), "");
  Time time = 0s;
  for (const auto end = Clock::now() + 60s;
       Clock::now() < end && head.command({time += 1ms, {Kind::velocity, radians(5), 0}, {}}).empty();)
    std::this_thread::sleep_for(5ms);
  head.close();
  const auto lines = helper.until("eof");
  ck_assert_uint_ge(lines.size(), 5);
  ck_assert(lines[1].starts_with("move at "));
  ck_assert(lines[2].starts_with("cerberus-head 1 "));
  assert_text(lines[3], "stop");
}
END_TEST

// Its process stays for a while after it has hung up: commands meanwhile start no other one, and the reason is the same.
START_TEST(a_helper_that_hung_up_and_has_not_ended_yet_keeps_its_reason) {
  HelperHead head("external");
  const std::string command =
      "sh -c 'read a; echo ready 1 velocity; while read b; do case $b in *at*) exec <&- >&-; sleep 60;; "
      "esac; "
      "done'";
  assert_text(head.open(setup_with(command)), "");
  assert_text(head.command({0s, {Kind::velocity, radians(5), 0}, {}}), "");
  std::string reason;
  Time time = 0s;
  for (const auto end = Clock::now() + 60s; Clock::now() < end; std::this_thread::sleep_for(1ms)) {
    const std::string wrong = head.command({time += 1ms, {}, {}});
    if (!reason.empty() && wrong != reason) break;
    reason = wrong;
  }
  assert_text(reason, "the head's helper `sh` is gone: it ended");
  for (const auto end = Clock::now() + 60s; Clock::now() < end; std::this_thread::sleep_for(1ms)) {
    reason = head.command({time += 1ms, {}, {}});
    if (reason.empty()) break;
    assert_text(reason, "the head's helper has been started again and is not ready yet");
  }
  assert_text(reason, "");
}
END_TEST

// The commands' failures until one says that the helper hangs.
std::string hung(HelperHead& head) {
  Time time = 0s;
  for (const auto end = Clock::now() + 60s; Clock::now() < end; std::this_thread::sleep_for(10ms))
    if (std::string wrong = head.command({time += 1ms, {Kind::velocity, radians(5), 0}, {}}); !wrong.empty())
      return wrong;
  return "it does not";
}

START_TEST(the_shipped_example_answers_and_is_killed_and_replaced_when_it_hangs) {
  HelperHead head("external");
  const std::string example = std::string(std::getenv("CERBERUS_SOURCE")) + "/pipelines/heads/example.py";
  assert_text(head.open(setup_with("python3 " + example)), "");
  std::this_thread::sleep_for(1500ms);
  assert_text(head.command({1ms, {Kind::velocity, radians(5), 0}, {}}), "");
  const auto first = cerberus::tests::children("python3");
  ck_assert_uint_eq(first.size(), 1);
  ::kill(first[0], SIGSTOP);
  assert_text(
      hung(head),
      "the head's helper `python3` hangs: it has not answered `alive` for 0.5 s. It was killed, and is "
      "started again to stop the head");
  std::string wrong = "not yet";
  Time time = 0s;
  for (const auto end = Clock::now() + 60s; Clock::now() < end && !wrong.empty();
       std::this_thread::sleep_for(10ms))
    wrong = head.command({time += 1ms, {Kind::velocity, radians(5), 0}, {}});
  assert_text(wrong, "");
  ck_assert(cerberus::tests::children("python3") != first);
}
END_TEST

// What it has started holds its socket, and perhaps its device: of two at most that of the new one lives.
START_TEST(a_helper_that_sends_no_more_poses_while_its_head_turns_is_killed_with_what_it_has_started) {
  const std::string length = "9." + std::to_string(::getpid());
  HelperHead head("external");
  assert_text(head.open(setup_with("sh -c 'read hello; echo ready 1 velocity feedback; sleep " + length +
                                   "; cat >/dev/null'")),
              "");
  assert_text(
      hung(head),
      "the head's helper `sh` hangs: it has sent no `pose` for 1 s while its head was to turn. It was "
      "killed, and is started again to stop the head");
  std::string sleeping = "sleep";
  (sleeping += '\0') += length;
  for (const auto end = Clock::now() + 500ms; Clock::now() < end; std::this_thread::sleep_for(20ms))
    ck_assert_int_le(cerberus::tests::running(sleeping), 1);
}
END_TEST

START_TEST(a_helper_sees_the_end_within_half_a_second_of_the_death_of_the_pipeline) {
  const Recorder helper("velocity");
  const pid_t pipeline = ::fork();
  if (pipeline == 0) {
    HelperHead head("external");
    if (!head.open(setup_with(helper.command())).empty()) ::_exit(1);
    if (!head.command({0s, {Kind::velocity, radians(5), 0}, {}}).empty()) ::_exit(1);
    for (;;) ::pause();
  }
  for (const auto end = Clock::now() + 60s; Clock::now() < end && helper.lines().size() < 3;)
    std::this_thread::sleep_for(5ms);
  ::kill(pipeline, SIGKILL);
  const auto killed = Clock::now();
  ck_assert_int_eq(::waitpid(pipeline, nullptr, 0), pipeline);
  helper.until("eof");
  ck_assert(cerberus::tests::in_time(Clock::now() - killed, 500ms));
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "helper_head",
      {the_shipped_example_goes_where_it_is_sent_and_reports_it, a_helper_receives_the_command,
       a_stop_is_sent_as_the_stop_of_the_protocol_and_a_hold_is_not,
       a_helper_receives_a_line_well_within_its_timeout,
       a_head_that_found_its_reference_is_there_and_measured_for_a_moment, a_head_without_a_reference_says_so,
       a_helper_that_cannot_open_its_head_reports_the_reason, a_helper_that_does_not_become_ready_is_killed,
       settings_that_the_start_refuses_are_refused_by_the_check, an_emergency_stop_between_two_looks_is_seen,
       a_helper_that_ended_is_reported_and_started_again,
       a_helper_that_ended_just_before_the_end_is_replaced_by_one_that_stops_the_head,
       a_helper_that_hung_up_and_has_not_ended_yet_keeps_its_reason,
       the_shipped_example_answers_and_is_killed_and_replaced_when_it_hangs,
       a_helper_that_sends_no_more_poses_while_its_head_turns_is_killed_with_what_it_has_started,
       a_helper_sees_the_end_within_half_a_second_of_the_death_of_the_pipeline},
      200);
}
