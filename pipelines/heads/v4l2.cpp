// SPDX-License-Identifier: LGPL-2.1-or-later
// The driver v4l2.
#include "heads/drivers.h"
#if HAVE_V4L2
#include "drivers/v4l2/v4l2_controls.h"
#include "drivers/v4l2/v4l2_head.h"
#endif

namespace cerberus::heads {

int run_v4l2([[maybe_unused]] const std::vector<drivers::OptionWord>& words) {
#if HAVE_V4L2
  drivers::V4l2Options options;
  std::string emergency_stop;
  for (const auto& [key, value, has_value] : words) {
    const auto number = drivers::number_of(value);
    if (key == "device") {
      options.device = value;
    } else if (key == "mode") {
      const auto mode = drivers::v4l2_mode(value);
      if (!mode) return fail("mode=" + value + ": auto, speed, absolute or relative");
      options.mode = *mode;
    } else if (key == "pan-speed" || key == "tilt-speed") {
      if (!number || *number <= 0 || *number > 3600) return fail(key + "=" + value + ": degrees a second");
      (key == "pan-speed" ? options.pan_speed : options.tilt_speed) = *number;
    } else if (key == "zoom") {
      if (!number || *number < 0 || *number > 1)
        return fail("zoom=" + value + ": 0 to 1 of the zoom's range");
      options.zoom = *number;
    } else if (key == "emergency-stop") {
      emergency_stop = value;
    } else {
      return fail("\"" + key +
                  "\" is no option of v4l2: device, mode, pan-speed, tilt-speed, zoom, emergency-stop");
    }
  }
  if (options.device.empty()) return fail("v4l2 needs a camera (device=/dev/video0)");
  drivers::V4l2Head head(options, std::make_unique<drivers::V4l2Controls>());
  return serve(head, emergency_stop);
#else
  return fail("v4l2 was left out of this build");
#endif
}

}  // namespace cerberus::heads
