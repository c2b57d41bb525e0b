// SPDX-License-Identifier: LGPL-2.1-or-later
// Sensors that block must not block their callers.
#include "drivers/sensor/sensor_runner.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <atomic>
#include <future>
#include <string>

#include "support/pipe.h"
#include "support/says.h"
#include "support/suite.h"

namespace {

using namespace cerberus::drivers;
using namespace std::chrono_literals;
using cerberus::sensing::Presence;
using cerberus::tests::Pipe;

// What a test and a device that it made know of each other.
struct Wire {
  std::atomic<int> reads = 0;
  std::atomic<bool> unplugged = false, dark = false, closed = false;
  Pipe lit;  // a line for each show(), of its readings
};

// A device with one event a read, for as long as it is plugged in. Its descriptor never becomes readable.
class Device final : public Sensor {
 public:
  explicit Device(std::shared_ptr<Wire> wire) : wire_(std::move(wire)) {}
  ~Device() override {
    close();
    if (fd_ >= 0) ::close(fd_);
  }
  SensorError open(const SensorSetup&) override {
    fd_ = ::eventfd(0, EFD_CLOEXEC);
    return {};
  }
  void close() noexcept override { wire_->closed = true; }
  void stop() noexcept override {}
  int fd() const override { return fd_; }
  SensorError read(Time now, std::vector<SensorEdge>& edges) override {
    if (wire_->unplugged) return {SensorFault::gone, "it was unplugged", ""};
    edges.push_back({now, 0, wire_->reads++ % 2 == 1});
    return {};
  }
  SensorError show(std::span<const Presence> readings) override {
    if (wire_->dark) return {SensorFault::gone, "no light", ""};
    std::string line;
    for (const Presence one : readings) line += std::to_string(static_cast<int>(one));
    line += "\n";
    return ::write(wire_->lit.ends[1], line.data(), line.size()) > 0 ? SensorError{}
                                                                     : SensorError{SensorFault::gone, "", ""};
  }
  std::string place(int sensor) const override { return "pin " + std::to_string(sensor); }
  bool measures() const override { return true; }

 private:
  std::shared_ptr<Wire> wire_;
  int fd_ = -1;
};

struct Rig {
  std::shared_ptr<Wire> wire = std::make_shared<Wire>();
  SensorRunner runner;
  Rig() {
    runner.begin(std::make_unique<Device>(wire), {}, {});
    ck_assert(runner.opened(60s) && !runner.error());
  }
  // Waits until the error is reported.
  std::string complaint() {
    std::vector<SensorEdge> edges;
    for (;;) {
      pollfd news{runner.fd(), POLLIN, 0};
      ck_assert_int_eq(poll(&news, 1, 60000), 1);
      if (const SensorError error = runner.read({}, edges)) return error.text;
    }
  }
};

std::unique_ptr<Sensor> scripted() {
  return make_sensor("scripted");
}

SensorSetup script(const std::string& text) {
  SensorSetup setup;
  setup.script = text;
  return setup;
}

START_TEST(the_first_levels_of_a_device_are_available_when_it_is_open) {
  Rig rig;
  std::vector<SensorEdge> edges;
  pollfd news{rig.runner.fd(), POLLIN, 0};
  ck_assert_int_eq(poll(&news, 1, 60000), 1);
  ck_assert(!rig.runner.read({}, edges) && !edges.empty() && !edges[0].level);
  ck_assert(rig.runner.place(2) == "pin 2" && rig.runner.measures() && !rig.runner.recording());
}
END_TEST

START_TEST(a_device_that_never_wakes_poll_is_read_periodically) {
  Rig rig;
  while (rig.wire->reads < 3) usleep(1000);
  rig.wire->unplugged = true;
  ck_assert(rig.complaint() == "it was unplugged");
}
END_TEST

START_TEST(leds_show_what_was_asked_for_last) {
  Rig rig;
  const Presence one[] = {Presence::detected, Presence::none, Presence::invalid}, other[] = {Presence::none};
  ck_assert(!rig.runner.show(one));
  ck_assert(rig.wire->lit.line() == "102");
  ck_assert(!rig.runner.show(other));
  ck_assert(rig.wire->lit.line() == "0");
  rig.wire->dark = true;
  rig.runner.show(one);
  ck_assert(rig.complaint() == "no light");
  ck_assert(rig.runner.show(one).text == "no light");  // and stays so
}
END_TEST

START_TEST(nothing_is_to_be_had_while_they_are_being_opened) {
  Pipe gate;
  SensorRunner runner;
  runner.begin(scripted(), script("open wait " + gate.reader() + "; 0,1,0,0"),
               [] { ck_abort_msg("it was not refused"); });
  ck_assert(!runner.opened() && !runner.opened(10ms));
  std::vector<SensorEdge> edges;
  ck_assert(!runner.read({}, edges) && edges.empty() && !runner.recording() && !runner.measures());
  ck_assert(runner.place(0).empty());
  pollfd news{runner.fd(), POLLIN, 0};
  ck_assert_int_eq(poll(&news, 1, 0), 0);
  gate.close_writer();
  ck_assert_int_eq(poll(&news, 1, 60000), 1);
  ck_assert(runner.opened() && !runner.error());
  const auto recording = runner.recording();
  ck_assert(recording && !recording->read(0s, edges) && edges.size() == 3 && edges[0].level);
  ck_assert(!runner.recording());  // once
}
END_TEST

START_TEST(a_refusal_is_reported_while_the_runner_exists) {
  Pipe gate;
  std::promise<void> reported;
  SensorRunner runner;
  const SensorSetup setup = script("open wait " + gate.reader() + "; open fail no such thing");
  runner.begin(scripted(), setup, [&] { reported.set_value(); });
  gate.close_writer();
  reported.get_future().wait();
  ck_assert(runner.opened() && runner.error().text == "no such thing" && !runner.recording());
  {
    Pipe closed;
    runner.begin(scripted(), script("open wait " + closed.reader() + "; open fail no such thing"),
                 [] { ck_abort_msg("no receiver is left"); });
    runner.close();
    ck_assert_int_eq(runner.fd(), -1);
  }
  usleep(100000);  // time for a wrong report
}
END_TEST

START_TEST(a_device_is_closed_by_its_own_thread_and_before_the_runner_is) {
  std::shared_ptr<Wire> wire;
  {
    Rig rig;
    wire = rig.wire;
    ck_assert(!wire->closed);
  }
  // 30 ms are enough on any machine that has a moment for it; then it is late, and not lost.
  while (!wire->closed) usleep(1000);
}
END_TEST

}  // namespace

int main() {
  return cerberus::tests::run_suite(
      "sensor_runner",
      {the_first_levels_of_a_device_are_available_when_it_is_open,
       a_device_that_never_wakes_poll_is_read_periodically, leds_show_what_was_asked_for_last,
       nothing_is_to_be_had_while_they_are_being_opened, a_refusal_is_reported_while_the_runner_exists,
       a_device_is_closed_by_its_own_thread_and_before_the_runner_is});
}
