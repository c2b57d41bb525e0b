// SPDX-License-Identifier: LGPL-2.1-or-later
// SOAP requests to one camera: signs them at the camera's time, and reads what comes back.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "drivers/onvif/address.h"
#include "drivers/onvif/answers.h"
#include "drivers/onvif/soap/http_client.h"
#include "motion/pose.h"

namespace cerberus::drivers::onvif {

using motion::Time;

struct SoapAnswer {
  unsigned id = 0;
  bool arrived = false;                 // an HTTP answer came, whatever it holds
  std::optional<XmlDocument> document;  // readable SOAP
  XmlElement body;                      // of `document`
  std::optional<Fault> fault;           // a fault, or HTTP's 401 as NotAuthorized
  std::string wrong;                    // why there is neither an answer nor a fault, for the user

  bool bad_request = false;  // likewise, by HTTP's 400: the camera did not understand the request

  bool good() const { return body && !fault; }
  bool not_authorized() const { return fault && fault->not_authorized(); }
};

class SoapClient {
 public:
  explicit SoapClient(std::unique_ptr<HttpClient> http) : http_(std::move(http)) {}
  // Returns the request's identity, never 0. signed: with the user's token.
  unsigned send(const Address& to, const Request& request, Time now, Time timeout, bool with_token = true);
  void cancel(unsigned id);
  std::optional<SoapAnswer> take(Time now);
  int fd() const { return http_->fd(); }
  const std::string& user() const { return http_->user(); }

  // The camera's clock showed `camera` when this one showed `now`.
  void set_camera_time(std::chrono::milliseconds camera, Time now);
  // From now on passwords are sent in clear: over an encrypted connection, or because the user asked for it.
  void send_passwords_in_clear(bool in_clear) { in_clear_ = in_clear; }
  bool passwords_in_clear() const { return in_clear_; }
  // When the oldest request was sent after which nothing has arrived; nothing: all is answered.
  std::optional<Time> unanswered() const { return unanswered_; }

 private:
  std::string created(Time now) const;

  std::unique_ptr<HttpClient> http_;
  unsigned last_id_ = 0;
  bool in_clear_ = false;
  std::string secret_;  // the password that was sent in clear: no camera may repeat it in an error text
  std::optional<std::chrono::milliseconds> camera_time_;
  Time camera_time_at_{};
  std::map<unsigned, Time> sent_;  // requests under way
  std::optional<Time> unanswered_;
};

}  // namespace cerberus::drivers::onvif
