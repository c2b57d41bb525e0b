// SPDX-License-Identifier: LGPL-2.1-or-later
// cerberus-head: the helper process that drives a real head for pantiltsink. It reads the line protocol
// (docs/manual/head-protocol.md) from its standard input. It lives on when the pipeline is killed, for as long as it
// takes to stop the head.
#include <glib-unix.h>
#include <glib.h>

#include <csignal>
#include <memory>
#include <string>
#include <vector>

#include "drivers/helper/helper_loop.h"
#include "drivers/pelco/pelco_head.h"
#include "drivers/visca/visca_head.h"
#include "heads/drivers.h"

namespace {

using namespace cerberus::drivers;
namespace heads = cerberus::heads;

struct Options {
  gchar* device = nullptr;
  gint baud = 0, address = 1;
  gboolean no_header = FALSE, no_feedback = FALSE, feedback = FALSE;
  gdouble pan_speed = PelcoOptions{}.pan_speed, tilt_speed = PelcoOptions{}.tilt_speed;
  gdouble zoom = ViscaOptions{}.zoom;
  gint home_preset = 0;
  gdouble home_time = PelcoOptions{}.home_time;
  gchar* speeds = nullptr;
  gchar* emergency_stop = nullptr;
};

using heads::fail;

int run_visca(const Options& o) {
  ViscaOptions options;
  options.device = o.device;
  if (o.baud != 0) options.baud = o.baud;
  options.address = o.address;
  options.header = !o.no_header;
  options.feedback = !o.no_feedback;
  options.zoom = o.zoom;
  if (o.zoom != ViscaOptions{}.zoom && !(o.zoom >= 0))
    return fail("--zoom is a position of the zoom, 0 to 1.92");
  if (o.speeds)
    if (const std::string wrong = visca::parse_speed_table(o.speeds, options.speeds); !wrong.empty())
      return fail(wrong);
  ViscaHead head(options);
  return heads::serve(head, o.emergency_stop ? o.emergency_stop : "");
}

int run_pelco(const Options& o) {
  PelcoOptions options;
  options.device = o.device;
  if (o.baud != 0) options.baud = o.baud;
  options.address = o.address;
  options.feedback = o.feedback;
  options.pan_speed = o.pan_speed;
  options.tilt_speed = o.tilt_speed;
  options.home_preset = o.home_preset;
  options.home_time = o.home_time;
  PelcoHead head(options);
  return heads::serve(head, o.emergency_stop ? o.emergency_stop : "");
}

// Returns why the options do not fit the driver: an option of the other one would be ignored otherwise.
std::string misplaced_option(const Options& o, const std::string& driver) {
  const PelcoOptions pelco;
  const struct {
    const char* name;
    bool given;
    const char* driver;
  } own[] = {{"no-header", o.no_header != FALSE, "visca"},
             {"no-feedback", o.no_feedback != FALSE, "visca"},
             {"zoom", o.zoom != ViscaOptions{}.zoom, "visca"},
             {"speeds", o.speeds != nullptr, "visca"},
             {"feedback", o.feedback != FALSE, "pelco-d"},
             {"pan-speed", o.pan_speed != pelco.pan_speed, "pelco-d"},
             {"tilt-speed", o.tilt_speed != pelco.tilt_speed, "pelco-d"},
             {"home-preset", o.home_preset != 0, "pelco-d"},
             {"home-time", o.home_time != pelco.home_time, "pelco-d"}};
  for (const auto& option : own)
    if (option.given && driver != option.driver)
      return std::string("\"") + option.name + "\" is no option of " + driver + ", but of " + option.driver;
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  // The end of the input stops the head and ends the program. A signal meant for the pipeline must not end it before.
  for (const int number : {SIGINT, SIGHUP, SIGTERM, SIGPIPE}) std::signal(number, SIG_IGN);
  if (const heads::Run run = heads::find_driver(argc > 1 ? argv[1] : "")) {
    std::vector<OptionWord> words;
    for (int i = 2; i < argc; ++i) words.push_back(option_word(argv[i]));
    return run(words);
  }
  Options o;
  const GOptionEntry entries[] = {
      {"device", 0, 0, G_OPTION_ARG_STRING, &o.device, "serial:/dev/ttyUSB0, udp:HOST:PORT or tcp:HOST:PORT",
       "DEVICE"},
      {"baud", 0, 0, G_OPTION_ARG_INT, &o.baud, "Baud rate of a serial port (visca 9600, pelco-d 2400)", "N"},
      {"address", 0, 0, G_OPTION_ARG_INT, &o.address, "Address on a serial line (1)", "N"},
      {"no-header", 0, 0, G_OPTION_ARG_NONE, &o.no_header, "UDP without the header of VISCA over IP",
       nullptr},
      {"no-feedback", 0, 0, G_OPTION_ARG_NONE, &o.no_feedback, "Do not ask the camera for its position",
       nullptr},
      {"zoom", 0, 0, G_OPTION_ARG_DOUBLE, &o.zoom, "Position of a VISCA camera's zoom to keep, 0 to 1.92",
       "N"},
      {"feedback", 0, 0, G_OPTION_ARG_NONE, &o.feedback, "Ask a Pelco-D head for its position", nullptr},
      {"pan-speed", 0, 0, G_OPTION_ARG_DOUBLE, &o.pan_speed,
       "Degrees a second of a Pelco-D head's fastest pan (40)", "N"},
      {"tilt-speed", 0, 0, G_OPTION_ARG_DOUBLE, &o.tilt_speed, "Degrees a second of its fastest tilt (20)",
       "N"},
      {"home-preset", 0, 0, G_OPTION_ARG_INT, &o.home_preset,
       "Preset of a Pelco-D head that looks straight ahead, its reference (none)", "N"},
      {"home-time", 0, 0, G_OPTION_ARG_DOUBLE, &o.home_time, "Seconds that it takes to go there at most (10)",
       "N"},
      {"speeds", 0, 0, G_OPTION_ARG_STRING, &o.speeds,
       "Speeds of a VISCA camera's steps 0, 1, 2 ... in degrees a second: \"PAN PAN ...; TILT TILT ...\"",
       "TABLE"},
      {"emergency-stop", 0, 0, G_OPTION_ARG_STRING, &o.emergency_stop,
       "A normally closed contact that releases the motors", "CHIP:LINE"},
      {nullptr, 0, 0, G_OPTION_ARG_NONE, nullptr, nullptr, nullptr}};
  const std::unique_ptr<GOptionContext, decltype(&g_option_context_free)> context(
      g_option_context_new("DRIVER"), g_option_context_free);
  g_option_context_set_summary(context.get(),
                               "Drives a pan-tilt head for pantiltsink. Drivers: visca, pelco-d, onvif, "
                               "stepper-gpio, servo-pwm, v4l2.");
  g_option_context_add_main_entries(context.get(), entries, nullptr);
  GError* error = nullptr;
  if (!g_option_context_parse(context.get(), &argc, &argv, &error)) {
    const std::string text = error->message;
    g_error_free(error);
    return fail(text);
  }
  const std::string driver = argc == 2 ? argv[1] : "";
  if (driver != "visca" && driver != "pelco-d")
    return fail("there is no head driver \"" + driver +
                "\": take visca, pelco-d, onvif, stepper-gpio, servo-pwm or v4l2");
  if (!o.device) return fail("the driver " + driver + " needs --device");
  if (const std::string wrong = misplaced_option(o, driver); !wrong.empty()) return fail(wrong);
  return driver == "visca" ? run_visca(o) : run_pelco(o);
}
