// SPDX-License-Identifier: LGPL-2.1-or-later
// The robot: its cameras, the mode that survives a restart, and the reports to the service manager.
#pragma once

#include <glib.h>

#include <memory>
#include <string>
#include <vector>

#include "camera.h"
#if HAVE_PAGE
#include "page_server.h"
#include "webhook.h"
#endif
#include "robot/backoff.h"
#include "robot/mode.h"
#include "robot/settings.h"

namespace cerberus::robot {

class Robot {
 public:
  // Makes the state folder and takes up the mode; false, and what is wrong.
  bool open(Settings settings, std::string& error);
  // Runs until SIGTERM or SIGINT; returns the exit code of the process.
  int run();

  Mode mode() const { return mode_->mode(); }
  void set_mode(Mode mode);

 private:
  void apply_mode();
  void on_order(const std::string& order);
  void save_mode();
#if HAVE_PAGE
  void open_page();
  void open_webhook();
#endif
  void tick();
  void report(const std::string& text) const;
  void begin_shut_down();

  Settings settings_;
  std::unique_ptr<ModeKeeper> mode_;
  std::vector<std::unique_ptr<Camera>> cameras_;
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
};

}  // namespace cerberus::robot
