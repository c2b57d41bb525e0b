// SPDX-License-Identifier: LGPL-2.1-or-later
// The types that motiondetect is made of: it takes their properties over.
#pragma once

#include <glib-object.h>

namespace cerberus::plugin {

GType cameramotion_get_type();
GType threeframediff_get_type();
GType fuzzythreshold_get_type();
GType motionregions_get_type();
GType motiontrack_get_type();

}  // namespace cerberus::plugin
