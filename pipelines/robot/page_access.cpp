// SPDX-License-Identifier: LGPL-2.1-or-later
// How a browser gets and loses its session: passwords are checked in a thread of their own.
#include <gio/gio.h>

#include <string_view>
#include <utility>

#include "device_tokens.h"
#include "page_request.h"

namespace cerberus::robot {

namespace {

constexpr std::string_view kDeviceAccount = "device";  // no role is called so

AccessTime now() {
  return std::chrono::steady_clock::now();
}

}  // namespace

void PageServer::set_cookie(SoupServerMessage* message, const char* name, const std::string& token,
                            const char* age) const {
  std::string cookie =
      std::string(name) + '=' + token + "; Path=/; HttpOnly; SameSite=Strict; Max-Age=" + age;
  if (house_.settings.page.tls) cookie += "; Secure";
  soup_message_headers_append(soup_server_message_get_response_headers(message), "Set-Cookie",
                              cookie.c_str());
}

// Whether the address must wait before it tries the account again; the answer says so then.
bool PageServer::must_wait(Request& request, std::string_view account) const {
  const std::chrono::seconds wait = limit_.wait(request.address, account, now());
  if (wait.count() == 0) return false;
  soup_message_headers_replace(soup_server_message_get_response_headers(request.message), "Retry-After",
                               std::to_string(wait.count()).c_str());
  request.refuse(429, "too many wrong passwords: wait " + std::to_string(wait.count()) + " s");
  return true;
}

void PageServer::log_in(Request& request) {
  if (const std::string token = request.value("device"); !token.empty()) return log_in_device(request, token);
  const Role role = role_of(request.value("user")).value_or(Role::none);
  if (must_wait(request, name(role))) return;
  // Counts as wrong until it is found right: several at once are no way around the limit.
  limit_.failed(request.address, name(role), now());
  const std::string password = request.value("password");
  if (passwords_.is_one_time(role, password) && is_local(request.message))
    return finish_log_in(request, role, true);
  auto right = std::make_shared<bool>(false);
  answer_later(
      request, [right, role, password, all = passwords_] { *right = all.verify(role, password); },
      [this, right, role](Request& later) {
        if (!*right)
          log_access(later.address, role == Role::none
                                        ? "gave a password for a role that does not exist"
                                        : "gave a wrong password for the role " + std::string(name(role)));
        finish_log_in(later, *right ? role : Role::none, false);
      });
}

const Device* PageServer::device_of(const std::string& token) {
  std::string error;
  if (!load_devices(house_.settings.state_folder, devices_, error))
    g_printerr("cerberusd: page: %s\n", error.c_str());
  return devices_.find(hash_of_token(token));
}

// Its token has so many random bits that no number of guesses finds one; each reads the file, and is written to the log.
void PageServer::log_in_device(Request& request, const std::string& token) {
  if (must_wait(request, kDeviceAccount)) return;
  limit_.failed(request.address, kDeviceAccount, now());
  const Device* device = device_of(token);
  if (device == nullptr) {
    log_access(request.address, "gave the token of no device");
    request.refuse(SOUP_STATUS_FORBIDDEN,
                   "this device is not known (any more): make it a token on the robot's machine, by "
                   "cerberusd --make-device-token");
    return;
  }
  limit_.withdraw(request.address, kDeviceAccount);
  if (request.session != nullptr) sessions_.end(request.session->token);
  begin_device_session(request, *device, token);
  if (request.session == nullptr)
    return request.refuse(SOUP_STATUS_INTERNAL_SERVER_ERROR, "the system gives no random numbers");
  request.done();
}

// The cookie of the token lasts as long as browsers keep one, from each session on.
void PageServer::begin_device_session(Request& request, const Device& device, const std::string& token) {
  const std::string own = random_token();
  if (own.empty()) return;
  Session& session = sessions_.begin(own, device.role, request.address, now());
  session.device = device.hash;
  request.session = &session;
  set_cookie(request.message, kCookie, own, "604800");
  set_cookie(request.message, kDeviceCookie, token, "34560000");
  log_access(request.who(), "logged in as the device " + device.name);
}

// A revoked device is shown nothing more.
void PageServer::end_revoked_devices() {
  bool read = false;
  sessions_.end_if([&](const Session& session) {
    if (session.device.empty()) return false;
    std::string error;
    if (!std::exchange(read, true)) load_devices(house_.settings.state_folder, devices_, error);
    return devices_.find(session.device) == nullptr;
  });
}

void PageServer::answer_later(Request& request, std::function<void()> work,
                              std::function<void(Request&)> done) {
  SoupServerMessage* message = request.message;
  auto held = std::shared_ptr<SoupServerMessage>(SOUP_SERVER_MESSAGE(g_object_ref(message)), g_object_unref);
  const bool added =
      background_.add(std::move(work), [this, held, address = request.address, done = std::move(done)] {
        SoupServerMessage* message = held.get();
        Request later{
            message,
            soup_server_message_get_uri(message) ? g_uri_get_path(soup_server_message_get_uri(message)) : "",
            nullptr, session_of(message), address};
        done(later);
        soup_server_message_unpause(message);
      });
  if (!added) return request.refuse(SOUP_STATUS_SERVICE_UNAVAILABLE, "too many passwords at once: try again");
  soup_server_message_pause(message);
}

// `role` none: the password is wrong.
void PageServer::finish_log_in(Request& request, Role role, bool one_time) {
  if (role == Role::none) {
    request.refuse(SOUP_STATUS_FORBIDDEN, "wrong password");
    return;
  }
  const std::string token = random_token();
  if (token.empty()) {
    request.refuse(SOUP_STATUS_INTERNAL_SERVER_ERROR, "the system gives no random numbers");
    return;
  }
  limit_.withdraw(request.address, name(role));
  if (request.session != nullptr) sessions_.end(request.session->token);
  Session& session = sessions_.begin(token, role, request.address, now());
  session.must_set_password = one_time;
  request.session = &session;
  set_cookie(request.message, kCookie, token, "604800");
  log_access(request.who(), "logged in");
  request.done();
}

void PageServer::log_out(Request& request) {
  log_access(request.who(), "logged out");
  sessions_.end(request.session->token);
  request.session = nullptr;
  set_cookie(request.message, kCookie, "", "0");
  set_cookie(request.message, kDeviceCookie, "", "0");
  close_strangers();
  request.done();
}

void PageServer::set_password(Request& request) {
  Session& session = *request.session;
  const Role role = role_of(request.value("user")).value_or(Role::none);
  if (session.must_set_password && role != Role::owner) {
    request.refuse(SOUP_STATUS_FORBIDDEN, "the owner's password comes first");
    return;
  }
  const std::string password = request.value("password");
  if (const std::string wrong = Passwords::fault_of(role, password); !wrong.empty())
    return request.refuse(SOUP_STATUS_BAD_REQUEST, wrong);
  auto hash = std::make_shared<std::string>();
  answer_later(
      request, [hash, password, all = passwords_] { *hash = all.hash_of(password); },
      [this, hash, role](Request& later) { keep_password(later, role, *hash); });
}

void PageServer::keep_password(Request& request, Role role, std::string hash) {
  if (request.session == nullptr || request.session->role != Role::owner)
    return request.refuse(SOUP_STATUS_UNAUTHORIZED, "log in first");  // it ended meanwhile
  if (hash.empty())
    return request.refuse(SOUP_STATUS_INTERNAL_SERVER_ERROR,
                          "the system has no memory or no random numbers for a password");
  Session& session = *request.session;
  passwords_.keep(role, std::move(hash));
  const std::string text = passwords_.state();
  g_autoptr(GError) error = nullptr;
  const auto how =
      static_cast<GFileSetContentsFlags>(G_FILE_SET_CONTENTS_CONSISTENT | G_FILE_SET_CONTENTS_DURABLE);
  if (!g_file_set_contents_full(path_of_passwords().c_str(), text.data(), static_cast<gssize>(text.size()),
                                how, 0600, &error)) {
    g_printerr("cerberusd: the passwords cannot be kept: %s\n", error->message);
    request.refuse(SOUP_STATUS_INTERNAL_SERVER_ERROR,
                   "the password counts until the next start: it cannot be kept");
    return;
  }
  session.must_set_password = false;
  sessions_.end_all(role, std::string(session.token));
  close_strangers();
  log_access(request.address, "set the password of the " + std::string(name(role)));
  request.done();
}

}  // namespace cerberus::robot
