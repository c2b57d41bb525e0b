// SPDX-License-Identifier: LGPL-2.1-or-later
// Two modules that need the same private metas at the same moment, in two threads: each is registered once.
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <thread>

#include "scene.h"
#include "support.h"

#include <dlfcn.h>

namespace {

std::mutex lock;
std::condition_variable changed;
int registrations = 0;  // of the record's meta

// The first thread is kept here until the second one comes, too; where it cannot, for the only time that passes here.
void meet() {
  std::unique_lock guard(lock);
  ++registrations;
  changed.notify_all();
  changed.wait_for(guard, std::chrono::milliseconds(200), [] { return registrations > 1; });
}

}  // namespace

// In place of GStreamer's function, which it calls.
#if GST_CHECK_VERSION(1, 24, 0)
GstMetaInfo* gst_meta_info_new(GType api, const gchar* impl, gsize size) {
  static const auto original =
      reinterpret_cast<decltype(&gst_meta_info_new)>(dlsym(RTLD_NEXT, "gst_meta_info_new"));
  if (std::strcmp(impl, "CerberusRecordMeta") == 0) meet();
  return original(api, impl, size);
}
#else
const GstMetaInfo* gst_meta_register(GType api, const gchar* impl, gsize size, GstMetaInitFunction init,
                                     GstMetaFreeFunction free, GstMetaTransformFunction transform) {
  static const auto original =
      reinterpret_cast<decltype(&gst_meta_register)>(dlsym(RTLD_NEXT, "gst_meta_register"));
  if (std::strcmp(impl, "CerberusRecordMeta") == 0) meet();
  return original(api, impl, size, init, free, transform);
}
#endif

GST_START_TEST(a_meta_that_two_modules_need_at_once_is_registered_once) {
  scene::Line detects("motiondetect"), shows("motionview stage=luma");
  GstBuffer *first = scene::grey_buffer({}, 0), *second = scene::grey_buffer({}, 0);
  std::thread one([&] { gst_buffer_unref(detects.through(first)); });
  std::thread other([&] { gst_buffer_unref(shows.through(second)); });
  one.join();
  other.join();
  fail_unless_equals_int(registrations, 1);
}
GST_END_TEST

static Suite* registration_suite() {
  Suite* suite = suite_create("registration");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 60);
  tcase_add_checked_fixture(tests, watch_library_log, nullptr);
  tcase_add_test(tests, a_meta_that_two_modules_need_at_once_is_registered_once);
  return suite;
}

GST_CHECK_MAIN(registration);
