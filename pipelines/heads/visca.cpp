// SPDX-License-Identifier: LGPL-2.1-or-later
// The driver visca.
#include "drivers/visca/visca_head.h"

#include <limits>

#include "heads/drivers.h"

namespace cerberus::heads {
#if HAVE_VISCA
namespace {

std::string read_speeds(const drivers::OptionWord& word, drivers::visca::SpeedTable& table) {
  const std::string wrong = drivers::visca::parse_speed_table(word.value, table);
  return wrong.empty() ? wrong : "speeds=" + word.value + ": " + wrong;
}

std::string read_word(const drivers::OptionWord& word, drivers::ViscaOptions& options) {
  const std::string& key = word.key;
  if (key == "baud") return read_whole(word, 1, 1000000, options.baud);
  if (key == "address") return read_whole(word, 1, 7, options.address);
  if (key == "zoom") return read_number(word, 0, 1000, options.zoom);  // the head knows its lens
  if (key == "speeds") return read_speeds(word, options.speeds);
  if (key == "sequence") {
    int number = 0;
    const std::string wrong = read_whole(word, 0, std::numeric_limits<int>::max(), number);
    options.sequence = static_cast<std::uint32_t>(number);
    return wrong;
  }
  if (key == "no-header")
    options.header = false;
  else if (key == "no-feedback")
    options.feedback = false;
  else
    return "\"" + key +
           "\" is no option of visca: device, baud, address, speeds, no-header, sequence, no-feedback, zoom, "
           "emergency-stop, invert";
  return word.has_value ? key + " takes no value" : "";
}

}  // namespace

int run_visca(const std::vector<drivers::OptionWord>& words) {
  drivers::ViscaOptions options;
  Around around;
  if (const std::string wrong = read_words(words, options, around, read_word); !wrong.empty())
    return fail(wrong);
  if (options.device.empty()) return fail("visca needs a camera (device=serial:/dev/ttyUSB0)");
  if (options.sequence && (!options.header || !options.device.starts_with("udp:")))
    return fail(
        "sequence= is the number in the header of VISCA over IP: it is for device=udp:HOST:PORT, and not "
        "beside no-header");
  options.warn = warn;
  drivers::ViscaHead head(options);
  return serve(head, around);
}
#else
int run_visca(const std::vector<drivers::OptionWord>&) {
  return fail("visca was left out of this build");
}
#endif

}  // namespace cerberus::heads
