// SPDX-License-Identifier: LGPL-2.1-or-later
// One open page: its WebSocket, and what it has not acknowledged yet.
#pragma once

#include <libsoup/soup.h>

#include <string>
#include <vector>

#include "camera.h"

namespace cerberus::robot {

class Viewer {
 public:
  // Pictures, and reports of state, that are on their way at most: a page that does not answer is sent nothing more.
  static constexpr std::size_t kMostUnacknowledged = 2;
  // So long a report may stay unacknowledged: a page that was suspended comes back by a new socket.
  static constexpr std::chrono::seconds kPatience{30};

  Viewer(SoupWebsocketConnection* connection, std::string token, std::string label, Camera* camera)
      : connection_(SOUP_WEBSOCKET_CONNECTION(g_object_ref(connection))),
        token_(std::move(token)),
        label_(std::move(label)),
        camera_(camera) {}
  ~Viewer() { g_object_unref(connection_); }
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  const std::string& token() const { return token_; }
  const std::string& label() const { return label_; }  // for the access log
  Camera* camera() const { return camera_; }
  SoupWebsocketConnection* connection() const { return connection_; }

  void show(Camera* camera) {
    camera_ = camera;
    shown_ = 0;
    send_picture();
  }
  // Sends the newest picture unless it was sent or too many are on their way.
  void send_picture();
  void send_state(const std::string& json);  // an object's members, to which a number is added
  void send(const std::string& text);
  // False: there was no such number yet.
  bool acknowledge_picture(guint64 number);
  bool acknowledge_state(guint64 number);
  // Whether it has not acknowledged a report for longer than kPatience.
  bool is_silent(Camera::Clock::time_point now) const {
    return !states_.empty() && now - waiting_since_ > kPatience;
  }
  void close(gushort code);

 private:
  bool is_open() const {
    return soup_websocket_connection_get_state(connection_) == SOUP_WEBSOCKET_STATE_OPEN;
  }

  SoupWebsocketConnection* connection_;
  std::string token_, label_;
  Camera* camera_;
  guint64 shown_ = 0, sent_ = 0, reported_ = 0;
  std::vector<guint64> pictures_, states_;     // not acknowledged
  Camera::Clock::time_point waiting_since_{};  // for the acknowledgement of states_.front()
};

}  // namespace cerberus::robot
