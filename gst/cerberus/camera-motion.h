/* SPDX-License-Identifier: LGPL-2.1-or-later */
#pragma once

#include <cerberus/api.h>
#include <gst/gst.h>

G_BEGIN_DECLS

/**
 * CerberusCameraMotion:
 * @matrix: (array fixed-size=9): motion of the picture from the previous frame to this one: a homography in row-major
 *     order, in pixels of the frame that it is attached to, pixel centres at whole numbers. A point (x, y) of the
 *     previous frame is found at ((m0 x + m1 y + m2) / w, (m3 x + m4 y + m5) / w), w = m6 x + m7 y + m8, in this one.
 * @from: running time of the previous frame, %GST_CLOCK_TIME_NONE where there is none
 * @confidence: share of the usable picture that follows @matrix, 0 to 1
 * @residual: RMS distance of that share from @matrix, in frame pixels
 * @still: the camera stands: @matrix is exactly identity
 * @scene_age: frames of this scene so far, this one included: 1 is the first frame after the start, a cut, a seek or a
 *     gap (it has no predecessor, and all elements drop their history); 0 is unknown
 * @path_id: the same for all frames that @path connects; 0 is none
 * @path: (array fixed-size=9): motion of the picture from the frame at which the path began to this one, as @matrix.
 *     The motion between any two frames of one path, also with dropped frames in between, is the later one's path times
 *     the inverse of the earlier one's
 * @calm: share of the scene's corners that follow @matrix within half a pixel of the analysed picture, mean of a second,
 *     as a tracker upstream has measured it; 1 where none has. Below 0.8 much of what moves is the scene: the picture
 *     shakes or blurs, or the camera drives past near things. Since: 0.3
 *
 * The camera's own motion between two consecutive frames.
 */
typedef struct _CerberusCameraMotion {
  gdouble matrix[9];
  GstClockTime from;
  gdouble confidence;
  gdouble residual;
  gboolean still;
  guint scene_age;
  guint path_id;
  gdouble path[9];
  gdouble calm;

  /*< private >*/
  gpointer _cerberus_reserved[GST_PADDING - 1];
} CerberusCameraMotion;

#define CERBERUS_TYPE_CAMERA_MOTION (cerberus_camera_motion_get_type())
#define CERBERUS_CAMERA_MOTION_META_API_TYPE (cerberus_camera_motion_meta_api_get_type())

/**
 * cerberus_camera_motion_free: (skip)
 */
CERBERUS_DECLARE_BOXED(CerberusCameraMotion, cerberus_camera_motion)

/**
 * cerberus_camera_motion_set_matrix:
 * @motion: a motion
 * @matrix: (array fixed-size=9): nine numbers, row-major, as in #CerberusCameraMotion
 *
 * Sets the matrix: bindings cannot write an array inside a structure.
 */
CERBERUS_API
void cerberus_camera_motion_set_matrix(CerberusCameraMotion* motion, const gdouble* matrix);

/**
 * cerberus_camera_motion_apply:
 * @motion: a motion
 * @x: column in the previous frame, pixels
 * @y: row in the previous frame, pixels
 * @out_x: (out) (optional): column in this frame, pixels
 * @out_y: (out) (optional): row in this frame, pixels
 *
 * Computes the place in this frame of a point of the previous frame that is at rest in the scene.
 *
 * Returns: %FALSE if the point lies on the transform's horizon (nothing is written then).
 */
CERBERUS_API
gboolean cerberus_camera_motion_apply(const CerberusCameraMotion* motion, gdouble x, gdouble y,
                                      gdouble* out_x, gdouble* out_y);

/**
 * cerberus_buffer_set_camera_motion:
 * @buffer: a writable buffer
 * @camera_motion: (nullable): where the picture went, copied; %NULL removes
 *
 * Attaches the camera's motion. It is scaled with the picture and lost where that is cropped; videoflip keeps it
 * unchanged, which is wrong and cannot be detected. At most one a buffer.
 *
 * Returns: %FALSE if @buffer is not writable.
 */
CERBERUS_DECLARE_META(CerberusCameraMotion, camera_motion)

G_END_DECLS
