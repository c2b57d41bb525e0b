// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cerberus/version.h>

void cerberus_version(guint* major, guint* minor, guint* micro) {
  if (major) *major = CERBERUS_VERSION_MAJOR;
  if (minor) *minor = CERBERUS_VERSION_MINOR;
  if (micro) *micro = CERBERUS_VERSION_MICRO;
}
