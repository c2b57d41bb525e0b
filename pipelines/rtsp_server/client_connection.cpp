// SPDX-License-Identifier: LGPL-2.1-or-later
#include "rtsp_server/client_connection.h"

#include <fcntl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>

namespace cerberus::rtsp {
namespace {

// Duplicates of a client's sockets. The client's own thread may close and free its connection at any time, so no other
// thread may touch that.
class Sockets {
 public:
  explicit Sockets(GstRTSPConnection* connection) {
    // Two where RTSP goes through HTTP.
    const std::array all = {gst_rtsp_connection_get_read_socket(connection),
                            gst_rtsp_connection_get_write_socket(connection)};
    for (std::size_t k = 0; k < all.size(); ++k)
      if (all[k] && (k == 0 || all[k] != all[0]))
        descriptors_[k] = fcntl(g_socket_get_fd(all[k]), F_DUPFD_CLOEXEC, 0);
  }
  ~Sockets() {
    for (const int descriptor : descriptors_)
      if (descriptor >= 0) close(descriptor);
  }
  Sockets(const Sockets&) = delete;
  Sockets& operator=(const Sockets&) = delete;
  void shut_down() const {
    for (const int descriptor : descriptors_)
      if (descriptor >= 0) shutdown(descriptor, SHUT_RDWR);
  }

 private:
  std::array<int, 2> descriptors_ = {-1, -1};
};

// Of a GstRTSPClient, set once each: two Sockets, and a text.
constexpr char kSockets[] = "cerberus-sockets";
constexpr char kSessionSockets[] = "cerberus-session-sockets";
constexpr char kAddress[] = "cerberus-address";

void keep_sockets(GstRTSPClient* client, const char* key) {
  GstRTSPConnection* connection = gst_rtsp_client_get_connection(client);
  if (!connection || g_object_get_data(G_OBJECT(client), key)) return;
  g_object_set_data_full(G_OBJECT(client), key, new Sockets(connection),
                         [](gpointer gone) { delete static_cast<Sockets*>(gone); });
}

}  // namespace

void note_connection(GstRTSPClient* client) {
  keep_sockets(client, kSockets);
  GstRTSPConnection* connection = gst_rtsp_client_get_connection(client);
  const char* address = connection ? gst_rtsp_connection_get_ip(connection) : nullptr;
  g_object_set_data_full(G_OBJECT(client), kAddress, g_strdup(address ? address : ""), g_free);
}

void note_session(GstRTSPClient* client) {
  GstRTSPConnection* connection = gst_rtsp_client_get_connection(client);
  if (connection && gst_rtsp_connection_is_tunneled(connection)) keep_sockets(client, kSessionSockets);
}

const char* address_of(GstRTSPClient* client) {
  return static_cast<const char*>(g_object_get_data(G_OBJECT(client), kAddress));
}

void shut_down(GstRTSPClient* client) {
  for (const char* key : {kSockets, kSessionSockets})
    if (const auto* sockets = static_cast<Sockets*>(g_object_get_data(G_OBJECT(client), key)))
      sockets->shut_down();
}

}  // namespace cerberus::rtsp
