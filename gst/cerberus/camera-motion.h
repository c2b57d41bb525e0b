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
 *
 * The camera's own motion between two consecutive frames.
 *
 * Since: 0.1
 */
typedef struct _CerberusCameraMotion CerberusCameraMotion;
struct _CerberusCameraMotion {
  gdouble matrix[9];
  GstClockTime from;
  gdouble confidence;
  gdouble residual;
  gboolean still;
  guint scene_age;
  guint path_id;
  gdouble path[9];

  /*< private >*/
  gpointer _cerberus_reserved[GST_PADDING];
};

/**
 * CerberusCameraMotionMeta:
 * @meta: parent
 * @motion: the camera's motion
 *
 * Carries a #CerberusCameraMotion on a video buffer. Scaled with the picture, lost where it is cropped; videoflip keeps
 * it unchanged, which is wrong and cannot be detected. At most one a buffer.
 *
 * Since: 0.1
 */
typedef struct _CerberusCameraMotionMeta CerberusCameraMotionMeta;
struct _CerberusCameraMotionMeta {
  GstMeta meta;
  CerberusCameraMotion motion;
};

#define CERBERUS_TYPE_CAMERA_MOTION (cerberus_camera_motion_get_type())
#define CERBERUS_CAMERA_MOTION_META_API_TYPE (cerberus_camera_motion_meta_api_get_type())
#define CERBERUS_CAMERA_MOTION_META_INFO (cerberus_camera_motion_meta_get_info())

CERBERUS_API
GType cerberus_camera_motion_get_type(void) G_GNUC_CONST;

CERBERUS_API
GType cerberus_camera_motion_meta_api_get_type(void);

/**
 * cerberus_camera_motion_meta_get_info: (skip)
 *
 * Returns: the registered #GstMetaInfo of #CerberusCameraMotionMeta.
 *
 * Since: 0.1
 */
CERBERUS_API
const GstMetaInfo* cerberus_camera_motion_meta_get_info(void);

/**
 * cerberus_camera_motion_init: (skip)
 * @motion: (out caller-allocates): memory to fill
 *
 * Fills @motion with the defaults of cerberus_camera_motion_new(), for structures on the stack.
 *
 * Since: 0.1
 */
CERBERUS_API
void cerberus_camera_motion_init(CerberusCameraMotion* motion);

/**
 * cerberus_camera_motion_new: (constructor)
 *
 * Makes an identity motion: not still, confidence 0, from %GST_CLOCK_TIME_NONE, scene age 0 (unknown).
 *
 * Returns: (transfer full): a new motion; free with cerberus_camera_motion_free().
 *
 * Since: 0.1
 */
CERBERUS_API
CerberusCameraMotion* cerberus_camera_motion_new(void);

/**
 * cerberus_camera_motion_copy:
 * @motion: a motion
 *
 * Returns: (transfer full) (nullable): a copy; %NULL only for a %NULL @motion.
 *
 * Since: 0.1
 */
CERBERUS_API
CerberusCameraMotion* cerberus_camera_motion_copy(const CerberusCameraMotion* motion);

/**
 * cerberus_camera_motion_free: (skip)
 * @motion: (transfer full) (nullable): a motion
 *
 * Frees @motion.
 *
 * Since: 0.1
 */
CERBERUS_API
void cerberus_camera_motion_free(CerberusCameraMotion* motion);

/**
 * cerberus_camera_motion_set_matrix:
 * @motion: a motion
 * @matrix: (array fixed-size=9): nine numbers, row-major, as in #CerberusCameraMotion
 *
 * Sets the matrix: bindings cannot write an array inside a structure.
 *
 * Since: 0.1
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
 *
 * Since: 0.1
 */
CERBERUS_API
gboolean cerberus_camera_motion_apply(const CerberusCameraMotion* motion, gdouble x, gdouble y,
                                      gdouble* out_x, gdouble* out_y);

/**
 * cerberus_buffer_add_camera_motion_meta: (skip)
 * @buffer: a writable buffer
 * @motion: what to attach, copied
 *
 * Attaches @motion, replacing one that is there already.
 *
 * Returns: (transfer none) (nullable): the meta on @buffer.
 *
 * Since: 0.1
 */
CERBERUS_API
CerberusCameraMotionMeta* cerberus_buffer_add_camera_motion_meta(GstBuffer* buffer,
                                                                 const CerberusCameraMotion* motion);

/**
 * cerberus_buffer_set_camera_motion:
 * @buffer: a writable buffer
 * @motion: (nullable): what to attach, copied; %NULL removes
 *
 * Attaches @motion, replacing one that is there already: the form for bindings.
 *
 * Returns: %TRUE if @buffer now carries @motion (or none, for %NULL); %FALSE if @buffer is not writable.
 *
 * Since: 0.1
 */
CERBERUS_API
gboolean cerberus_buffer_set_camera_motion(GstBuffer* buffer, const CerberusCameraMotion* motion);

/**
 * cerberus_buffer_get_camera_motion_meta: (skip)
 * @buffer: a buffer
 *
 * Returns: (transfer none) (nullable): the meta on @buffer, without a copy.
 *
 * Since: 0.1
 */
CERBERUS_API
const CerberusCameraMotionMeta* cerberus_buffer_get_camera_motion_meta(GstBuffer* buffer);

/**
 * cerberus_buffer_get_camera_motion:
 * @buffer: a buffer
 *
 * Returns: (transfer full) (nullable): a copy of the camera's motion, or %NULL if nothing upstream measured it.
 *
 * Since: 0.1
 */
CERBERUS_API
CerberusCameraMotion* cerberus_buffer_get_camera_motion(GstBuffer* buffer);

G_DEFINE_AUTOPTR_CLEANUP_FUNC(CerberusCameraMotion, cerberus_camera_motion_free)

G_END_DECLS
