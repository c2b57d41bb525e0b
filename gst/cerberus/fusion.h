/* SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <cerberus/api.h>
#include <cerberus/pir.h>
#include <gst/gst.h>

G_BEGIN_DECLS

/**
 * CERBERUS_MESSAGE_FUSION:
 *
 * Name of the structure of the element message that tells of every change of the fusion's decision. Fields:
 * `running-time` (uint64, nanoseconds: of the frame, or, of what was decided between two frames, when that was), `rule`
 * (int), `rule-name` (string), `action` (#CerberusFusionAction), `target` (uint), `pan`, `sector-from`, `sector-to`
 * (double, degrees), `limited`, `camera-found` (boolean), `sensors` (array of int: 0, 1, 2 = invalid), `bearings`
 * (array of double, degrees, one a sensor), `doubtful` (uint, one bit a sensor).
 *
 * Since: 0.1
 */
#define CERBERUS_MESSAGE_FUSION "cerberus-fusion"

/**
 * CERBERUS_EVENT_FUSION:
 *
 * Name of the structure of the custom downstream out-of-band event by which a live fusion tells a head what it decided
 * between two frames, because a sensor changed its mind: nobody waits for the next frame, and no queue holds it up. It
 * counts as if the last frame had carried it, until a frame that was decided later (#CerberusFusion.decided). Fields:
 * `head` (string: whom it is for; empty: any), and those of %CERBERUS_MESSAGE_FUSION.
 *
 * Since: 0.1
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
 *
 * Since: 0.1
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
 * @rule_name: its name; interned, owned by nobody
 * @action: what to do
 * @target: identity of the track to follow, 0 for none
 * @pan: the pan angle that the decision used, degrees; NaN if it is not known
 * @sector_from: left edge of where to turn to or to search, degrees; NaN for none
 * @sector_to: right edge of it, degrees; NaN for none
 * @limited: what is wanted lies beyond the head's limits
 * @camera_found: the camera sees a confirmed object
 * @n_sensors: number of PIR sensors
 * @sensors: their readings: 0 nothing, 1 somebody, 2 invalid
 * @bearings: where each of them looks, degrees, positive to the
 *     right of straight ahead; 0 for one that has not told yet
 * @doubtful: one bit a sensor: its reading was not counted because the robot itself turned
 * @decided: running time until which the sensors were heard for it: of two decisions the later one counts;
 *     %GST_CLOCK_TIME_NONE if it is not known
 *
 * What camera and PIR sensors together decided for a frame.
 *
 * Since: 0.1
 */
typedef struct _CerberusFusion CerberusFusion;
struct _CerberusFusion {
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

  /*< private >*/
  gpointer _cerberus_reserved[GST_PADDING];
};

#define CERBERUS_TYPE_FUSION (cerberus_fusion_get_type())
#define CERBERUS_TYPE_FUSION_ACTION (cerberus_fusion_action_get_type())
#define CERBERUS_FUSION_META_API_TYPE (cerberus_fusion_meta_api_get_type())

CERBERUS_API
GType cerberus_fusion_get_type(void) G_GNUC_CONST;

CERBERUS_API
GType cerberus_fusion_action_get_type(void) G_GNUC_CONST;

CERBERUS_API
GType cerberus_fusion_meta_api_get_type(void);

/**
 * cerberus_fusion_action_get_nick: (skip)
 * @action: an action
 *
 * Returns: (transfer none): `track`, `turn-left`, `turn-right`, `search`, `zero` or `hold`, as in JSON.
 *
 * Since: 0.1
 */
CERBERUS_API
const gchar* cerberus_fusion_action_get_nick(CerberusFusionAction action);

/**
 * cerberus_fusion_init: (skip)
 * @fusion: (out caller-allocates): memory to fill
 *
 * Fills @fusion with the defaults of cerberus_fusion_new(), for structures on the stack.
 *
 * Since: 0.1
 */
CERBERUS_API
void cerberus_fusion_init(CerberusFusion* fusion);

/**
 * cerberus_fusion_new: (constructor)
 *
 * Makes a decision to hold, without rule, target, sensors and known pan angle.
 *
 * Returns: (transfer full): a new decision; free with cerberus_fusion_free().
 *
 * Since: 0.1
 */
CERBERUS_API
CerberusFusion* cerberus_fusion_new(void);

/**
 * cerberus_fusion_copy:
 * @fusion: a decision
 *
 * Returns: (transfer full) (nullable): a copy; %NULL only for a %NULL @fusion.
 *
 * Since: 0.1
 */
CERBERUS_API
CerberusFusion* cerberus_fusion_copy(const CerberusFusion* fusion);

/**
 * cerberus_fusion_free: (skip)
 * @fusion: (transfer full) (nullable): a decision
 *
 * Frees @fusion.
 *
 * Since: 0.1
 */
CERBERUS_API
void cerberus_fusion_free(CerberusFusion* fusion);

/**
 * cerberus_fusion_get_sensors:
 * @fusion: a decision
 *
 * Returns: (transfer full): the PIR readings, a byte a sensor: 0 nothing, 1 somebody, 2 invalid.
 *
 * Since: 0.1
 */
CERBERUS_API
GBytes* cerberus_fusion_get_sensors(const CerberusFusion* fusion);

/**
 * cerberus_buffer_set_fusion:
 * @buffer: a writable buffer
 * @fusion: (nullable): what was decided for the frame, copied; %NULL removes
 *
 * Attaches @fusion, replacing one that is there already. A fact about the moment: it survives scaling and cropping.
 *
 * Whoever reads it finds sane values, here and in messages and events: an action that is none counts as
 * %CERBERUS_FUSION_HOLD, a rule without a name is called "none", sensors beyond %CERBERUS_PIR_MAX_SENSORS are left out,
 * a reading above 2 is invalid (2), and a bearing that is no finite number is 0.
 *
 * Returns: %TRUE if @buffer now carries @fusion (or none, for %NULL); %FALSE if @buffer is not writable.
 *
 * Since: 0.1
 */
CERBERUS_API
gboolean cerberus_buffer_set_fusion(GstBuffer* buffer, const CerberusFusion* fusion);

/**
 * cerberus_buffer_get_fusion:
 * @buffer: a buffer
 *
 * Returns: (transfer full) (nullable): a copy of the decision for the frame, or %NULL if nobody made one.
 *
 * Since: 0.1
 */
CERBERUS_API
CerberusFusion* cerberus_buffer_get_fusion(GstBuffer* buffer);

/**
 * cerberus_buffer_peek_fusion: (skip)
 * @buffer: a buffer
 *
 * Returns: (transfer none) (nullable): the decision on @buffer, without a copy.
 *
 * Since: 0.1
 */
CERBERUS_API
const CerberusFusion* cerberus_buffer_peek_fusion(GstBuffer* buffer);

/**
 * cerberus_message_new_fusion:
 * @src: (transfer none) (nullable): the object that posts it
 * @running_time: running time of the frame, or when it was decided between two
 * @fusion: what was decided
 *
 * Makes the element message %CERBERUS_MESSAGE_FUSION.
 *
 * Returns: (transfer full): a new message.
 *
 * Since: 0.1
 */
CERBERUS_API
GstMessage* cerberus_message_new_fusion(GstObject* src, GstClockTime running_time,
                                        const CerberusFusion* fusion);

/**
 * cerberus_message_parse_fusion:
 * @message: a message
 * @running_time: (out) (optional): running time of the frame
 *
 * Reads a %CERBERUS_MESSAGE_FUSION.
 *
 * Returns: (transfer full) (nullable): what was decided; %NULL if @message is no well-formed one.
 *
 * Since: 0.1
 */
CERBERUS_API
CerberusFusion* cerberus_message_parse_fusion(GstMessage* message, GstClockTime* running_time);

/**
 * cerberus_event_new_fusion:
 * @head: (nullable): name of the head that it is for; %NULL or empty: any
 * @fusion: what was decided between two frames, with the time of that
 *
 * Makes the custom downstream out-of-band event %CERBERUS_EVENT_FUSION.
 *
 * Returns: (transfer full): a new event.
 *
 * Since: 0.1
 */
CERBERUS_API
GstEvent* cerberus_event_new_fusion(const gchar* head, const CerberusFusion* fusion);

/**
 * cerberus_event_parse_fusion:
 * @event: an event
 * @head: (out) (optional) (transfer none): name of the head that it is for; empty: any. It lives as long as @event
 *
 * Reads a %CERBERUS_EVENT_FUSION.
 *
 * Returns: (transfer full) (nullable): what was decided; %NULL
 *     (and nothing is written) if @event is no well-formed one.
 *
 * Since: 0.1
 */
CERBERUS_API
CerberusFusion* cerberus_event_parse_fusion(GstEvent* event, const gchar** head);

G_DEFINE_AUTOPTR_CLEANUP_FUNC(CerberusFusion, cerberus_fusion_free)

G_END_DECLS
