// SPDX-License-Identifier: LGPL-2.1-or-later
#include "publish/webhook_queue.h"

#include <algorithm>

#include "text/json_line.h"
#include "text/utc.h"

namespace cerberus::publish {

std::string webhook_body(std::string_view id, std::string_view robot, std::string_view camera,
                         std::string_view topic, std::chrono::nanoseconds utc, std::string_view data) {
  text::JsonLine line;
  line.open('{').key("id").text(id).key("robot").text(robot).key("camera").text(camera);
  line.key("topic").text(topic).key("utc").string(std::string_view(text::Utc(utc)));
  const bool is_object = data.starts_with('{') && data.ends_with('}');
  if (!is_object) line.key("data").text(data).close('}');
  std::string text(line.finish());
  text.pop_back();  // the newline
  if (is_object) text.append(",\"data\":").append(data).append("}");
  return text;
}

WebhookQueue::Outcome WebhookQueue::outcome_of(unsigned status) {
  if (status >= 200 && status < 300) return Outcome::delivered;
  // RFC 9110: 408 request timeout; RFC 6585: 429 too many requests.
  const bool final = status >= 300 && status < 500 && status != 408 && status != 429;
  return final ? Outcome::refused : Outcome::failed;
}

void WebhookQueue::add(Event event) {
  if (events_.size() >= parameters_.most) {
    // What is on its way stays: its answer is about the first one.
    events_.erase(events_.begin() + (on_its_way_ ? 1 : 0));
    ++dropped_;
  }
  events_.push_back(std::move(event));
}

const WebhookQueue::Event* WebhookQueue::next(Time now) {
  if (on_its_way_ || events_.empty() || now < due_) return nullptr;
  on_its_way_ = true;
  return &events_.front();
}

void WebhookQueue::finished(Outcome outcome, Time now) {
  if (!on_its_way_) return;
  on_its_way_ = false;
  if (outcome == Outcome::failed) {
    const int doublings = std::min(failures_++, 20);
    due_ = now + std::min(parameters_.first * (1 << doublings), parameters_.longest);
    return;
  }
  failures_ = 0;
  if (outcome == Outcome::refused) ++dropped_;
  events_.pop_front();
}

}  // namespace cerberus::publish
