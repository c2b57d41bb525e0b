/* SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <cerberus/api.h>
#include <cerberus/stamp.h>
#include <gst/gst.h>

G_BEGIN_DECLS

/**
 * CERBERUS_PIR_CAPS:
 *
 * Caps string of every stream of PIR readings. Complete caps name `format`, `sensors`
 * (int), `bearings` (array of double, degrees, one a sensor, positive to the right of
 * straight ahead) and `field-of-view` (double, degrees, of each sensor). `range` (double,
 * metres) says how far each sensor sees a person, where that is known.
 */
#define CERBERUS_PIR_CAPS "application/x-pir, format = (string) { presence, level }"

/**
 * CERBERUS_PIR_MAX_SENSORS:
 *
 * As many sensors as one stream can carry.
 */
#define CERBERUS_PIR_MAX_SENSORS 16

/**
 * CERBERUS_MESSAGE_PIR:
 *
 * Name of the element message that a PIR source posts at every change. Fields: those of #CerberusStamp, `sensors`
 * (array of int, one a sensor: 0 nothing, 1 motion, 2 invalid), `bearings` (array of double, degrees), `doubtful`
 * (uint, one bit a sensor).
 */
#define CERBERUS_MESSAGE_PIR "cerberus-pir"

/**
 * CerberusPirFormat:
 * @CERBERUS_PIR_PRESENCE: one byte a sensor: 0 nothing, 1 motion, 2 invalid (as in warm-up)
 * @CERBERUS_PIR_LEVEL: one 32-bit float a sensor, in volts, in this machine's byte order; NaN: nothing was measured
 *
 * What a buffer of PIR readings holds.
 */
typedef enum { CERBERUS_PIR_PRESENCE, CERBERUS_PIR_LEVEL } CerberusPirFormat;

/**
 * CerberusPirInfo:
 * @format: what a buffer holds
 * @sensors: number of sensors, 1 to %CERBERUS_PIR_MAX_SENSORS
 * @bearings: where each sensor looks, degrees, positive to the right of straight ahead
 * @field_of_view: how wide each sensor sees, degrees
 *
 * What the caps of a stream of PIR readings say.
 */
typedef struct _CerberusPirInfo {
  CerberusPirFormat format;
  guint sensors;
  gdouble bearings[CERBERUS_PIR_MAX_SENSORS];
  gdouble field_of_view;
} CerberusPirInfo;

/**
 * cerberus_pir_info_init: (skip)
 * @info: (out caller-allocates): memory to fill
 *
 * Fills @info with the paper's arrangement: presence of three sensors ahead, left and right (0, -120 and 120 degrees),
 * 120 degrees each.
 */
CERBERUS_API
void cerberus_pir_info_init(CerberusPirInfo* info);

/**
 * cerberus_pir_info_to_caps: (skip)
 * @info: what the caps shall say
 *
 * Returns: (transfer full) (nullable): fixed caps, or %NULL if @info is not one that
 *     cerberus_pir_info_from_caps() would accept.
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
 */
CERBERUS_API
gboolean cerberus_pir_info_from_caps(CerberusPirInfo* info, const GstCaps* caps, GError** error);

/**
 * cerberus_pir_info_buffer_size: (skip)
 * @info: what the caps say
 *
 * Returns: bytes of one buffer.
 */
CERBERUS_API
gsize cerberus_pir_info_buffer_size(const CerberusPirInfo* info);

/**
 * CerberusPir:
 * @n_sensors: number of sensors
 * @sensors: their readings: 0 nothing, 1 motion, 2 invalid
 * @bearings: direction of each sensor, degrees, positive to the right of straight ahead
 * @doubtful: one bit a sensor: the robot's own motion may have caused its detection
 *
 * The readings of all sensors of a stream.
 */
typedef struct _CerberusPir {
  guint n_sensors;
  guint8 sensors[CERBERUS_PIR_MAX_SENSORS];
  gdouble bearings[CERBERUS_PIR_MAX_SENSORS];
  guint doubtful;

  /*< private >*/
  gpointer _cerberus_reserved[GST_PADDING];
} CerberusPir;

#define CERBERUS_TYPE_PIR (cerberus_pir_get_type())
#define CERBERUS_TYPE_PIR_FORMAT (cerberus_pir_format_get_type())

/**
 * cerberus_pir_free: (skip)
 */
CERBERUS_DECLARE_BOXED(CerberusPir, cerberus_pir)
CERBERUS_DECLARE_ENUM(CerberusPirFormat, cerberus_pir_format)

/**
 * cerberus_pir_get_sensors:
 * @pir: readings
 *
 * Returns: (transfer full): a byte a sensor: 0 nothing, 1 motion, 2 invalid.
 */
CERBERUS_API
GBytes* cerberus_pir_get_sensors(const CerberusPir* pir);

/**
 * cerberus_message_new_pir:
 * @src: (nullable): the object that posts it
 * @stamp: (nullable): when, and by which camera
 * @pir: the readings
 *
 * Returns: (transfer full): a new %CERBERUS_MESSAGE_PIR.
 */
CERBERUS_DECLARE_MESSAGE(CerberusPir, pir)

G_END_DECLS
