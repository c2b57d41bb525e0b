// SPDX-License-Identifier: LGPL-2.1-or-later
// The HTTP side of the ONVIF driver against libsoup's own server: certificates, logins in clear, sizes, time-outs.
#include <libsoup/soup.h>
#include <poll.h>

#include <atomic>
#include <future>
#include <thread>

#include "drivers/onvif/soap/xml.h"
#include "heads/soup_client.h"

#include "support/suite.h"
#include "support/text.h"

using namespace cerberus::drivers::onvif;
using namespace std::chrono_literals;
using cerberus::heads::SoupClient;
using cerberus::heads::SoupClientOptions;
using cerberus::tests::assert_text;

namespace {

// Made for this test by `openssl req -x509`: CN camera.invalid, until 2126. Nothing else trusts or uses it.
constexpr char kCertificate[] =
    "-----BEGIN PRIVATE KEY-----\n"
    "MIGHAgEAMBMGByqGSM49AgEGCCqGSM49AwEHBG0wawIBAQQgYDHVMscdX98n37kc\n"
    "Q5EpQy6+sljbSv4evxzS0arFHHihRANCAARKVIWjxxREnjkbVNEFCRUgCmex9d5/\n"
    "Qv9zfYMtWK+WkvSDEp8vow10euiCNg1IuB5SIHE0BhoY/mLDwjNoJAi8\n"
    "-----END PRIVATE KEY-----\n"
    "-----BEGIN CERTIFICATE-----\n"
    "MIIBiTCCAS+gAwIBAgIUK4soufYBgW6Df5dh5kZ2OsDWOmIwCgYIKoZIzj0EAwIw\n"
    "GTEXMBUGA1UEAwwOY2FtZXJhLmludmFsaWQwIBcNMjYxMTIyMjA1OTI1WhgPMjEy\n"
    "NjEwMjkyMDU5MjVaMBkxFzAVBgNVBAMMDmNhbWVyYS5pbnZhbGlkMFkwEwYHKoZI\n"
    "zj0CAQYIKoZIzj0DAQcDQgAESlSFo8cURJ45G1TRBQkVIApnsfXef0L/c32DLViv\n"
    "lpL0gxKfL6MNdHrogjYNSLgeUiBxNAYaGP5iw8IzaCQIvKNTMFEwHQYDVR0OBBYE\n"
    "FIH81hVdlOOkgj85udMPNATmp84VMB8GA1UdIwQYMBaAFIH81hVdlOOkgj85udMP\n"
    "NATmp84VMA8GA1UdEwEB/wQFMAMBAf8wCgYIKoZIzj0EAwIDSAAwRQIgQQQ3QyWu\n"
    "bBledkLMJ3mxDZvXDrBEy5J2mtvvkYBWAQsCIQDVv0gfqmZveV1sRP6Xs3DzJmf8\n"
    "iTaJYY7VLEWT1Waujw==\n"
    "-----END CERTIFICATE-----\n";
// openssl x509 -outform DER | sha256sum
constexpr char kFingerprint[] = "f72988f07d746b058c36b059b68ac7025bdb0dc2e8aee98345f1782ae20c7e21";

class Server {
 public:
  explicit Server(bool tls) {
    std::promise<std::string> url;
    thread_ = std::thread([this, tls, &url] { run(tls, url); });
    url_ = url.get_future().get();
  }
  ~Server() {
    end_ = true;
    g_main_context_wakeup(context_);
    thread_.join();
    g_main_context_unref(context_);
  }
  std::string url(const std::string& path) const { return url_ + path; }
  int requests() const { return requests_; }
  int logins() const { return logins_; }

 private:
  void run(bool tls, std::promise<std::string>& url) {
    g_main_context_push_thread_default(context_);
    g_autoptr(GTlsCertificate) certificate = g_tls_certificate_new_from_pem(kCertificate, -1, nullptr);
    ck_assert_ptr_nonnull(certificate);
    g_autoptr(SoupServer) server = soup_server_new("tls-certificate", tls ? certificate : nullptr, nullptr);
    soup_server_add_handler(server, nullptr, on_request, this, nullptr);
    ck_assert(soup_server_listen_local(
        server, 0, tls ? SOUP_SERVER_LISTEN_HTTPS : SOUP_SERVER_LISTEN_IPV4_ONLY, nullptr));
    GSList* uris = soup_server_get_uris(server);
    url.set_value((tls ? "https://127.0.0.1:" : "http://127.0.0.1:") +
                  std::to_string(g_uri_get_port(static_cast<GUri*>(uris->data))));
    g_slist_free_full(uris, reinterpret_cast<GDestroyNotify>(g_uri_unref));
    while (!end_) g_main_context_iteration(context_, TRUE);
    soup_server_disconnect(server);
    g_main_context_pop_thread_default(context_);
  }
  static void on_request(SoupServer*, SoupServerMessage* message, const char* path, GHashTable*,
                         gpointer data) {
    auto& self = *static_cast<Server*>(data);
    ++self.requests_;
    if (soup_message_headers_get_one(soup_server_message_get_request_headers(message), "Authorization"))
      ++self.logins_;
    const std::string wanted = path;
    if (wanted == "/never") return soup_server_message_pause(message);
    if (wanted == "/basic" && self.logins_ == 0) {
      soup_message_headers_append(soup_server_message_get_response_headers(message), "WWW-Authenticate",
                                  "Basic realm=\"camera\"");
      return soup_server_message_set_status(message, 401, nullptr);
    }
    const std::string body(wanted == "/large" ? kMostXml + 1 : 2, 'x');
    soup_server_message_set_status(message, 200, nullptr);
    soup_server_message_set_response(message, "text/plain", SOUP_MEMORY_COPY, body.data(), body.size());
  }

  GMainContext* context_ = g_main_context_new();
  std::string url_;
  std::atomic<bool> end_{false};
  std::atomic<int> requests_{0}, logins_{0};
  std::thread thread_;
};

HttpAnswer ask(SoupClientOptions options, const std::string& url, std::chrono::milliseconds timeout = 5s) {
  SoupClient client(std::move(options));
  client.post({.id = 7, .url = url, .action = "a", .body = "b", .timeout = timeout});
  for (int k = 0; k < 1000; ++k) {
    pollfd wait{client.fd(), POLLIN, 0};
    ::poll(&wait, 1, 10);
    if (auto answer = client.take()) {
      ck_assert_uint_eq(answer->id, 7);
      return *answer;
    }
  }
  ck_abort_msg("no answer");
}

SoupClientOptions with(const char* fingerprint) {
  return {.user = "admin", .password = "hunter2", .fingerprint = fingerprint};
}

}  // namespace

START_TEST(a_certificate_of_no_authority_is_refused_and_its_fingerprint_is_said) {
  Server server(true);
  const HttpAnswer answer = ask(with(""), server.url("/"));
  ck_assert_int_eq(answer.status, 0);
  ck_assert_msg(answer.error.find(std::string("fingerprint ") + kFingerprint +
                                  ", which no authority vouches for") != std::string::npos,
                "%s", answer.error.c_str());
  ck_assert_int_eq(server.requests(), 0);
}
END_TEST

START_TEST(a_pinned_certificate_is_trusted_and_no_other) {
  Server server(true);
  const HttpAnswer good = ask(with(kFingerprint), server.url("/"));
  ck_assert_msg(good.status == 200, "%s", good.error.c_str());
  assert_text(good.body, "xx");
  const HttpAnswer bad = ask(with(std::string(64, 'a').c_str()), server.url("/"));
  ck_assert_int_eq(bad.status, 0);
  ck_assert_msg(bad.error.find("and not the one of device-options") != std::string::npos, "%s",
                bad.error.c_str());
  ck_assert_int_eq(server.requests(), 1);
}
END_TEST

START_TEST(a_password_in_clear_is_kept_back_without_tls) {
  {
    Server server(false);
    ck_assert_int_eq(ask(with(""), server.url("/basic")).status, 401);
    ck_assert_int_eq(server.logins(), 0);
  }
  {
    Server server(false);
    SoupClientOptions options = with("");
    options.password_text = true;
    ck_assert_int_eq(ask(options, server.url("/basic")).status, 200);
    ck_assert_int_eq(server.logins(), 1);
  }
  Server server(true);
  ck_assert_int_eq(ask(with(kFingerprint), server.url("/basic")).status, 200);
}
END_TEST

START_TEST(an_answer_that_is_too_large_is_cut_off) {
  Server server(false);
  const HttpAnswer answer = ask(with(""), server.url("/large"));
  ck_assert_int_eq(answer.status, 200);
  ck_assert(answer.body.empty());
}
END_TEST

START_TEST(an_answer_that_does_not_come_is_given_up) {
  Server server(false);
  const HttpAnswer answer = ask(with(""), server.url("/never"), 50ms);
  ck_assert_int_eq(answer.status, 0);
  assert_text(answer.error, "no answer in time");
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "onvif_http",
      {a_certificate_of_no_authority_is_refused_and_its_fingerprint_is_said,
       a_pinned_certificate_is_trusted_and_no_other, a_password_in_clear_is_kept_back_without_tls,
       an_answer_that_is_too_large_is_cut_off, an_answer_that_does_not_come_is_given_up});
}
