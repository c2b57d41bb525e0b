// SPDX-License-Identifier: LGPL-2.1-or-later
// The driver onvif.
#include "heads/drivers.h"

#if HAVE_ONVIF
#include <cstdio>
#include <utility>

#include "drivers/head/reach.h"
#include "drivers/onvif/discovery.h"
#include "drivers/onvif/onvif_head.h"
#include "heads/password.h"
#include "heads/soup_client.h"
#endif

namespace cerberus::heads {

#if HAVE_ONVIF
namespace {

using drivers::number_of;
using drivers::OnvifOptions;
using drivers::OptionWord;

constexpr double kMostSpeed = 3600;  // degrees a second, as of pantiltsink

constexpr char kOptions[] =
    "device, user, password-file, password-env, password-credential, password-text, profile, fingerprint, "
    "range, "
    "pan-speed, tilt-speed, zoom, answer-time, home-preset, home-time, no-feedback, no-absolute, "
    "emergency-stop, invert";

struct Settings {
  OnvifOptions head;
  SoupClientOptions http;
  SecretSource password;
  Around around;
  bool has_device = false, discover = false;
};

constexpr std::chrono::milliseconds kDiscovery{1000};  // the pipeline waits 5 s for a helper, login included

std::string find_camera(Settings& s) {
  std::string wrong, device;
  const auto found = drivers::onvif::discover(kDiscovery, wrong);
  if (wrong.empty()) wrong = drivers::onvif::choose_found(found, !s.http.user.empty(), device);
  return wrong.empty() ? parse_device(device, s.head.login.device) : wrong;
}

// The number of `word`, above 0 and at most `most`.
std::string read_positive(const OptionWord& word, double most, double& number) {
  const auto value = number_of(word.value);
  if (!value || *value <= 0 || *value > most)
    return word.key + " is a number above 0 and at most " + std::to_string(static_cast<int>(most));
  number = *value;
  return {};
}

// "PAN-MIN,PAN-MAX,TILT-MIN,TILT-MAX"
std::string read_range(const std::string& list, drivers::onvif::Mechanics& mechanics) {
  const auto range = drivers::parse_range(list);
  if (!range)
    return "range is four numbers of degrees, PAN-MIN,PAN-MAX,TILT-MIN,TILT-MAX, each MIN below its MAX";
  using sensing::degrees;
  mechanics.least = drivers::onvif::Angles{degrees(range->pan.from), degrees(range->tilt.from)};
  mechanics.most = drivers::onvif::Angles{degrees(range->pan.to), degrees(range->tilt.to)};
  return {};
}

std::string read_number(const OptionWord& word, OnvifOptions& options) {
  if (word.key == "range") return read_range(word.value, options.mechanics);
  if (word.key == "pan-speed") return read_positive(word, kMostSpeed, options.mechanics.full_speed.pan);
  if (word.key == "tilt-speed") return read_positive(word, kMostSpeed, options.mechanics.full_speed.tilt);
  if (word.key == "home-time") {
    double seconds = 0;
    std::string wrong = read_positive(word, 100, seconds);
    options.home_time = std::chrono::milliseconds(static_cast<int>(seconds * 1000));
    return wrong;
  }
  if (word.key == "zoom") {
    const auto position = number_of(word.value);
    if (!position || *position < 0 || *position > 1)
      return "zoom=" + word.value + ": 0 to 1, the position of the lens to keep (lock-zoom)";
    options.login.zoom = *position;
    return {};
  }
  const auto milliseconds = number_of(word.value);
  if (!milliseconds || *milliseconds < 100 || *milliseconds > 10000)
    return "answer-time is 100 to 10000 milliseconds";
  options.answer_time = std::chrono::milliseconds(static_cast<int>(*milliseconds));
  return {};
}

// The value of an unknown word is not repeated: it may be a password.
std::string read_word(const OptionWord& word, Settings& s) {
  const auto& [key, value, has_value] = word;
  if (key == "device") {
    s.has_device = true;
    s.discover = value == "discover";
    if (s.discover) return {};
    return parse_device(value, s.head.login.device);
  }
  if (key == "range" || key == "pan-speed" || key == "tilt-speed" || key == "answer-time" ||
      key == "home-time" || key == "zoom")
    return read_number(word, s.head);
  std::string* const text = key == "user"                  ? &s.http.user
                            : key == "password-file"       ? &s.password.file
                            : key == "password-env"        ? &s.password.environment
                            : key == "password-credential" ? &s.password.credential
                            : key == "profile"             ? &s.head.login.profile
                            : key == "home-preset"         ? &s.head.login.preset
                            : key == "emergency-stop"      ? &s.around.emergency_stop
                                                           : nullptr;
  if (text) {
    *text = value;
    return value.empty() ? key + " needs a value" : "";
  }
  if (key == "invert") return drivers::parse_inverted(word, s.around.inverted);
  if (key == "fingerprint") {
    s.http.fingerprint = normal_fingerprint(value);
    return s.http.fingerprint.empty() ? "fingerprint is a SHA-256 sum of 64 hexadecimal digits" : "";
  }
  if (key == "password-text")
    s.head.login.password_text = s.http.password_text = true;
  else if (key == "no-feedback")
    s.head.feedback = s.head.absolute = false;
  else if (key == "no-absolute")
    s.head.absolute = false;
  else
    return "\"" + key + "\" is no option of onvif: " + kOptions;
  return has_value ? key + " takes no value" : "";
}

std::string read_words(const std::vector<OptionWord>& words, Settings& s) {
  for (const OptionWord& word : words)
    if (std::string wrong = read_word(word, s); !wrong.empty()) return wrong;
  if (!s.has_device) return "onvif needs a camera (device=http://HOST)";
  if (!s.http.fingerprint.empty() && !s.head.login.device.encrypted)
    return "fingerprint needs an encrypted connection: write device=https://HOST";
  s.head.home = s.head.login.preset == "home";
  if (s.head.home) s.head.login.preset.clear();
  std::string wrong = read_password(s.password, s.http.password);
  if (wrong.empty() && s.http.user.empty() && !s.http.password.empty())
    return "a password needs a user: give user=";
  return wrong.empty() && s.discover ? find_camera(s) : wrong;
}

}  // namespace

int run_onvif(const std::vector<OptionWord>& words) {
  Settings settings;
  if (const std::string wrong = read_words(words, settings); !wrong.empty()) return fail(wrong);
  settings.head.warn = warn;
  drivers::OnvifHead head(std::make_unique<SoupClient>(std::move(settings.http)), std::move(settings.head));
  return serve(head, settings.around);
}

#else

int run_onvif(const std::vector<drivers::OptionWord>&) {
  return fail("onvif needs libsoup 3 and libxml2, which this build was made without");
}

#endif

}  // namespace cerberus::heads
