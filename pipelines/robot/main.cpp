// SPDX-License-Identifier: LGPL-2.1-or-later
// cerberusd: a whole robot from one configuration file, documented in docs/manual/robot.md.
#include <gst/gst.h>

#include <cstdio>
#include <filesystem>
#include <string>

#if HAVE_PAGE
#include "device_tokens.h"
#endif
#include "encoder_choice.h"
#include "persons_choice.h"
#include "robot.h"
#include "robot/settings_file.h"
#include "settings_trial.h"

namespace {

constexpr int kWrongConfiguration = 78;  // EX_CONFIG of sysexits.h: its unit does not start the program again

// A program that was not installed finds the elements of its own build; one that was installed where GStreamer does not
// look finds those that were installed with it.
void find_elements() {
  g_autoptr(GstElementFactory) there = gst_element_factory_find("motiondetect");
  if (there) return;
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  std::filesystem::path plugins = program.parent_path().parent_path() / "plugins";
  if (error || !std::filesystem::is_directory(plugins, error)) plugins = CERBERUS_PLUGINS;
  if (std::filesystem::is_directory(plugins, error))
    gst_registry_scan_path(gst_registry_get(), plugins.c_str());
}

}  // namespace

int main(int argc, char** argv) {
  gboolean check = FALSE, version = FALSE, make_device = FALSE, list_devices = FALSE;
  g_autofree gchar *device = nullptr, *role = nullptr, *revoke = nullptr;
  const GOptionEntry options[] = {
      {"check", 0, 0, G_OPTION_ARG_NONE, &check,
       "Explain every mistake of FILE with its line, and run nothing", nullptr},
      {"version", 0, 0, G_OPTION_ARG_NONE, &version, "Print the version", nullptr},
      {"make-device-token", 0, 0, G_OPTION_ARG_NONE, &make_device,
       "Make a token by which a device sees the page of FILE without a password, and print it once", nullptr},
      {"device", 0, 0, G_OPTION_ARG_STRING, &device, "Name of that device (kiosk)", "NAME"},
      {"role", 0, 0, G_OPTION_ARG_STRING, &role, "Its role: viewer or operator (viewer)", "ROLE"},
      {"revoke-device", 0, 0, G_OPTION_ARG_STRING, &revoke, "Let a device in no more, from now on", "NAME"},
      {"list-devices", 0, 0, G_OPTION_ARG_NONE, &list_devices, "Print the devices and their roles", nullptr},
      {nullptr, 0, 0, G_OPTION_ARG_NONE, nullptr, nullptr, nullptr}};
  g_autoptr(GOptionContext) context = g_option_context_new("FILE");
  g_option_context_set_summary(context, "Runs the robot that FILE describes (docs/manual/robot.md).");
  g_option_context_add_main_entries(context, options, nullptr);
  g_option_context_add_group(context, gst_init_get_option_group());
  g_autoptr(GError) error = nullptr;
  const bool parsed = g_option_context_parse(context, &argc, &argv, &error);
  if (parsed && version) {
    std::printf("cerberusd %s\n", CERBERUS_VERSION);
    return 0;
  }
  if (!parsed || argc != 2) {
    std::fprintf(stderr, "cerberusd: %s\n", error ? error->message : "which FILE? (cerberusd --help)");
    return 2;
  }
  if (make_device || revoke || list_devices) {
    const gchar* credentials = g_getenv("CREDENTIALS_DIRECTORY");
    const auto file = cerberus::robot::load_settings(argv[1], credentials ? credentials : "");
    if (!file.settings) {
      std::fprintf(stderr, "%s\n", file.errors.c_str());
      return kWrongConfiguration;
    }
#if HAVE_PAGE
    if (make_device)
      return cerberus::robot::make_device_token(*file.settings, device ? device : "kiosk",
                                                role ? role : "viewer");
    return revoke ? cerberus::robot::revoke_device(*file.settings, revoke)
                  : cerberus::robot::list_devices(*file.settings);
#else
    std::fprintf(stderr, "cerberusd: this build has no page (it needs libsoup 3 and libargon2)\n");
    return 1;
#endif
  }
  find_elements();
  const auto load = [path = std::string(argv[1])](std::string* lacks) {
    const gchar* credentials = g_getenv("CREDENTIALS_DIRECTORY");
    cerberus::robot::SettingsFile file = cerberus::robot::load_settings(path, credentials ? credentials : "");
    if (!file.settings) return file;
    cerberus::robot::choose_encoders(*file.settings);
    cerberus::robot::choose_persons(*file.settings);
    cerberus::robot::Trial trial = cerberus::robot::try_settings(*file.settings);
    if (lacks != nullptr) *lacks = cerberus::robot::describe(std::move(trial.lacks), path);
    if (trial.mistakes.empty()) return file;
    return cerberus::robot::SettingsFile{std::nullopt,
                                         cerberus::robot::describe(std::move(trial.mistakes), path)};
  };
  std::string lacks;
  cerberus::robot::SettingsFile file = load(check ? &lacks : nullptr);
  const std::string wrong = file.errors + (file.errors.empty() || lacks.empty() ? "" : "\n") + lacks;
  if (!file.settings || !lacks.empty()) {
    std::fprintf(stderr, "%s\n", wrong.c_str());
    return check ? 1 : kWrongConfiguration;
  }
  if (check) {
    std::printf("%s: no mistake\n", argv[1]);
    return 0;
  }
  // What other threads hand to the main loop is never run by them, also before it runs.
  g_main_context_acquire(nullptr);
  cerberus::robot::Robot robot([load] { return load(nullptr); });
  std::string fault;
  if (!robot.open(*std::move(file.settings), fault)) {
    std::fprintf(stderr, "cerberusd: %s\n", fault.c_str());
    return 1;
  }
  return robot.run();
}
