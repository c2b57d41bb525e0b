// SPDX-License-Identifier: LGPL-2.1-or-later
// pirsrc on an A/D converter that the kernel simulates.
#include "pir_source.h"

#include <fcntl.h>
#include <sys/mount.h>

#include <cmath>
#include <string>

namespace {

using namespace simulated;

const std::string kInput = "/sys/bus/iio/devices/iio:device0/in_voltage0_";
const std::string kRaw = kInput + "raw";

// The dummy's voltage never changes: a file of our own takes the place of the attribute.
class Voltage {
 public:
  Voltage() {
    umount(kRaw.c_str());  // left by a test that died
    simulated::write_text(kFile, "00073\n");
    simulated::must(mount(kFile, kRaw.c_str(), nullptr, MS_BIND, nullptr) == 0, "mount");
  }
  ~Voltage() { umount(kRaw.c_str()); }
  void set(int raw) {  // never empty in between
    gchar* text = g_strdup_printf("%05d\n", raw);
    const int fd = open(kFile, O_WRONLY | O_CLOEXEC);
    simulated::must(pwrite(fd, text, 6, 0) == 6, kFile);
    close(fd);
    g_free(text);
  }

 private:
  static constexpr char kFile[] = "/run/raw";
};

std::string iio(const std::string& more) {
  return "driver=iio heartbeat=5000000000 bearings=0 channels=0 " + more;
}

GST_START_TEST(a_converters_voltage_is_compared_in_volts) {
  Converter converter;
  // 80 x 0.001333 mV = 0.00010664 V
  for (const char* device : {"iio:device0", "pirs"}) {
    Source below(iio("hysteresis=0 threshold=0.000107 iio-device=" + std::string(device)));
    below.play();
    below.expect({0});
    Source above(iio("hysteresis=0 threshold=0.000106 iio-device=" + std::string(device)));
    above.play();
    above.expect({1});
  }
}
GST_END_TEST

GST_START_TEST(who_asks_for_volts_gets_what_was_measured) {
  Converter converter;
  Voltage voltage;
  voltage.set(1500);
  Source source(iio(""), "application/x-pir,format=level");
  source.play();
  const auto volts = [&](GstClockTime* when) {
    GstBuffer* buffer = source.take();
    gfloat value = 0;
    fail_unless_equals_int(gst_buffer_extract(buffer, 0, &value, 8), 4);
    *when = GST_BUFFER_PTS(buffer);
    gst_buffer_unref(buffer);
    return value;
  };
  // The dummy's offset is 7, its scale 0.001333 mV: (1500 + 7) x 0.001333 mV
  GstClockTime first = 0, next = 0;
  fail_unless(std::abs(volts(&first) - 0.002008831) < 1e-9);
  fail_unless(std::abs(volts(&next) - 0.002008831) < 1e-9);  // though nothing changed
  fail_unless(next > first);
  voltage.set(-500);
  float last = 0;
  for (int i = 0; i < 100 && last >= 0; ++i) last = volts(&next);
  fail_unless(std::abs(last + 0.000657169) < 1e-9);
}
GST_END_TEST

GST_START_TEST(a_voltage_that_rises_and_falls_is_a_detection_with_hysteresis) {
  Converter converter;
  Voltage voltage;
  // on at 0.003 V: raw 2244; off below 0.001 V: raw 743
  Source source(iio("min-pulse=0 debounce=0 threshold=0.002 hysteresis=0.002"));
  source.play();
  source.expect({0});
  const GstClockTime least = least_of(60 * GST_MSECOND, [&] {
    voltage.set(2200);  // 0.00294 V: not yet
    g_usleep(50000);
    const GstClockTime before = source.now();
    voltage.set(2300);
    const GstClockTime rose = source.expect({1});
    fail_unless(rose + 10 * GST_MSECOND >= before);  // a sample's time is that of its request
    const GstClockTime took = source.now() - before;
    voltage.set(800);  // 0.00108 V: not yet
    g_usleep(50000);
    const GstClockTime falling = source.now();
    voltage.set(700);
    fail_unless(source.expect({0}) + 10 * GST_MSECOND >= falling);
    return took;
  });
  fail_unless(least < 60 * GST_MSECOND);
}
GST_END_TEST

GST_START_TEST(a_channel_or_a_converter_that_is_missing_is_named) {
  Converter converter;
  const std::string channel = Source(iio("channels=9")).refusal(GST_RESOURCE_ERROR_NOT_FOUND);
  fail_unless(says(channel, "voltage9") && says(channel, "iio:device0") && says(channel, "It has: voltage0"));
  const std::string device = Source(iio("iio-device=adc")).refusal(GST_RESOURCE_ERROR_NOT_FOUND);
  fail_unless(says(device, "\"adc\"") && says(device, "iio:device0 (pirs)"));
  converter.unplug();
  fail_unless(says(Source(iio("")).refusal(GST_RESOURCE_ERROR_NOT_FOUND), "no IIO device"));
}
GST_END_TEST

// Only the owner may read the file; the test is that owner, until it changes its user.
class Forbidden {
 public:
  explicit Forbidden(const std::string& file) : file_(file) {
    must(chmod(file_.c_str(), 0400) == 0, "chmod " + file_);
    must(seteuid(65534) == 0, "seteuid");
  }
  ~Forbidden() {
    must(seteuid(0) == 0, "seteuid");
    chmod(file_.c_str(), 0444);
  }
  Forbidden(const Forbidden&) = delete;

 private:
  std::string file_;
};

GST_START_TEST(a_channel_that_may_not_be_read_is_named) {
  Converter converter;
  for (const char* which : {"raw", "scale", "offset"}) {
    Source source(iio(""));
    const Forbidden forbidden(kInput + which);
    const std::string why = source.refusal(GST_RESOURCE_ERROR_NOT_AUTHORIZED);
    fail_unless(says(why, "No permission to read voltage0 of iio:device0: let a udev rule"), "%s", which);
  }
  Source source(iio(""));
  source.play();
  source.expect({0});
  const Forbidden forbidden(kRaw);  // while it runs
  const std::string why =
      source.words(GST_MESSAGE_ERROR, GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_NOT_AUTHORIZED);
  fail_unless(says(why, "No permission to read voltage0 of iio:device0"));
}
GST_END_TEST

GST_START_TEST(a_converter_that_is_unplugged_while_running_is_an_error_that_names_it) {
  Converter converter;
  Source source(iio(""));
  source.play();
  source.expect({0});
  converter.unplug();
  source.expect({2});
  const std::string why = source.words(GST_MESSAGE_ERROR, GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_READ);
  fail_unless(says(why, "voltage0 of iio:device0"));
}
GST_END_TEST

Suite* iio_suite() {
  Suite* suite = suite_create("iio");
  TCase* tests = tcase_create("iio");
  tcase_set_timeout(tests, 60);
  tcase_add_test(tests, a_converters_voltage_is_compared_in_volts);
  tcase_add_test(tests, who_asks_for_volts_gets_what_was_measured);
  tcase_add_test(tests, a_voltage_that_rises_and_falls_is_a_detection_with_hysteresis);
  tcase_add_test(tests, a_channel_or_a_converter_that_is_missing_is_named);
  tcase_add_test(tests, a_channel_that_may_not_be_read_is_named);
  tcase_add_test(tests, a_converter_that_is_unplugged_while_running_is_an_error_that_names_it);
  suite_add_tcase(suite, tests);
  return suite;
}

}  // namespace

GST_CHECK_MAIN(iio)
