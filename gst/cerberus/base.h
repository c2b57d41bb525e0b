/* SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <cerberus/api.h>
#include <gst/gst.h>

G_BEGIN_DECLS

/**
 * CERBERUS_EVENT_BASE:
 *
 * Name of the structure of the custom upstream event by which an application (or a simulator) tells how fast the body
 * that carries head and sensors turns. It holds from its running time until the next one's, for %CERBERUS_BASE_LIFETIME
 * at the most, and goes before what `cameramotion` sees. Say it some times a second, also when nothing changes: who
 * falls silent is not believed for ever. Fields: `yaw-rate` (double, degrees a second, positive to the right),
 * `running-time` (uint64, nanoseconds).
 *
 * Since: 0.1
 */
#define CERBERUS_EVENT_BASE "cerberus-base"

/**
 * CERBERUS_BASE_LIFETIME:
 *
 * How long a %CERBERUS_EVENT_BASE holds when no other follows: a second, in nanoseconds.
 *
 * Since: 0.1
 */
#define CERBERUS_BASE_LIFETIME 1000000000

/**
 * CerberusBase:
 * @yaw_rate: how fast the body turned when the frame was taken, degrees a second, positive to the right
 * @told: an application or a simulator said so; else it was seen: the picture's turn without the head's
 *
 * How the body that carries head and sensors moves. What is not known is not attached.
 *
 * Since: 0.1
 */
typedef struct _CerberusBase CerberusBase;
struct _CerberusBase {
  gdouble yaw_rate;
  gboolean told;

  /*< private >*/
  gpointer _cerberus_reserved[GST_PADDING];
};

#define CERBERUS_TYPE_BASE (cerberus_base_get_type())
#define CERBERUS_BASE_META_API_TYPE (cerberus_base_meta_api_get_type())

CERBERUS_API
GType cerberus_base_get_type(void) G_GNUC_CONST;

CERBERUS_API
GType cerberus_base_meta_api_get_type(void);

/**
 * cerberus_base_init: (skip)
 * @base: (out caller-allocates): memory to fill
 *
 * Fills @base with the defaults of cerberus_base_new(), for structures on the stack.
 *
 * Since: 0.1
 */
CERBERUS_API
void cerberus_base_init(CerberusBase* base);

/**
 * cerberus_base_new: (constructor)
 *
 * Makes a body that stands, as seen.
 *
 * Returns: (transfer full): a new base; free with cerberus_base_free().
 *
 * Since: 0.1
 */
CERBERUS_API
CerberusBase* cerberus_base_new(void);

/**
 * cerberus_base_copy:
 * @base: a base
 *
 * Returns: (transfer full) (nullable): a copy; %NULL only for a %NULL @base.
 *
 * Since: 0.1
 */
CERBERUS_API
CerberusBase* cerberus_base_copy(const CerberusBase* base);

/**
 * cerberus_base_free: (skip)
 * @base: (transfer full) (nullable): a base
 *
 * Frees @base.
 *
 * Since: 0.1
 */
CERBERUS_API
void cerberus_base_free(CerberusBase* base);

/**
 * cerberus_event_new_base:
 * @yaw_rate: how fast the body turns, degrees a second, positive to the right
 * @running_time: from when on
 *
 * Makes the custom upstream event %CERBERUS_EVENT_BASE.
 *
 * Returns: (transfer full): a new event.
 *
 * Since: 0.1
 */
CERBERUS_API
GstEvent* cerberus_event_new_base(gdouble yaw_rate, GstClockTime running_time);

/**
 * cerberus_event_parse_base:
 * @event: an event
 * @yaw_rate: (out) (optional): degrees a second, positive to the right
 * @running_time: (out) (optional): from when on
 *
 * Reads a %CERBERUS_EVENT_BASE.
 *
 * Returns: %FALSE (and nothing is written) if @event is no well-formed one.
 *
 * Since: 0.1
 */
CERBERUS_API
gboolean cerberus_event_parse_base(GstEvent* event, gdouble* yaw_rate, GstClockTime* running_time);

/**
 * cerberus_buffer_set_base:
 * @buffer: a writable buffer
 * @base: (nullable): how the body moved when the frame was taken, copied; %NULL removes
 *
 * Attaches @base, replacing one that is there already. A fact about the moment: it survives scaling and cropping.
 *
 * Returns: %TRUE if @buffer now carries @base (or none, for %NULL); %FALSE if @buffer is not writable.
 *
 * Since: 0.1
 */
CERBERUS_API
gboolean cerberus_buffer_set_base(GstBuffer* buffer, const CerberusBase* base);

/**
 * cerberus_buffer_get_base:
 * @buffer: a buffer
 *
 * Returns: (transfer full) (nullable): a copy of how the body moved when the frame was taken, or %NULL if nobody knew.
 *
 * Since: 0.1
 */
CERBERUS_API
CerberusBase* cerberus_buffer_get_base(GstBuffer* buffer);

/**
 * cerberus_buffer_peek_base: (skip)
 * @buffer: a buffer
 *
 * Returns: (transfer none) (nullable): what @buffer carries, without a copy.
 *
 * Since: 0.1
 */
CERBERUS_API
const CerberusBase* cerberus_buffer_peek_base(GstBuffer* buffer);

G_DEFINE_AUTOPTR_CLEANUP_FUNC(CerberusBase, cerberus_base_free)

G_END_DECLS
