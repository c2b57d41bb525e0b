// SPDX-License-Identifier: LGPL-2.1-or-later
// What happens between an address and the first move: the camera's clock, its services, the profile that can pan and tilt,
// what its PTZ configuration offers, a Stop, the position, and the zoom where it is to be kept. Nothing of it turns the
// camera: a position that it reports may be false.
#pragma once

#include <string>

#include "drivers/onvif/soap/soap_client.h"

namespace cerberus::drivers::onvif {

struct LoginOptions {
  Address device;
  // Token or name of a profile, which is used also without a PTZ configuration, or of a node of the PTZ service, which is
  // reached by the first profile; empty: the first profile with a PTZ configuration.
  std::string profile;
  bool password_text = false;  // passwords in clear also without TLS
  std::string preset;          // token or name of a preset to look up; empty: none
  double zoom = -1;            // position of the zoom to keep, 0 to 1; negative: whatever it is
};

// What the camera is, after a login.
struct Camera {
  Address ptz;
  std::string profile;
  PtzOptions options;
  std::optional<PtzStatus> status;  // nothing: it has none
  std::string preset;               // token of the preset that was looked up
};

// Sets the zoom of a camera whose options have one. position: 0 to 1.
Request zoom_request(const Camera& camera, double position);

class Login {
 public:
  Login(SoapClient& soap, LoginOptions options) : soap_(soap), options_(std::move(options)) {}
  // Begins anew. timeout: of each request. again: the camera was driven before, so that a zoom that cannot be kept is a
  // warning() and does not end the login.
  void begin(Time now, Time timeout, bool again = false);
  bool busy() const { return id_ != 0; }
  // Gives up what is still to be asked for. False: not even the profile is known.
  bool cut_short();
  bool owns(unsigned id) const { return id != 0 && id == id_; }
  // An answer that it owns.
  void handle(const SoapAnswer& answer, Time now);
  // After the end: why it failed; empty: it is done.
  const std::string& wrong() const { return wrong_; }
  // Of a login that is done: what is wrong and keeps no camera from turning; empty: nothing.
  const std::string& warning() const { return warning_; }
  // It failed because the camera refused the user.
  bool refused() const { return refused_; }
  const Camera& camera() const { return camera_; }

 private:
  enum class Step {
    clock,
    services,
    capabilities,
    profiles,
    profiles_media2,
    nodes,
    options,
    stop,
    presets,
    status,
    zoom
  };

  void send(Step step, Time now);
  void fail(std::string why);
  // False: the login has failed of it.
  bool goes_on_without_zoom(std::string why);
  // False: no profile of these can pan and tilt, or none of the name that is asked for.
  bool choose(const std::vector<Profile>& profiles);
  void after_services(const SoapAnswer& answer, Time now);
  void after_profiles(const SoapAnswer& answer, Time now);
  void after_nodes(const SoapAnswer& answer, Time now);
  void after_presets(const SoapAnswer& answer, Time now);
  void after_spaces(const std::string& unknown, Time now);
  void after_options(const SoapAnswer& answer, Time now);
  void set_zoom(Time now);
  Address service(const std::string& claimed) const;

  SoapClient& soap_;
  LoginOptions options_;
  Camera camera_;
  Step step_ = Step::clock;
  unsigned id_ = 0;
  Time timeout_{}, sent_{};
  Services services_;
  std::string configuration_;
  std::string seen_profiles_;                  // those that can pan and tilt, for messages
  std::string other_profiles_;                 // those without a PTZ configuration, likewise
  std::string first_profile_, named_profile_;  // tokens; the latter is the one that is asked for
  std::string wrong_, warning_;
  bool again_ = false;
  bool refused_ = false;
  int unreadable_ = 0;  // answers to the position inquiry that are no SOAP
};

}  // namespace cerberus::drivers::onvif
