// SPDX-License-Identifier: LGPL-2.1-or-later
// Sets an element's property by its text.
#pragma once

#include <gst/gst.h>

#include <string>

#include "robot/pipeline_text.h"

namespace cerberus::robot {

// As gst_parse_launch() would, but texts literally, and a value that the property does not take is an error. False: the
// property is as before, and `error` says what is wrong.
bool set_property(GstElement* element, const Assignment& assignment, std::string& error);

}  // namespace cerberus::robot
