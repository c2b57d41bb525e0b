// SPDX-License-Identifier: LGPL-2.1-or-later
// What the ONVIF driver needs from outside: HTTP requests that never block, the user's credentials, the wall clock. The
// implementation with libsoup is pipelines/heads/soup_client.h; one thread calls.
#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "drivers/onvif/messages.h"

namespace cerberus::drivers::onvif {

struct HttpRequest {
  unsigned id = 0;
  std::string url;
  std::string action;  // parameter of the content type application/soap+xml
  std::string body;
  std::chrono::milliseconds timeout{2000};
};

struct HttpAnswer {
  unsigned id = 0;
  int status = 0;     // of HTTP; 0: no answer came
  std::string body;   // at most kMostXml bytes
  std::string error;  // why no answer came, for the user
};

class HttpClient {
 public:
  virtual ~HttpClient() = default;
  // Sends a POST. Each one that is not cancelled is answered once through take(). A redirection is not followed.
  virtual void post(const HttpRequest& request) = 0;
  // Closes the connection of a request; the far side may have received it.
  virtual void cancel(unsigned id) = 0;
  virtual std::optional<HttpAnswer> take() = 0;
  // Readable while take() has an answer.
  virtual int fd() const = 0;
  // The user that logs in; empty: none.
  virtual const std::string& user() const = 0;
  // The user's token for a message made at `created` (camera's time), its password digested or in clear. Nothing: there
  // is no user.
  virtual std::optional<UsernameToken> token(const std::string& created, bool digest) = 0;
  // UTC since 1970.
  virtual std::chrono::milliseconds utc() const = 0;
};

}  // namespace cerberus::drivers::onvif
