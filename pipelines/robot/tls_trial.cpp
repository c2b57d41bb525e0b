// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tls_trial.h"

#include <sys/socket.h>

#include <array>
#include <cerrno>
#include <thread>

namespace cerberus::robot {

namespace {

constexpr guint kPatience = 10;  // seconds; both ends are here

// One end of a pair of sockets as a stream; takes the descriptor. nullptr: out of descriptors or memory.
GIOStream* stream_of(int descriptor) {
  g_autoptr(GSocket) socket = g_socket_new_from_fd(descriptor, nullptr);
  if (socket == nullptr) return nullptr;
  g_socket_set_timeout(socket, kPatience);
  return G_IO_STREAM(g_socket_connection_factory_create_connection(socket));
}

struct End {
  std::string fault;
  bool was_left = false;  // the other end knows why
};

// The other end is told by the end of the stream.
End shake_hands(GIOStream* end, GIOStream* below) {
  g_autoptr(GError) error = nullptr;
  if (g_tls_connection_handshake(G_TLS_CONNECTION(end), nullptr, &error)) return {};
  g_io_stream_close(below, nullptr, nullptr);
  const bool was_left = !g_error_matches(error, G_TLS_ERROR, G_TLS_ERROR_HANDSHAKE) &&
                        !g_error_matches(error, G_TLS_ERROR, G_TLS_ERROR_MISC);
  return {error->message, was_left};
}

}  // namespace

std::string tls_fault(GTlsCertificate* certificate) {
  std::array<int, 2> pair{};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair.data()) != 0) return g_strerror(errno);
  g_autoptr(GIOStream) served = stream_of(pair[0]);
  g_autoptr(GIOStream) asked = stream_of(pair[1]);
  if (served == nullptr || asked == nullptr) return "the system gives no sockets";
  g_autoptr(GError) error = nullptr;
  g_autoptr(GIOStream) server = g_tls_server_connection_new(served, certificate, &error);
  if (server == nullptr) return error->message;
  g_autoptr(GIOStream) client = g_tls_client_connection_new(asked, nullptr, &error);
  if (client == nullptr) return error->message;
  // Who signed the certificate, for which name and until when is the browser's question.
  const auto accept =
      +[](GTlsConnection*, GTlsCertificate*, GTlsCertificateFlags, gpointer) -> gboolean { return TRUE; };
  g_signal_connect(client, "accept-certificate", G_CALLBACK(accept), nullptr);
  End of_client;
  std::thread other([&] { of_client = shake_hands(client, asked); });
  const End of_server = shake_hands(server, served);
  other.join();
  std::string fault = of_client.fault.empty() || of_client.was_left ? of_server.fault : of_client.fault;
  if (fault.empty()) fault = of_client.fault;
  while (fault.ends_with('.')) fault.pop_back();
  return fault.empty() ? "" : "no TLS connection can be made with them (" + fault + ')';
}

}  // namespace cerberus::robot
