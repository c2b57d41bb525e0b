// SPDX-License-Identifier: LGPL-2.1-or-later
// Every question about GStreamer's version is asked here and nowhere else (1.22 of Debian 12 to 1.26 of
// Debian 13).
#pragma once

#include <gst/gst.h>

// HAVE_ANALYTICS comes from the build when plugins-bad's analytics library is there.
#if defined(HAVE_ANALYTICS) && GST_CHECK_VERSION(1, 24, 0)
#define CERBERUS_ANALYTICS 1
#else
#define CERBERUS_ANALYTICS 0
#endif
