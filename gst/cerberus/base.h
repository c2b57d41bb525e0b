/* SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <cerberus/api.h>
#include <gst/gst.h>

G_BEGIN_DECLS

/**
 * CERBERUS_EVENT_BASE:
 *
 * Name of the custom upstream event by which an application (or a simulator) reports how fast the body that carries
 * head and sensors turns and drives. It holds from its running time until the next one's, for %CERBERUS_BASE_LIFETIME at
 * most, and has priority over the estimate of `cameramotion`. Send it some times a second, also while nothing changes.
 * Fields: `yaw-rate` (double, degrees a second, positive to the right), `speed` (double, metres a second, positive
 * ahead), `running-time` (uint64, nanoseconds). One of the first two may be missing: it is not known.
 */
#define CERBERUS_EVENT_BASE "cerberus-base"

/**
 * CERBERUS_BASE_LIFETIME:
 *
 * How long a %CERBERUS_EVENT_BASE holds when no other follows: a second, in nanoseconds.
 */
#define CERBERUS_BASE_LIFETIME 1000000000

/**
 * CerberusBaseSource:
 * @CERBERUS_BASE_ESTIMATED: from the picture: its turn without the head's
 * @CERBERUS_BASE_REPORTED: by a %CERBERUS_EVENT_BASE
 *
 * Where the motion of the base comes from.
 */
typedef enum { CERBERUS_BASE_ESTIMATED, CERBERUS_BASE_REPORTED } CerberusBaseSource;

/**
 * CerberusBase:
 * @yaw_rate: how fast the body turned when the frame was taken, degrees a second, positive to the right; in events NaN
 *   where it is not known
 * @source: where @yaw_rate comes from
 * @valid_from: in events the running time from which it holds; on buffers %GST_CLOCK_TIME_NONE
 * @speed: how fast the body drives, metres a second, positive ahead, NaN where it is not known, as on most buffers
 *
 * How the body that carries head and sensors moves. An unknown motion is not attached.
 */
typedef struct _CerberusBase {
  gdouble yaw_rate;
  CerberusBaseSource source;
  GstClockTime valid_from;
  gdouble speed;

  /*< private >*/
  gpointer _cerberus_reserved[GST_PADDING - 1];
} CerberusBase;

#define CERBERUS_TYPE_BASE (cerberus_base_get_type())
#define CERBERUS_TYPE_BASE_SOURCE (cerberus_base_source_get_type())
#define CERBERUS_BASE_META_API_TYPE (cerberus_base_meta_api_get_type())

/**
 * cerberus_base_free: (skip)
 */
CERBERUS_DECLARE_BOXED(CerberusBase, cerberus_base)
CERBERUS_DECLARE_ENUM(CerberusBaseSource, cerberus_base_source)

/**
 * cerberus_buffer_set_base:
 * @buffer: a writable buffer
 * @base: (nullable): how the body moved when the frame was taken, copied; %NULL removes
 *
 * Attaches a fact about the moment: it survives scaling and cropping.
 *
 * Returns: %FALSE if @buffer is not writable.
 */
CERBERUS_DECLARE_META(CerberusBase, base)

CERBERUS_DECLARE_EVENT(CerberusBase, base)

G_END_DECLS
