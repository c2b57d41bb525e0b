// SPDX-License-Identifier: LGPL-2.1-or-later
// The loop of a helper process and its emergency stop, over a device of the test's own. Only the silence itself takes time.
#include "drivers/helper/helper_loop.h"

#include <sys/socket.h>
#include <unistd.h>

#include <future>
#include <string>

#include "drivers/head/emergency_stop.h"
#include "drivers/helper/head_server.h"
#include "support/fake_lines.h"
#include "support/suite.h"

using namespace cerberus::drivers;
using namespace std::chrono_literals;

namespace {

// Reports its first stop.
class NotingDevice final : public HeadDevice {
 public:
  std::string open(const HeadSetup&, Time) override { return refusal; }
  HeadAbilities abilities() const override { return {.velocity = true}; }
  void move(const cerberus::motion::AxisCommand&, const cerberus::motion::AxisCommand&, Time) override {}
  void limit(const cerberus::motion::Limits& to, Time) override {
    limits = to;
    limited.set_value();
  }
  void stop(Time) noexcept override {
    if (!std::exchange(stopped_, true)) stopped.set_value();
  }
  void release(Time) noexcept override { ++releases; }
  bool stopping() const override { return false; }
  void watch(std::vector<pollfd>&) const override {}
  Time tick(Time now) override {
    ++ticks;
    return now + 1s;
  }
  std::optional<PoseLine> take_pose(Time) override { return std::nullopt; }
  std::string fault() const override { return {}; }

  std::promise<void> limited, stopped;
  cerberus::motion::Limits limits;
  std::string refusal;  // of open()
  int releases = 0, ticks = 0;

 private:
  bool stopped_ = false;
};

// Stops within some calls of tick(), each of which comes too late, as a stepper's do on a busy machine.
class LateDevice final : public HeadDevice {
 public:
  std::string open(const HeadSetup&, Time) override { return {}; }
  HeadAbilities abilities() const override { return {.velocity = true}; }
  void move(const cerberus::motion::AxisCommand&, const cerberus::motion::AxisCommand&, Time) override {}
  void limit(const cerberus::motion::Limits&, Time) override {}
  void stop(Time) noexcept override { left_ = 3; }
  bool stopping() const override { return left_ > 0; }
  void watch(std::vector<pollfd>&) const override {}
  Time tick(Time now) override {
    --left_;
    return now - 5ms;
  }
  std::optional<PoseLine> take_pose(Time) override { return std::nullopt; }
  std::string fault() const override { return {}; }

 private:
  int left_ = 0;
};

}  // namespace

START_TEST(the_end_of_the_pipeline_stops_a_head_whose_steps_are_overdue) {
  LateDevice device;
  int ends[2];
  ck_assert_int_eq(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
  const std::string text =
      "cerberus-head 1 timeout 0.5 limits -170 170 -45 45 speed 90 90 acceleration 600 600 start 0 0\n";
  ck_assert_int_eq(::send(ends[0], text.data(), text.size(), MSG_NOSIGNAL), static_cast<int>(text.size()));
  ::close(ends[0]);
  ck_assert_int_eq(serve_head(ends[1], ends[1], device), 0);  // it would wait for ever
  ck_assert(!device.stopping());
  ::close(ends[1]);
}
END_TEST

START_TEST(a_head_that_cannot_be_opened_is_left_alone_and_ends_the_helper) {
  NotingDevice device;
  device.refusal = "no such port";
  int ends[2];
  ck_assert_int_eq(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
  const std::string text =
      "cerberus-head 1 timeout 0.5 limits -170 170 -45 45 speed 90 90 acceleration 600 600 start 0 0\n";
  ck_assert_int_eq(::send(ends[0], text.data(), text.size(), MSG_NOSIGNAL), static_cast<int>(text.size()));
  ck_assert_int_eq(serve_head(ends[1], ends[1], device), 2);
  char answer[64] = {};
  ck_assert(::recv(ends[0], answer, sizeof answer - 1, 0) > 0);
  ck_assert_str_eq(answer, "fault no such port\n");
  ck_assert_int_eq(device.ticks, 0);
  ::close(ends[0]);
  ::close(ends[1]);
}
END_TEST

START_TEST(silence_after_other_limits_stops_a_head_that_returns_within_them) {
  NotingDevice device;
  int ends[2];
  ck_assert_int_eq(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
  auto status = std::async(std::launch::async, [&] { return serve_head(ends[1], ends[1], device); });
  const std::string text =
      "cerberus-head 1 timeout 0.05 limits -170 170 -45 45 speed 90 90 acceleration 600 600 start 0 0\n"
      "limits -10 10 -10 10\n";
  ck_assert_int_eq(::send(ends[0], text.data(), text.size(), MSG_NOSIGNAL), static_cast<int>(text.size()));
  auto stopped = device.stopped.get_future();
  ck_assert(device.limited.get_future().wait_for(60s) == std::future_status::ready);
  ck_assert(stopped.wait_for(60s) == std::future_status::ready);
  ::close(ends[0]);
  ck_assert_int_eq(status.get(), 0);
  ::close(ends[1]);
}
END_TEST

START_TEST(other_limits_leave_the_speeds_of_the_first_line) {
  NotingDevice device;
  HeadServer server(device, [](const std::string&) {});
  server.obey("cerberus-head 1 timeout 0.5 limits -170 170 -45 45 speed 30 20 acceleration 200 100 start 0 0",
              0s);
  server.obey("limits -10 10 -5 5", 1ms);
  const auto check = [](const cerberus::motion::AxisLimits& axis, double to, double speed,
                        double acceleration) {
    using cerberus::sensing::degrees;
    ck_assert_double_eq_tol(degrees(axis.to), to, 1e-9);
    ck_assert_double_eq_tol(degrees(axis.from), -to, 1e-9);
    ck_assert_double_eq_tol(degrees(axis.speed), speed, 1e-9);
    ck_assert_double_eq_tol(degrees(axis.acceleration), acceleration, 1e-9);
  };
  check(device.limits.pan, 10, 30, 200);
  check(device.limits.tilt, 5, 20, 100);
}
END_TEST

START_TEST(a_stop_while_the_emergency_contact_is_open_releases) {
  NotingDevice device;
  cerberus::tests::FakeLines contact;
  contact.inputs = {true};
  EmergencyStop guarded(device, std::make_unique<cerberus::tests::FakePort>(contact), "26");
  ck_assert(guarded.open({}, 0s).empty());
  ck_assert_int_eq(device.releases, 1);
  guarded.stop(1ms);
  ck_assert_int_eq(device.releases, 2);
  ck_assert(device.stopped.get_future().wait_for(0s) == std::future_status::timeout);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "helper_loop",
      {a_head_that_cannot_be_opened_is_left_alone_and_ends_the_helper,
       the_end_of_the_pipeline_stops_a_head_whose_steps_are_overdue,
       silence_after_other_limits_stops_a_head_that_returns_within_them,
       other_limits_leave_the_speeds_of_the_first_line, a_stop_while_the_emergency_contact_is_open_releases});
}
