// SPDX-License-Identifier: LGPL-2.1-or-later
// The types that motiondetect is made of: it takes their properties over.
#pragma once

#include <glib-object.h>

namespace cerberus::plugin {

GType cameramotion_type();
GType threeframediff_type();
GType fuzzythreshold_type();
GType motionregions_type();
GType motiontrack_type();

}  // namespace cerberus::plugin
