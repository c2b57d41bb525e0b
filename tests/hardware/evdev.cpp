// SPDX-License-Identifier: LGPL-2.1-or-later
// pirsrc on an input device that the kernel simulates (uinput): real events, levels and time stamps.
#include "pir_source.h"

#include <fcntl.h>
#include <linux/uinput.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <string>

namespace {

using namespace simulated;

// Two keys and a switch.
class Receiver {
 public:
  explicit Receiver(const std::string& name = "PIR receiver") { plug(name); }
  ~Receiver() { unplug(); }
  Receiver(const Receiver&) = delete;

  void plug(const std::string& name = "PIR receiver") {
    fd_ = open("/dev/uinput", O_WRONLY | O_CLOEXEC);
    simulated::must(fd_ >= 0, "/dev/uinput");
    ask(UI_SET_EVBIT, EV_KEY);
    ask(UI_SET_EVBIT, EV_SW);
    ask(UI_SET_KEYBIT, BTN_0);
    ask(UI_SET_KEYBIT, BTN_1);
    ask(UI_SET_SWBIT, SW_MACHINE_COVER);
    uinput_setup setup{};
    setup.id.bustype = BUS_USB;
    name.copy(setup.name, sizeof setup.name - 1);
    simulated::must(ioctl(fd_, UI_DEV_SETUP, &setup) == 0 && ioctl(fd_, UI_DEV_CREATE) == 0, "UI_DEV_CREATE");
  }
  void unplug() {
    if (fd_ < 0) return;
    ioctl(fd_, UI_DEV_DESTROY);
    close(fd_);
    fd_ = -1;
  }
  void set(int type, int code, bool on) const {
    input_event events[2]{};
    events[0].type = static_cast<__u16>(type);
    events[0].code = static_cast<__u16>(code);
    events[0].value = on;
    events[1].type = EV_SYN;
    simulated::must(write(fd_, events, sizeof events) == static_cast<ssize_t>(sizeof events), "uinput");
  }

 private:
  void ask(unsigned long request, int value) const {
    simulated::must(ioctl(fd_, request, value) == 0, "uinput's ioctl");
  }
  int fd_ = -1;
};

std::string evdev(const std::string& device = "\"PIR receiver\"") {
  return "driver=evdev heartbeat=5000000000 min-pulse=0 debounce=0 codes=BTN_0,BTN_1,SW_MACHINE_COVER "
         "device=" +
         device;
}

GST_START_TEST(levels_at_opening_and_events_with_the_kernels_time) {
  const Receiver receiver;
  receiver.set(EV_SW, SW_MACHINE_COVER, true);
  Source source(evdev());
  source.play();
  source.expect({0, 0, 1});
  const GstClockTime before = source.now();
  receiver.set(EV_KEY, BTN_1, true);
  const GstClockTime after = source.now();
  const GstClockTime when = source.expect({0, 1, 1});
  // A millisecond: the two clocks cannot be read at the same moment.
  fail_unless(when + GST_MSECOND >= before && when <= after + GST_MSECOND);
  receiver.set(EV_SW, SW_MACHINE_COVER, false);
  source.expect({0, 1, 0});
  receiver.set(EV_KEY, BTN_1, false);
  source.expect({0, 0, 0});
}
GST_END_TEST

GST_START_TEST(a_receiver_that_is_unplugged_is_a_warning_and_is_used_again) {
  Receiver receiver;
  Source source(evdev());
  source.play();
  source.expect({0, 0, 0});
  receiver.unplug();
  source.expect({2, 2, 2});
  fail_unless(says(source.words(GST_MESSAGE_WARNING, GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_READ),
                   "Input device PIR receiver (PIR receiver) is gone"));
  receiver.plug();
  receiver.set(EV_KEY, BTN_0, true);
  source.expect({1, 0, 0});
  fail_unless(source.pop(GST_MESSAGE_ERROR) == nullptr);
}
GST_END_TEST

GST_START_TEST(what_the_receiver_lacks_is_named) {
  const Receiver receiver;
  Source source("driver=evdev device=\"PIR receiver\" codes=BTN_0,BTN_1,BTN_7");
  fail_unless(says(source.refusal(GST_RESOURCE_ERROR_NOT_FOUND),
                   "has no BTN_7. It has: BTN_0, BTN_1, SW_MACHINE_COVER"));
  Source other(evdev("attic"));
  fail_unless(says(other.refusal(GST_RESOURCE_ERROR_NOT_FOUND), "(PIR receiver)"));
}
GST_END_TEST

Suite* evdev_suite() {
  Suite* suite = suite_create("evdev");
  TCase* tests = tcase_create("evdev");
  tcase_set_timeout(tests, 60);
  tcase_add_test(tests, levels_at_opening_and_events_with_the_kernels_time);
  tcase_add_test(tests, a_receiver_that_is_unplugged_is_a_warning_and_is_used_again);
  tcase_add_test(tests, what_the_receiver_lacks_is_named);
  suite_add_tcase(suite, tests);
  return suite;
}

}  // namespace

GST_CHECK_MAIN(evdev)
