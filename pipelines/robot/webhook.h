// SPDX-License-Identifier: LGPL-2.1-or-later
// Sends events to a web server, signed: docs/manual/webhook.md. Main loop's thread; nothing waits for it.
#pragma once

#include <libsoup/soup.h>

#include <memory>
#include <string>

#include "publish/webhook_queue.h"
#include "robot/settings.h"

namespace cerberus::robot {

class Webhook {
 public:
  Webhook(WebhookSettings settings, std::string robot);
  ~Webhook();
  Webhook(const Webhook&) = delete;
  Webhook& operator=(const Webhook&) = delete;

  // Reads the secret; false, and what is wrong.
  bool open(std::string& error);
  void add(const std::string& camera, const std::string& topic, const std::string& payload);
  // Once a second: sends again what failed.
  void tick() { send(); }

 private:
  struct Attempt;
  void send();
  void finished(SoupMessage* message, const std::string& fault);

  WebhookSettings settings_;
  std::string robot_, secret_, run_;
  SoupSession* session_ = nullptr;
  std::shared_ptr<Webhook*> self_ = std::make_shared<Webhook*>(this);  // an answer may outlive this
  publish::WebhookQueue queue_;
  std::uint64_t number_ = 0, reported_ = 0;
};

}  // namespace cerberus::robot
