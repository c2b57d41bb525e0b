// SPDX-License-Identifier: LGPL-2.1-or-later
// An ONVIF pan-tilt camera for tests, written from the published WSDL and specifications and not from our encoder: HTTP on
// loopback, requests read with their namespaces, with faults. It turns in real time.
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "support/http_server.h"
#include "support/stepped_time.h"

struct _xmlNode;

namespace cerberus::tests {

struct OnvifFaults {
  std::string user{}, password{};  // demanded where not empty
  bool http_digest = false;        // by HTTP's Digest scheme, not by WS-Security
  bool clear_only = false;         // it takes PasswordText only
  std::chrono::seconds clock{0};   // its clock is off by this
  enum class MoveStatus { alive, always_idle, always_moving, absent } move_status = MoveStatus::alive;
  bool positions = true;                // GetStatus has a position
  bool degrees = false;                 // it claims the space of positions in degrees, and reports in it
  bool refuses_absolute = false;        // it claims AbsoluteMove and refuses it
  bool claims_degree_velocity = false;  // it claims VelocitySpaceDegrees and refuses it
  std::string
      refuses_timeout{};  // by a fault of this code (TimeoutNotSupported is the right one); HTTP: without SOAP
  std::string
      position_space{};  // of the positions that it reports; "none": it names none. Empty: the right one
  bool status_at_zero = false;  // GetStatus always says 0, 0
  bool ignores_timeout = false;
  bool refuses_moves = false;    // all of them
  bool refuses_stop = false;     // by a fault; a ContinuousMove at 0 stops it
  std::string claims_host{};     // the XAddr of its services names this instead
  std::string redirects{};       // PTZ requests are redirected to this address
  bool bare_ampersand = false;   // in the URI of its services
  bool no_get_services = false;  // only GetCapabilities
  bool media2_only = false;
  bool no_ptz_profile = false;              // no profile has a PTZ configuration
  bool moves_any_profile = false;           // also one without
  bool no_nodes = false;                    // GetNodes is not there
  bool zooms = false;                       // has a zoom with absolute positions
  double widest = 0, longest = 1;           // of its zoom, in units of its space
  bool refuses_options = false;             // by a fault of GetConfigurationOptions
  bool refuses_zoom = false;                // it claims them and refuses them
  bool repeats_password = false;            // in the reason of a fault
  std::chrono::milliseconds delay{0};       // of every answer
  std::chrono::milliseconds move_delay{0};  // moves are obeyed and answered so late
  std::chrono::milliseconds dead_time{
      0};                  // from a move or stop, which are answered before, until it turns so
  int errors = 0;          // as many PTZ requests are answered by HTTP 500 without SOAP
  int garbage = 0;         // likewise by something that is no XML
  int swallows_stops = 0;  // as many stops are acknowledged and not obeyed
  int loses_stops = 0;     // as many are neither obeyed nor answered
};

class OnvifCamera {
 public:
  using Clock = HttpServer::Clock;
  static constexpr double kPanSpeed = 100, kTiltSpeed = 50;  // degrees a second at velocity 1
  static constexpr double kPanEnd = 170, kTiltEnd = 90;  // degrees at the end 1 of the generic position space

  // time: of a test, which passes requests by answer(); nullptr: the steady clock.
  explicit OnvifCamera(OnvifFaults faults = {}, const SteppedTime* time = nullptr);
  HttpReply answer(const HttpMessage& message);
  std::string device() const { return "http://127.0.0.1:" + std::to_string(server_.port()); }
  int port() const { return server_.port(); }
  void set_silent(bool silent) { server_.set_silent(silent); }
  void set_gone(bool gone) { server_.set_gone(gone); }
  void set_clock(std::chrono::seconds off);
  void set_garbage(int answers);
  void lose_stops(int requests);

  double pan(), tilt();  // degrees
  void look(double pan, double tilt);
  void allow_moves();     // from now on
  void release_status();  // likewise GetStatus says where it is
  double zoom();          // 0 to 1
  void set_zoom(double position);
  void refuse_zoom();     // from now on
  void refuse_options();  // likewise
  double speed();         // of pan, degrees a second
  Clock::time_point stopped();
  int count(const std::string& operation);  // requests that were obeyed or acknowledged
  std::vector<std::string> requests();      // documents, in order
  // The last ContinuousMove's Timeout, as written; empty: it had none.
  std::string timeout();

 private:
  HttpReply obey(const std::string& space, const _xmlNode* request);
  HttpReply ptz(const std::string& name, const _xmlNode* request);
  HttpReply services(bool capabilities);
  HttpReply profiles(bool media2);
  std::string spaces() const;
  HttpReply options();
  HttpReply status();
  HttpReply continuous_move(const _xmlNode* request);
  HttpReply absolute_move(const _xmlNode* request);
  HttpReply stop(const _xmlNode* request);
  bool logged_in(const HttpMessage& message, const _xmlNode* header) const;
  bool token_is_good(const _xmlNode* header) const;
  bool digest_is_good(const HttpMessage& message) const;
  std::chrono::system_clock::time_point clock() const;
  void advance(Clock::time_point now);
  void halt(Clock::time_point now);

  OnvifFaults faults_;
  const SteppedTime* time_;
  std::mutex lock_;
  double pan_ = 0, tilt_ = 0, pan_speed_ = 0, tilt_speed_ = 0, zoom_ = 0;
  bool to_angle_ = false;
  double to_pan_ = 0, to_tilt_ = 0;
  Clock::time_point last_ = now_of(time_), stopped_{}, until_ = Clock::time_point::max();
  struct Late {
    Clock::time_point due;
    double pan, tilt;
    Clock::time_point until;
  };
  std::vector<Late> late_;  // moves that are obeyed later
  std::map<std::string, int> counts_;
  std::vector<std::string> requests_;
  std::string timeout_;
  HttpServer server_;  // last: its thread uses the others
};

}  // namespace cerberus::tests
