// SPDX-License-Identifier: LGPL-2.1-or-later
#include "heads/soup_client.h"

#include <libsoup/soup.h>
#include <sys/eventfd.h>
#include <sys/random.h>
#include <unistd.h>

#include <array>
#include <deque>
#include <map>
#include <mutex>
#include <thread>
#include <utility>

#include "drivers/onvif/soap/xml.h"

namespace cerberus::heads {

using drivers::onvif::HttpAnswer;
using drivers::onvif::HttpRequest;

namespace {

constexpr int kConnections = 8;      // to the camera at once: stops do not wait for moves
constexpr gsize kPiece = 16 * 1024;  // bytes read at once
constexpr std::size_t kNonceBytes = 16;

std::string sha256_of(GTlsCertificate* certificate) {
  g_autoptr(GByteArray) der = nullptr;
  g_object_get(certificate, "certificate", &der, nullptr);
  if (!der) return {};
  g_autofree char* digest = g_compute_checksum_for_data(G_CHECKSUM_SHA256, der->data, der->len);
  return digest;
}

}  // namespace

// One request, owned by the map of calls. Everything here happens on the thread of libsoup.
struct SoupClient::Call {
  Core& core;
  HttpRequest request;
  SoupMessage* message = nullptr;
  GInputStream* stream = nullptr;
  GCancellable* cancellable = g_cancellable_new();
  GSource* timer = nullptr;
  std::string body, certificate;  // certificate: the fingerprint that was not trusted
  bool timed_out = false, dropped = false;

  Call(Core& owner, HttpRequest what) : core(owner), request(std::move(what)) {}
  ~Call() {
    if (timer) g_source_destroy(timer);
    g_clear_pointer(&timer, g_source_unref);
    g_clear_object(&stream);
    g_clear_object(&message);
    g_clear_object(&cancellable);
  }
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

  void begin();
  void set_body();
  void read();
  void end(int status, std::string error);
  void fail(const GError* error);

  static gboolean on_certificate(SoupMessage*, GTlsCertificate* certificate, GTlsCertificateFlags,
                                 gpointer self);
  static gboolean on_login(SoupMessage*, SoupAuth* auth, gboolean again, gpointer self);
  static void on_restart(Call* call);
  static gboolean on_timeout(gpointer self);
  static void on_headers(GObject* session, GAsyncResult* result, gpointer self);
  static void on_piece(GObject* stream, GAsyncResult* result, gpointer self);
};

struct SoupClient::Core {
  SoupClientOptions options;
  GMainContext* context = g_main_context_new();
  int event = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  std::mutex lock;
  std::deque<HttpAnswer> answers;  // under `lock`
  // Of the thread:
  SoupSession* session = nullptr;
  std::map<unsigned, std::unique_ptr<Call>> calls;
  bool ended = false;
  std::thread thread;

  explicit Core(SoupClientOptions o) : options(std::move(o)), thread([this] { run(); }) {}
  ~Core() {
    invoke([](Core& core) {
      core.ended = true;
      for (const auto& [id, call] : core.calls) call->dropped = true, g_cancellable_cancel(call->cancellable);
    });
    thread.join();
    g_main_context_unref(context);
    ::close(event);
  }

  void run();
  // Runs a function on the thread.
  template <typename Function>
  void invoke(Function function) {
    struct Job {
      Core& core;
      Function function;
    };
    GSource* source = g_idle_source_new();  // not g_main_context_invoke(): that may run it on this thread
    g_source_set_priority(source, G_PRIORITY_DEFAULT);
    g_source_set_callback(
        source,
        [](gpointer data) -> gboolean {
          auto* job = static_cast<Job*>(data);
          job->function(job->core);
          return G_SOURCE_REMOVE;
        },
        new Job{*this, std::move(function)}, [](gpointer data) { delete static_cast<Job*>(data); });
    g_source_attach(source, context);
    g_source_unref(source);
  }
};

void SoupClient::Core::run() {
  g_main_context_push_thread_default(context);
  session = soup_session_new_with_options("max-conns", 2 * kConnections, "max-conns-per-host", kConnections,
                                          "proxy-resolver", nullptr, "timeout", 0, nullptr);
  // Without authorities no certificate is trusted by itself, and each one is compared with the fingerprint.
  if (!options.fingerprint.empty()) soup_session_set_tls_database(session, nullptr);
  while (!ended || !calls.empty()) g_main_context_iteration(context, TRUE);
  soup_session_abort(session);
  while (g_main_context_iteration(context, FALSE)) continue;
  g_clear_object(&session);
  g_main_context_pop_thread_default(context);
}

void SoupClient::Call::begin() {
  message = soup_message_new("POST", request.url.c_str());
  if (!message) return end(0, "its address is no URL");
  soup_message_add_flags(message, SOUP_MESSAGE_NO_REDIRECT);
  set_body();
  g_signal_connect_swapped(message, "restarted", G_CALLBACK(on_restart), this);
  g_signal_connect(message, "accept-certificate", G_CALLBACK(on_certificate), this);
  g_signal_connect(message, "authenticate", G_CALLBACK(on_login), this);
  timer = g_timeout_source_new(static_cast<guint>(request.timeout.count()));
  g_source_set_callback(timer, on_timeout, this, nullptr);
  g_source_attach(timer, core.context);
  soup_session_send_async(core.session, message, G_PRIORITY_DEFAULT, cancellable, on_headers, this);
}

void SoupClient::Call::set_body() {
  const std::string type = "application/soap+xml; charset=utf-8; action=\"" + request.action + "\"";
  g_autoptr(GBytes) bytes = g_bytes_new(request.body.data(), request.body.size());
  soup_message_set_request_body_from_bytes(message, type.c_str(), bytes);
}

// A request that is sent again with a login has lost its body.
void SoupClient::Call::on_restart(Call* call) {
  call->set_body();
}

gboolean SoupClient::Call::on_certificate(SoupMessage*, GTlsCertificate* certificate, GTlsCertificateFlags,
                                          gpointer self) {
  auto& call = *static_cast<Call*>(self);
  call.certificate = sha256_of(certificate);
  return !call.certificate.empty() && call.certificate == call.core.options.fingerprint;
}

// Digest always; Basic, which shows the password, over TLS or when the user asked for it.
gboolean SoupClient::Call::on_login(SoupMessage*, SoupAuth* auth, gboolean again, gpointer self) {
  const auto& call = *static_cast<Call*>(self);
  const SoupClientOptions& options = call.core.options;
  const bool digest = g_str_equal(soup_auth_get_scheme_name(auth), "Digest");
  const bool clear = options.password_text || call.request.url.starts_with("https:");
  if (again || options.user.empty() || soup_auth_is_for_proxy(auth) || !(digest || clear)) return FALSE;
  soup_auth_authenticate(auth, options.user.c_str(), options.password.c_str());
  return TRUE;
}

gboolean SoupClient::Call::on_timeout(gpointer self) {
  auto& call = *static_cast<Call*>(self);
  call.timed_out = true;
  g_cancellable_cancel(call.cancellable);
  return G_SOURCE_REMOVE;
}

void SoupClient::Call::on_headers(GObject* session, GAsyncResult* result, gpointer self) {
  auto& call = *static_cast<Call*>(self);
  g_autoptr(GError) error = nullptr;
  call.stream = soup_session_send_finish(SOUP_SESSION(session), result, &error);
  if (!call.stream) return call.fail(error);
  call.read();
}

void SoupClient::Call::read() {
  g_input_stream_read_bytes_async(stream, kPiece, G_PRIORITY_DEFAULT, cancellable, on_piece, this);
}

void SoupClient::Call::on_piece(GObject* stream, GAsyncResult* result, gpointer self) {
  auto& call = *static_cast<Call*>(self);
  g_autoptr(GError) error = nullptr;
  g_autoptr(GBytes) piece = g_input_stream_read_bytes_finish(G_INPUT_STREAM(stream), result, &error);
  if (!piece) return call.fail(error);
  gsize size = 0;
  const auto* data = static_cast<const char*>(g_bytes_get_data(piece, &size));
  if (size == 0) return call.end(static_cast<int>(soup_message_get_status(call.message)), {});
  if (call.body.size() + size > drivers::onvif::kMostXml) {
    call.body.clear();  // no XML that would be read
    return call.end(static_cast<int>(soup_message_get_status(call.message)), {});
  }
  call.body.append(data, size);
  call.read();
}

void SoupClient::Call::fail(const GError* error) {
  const std::string& pinned = core.options.fingerprint;
  if (timed_out) return end(0, "no answer in time");
  if (!certificate.empty() && certificate != pinned)
    return end(0, "its certificate has the SHA-256 fingerprint " + certificate +
                      (pinned.empty() ? ", which no authority vouches for: if it is the camera's, give it as "
                                        "fingerprint= in device-options"
                                      : ", and not the one of device-options"));
  end(0, error->message);
}

void SoupClient::Call::end(int status, std::string error) {
  if (!dropped) {
    {
      const std::lock_guard guard(core.lock);
      core.answers.push_back({request.id, status, std::move(body), std::move(error)});
    }
    const std::uint64_t one = 1;
    [[maybe_unused]] const ssize_t written = ::write(core.event, &one, sizeof one);
  }
  const unsigned id = request.id;
  core.calls.erase(id);  // and this object
}

SoupClient::SoupClient(SoupClientOptions options) : core_(std::make_unique<Core>(std::move(options))) {}

SoupClient::~SoupClient() = default;

void SoupClient::post(const HttpRequest& request) {
  core_->invoke([request](Core& core) {
    auto& call = core.calls[request.id];
    call = std::make_unique<Call>(core, request);
    call->begin();
  });
}

void SoupClient::cancel(unsigned id) {
  core_->invoke([id](Core& core) {
    const auto call = core.calls.find(id);
    if (call == core.calls.end()) return;
    call->second->dropped = true;
    g_cancellable_cancel(call->second->cancellable);
  });
}

std::optional<HttpAnswer> SoupClient::take() {
  const std::lock_guard guard(core_->lock);
  if (core_->answers.empty()) {
    std::uint64_t count;
    [[maybe_unused]] const ssize_t drained = ::read(core_->event, &count, sizeof count);
    return std::nullopt;
  }
  HttpAnswer answer = std::move(core_->answers.front());
  core_->answers.pop_front();
  return answer;
}

int SoupClient::fd() const {
  return core_->event;
}

const std::string& SoupClient::user() const {
  return core_->options.user;
}

std::chrono::milliseconds SoupClient::utc() const {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
      std::chrono::system_clock::now().time_since_epoch());
}

std::optional<drivers::onvif::UsernameToken> SoupClient::token(const std::string& created, bool digest) {
  const SoupClientOptions& options = core_->options;
  std::string nonce(kNonceBytes, '\0');
  if (options.user.empty() ||
      ::getrandom(nonce.data(), nonce.size(), 0) != static_cast<ssize_t>(nonce.size()))
    return std::nullopt;
  return drivers::onvif::UsernameToken{
      .username = options.user,
      .password = digest ? password_digest(nonce, created, options.password) : options.password,
      .digest = digest,
      .nonce = drivers::onvif::base64(nonce),
      .created = created};
}

std::string password_digest(const std::string& nonce, const std::string& created,
                            const std::string& password) {
  const std::string all = nonce + created + password;
  GChecksum* sum = g_checksum_new(G_CHECKSUM_SHA1);
  g_checksum_update(sum, reinterpret_cast<const guchar*>(all.data()), static_cast<gssize>(all.size()));
  std::array<guint8, 20> digest;
  gsize size = digest.size();
  g_checksum_get_digest(sum, digest.data(), &size);
  g_checksum_free(sum);
  return drivers::onvif::base64({reinterpret_cast<const char*>(digest.data()), size});
}

std::string normal_fingerprint(const std::string& text) {
  std::string digits;
  for (const char c : text) {
    if (c == ':') continue;
    if (!g_ascii_isxdigit(c)) return {};
    digits += g_ascii_tolower(c);
  }
  return digits.size() == 64 ? digits : std::string();
}

}  // namespace cerberus::heads
