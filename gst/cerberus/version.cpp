// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cerberus/cerberus.h>

void cerberus_version(guint* major, guint* minor, guint* micro) {
  if (major) *major = CERBERUS_VERSION_MAJOR;
  if (minor) *minor = CERBERUS_VERSION_MINOR;
  if (micro) *micro = CERBERUS_VERSION_MICRO;
}

void cerberus_init(void) {
  g_autoptr(GstBuffer) buffer = gst_buffer_new();  // every meta is registered by its first use
  cerberus_buffer_set_regions(buffer, nullptr);
  cerberus_buffer_regions_known(buffer);
  cerberus_buffer_peek_camera_motion(buffer);
  cerberus_buffer_peek_pose(buffer);
  cerberus_buffer_peek_base(buffer);
  cerberus_buffer_peek_fusion(buffer);
  cerberus_buffer_peek_stamp(buffer);
  cerberus_buffer_peek_truth(buffer);
}
