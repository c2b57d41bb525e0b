// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/onvif/login.h"

#include <algorithm>
#include <utility>

namespace cerberus::drivers::onvif {
namespace {

constexpr Time kStopTime = std::chrono::milliseconds(500);  // the driver sends Stop again after the login
constexpr int kMostUnreadable =
    5;  // answers to the position inquiry; derived: as OnvifParameters::most_unreadable

}  // namespace

Request zoom_request(const Camera& camera, double position) {
  const Space& space = *camera.options.zoom;
  return absolute_zoom(camera.profile, space.x.from + position * (space.x.to - space.x.from), space.uri);
}

void Login::begin(Time now, Time timeout, bool again) {
  soap_.cancel(id_);
  camera_ = {};
  services_ = {};
  configuration_.clear();
  seen_profiles_.clear();
  other_profiles_.clear();
  first_profile_.clear();
  named_profile_.clear();
  wrong_.clear();
  warning_.clear();
  again_ = again;
  unreadable_ = 0;
  refused_ = false;
  timeout_ = timeout;
  soap_.send_passwords_in_clear(options_.password_text);
  send(Step::clock, now);
}

void Login::fail(std::string why) {
  wrong_ = std::move(why);
  id_ = 0;
}

bool Login::goes_on_without_zoom(std::string why) {
  if (again_)
    warning_ = std::move(why);
  else
    fail(std::move(why));
  return again_;
}

// An address that cannot be read: most cameras serve everything at one path.
Address Login::service(const std::string& claimed) const {
  return reachable(claimed, options_.device).value_or(options_.device);
}

void Login::send(Step step, Time now) {
  step_ = step;
  sent_ = now;
  const auto request = [&]() -> Request {
    switch (step) {
      case Step::clock:
        return get_system_date_and_time();
      case Step::services:
        return get_services();
      case Step::capabilities:
        return get_capabilities();
      case Step::profiles:
        return get_profiles();
      case Step::profiles_media2:
        return get_profiles_media2();
      case Step::nodes:
        return get_nodes();
      case Step::options:
        return get_configuration_options(configuration_);
      case Step::stop:
        return stop(camera_.profile);
      case Step::presets:
        return get_presets(camera_.profile);
      case Step::status:
        return get_status(camera_.profile);
      case Step::zoom:
        break;
    }
    return zoom_request(camera_, options_.zoom);
  };
  const Address to = step <= Step::capabilities      ? options_.device
                     : step == Step::profiles        ? service(services_.media)
                     : step == Step::profiles_media2 ? service(services_.media2)
                                                     : camera_.ptz;
  // The clock is asked for without a token, which the camera could not accept before its clock is known.
  id_ = soap_.send(to, request(), now, step == Step::stop ? std::min(timeout_, kStopTime) : timeout_,
                   step != Step::clock);
}

bool Login::choose(const std::vector<Profile>& profiles) {
  for (const Profile& profile : profiles) {
    const bool named = options_.profile == profile.token || options_.profile == profile.name;
    if (!profile.configuration.empty() && (named || options_.profile.empty())) {
      camera_.profile = profile.token;
      configuration_ = profile.configuration;
      return true;
    }
    if (first_profile_.empty()) first_profile_ = profile.token;
    if (named && named_profile_.empty()) named_profile_ = profile.token;
    std::string& seen = profile.configuration.empty() ? other_profiles_ : seen_profiles_;
    if (!seen.empty()) seen.append(", ");
    seen.append(profile.token);
  }
  return false;
}

void Login::after_services(const SoapAnswer& answer, Time now) {
  services_ = read_services(answer.body);
  if (services_.ptz.empty() && step_ == Step::services) return send(Step::capabilities, now);
  if (services_.ptz.empty()) return fail("has no PTZ service: it cannot pan and tilt");
  camera_.ptz = service(services_.ptz);
  if (services_.media.empty() && services_.media2.empty())
    return fail("has no media service, so no profile to move");
  send(services_.media.empty() ? Step::profiles_media2 : Step::profiles, now);
}

void Login::after_profiles(const SoapAnswer& answer, Time now) {
  if (choose(read_profiles(answer.body))) return send(Step::options, now);
  if (step_ == Step::profiles && !services_.media2.empty()) return send(Step::profiles_media2, now);
  // Some cameras turn without: their nodes say what they offer, where a profile or a node is named.
  if (!options_.profile.empty() && !first_profile_.empty()) return send(Step::nodes, now);
  fail("has no profile with a PTZ configuration: it cannot pan and tilt" +
       (other_profiles_.empty()
            ? std::string()
            : ", or does so without: then name one of its profiles (profile=): " + other_profiles_));
}

void Login::after_nodes(const SoapAnswer& answer, Time now) {
  const std::vector<PtzNode> nodes = read_nodes(answer.body);
  auto node = nodes.begin();
  std::string seen;
  if (named_profile_.empty())
    for (node = nodes.begin();
         node != nodes.end() && node->token != options_.profile && node->name != options_.profile; ++node)
      seen.append(seen.empty() ? "" : ", ").append(node->token);
  const std::string none = "has no profile \"" + options_.profile + "\" that can pan and tilt";
  if (named_profile_.empty() && node == nodes.end())
    return fail(none + "; it has " + (seen_profiles_.empty() ? other_profiles_ : seen_profiles_) +
                (seen.empty() ? "" : ", and the nodes " + seen));
  camera_.profile = named_profile_.empty() ? first_profile_ : named_profile_;
  if (node != nodes.end()) camera_.options = node->options;
  if (!seen_profiles_.empty())
    warning_ = "has no PTZ configuration in the profile \"" + camera_.profile +
               "\", which is used all the same; it has one in " + seen_profiles_;
  after_spaces(answer.good() ? "" : "GetNodes (" + (answer.fault ? answer.fault->text() : answer.wrong) + ")",
               now);
}

void Login::after_options(const SoapAnswer& answer, Time now) {
  camera_.options = read_configuration_options(answer.body).value_or(PtzOptions{});
  after_spaces(answer.good()
                   ? ""
                   : "GetConfigurationOptions (" + (answer.fault ? answer.fault->text() : answer.wrong) + ")",
               now);
}

// unknown: the request that would say what the camera offers and was not answered, for a message; empty: none.
void Login::after_spaces(const std::string& unknown, Time now) {
  if (options_.zoom < 0 || camera_.options.zoom) return send(Step::stop, now);
  const std::string why = unknown.empty()
                              ? "has no absolute zoom in the profile \"" + camera_.profile +
                                    "\": its zoom cannot be kept (lock-zoom). Name another profile "
                                    "(profile=), or set the zoom at the camera"
                              : "does not answer " + unknown +
                                    ", which would say how its zoom is set: it cannot be kept (lock-zoom)";
  if (goes_on_without_zoom(why)) send(Step::stop, now);
}

// At the end, because the camera has been stopped by then and what else is asked for must not wait for the lens.
void Login::set_zoom(Time now) {
  if (options_.zoom >= 0 && camera_.options.zoom) send(Step::zoom, now);
}

// A preset by token or name.
void Login::after_presets(const SoapAnswer& answer, Time now) {
  std::string seen;
  for (const Preset& preset : read_presets(answer.body)) {
    if (preset.token == options_.preset || (camera_.preset.empty() && preset.name == options_.preset))
      camera_.preset = preset.token;
    if (!seen.empty()) seen.append(", ");
    seen.append(preset.token);
    if (!preset.name.empty()) seen.append(" (").append(preset.name).append(")");
  }
  if (!camera_.preset.empty()) return send(Step::status, now);
  fail("has no preset \"" + options_.preset + "\"" + (seen.empty() ? "" : "; it has " + seen));
}

bool Login::cut_short() {
  soap_.cancel(id_);
  id_ = 0;
  return !camera_.profile.empty();
}

void Login::handle(const SoapAnswer& answer, Time now) {
  id_ = 0;
  if (step_ == Step::zoom && again_ && !answer.good()) {
    warning_ = "does not keep its zoom where lock-zoom has it (" +
               (answer.fault ? answer.fault->text() : answer.wrong) + ")";
    return;
  }
  if (!answer.arrived && step_ != Step::stop) return fail("cannot be reached: " + answer.wrong);
  if (step_ == Step::clock) {
    // Half of the way there and back lies behind the answer; without the camera's time this machine's is used.
    if (const auto time = read_system_date_and_time(answer.body))
      soap_.set_camera_time(*time, sent_ + (now - sent_) / 2);
    return send(Step::services, now);
  }
  if (answer.not_authorized()) {
    if (options_.device.encrypted && !soap_.passwords_in_clear() && !soap_.user().empty()) {
      soap_.send_passwords_in_clear(true);
      return send(step_, now);
    }
    refused_ = true;
    const std::string& user = soap_.user();
    return fail(user.empty()
                    ? "demands a login: give user= and password-file= in device-options"
                    : "refuses the login of the user \"" + user + "\" (" + answer.fault->text() +
                          "): check user= and password-file= in device-options, and the user's rights");
  }
  const bool optional = step_ != Step::capabilities && step_ != Step::profiles_media2 &&
                        !(step_ == Step::profiles && services_.media2.empty());
  if (!answer.good() && !optional)
    return fail(answer.fault ? "does not say what it can do (" + answer.fault->text() + ")"
                             : "is no ONVIF camera: " + answer.wrong);
  switch (step_) {
    case Step::clock:
      break;
    case Step::services:
    case Step::capabilities:
      return after_services(answer, now);
    case Step::profiles:
    case Step::profiles_media2:
      return after_profiles(answer, now);
    case Step::nodes:
      return after_nodes(answer, now);
    case Step::options:
      return after_options(answer, now);
    case Step::stop:
      return send(options_.preset.empty() ? Step::status : Step::presets, now);
    case Step::presets:
      return after_presets(answer, now);
    case Step::status:
      if (!answer.wrong.empty()) {
        if (++unreadable_ < kMostUnreadable) return send(step_, now);
        return fail("has a PTZ service that does not work: " + answer.wrong);
      }
      camera_.status = read_status(answer.body);
      return set_zoom(now);
    case Step::zoom:
      if (!answer.good())
        fail("does not keep its zoom where lock-zoom has it (" +
             (answer.fault ? answer.fault->text() : answer.wrong) + ")");
      return;
  }
}

}  // namespace cerberus::drivers::onvif
