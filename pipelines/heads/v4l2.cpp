// SPDX-License-Identifier: LGPL-2.1-or-later
// The driver v4l2.
#include "heads/drivers.h"
#if HAVE_V4L2
#include "drivers/head/threaded_device.h"
#include "drivers/v4l2/v4l2_controls.h"
#include "drivers/v4l2/v4l2_head.h"
#endif

namespace cerberus::heads {

#if HAVE_V4L2
namespace {

std::string read_word(const drivers::OptionWord& word, drivers::V4l2Options& options) {
  const std::string& key = word.key;
  const std::string given = key + "=" + word.value + ": ";
  const auto number = drivers::number_of(word.value);
  if (key == "mode") {
    const auto mode = drivers::v4l2_mode(word.value);
    if (!mode) return given + "auto, speed, absolute or relative";
    options.mode = *mode;
  } else if (key == "pan-speed" || key == "tilt-speed") {
    if (!number || *number <= 0 || *number > 3600) return given + "degrees a second";
    (key == "pan-speed" ? options.pan_speed : options.tilt_speed) = *number;
  } else if (key == "zoom") {
    if (!number || *number < 0 || *number > 1) return given + "0 to 1 of the zoom's range";
    options.zoom = *number;
  } else {
    return "\"" + key +
           "\" is no option of v4l2: device, mode, pan-speed, tilt-speed, zoom, emergency-stop, invert";
  }
  return {};
}

}  // namespace

int run_v4l2(const std::vector<drivers::OptionWord>& words) {
  drivers::V4l2Options options;
  Around around;
  if (const std::string wrong = read_words(words, options, around, read_word); !wrong.empty())
    return fail(wrong);
  if (options.device.empty()) return fail("v4l2 needs a camera (device=/dev/video0)");
  drivers::ThreadedDevice head(
      std::make_unique<drivers::V4l2Head>(options, std::make_unique<drivers::V4l2Controls>()),
      "the camera " + options.device);
  return serve(head, around);
}
#else
int run_v4l2(const std::vector<drivers::OptionWord>&) {
  return fail("v4l2 was left out of this build");
}
#endif

}  // namespace cerberus::heads
