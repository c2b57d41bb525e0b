// SPDX-License-Identifier: LGPL-2.1-or-later
// The error text for a window that does not fit into its picture.
#pragma once

#include <string>

#include "vision/image/image.h"

namespace cerberus::vision {

// One sentence that names both sizes in pixels, and both angles of view in degrees unless `window_fov` is 0 (a pixel of
// the picture is a pixel of the window). Call it where WindowGeometry::fits() is false.
std::string window_misfit(Size picture, double picture_fov, Size window, double window_fov);

}  // namespace cerberus::vision
