/* SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <cerberus/api.h>
#include <cerberus/pose.h>
#include <cerberus/stamp.h>
#include <gst/gst.h>

G_BEGIN_DECLS

/**
 * CERBERUS_MESSAGE_PANTILT:
 *
 * Name of the element message that a head posts when its state changes. Fields: those of #CerberusStamp, `state`
 * (string, a nick of #CerberusPantiltState), `reason` (string, for a user), `head` (string), `pan`, `tilt` (double,
 * degrees), `waits-for-order` (boolean: it stands, and only the next order by hand, or `auto`, moves it).
 */
#define CERBERUS_MESSAGE_PANTILT "cerberus-pantilt"

/**
 * CerberusPantiltState:
 * @CERBERUS_PANTILT_STOPPED: it stands, and follows nothing
 * @CERBERUS_PANTILT_TRACKING: it follows a target
 * @CERBERUS_PANTILT_TURNING: it turns at the defined speed
 * @CERBERUS_PANTILT_SEARCHING: it sweeps a sector
 * @CERBERUS_PANTILT_ZEROING: it returns to straight ahead
 * @CERBERUS_PANTILT_HOLDING: it stays where it is
 * @CERBERUS_PANTILT_MANUAL: the application drives it
 * @CERBERUS_PANTILT_LIMITED: it stands at a limit that the target is beyond
 * @CERBERUS_PANTILT_FAULT: its driver fails
 * @CERBERUS_PANTILT_HOMING: it has lost its reference and looks for it
 *
 * What a head does.
 */
typedef enum {
  CERBERUS_PANTILT_STOPPED,
  CERBERUS_PANTILT_TRACKING,
  CERBERUS_PANTILT_TURNING,
  CERBERUS_PANTILT_SEARCHING,
  CERBERUS_PANTILT_ZEROING,
  CERBERUS_PANTILT_HOLDING,
  CERBERUS_PANTILT_MANUAL,
  CERBERUS_PANTILT_LIMITED,
  CERBERUS_PANTILT_FAULT,
  CERBERUS_PANTILT_HOMING,
} CerberusPantiltState;

/**
 * CerberusPantilt:
 * @state: what the head does
 * @reason: (nullable): why, in words for a user; owned by a boxed structure, borrowed in one on the stack
 * @pose: where it looks; of a message its name, pan, tilt and the time from which it is valid are known
 * @waits_for_order: it stands, and only the next order by hand, or `auto`, moves it
 *
 * The state of a pan-tilt head.
 */
typedef struct _CerberusPantilt {
  CerberusPantiltState state;
  gchar* reason;
  CerberusPose pose;
  gboolean waits_for_order;

  /*< private >*/
  gpointer _cerberus_reserved[GST_PADDING];
} CerberusPantilt;

#define CERBERUS_TYPE_PANTILT (cerberus_pantilt_get_type())
#define CERBERUS_TYPE_PANTILT_STATE (cerberus_pantilt_state_get_type())

/**
 * cerberus_pantilt_free: (skip)
 */
CERBERUS_DECLARE_BOXED(CerberusPantilt, cerberus_pantilt)
CERBERUS_DECLARE_ENUM(CerberusPantiltState, cerberus_pantilt_state)

/**
 * cerberus_message_new_pantilt:
 * @src: (nullable): the object that posts it
 * @stamp: (nullable): when, and by which camera
 * @pantilt: the state of the head
 *
 * Returns: (transfer full): a new %CERBERUS_MESSAGE_PANTILT.
 */
CERBERUS_DECLARE_MESSAGE(CerberusPantilt, pantilt)

G_END_DECLS
