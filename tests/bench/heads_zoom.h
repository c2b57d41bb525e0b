// SPDX-License-Identifier: LGPL-2.1-or-later
// keep-size before simulated heads whose cameras have a zoom: what size a person has that comes and goes.
#pragma once

#include "asked.h"

namespace cerberus::bench {

void print_zoom(Asked& asked, int seeds);

}  // namespace cerberus::bench
