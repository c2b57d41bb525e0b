// SPDX-License-Identifier: LGPL-2.1-or-later
// The enumerations of the corridor's properties. Where lib/vision has the same one the numbers are the same, so that an
// element only casts.
#pragma once

#include <glib-object.h>

namespace cerberus::plugin {

enum KeepPlanes { KEEP_PLANES_AUTO, KEEP_PLANES_ALWAYS, KEEP_PLANES_NEVER };
enum Preset { PRESET_DEFAULT, PRESET_PAPER, PRESET_TRAFFIC };

GType motion_model_type();
GType weighting_type();
GType extremes_type();
GType area_type();
GType keep_planes_type();
GType preset_type();

}  // namespace cerberus::plugin
