// SPDX-License-Identifier: LGPL-2.1-or-later
// The servo driver on a folder of files in place of a PWM chip.
#include "drivers/servo/servo_head.h"

#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "drivers/helper/option_words.h"
#include "support/suite.h"
#include "support/text.h"

using namespace cerberus::drivers;
using namespace std::chrono_literals;
using cerberus::sensing::radians;
using cerberus::tests::assert_text;
using Kind = cerberus::motion::AxisCommand::Kind;

namespace {

class Chip {
 public:
  Chip() {
    char name[] = "/tmp/cerberus-pwm-XXXXXX";
    folder_ = ::mkdtemp(name);
    for (const int channel : {0, 1}) {
      const std::string path = folder_ + "/pwm" + std::to_string(channel);
      ::mkdir(path.c_str(), 0755);
      for (const char* file : {"period", "duty_cycle", "enable"}) std::ofstream(path + "/" + file) << "0\n";
    }
    std::ofstream(folder_ + "/export");
  }
  ~Chip() { std::filesystem::remove_all(folder_); }
  const std::string& folder() const { return folder_; }
  long read(const char* file, int channel = 0) const {
    std::ifstream in(folder_ + "/pwm" + std::to_string(channel) + "/" + file);
    long value = -1;
    in >> value;
    return value;
  }

 private:
  std::string folder_;
};

ServoOptions options(const Chip& chip, const std::string& pan, const std::string& tilt = "") {
  ServoOptions options;
  options.chip = chip.folder();
  assert_text(parse_servo_axis(pan, options.pan), "");
  if (!tilt.empty()) assert_text(parse_servo_axis(tilt, options.tilt), "");
  return options;
}

HeadSetup setup() {
  HeadSetup setup;
  setup.limits.pan = {radians(-40), radians(40), radians(60), radians(600)};
  setup.limits.tilt = {radians(-20), radians(20), radians(60), radians(600)};
  return setup;
}

Time run(ServoHead& head, Time now, Time length) {
  for (const Time end = now + length; now < end;) {
    const Time next = head.tick(now);
    ck_assert(next > now);
    now = std::min(end, next);
  }
  return now;
}

}  // namespace

START_TEST(angles_become_pulses) {
  Chip chip;
  ServoHead head(options(chip, "channel=0", "channel=1 pulse=600,2400 range=-90,90 invert trim=9"));
  assert_text(head.open(setup(), 0s), "");
  ck_assert_int_eq(chip.read("period"), 20000000);
  ck_assert_int_eq(chip.read("enable"), 0);  // a head that was sent nowhere gives no pulse
  head.move({Kind::position, radians(18), 10}, {Kind::position, radians(-9), 10}, 0s);
  run(head, 0s, 2s);
  ck_assert_int_eq(chip.read("enable"), 1);
  ck_assert_int_eq(chip.read("duty_cycle"), 1700000);     // 1500 us + 18 / 90 of 1000 us
  ck_assert_int_eq(chip.read("duty_cycle", 1), 1500000);  // the trim takes -9 to the middle
  const auto pose = head.take_pose(2s);                   // it is where its plan is
  ck_assert(pose && head.abilities().feedback);
  ck_assert_double_eq_tol(pose->pan.position, radians(18), 1e-9);
  ck_assert_double_eq_tol(pose->tilt.position, radians(-9), 1e-9);
  head.move({Kind::position, radians(18), 10}, {Kind::position, radians(11), 10}, 2s);
  run(head, 2s, 2s);
  ck_assert_int_eq(chip.read("duty_cycle", 1), 1300000);  // 20 / 180 of 1800 us, downwards
}
END_TEST

// With the pulse that follows the command, and not with one that repeats the last.
START_TEST(a_motion_from_rest_begins_at_once_and_goes_on_evenly) {
  Chip chip;
  ServoHead head(options(chip, "channel=0"));
  head.open(setup(), 0s);
  head.move({Kind::position, 0, 10}, {}, 0s);
  Time now = run(head, 0s, 510ms);  // between two periods
  ck_assert_int_eq(chip.read("duty_cycle"), 1500000);
  head.move({Kind::position, 0, 10}, {}, now);  // nothing to move yet
  head.move({Kind::velocity, radians(60), 0}, {}, now);
  head.tick(now);
  // 600 degrees a second squared for 20 ms: .12 degrees = 1.33 us.
  ck_assert_int_eq(chip.read("duty_cycle"), 1501333);
  for (long last = 1501333, step = 0; now < 700ms;) {
    now = run(head, now, 20ms);
    const long width = chip.read("duty_cycle");
    ck_assert_int_ge(width - last, step - 2000);  // it speeds up to 13.3 us a period and never goes back
    ck_assert_int_ge(width, last);
    step = width - last;
    last = width;
  }
}
END_TEST

START_TEST(the_pulse_turns_no_faster_than_allowed) {
  Chip chip;
  ServoHead head(options(chip, "channel=0 slew=30"));
  ck_assert(head.abilities().feedback);  // the pipeline's model is faster
  assert_text(head.open(setup(), 0s), "");
  head.move({Kind::position, radians(36), 10}, {}, 0s);
  long last = 1500000, most = 0;
  for (Time now = 0s; now < 2s;) {
    now = run(head, now, 20ms);
    const long width = chip.read("duty_cycle");
    most = std::max(most, width - last);
    last = width;
  }
  ck_assert_int_eq(last, 1900000);
  // 30 degrees a second x 20 ms = .6 degrees = 6.67 us a period.
  ck_assert(most <= 6700 && most >= 6600);
}
END_TEST

START_TEST(pulses_end_whole_and_begin_with_the_width_they_ended_with) {
  Chip chip;
  ServoOptions with = options(chip, "channel=0");
  with.release_delay = 1s;
  ServoHead head(with);
  head.open(setup(), 0s);
  head.move({Kind::position, radians(9), 10}, {}, 0s);
  Time now = run(head, 0s, 1s);
  ck_assert_int_eq(chip.read("duty_cycle"), 1600000);
  int quiet = 0;  // periods without a pulse before the output is off: the last pulse has ended by then
  for (int k = 0; k < 100 && chip.read("enable") == 1; ++k) {
    quiet += chip.read("duty_cycle") == 0;
    now = run(head, now, 20ms);
  }
  ck_assert_int_eq(chip.read("enable"), 0);
  ck_assert_int_eq(quiet, 2);
  head.move({Kind::velocity, radians(10), 0}, {}, now);
  head.tick(now);
  ck_assert_int_eq(chip.read("enable"), 1);
  ck_assert_int_eq(chip.read("duty_cycle"), 1600000);
}
END_TEST

START_TEST(a_stop_brakes_and_holds_and_the_end_gives_no_pulse) {
  Chip chip;
  {
    ServoHead head(options(chip, "channel=0"));
    HeadSetup slow = setup();
    slow.limits.pan.acceleration = radians(20);
    head.open(slow, 0s);
    head.move({Kind::velocity, radians(60), 0}, {}, 0s);
    Time now = run(head, 0s, 1s);
    head.stop(now);
    ck_assert(head.stopping());
    now = run(head, now, 280ms);
    ck_assert(!head.stopping());
    const long there = chip.read("duty_cycle");
    ck_assert(there > 1500000);
    run(head, now, 1s);
    ck_assert_int_eq(chip.read("duty_cycle"), there);
    ck_assert_int_eq(chip.read("enable"), 1);
    head.release(now);
    ck_assert_int_eq(chip.read("enable"), 0);
  }
  ck_assert_int_eq(chip.read("enable"), 0);
}
END_TEST

START_TEST(a_stop_does_not_bring_a_servo_back_within_limits_that_were_moved) {
  Chip chip;
  ServoHead head(options(chip, "channel=0"));
  head.open(setup(), 0s);
  head.move({Kind::position, radians(36), 10}, {}, 0s);
  Time now = run(head, 0s, 2s);
  ck_assert_int_eq(chip.read("duty_cycle"), 1900000);
  cerberus::motion::Limits narrow = setup().limits;
  narrow.pan.to = radians(9);
  head.limit(narrow, now);
  head.stop(now);
  ck_assert(!head.stopping());
  run(head, now, 2s);
  ck_assert_int_eq(chip.read("duty_cycle"), 1900000);
}
END_TEST

// The channel of a chip that returned may appear late. The opening waits for that, tick() does not: it tries again.
START_TEST(a_chip_that_returns_without_its_channel_holds_up_nothing) {
  Chip chip;
  const std::string channel = chip.folder() + "/pwm0/";
  std::filesystem::remove(channel + "enable");
  std::filesystem::create_symlink("/dev/full", channel + "enable");  // every write fails
  ServoHead head(options(chip, "channel=0"));
  assert_text(head.open(setup(), 0s), "");
  head.move({Kind::position, radians(36), 10}, {}, 0s);
  Time now = run(head, 0s, 100ms);
  ck_assert(head.fault().find("does not answer any more") != std::string::npos);
  std::filesystem::rename(channel + "duty_cycle", channel + "away");
  std::filesystem::remove(channel + "enable");
  std::ofstream(channel + "enable") << "0\n";
  using Clock = std::chrono::steady_clock;
  auto shortest = Clock::duration::max();  // of three: the machine may be busy
  for (int k = 0; k < 3; ++k) {
    now += 1s;
    const auto begin = Clock::now();
    now = head.tick(now);
    shortest = std::min(shortest, Clock::now() - begin);
  }
  ck_assert(shortest < PwmChannel::kPatience / 2);
  ck_assert(!head.fault().empty());
  std::filesystem::rename(channel + "away", channel + "duty_cycle");
  now = run(head, now, 1100ms);
  assert_text(head.fault(), "");
  ck_assert_int_eq(chip.read("enable"), 0);  // it stands until the next move
}
END_TEST

START_TEST(a_channel_has_one_program_and_the_second_one_is_told_which) {
  const Chip chip;
  ServoHead first(options(chip, "channel=0"));
  assert_text(first.open(setup(), 0s), "");
  const std::string wrong = ServoHead(options(chip, "channel=1", "channel=0")).open(setup(), 0s);
  ck_assert_msg(wrong.find("channel 0 of the PWM chip " + chip.folder() +
                           " (tilt) is driven by another program (process " + std::to_string(::getpid())) !=
                    std::string::npos,
                "%s", wrong.c_str());
  assert_text(ServoHead(options(chip, "channel=1")).open(setup(), 0s), "");  // a chip has many
}
END_TEST

START_TEST(limits_beyond_the_servo_and_a_missing_chip_are_named) {
  Chip chip;
  ServoHead head(options(chip, "channel=0 trim=2"));
  HeadSetup wide = setup();
  wide.limits.pan.to = radians(170);
  assert_text(
      head.open(wide, 0s),
      "pan-min -40 and pan-max 170 are beyond what the servo reaches, -47 to 43 (range and trim): set "
      "pan-min and pan-max");
  ServoOptions gone = options(chip, "channel=0");
  gone.chip = "/tmp/no-such-chip";
  ck_assert(ServoHead(gone).open(setup(), 0s).find("there is no PWM chip /tmp/no-such-chip. ") == 0);
  ServoOptions other = options(chip, "channel=7");  // is exported and does not appear
  ck_assert(ServoHead(other).open(setup(), 0s).find("channel 7 of the PWM chip " + chip.folder()) == 0);
  ServoOptions fast = options(chip, "channel=0", "channel=1 pulse=500,2500");
  assert_text(ServoHead(fast).check(), "");
  fast.period = Time(2'500'000);
  assert_text(ServoHead(fast).check(),
              "a pulse of 2500 microseconds does not end before the next one (frequency and pulse)");
  ServoAxisOptions axis;
  assert_text(parse_servo_axis("channel=0 invert=no", axis), "invert=no: invert takes no value");
  assert_text(parse_servo_axis("pulse=2000,1000 channel=0", axis),
              "pulse=2000,1000: SHORTEST,LONGEST in microseconds, 100 to 10000");
  assert_text(parse_servo_axis("", axis), "channel= is missing: the servo's channel of the PWM chip");
  assert_text(parse_servo_axis("channel=1.5", axis), "channel=1.5: a channel of the PWM chip, 0 to 255");
  ck_assert(parse_servo_axis("channel=0 speed=3", axis).find("\"speed\" is no option") == 0);
  assert_text(pwm_chip_folder("pwmchip2"), "/sys/class/pwm/pwmchip2");
  assert_text(pwm_chip_folder("2"), "/sys/class/pwm/pwmchip2");
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "servo_head",
      {angles_become_pulses, a_motion_from_rest_begins_at_once_and_goes_on_evenly,
       the_pulse_turns_no_faster_than_allowed, pulses_end_whole_and_begin_with_the_width_they_ended_with,
       a_stop_brakes_and_holds_and_the_end_gives_no_pulse,
       a_stop_does_not_bring_a_servo_back_within_limits_that_were_moved,
       a_chip_that_returns_without_its_channel_holds_up_nothing,
       a_channel_has_one_program_and_the_second_one_is_told_which,
       limits_beyond_the_servo_and_a_missing_chip_are_named});
}
