// SPDX-License-Identifier: LGPL-2.1-or-later
#include "device_tokens.h"

#include <gio/gio.h>
#include <glib/gstdio.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>

#include "robot/page/passwords.h"
#include "settings_trial.h"
#include "text/file.h"

namespace cerberus::robot {

namespace {

constexpr std::size_t kMostBytes = 16384;  // of the file: 64 lines of the longest names

std::string folder_of(const Settings& settings) {
  return settings.state_folder.empty() ? default_state_folder() : settings.state_folder;
}

int fail(const std::string& text) {
  std::fprintf(stderr, "cerberusd: %s\n", text.c_str());
  return 1;
}

// The file belongs to the folder's owner, as whom the robot runs: an administrator may call this as root. That owner may put
// a link in the place of the file, and is given no other file by it.
bool save(const std::string& folder, const Devices& devices, std::string& error) {
  if (g_mkdir_with_parents(folder.c_str(), 0700) != 0) {
    error = folder + " cannot be made: " + g_strerror(errno);
    return false;
  }
  const std::string path = path_of_devices(folder), text = devices.state();
  g_autoptr(GError) fault = nullptr;
  const auto how =
      static_cast<GFileSetContentsFlags>(G_FILE_SET_CONTENTS_CONSISTENT | G_FILE_SET_CONTENTS_DURABLE);
  if (!g_file_set_contents_full(path.c_str(), text.data(), static_cast<gssize>(text.size()), how, 0600,
                                &fault)) {
    error = fault->message;
    return false;
  }
  GStatBuf about{};
  if (::geteuid() == 0 && g_stat(folder.c_str(), &about) == 0 &&
      ::lchown(path.c_str(), about.st_uid, about.st_gid) != 0) {
    error = path + " cannot be given to the folder's owner: " + g_strerror(errno);
    return false;
  }
  return true;
}

}  // namespace

std::string path_of_devices(const std::string& state_folder) {
  return state_folder + "/devices";
}

std::string hash_of_token(const std::string& token) {
  g_autofree gchar* hash = g_compute_checksum_for_data(
      G_CHECKSUM_SHA256, reinterpret_cast<const guchar*>(token.data()), token.size());
  return hash;
}

bool load_devices(const std::string& state_folder, Devices& devices, std::string& error) {
  const std::string path = path_of_devices(state_folder);
  const text::File file = text::read_file(path, kMostBytes);
  if (file.fault == text::File::Fault::failed && file.error == ENOENT) {
    devices = {};
    return true;
  }
  if (file.fault == text::File::Fault::none && devices.restore(file.text)) return true;
  devices = {};
  error = path + " is no list of devices: remove it, and make their tokens anew";
  return false;
}

int make_device_token(const Settings& settings, const std::string& name, const std::string& role) {
  const std::string folder = folder_of(settings);
  Devices devices;
  std::string error;
  if (!load_devices(folder, devices, error)) return fail(error);
  const Role as = role_of(role).value_or(Role::none);
  if (const std::string wrong = devices.fault_of(name, as); !wrong.empty()) return fail(wrong);
  const std::string token = random_token();
  if (token.empty()) return fail("the system gives no random numbers");
  devices.add(name, as, hash_of_token(token));
  if (!save(folder, devices, error)) return fail(error);
  const PageSettings& page = settings.page;
  const bool everywhere = page.listen == "0.0.0.0" || page.listen == "::";
  const std::string host = everywhere                                  ? "127.0.0.1"
                           : page.listen.find(':') != page.listen.npos ? '[' + page.listen + ']'
                                                                       : page.listen;
  std::printf(
      "Token of the device \"%s\" (%s), which is shown only here:\n%s\n"
      "Open this once in its browser:\n%s://%s:%d/#device=%s\n",
      name.c_str(), role.c_str(), token.c_str(), page.tls ? "https" : "http", host.c_str(), page.port,
      token.c_str());
  return 0;
}

int revoke_device(const Settings& settings, const std::string& name) {
  const std::string folder = folder_of(settings);
  Devices devices;
  std::string error;
  if (!load_devices(folder, devices, error)) return fail(error);
  if (!devices.revoke(name)) return fail("there is no device \"" + name + "\" (--list-devices)");
  if (!save(folder, devices, error)) return fail(error);
  std::printf("The device \"%s\" is let in no more.\n", name.c_str());
  return 0;
}

int list_devices(const Settings& settings) {
  Devices devices;
  std::string error;
  if (!load_devices(folder_of(settings), devices, error)) return fail(error);
  for (const Device& device : devices.all())
    std::printf("%s (%s)\n", device.name.c_str(), std::string(robot::name(device.role)).c_str());
  return 0;
}

}  // namespace cerberus::robot
