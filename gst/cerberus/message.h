/* SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <cerberus/api.h>
#include <cerberus/region.h>
#include <cerberus/stamp.h>
#include <gst/gst.h>

G_BEGIN_DECLS

/**
 * CERBERUS_MESSAGE_MOTION:
 *
 * Name of the element message that reports that motion started or ended. Fields: those of #CerberusStamp, `state`
 * (string, a nick of #CerberusMotionState), `objects` (list of structures `cerberus-object`).
 */
#define CERBERUS_MESSAGE_MOTION "cerberus-motion"

/**
 * CERBERUS_MESSAGE_TRACK:
 *
 * Name of the element message that reports what happens to one track. Fields: those of #CerberusStamp, `state` (string,
 * a nick of #CerberusTrackState), `object` (structure `cerberus-object`: identity, box, velocity and so on), `first`,
 * `last` (uint64, running times of the first and the last frame that it was published on).
 */
#define CERBERUS_MESSAGE_TRACK "cerberus-track"

/**
 * CerberusMotionState:
 * @CERBERUS_MOTION_STARTED: the first object appeared
 * @CERBERUS_MOTION_ENDED: no object was there for `hold-time`, or the stream ended
 *
 * What happened to motion as a whole.
 */
typedef enum { CERBERUS_MOTION_STARTED, CERBERUS_MOTION_ENDED } CerberusMotionState;

/**
 * CerberusTrackState:
 * @CERBERUS_TRACK_APPEARED: it was published for the first time
 * @CERBERUS_TRACK_UPDATED: it is still there; at most once a second for each track
 * @CERBERUS_TRACK_LEFT: it was not published for `hold-time`, or the stream ended
 *
 * What happened to a track.
 */
typedef enum { CERBERUS_TRACK_APPEARED, CERBERUS_TRACK_UPDATED, CERBERUS_TRACK_LEFT } CerberusTrackState;

/**
 * CerberusMotion:
 * @state: started or ended
 * @regions: (nullable) (element-type CerberusRegion): the moving objects, or those of the last frame with any; owned by
 *     a boxed structure, borrowed in one on the stack; %NULL counts as empty
 *
 * The start or the end of motion.
 */
typedef struct _CerberusMotion {
  CerberusMotionState state;
  GPtrArray* regions;

  /*< private >*/
  gpointer _cerberus_reserved[GST_PADDING];
} CerberusMotion;

/**
 * CerberusTrack:
 * @state: what happened to it
 * @region: the track as it was last published
 * @first: running time of the first frame that it was published on, %GST_CLOCK_TIME_NONE if it is not known
 * @last: running time of the last frame that it was published on, %GST_CLOCK_TIME_NONE if it is not known
 *
 * What happened to one track.
 */
typedef struct _CerberusTrack {
  CerberusTrackState state;
  CerberusRegion region;
  GstClockTime first, last;

  /*< private >*/
  gpointer _cerberus_reserved[GST_PADDING];
} CerberusTrack;

#define CERBERUS_TYPE_MOTION (cerberus_motion_get_type())
#define CERBERUS_TYPE_MOTION_STATE (cerberus_motion_state_get_type())
#define CERBERUS_TYPE_TRACK (cerberus_track_get_type())
#define CERBERUS_TYPE_TRACK_STATE (cerberus_track_state_get_type())

/**
 * cerberus_motion_free: (skip)
 */
CERBERUS_DECLARE_BOXED(CerberusMotion, cerberus_motion)
CERBERUS_DECLARE_ENUM(CerberusMotionState, cerberus_motion_state)

/**
 * cerberus_track_free: (skip)
 */
CERBERUS_DECLARE_BOXED(CerberusTrack, cerberus_track)
CERBERUS_DECLARE_ENUM(CerberusTrackState, cerberus_track_state)

/**
 * cerberus_motion_add_region:
 * @motion: a boxed motion
 * @region: an object, copied
 *
 * Appends @region to those of @motion.
 */
CERBERUS_API
void cerberus_motion_add_region(CerberusMotion* motion, const CerberusRegion* region);

/**
 * cerberus_motion_get_regions:
 * @motion: a motion
 *
 * Returns: (transfer container) (element-type CerberusRegion): copies of its objects, possibly none.
 */
CERBERUS_API
GPtrArray* cerberus_motion_get_regions(const CerberusMotion* motion);

/**
 * cerberus_message_new_motion:
 * @src: (nullable): the object that posts it
 * @stamp: (nullable): when, and by which camera
 * @motion: the start or the end of motion
 *
 * Returns: (transfer full): a new %CERBERUS_MESSAGE_MOTION.
 */
CERBERUS_DECLARE_MESSAGE(CerberusMotion, motion)

/**
 * cerberus_message_new_track:
 * @src: (nullable): the object that posts it
 * @stamp: (nullable): when, and by which camera
 * @track: what happened to a track
 *
 * Returns: (transfer full): a new %CERBERUS_MESSAGE_TRACK.
 */
CERBERUS_DECLARE_MESSAGE(CerberusTrack, track)

G_END_DECLS
