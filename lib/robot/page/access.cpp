// SPDX-License-Identifier: LGPL-2.1-or-later
#include "robot/page/access.h"

#include <algorithm>
#include <utility>

namespace cerberus::robot {

namespace {

constexpr std::array<Route, 16> kRoutes{{
    {"GET", "/", Role::none},
    {"GET", "/page.css", Role::none},
    {"GET", "/page.js", Role::none},
    {"GET", "/session", Role::none},
    {"POST", "/login", Role::none},
    {"POST", "/logout", Role::viewer},
    {"GET", "/socket", Role::viewer},
    {"GET", "/events", Role::viewer},
    {"GET", "/events/*", Role::viewer},
    {"GET", "/reasons", Role::viewer},
    {"GET", "/picture/*", Role::viewer},
    {"POST", "/picture", Role::viewer},
    {"GET", "/log", Role::owner},
    {"POST", "/keep", Role::operator_},
    {"POST", "/delete", Role::owner},
    {"POST", "/password", Role::owner},
}};

// Compares without a hint by time at which letter two tokens differ.
bool same(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned different = 0;
  for (std::size_t k = 0; k < a.size(); ++k) different |= static_cast<unsigned char>(a[k] ^ b[k]);
  return different == 0;
}

// "robot:8080", "[::1]:8080" without the port; all of it where what follows is no port.
std::string_view without_port(std::string_view host) {
  const std::size_t bracket = host.starts_with('[') ? host.find(']') : 0;
  const std::size_t colon = bracket == host.npos ? host.npos : host.find(':', bracket);
  if (colon == host.npos || host.find_first_not_of("0123456789", colon + 1) != host.npos) return host;
  return host.substr(0, colon);
}

bool is_numeric(std::string_view host) {
  if (host.starts_with('[')) return host.ends_with(']');
  return !host.empty() && host.find_first_not_of("0123456789.") == host.npos;
}

bool same_letters(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
  return std::ranges::equal(a, b, {}, lower, lower);
}

}  // namespace

std::string_view name(Role role) {
  constexpr std::array<std::string_view, 4> kNames{"none", "viewer", "operator", "owner"};
  return kNames[static_cast<std::size_t>(role)];
}

std::optional<Role> role_of(std::string_view text) {
  for (const Role role : {Role::viewer, Role::operator_, Role::owner})
    if (text == name(role)) return role;
  return std::nullopt;
}

Role needed(const PageCommand& command, Mode present) {
  switch (command.kind) {
    case PageCommand::Kind::ack:
    case PageCommand::Kind::seen:
    case PageCommand::Kind::camera:
      return Role::viewer;
    case PageCommand::Kind::stop:
    case PageCommand::Kind::home:
    case PageCommand::Kind::automatic:
    case PageCommand::Kind::turn:
    case PageCommand::Kind::follow:
    case PageCommand::Kind::stage:
    case PageCommand::Kind::drive:
      return Role::operator_;
    case PageCommand::Kind::set:
      return Role::owner;
    case PageCommand::Kind::mode:
      break;
  }
  return command.mode == Mode::privacy || present == Mode::privacy ? Role::owner : Role::operator_;
}

std::span<const Route> routes() {
  return kRoutes;
}

const Route* find_route(std::string_view method, std::string_view path) {
  for (const Route& route : kRoutes) {
    const bool all = route.path.ends_with('*');
    const std::string_view stem = route.path.substr(0, route.path.size() - (all ? 1 : 0));
    const bool asked = method == route.method || (method == "HEAD" && route.method == "GET");
    if (asked && (all ? path.starts_with(stem) : path == stem)) return &route;
  }
  return nullptr;
}

bool is_own_host(std::string_view host, std::string_view machine, std::span<const std::string> origins) {
  const std::string_view bare = without_port(host);
  if (is_numeric(bare) || same_letters(bare, "localhost")) return true;
  if (!machine.empty()) {
    if (same_letters(bare, machine)) return true;
    if (bare.size() == machine.size() + 6 && same_letters(bare.substr(0, machine.size()), machine) &&
        same_letters(bare.substr(machine.size()), ".local"))
      return true;
  }
  return std::ranges::any_of(origins, [&](const std::string& origin) {
    const std::size_t scheme = origin.find("://");
    return scheme != origin.npos && same_letters(host, std::string_view(origin).substr(scheme + 3));
  });
}

bool is_own_origin(std::string_view origin, std::string_view host, std::span<const std::string> origins,
                   bool tls) {
  const std::string_view scheme = tls ? "https://" : "http://";
  if (origin.starts_with(scheme) && !host.empty() && same_letters(origin.substr(scheme.size()), host))
    return true;
  return std::ranges::find(origins, origin) != origins.end();
}

Session& Sessions::begin(std::string token, Role role, std::string address, AccessTime now) {
  if (sessions_.size() >= parameters_.most)
    sessions_.erase(std::ranges::min_element(sessions_, {}, &Session::used));
  return sessions_.emplace_back(Session{std::move(token), role, false, std::move(address), now, now});
}

Session* Sessions::find(std::string_view token, AccessTime now) {
  std::erase_if(sessions_, [&](const Session& session) {
    return now - session.used > parameters_.idle || now - session.begun > parameters_.longest;
  });
  for (Session& session : sessions_) {
    if (!same(session.token, token)) continue;
    session.used = now;
    return &session;
  }
  return nullptr;
}

void Sessions::end(std::string token) {
  std::erase_if(sessions_,
                [ended = std::move(token)](const Session& session) { return same(session.token, ended); });
}

void Sessions::end_all(Role role, std::string_view except) {
  std::erase_if(sessions_,
                [&](const Session& session) { return session.role == role && !same(session.token, except); });
}

bool Steering::take(std::string_view token, AccessTime now) {
  if (token_ != token && now < until_) return false;
  token_ = token;
  until_ = now + kHold;
  return true;
}

void Steering::stop(std::string_view token) {
  if (!token_.empty() && token_ != token && !must_let_go(token_)) {
    if (must_let_go_.size() >= kMost) must_let_go_.erase(must_let_go_.begin());
    must_let_go_.push_back(token_);
  }
  let_go(token);
  release();
}

bool Steering::must_let_go(std::string_view token) const {
  return std::ranges::find(must_let_go_, token) != must_let_go_.end();
}

}  // namespace cerberus::robot
