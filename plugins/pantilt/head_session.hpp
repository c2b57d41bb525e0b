// SPDX-License-Identifier: LGPL-2.1-or-later
// Connects a head controller with the states, the clock and the bus of its sink: opens and closes the head by the
// settings, calls tick() where the clock drives the head, and sends the controller's reports. Thread-safe unless noted
// otherwise.
#pragma once

#include <cerberus/fusion.h>
#include <gst/base/gstbasesink.h>

#include <atomic>
#include <mutex>

#include "cerberus/private/element.hpp"
#include "control/gyro/base_gyro.h"
#include "control/head_controller.h"
#include "head_settings.hpp"
#include "shared/clock_times.hpp"
#include "shared/stamps.hpp"
#include "ticker.hpp"

namespace cerberus::plugin {

// A decision as the controller takes it; the name of its rule is interned.
control::FusionDecision from_c(const CerberusFusion& fusion);

struct HeadSession {
  using Reports = control::DeferredNotifications;

  GstBaseSink* sink = nullptr;
  Adjustable<HeadSettings> settings;
  control::HeadController controller;
  control::BaseGyro gyro;
  std::atomic<const char*> head = nullptr;  // its name, interned; of the last one, if none is open
  std::atomic<double> field_of_view = 0;    // degrees
  std::atomic<bool> clock_driven = false, playing = false;
  std::atomic<bool> chosen = false;  // a track, by an element upstream: follow_query.hpp
  std::atomic<bool> watched = true;  // false: the head needs a ticker and the system has no thread for it
  std::mutex changing;               // keeps the ticker waiting

  // What open() would refuse of the settings, without a look at any device.
  std::string settings_fault() const;
  // From READY to PAUSED and back. Returns false after posting an error.
  bool open();
  void close();
  // Applies the settings. Limits that are refused are a warning, and the properties are set back to those in force.
  void configure();
  void halt(const char* reason);
  void end();  // of the stream
  void resume();
  // Once it is known whether the stream is live.
  void set_live(bool live);
  // Starts the ticker, until pause(), if the clock drives the head. False: there is no thread for it, and the caller
  // calls halt_unwatched() when it holds no lock.
  bool run();
  void pause();
  void halt_unwatched();  // posts the error

  // A downstream event that may be a decision between two frames.
  void on_decision(GstEvent* event);

  std::optional<motion::Time> now() const { return clock_now(sink); }
  Reports reports() { return Reports(queue_, head); }
  void send(const Reports& reports) const;
  // act(controller, now, reports) -> result; then the reports are sent.
  template <typename Act>
  auto with_reports(Act act) {
    Reports out = reports();
    const auto result = act(controller, now(), out);
    send(out);
    return result;
  }

  Stamps stamps;  // of the frames
  std::string camera_name;

 private:
  bool start_gyro(const std::string& which);
  void refusal_soon();
  bool start_ticker();
  GstClockTime tick(GstClockTime time);

  control::NotificationQueue queue_;
  bool real_ = false;       // the head has a clock of its own
  std::mutex configuring_;  // the newest settings come last; of the two that follow
  HeadSettings in_force_;   // with the limits that the controller accepted
  bool opened_ = false;
  std::mutex ticker_lock_;  // start and stop; never held by the ticker's own thread
  bool running_ = false;    // from run() to pause(); with that lock
  Ticker ticker_;
};

}  // namespace cerberus::plugin
