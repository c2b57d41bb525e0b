// SPDX-License-Identifier: LGPL-2.1-or-later
#include "rtsp_server/limited_auth.h"

#include <chrono>
#include <mutex>
#include <optional>
#include <string>

#include "publish/streams/rate_limit.h"

namespace cerberus::rtsp {
namespace {

// A player sends one wrong password several times (rtspsrc six times). Derived: five tries of a user who mistypes, and the
// same of ten addresses. Guarded by the test of wrong passwords.
constexpr publish::RateLimit::Parameters kLimit{.free = 30, .free_of_all = 300};

struct Limit {
  std::mutex lock;  // clients are served by several threads
  publish::RateLimit limit{kLimit};
};

struct CerberusLimitedAuth {
  GstRTSPAuth parent;
  Limit* limit;
};
struct CerberusLimitedAuthClass {
  GstRTSPAuthClass parent_class;
};

G_DEFINE_TYPE(CerberusLimitedAuth, limited_auth, GST_TYPE_RTSP_AUTH)

// The user that a request is of. Nothing: it has no log-in, or several, with which one request would be several tries.
std::optional<std::string> user_of(const GstRTSPMessage* request) {
  GstRTSPAuthCredential** const all = gst_rtsp_message_parse_auth_credentials(
      const_cast<GstRTSPMessage*>(request), GST_RTSP_HDR_AUTHORIZATION);
  std::optional<std::string> user;
  int users = 0;
  for (auto** each = all; each && *each; ++each)
    for (auto** param = (*each)->params; param && *param; ++param)
      if (g_strcmp0((*param)->name, "username") == 0 && (*param)->value && ++users == 1)
        user = (*param)->value;
  const bool one = all && all[0] && !all[1] && users == 1;
  if (all) gst_rtsp_auth_credentials_free(all);
  return one ? user : std::nullopt;
}

// Without a token the server answers 401, which is also the answer to a client's first request: that one has no
// password, and does not count.
gboolean limited_auth_authenticate(GstRTSPAuth* auth, GstRTSPContext* context) {
  const auto parent = GST_RTSP_AUTH_CLASS(limited_auth_parent_class)->authenticate;
  gchar* given = nullptr;
  if (!context->request ||
      gst_rtsp_message_get_header(context->request, GST_RTSP_HDR_AUTHORIZATION, &given, 0) != GST_RTSP_OK)
    return parent(auth, context);
  const gchar* ip = context->conn ? gst_rtsp_connection_get_ip(context->conn) : nullptr;
  const std::string address = ip ? ip : "";
  const auto now = std::chrono::steady_clock::now();
  const std::optional<std::string> user = user_of(context->request);
  if (!user) return TRUE;
  Limit& limit = *reinterpret_cast<CerberusLimitedAuth*>(auth)->limit;
  const std::lock_guard guard(limit.lock);
  if (limit.limit.wait(address, *user, now) > std::chrono::seconds::zero()) return TRUE;
  const gboolean done = parent(auth, context);
  if (context->token)
    limit.limit.succeeded(address, *user);
  else
    limit.limit.failed(address, *user, now);
  return done;
}

void limited_auth_init(CerberusLimitedAuth* self) {
  self->limit = new Limit;
}

void limited_auth_finalize(GObject* object) {
  delete reinterpret_cast<CerberusLimitedAuth*>(object)->limit;
  G_OBJECT_CLASS(limited_auth_parent_class)->finalize(object);
}

void limited_auth_class_init(CerberusLimitedAuthClass* type) {
  type->parent_class.authenticate = limited_auth_authenticate;
  G_OBJECT_CLASS(type)->finalize = limited_auth_finalize;
}

}  // namespace

GstRTSPAuth* limited_auth_new() {
  return GST_RTSP_AUTH(g_object_new(limited_auth_get_type(), nullptr));
}

}  // namespace cerberus::rtsp
