// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sensing/levels.h"

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "support/suite.h"

using namespace cerberus::sensing;
using namespace std::chrono_literals;

namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
using Readings = std::vector<Presence>;
constexpr Presence O = Presence::none, I = Presence::detected, X = Presence::invalid;

Readings now(const LevelSensors& sensors) {
  return {sensors.presence().begin(), sensors.presence().end()};
}

START_TEST(a_voltage_switches_with_hysteresis) {
  LevelSwitch level({.threshold = 1.5, .hysteresis = 1});  // on at 2, off below 1
  ck_assert(!level.update(1.9) && level.update(2.0) && level.update(1.0) && !level.update(0.99) &&
            !level.update(1.5));
  ck_assert(level.update(3) && level.update(std::numeric_limits<double>::quiet_NaN()));
  for (const double none : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    LevelSwitch sharp({.threshold = 1.5, .hysteresis = none});
    ck_assert(!sharp.update(1.49) && sharp.update(1.5) && !sharp.update(1.49));
  }
}
END_TEST

START_TEST(nothing_is_known_before_the_first_measurement) {
  LevelSensors sensors;
  sensors.begin(2, {});
  ck_assert(now(sensors) == Readings({X, X}));
  ck_assert(sensors.deadline() == kNever);
  sensors.poll(1s);
  ck_assert(now(sensors) == Readings({X, X}));
  sensors.measure(2s, std::array{0.1F, 3.0F});
  ck_assert(now(sensors) == Readings({O, I}));
  sensors.begin(1, {});
  ck_assert(now(sensors) == Readings({X}));
}
END_TEST

START_TEST(a_fall_counts_when_the_debounce_time_is_over) {
  LevelSensors sensors;
  sensors.begin(1, {}, {.debounce = 30ms});
  sensors.measure(0s, std::array{3.0F});
  sensors.measure(1s, std::array{0.0F});
  ck_assert(now(sensors) == Readings({I}));
  ck_assert(sensors.deadline() == 1030ms);
  sensors.poll(1029ms);
  ck_assert(now(sensors) == Readings({I}));
  sensors.poll(1030ms);
  ck_assert(now(sensors) == Readings({O}));
}
END_TEST

START_TEST(what_was_not_measured_is_invalid_until_it_is) {
  LevelSensors sensors;
  sensors.begin(3, {}, {.debounce = 0ms});
  sensors.measure(0s, std::array{3.0F, 3.0F, 3.0F});
  sensors.measure(1s, std::array{kNaN, std::numeric_limits<float>::infinity()});  // and none for the third
  ck_assert(now(sensors) == Readings({X, X, X}));
  sensors.measure(2s, std::array{1.65F, 0.0F, 3.0F});  // 1.65 V: as before, by its hysteresis
  ck_assert(now(sensors) == Readings({I, O, I}));
}
END_TEST

START_TEST(a_stuck_sensor_is_invalid_and_reported) {
  LevelSensors sensors;
  sensors.begin(2, {}, {.stuck_after = 5s});
  sensors.measure(0s, std::array{3.0F, 0.0F});
  ck_assert(sensors.fault(0) == PirFault::none && sensors.deadline() == 5s);
  sensors.poll(5s);
  ck_assert(now(sensors) == Readings({X, O}));
  ck_assert(sensors.fault(0) == PirFault::stuck_on && sensors.fault(1) == PirFault::none);
  sensors.measure(6s, std::array{0.0F, 0.0F});
  sensors.poll(7s);
  ck_assert(now(sensors) == Readings({O, O}) && sensors.fault(0) == PirFault::none);
}
END_TEST

// Volts that are a line's level with noise on it, less than half the hysteresis: presence is that of the line itself.
START_TEST(noise_within_the_hysteresis_changes_nothing) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> noise(-0.4F, 0.4F);
  LevelSensors sensors;
  sensors.begin(1, {.threshold = 1.5, .hysteresis = 1});
  PirModel line;
  bool level = false;
  Time time = 0s;
  for (int i = 0; i < 20000; ++i, time += 7ms) {
    if (random() % 16 == 0) level = !level;
    const float volts = level ? 2.5F : 0.5F;
    sensors.measure(time, std::array{volts + noise(random)});
    line.edge(time, level);
    ck_assert(sensors.presence()[0] == line.presence());
    ck_assert(sensors.fault(0) == line.fault());
    ck_assert(sensors.deadline() == line.deadline());
  }
}
END_TEST

}  // namespace

int main() {
  return cerberus::tests::run_suite(
      "levels", {a_voltage_switches_with_hysteresis, nothing_is_known_before_the_first_measurement,
                 a_fall_counts_when_the_debounce_time_is_over, what_was_not_measured_is_invalid_until_it_is,
                 a_stuck_sensor_is_invalid_and_reported, noise_within_the_hysteresis_changes_nothing});
}
