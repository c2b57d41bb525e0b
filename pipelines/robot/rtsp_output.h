// SPDX-License-Identifier: LGPL-2.1-or-later
// The cameras' streams on the robot's RTSP server, which is tried again after failures.
#pragma once

#include <gst/gst.h>

#include <memory>
#include <optional>
#include <string>

#include "robot/settings.h"

namespace cerberus::robot {

class RtspOutput {
 public:
  RtspOutput();
  ~RtspOutput();
  RtspOutput(const RtspOutput&) = delete;
  RtspOutput& operator=(const RtspOutput&) = delete;

  // Whether this build has the server.
  static bool is_built();

  // Opens the server anew, or closes it where the settings have no [rtsp].
  void configure(const Settings& settings);
  // Serves what has begun, and tries again what failed. Once a second.
  void tick();
  const std::string& fault() const { return fault_; }  // empty: there is none

  // The streams of a camera's pipeline may be watched from now on, until hide(). The first time the pipeline does not
  // play yet.
  void show(const std::string& camera, GstElement* pipeline);
  // Nothing of the pipeline is sent from now on; the connections of its clients are closed.
  void hide(const std::string& camera, GstElement* pipeline);
  // The pipeline is gone.
  void forget(const std::string& camera, GstElement* pipeline);

 private:
  struct State;

  void open();

  std::unique_ptr<State> state_;
  std::string fault_;
};

}  // namespace cerberus::robot
