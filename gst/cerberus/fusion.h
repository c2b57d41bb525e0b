/* SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <cerberus/api.h>
#include <cerberus/pir.h>
#include <cerberus/stamp.h>
#include <gst/gst.h>

G_BEGIN_DECLS

/**
 * CERBERUS_MESSAGE_FUSION:
 *
 * Name of the element message that reports every change of the fusion's decision. Fields: those of #CerberusStamp (the
 * running time is the frame's, or that of a decision made between two frames), `rule` (int), `rule-name` (string),
 * `action` (#CerberusFusionAction), `target` (uint), `pan`, `sector-from`, `sector-to` (double, degrees), `limited`,
 * `camera-found` (boolean), `sensors` (array of int: 0, 1, 2 = invalid), `bearings` (array of double, degrees, one a
 * sensor), `doubtful` (uint, one bit a sensor), `decided` (uint64), `head` (string), `immediate` (boolean; missing: no).
 */
#define CERBERUS_MESSAGE_FUSION "cerberus-fusion"

/**
 * CERBERUS_EVENT_FUSION:
 *
 * Name of the custom downstream out-of-band event by which a live fusion sends a head a decision that it made between
 * two frames because a sensor changed: it neither waits for the next frame nor in a queue. It counts as if the last
 * frame had carried it, until a frame with a later #CerberusFusion.decided. Fields: those of %CERBERUS_MESSAGE_FUSION
 * without the stamp.
 */
#define CERBERUS_EVENT_FUSION "cerberus-fusion"

/**
 * CerberusFusionAction:
 * @CERBERUS_FUSION_TRACK: bring the target into the middle of the picture ("Camera Tracking")
 * @CERBERUS_FUSION_TURN_LEFT: turn to the left at the defined speed
 * @CERBERUS_FUSION_TURN_RIGHT: turn to the right at the defined speed
 * @CERBERUS_FUSION_SEARCH: sweep between the sector's edges until something is found
 * @CERBERUS_FUSION_ZERO: return to straight ahead
 * @CERBERUS_FUSION_HOLD: stay
 *
 * What the head is to do.
 */
typedef enum {
  CERBERUS_FUSION_TRACK,
  CERBERUS_FUSION_TURN_LEFT,
  CERBERUS_FUSION_TURN_RIGHT,
  CERBERUS_FUSION_SEARCH,
  CERBERUS_FUSION_ZERO,
  CERBERUS_FUSION_HOLD,
} CerberusFusionAction;

/**
 * CerberusFusion:
 * @rule: number of the rule that fired, 0 for none that has a number
 * @rule_name: its name; interned, not to be freed
 * @action: what to do
 * @target: identity of the track to follow, 0 for none
 * @pan: the pan angle that the decision used, degrees; NaN if it is not known
 * @sector_from: left edge of where to turn to or to search, degrees; NaN for none
 * @sector_to: right edge of it, degrees; NaN for none
 * @limited: the wanted direction lies beyond the head's limits
 * @camera_found: the camera sees a confirmed object
 * @n_sensors: number of PIR sensors
 * @sensors: their readings: 0 nothing, 1 motion, 2 invalid
 * @bearings: direction of each sensor, degrees, positive to the right of straight ahead; 0 until it is known
 * @doubtful: one bit a sensor: its reading was not counted, as the robot's own motion may have caused it
 * @decided: running time up to which the sensors' readings were used: of two decisions the later one counts;
 *     %GST_CLOCK_TIME_NONE if it is not known
 * @head: name of the head that a %CERBERUS_EVENT_FUSION is for; interned, not to be freed; %NULL: any
 * @immediate: %CERBERUS_FUSION_HOLD or %CERBERUS_FUSION_ZERO ends at once what the head does by itself, as the way round to
 *     a person behind it; so do rules of a table that say hold or zero
 *
 * What camera and PIR sensors together decided for a frame.
 */
typedef struct _CerberusFusion {
  gint rule;
  const gchar* rule_name;
  CerberusFusionAction action;
  guint target;
  gdouble pan;
  gdouble sector_from, sector_to;
  gboolean limited, camera_found;
  guint n_sensors;
  guint8 sensors[CERBERUS_PIR_MAX_SENSORS];
  gdouble bearings[CERBERUS_PIR_MAX_SENSORS];
  guint doubtful;
  GstClockTime decided;
  const gchar* head;
  gboolean immediate;

  /*< private >*/
  gpointer _cerberus_reserved[GST_PADDING - 1];
} CerberusFusion;

#define CERBERUS_TYPE_FUSION (cerberus_fusion_get_type())
#define CERBERUS_TYPE_FUSION_ACTION (cerberus_fusion_action_get_type())
#define CERBERUS_FUSION_META_API_TYPE (cerberus_fusion_meta_api_get_type())

/**
 * cerberus_fusion_free: (skip)
 */
CERBERUS_DECLARE_BOXED(CerberusFusion, cerberus_fusion)
CERBERUS_DECLARE_ENUM(CerberusFusionAction, cerberus_fusion_action)

/**
 * cerberus_fusion_set_head:
 * @fusion: a decision
 * @head: (nullable): name of the head that it is for; %NULL or empty: any
 *
 * Names the head (bindings cannot intern strings).
 */
CERBERUS_API
void cerberus_fusion_set_head(CerberusFusion* fusion, const gchar* head);

/**
 * cerberus_fusion_get_sensors:
 * @fusion: a decision
 *
 * Returns: (transfer full): the PIR readings, a byte a sensor: 0 nothing, 1 motion, 2 invalid.
 */
CERBERUS_API
GBytes* cerberus_fusion_get_sensors(const CerberusFusion* fusion);

/**
 * cerberus_buffer_set_fusion:
 * @buffer: a writable buffer
 * @fusion: (nullable): the decision for the frame, copied; %NULL removes
 *
 * Attaches a fact about the moment: it survives scaling and cropping. On buffers, and in messages and events, values
 * are sane: an unknown action counts as %CERBERUS_FUSION_HOLD, a rule without a name is called "none", sensors beyond
 * %CERBERUS_PIR_MAX_SENSORS are left out, a reading above 2 is invalid (2), and a bearing that is not finite is 0.
 *
 * Returns: %FALSE if @buffer is not writable.
 */
CERBERUS_DECLARE_META(CerberusFusion, fusion)

/**
 * cerberus_message_new_fusion:
 * @src: (nullable): the object that posts it
 * @stamp: (nullable): when, and by which camera
 * @fusion: a decision
 *
 * Returns: (transfer full): a new %CERBERUS_MESSAGE_FUSION.
 */
CERBERUS_DECLARE_MESSAGE(CerberusFusion, fusion)

CERBERUS_DECLARE_EVENT(CerberusFusion, fusion)

G_END_DECLS
