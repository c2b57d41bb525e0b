/* SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <cerberus/api.h>
#include <gst/gst.h>
#include <gst/video/video.h>

G_BEGIN_DECLS

/**
 * CERBERUS_VIDEO_FORMATS_8_BIT:
 *
 * The 8-bit formats among %CERBERUS_VIDEO_FORMATS, without the braces of a list.
 */
#define CERBERUS_VIDEO_FORMATS_8_BIT                                                    \
  "GRAY8, I420, YV12, NV12, NV21, Y41B, Y42B, Y444, YUY2, UYVY, RGB, BGR, RGBx, BGRx, " \
  "xRGB, xBGR, RGBA, BGRA, ARGB, ABGR"

/**
 * CERBERUS_VIDEO_FORMATS:
 *
 * Every video format that the elements read, as a list for a caps string: those with a luma plane (or interleaved
 * luma) of 8 bits, or of 10 to 16 bits in words of 16, read without any conversion, and the packed RGB family, from
 * which luma is computed.
 */
#define CERBERUS_VIDEO_FORMATS                                                                    \
  "{ " CERBERUS_VIDEO_FORMATS_8_BIT                                                               \
  ", P010_10LE, P010_10BE, P012_LE, P012_BE, P016_LE, P016_BE, I420_10LE, I420_10BE, I420_12LE, " \
  "I420_12BE, I422_10LE, I422_10BE, I422_12LE, I422_12BE, Y444_10LE, Y444_10BE, Y444_12LE, "      \
  "Y444_12BE, Y444_16LE, Y444_16BE, GRAY16_LE, GRAY16_BE }"

/**
 * CERBERUS_VIDEO_CAPS:
 *
 * Caps string of raw video in %CERBERUS_VIDEO_FORMATS, any size and frame
 * rate. Caps that name no frame rate at all are a subset of it too.
 */
#define CERBERUS_VIDEO_CAPS                                \
  "video/x-raw, format = (string) " CERBERUS_VIDEO_FORMATS \
  ", width = (int) [ 1, 2147483647 ], height = (int) [ 1, 2147483647 ]"

/**
 * CERBERUS_JSON_LINES_CAPS:
 *
 * Caps string of JSON lines: every buffer is one JSON object in UTF-8 that ends with a line feed.
 */
#define CERBERUS_JSON_LINES_CAPS "application/x-json-lines"

/**
 * cerberus_video_format_is_supported:
 * @format: a video format
 *
 * Returns: %TRUE if @format is one of %CERBERUS_VIDEO_FORMATS.
 */
CERBERUS_API
gboolean cerberus_video_format_is_supported(GstVideoFormat format);

G_END_DECLS
