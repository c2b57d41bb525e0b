// SPDX-License-Identifier: LGPL-2.1-or-later
#include "enums.hpp"

#include "vision/background/foreground_mask.h"
#include "vision/change/fuzzy_threshold.h"
#include "vision/ego_motion/camera_motion.h"

namespace cerberus::plugin {
namespace {

// A type is registered once a process, by whichever thread asks first (C++ static initialisation).
GType register_enum(const char* name, const GEnumValue* values) {
  return g_enum_register_static(name, values);
}

template <typename E>
constexpr int number(E value) {
  return static_cast<int>(value);
}

}  // namespace

GType motion_model_type() {
  using vision::MotionModel;
  static const GEnumValue values[] = {
      {number(MotionModel::none), "The camera stands still", "none"},
      {number(MotionModel::translation), "Shift only", "translation"},
      {number(MotionModel::similarity),
       "Shift, rotation and zoom, and the bend and shear of a turning camera's picture", "similarity"},
      {number(MotionModel::affine), "Similarity with shear", "affine"},
      {number(MotionModel::homography), "Full perspective of a plane or a turning camera", "homography"},
      {0, nullptr, nullptr}};
  static const GType type = register_enum("CerberusMotionModel", values);
  return type;
}

GType weighting_type() {
  using vision::Weighting;
  static const GEnumValue values[] = {
      {number(Weighting::linear), "Counts of the histogram as they are", "linear"},
      {number(Weighting::log), "Logarithm of the counts", "log"},
      {0, nullptr, nullptr}};
  static const GType type = register_enum("CerberusWeighting", values);
  return type;
}

GType extremes_type() {
  using vision::Extremes;
  static const GEnumValue values[] = {
      {number(Extremes::subset), "Lowest and highest level of the subset", "subset"},
      {number(Extremes::image), "Lowest and highest level of the whole picture", "image"},
      {0, nullptr, nullptr}};
  static const GType type = register_enum("CerberusExtremes", values);
  return type;
}

GType area_type() {
  using vision::Area;
  static const GEnumValue values[] = {
      {number(Area::leading), "M(k), what the object newly covers", "leading"},
      {number(Area::common), "M(k-1), where the object was one frame ago", "common"},
      {number(Area::all), "D(k), all that changed since the last frame", "all"},
      {0, nullptr, nullptr}};
  static const GType type = register_enum("CerberusArea", values);
  return type;
}

GType keep_planes_type() {
  static const GEnumValue values[] = {
      {KEEP_PLANES_AUTO, "Only when an element downstream requests it", "auto"},
      {KEEP_PLANES_ALWAYS, "Leave it on the buffers", "always"},
      {KEEP_PLANES_NEVER, "Remove it always", "never"},
      {0, nullptr, nullptr}};
  static const GType type = register_enum("CerberusKeepPlanes", values);
  return type;
}

GType preset_type() {
  static const GEnumValue values[] = {
      {PRESET_DEFAULT, "Best masks and boxes for people, from a camera that may turn", "default"},
      {PRESET_PAPER, "The paper's method: three frames, threshold by fuzziness alone", "paper"},
      {PRESET_TRAFFIC, "Vehicles: no human gate, no person heights", "traffic"},
      {0, nullptr, nullptr}};
  static const GType type = register_enum("CerberusPreset", values);
  return type;
}

}  // namespace cerberus::plugin
