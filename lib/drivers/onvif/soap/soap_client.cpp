// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/onvif/soap/soap_client.h"

#include <utility>

namespace cerberus::drivers::onvif {

namespace {

constexpr int kBadRequest = 400, kUnauthorized = 401;

}  // namespace

std::string SoapClient::created(Time now) const {
  using std::chrono::duration_cast, std::chrono::milliseconds;
  return utc_text(camera_time_ ? *camera_time_ + duration_cast<milliseconds>(now - camera_time_at_)
                               : http_->utc());
}

unsigned SoapClient::send(const Address& to, const Request& request, Time now, Time timeout,
                          bool with_token) {
  std::optional<UsernameToken> token;
  if (with_token) token = http_->token(created(now), !in_clear_);
  if (token && !token->digest) secret_ = token->password;
  const unsigned id = ++last_id_ == 0 ? ++last_id_ : last_id_;
  http_->post({.id = id,
               .url = to.url(),
               .action = request.action,
               .body = envelope(request, token),
               .timeout = std::chrono::duration_cast<std::chrono::milliseconds>(timeout)});
  sent_.emplace(id, now);
  if (!unanswered_) unanswered_ = now;
  return id;
}

void SoapClient::cancel(unsigned id) {
  if (sent_.erase(id) != 0) http_->cancel(id);
}

std::optional<SoapAnswer> SoapClient::take(Time) {
  for (auto http = http_->take(); http; http = http_->take()) {
    if (sent_.erase(http->id) == 0) continue;  // cancelled meanwhile
    SoapAnswer answer;
    answer.id = http->id;
    answer.arrived = http->status != 0;
    if (answer.arrived) unanswered_.reset();
    if (!answer.arrived) {
      answer.wrong = std::move(http->error);
      return answer;
    }
    answer.document = XmlDocument::parse(http->body);
    if (answer.document) answer.body = body_of(*answer.document);
    answer.fault = read_fault(answer.body);
    if (answer.fault && !secret_.empty() && answer.fault->text().find(secret_) != std::string::npos)
      answer.fault->reason.clear();
    if (http->status == kUnauthorized && !(answer.fault && answer.fault->not_authorized()))
      answer.fault = Fault{"NotAuthorized", {"NotAuthorized"}, "HTTP 401"};
    answer.bad_request = http->status == kBadRequest && !answer.body && !answer.fault;
    if (!answer.body && !answer.fault)
      answer.wrong = "it answers what is no SOAP (HTTP " + std::to_string(http->status) + ")";
    return answer;
  }
  return std::nullopt;
}

void SoapClient::set_camera_time(std::chrono::milliseconds camera, Time now) {
  camera_time_ = camera;
  camera_time_at_ = now;
}

}  // namespace cerberus::drivers::onvif
