// SPDX-License-Identifier: LGPL-2.1-or-later
// A head that blocks must not block its callers. The scripted head blocks on
// pipes, so nothing here waits for a clock but the patience that is tested.
#include "drivers/head/head_runner.h"

#include <check.h>
#include <poll.h>

#include <atomic>
#include <future>
#include <string>
#include <thread>

#include "drivers/head/head_place.h"
#include "support/forwarding_head.h"
#include "support/pipe.h"
#include "support/suite.h"
#include "support/text.h"

using namespace cerberus::motion;
using namespace cerberus::drivers;
using namespace std::chrono_literals;
using cerberus::tests::assert_text;
using cerberus::tests::Pipe;
using Answer = HeadRunner::Answer;
using Clock = std::chrono::steady_clock;
using Kind = AxisCommand::Kind;

namespace {

// Returns whether nothing was written that has not been read.
bool is_empty(const Pipe& pipe) {
  pollfd readable{pipe.ends[0], POLLIN, 0};
  return ::poll(&readable, 1, 0) == 0;
}

std::unique_ptr<HeadRunner> runner_with(const std::string& script, std::shared_ptr<HeadLease> lease = {}) {
  auto runner = std::make_unique<HeadRunner>(make_head("scripted"), std::move(lease));
  HeadSetup setup;
  setup.script = script;
  ck_assert(runner->open(setup, 60s) == Answer::done);
  return runner;
}

HeadCommand go(Time time, double pan) {
  return {time, {Kind::position, pan, 1}, {}};
}

// A runner whose head is blocked in a command of the time 1 s, which `record` has, until the writer of `gate` is closed.
std::unique_ptr<HeadRunner> blocked_runner(Pipe& gate, Pipe& record, std::shared_ptr<HeadLease> lease = {}) {
  auto runner =
      runner_with("record " + record.writer() + "; command wait " + gate.reader(), std::move(lease));
  assert_text(record.line(), "open 0");
  runner->command(go(1s, 0.125));
  assert_text(record.line(), "command 1000000000 position 0.125 1 hold 0 0");
  return runner;
}

}  // namespace

START_TEST(questions_are_answered_with_all_pieces_of_the_way) {
  HeadRunner runner(make_head("simulated"), {});
  HeadSetup setup;
  setup.limits.pan = {-3, 3, 1, 2};
  ck_assert(runner.open(setup, 60s) == Answer::done);
  ck_assert(runner.simulated());
  std::vector<Pose> poses;
  ck_assert(runner.ask(go(0s, 2), 0s, 10s, poses, 60s) == Answer::done);
  ck_assert_uint_eq(poses.size(), 4);  // up, cruise, down, rest
  ck_assert_int_eq(poses[1].from.count(), Time(500ms).count());
  ck_assert_double_eq_tol(poses[3].pan.position, 2, 1e-9);
}
END_TEST

START_TEST(a_failure_is_reported_once_and_cleared_by_the_next_success) {
  const auto runner = runner_with("command 2 fail no power");
  std::vector<Pose> poses;
  ck_assert(runner->ask(go(0s, 1), 0s, 0s, poses, 60s) == Answer::done);
  ck_assert(runner->healthy());
  ck_assert(runner->ask(go(1s, 1), 1s, 1s, poses, 60s) == Answer::failed);
  ck_assert(!runner->healthy());
  assert_text(runner->failure().what, "no power");
  assert_text(runner->failure().what, "");
  // A question alone is answered, and heals nothing.
  ck_assert(runner->ask({}, 1s, 1s, poses, 60s) == Answer::done);
  ck_assert(!runner->healthy());
}
END_TEST

// A head whose device is unplugged and comes back without any command.
START_TEST(a_fault_at_rest_is_found_by_a_question_which_is_answered_all_the_same) {
  struct Unplugged final : Head {
    std::string why, blind;
    std::string open(const HeadSetup&) override { return {}; }
    void close() noexcept override {}
    void stop(Time) noexcept override {}
    std::string command(const HeadCommand&) override { return why; }
    std::string limit(Time, const Limits&) override { return {}; }
    std::string state(Time time, Pose& pose) override {
      pose = {};
      pose.from = time;
      return blind;
    }
    std::string fault() override { return why; }
    bool blocks() const override { return false; }
  };
  auto head = std::make_unique<Unplugged>();
  Unplugged& device = *head;
  HeadRunner runner(std::move(head), {});
  ck_assert(runner.open({}, 60s) == Answer::done);
  std::vector<Pose> poses;
  ck_assert(runner.ask({}, 0s, 0s, poses, 60s) == Answer::done);
  device.why = "it was unplugged";
  poses.clear();
  ck_assert(runner.ask({}, 1s, 1s, poses, 60s) == Answer::failed);
  ck_assert_uint_eq(poses.size(), 1);
  ck_assert(!runner.healthy());
  assert_text(runner.failure().what, "it was unplugged");
  device.why.clear();
  ck_assert(runner.ask({}, 2s, 2s, poses, 60s) == Answer::done);
  ck_assert(runner.healthy());
  device.blind = "it has no position";  // and no fault of its own
  ck_assert(runner.ask({}, 3s, 3s, poses, 60s) == Answer::failed);
  assert_text(runner.failure().what, "it has no position");
}
END_TEST

// Of a command that was replaced before its turn there is none.
START_TEST(a_failure_names_the_order_that_was_executed_last) {
  Pipe gate, record;
  const auto runner = runner_with("record " + record.writer() + "; command 1 wait " + gate.reader() +
                                  "; command 2 fail no power; state 2 fail it is dark");
  const auto order = [](Time time, unsigned number) {
    HeadCommand command = go(time, 1);
    command.order = number;
    return command;
  };
  record.line();
  runner->command(order(1s, 7));
  record.line();
  runner->command(order(2s, 8));  // waits
  runner->command(order(3s, 9));
  ck_assert_uint_eq(runner->failure().order, 0);
  gate.close_writer();
  std::vector<Pose> poses;
  runner->ask({}, 3s, 3s, poses, 60s);
  HeadRunner::Failure failure = runner->failure();
  assert_text(failure.what, "no power");
  ck_assert_uint_eq(failure.order, 9);
  ck_assert(runner->ask({}, 4s, 4s, poses, 60s) == Answer::failed);
  failure = runner->failure();
  assert_text(failure.what, "it is dark");
  ck_assert_uint_eq(failure.order, 9);
  ck_assert(runner->ask(go(5s, 1), 5s, 5s, poses, 60s) == Answer::failed);
  ck_assert_uint_eq(runner->failure().order, 0);
}
END_TEST

START_TEST(a_head_that_fails_is_stopped) {
  Pipe record;
  const auto runner = runner_with("record " + record.writer() + "; command fail no power");
  std::vector<Pose> poses;
  runner->ask(go(5s, 1), 5s, 5s, poses, 60s);
  assert_text(record.line(), "open 0");
  assert_text(record.line(), "command 5000000000 position 1 1 hold 0 0");
  assert_text(record.line(), "stop 5000000000");
}
END_TEST

START_TEST(a_caller_without_patience_is_not_blocked) {
  Pipe gate;
  const auto runner = runner_with("command wait " + gate.reader());
  std::vector<Pose> poses;
  const auto start = Clock::now();
  ck_assert(runner->ask(go(0s, 1), 0s, 0s, poses, 20ms) == Answer::late);
  ck_assert(runner->stop(0s, 20ms) == Answer::late);
  ck_assert(!runner->idle());
  ck_assert(Clock::now() - start < 5s);
  gate.close_writer();
  ck_assert(runner->stop(1s, 60s) == Answer::done);
}
END_TEST

START_TEST(interrupt_wakes_a_waiting_caller) {
  Pipe gate;
  const auto runner = runner_with("command wait " + gate.reader());
  std::atomic<bool> returned = false;
  std::thread waiting([&] {
    std::vector<Pose> poses;
    ck_assert(runner->ask(go(0s, 1), 0s, 0s, poses, 60s) == Answer::interrupted);
    returned = true;
  });
  while (runner->idle()) std::this_thread::yield();
  ck_assert(!returned);
  runner->interrupt(true);
  waiting.join();
  std::vector<Pose> poses;
  ck_assert(runner->ask({}, 0s, 0s, poses, 60s) == Answer::interrupted);
  runner->interrupt(false);
  gate.close_writer();
  ck_assert(runner->ask({}, 0s, 0s, poses, 60s) == Answer::done);
}
END_TEST

START_TEST(two_interrupts_must_both_be_revoked) {
  const auto runner = runner_with("");
  std::vector<Pose> poses;
  runner->interrupt(true);
  runner->interrupt(true);
  runner->interrupt(false);
  ck_assert(runner->ask({}, 0s, 0s, poses, 60s) == Answer::interrupted);
  runner->interrupt(false);
  ck_assert(runner->ask({}, 0s, 0s, poses, 60s) == Answer::done);
  runner->interrupt(false);  // one too many does no harm
  runner->interrupt(true);
  ck_assert(runner->ask({}, 0s, 0s, poses, 60s) == Answer::interrupted);
}
END_TEST

START_TEST(a_refusal_is_reported_and_nothing_else) {
  Pipe gate;
  std::promise<void> reported;
  HeadRunner runner(
      make_head("scripted"), {}, [] { ck_abort_msg("it did not move"); }, [&] { reported.set_value(); });
  HeadSetup setup;
  setup.script = "open wait " + gate.reader() + "; open fail no such port";
  ck_assert(runner.open(setup, 1ms) == Answer::late);
  ck_assert(runner.refusal().empty());
  gate.close_writer();
  reported.get_future().wait();
  assert_text(runner.refusal(), "no such port");
  assert_text(runner.refusal(), "");
}
END_TEST

START_TEST(a_head_that_never_blocks_is_nobodys_but_the_callers) {
  std::vector<std::thread::id> notified;
  HeadRunner runner(make_head("simulated"), {}, [&] { notified.push_back(std::this_thread::get_id()); });
  // No patience is needed, and no waiting caller can be interrupted.
  ck_assert(runner.open({}, 0s) == Answer::done);
  runner.interrupt(true);
  std::vector<Pose> poses;
  ck_assert(runner.ask(go(0s, 1), 0s, 1s, poses, 0s) == Answer::done);
  ck_assert_double_eq_tol(poses.back().pan.speed, 1, 1e-9);
  runner.command(go(1s, 0));
  ck_assert(runner.idle());
  ck_assert(runner.stop(2s, 0s) == Answer::done);
  ck_assert_uint_eq(notified.size(), 4);
  for (const std::thread::id id : notified) ck_assert(id == std::this_thread::get_id());
  ck_assert(runner.ask(go(1s, 1), 2s, 2s, poses, 0s) == Answer::failed);  // a stale one
  ck_assert(!runner.failure().what.empty());
}
END_TEST

START_TEST(of_commands_given_meanwhile_only_the_newest_counts) {
  Pipe gate, record;
  const auto runner = runner_with("record " + record.writer() + "; command wait " + gate.reader());
  assert_text(record.line(), "open 0");
  runner->command(go(1s, 0.125));
  assert_text(record.line(), "command 1000000000 position 0.125 1 hold 0 0");  // blocked in it now
  runner->command(go(2s, 0.25));
  runner->command(go(3s, 0.375));
  gate.close_writer();
  assert_text(record.line(), "command 3000000000 position 0.375 1 hold 0 0");
}
END_TEST

namespace {

// A scripted head that notes which commands were stops.
class StopNoter final : public cerberus::tests::ForwardingHead {
 public:
  explicit StopNoter(std::shared_ptr<std::string> notes)
      : ForwardingHead("scripted"), notes_(std::move(notes)) {}
  std::string command(const HeadCommand& command) override {
    *notes_ += command.stop ? "stop " : "command ";
    return ForwardingHead::command(command);
  }
  void learn(const SpeedMap& pan, const SpeedMap&) override {
    *notes_ += "learn " + std::to_string(pan.points().size()) + " ";
  }

 private:
  std::shared_ptr<std::string> notes_;
};

}  // namespace

START_TEST(what_was_learnt_comes_before_the_command_that_waits) {
  Pipe gate, record;
  auto notes = std::make_shared<std::string>();
  HeadRunner runner(std::make_unique<StopNoter>(notes), {});
  HeadSetup setup;
  setup.script = "record " + record.writer() + "; command wait " + gate.reader();
  ck_assert(runner.open(setup, 60s) == Answer::done);
  record.line();
  runner.command(go(1s, 1));
  record.line();
  runner.command(go(2s, 2));
  runner.learn(SpeedMap({{1, 2}}), {});
  runner.learn(SpeedMap({{1, 2}, {2, 3}}), {});  // the newest counts
  gate.close_writer();
  std::vector<Pose> poses;
  ck_assert(runner.ask({}, 3s, 3s, poses, 60s) == Answer::done);
  assert_text(*notes, "command learn 2 command ");
}
END_TEST

START_TEST(a_hold_after_a_stop_that_waits_does_not_revoke_it_and_a_move_does) {
  for (const auto& [moves, by_stop] : {std::pair{false, false}, {true, false}, {false, true}}) {
    Pipe gate, record;
    auto notes = std::make_shared<std::string>();
    HeadRunner runner(std::make_unique<StopNoter>(notes), {});
    HeadSetup setup;
    setup.script = "record " + record.writer() + "; command wait " + gate.reader();
    ck_assert(runner.open(setup, 60s) == Answer::done);
    record.line();
    runner.command(go(1s, 0.125));
    record.line();  // blocked in it now
    if (by_stop)
      runner.stop(2s, 1ms);
    else
      runner.command({2s, {}, {}, true});
    runner.command(moves ? go(3s, 0.25) : HeadCommand{3s, {}, {}});
    gate.close_writer();
    record.line();  // the third; the second one was superseded
    assert_text(*notes, moves ? "command command " : "command stop ");
  }
}
END_TEST

START_TEST(a_stop_beats_the_commands_before_it) {
  Pipe gate, record;
  auto runner = blocked_runner(gate, record);
  runner->command(go(2s, 0.25));
  runner->stop(3s, 1ms);
  gate.close_writer();
  assert_text(record.line(), "stop 3000000000");
  runner.reset();
  assert_text(record.line(), "close 3000000000");  // and no command in between
}
END_TEST

// Each caller receives the answer to its own question, whatever other threads ask, command and stop.
START_TEST(two_callers_at_once_are_both_answered) {
  const auto runner = runner_with("");
  std::atomic<int> asking = 2;
  const auto ask = [&](Time from) {
    std::vector<Pose> poses;
    for (int k = 0; k < 2000; ++k, from += 2s) {
      ck_assert(runner->ask({}, from, from, poses, 60s) == Answer::done);
      ck_assert_uint_eq(poses.size(), 1);
      ck_assert_int_eq(poses[0].from.count(), from.count());
    }
    --asking;
  };
  std::thread even(ask, 0s), odd(ask, 1s);
  while (asking > 0) {
    runner->command({0s, {}, {}});
    runner->stop(0s, 60s);
  }
  even.join();
  odd.join();
}
END_TEST

START_TEST(the_second_caller_waits_no_longer_than_its_patience_and_is_interrupted) {
  Pipe gate, record;
  const auto runner = runner_with("record " + record.writer() + "; command wait " + gate.reader());
  record.line();
  std::thread first([&] {
    std::vector<Pose> poses;
    ck_assert(runner->ask(go(0s, 1), 0s, 0s, poses, 60s) == Answer::interrupted);
  });
  record.line();  // it is in the call
  std::vector<Pose> poses;
  ck_assert(runner->ask({}, 1s, 1s, poses, 1ms) == Answer::late);
  std::thread second([&] {
    std::vector<Pose> none;
    ck_assert(runner->ask({}, 1s, 1s, none, 60s) == Answer::interrupted);
  });
  runner->interrupt(true);
  first.join();
  second.join();
  runner->interrupt(false);
  gate.close_writer();
  ck_assert(runner->ask({}, 2s, 2s, poses, 60s) == Answer::done);
  ck_assert_int_eq(poses[0].from.count(), Time(2s).count());
}
END_TEST

START_TEST(new_limits_come_before_the_command_that_waits) {
  Pipe gate, record;
  const auto runner = blocked_runner(gate, record);
  runner->command(go(2s, 2));
  Limits narrow;
  narrow.pan = {-0.5, 0.5};
  narrow.tilt = {-0.25, 0.25};
  runner->limit(3s, narrow);
  gate.close_writer();
  assert_text(record.line(), "limit 2000000000 -0.5 0.5 -0.25 0.25");  // so that the command is not stale
  assert_text(record.line(), "command 2000000000 position 2 1 hold 0 0");
  std::vector<Pose> poses;
  ck_assert(runner->ask({}, 4s, 4s, poses, 60s) == Answer::done);
  ck_assert_double_eq(poses[0].pan.position, 0.5);
}
END_TEST

START_TEST(a_head_that_refuses_limits_is_stopped_and_obeys_nothing_until_it_takes_them) {
  Pipe record;
  const auto runner = runner_with("record " + record.writer() + "; limit fail no memory");
  assert_text(record.line(), "open 0");
  runner->limit(1s, {});
  const std::string limit = record.line();
  ck_assert_msg(limit.starts_with("limit 1000000000 "), "%s", limit.c_str());
  assert_text(record.line(), "stop 1000000000");
  std::vector<Pose> poses;
  ck_assert(runner->ask(go(2s, 1), 2s, 2s, poses, 60s) == Answer::failed);
  assert_text(runner->failure().what, "no memory");
  ck_assert(!runner->healthy());
  ck_assert(record.line().starts_with("limit 1000000000 "));
  assert_text(record.line(), "stop 1000000000");
  HeadSetup anew;
  anew.script = "record " + record.writer();
  ck_assert(runner->open(anew, 60s) == Answer::done);
  ck_assert(runner->ask(go(3s, 1), 3s, 3s, poses, 60s) == Answer::done);
  assert_text(record.line(), "open 0");
  assert_text(record.line(), "command 3000000000 position 1 1 hold 0 0");
}
END_TEST

START_TEST(a_blocked_driver_keeps_its_lease_and_closes_by_itself) {
  Pipe gate, record;
  std::weak_ptr<HeadLease> watch;
  {
    auto lease = HeadLease::take("blocked");
    watch = lease;
    auto runner = blocked_runner(gate, record, std::move(lease));
    runner->set_close_patience(20ms);
    const auto start = Clock::now();
    runner.reset();
    ck_assert(Clock::now() - start < 5s);
  }
  ck_assert(!watch.expired());
  gate.close_writer();
  assert_text(record.line(), "close 1000000000");
  while (!watch.expired()) std::this_thread::yield();
}
END_TEST

START_TEST(a_head_that_is_being_closed_is_waited_for_and_one_in_use_is_not) {
  Pipe gate, record, next_record;
  auto lease = HeadLease::take("gate");
  ck_assert(lease && lease->wait({}) && !HeadLease::take("gate"));  // in use
  auto runner = blocked_runner(gate, record, std::move(lease));
  runner->set_close_patience(1ms);
  runner.reset();
  auto next_lease = HeadLease::take("gate");
  ck_assert(next_lease && !next_lease->wait(1ms));  // its driver has not returned
  ck_assert(!HeadLease::take("gate"));              // one waits for it already
  ck_assert(HeadLease::take("another") != nullptr);
  HeadRunner unblocking(make_head("simulated"), next_lease);
  ck_assert(unblocking.open({}, 60s) == Answer::failed);
  ck_assert(unblocking.refusal().find("it is still being stopped") == 0);

  HeadRunner next(make_head("scripted"), std::move(next_lease));
  HeadSetup setup;
  setup.script = "record " + next_record.writer();
  ck_assert(next.open(setup, 1ms) == Answer::late);
  ck_assert(is_empty(next_record));
  gate.close_writer();
  assert_text(next_record.line(), "open 0");
  ck_assert_int_eq(record.line().find("close"), 0);  // the first driver was closed before
}
END_TEST

START_TEST(a_device_has_one_head_whatever_its_names_are_and_however_it_is_written) {
  const auto place = [](const char* driver, const char* device, const char* options = "") {
    return head_place(driver, device, option_words(options));
  };
  assert_text(place("onvif", "http://Camera/onvif/device_service"), place("onvif", "camera").c_str());
  assert_text(place("onvif", "camera:80"), place("onvif", "camera").c_str());
  assert_text(place("onvif", "https://camera"), place("onvif", "camera:443").c_str());
  assert_text(place("onvif", "http://[fe80::1]/"), "[fe80::1]:80 profile ");
  ck_assert(place("onvif", "camera", "profile=a") != place("onvif", "camera", "profile=b"));
  ck_assert(place("onvif", "camera", "profile='PTZ 1'") != place("onvif", "camera", "profile='PTZ 2'"));
  assert_text(place("visca", "udp:camera:52381", "speeds='1 address=3' address='02'"),
              "udp:camera:52381 address 2");
  assert_text(place("v4l2", "/dev/../dev/null"), "/dev/null");
  assert_text(place("visca", "serial:/dev/../dev/null"), "serial:/dev/null address 1");
  assert_text(place("pelco-d", "tcp:gateway:4001", "baud=2400 address=2"), "tcp:gateway:4001 address 2");
  for (const char* driver : {"simulated", "external", "stepper-gpio", "servo-pwm"})
    assert_text(place(driver, "gpiochip0"), "");  // the kernel keeps lines and channels apart
  assert_text(place("onvif", "discover"), "");

  auto lease = HeadLease::take("a", "camera");
  ck_assert(lease && !HeadLease::take("b", "camera") && !HeadLease::take("a", "other"));
  ck_assert(HeadLease::is_taken("a") && !HeadLease::is_taken("b"));
  ck_assert(HeadLease::take("b", "other") != nullptr);
  ck_assert(HeadLease::take("b") != nullptr);
  lease->announce_return();
  ck_assert(!HeadLease::is_taken("a"));
  const auto next = HeadLease::take("b", "camera");
  ck_assert(next && !next->wait(1ms));
  lease.reset();
  ck_assert(next->wait(1ms));
}
END_TEST

START_TEST(a_runner_that_is_destroyed_while_it_waits_opens_nothing) {
  Pipe gate, record, next_record;
  auto lease = HeadLease::take("given up");
  const std::weak_ptr<HeadLease> watch = lease;
  auto runner = blocked_runner(gate, record, std::move(lease));
  runner->set_close_patience(1ms);
  runner.reset();
  auto next_lease = HeadLease::take("given up");
  const std::weak_ptr<HeadLease> next_watch = next_lease;
  {
    HeadRunner next(make_head("scripted"), std::move(next_lease));
    next.set_close_patience(1ms);
    HeadSetup setup;
    setup.script = "record " + next_record.writer();
    ck_assert(next.open(setup, 20ms) == Answer::late);
  }
  gate.close_writer();
  while (!watch.expired() || !next_watch.expired()) std::this_thread::yield();
  ck_assert(is_empty(next_record));
}
END_TEST

START_TEST(a_driver_that_does_not_open_returns_the_reason) {
  HeadRunner runner(make_head("scripted"), {});
  HeadSetup setup;
  setup.script = "open fail no such device";
  ck_assert(runner.open(setup, 60s) == Answer::failed);
  assert_text(runner.failure().what, "no such device");
  assert_text(runner.refusal(), "no such device");
  assert_text(runner.refusal(), "");  // reported before
  // Nothing else fails of anything else.
  std::vector<Pose> poses;
  ck_assert(runner.ask(HeadCommand{}, {}, {}, poses, 60s) == Answer::failed);
  assert_text(runner.failure().what, "no such device");
  for (const char* nonsense :
       {"opn fail x", "record", "record x", "command", "command 3", "command wait", "stop jump 3"}) {
    setup.script = nonsense;
    ck_assert(runner.open(setup, 60s) == Answer::failed);
    ck_assert(runner.failure().what.find("script: ") == 0);
  }
}
END_TEST

START_TEST(a_thousand_heads_come_and_go) {
  for (int k = 0; k < 1000; ++k) {
    HeadRunner runner(make_head(k % 2 ? "simulated" : "scripted"), {});
    ck_assert(runner.open({}, 60s) == Answer::done);
    runner.command(go(0s, 1));
  }
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "head_runner",
      {questions_are_answered_with_all_pieces_of_the_way,
       a_failure_is_reported_once_and_cleared_by_the_next_success,
       a_fault_at_rest_is_found_by_a_question_which_is_answered_all_the_same,
       a_failure_names_the_order_that_was_executed_last,
       a_head_that_fails_is_stopped,
       a_caller_without_patience_is_not_blocked,
       interrupt_wakes_a_waiting_caller,
       two_interrupts_must_both_be_revoked,
       a_refusal_is_reported_and_nothing_else,
       a_head_that_never_blocks_is_nobodys_but_the_callers,
       two_callers_at_once_are_both_answered,
       the_second_caller_waits_no_longer_than_its_patience_and_is_interrupted,
       new_limits_come_before_the_command_that_waits,
       a_head_that_refuses_limits_is_stopped_and_obeys_nothing_until_it_takes_them,
       of_commands_given_meanwhile_only_the_newest_counts,
       what_was_learnt_comes_before_the_command_that_waits,
       a_hold_after_a_stop_that_waits_does_not_revoke_it_and_a_move_does,
       a_stop_beats_the_commands_before_it,
       a_blocked_driver_keeps_its_lease_and_closes_by_itself,
       a_head_that_is_being_closed_is_waited_for_and_one_in_use_is_not,
       a_device_has_one_head_whatever_its_names_are_and_however_it_is_written,
       a_runner_that_is_destroyed_while_it_waits_opens_nothing,
       a_driver_that_does_not_open_returns_the_reason,
       a_thousand_heads_come_and_go},
      200);
}
