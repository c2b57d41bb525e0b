/* SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <cerberus/api.h>
#include <gst/gst.h>

G_BEGIN_DECLS

/**
 * CerberusUtcSource:
 * @CERBERUS_UTC_UNKNOWN: the wall-clock time is not known
 * @CERBERUS_UTC_REFERENCE_TIMESTAMP: a #GstReferenceTimestampMeta on the buffer (`timestamp/x-unix` or `timestamp/x-ntp`)
 * @CERBERUS_UTC_CLOCK: the system's clock when the buffer arrived; live only
 *
 * Where a wall-clock time comes from.
 */
typedef enum { CERBERUS_UTC_UNKNOWN, CERBERUS_UTC_REFERENCE_TIMESTAMP, CERBERUS_UTC_CLOCK } CerberusUtcSource;

/**
 * CerberusStamp:
 * @running_time: of the frame or reading, %GST_CLOCK_TIME_NONE if it is not known
 * @utc: nanoseconds since 1970-01-01 00:00 UTC, %GST_CLOCK_TIME_NONE if it is not known
 * @utc_source: where @utc comes from
 * @camera_name: the camera's name; interned, not to be freed; %NULL if it has none
 *
 * The time and the camera of an observation. Each message carries one in the fields `running-time` (uint64), and
 * where they are known `utc` (uint64), `utc-source` (string: `reference-timestamp` or `clock`) and `camera-name`
 * (string). The first element that has more than the running time attaches one to the buffer for the others.
 */
typedef struct _CerberusStamp {
  GstClockTime running_time;
  GstClockTime utc;
  CerberusUtcSource utc_source;
  const gchar* camera_name;

  /*< private >*/
  gpointer _cerberus_reserved[GST_PADDING];
} CerberusStamp;

#define CERBERUS_TYPE_STAMP (cerberus_stamp_get_type())
#define CERBERUS_TYPE_UTC_SOURCE (cerberus_utc_source_get_type())
#define CERBERUS_STAMP_META_API_TYPE (cerberus_stamp_meta_api_get_type())

/**
 * cerberus_stamp_free: (skip)
 */
CERBERUS_DECLARE_BOXED(CerberusStamp, cerberus_stamp)
CERBERUS_DECLARE_ENUM(CerberusUtcSource, cerberus_utc_source)

/**
 * cerberus_stamp_set_camera_name:
 * @stamp: a stamp
 * @name: (nullable): the camera's name; %NULL or empty: none
 *
 * Names the camera (bindings cannot intern strings).
 */
CERBERUS_API
void cerberus_stamp_set_camera_name(CerberusStamp* stamp, const gchar* name);

/**
 * cerberus_message_parse_stamp:
 * @message: a message
 *
 * Returns: (transfer full) (nullable): the stamp of any message of the library; %NULL if @message is another one.
 */
CERBERUS_API
CerberusStamp* cerberus_message_parse_stamp(GstMessage* message);

/**
 * cerberus_buffer_set_stamp:
 * @buffer: a writable buffer
 * @stamp: (nullable): copied; %NULL removes
 *
 * Returns: %FALSE if @buffer is not writable.
 */
CERBERUS_DECLARE_META(CerberusStamp, stamp)

G_END_DECLS
