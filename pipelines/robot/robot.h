// SPDX-License-Identifier: LGPL-2.1-or-later
// The robot: its cameras, the mode that survives a restart, and the reports to the service manager.
#pragma once

#include <glib.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "camera.h"
#if HAVE_PAGE
#include "page_server.h"
#include "webhook.h"
#endif
#include "broker.h"
#include "robot/backoff.h"
#include "robot/mode.h"
#include "robot/settings.h"
#include "robot/settings_file.h"
#include "rtsp_output.h"

namespace cerberus::robot {

class Robot {
 public:
  // `load` reads the configuration file again.
  explicit Robot(std::function<SettingsFile()> load) : load_(std::move(load)) {}

  // Makes the state folder and takes up the mode; false, and what is wrong.
  bool open(Settings settings, std::string& error);
  // Runs until SIGTERM or SIGINT, and reads the configuration again at SIGHUP; returns the exit code of the process.
  int run();

  Mode mode() const { return mode_->mode(); }
  void set_mode(Mode mode);

 private:
  void apply_mode();
  void on_order(const std::string& order);
  void save_mode();
#if HAVE_PAGE
  void open_page();
#endif
  void open_webhook();    // and closes the one before
  void open_base();       // the same
  void set_publishing();  // what the cameras publish: by MQTT, and for the webhook
  void take_topics();     // that cameras leave at the broker
  SharedSettings shared(const CameraSettings& camera) const;
  std::optional<RtspSettings> rtsp_of(const CameraSettings& camera) const;
  void tick();
  void report(const std::string& text) const;
  void begin_shut_down();
  static void make_folder(const CameraSettings& settings);  // of its recordings
  std::unique_ptr<Camera> make_camera(const CameraSettings& settings);
  void reload();
  void take(Settings settings);

  std::function<SettingsFile()> load_;
  Settings settings_;
  std::optional<Properties> publishing_;  // of mqttpublish
  std::unique_ptr<ModeKeeper> mode_;
  RtspOutput rtsp_;  // outlives the cameras
  std::vector<std::unique_ptr<Camera>> cameras_;
  std::vector<std::unique_ptr<Camera>> leaving_;  // no longer in the configuration, until they have stopped
#if HAVE_MQTT
  RetiredTopics retired_topics_;
#endif
#if HAVE_PAGE
  std::unique_ptr<PageServer> page_;
  std::unique_ptr<Webhook> webhook_;
  std::unique_ptr<BaseOutput> base_;
  Backoff page_backoff_;
  std::string page_fault_;
#endif
  GMainLoop* loop_ = nullptr;
  int shutting_down_ = 0;  // seconds left; 0: not
  std::string status_;
  bool refused_ = false;  // the configuration that was read last has mistakes
};

}  // namespace cerberus::robot
