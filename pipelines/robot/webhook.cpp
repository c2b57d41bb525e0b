// SPDX-License-Identifier: LGPL-2.1-or-later
#include "webhook.h"

#include <utility>

#include "robot/page/passwords.h"
#include "robot/settings_file.h"

namespace cerberus::robot {

namespace {

constexpr guint kPatience = 10;              // seconds for a whole answer
constexpr std::size_t kShortestSecret = 16;  // letters: 64 bits in hexadecimal digits

publish::WebhookQueue::Time now() {
  return std::chrono::steady_clock::now();
}

}  // namespace

// One request, which may outlive the webhook. It ends after kPatience whatever the receiver does: the session's own
// timeout is that of one read or write.
struct Webhook::Attempt {
  explicit Attempt(std::weak_ptr<Webhook*> of)
      : self(std::move(of)), timer(g_timeout_add_seconds(kPatience, on_time, this)) {}
  ~Attempt() {
    if (timer != 0) g_source_remove(timer);
    g_object_unref(cancellable);
    g_clear_object(&message);
  }
  Attempt(const Attempt&) = delete;
  Attempt& operator=(const Attempt&) = delete;

  static gboolean on_time(gpointer data) {
    auto& attempt = *static_cast<Attempt*>(data);
    attempt.timer = 0;
    g_cancellable_cancel(attempt.cancellable);
    return G_SOURCE_REMOVE;
  }
  // The status counts, the body does not: it is neither waited for nor read.
  static void on_answer(GObject* session, GAsyncResult* result, gpointer data) {
    std::unique_ptr<Attempt> attempt(static_cast<Attempt*>(data));
    g_autoptr(GError) error = nullptr;
    g_autoptr(GInputStream) answer = soup_session_send_finish(SOUP_SESSION(session), result, &error);
    if (answer == nullptr) {
      attempt->fault = attempt->timer == 0 ? "there is no answer" : error->message;
      attempt->finish();
      return;
    }
    attempt->message =
        SOUP_MESSAGE(g_object_ref(soup_session_get_async_result_message(SOUP_SESSION(session), result)));
    GCancellable* cancellable = attempt->cancellable;
    g_input_stream_close_async(
        answer, G_PRIORITY_DEFAULT, cancellable,
        [](GObject* stream, GAsyncResult* closed, gpointer of) {
          const std::unique_ptr<Attempt> done(static_cast<Attempt*>(of));
          g_input_stream_close_finish(G_INPUT_STREAM(stream), closed, nullptr);
          done->finish();
        },
        attempt.release());
  }
  void finish() const {
    if (const auto webhook = self.lock()) (*webhook)->finished(message, fault);
  }

  std::weak_ptr<Webhook*> self;
  GCancellable* cancellable = g_cancellable_new();
  guint timer;
  SoupMessage* message = nullptr;  // nullptr: without an answer
  std::string fault;
};

Webhook::Webhook(WebhookSettings settings, std::string robot)
    : settings_(std::move(settings)), robot_(std::move(robot)) {}

Webhook::~Webhook() {
  if (session_ == nullptr) return;
  soup_session_abort(session_);
  g_object_unref(session_);
}

bool Webhook::open(std::string& error) {
  const std::optional<std::string> secret = read_secret(settings_.secret_file, error);
  if (!secret) return false;
  if (secret->size() < kShortestSecret) {
    error = settings_.secret_file + ": the secret of a webhook has at least 16 characters";
    return false;
  }
  secret_ = *secret;
  run_ = random_token(8);
  session_ = soup_session_new_with_options("timeout", kPatience, "max-conns", 1, nullptr);
  if (!settings_.ca_file.empty()) {
    g_autoptr(GError) fault = nullptr;
    g_autoptr(GTlsDatabase) authorities = g_tls_file_database_new(settings_.ca_file.c_str(), &fault);
    if (authorities == nullptr) {
      error = settings_.ca_file + ": " + fault->message;
      return false;
    }
    soup_session_set_tls_database(session_, authorities);
  }
  return true;
}

void Webhook::add(const std::string& camera, const std::string& topic, const std::string& payload) {
  const std::string id = run_ + '-' + std::to_string(++number_);
  const std::chrono::microseconds utc(g_get_real_time());
  queue_.add({id, publish::webhook_body(id, robot_, camera, topic, utc, payload)});
  send();
}

// The timestamp is that of this attempt: a receiver refuses old ones.
void Webhook::send() {
  const publish::WebhookQueue::Event* event = queue_.next(now());
  if (event == nullptr) return;
  g_autoptr(SoupMessage) message = soup_message_new("POST", settings_.url.c_str());
  const std::string stamp = std::to_string(g_get_real_time() / G_USEC_PER_SEC);
  const std::string signed_text = stamp + '.' + event->body;
  g_autofree gchar* signature = g_compute_hmac_for_data(
      G_CHECKSUM_SHA256, reinterpret_cast<const guchar*>(secret_.data()), secret_.size(),
      reinterpret_cast<const guchar*>(signed_text.data()), signed_text.size());
  SoupMessageHeaders* headers = soup_message_get_request_headers(message);
  soup_message_headers_append(headers, "Cerberus-Timestamp", stamp.c_str());
  soup_message_headers_append(headers, "Cerberus-Signature", (std::string("sha256=") + signature).c_str());
  soup_message_add_flags(message, SOUP_MESSAGE_NO_REDIRECT);
  g_autoptr(GBytes) body = g_bytes_new(event->body.data(), event->body.size());
  soup_message_set_request_body_from_bytes(message, "application/json", body);
  auto* attempt = new Attempt(self_);
  soup_session_send_async(session_, message, G_PRIORITY_DEFAULT, attempt->cancellable, Attempt::on_answer,
                          attempt);
}

void Webhook::finished(SoupMessage* message, const std::string& fault) {
  using Outcome = publish::WebhookQueue::Outcome;
  const unsigned status = message ? soup_message_get_status(message) : 0;
  const Outcome outcome = publish::WebhookQueue::outcome_of(status);
  const std::string what = fault.empty() ? "the answer is " + std::to_string(status) : fault;
  if (outcome == Outcome::failed && queue_.failures() == 0)
    g_printerr("cerberusd: webhook: %s; it is tried again\n", what.c_str());
  if (outcome == Outcome::refused) g_printerr("cerberusd: webhook: an event is dropped: %s\n", what.c_str());
  queue_.finished(outcome, now());
  if (outcome == Outcome::delivered && queue_.dropped() > std::exchange(reported_, queue_.dropped()))
    g_printerr("cerberusd: webhook: %s events were dropped so far\n",
               std::to_string(queue_.dropped()).c_str());
  send();
}

}  // namespace cerberus::robot
