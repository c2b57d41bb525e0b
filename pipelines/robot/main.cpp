// SPDX-License-Identifier: LGPL-2.1-or-later
// cerberusd: a whole robot from one configuration file, documented in docs/manual/robot.md.
#include <gst/gst.h>

#include <cstdio>
#include <filesystem>
#include <string>

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
  gboolean check = FALSE;
  const GOptionEntry options[] = {{"check", 0, 0, G_OPTION_ARG_NONE, &check,
                                   "Explain every mistake of FILE with its line, and run nothing", nullptr},
                                  {nullptr, 0, 0, G_OPTION_ARG_NONE, nullptr, nullptr, nullptr}};
  g_autoptr(GOptionContext) context = g_option_context_new("FILE");
  g_option_context_set_summary(context, "Runs the robot that FILE describes (docs/manual/robot.md).");
  g_option_context_add_main_entries(context, options, nullptr);
  g_option_context_add_group(context, gst_init_get_option_group());
  g_autoptr(GError) error = nullptr;
  if (!g_option_context_parse(context, &argc, &argv, &error) || argc != 2) {
    std::fprintf(stderr, "cerberusd: %s\n", error ? error->message : "which FILE? (cerberusd --help)");
    return 2;
  }
  find_elements();
  const auto load = [path = std::string(argv[1])](std::string* lacks) {
    const gchar* credentials = g_getenv("CREDENTIALS_DIRECTORY");
    cerberus::robot::SettingsFile file = cerberus::robot::load_settings(path, credentials ? credentials : "");
    if (!file.settings) return file;
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
