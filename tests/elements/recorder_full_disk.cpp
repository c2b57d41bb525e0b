// SPDX-License-Identifier: LGPL-2.1-or-later
// A disk without room keeps a recorder from recording, which is reported as in recorder_faults.cpp. A program of its own:
// it is skipped where this user may not mount a disk.
#include <sys/mount.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "recorder_rig.h"

using namespace recorder_rig;

namespace {

bool mount_small_disk(const std::string& folder) {
  return mount("none", folder.c_str(), "tmpfs", 0, "size=512k") == 0;
}

bool may_mount() {
  char folder[] = "/tmp/cerberus-disk-XXXXXX";
  const bool mounted = mkdtemp(folder) && mount_small_disk(folder);
  if (!mounted) g_print("skipped: this user may not mount a disk: %s\n", std::strerror(errno));
  if (mounted) umount(folder);
  rmdir(folder);
  return mounted;
}

}  // namespace

GST_START_TEST(a_disk_that_is_full_is_a_fault_before_an_event_needs_it_and_until_it_has_room) {
  Rig rig;
  fail_unless(mount_small_disk(rig.folder.path()));
  rig.start();
  fault_names(rig, rig.folder.path().c_str(), "No space left");
  {
    std::ofstream filler(rig.folder.path() + "/filler");
    while (filler.put('x').flush()) {
    }
  }
  rig.play_to(57);
  rig.start_event();
  g_autoptr(GstStructure) failed = rig.wait_for_file("failed");
  const bool mounted = mount("none", rig.folder.path().c_str(), "tmpfs", MS_REMOUNT, "size=20m") == 0;
  rig.play_to(57 + 130);
  const std::string end = next_fault(rig);
  rig.finish();
  rig.stop();
  umount(rig.folder.path().c_str());
  fail_unless(mounted && end == "sound", "%s", end.c_str());
}
GST_END_TEST

int main(int argc, char** argv) {
  if (!may_mount()) return 77;
  gst_check_init(&argc, &argv);
  watch_library_log();
  Suite* suite = suite_create("recorder_full_disk");
  TCase* tests = tcase_create("recorder_full_disk");
  tcase_set_timeout(tests, 240);
  tcase_add_test(tests, a_disk_that_is_full_is_a_fault_before_an_event_needs_it_and_until_it_has_room);
  suite_add_tcase(suite, tests);
  return gst_check_run_suite(suite, "recorder_full_disk", __FILE__);
}
