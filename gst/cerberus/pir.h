/* SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <cerberus/api.h>
#include <gst/gst.h>

G_BEGIN_DECLS

/**
 * CERBERUS_PIR_CAPS:
 *
 * Caps string of every stream of PIR readings. Complete caps name `format`, `sensors`
 * (int), `bearings` (array of double, degrees, one a sensor, positive to the right of
 * straight ahead) and `field-of-view` (double, degrees, of each sensor).
 *
 * Since: 0.1
 */
#define CERBERUS_PIR_CAPS "application/x-pir, format = (string) { presence, level }"

/**
 * CERBERUS_PIR_MAX_SENSORS:
 *
 * As many sensors as one stream can carry.
 *
 * Since: 0.1
 */
#define CERBERUS_PIR_MAX_SENSORS 16

/**
 * CERBERUS_MESSAGE_PIR:
 *
 * Name of the structure of the element message that a PIR source posts at every change. Fields: `running-time` (uint64,
 * nanoseconds), `sensors` (array of int, one a sensor: 0 nothing, 1 somebody, 2 invalid), `bearings` (array of double,
 * degrees).
 *
 * Since: 0.1
 */
#define CERBERUS_MESSAGE_PIR "cerberus-pir"

/**
 * CerberusPirFormat:
 * @CERBERUS_PIR_PRESENCE: one byte a sensor: 0 nothing, 1 somebody, 2 invalid (as in warm-up)
 * @CERBERUS_PIR_LEVEL: one 32-bit float a sensor, in volts, in this machine's byte order; NaN: nothing was measured
 *
 * What a buffer of PIR readings holds.
 *
 * Since: 0.1
 */
typedef enum {
  CERBERUS_PIR_PRESENCE,
  CERBERUS_PIR_LEVEL,
} CerberusPirFormat;

/**
 * CerberusPirInfo:
 * @format: what a buffer holds
 * @sensors: number of sensors, 1 to %CERBERUS_PIR_MAX_SENSORS
 * @bearings: where each sensor looks, degrees, positive to the right of straight ahead
 * @field_of_view: how wide each sensor sees, degrees
 *
 * What the caps of a stream of PIR readings say.
 *
 * Since: 0.1
 */
typedef struct _CerberusPirInfo CerberusPirInfo;
struct _CerberusPirInfo {
  CerberusPirFormat format;
  guint sensors;
  gdouble bearings[CERBERUS_PIR_MAX_SENSORS];
  gdouble field_of_view;
};

/**
 * cerberus_pir_info_init: (skip)
 * @info: (out caller-allocates): memory to fill
 *
 * Fills @info with the paper's arrangement: presence of three sensors ahead, left and right (0, -120 and 120 degrees),
 * 120 degrees each.
 *
 * Since: 0.1
 */
CERBERUS_API
void cerberus_pir_info_init(CerberusPirInfo* info);

/**
 * cerberus_pir_info_to_caps: (skip)
 * @info: what the caps shall say
 *
 * Returns: (transfer full) (nullable): fixed caps, or %NULL if @info is not one that
 *     cerberus_pir_info_from_caps() would accept.
 *
 * Since: 0.1
 */
CERBERUS_API
GstCaps* cerberus_pir_info_to_caps(const CerberusPirInfo* info);

/**
 * cerberus_pir_info_from_caps: (skip)
 * @info: (out caller-allocates): memory to fill
 * @caps: fixed caps
 * @error: (nullable): where to put what is wrong with @caps, in words for a user
 *
 * Returns: %FALSE (with @error set) if @caps are not complete caps of PIR readings: an unknown format, no sensor or too
 *     many, a bearing a sensor missing or not finite, a field of view outside 0 to 360 degrees.
 *
 * Since: 0.1
 */
CERBERUS_API
gboolean cerberus_pir_info_from_caps(CerberusPirInfo* info, const GstCaps* caps, GError** error);

/**
 * cerberus_pir_info_buffer_size: (skip)
 * @info: what the caps say
 *
 * Returns: bytes of one buffer.
 *
 * Since: 0.1
 */
CERBERUS_API
gsize cerberus_pir_info_buffer_size(const CerberusPirInfo* info);

/**
 * cerberus_message_new_pir: (skip)
 * @src: (transfer none) (nullable): the object that posts it
 * @running_time: running time of the change
 * @info: what the stream's caps say
 * @sensors: the readings, a byte a sensor: 0, 1, or 2 for invalid
 *
 * Makes the element message %CERBERUS_MESSAGE_PIR.
 *
 * Returns: (transfer full): a new message.
 *
 * Since: 0.1
 */
CERBERUS_API
GstMessage* cerberus_message_new_pir(GstObject* src, GstClockTime running_time, const CerberusPirInfo* info,
                                     const guint8* sensors);

/**
 * cerberus_message_parse_pir:
 * @message: a message
 * @running_time: (out) (optional): running time of the change
 *
 * Reads a %CERBERUS_MESSAGE_PIR.
 *
 * Returns: (transfer full) (nullable): the readings, a byte a sensor: 0 nothing, 1 somebody, 2 invalid; %NULL if
 *     @message is no well-formed one.
 *
 * Since: 0.1
 */
CERBERUS_API
GBytes* cerberus_message_parse_pir(GstMessage* message, GstClockTime* running_time);

G_END_DECLS
