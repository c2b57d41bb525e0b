// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cerberus/camera-motion.h>
#include <gst/video/video.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "private/meta.hpp"
#include "vision/geometry/transform.h"

namespace {

using cerberus::vision::Size;
using cerberus::vision::Transform;

constexpr CerberusCameraMotion kUnknown = {
    .matrix = {1, 0, 0, 0, 1, 0, 0, 0, 1},
    .from = GST_CLOCK_TIME_NONE,
    .confidence = 0,
    .residual = 0,
    .still = FALSE,
    .scene_age = 0,
    .path_id = 0,
    .path = {1, 0, 0, 0, 1, 0, 0, 0, 1},
    ._cerberus_reserved = {},
};

using Carried = cerberus::ValueMeta<&CerberusCameraMotionMeta::motion, cerberus_camera_motion_init,
                                    cerberus_camera_motion_meta_get_info>;

void scale(gdouble (&matrix)[9], Size from, Size to) {
  Transform transform;
  std::copy(std::begin(matrix), std::end(matrix), transform.m.begin());
  transform = transform.rescaled(from, to);  // identity stays exactly identity
  std::copy(transform.m.begin(), transform.m.end(), matrix);
}

// The same motion in a picture of another size. The residual scales by the geometric mean of both directions.
CerberusCameraMotion scaled(const CerberusCameraMotion& motion, Size from, Size to) {
  CerberusCameraMotion result = motion;
  if (from == to || from.area() <= 0 || to.area() <= 0) return result;
  scale(result.matrix, from, to);
  scale(result.path, from, to);
  result.residual *= std::sqrt(static_cast<double>(to.area()) / static_cast<double>(from.area()));
  return result;
}

// Copies and scaling keep the meta; whatever else is done to a picture (cropping, turning) makes its pixels
// wrong.
gboolean meta_transform(GstBuffer* to, GstMeta* meta, GstBuffer*, GQuark type, gpointer data) {
  const CerberusCameraMotion& motion = Carried::value_of(meta);
  if (GST_META_TRANSFORM_IS_COPY(type)) return Carried::put(to, motion) != nullptr;
  if (!GST_VIDEO_META_TRANSFORM_IS_SCALE(type)) return FALSE;
  const auto* scale = static_cast<GstVideoMetaTransform*>(data);
  const CerberusCameraMotion result =
      scaled(motion, {GST_VIDEO_INFO_WIDTH(scale->in_info), GST_VIDEO_INFO_HEIGHT(scale->in_info)},
             {GST_VIDEO_INFO_WIDTH(scale->out_info), GST_VIDEO_INFO_HEIGHT(scale->out_info)});
  return Carried::put(to, result) != nullptr;
}

}  // namespace

G_DEFINE_BOXED_TYPE(CerberusCameraMotion, cerberus_camera_motion, cerberus_camera_motion_copy,
                    cerberus_camera_motion_free)

GType cerberus_camera_motion_meta_api_get_type(void) {
  static const GType type = cerberus::register_meta_api("CerberusCameraMotionMetaAPI", GST_META_TAG_VIDEO_STR,
                                                        GST_META_TAG_VIDEO_SIZE_STR);
  return type;
}

const GstMetaInfo* cerberus_camera_motion_meta_get_info(void) {
  static const GstMetaInfo* const info =
      Carried::register_as(CERBERUS_CAMERA_MOTION_META_API_TYPE, "CerberusCameraMotionMeta", meta_transform);
  return info;
}

void cerberus_camera_motion_init(CerberusCameraMotion* motion) {
  g_return_if_fail(motion);
  *motion = kUnknown;
}

CerberusCameraMotion* cerberus_camera_motion_new(void) {
  return cerberus_camera_motion_copy(&kUnknown);
}

CerberusCameraMotion* cerberus_camera_motion_copy(const CerberusCameraMotion* motion) {
  return static_cast<CerberusCameraMotion*>(g_memdup2(motion, sizeof *motion));
}

void cerberus_camera_motion_free(CerberusCameraMotion* motion) {
  g_free(motion);
}

void cerberus_camera_motion_set_matrix(CerberusCameraMotion* motion, const gdouble* matrix) {
  g_return_if_fail(motion);
  g_return_if_fail(matrix);
  std::copy_n(matrix, std::size(motion->matrix), motion->matrix);
}

gboolean cerberus_camera_motion_apply(const CerberusCameraMotion* motion, gdouble x, gdouble y,
                                      gdouble* out_x, gdouble* out_y) {
  g_return_val_if_fail(motion, FALSE);
  const gdouble* m = motion->matrix;
  const double w = m[6] * x + m[7] * y + m[8];
  const double px = (m[0] * x + m[1] * y + m[2]) / w, py = (m[3] * x + m[4] * y + m[5]) / w;
  if (!std::isfinite(px) || !std::isfinite(py)) return FALSE;
  if (out_x) *out_x = px;
  if (out_y) *out_y = py;
  return TRUE;
}

CerberusCameraMotionMeta* cerberus_buffer_add_camera_motion_meta(GstBuffer* buffer,
                                                                 const CerberusCameraMotion* motion) {
  g_return_val_if_fail(GST_IS_BUFFER(buffer), nullptr);
  g_return_val_if_fail(gst_buffer_is_writable(buffer), nullptr);
  g_return_val_if_fail(motion, nullptr);
  return Carried::put(buffer, *motion);
}

gboolean cerberus_buffer_set_camera_motion(GstBuffer* buffer, const CerberusCameraMotion* motion) {
  g_return_val_if_fail(GST_IS_BUFFER(buffer), FALSE);
  return Carried::set(buffer, motion);
}

const CerberusCameraMotionMeta* cerberus_buffer_get_camera_motion_meta(GstBuffer* buffer) {
  g_return_val_if_fail(GST_IS_BUFFER(buffer), nullptr);
  return Carried::find(buffer);
}

CerberusCameraMotion* cerberus_buffer_get_camera_motion(GstBuffer* buffer) {
  const CerberusCameraMotionMeta* meta = cerberus_buffer_get_camera_motion_meta(buffer);
  return meta ? cerberus_camera_motion_copy(&meta->motion) : nullptr;
}
