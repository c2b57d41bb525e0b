// SPDX-License-Identifier: LGPL-2.1-or-later
#include <cerberus/camera-motion.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>

#include "cerberus/private/define.hpp"
#include "vision/geometry/transform.h"

namespace {

using cerberus::vision::Transform;

void unknown(CerberusCameraMotion& motion) {
  for (const int diagonal : {0, 4, 8}) motion.matrix[diagonal] = motion.path[diagonal] = 1;
  motion.from = GST_CLOCK_TIME_NONE;
  motion.calm = 1;
}

void scale(gdouble (&matrix)[9], const cerberus::Rescaling& sizes) {
  Transform transform;
  std::copy(std::begin(matrix), std::end(matrix), transform.m.begin());
  transform = transform.rescaled(sizes.from, sizes.to);  // identity stays exactly identity
  std::copy(transform.m.begin(), transform.m.end(), matrix);
}

gboolean transform_meta(GstBuffer* to, GstMeta* meta, GstBuffer* from, GQuark type, gpointer data);

}  // namespace

template <typename Archive>
static void exchange(Archive& archive, CerberusCameraMotion& m) {
  archive(m.matrix, cerberus::publish::Moment{m.from}, m.confidence, m.residual, m.still, m.scene_age,
          m.path_id, m.path, m.calm);
}

CERBERUS_DEFINE_BOXED(CerberusCameraMotion, cerberus_camera_motion, unknown)
CERBERUS_DEFINE_META(CerberusCameraMotion, camera_motion, std::identity{}, transform_meta,
                     GST_META_TAG_VIDEO_STR, GST_META_TAG_VIDEO_SIZE_STR)

namespace {

// The residual scales by the geometric mean of both directions.
gboolean transform_meta(GstBuffer* to, GstMeta*, GstBuffer* from, GQuark type, gpointer data) {
  const auto sizes = cerberus::rescaling(type, data);
  const CerberusCameraMotion* carried = CerberusCameraMotionCarried::peek(from);
  if (!sizes || !carried) return FALSE;
  CerberusCameraMotion motion = *carried;
  if (sizes->from != sizes->to) {
    scale(motion.matrix, *sizes);
    scale(motion.path, *sizes);
    motion.residual *=
        std::sqrt(static_cast<double>(sizes->to.area()) / static_cast<double>(sizes->from.area()));
  }
  return CerberusCameraMotionCarried::set(to, &motion);
}

}  // namespace

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
