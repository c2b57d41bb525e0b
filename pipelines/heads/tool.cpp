// SPDX-License-Identifier: LGPL-2.1-or-later
#include "heads/tool.h"

#include <gst/gst.h>
#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <memory>
#include <utility>

#include "control/trials/move_check.h"
#include "drivers/helper/option_words.h"
#include "heads/head_link.h"
#include "sensing/angles.h"

namespace cerberus::heads {
namespace {

termios usual;  // of the terminal, before the first Keys

bool has_input() {
  pollfd wait{STDIN_FILENO, POLLIN, 0};
  return ::poll(&wait, 1, 0) == 1 && (wait.revents & POLLIN);
}

}  // namespace

Keys::Keys() : terminal_(::isatty(STDIN_FILENO) && ::tcgetattr(STDIN_FILENO, &usual) == 0) {
  if (!terminal_) return;
  termios mode = usual;
  mode.c_lflag &= ~static_cast<tcflag_t>(ICANON | ECHO);
  ::tcsetattr(STDIN_FILENO, TCSANOW, &mode);
}

Keys::~Keys() {
  if (terminal_) ::tcsetattr(STDIN_FILENO, TCSANOW, &usual);
}

bool Keys::pressed() {
  return terminal_ && has_input();
}

void Keys::clear() {
  if (terminal_) ::tcflush(STDIN_FILENO, TCIFLUSH);
}

bool Keys::ask(const std::string& text) {
  std::printf("%s\nPress Enter to begin; the first key then ends it. ", text.c_str());
  std::fflush(stdout);
  char key = 0;
  const bool go = ::read(STDIN_FILENO, &key, 1) == 1 && (key == '\n' || key == ' ');
  std::printf("\n");
  return go;
}

int move_head(const ToolOptions& options) {
  char text[200];
  std::snprintf(text, sizeof text,
                "The head will turn at %g degrees a second to the right and %g up, for %g s.", options.pan,
                options.tilt, options.seconds);
  if (!options.yes && !Keys::ask(text)) return 1;
  HeadLink link;
  std::string wrong = link.start(options.driver, options.setup);
  Keys keys;
  if (wrong.empty() && !link.abilities().velocity) wrong = "the head does not turn at speeds";
  if (wrong.empty()) link.turn(sensing::radians(options.pan), sensing::radians(options.tilt));
  control::MoveCheck check(options.setup.limits,
                           {sensing::radians(options.pan), sensing::radians(options.tilt)},
                           motion::seconds(options.setup.latency));
  bool goes_on = true;
  for (const double end = now_seconds() + options.seconds;
       wrong.empty() && goes_on && now_seconds() < end && !keys.pressed();) {
    wrong = link.serve(20);
    const auto pose = std::exchange(link.pose, std::nullopt);
    if (!pose || !wrong.empty()) continue;
    std::printf("pan %.2f tilt %.2f\n", sensing::degrees(pose->pan.position),
                sensing::degrees(pose->tilt.position));
    const double time = now_seconds() - pose->age;
    goes_on = check.add(motion::Time(static_cast<motion::Time::rep>(time * 1e9)),
                        {pose->pan.position, pose->tilt.position});
    wrong = check.fault();
    if (!goes_on && wrong.empty()) std::printf("stopped at the limits\n");
  }
  if (const std::string end = link.finish(); wrong.empty()) wrong = end;
  if (!wrong.empty()) std::fprintf(stderr, "cerberus-heads: %s\n", wrong.c_str());
  return wrong.empty() ? 0 : 1;
}

}  // namespace cerberus::heads

namespace {

using cerberus::heads::ToolOptions;
using cerberus::sensing::radians;

constexpr char kSummary[] =
    "Commands:\n"
    "  list [DEVICE ...]   heads of this machine and ONVIF cameras of this network; a serial port is asked "
    "(VISCA) only if it is named\n"
    "  move DRIVER         turns a head: --pan and --tilt in degrees a second, for --seconds\n"
    "  calibrate DRIVER    measures a head through its camera (--source, --horizontal-fov) into --output\n"
    "Drivers: visca, pelco-d, onvif, stepper-gpio, servo-pwm, v4l2, external.";

// The helper beside this program, or the installed one.
std::string helper_program(const char* self) {
  if (const char* named = g_getenv("CERBERUS_HEAD"); named && *named) return named;
  g_autofree gchar* path = g_file_read_link("/proc/self/exe", nullptr);
  g_autofree gchar* folder = g_path_get_dirname(path ? path : self);
  g_autofree gchar* beside = g_build_filename(folder, "cerberus-head", nullptr);
  return g_file_test(beside, G_FILE_TEST_IS_EXECUTABLE) ? beside : CERBERUS_LIBEXEC "/cerberus-head";
}

int usage(const char* text) {
  std::fprintf(stderr, "cerberus-heads: %s (--help says more)\n", text);
  return 2;
}

std::string read_limits(const char* text, cerberus::motion::Limits& head) {
  std::vector<double> degrees;
  for (const std::string& part : cerberus::drivers::comma_list(text))
    if (const auto number = cerberus::drivers::number_of(part)) degrees.push_back(*number);
  if (degrees.size() != 4 || std::ranges::count(std::string_view(text), ',') != 3)
    return std::string("--limits=") + text +
           ": four numbers of degrees, PAN-MIN,PAN-MAX,TILT-MIN,TILT-MAX (-60,60,-20,20)";
  head.pan = {radians(degrees[0]), radians(degrees[1])};
  head.tilt = {radians(degrees[2]), radians(degrees[3])};
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  g_autofree gchar *device = nullptr, *words = nullptr, *command = nullptr, *limits = nullptr,
                   *source = nullptr, *output = nullptr;
  gdouble pan = 0, tilt = 0, seconds = 1, fov = 0;
  gboolean yes = FALSE, version = FALSE;
  const GOptionEntry entries[] = {
      {"device", 0, 0, G_OPTION_ARG_STRING, &device, "As of pantiltsink", "DEVICE"},
      {"device-options", 0, 0, G_OPTION_ARG_STRING, &words, "As of pantiltsink", "WORDS"},
      {"command", 0, 0, G_OPTION_ARG_STRING, &command, "The helper of the driver external", "COMMAND"},
      {"limits", 0, 0, G_OPTION_ARG_STRING, &limits, "Degrees that the head may turn (-60,60,-20,20)",
       "PAN-MIN,PAN-MAX,TILT-MIN,TILT-MAX"},
      {"pan", 0, 0, G_OPTION_ARG_DOUBLE, &pan, "Degrees a second to the right", "N"},
      {"tilt", 0, 0, G_OPTION_ARG_DOUBLE, &tilt, "Degrees a second up", "N"},
      {"seconds", 0, 0, G_OPTION_ARG_DOUBLE, &seconds, "How long to turn (1)", "N"},
      {"source", 0, 0, G_OPTION_ARG_STRING, &source, "The head's camera (v4l2src ! videoconvert)",
       "LAUNCH-LINE"},
      {"horizontal-fov", 0, 0, G_OPTION_ARG_DOUBLE, &fov, "Degrees that the camera sees over its width", "N"},
      {"output", 'o', 0, G_OPTION_ARG_STRING, &output, "The calibration's file (head.calibration)", "FILE"},
      {"yes", 'y', 0, G_OPTION_ARG_NONE, &yes, "Move without asking", nullptr},
      {"version", 0, 0, G_OPTION_ARG_NONE, &version, "Print the version", nullptr},
      {nullptr, 0, 0, G_OPTION_ARG_NONE, nullptr, nullptr, nullptr}};
  g_autoptr(GOptionContext) context = g_option_context_new("COMMAND");
  g_option_context_set_summary(context, kSummary);
  g_option_context_add_main_entries(context, entries, nullptr);
  g_option_context_add_group(context, gst_init_get_option_group());
  g_autoptr(GError) error = nullptr;
  if (!g_option_context_parse(context, &argc, &argv, &error)) return usage(error->message);
  if (version) {
    std::printf("cerberus-heads %s\n", CERBERUS_VERSION);
    return 0;
  }
  if (argc < 2) return usage("say list, move or calibrate");
  const std::string what = argv[1];
  if (what == "list") return cerberus::heads::list_heads({argv + 2, argv + argc});
  if (what != "move" && what != "calibrate")
    return usage("there is no such command: list, move or calibrate");
  if (argc != 3) return usage("name one driver");
  ToolOptions options;
  options.driver = argv[2];
  options.setup.helper = helper_program(argv[0]);
  options.setup.device = device ? device : "";
  options.setup.options = words ? words : "";
  options.setup.command = command ? command : "";
  if (options.driver == "external" ? !command : !device)
    return usage("name the head: --device, or --command of external");
  auto& head = options.setup.limits;
  if (const std::string wrong = read_limits(limits ? limits : "-60,60,-20,20", head); !wrong.empty())
    return usage(wrong.c_str());
  if (const std::string wrong = cerberus::motion::check(head); !wrong.empty()) return usage(wrong.c_str());
  options.pan = pan;
  options.tilt = tilt;
  options.seconds = seconds;
  if (!(seconds > 0 && seconds <= 60)) return usage("--seconds is up to 60");
  if (source) options.source = source;
  options.horizontal_fov = fov;
  if (output) options.output = output;
  options.yes = yes;
  return what == "move" ? cerberus::heads::move_head(options) : cerberus::heads::calibrate_head(options);
}
