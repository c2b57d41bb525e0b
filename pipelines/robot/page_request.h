// SPDX-License-Identifier: LGPL-2.1-or-later
// One request to the page's server, and its answer.
#pragma once

#include "page_server.h"

namespace cerberus::robot {

constexpr const char* kCookie = "cerberus";
constexpr const char* kDeviceCookie = "cerberus-device";

// The value of a cookie of the request; empty: there is none.
std::string cookie_of(SoupServerMessage* message, const char* name);

struct PageServer::Request {
  SoupServerMessage* message;
  std::string_view path;
  GHashTable* query;  // of the address or, of a POST, of the body; may be nullptr
  Session* session;   // nullptr: not logged in
  std::string address;

  std::string value(const char* key) const {
    const auto* text = query ? static_cast<const char*>(g_hash_table_lookup(query, key)) : nullptr;
    return text ? text : "";
  }
  void respond(guint status, const char* type, const std::string& body) {
    soup_server_message_set_status(message, status, nullptr);
    soup_server_message_set_response(message, type, SOUP_MEMORY_COPY, body.data(), body.size());
  }
  void refuse(guint status, const std::string& why) {
    respond(status, "text/plain; charset=utf-8", why + '\n');
  }
  void done() { respond(SOUP_STATUS_OK, "text/plain; charset=utf-8", "done\n"); }
  std::string who() const { return std::string(name(session ? session->role : Role::none)) + '@' + address; }
};

// A line of the access log.
inline void log_access(const std::string& who, const std::string& what) {
  g_printerr("cerberusd: page: %s %s\n", who.c_str(), what.c_str());
}

}  // namespace cerberus::robot
