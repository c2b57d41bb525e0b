// SPDX-License-Identifier: LGPL-2.1-or-later
// HTTP for the ONVIF driver, by libsoup on a thread of its own: name look-ups, connections and TLS never hold up the
// helper's loop. No proxy, no redirection, no cookies.
#pragma once

#include <memory>
#include <string>

#include "drivers/onvif/soap/http_client.h"

namespace cerberus::heads {

struct SoupClientOptions {
  std::string user, password;
  // SHA-256 of the camera's certificate in 64 hexadecimal digits: this one is trusted and no other. Empty: one that the
  // system's authorities have signed.
  std::string fingerprint;
  // The password may be sent in clear without TLS (HTTP's Basic scheme).
  bool password_text = false;
};

class SoupClient final : public drivers::onvif::HttpClient {
 public:
  explicit SoupClient(SoupClientOptions options);
  ~SoupClient() override;
  void post(const drivers::onvif::HttpRequest& request) override;
  void cancel(unsigned id) override;
  std::optional<drivers::onvif::HttpAnswer> take() override;
  int fd() const override;
  const std::string& user() const override;
  std::optional<drivers::onvif::UsernameToken> token(const std::string& created, bool digest) override;
  std::chrono::milliseconds utc() const override;

 private:
  struct Core;
  struct Call;
  std::unique_ptr<Core> core_;
};

// WS-Security UsernameToken Profile 1.0: Base64(SHA-1(nonce + created + password)). nonce: its bytes.
std::string password_digest(const std::string& nonce, const std::string& created,
                            const std::string& password);

// `AB:CD:...` or without colons, in any case, as 64 small hexadecimal digits; empty: it is none.
std::string normal_fingerprint(const std::string& text);

}  // namespace cerberus::heads
