/* SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <cerberus/api.h>
#include <cerberus/region.h>
#include <gst/gst.h>

G_BEGIN_DECLS

/**
 * CERBERUS_MESSAGE_MOTION:
 *
 * Name of the structure of the element message that tells that motion started or ended. Fields: `state` (string,
 * `started` or `ended`), `running-time` (uint64, nanoseconds), `objects` (list of structures `cerberus-object`).
 *
 * Since: 0.1
 */
#define CERBERUS_MESSAGE_MOTION "cerberus-motion"

/**
 * cerberus_message_new_motion:
 * @src: (transfer none) (nullable): the object that posts it
 * @started: %TRUE: motion started; %FALSE: it ended
 * @running_time: running time of the frame in which it did
 * @regions: (nullable) (element-type CerberusRegion): what moves, or moved last; %NULL for none
 *
 * Makes the element message %CERBERUS_MESSAGE_MOTION.
 *
 * Returns: (transfer full): a new message, for gst_element_post_message().
 *
 * Since: 0.1
 */
CERBERUS_API
GstMessage* cerberus_message_new_motion(GstObject* src, gboolean started, GstClockTime running_time,
                                        GPtrArray* regions);

/**
 * cerberus_message_is_motion:
 * @message: a message
 *
 * Returns: %TRUE if @message is a %CERBERUS_MESSAGE_MOTION.
 *
 * Since: 0.1
 */
CERBERUS_API
gboolean cerberus_message_is_motion(GstMessage* message);

/**
 * cerberus_message_parse_motion:
 * @message: a message
 * @started: (out) (optional): whether motion started (or ended)
 * @running_time: (out) (optional): running time of the frame in which it did
 * @regions: (out) (optional) (transfer container) (element-type CerberusRegion): what moves; release with
 *     g_ptr_array_unref(), which frees the regions too
 *
 * Reads a %CERBERUS_MESSAGE_MOTION.
 *
 * Returns: %FALSE (and nothing is written) if @message is not a well-formed one.
 *
 * Since: 0.1
 */
CERBERUS_API
gboolean cerberus_message_parse_motion(GstMessage* message, gboolean* started, GstClockTime* running_time,
                                       GPtrArray** regions);

G_END_DECLS
