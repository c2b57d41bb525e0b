// SPDX-License-Identifier: LGPL-2.1-or-later
// Who may do what on the page: roles, routes, sessions, and the limit on wrong passwords. Time is a parameter.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "publish/streams/rate_limit.h"
#include "robot/page/page_commands.h"

namespace cerberus::robot {

// Each may do what those before it may.
enum class Role : std::uint8_t { none, viewer, operator_, owner };

std::string_view name(Role role);
std::optional<Role> role_of(std::string_view name);  // viewer, operator or owner

// The role that a message of the page's WebSocket needs while this mode is in force: who may not begin privacy may not
// end it either.
Role needed(const PageCommand& command, Mode present);

// What the page's server answers; every other address is unknown.
struct Route {
  std::string_view method, path;  // a path that ends with * stands for all that begin so
  Role role;                      // that is needed
};
std::span<const Route> routes();
// HEAD is answered where GET is, without the body.
const Route* find_route(std::string_view method, std::string_view path);

// Whether a request's Host names this machine: a numeric address, localhost, the machine's own name (also with
// .local), or the host of a configured origin. A page of another name that resolves to this machine is refused (DNS
// rebinding).
bool is_own_host(std::string_view host, std::string_view machine, std::span<const std::string> origins);
// Whether a request that changes something, or a WebSocket, comes from the page itself or from a configured origin. A
// missing origin is refused: browsers send one. `tls`: whether the page itself is served by HTTPS.
bool is_own_origin(std::string_view origin, std::string_view host, std::span<const std::string> origins,
                   bool tls = false);

using AccessTime = std::chrono::steady_clock::time_point;

struct Session {
  std::string token;
  Role role = Role::none;
  bool must_set_password = false;  // logged in with the one-time password: may do nothing else
  std::string address;
  AccessTime begun{}, used{};
  std::set<std::string> played{};  // recordings of which the access log has a line
  std::string device{};            // of a device: the hash of its token (devices.h)
};

class Sessions {
 public:
  struct Parameters {
    std::chrono::hours idle{12}, longest{24 * 7};  // convention: a working day, a week
    std::size_t most = 64;                         // the one that was used longest ago ends
  };

  // `token` is random, at least 128 bits.
  Session& begin(std::string token, Role role, std::string address, AccessTime now);
  // The session of a token, which is then used; nullptr: there is none.
  Session* find(std::string_view token, AccessTime now);
  // `token` may be that of the session that ends here: it is a copy.
  void end(std::string token);
  // Ends all sessions of a role, after its password changed.
  void end_all(Role role, std::string_view except);
  // Ends those of which `over` says so.
  void end_if(const std::function<bool(const Session&)>& over) { std::erase_if(sessions_, over); }
  std::size_t count() const { return sessions_.size(); }

 private:
  Parameters parameters_;
  std::vector<Session> sessions_;
};

using publish::RateLimit;

// One controller at a time: the head belongs to the session that moved it last, until that is silent for `hold`.
class Steering {
 public:
  static constexpr std::chrono::seconds kHold{2};

  // Takes the head, or keeps it; false: another session has it.
  bool take(std::string_view token, AccessTime now);
  bool is_held_by(std::string_view token, AccessTime now) const { return token_ == token && now < until_; }
  void release() { until_ = {}; }
  // A session stopped what another moves: that one, which may go on sending orders, must let go before it moves again.
  void stop(std::string_view token);
  // An order of no speed, or a stop.
  void let_go(std::string_view token) { std::erase(must_let_go_, token); }
  bool must_let_go(std::string_view token) const;

 private:
  static constexpr std::size_t kMost = 64;  // as sessions

  std::string token_;
  AccessTime until_{};
  std::vector<std::string> must_let_go_;  // tokens
};

}  // namespace cerberus::robot
