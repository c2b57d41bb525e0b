// SPDX-License-Identifier: LGPL-2.1-or-later
// A gyro's attributes as files of a folder like that of the kernel, and the thread that reads them.
#include "drivers/iio/iio_gyro.h"

#include <condition_variable>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <string>
#include <vector>

#include "drivers/iio/gyro_runner.h"
#include "support/says.h"
#include "support/suite.h"

namespace {

using namespace cerberus::drivers;
using namespace std::chrono_literals;
namespace fs = std::filesystem;

// /sys/bus/iio/devices with an A/D converter and a gyro.
class Bus {
 public:
  Bus() {
    char name[] = "/tmp/cerberus-iio-XXXXXX";
    if (!mkdtemp(name)) ck_abort_msg("mkdtemp");
    folder_ = name;
    add("iio:device0", "ads1115", {{"in_voltage0_raw", "12"}});
    add("iio:device1", "mpu6050", {{"in_anglvel_z_raw", "-1000"}, {"in_anglvel_scale", "0.001064724"}});
  }
  ~Bus() { fs::remove_all(folder_); }
  void add(const std::string& id, const std::string& name,
           const std::vector<std::pair<std::string, std::string>>& files) {
    fs::create_directories(folder_ + "/" + id);
    write(id, "name", name);
    for (const auto& [file, text] : files) write(id, file, text);
  }
  // Written aside and moved: a reader finds the old or the new text.
  void write(const std::string& id, const std::string& file, const std::string& text) const {
    std::ofstream(folder_ + "/" + id + "/" + file) << text << '\n';
  }
  void remove(const std::string& id) const { fs::remove_all(folder_ + "/" + id); }
  GyroSetup gyro(const std::string& text) const {
    GyroSetup setup;
    const std::string wrong = parse_gyro(text, setup);
    ck_assert_msg(wrong.empty(), "%s", wrong.c_str());
    setup.folder = folder_;
    setup.interval = 1ms;
    return setup;
  }
  const std::string& folder() const { return folder_; }

 private:
  std::string folder_;
};

double read(const GyroSetup& setup) {
  IioGyro gyro;
  SensorError error = gyro.open(setup);
  double rate = 0;
  if (!error) error = gyro.read(rate);
  if (error) ck_abort_msg("%s", error.text.c_str());
  return rate;
}

void must_refuse(const GyroSetup& setup, SensorFault fault, const std::string& words) {
  IioGyro gyro;
  const SensorError error = gyro.open(setup);
  ck_assert_msg(error.fault == fault, "%s", error.text.c_str());
  ck_assert(says(error.text, words));
  ck_assert(!gyro.is_open());
}

START_TEST(a_turn_to_the_right_is_negative_for_an_axis_that_points_up) {
  Bus bus;
  // -1000 x 0.001064724 rad/s counter-clockwise = 1.064724 rad/s to the right
  for (const std::string& device :
       {std::string("mpu6050"), std::string("iio:device1"), bus.folder() + "/iio:device1"})
    ck_assert_double_eq_tol(read(bus.gyro(device)), 1.064724, 1e-12);
  ck_assert_double_eq_tol(read(bus.gyro("mpu6050 axis=z")), 1.064724, 1e-12);
  ck_assert_double_eq_tol(read(bus.gyro("mpu6050 axis=-z")), -1.064724, 1e-12);
}
END_TEST

START_TEST(an_axis_may_have_scale_and_offset_of_its_own) {
  Bus bus;
  bus.add("iio:device2", "fxas21002c",
          {{"in_anglvel_y_raw", "200"},
           {"in_anglvel_y_scale", "0.01"},
           {"in_anglvel_scale", "7"},
           {"in_anglvel_y_offset", "-50"}});
  ck_assert_double_eq_tol(read(bus.gyro("fxas21002c axis=-y")), 1.5, 1e-12);  // (200 - 50) x 0.01
  bus.add("iio:device3", "plain", {{"in_anglvel_x_raw", "3"}});
  ck_assert_double_eq_tol(read(bus.gyro("axis=x plain")), -3, 1e-12);
}
END_TEST

START_TEST(what_is_wrong_is_named) {
  Bus bus;
  must_refuse(bus.gyro("bno055"), SensorFault::not_found,
              "There are: iio:device0 (ads1115), iio:device1 (mpu6050).");
  must_refuse(bus.gyro("ads1115"), SensorFault::not_found, "\"ads1115\" is no gyro with an axis z");
  must_refuse(bus.gyro("mpu6050 axis=x"), SensorFault::not_found, "no gyro with an axis x");
  bus.write("iio:device1", "in_anglvel_z_raw", "much");
  must_refuse(bus.gyro("mpu6050"), SensorFault::gone, "mpu6050 cannot be read");
  GyroSetup setup = bus.gyro("mpu6050");
  setup.folder = "/nowhere";
  must_refuse(setup, SensorFault::not_found, "This machine has no IIO device.");
  for (const char* wrong :
       {"", "axis=z", "mpu6050 axis=w", "mpu6050 axis=", "mpu6050 axis=--z", "a b", "a rate=7"}) {
    GyroSetup ignored;
    ck_assert(says(parse_gyro(wrong, ignored), std::string("\"") + wrong + "\" names no gyro"));
  }
}
END_TEST

// What the runner's thread reported.
struct Reports {
  std::mutex lock;
  std::condition_variable news;
  std::vector<double> rates;
  std::vector<std::pair<std::string, bool>> changes;

  GyroRunner::Calls calls() {
    return {.on_rate =
                [this](double rate) {
                  const std::lock_guard guard(lock);
                  rates.push_back(rate);
                  news.notify_all();
                },
            .on_change =
                [this](const SensorError& error, bool final) {
                  const std::lock_guard guard(lock);
                  changes.emplace_back(error.text, final);
                  news.notify_all();
                }};
  }
  template <typename Condition>
  void wait(Condition condition) {
    std::unique_lock guard(lock);
    ck_assert(news.wait_for(guard, 20s, condition));
  }
};

START_TEST(the_runner_reads_until_it_is_stopped) {
  Bus bus;
  Reports reports;
  GyroRunner runner;
  runner.start(bus.gyro("mpu6050"), reports.calls());
  reports.wait([&] { return reports.rates.size() >= 3; });
  ck_assert_double_eq_tol(reports.rates.back(), 1.064724, 1e-12);
  runner.stop();
  const std::size_t count = reports.rates.size();
  runner.stop();
  ck_assert_uint_eq(reports.rates.size(), count);
  ck_assert(reports.changes.empty());
}
END_TEST

START_TEST(a_gyro_that_is_not_there_is_reported_once_and_for_all) {
  Bus bus;
  Reports reports;
  GyroRunner runner;
  runner.start(bus.gyro("bno055"), reports.calls());
  reports.wait([&] { return !reports.changes.empty(); });
  ck_assert(says(reports.changes[0].first, "\"bno055\"") && reports.changes[0].second);
}
END_TEST

START_TEST(a_gyro_that_fails_is_opened_again_when_it_works) {
  Bus bus;
  Reports reports;
  GyroRunner runner;
  runner.start(bus.gyro("mpu6050"), reports.calls());
  reports.wait([&] { return !reports.rates.empty(); });
  bus.write("iio:device1", "in_anglvel_z_raw", "");
  reports.wait([&] { return !reports.changes.empty(); });
  ck_assert(says(reports.changes[0].first, "cannot be read") && !reports.changes[0].second);
  bus.write("iio:device1", "in_anglvel_z_raw", "1000");
  reports.wait([&] { return reports.changes.size() == 2; });
  ck_assert(reports.changes[1].first.empty() && !reports.changes[1].second);
  const std::size_t before = reports.rates.size();
  reports.wait([&] { return reports.rates.size() > before; });
  ck_assert_double_eq_tol(reports.rates.back(), -1.064724, 1e-12);
}
END_TEST

}  // namespace

int main() {
  return cerberus::tests::run_suite("iio_gyro", {a_turn_to_the_right_is_negative_for_an_axis_that_points_up,
                                                 an_axis_may_have_scale_and_offset_of_its_own,
                                                 what_is_wrong_is_named, the_runner_reads_until_it_is_stopped,
                                                 a_gyro_that_is_not_there_is_reported_once_and_for_all,
                                                 a_gyro_that_fails_is_opened_again_when_it_works});
}
