// SPDX-License-Identifier: LGPL-2.1-or-later
// cerberus-head with motors on a GPIO chip that the kernel simulates: every step as the kernel recorded it. The first
// argument is cerberus-head. Times of a machine within a machine are reported; what is asserted of the ramp are the
// deadlines that the helper planned.
#include "simulated.h"

#include <fcntl.h>
#include <linux/i2c-dev.h>
#include <linux/i2c.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>

#include <csignal>
#include <filesystem>
#include <optional>
#include <thread>

#include "../support/fake_lines.h"
#include "drivers/helper/helper_head.h"
#include "helper.h"

using namespace simulated;
using Kind = cerberus::motion::AxisCommand::Kind;

namespace {

constexpr int kContact = 9;
constexpr char kCoils[] = "--pan=lines=2,3,4,5";

// One motor on the lines 2 to 5 of the chip.
Helper stepper(const Chip& chip, const std::vector<std::string>& more) {
  std::vector<std::string> words{"stepper-gpio", "--device=" + chip.path(), kCoils, "--late-limit=5000"};
  words.insert(words.end(), more.begin(), more.end());
  HeadSetup setup;
  setup.limits.pan.speed = radians(50);
  setup.limits.pan.acceleration = radians(500);
  return Helper(words, setup);
}

// Waits for the coils to be off. Returns how long it took.
Clock::duration wait_off(const Chip& chip, Clock::duration most) {
  const auto took = wait_coils(chip, true, most);
  ck_assert_msg(took.has_value(), "coils are on after %.0f ms", milliseconds(most));
  return took.value_or(most);
}

struct Set {
  int gpio = 0;
  bool level = false;
  double time = 0;  // seconds
};

// Of a line such as "cerberus-head-92 [001] ..... 5.123456: gpio_value: 514 set 1".
std::optional<Set> parse_set(const std::string& line) {
  const std::size_t event = line.find(": gpio_value: ");
  if (event == line.npos) return std::nullopt;
  Set set;
  int level = 0;
  if (std::sscanf(line.c_str() + event, ": gpio_value: %d set %d", &set.gpio, &level) != 2)
    return std::nullopt;
  set.level = level != 0;
  const std::size_t blank = line.rfind(' ', event - 1);
  set.time = std::strtod(line.c_str() + blank, nullptr);
  return set;
}

// A register of the PCA9685 at address 0x40, as i2c-stub keeps it.
int register_of(int number) {
  const int bus = ::open("/dev/i2c-0", O_RDWR | O_CLOEXEC);
  must(bus >= 0 && ::ioctl(bus, I2C_SLAVE_FORCE, 0x40) == 0, "/dev/i2c-0");
  i2c_smbus_data data{};
  i2c_smbus_ioctl_data call{I2C_SMBUS_READ, static_cast<__u8>(number), I2C_SMBUS_BYTE_DATA, &data};
  must(::ioctl(bus, I2C_SMBUS, &call) == 0, "read a register");
  ::close(bus);
  return data.byte;
}

void plug_pca9685() {
  write_text("/sys/bus/i2c/devices/i2c-0/new_device", "pca9685 0x40");
}
void unplug_pca9685() {
  write_text("/sys/bus/i2c/devices/i2c-0/delete_device", "0x40");
}

// Makes the PCA9685, of which the kernel keeps the registers only. False, and says why: there is none.
bool has_pca9685() {
  const char* module = std::getenv("CERBERUS_I2C_STUB");
  if (!module) {
    std::printf("skipped: the kernel has no i2c-stub\n");
    return false;
  }
  if (::access("/sys/bus/i2c/devices/i2c-0", F_OK) == 0) return true;  // of another test
  const int file = ::open(module, O_RDONLY | O_CLOEXEC);
  must(file >= 0 && ::syscall(SYS_finit_module, file, "chip_addr=0x40", 0) == 0, "insmod i2c-stub");
  ::close(file);
  plug_pca9685();
  return true;
}

// Of LED3: counts of 4096 in 20 ms.
int pulse() {
  return (register_of(0x15) & 15) * 256 + register_of(0x14) -
         ((register_of(0x13) & 15) * 256 + register_of(0x12));  // LED3_OFF, LED3_ON
}
bool pulses_off() {
  return register_of(0x15) & 16;
}
bool a_helper_runs() {
  std::error_code gone;  // processes end meanwhile
  for (const auto& each : std::filesystem::directory_iterator("/proc", gone)) {
    std::string name;
    std::ifstream words(each.path() / "cmdline");  // nothing of one that has ended
    if (std::getline(words, name, '\0') && name.ends_with("cerberus-head")) return true;
  }
  return false;
}

}  // namespace

START_TEST(every_half_step_of_90_degrees_is_in_the_kernels_trace) {
  const Chip chip(12);
  const std::string record = "/run/steps";
  std::vector<Set> sets;
  {
    Helper helper = stepper(chip, {"--release-delay=0.5", "--record=" + record});
    const Trace trace("gpio/gpio_value");
    helper.send("move to 90 50 hold\n");
    helper.arrive(90);
    for (const auto end = Clock::now() + 20s; !coils_off(chip) && Clock::now() < end;) helper.expect("pose");
    for (const std::string& line : trace.lines())
      if (const auto set = parse_set(line)) sets.push_back(*set);
  }
  ck_assert(coils_off(chip));
  // The phase in which it rests, a line for each half step, and four to switch off.
  ck_assert_uint_eq(sets.size(), 1 + 1019 + 4);
  cerberus::tests::FakeLines lines;
  lines.levels.resize(4);
  cerberus::tests::CoilMotor motor;
  const int first = sets.front().gpio;  // IN1
  ck_assert(sets.front().level);
  for (std::size_t k = 0; k < 1 + 1019; ++k) {
    lines.levels.at(static_cast<std::size_t>(sets[k].gpio - first)) = sets[k].level;
    motor.follow(lines);
    ck_assert_int_eq(motor.half_steps(), static_cast<int>(k));  // in order, one at a time
  }
  for (std::size_t k = 1 + 1019; k < sets.size(); ++k) ck_assert(!sets[k].level);

  // 50 degrees a second at 500 a second squared: cruising at 566.08 half steps a second, 90 / 50 + 50 / 500 = 1.9 s.
  std::ifstream file(record);
  std::vector<double> planned, executed;
  std::string axis;
  for (long long count, plan, done; file >> axis >> count >> plan >> done;) {
    planned.push_back(static_cast<double>(plan) * 1e-9);
    executed.push_back(static_cast<double>(done) * 1e-9);
  }
  ck_assert_uint_eq(planned.size(), 1019);
  const double step = 360 / 4075.7728395;
  for (std::size_t k = 1; k < 28;
       ++k)  // it speeds up over 2.5 degrees; step k is due sqrt(2 (k + .5) step / 500) after the start
    ck_assert_double_eq_tol(
        planned[k] - planned[0],
        std::sqrt(2 * (static_cast<double>(k) + 0.5) * step / 500) - std::sqrt(step / 500), 1e-6);
  ck_assert_double_eq_tol(planned[600] - planned[500], 100 * step / 50, 1e-6);
  ck_assert_double_eq_tol(planned.back() - planned.front(), 1.9 - 2 * std::sqrt(step / 500), 2e-3);
  double latest = 0;
  for (std::size_t k = 0; k < planned.size(); ++k) latest = std::max(latest, executed[k] - planned[k]);
  std::printf("90 degrees: %.3f s from the first edge to the last step, latest step %.1f ms\n",
              sets[1019].time - sets[0].time, latest * 1e3);
}
END_TEST

START_TEST(an_open_contact_switches_the_coils_off) {
  Chip chip(12);
  Helper helper = stepper(chip, {"--emergency-stop=" + chip.path() + ":" + std::to_string(kContact)});
  helper.expect("fault the emergency stop is pressed");  // pulled up: as a broken wire
  helper.expect("emergency pressed");
  helper.send("move at 20 hold\n");
  helper.expect("pose");
  helper.expect("pose");
  ck_assert(coils_off(chip));
  chip.pull(kContact, false);
  helper.expect("emergency released");
  ck_assert(coils_off(chip));
  helper.send("move at 20 hold\n");
  while (coils_off(chip)) std::this_thread::sleep_for(1ms);
  helper.expect("pose");
  chip.pull(kContact, true);
  std::printf("emergency stop: off after %.1f ms\n", milliseconds(wait_off(chip, 60s)));
  helper.expect("emergency pressed");
}
END_TEST

START_TEST(coils_are_off_when_the_pipeline_is_killed) {
  std::vector<Clock::duration> times;
  for (int round = 0; round < kills(); ++round) {
    const Chip chip(12);
    HelperHead head("stepper-gpio");
    const auto drive = [&] {
      HeadSetup setup;
      setup.helper = program;
      setup.device = chip.path();
      setup.options = "pan='lines=2,3,4,5' late-limit=5000 release-delay=never";
      setup.helper_timeout = 10s;  // the end of its input stops it, and no silence
      return head.open(setup).empty() && head.command({0s, {Kind::velocity, radians(30), 0}, {}}).empty();
    };
    const pid_t pipeline = pipeline_that_drives(drive, [&] { return !coils_off(chip); });
    std::this_thread::sleep_for(std::chrono::milliseconds(37 * round % 400));
    ::kill(pipeline, SIGKILL);
    times.push_back(wait_off(chip, 60s));
    ck_assert_int_eq(::waitpid(pipeline, nullptr, 0), pipeline);
    // The helper ends: its lines are free again.
    std::this_thread::sleep_for(300ms);
  }
  ck_assert(report_kills("coils off", times));
}
END_TEST

START_TEST(a_chip_that_is_removed_while_the_head_moves_is_reported) {
  Chip chip(12);
  Helper helper = stepper(chip, {});
  helper.send("move at 20 hold\n");
  helper.expect("pose");
  chip.unplug();
  const std::string fault = helper.expect("fault");
  ck_assert_msg(fault.find(chip.path() + " does not answer any more") != std::string::npos, "'%s'",
                fault.c_str());
}
END_TEST

// Its coils are off, and it sets no line.
START_TEST(a_chip_that_is_removed_while_the_head_rests_is_reported_and_used_again) {
  Chip chip(12);
  Helper helper(
      {"stepper-gpio", "--device=" + chip.label(), kCoils, "--late-limit=5000", "--release-delay=0.1"},
      HeadSetup{});
  helper.send("move to 5 50 hold\n");
  helper.arrive(5);
  wait_off(chip, 60s);
  chip.unplug();
  const auto pulled = Clock::now();
  const std::string fault = helper.expect("fault");
  std::printf("chip removed at rest: reported after %.0f ms\n", milliseconds(Clock::now() - pulled));
  ck_assert_msg(fault.find("does not answer any more") != std::string::npos, "'%s'", fault.c_str());
  chip.plug();
  helper.expect("recovered");
  ck_assert(coils_off(chip));
  helper.send("move to 0 50 hold\n");
  helper.arrive(0);
}
END_TEST

START_TEST(lines_that_are_taken_are_named) {
  const Chip chip(12);
  Helper helper = stepper(chip, {});
  HelperHead second("stepper-gpio");
  HeadSetup setup;
  setup.helper = program;
  setup.device = chip.path();
  setup.options = "pan='lines=4,5,6,7'";
  const std::string wrong = second.open(setup);
  ck_assert_msg(wrong.find("Line 4 of GPIO chip " + chip.path() + " is in use by \"cerberus\"") == 0, "'%s'",
                wrong.c_str());
}
END_TEST

START_TEST(a_servo_on_a_pca9685_gets_its_pulses) {
  if (!has_pca9685()) return;
  HeadSetup setup;
  setup.limits.pan = {radians(-45), radians(45), radians(90), radians(600)};
  {
    Helper helper({"servo-pwm", "--device=pwmchip0", "--pan=channel=3 slew=90"}, setup);
    for (const auto& [angle, count] : {std::pair{45, 409.6}, {-45, 204.8}, {0, 307.2}}) {
      helper.send("move to " + std::to_string(angle) + " 90 hold\n");
      helper.arrive(angle);
      std::this_thread::sleep_for(200ms);  // two periods of an emulated machine
      ck_assert_msg(std::abs(pulse() - count) <= 1, "%d counts at %d degrees, not %g", pulse(), angle, count);
    }
    ck_assert_int_eq(register_of(0xfe), 121);  // prescaler: 25 MHz / (4096 x 50 Hz) - 1
  }
  for (const auto end = Clock::now() + 10s; !pulses_off() && Clock::now() < end;)
    std::this_thread::sleep_for(10ms);
  ck_assert(pulses_off());
}
END_TEST

START_TEST(a_pwm_chip_that_is_removed_while_the_servo_rests_is_reported_and_used_again) {
  if (!has_pca9685()) return;
  HeadSetup setup;
  setup.limits.pan = {radians(-45), radians(45), radians(90), radians(600)};
  Helper helper({"servo-pwm", "--device=pwmchip0", "--pan=channel=3", "--release-delay=0.1"}, setup);
  helper.send("move to 10 90 hold\n");
  helper.arrive(10);
  for (const auto end = Clock::now() + 60s; !pulses_off() && Clock::now() < end;)
    std::this_thread::sleep_for(10ms);
  ck_assert(pulses_off());
  unplug_pca9685();
  const auto pulled = Clock::now();
  const std::string fault = helper.expect("fault");
  std::printf("PWM chip removed at rest: reported after %.0f ms\n", milliseconds(Clock::now() - pulled));
  ck_assert_msg(fault.find("pwmchip0 does not answer any more") != std::string::npos, "'%s'", fault.c_str());
  plug_pca9685();
  helper.expect("recovered");
  ck_assert(pulses_off());
  helper.send("move to 0 90 hold\n");
  helper.arrive(0);
}
END_TEST

// Its pulses are 4.55 counts a degree, so that they change 18 times a second.
START_TEST(servos_stand_when_the_pipeline_is_killed) {
  if (!has_pca9685()) return;
  std::vector<Clock::duration> times;
  for (int round = 0; round < kills(); ++round) {
    HelperHead head("servo-pwm");
    const auto drive = [&] {
      HeadSetup setup;
      setup.limits.pan = {radians(-45), radians(45), radians(90), radians(600)};
      setup.pan = radians(-45);
      setup.helper = program;
      setup.device = "pwmchip0";
      setup.options = "pan='channel=3 pulse=500,2500'";
      setup.helper_timeout = 10s;
      return head.open(setup).empty() && head.command({0s, {Kind::velocity, radians(4), 0}, {}}).empty();
    };
    const pid_t pipeline = pipeline_that_drives(drive, [] { return !pulses_off() && pulse() > 103 + 2; });
    std::this_thread::sleep_for(std::chrono::milliseconds(37 * round % 400));
    ::kill(pipeline, SIGKILL);
    const auto killed = Clock::now();
    ck_assert_int_eq(::waitpid(pipeline, nullptr, 0), pipeline);
    auto changed = killed;
    int last = pulse(), most = 0;
    bool off = pulses_off();
    const auto over = [&] { return off || !a_helper_runs(); };  // else it may only be slow
    while (Clock::now() - changed < 1s || (!over() && Clock::now() - killed < 60s)) {
      const int now = pulse();
      const bool ended = pulses_off();
      if (now != last || off != ended) changed = Clock::now();
      last = now;
      off = ended;
      if (!off) most = std::max(most, last);
      std::this_thread::sleep_for(2ms);
    }
    ck_assert(over());
    ck_assert_int_lt(most, 512 - 2);  // it did not reach its limit
    times.push_back(changed - killed);
  }
  ck_assert(report_kills("servo stands", times));
}
END_TEST

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  program = argv[1];
  return cerberus::tests::run_suite(
      "hardware_heads",
      {every_half_step_of_90_degrees_is_in_the_kernels_trace, an_open_contact_switches_the_coils_off,
       coils_are_off_when_the_pipeline_is_killed, a_chip_that_is_removed_while_the_head_moves_is_reported,
       a_chip_that_is_removed_while_the_head_rests_is_reported_and_used_again, lines_that_are_taken_are_named,
       a_servo_on_a_pca9685_gets_its_pulses,
       a_pwm_chip_that_is_removed_while_the_servo_rests_is_reported_and_used_again,
       servos_stand_when_the_pipeline_is_killed},
      120 + 8 * kills());
}
