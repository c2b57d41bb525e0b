// SPDX-License-Identifier: LGPL-2.1-or-later
#include "page_listener.h"

#include <glib/gstdio.h>
#include <netinet/in.h>
#include <netinet/tcp.h>

#include <algorithm>
#include <set>
#include <utility>

#include "robot/page/client_address.h"

namespace cerberus::robot {

namespace {

std::string name_of(GSocketAddress* address) {
  if (!G_IS_INET_SOCKET_ADDRESS(address)) return "?";
  auto* socket = G_INET_SOCKET_ADDRESS(address);
  g_autofree gchar* text = g_inet_address_to_string(g_inet_socket_address_get_address(socket));
  return std::string(text) + ':' + std::to_string(g_inet_socket_address_get_port(socket));
}

std::string without_port(const std::string& name) {
  return name.substr(0, name.rfind(':'));
}

gint64 in_seconds(guint seconds) {
  return g_get_monotonic_time() + gint64{seconds} * G_USEC_PER_SEC;
}

void cut(GObject* connection) {
  g_socket_shutdown(g_socket_connection_get_socket(G_SOCKET_CONNECTION(connection)), TRUE, TRUE, nullptr);
}

}  // namespace

PageListener::~PageListener() {
  if (service_ != nullptr) {
    g_socket_service_stop(service_);
    g_socket_listener_close(G_SOCKET_LISTENER(service_));
    g_signal_handlers_disconnect_by_data(service_, this);
    g_object_unref(service_);
  }
  if (timer_ != 0) g_source_remove(timer_);
  for (const auto& [connection, name] : open_) g_object_weak_unref(connection, forget, this);
  g_clear_object(&certificate_);
}

bool PageListener::open(SoupServer* server, GSocketAddress* address, GTlsCertificate* certificate,
                        std::string& error) {
  server_ = server;
  if (certificate != nullptr) certificate_ = G_TLS_CERTIFICATE(g_object_ref(certificate));
  service_ = g_socket_service_new();
  // What comes at once waits for accept(), else for seconds until TCP tries again.
  g_socket_listener_set_backlog(G_SOCKET_LISTENER(service_), static_cast<int>(parameters_.most));
  g_autoptr(GError) fault = nullptr;
  if (!g_socket_listener_add_address(G_SOCKET_LISTENER(service_), address, G_SOCKET_TYPE_STREAM,
                                     G_SOCKET_PROTOCOL_TCP, nullptr, nullptr, &fault)) {
    error = fault->message;
    return false;
  }
  g_signal_connect(service_, "incoming",
                   G_CALLBACK(+[](GSocketService*, GSocketConnection* connection, GObject*, gpointer self) {
                     static_cast<PageListener*>(self)->accept(connection);
                     return static_cast<gboolean>(TRUE);
                   }),
                   this);
  g_socket_service_start(service_);
  timer_ = g_timeout_add_seconds(
      1,
      [](gpointer self) {
        static_cast<PageListener*>(self)->sweep();
        return static_cast<gboolean>(G_SOURCE_CONTINUE);
      },
      this);
  return true;
}

std::size_t PageListener::count_of(const std::string& client) const {
  return static_cast<std::size_t>(
      std::ranges::count_if(open_, [&](const auto& one) { return one.second.client == client; }));
}

// A connection that is not handed on is closed with its last reference.
void PageListener::accept(GSocketConnection* connection) {
  g_autoptr(GSocketAddress) remote = g_socket_connection_get_remote_address(connection, nullptr);
  g_autoptr(GSocketAddress) local = g_socket_connection_get_local_address(connection, nullptr);
  if (remote == nullptr || local == nullptr || open_.size() >= parameters_.most) return;
  std::string name = name_of(remote);
  const std::string address = without_port(name);
  const bool of_proxy = is_in(address, trusted_);
  const auto of_proxies = std::ranges::count_if(open_, [](const auto& one) { return one.second.of_proxy; });
  if (of_proxy ? static_cast<std::size_t>(of_proxies) >= parameters_.most_of_proxies
               : count_of(address) >= parameters_.most_of_address)
    return;
  GSocket* socket = g_socket_connection_get_socket(connection);
  g_socket_set_timeout(socket, parameters_.idle);
  g_socket_set_option(socket, IPPROTO_TCP, TCP_NODELAY, 1, nullptr);
  g_autoptr(GError) fault = nullptr;
  g_autoptr(GIOStream) stream = G_IO_STREAM(g_object_ref(connection));
  if (certificate_ != nullptr) {
    GIOStream* secure = g_tls_server_connection_new(stream, certificate_, &fault);
    if (secure == nullptr) return;
    // Browsers close without the message of TLS that says so.
    g_tls_connection_set_require_close_notify(G_TLS_CONNECTION(secure), FALSE);
    g_object_unref(std::exchange(stream, secure));
  }
  open_.emplace(G_OBJECT(connection),
                Open{std::move(name), of_proxy ? "" : address, in_seconds(parameters_.head), of_proxy});
  g_object_weak_ref(G_OBJECT(connection), forget, this);
  soup_server_accept_iostream(server_, stream, local, remote, &fault);
}

void PageListener::forget(gpointer listener, GObject* connection) {
  static_cast<PageListener*>(listener)->open_.erase(connection);
}

void PageListener::abort(GSocketAddress* remote) {
  const std::string name = name_of(remote);
  for (const auto& [connection, open] : open_)
    if (open.name == name) cut(connection);
}

void PageListener::note(GSocketAddress* remote, Step step) {
  const std::string name = name_of(remote);
  for (auto& [connection, open] : open_) {
    if (open.name != name || open.socket) continue;
    open.socket = step == Step::became_socket;
    if (open.of_proxy && step == Step::answered) open.client.clear();
    open.until = step == Step::head_read  ? in_seconds(parameters_.head)
                 : step == Step::answered ? in_seconds(parameters_.idle)
                                          : 0;
  }
}

bool PageListener::assign(GSocketAddress* remote, const std::string& client) {
  const std::string name = name_of(remote);
  for (auto& [connection, open] : open_) {
    if (open.name != name || !open.of_proxy) continue;
    open.client.clear();
    if (count_of(client) >= parameters_.most_of_address) return false;
    open.client = client;
  }
  return true;
}

void PageListener::sweep() {
  const gint64 now = g_get_monotonic_time();
  for (const auto& [connection, open] : open_)
    if (open.until != 0 && open.until < now) cut(connection);
}

GTlsCertificate* load_certificate(const std::string& certificate, const std::string& key,
                                  std::string& error) {
  g_autoptr(GError) fault = nullptr;
  GTlsCertificate* loaded = g_tls_certificate_new_from_files(certificate.c_str(), key.c_str(), &fault);
  if (loaded == nullptr) error = "the certificate " + certificate + " cannot be used: " + fault->message;
  return loaded;
}

GTlsCertificate* self_made_certificate(const Settings& settings, std::string& error) {
  const std::string& folder = settings.state_folder;
  const std::string certificate = folder + "/page-certificate.pem", key = folder + "/page-key.pem";
  if (!g_file_test(certificate.c_str(), G_FILE_TEST_EXISTS) ||
      !g_file_test(key.c_str(), G_FILE_TEST_EXISTS)) {
    std::string host = g_get_host_name();
    const auto is_odd = [](char c) { return !g_ascii_isalnum(c) && c != '-' && c != '.'; };
    if (host.empty() || host.size() > 60 || std::ranges::any_of(host, is_odd)) host = "robot";
    std::string names =
        "subjectAltName=DNS:" + host + ",DNS:" + host + ".local,DNS:localhost,IP:127.0.0.1,IP:::1";
    std::set<std::string> addresses{settings.page.listen};
    if (settings.rtsp) addresses.insert(settings.rtsp->listen);
    for (const std::string& address : addresses)
      if (address != "0.0.0.0" && address != "::" && address != "127.0.0.1") names += ",IP:" + address;
    const std::string subject = "/CN=" + host;
    // Ten years: a person accepts it once in a browser, by its fingerprint.
    const char* words[] = {"openssl",
                           "req",
                           "-x509",
                           "-newkey",
                           "ec",
                           "-pkeyopt",
                           "ec_paramgen_curve:prime256v1",
                           "-nodes",
                           "-days",
                           "3650",
                           "-subj",
                           subject.c_str(),
                           "-addext",
                           names.c_str(),
                           "-keyout",
                           key.c_str(),
                           "-out",
                           certificate.c_str(),
                           nullptr};
    g_autoptr(GError) fault = nullptr;
    g_autofree gchar* said = nullptr;
    gint status = 0;
    const bool ran = g_spawn_sync(nullptr, const_cast<gchar**>(words), nullptr, G_SPAWN_SEARCH_PATH, nullptr,
                                  nullptr, nullptr, &said, &status, &fault);
    if (!ran || !g_spawn_check_wait_status(status, &fault)) {
      error = std::string("the openssl tool, which makes the page's certificate, failed: ") + fault->message;
      g_unlink(key.c_str());
      g_unlink(certificate.c_str());
      return nullptr;
    }
    g_chmod(key.c_str(), 0600);
  }
  return load_certificate(certificate, key, error);
}

std::string fingerprint(GTlsCertificate* certificate) {
  g_autoptr(GByteArray) bytes = nullptr;
  g_object_get(certificate, "certificate", &bytes, nullptr);
  if (bytes == nullptr) return {};
  g_autofree gchar* digits = g_compute_checksum_for_data(G_CHECKSUM_SHA256, bytes->data, bytes->len);
  std::string text;
  for (std::size_t k = 0; digits[k] != '\0'; ++k) {
    if (k > 0 && k % 2 == 0) text += ':';
    text += g_ascii_toupper(digits[k]);
  }
  return text;
}

}  // namespace cerberus::robot
