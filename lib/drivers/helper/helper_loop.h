// SPDX-License-Identifier: LGPL-2.1-or-later
// The main loop of a helper process: lines in, a head moved, lines out (head_server.h). The head stops at the end of the
// input, after `quit`, and after a silence.
#pragma once

#include "drivers/helper/head_device.h"

namespace cerberus::drivers {

// Serves until the end. in, out: descriptors of the socket. ends: called when the pipeline has ended; the head is then
// stopped. Returns the process's exit status.
int serve_head(int in, int out, HeadDevice& device, void (*ends)() = nullptr);

}  // namespace cerberus::drivers
