/* SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <cerberus/api.h>
#include <cerberus/pose.h>
#include <gst/gst.h>

G_BEGIN_DECLS

/**
 * CERBERUS_MESSAGE_PANTILT:
 *
 * Name of the structure of the element message that a head posts when what it does changes. Fields: `state` (string:
 * `stopped`, `tracking`, `turning`, `searching`, `zeroing`, `holding`, `manual`, `limited` or `fault`), `reason`
 * (string, for a user), `head` (string), `pan`, `tilt` (double, degrees), `running-time` (uint64, nanoseconds).
 *
 * Since: 0.1
 */
#define CERBERUS_MESSAGE_PANTILT "cerberus-pantilt"

/**
 * cerberus_message_new_pantilt:
 * @src: (transfer none) (nullable): the object that posts it
 * @running_time: when
 * @state: what the head does now, one of the words of %CERBERUS_MESSAGE_PANTILT
 * @reason: (nullable): why, in words for a user
 * @pose: where it looks
 *
 * Makes the element message %CERBERUS_MESSAGE_PANTILT.
 *
 * Returns: (transfer full): a new message.
 *
 * Since: 0.1
 */
CERBERUS_API
GstMessage* cerberus_message_new_pantilt(GstObject* src, GstClockTime running_time, const gchar* state,
                                         const gchar* reason, const CerberusPose* pose);

/**
 * cerberus_message_parse_pantilt:
 * @message: a message
 * @running_time: (out) (optional): when
 * @state: (out) (optional) (transfer full): what the head does, one of the words of %CERBERUS_MESSAGE_PANTILT
 * @reason: (out) (optional) (transfer full): why, in words for a user; may be empty
 *
 * Reads a %CERBERUS_MESSAGE_PANTILT.
 *
 * Returns: (transfer full) (nullable): where the head looked at @running_time: its name, pan and tilt, and nothing
 *     more; %NULL (and nothing is written) if @message is no well-formed one.
 *
 * Since: 0.1
 */
CERBERUS_API
CerberusPose* cerberus_message_parse_pantilt(GstMessage* message, GstClockTime* running_time, gchar** state,
                                             gchar** reason);

G_END_DECLS
