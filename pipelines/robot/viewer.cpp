// SPDX-License-Identifier: LGPL-2.1-or-later
#include "viewer.h"

namespace cerberus::robot {

void Viewer::send(const std::string& text) {
  if (is_open()) soup_websocket_connection_send_text(connection_, text.c_str());
}

void Viewer::send_state(const std::string& json) {
  if (states_.size() >= kMostUnacknowledged) return;
  if (states_.empty()) waiting_since_ = Camera::Clock::now();
  states_.push_back(++reported_);
  send("{\"number\":" + std::to_string(reported_) + ',' + json + '}');
}

// Number (8 bytes), length of the facts (4 bytes), both big endian; the facts as JSON; the picture as JPEG.
void Viewer::send_picture() {
  if (pictures_.size() >= kMostUnacknowledged || !is_open()) return;
  guint64 number = 0;
  g_autoptr(GBytes) picture = camera_->picture(number);
  if (picture == nullptr || number == shown_) return;
  shown_ = number;
  const std::string facts = camera_->facts();
  const guint64 sent = GUINT64_TO_BE(++sent_);
  const guint32 length = GUINT32_TO_BE(static_cast<guint32>(facts.size()));
  gsize size = 0;
  const auto* jpeg = static_cast<const char*>(g_bytes_get_data(picture, &size));
  std::string message;
  message.reserve(12 + facts.size() + size);
  message.append(reinterpret_cast<const char*>(&sent), sizeof sent);
  message.append(reinterpret_cast<const char*>(&length), sizeof length);
  message.append(facts).append(jpeg, size);
  soup_websocket_connection_send_binary(connection_, message.data(), message.size());
  pictures_.push_back(sent_);
}

bool Viewer::acknowledge_picture(guint64 number) {
  if (number > sent_) return false;
  std::erase_if(pictures_, [=](guint64 one) { return one <= number; });
  send_picture();
  return true;
}

bool Viewer::acknowledge_state(guint64 number) {
  if (number > reported_) return false;
  if (std::erase_if(states_, [=](guint64 one) { return one <= number; }) > 0)
    waiting_since_ = Camera::Clock::now();
  return true;
}

void Viewer::close(gushort code) {
  if (is_open()) soup_websocket_connection_close(connection_, code, nullptr);
}

}  // namespace cerberus::robot
