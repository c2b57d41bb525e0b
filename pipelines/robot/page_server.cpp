// SPDX-License-Identifier: LGPL-2.1-or-later
#include "page_server.h"

#include <gio/gio.h>

#include <algorithm>
#include <cerrno>

#include "page_log.h"
#include "page_request.h"
#include "text/file.h"
#include "text/json_line.h"

namespace cerberus::robot {

namespace {

constexpr goffset kLongestBody = 2048;        // bytes of a form
constexpr std::size_t kMostPasswords = 4096;  // bytes of the file

// Nothing but what this page brings itself is loaded or framed.
constexpr const char* kHeaders[][2] = {
    {"Content-Security-Policy",
     "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; media-src 'self'; "
     "connect-src "
     "'self'; form-action 'self'; frame-ancestors 'none'; base-uri 'none'"},
    {"X-Frame-Options", "DENY"},
    {"X-Content-Type-Options", "nosniff"},
    {"Referrer-Policy", "no-referrer"},
    {"Cross-Origin-Resource-Policy", "same-origin"},
    {"Cross-Origin-Opener-Policy", "same-origin"},
    {"Cache-Control", "no-store"},
};

std::string header(SoupServerMessage* message, const char* name) {
  const char* value = soup_message_headers_get_one(soup_server_message_get_request_headers(message), name);
  return value ? value : "";
}

GInetAddress* peer(SoupServerMessage* message) {
  GSocketAddress* address = soup_server_message_get_remote_address(message);
  return G_IS_INET_SOCKET_ADDRESS(address) ? g_inet_socket_address_get_address(G_INET_SOCKET_ADDRESS(address))
                                           : nullptr;
}

std::string peer_name(SoupServerMessage* message) {
  GInetAddress* address = peer(message);
  g_autofree gchar* text = address ? g_inet_address_to_string(address) : nullptr;
  return text ? text : "?";
}

// Of several headers of a name: all, joined by commas.
std::string headers(SoupServerMessage* message, const char* name) {
  const char* value = soup_message_headers_get_list(soup_server_message_get_request_headers(message), name);
  return value ? value : "";
}

bool is_loopback(const std::string& address) {
  return address.starts_with("127.") || address == "::1";
}

AccessTime now() {
  return std::chrono::steady_clock::now();
}

}  // namespace

std::string cookie_of(SoupServerMessage* message, const char* name) {
  const std::string cookies = header(message, "Cookie"), key = std::string(name) + '=';
  for (std::size_t at = 0; at < cookies.size();) {
    const std::size_t end = std::min(cookies.find(';', at), cookies.size());
    if (cookies.compare(at, key.size(), key) == 0)
      return cookies.substr(at + key.size(), end - at - key.size());
    at = cookies.find_first_not_of(' ', end + 1);
  }
  return {};
}

Client PageServer::client(SoupServerMessage* message) const {
  return client_of(peer_name(message), house_.settings.page.trusted_proxies,
                   headers(message, "X-Forwarded-For"), headers(message, "Forwarded"));
}

// What a proxy hands on counts as from elsewhere, whatever its headers say.
bool PageServer::is_local(SoupServerMessage* message) const {
  const Client from = client(message);
  return !from.proxied && is_loopback(from.address);
}

PageServer::PageServer(House house) : house_(std::move(house)) {}

PageServer::~PageServer() {
  for (const auto& camera : house_.cameras) {
    camera->set_on_picture({});
    camera->set_watched(false);
  }
  for (const auto& viewer : viewers_) g_signal_handlers_disconnect_by_data(viewer->connection(), this);
  viewers_.clear();
  if (server_ == nullptr) return;
  soup_server_disconnect(server_);
  g_signal_handlers_disconnect_by_data(server_, this);
  g_object_unref(server_);
}

bool PageServer::open(std::string& error) {
  const text::File file = text::read_file(path_of_passwords(), kMostPasswords);
  const bool is_first = file.fault == text::File::Fault::failed && file.error == ENOENT;
  if (!is_first && (file.fault != text::File::Fault::none || !passwords_.restore(file.text))) {
    error = path_of_passwords() + " cannot be read; without this file a new password is asked for";
    return false;
  }
  server_ = soup_server_new(nullptr, nullptr);  // without a header that says which server this is
  // JPEG does not become smaller by it: it would cost more than the encoder.
  soup_server_remove_websocket_extension(server_, SOUP_TYPE_WEBSOCKET_EXTENSION_DEFLATE);
  const auto early = [](SoupServer*, SoupServerMessage* message, const char* path, GHashTable*,
                        gpointer page) { static_cast<PageServer*>(page)->authorize(message, path); };
  soup_server_add_early_handler(server_, nullptr, early, this, nullptr);
  soup_server_add_handler(
      server_, nullptr,
      [](SoupServer*, SoupServerMessage* message, const char* path, GHashTable* query, gpointer data) {
        auto& page = *static_cast<PageServer*>(data);
        page.listener_.note(soup_server_message_get_remote_address(message), PageListener::Step::body_read);
        g_autoptr(GHashTable) form = nullptr;
        if (std::string_view(soup_server_message_get_method(message)) == "POST") {
          SoupMessageBody* body = soup_server_message_get_request_body(message);
          g_autoptr(GBytes) bytes = soup_message_body_flatten(body);
          gsize size = 0;
          const auto* letters = static_cast<const char*>(g_bytes_get_data(bytes, &size));
          form = soup_form_decode(std::string(letters ? letters : "", size).c_str());
          query = form;
        }
        Request request{message, path, query, page.session_of(message), page.client(message).address};
        page.answer(request);
      },
      this, nullptr);
  const auto answered = +[](SoupServer*, SoupServerMessage* message, gpointer page) {
    static_cast<PageServer*>(page)->listener_.note(soup_server_message_get_remote_address(message),
                                                   PageListener::Step::answered);
  };
  g_signal_connect(server_, "request-finished", G_CALLBACK(answered), this);
  soup_server_add_early_handler(server_, "/socket", early, this, nullptr);
  soup_server_add_websocket_handler(
      server_, "/socket", nullptr, nullptr,
      [](SoupServer*, SoupServerMessage* message, const char*, SoupWebsocketConnection* connection,
         gpointer page) { static_cast<PageServer*>(page)->open_socket(message, connection); },
      this, nullptr);
  listener_.trust(house_.settings.page.trusted_proxies);
  if (!listen(error)) return false;
  if (!passwords_.has(Role::owner)) {
    // Only where the program was started; a log keeps it, but it counts until a password is set, on this machine alone.
    g_print("One-time password of the owner, for a browser on this machine: %s\n",
            passwords_.make_one_time().c_str());
  }
#if HAVE_MQTT
  if (house_.settings.mqtt && house_.settings.list_cameras)
    fleet_ = std::make_unique<FleetClient>(*house_.settings.mqtt);
#endif
  for (const auto& camera : house_.cameras) {
    camera->set_on_picture([this](Camera& from) {
      for (const auto& viewer : viewers_)
        if (viewer->camera() == &from) viewer->send_picture();
    });
  }
  return true;
}

bool PageServer::listen(std::string& error) {
  const PageSettings& page = house_.settings.page;
  g_autoptr(GSocketAddress) address =
      g_inet_socket_address_new_from_string(page.listen.c_str(), static_cast<guint>(page.port));
  if (address == nullptr) {
    error = "\"listen\" of [page] is a numeric address: 127.0.0.1, or 0.0.0.0 for every network";
    return false;
  }
  g_autoptr(GTlsCertificate) certificate = nullptr;
  if (page.tls) {
    certificate = page.certificate.empty() ? self_made_certificate(house_.settings, error)
                                           : load_certificate(page.certificate, page.key, error);
    if (certificate == nullptr) return false;
  }
  if (!listener_.open(server_, address, certificate, error)) {
    error = "the page cannot listen at " + page.listen + ':' + std::to_string(page.port) + ": " + error;
    return false;
  }
  g_printerr("cerberusd: the page is at %s://%s:%d\n", page.tls ? "https" : "http", page.listen.c_str(),
             page.port);
  if (certificate != nullptr)
    g_printerr("cerberusd: SHA-256 of the page's certificate: %s\n", fingerprint(certificate).c_str());
  else if (!g_inet_address_get_is_loopback(g_inet_socket_address_get_address(G_INET_SOCKET_ADDRESS(address))))
    g_printerr(
        "cerberusd: the page is open to the network, and without TLS passwords travel in plain text\n");
  return true;
}

Session* PageServer::session_of(SoupServerMessage* message) {
  return sessions_.find(cookie_of(message, kCookie), now());
}

// Before the body is read: a status that is set here ends the request, of a WebSocket too.
void PageServer::authorize(SoupServerMessage* message, std::string_view path) {
  if (soup_server_message_get_status(message) != 0) return;
  listener_.note(soup_server_message_get_remote_address(message), PageListener::Step::head_read);
  SoupMessageHeaders* answer = soup_server_message_get_response_headers(message);
  for (const auto& [name, value] : kHeaders) soup_message_headers_replace(answer, name, value);
  SoupMessageBody* body = soup_server_message_get_request_body(message);
  const auto refuse = [&](guint status, const char* why) {
    soup_message_body_set_accumulate(body, FALSE);
    soup_server_message_set_status(message, status, nullptr);
    soup_server_message_set_response(message, "text/plain; charset=utf-8", SOUP_MEMORY_STATIC, why,
                                     strlen(why));
  };
  if (!listener_.assign(soup_server_message_get_remote_address(message), client(message).address))
    return refuse(SOUP_STATUS_SERVICE_UNAVAILABLE, "too many requests at once\n");
  const std::string_view method = soup_server_message_get_method(message);
  const std::string host = header(message, "Host"), origin = header(message, "Origin");
  const std::vector<std::string>& origins = house_.settings.page.origins;
  if (!is_own_host(host, g_get_host_name(), origins)) return refuse(SOUP_STATUS_FORBIDDEN, "unknown host\n");
  const Route* route = find_route(method, path);
  if (route == nullptr) return refuse(SOUP_STATUS_NOT_FOUND, "there is no such page\n");
  const bool changes = method == "POST" || path == "/socket";
  if (changes && !is_own_origin(origin, host, origins, house_.settings.page.tls))
    return refuse(SOUP_STATUS_FORBIDDEN, "this does not come from the page\n");
  SoupMessageHeaders* asked = soup_server_message_get_request_headers(message);
  if (soup_message_headers_get_encoding(asked) == SOUP_ENCODING_CHUNKED ||
      soup_message_headers_get_content_length(asked) > kLongestBody)
    return refuse(SOUP_STATUS_REQUEST_ENTITY_TOO_LARGE, "too long\n");
  if (route->role == Role::none) return;
  const Session* session = session_of(message);
  if (session == nullptr) return refuse(SOUP_STATUS_UNAUTHORIZED, "log in first\n");
  const bool allowed_first = path == "/password" || path == "/logout";
  if (session->role < route->role || (session->must_set_password && !allowed_first))
    return refuse(SOUP_STATUS_FORBIDDEN, "this role may not do that\n");
}

void PageServer::answer(Request& request) {
  if (soup_server_message_get_status(request.message) != 0) return;  // refused before
  const std::string_view path = request.path;
  if (path == "/session") return answer_session(request);
  if (path == "/login") return log_in(request);
  if (path == "/logout") return log_out(request);
  if (path == "/password") return set_password(request);
  if (path == "/events" || path == "/reasons") return answer_events(request);
  if (path.starts_with("/events/")) return answer_recording(request);
  if (path == "/keep" || path == "/delete") return change_recording(request);
  if (path == "/log") return answer_log(request);
  if (path == "/picture") return ask_for_picture(request);
  if (path.starts_with("/picture/")) return answer_picture(request);
  if (path == "/socket") return request.refuse(SOUP_STATUS_BAD_REQUEST, "this is for WebSockets");
  answer_page(request);
}

void PageServer::answer_page(Request& request) {
  const std::string name = request.path == "/" ? "/index.html" : std::string(request.path);
  const char* type = name.ends_with(".css")  ? "text/css; charset=utf-8"
                     : name.ends_with(".js") ? "text/javascript; charset=utf-8"
                                             : "text/html; charset=utf-8";
  g_autoptr(GBytes) bytes =
      g_resources_lookup_data(("/cerberus/page" + name).c_str(), G_RESOURCE_LOOKUP_FLAGS_NONE, nullptr);
  if (bytes == nullptr) return request.refuse(SOUP_STATUS_NOT_FOUND, "there is no such page");
  gsize size = 0;
  const auto* text = static_cast<const char*>(g_bytes_get_data(bytes, &size));
  request.respond(SOUP_STATUS_OK, type, std::string(text, size));
}

void PageServer::answer_log(Request& request) {
  request.respond(SOUP_STATUS_OK, "text/plain; charset=utf-8", collected_log());
}

// POST /picture (camera): asks a camera of the broker for one, which /picture/CAMERA is when it came.
void PageServer::ask_for_picture(Request& request) {
  if (house_.mode() == Mode::privacy)
    return request.refuse(SOUP_STATUS_FORBIDDEN, "privacy: nothing is shown");
#if HAVE_MQTT
  if (fleet_ && fleet_->ask_for_picture(request.value("camera"))) {
    log_access(request.who(), "asks for a picture of " + request.value("camera"));
    return request.done();
  }
#endif
  request.refuse(SOUP_STATUS_NOT_FOUND, "there is no such camera");
}

void PageServer::answer_picture(Request& request) {
  if (house_.mode() == Mode::privacy)
    return request.refuse(SOUP_STATUS_FORBIDDEN, "privacy: nothing is shown");
#if HAVE_MQTT
  const std::string* picture = fleet_ ? fleet_->fleet().picture(request.path.substr(9)) : nullptr;
  if (picture != nullptr) return request.respond(SOUP_STATUS_OK, "image/jpeg", *picture);
#endif
  request.refuse(SOUP_STATUS_NOT_FOUND, "there is no such picture");
}

void PageServer::answer_session(Request& request) {
  // A device comes back by itself after a restart.
  if (request.session == nullptr)
    if (const std::string token = cookie_of(request.message, kDeviceCookie); !token.empty())
      if (const Device* device = device_of(token)) begin_device_session(request, *device, token);
  text::JsonLine line;
  line.open('{').key("robot").text(house_.settings.name).key("role");
  if (request.session != nullptr)
    line.string(name(request.session->role));
  else
    line.null();
  line.key("first").boolean(!passwords_.has(Role::owner) && is_local(request.message));
  line.key("must-set-password").boolean(request.session != nullptr && request.session->must_set_password);
  line.key("device").boolean(request.session != nullptr && !request.session->device.empty());
  request.respond(SOUP_STATUS_OK, "application/json", std::string(line.close('}').finish()));
}

}  // namespace cerberus::robot
