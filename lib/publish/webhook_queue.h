// SPDX-License-Identifier: LGPL-2.1-or-later
// The events that wait for a webhook: a bounded queue in order, one on its way at a time, tried again with back-off. Time
// is a parameter. What is sent: docs/manual/webhook.md.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <string>
#include <string_view>

namespace cerberus::publish {

// The JSON body of one event. `data`: a JSON object, or a text (as of the topics mode and status). `utc` since 1970.
std::string webhook_body(std::string_view id, std::string_view robot, std::string_view camera,
                         std::string_view topic, std::chrono::nanoseconds utc, std::string_view data);

class WebhookQueue {
 public:
  using Time = std::chrono::steady_clock::time_point;

  struct Parameters {
    std::size_t most = 256;  // events that wait; more would be hours old: the oldest is dropped
    std::chrono::seconds first{
        1};  // convention, as in robot/backoff.h: a receiver that restarts is back in seconds
    std::chrono::seconds longest{60};
  };
  struct Event {
    std::string id, body;
  };
  enum class Outcome : std::uint8_t {
    delivered,
    failed,   // no answer, or one that may change: tried again
    refused,  // an answer that a repetition does not change: dropped
  };
  // What an HTTP status means; 0: there was no answer.
  static Outcome outcome_of(unsigned status);

  WebhookQueue() = default;
  explicit WebhookQueue(const Parameters& parameters) : parameters_(parameters) {}

  void add(Event event);
  // The event to send at `now`, which is on its way until finished(); nullptr: none is due, or one is on its way.
  const Event* next(Time now);
  void finished(Outcome outcome, Time now);

  std::size_t waiting() const { return events_.size(); }
  std::uint64_t dropped() const { return dropped_; }  // because too many waited, or the receiver refused them
  int failures() const { return failures_; }          // since the last one that was delivered

 private:
  Parameters parameters_;
  std::deque<Event> events_;
  bool on_its_way_ = false;
  int failures_ = 0;
  Time due_{};
  std::uint64_t dropped_ = 0;
};

}  // namespace cerberus::publish
