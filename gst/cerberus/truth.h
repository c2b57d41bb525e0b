/* SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <cerberus/api.h>
#include <gst/gst.h>

G_BEGIN_DECLS

/**
 * CERBERUS_TRUTH_MAX_PERSONS:
 *
 * The most persons in a #CerberusTruth.
 */
#define CERBERUS_TRUTH_MAX_PERSONS 16

/**
 * CerberusTruthPerson:
 * @id: its number, from 1; the same in all frames
 * @x: left edge of the whole person's box, pixels; may lie outside the frame, as the other edges may
 * @y: top edge, pixels
 * @width: pixels; 0: the person is behind the camera
 * @height: pixels
 * @visible: share of the person that is in the frame and not hidden, 0 to 1
 * @bearing: from the camera's axis, degrees, positive to the right
 * @distance: from the camera over the floor, metres
 * @speed: metres a second
 *
 * A person of a simulated world, as the camera that took the frame has it.
 */
typedef struct _CerberusTruthPerson {
  guint id;
  gdouble x, y, width, height;
  gdouble visible;
  gdouble bearing, distance, speed;
} CerberusTruthPerson;

/**
 * CerberusTruth:
 * @n_persons: number of persons
 * @persons: all persons of the world, hidden ones too
 * @base_x: where the robot is on the floor plan, metres
 * @base_y: where the robot is on the floor plan, metres
 * @base_heading: where it is ahead, degrees clockwise from the plan's x
 * @base_speed: metres a second, below 0: backwards
 * @base_yaw_rate: degrees a second, positive to the right
 * @pan: of the camera from straight ahead, degrees, positive to the right
 * @tilt: of the camera, degrees, positive up
 *
 * What was when a simulated frame was taken.
 */
typedef struct _CerberusTruth {
  guint n_persons;
  CerberusTruthPerson persons[CERBERUS_TRUTH_MAX_PERSONS];
  gdouble base_x, base_y, base_heading, base_speed, base_yaw_rate;
  gdouble pan, tilt;

  /*< private >*/
  gpointer _cerberus_reserved[GST_PADDING];
} CerberusTruth;

#define CERBERUS_TYPE_TRUTH (cerberus_truth_get_type())
#define CERBERUS_TYPE_TRUTH_PERSON (cerberus_truth_person_get_type())
#define CERBERUS_TRUTH_META_API_TYPE (cerberus_truth_meta_api_get_type())

/**
 * cerberus_truth_free: (skip)
 */
CERBERUS_DECLARE_BOXED(CerberusTruth, cerberus_truth)

/**
 * cerberus_truth_person_free: (skip)
 */
CERBERUS_DECLARE_BOXED(CerberusTruthPerson, cerberus_truth_person)

/**
 * cerberus_truth_get_person:
 * @truth: a truth
 * @index: from 0
 *
 * Returns: (transfer full) (nullable): the person, or %NULL if there are not so many.
 */
CERBERUS_API
CerberusTruthPerson* cerberus_truth_get_person(const CerberusTruth* truth, guint index);

/**
 * cerberus_buffer_set_truth:
 * @buffer: a writable buffer
 * @truth: (nullable): what was when the frame was taken, copied; %NULL removes
 *
 * Attaches what is true of this picture's pixels: it is scaled with them, and does not survive a crop.
 *
 * Returns: %FALSE if @buffer is not writable.
 */
CERBERUS_DECLARE_META(CerberusTruth, truth)

G_END_DECLS
