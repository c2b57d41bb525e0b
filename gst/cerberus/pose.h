/* SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <cerberus/api.h>
#include <gst/gst.h>

G_BEGIN_DECLS

/**
 * CERBERUS_EVENT_POSE:
 *
 * Name of the custom upstream event by which a head publishes its pose. Elements evaluate it and forward it; only a
 * source ends it. Another head's event is ignored.
 */
#define CERBERUS_EVENT_POSE "cerberus-pose"

/**
 * CerberusPoseSource:
 * @CERBERUS_POSE_COMMANDED: from the commands sent to the head
 * @CERBERUS_POSE_MEASURED: from the head's own feedback
 *
 * Where a pose comes from.
 */
typedef enum { CERBERUS_POSE_COMMANDED, CERBERUS_POSE_MEASURED } CerberusPoseSource;

/**
 * CerberusPose:
 * @head: the head's name; interned, not to be freed. %NULL counts as "head" wherever a pose is attached or sent
 * @pan: pan angle at @valid_from, degrees, positive to the right; does not wrap
 * @tilt: tilt angle at @valid_from, degrees, positive up
 * @pan_speed: degrees a second at @valid_from
 * @tilt_speed: degrees a second at @valid_from
 * @pan_acceleration: degrees a second squared, constant while valid
 * @tilt_acceleration: degrees a second squared, constant while valid
 * @valid_from: running time from which it holds
 * @valid_until: running time until which it is certain to hold, %GST_CLOCK_TIME_NONE: until the next one
 * @source: commanded or measured
 * @moving: the head moves
 * @settled: the head stands where it was sent
 * @field_of_view: degrees that the camera sees over the frame's width, by the head's zoom; 0: nothing is said; negative: unknown zoom
 *
 * Where a pan-tilt head looks: one piece of its plan, of constant acceleration.
 */
typedef struct _CerberusPose {
  const gchar* head;
  gdouble pan, tilt;
  gdouble pan_speed, tilt_speed;
  gdouble pan_acceleration, tilt_acceleration;
  GstClockTime valid_from, valid_until;
  CerberusPoseSource source;
  gboolean moving, settled;
  gdouble field_of_view;

  /*< private >*/
  gpointer _cerberus_reserved[GST_PADDING];
} CerberusPose;

#define CERBERUS_TYPE_POSE (cerberus_pose_get_type())
#define CERBERUS_TYPE_POSE_SOURCE (cerberus_pose_source_get_type())
#define CERBERUS_POSE_META_API_TYPE (cerberus_pose_meta_api_get_type())

/**
 * cerberus_pose_free: (skip)
 */
CERBERUS_DECLARE_BOXED(CerberusPose, cerberus_pose)
CERBERUS_DECLARE_ENUM(CerberusPoseSource, cerberus_pose_source)

/**
 * cerberus_pose_set_head:
 * @pose: a pose
 * @head: the head's name
 *
 * Names the head (bindings cannot intern strings).
 */
CERBERUS_API
void cerberus_pose_set_head(CerberusPose* pose, const gchar* head);

/**
 * cerberus_pose_evaluate:
 * @pose: a pose
 * @running_time: when
 * @pan: (out) (optional): pan angle then, degrees
 * @tilt: (out) (optional): tilt angle then, degrees
 *
 * Computes where the head looks at @running_time: angle + speed dt + acceleration dt^2 / 2, held at the ends of the
 * span in which the pose is valid.
 *
 * Returns: %TRUE if @running_time lies within that span.
 */
CERBERUS_API
gboolean cerberus_pose_evaluate(const CerberusPose* pose, GstClockTime running_time, gdouble* pan,
                                gdouble* tilt);

/**
 * cerberus_buffer_set_pose:
 * @buffer: a writable buffer
 * @pose: (nullable): where the head looked when the frame was taken, copied; %NULL removes
 *
 * Attaches a fact about the moment: it survives scaling and cropping.
 *
 * Returns: %FALSE if @buffer is not writable.
 */
CERBERUS_DECLARE_META(CerberusPose, pose)

CERBERUS_DECLARE_EVENT(CerberusPose, pose)

G_END_DECLS
