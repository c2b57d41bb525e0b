// SPDX-License-Identifier: LGPL-2.1-or-later
// Leads a station through the states of its sink: opens and closes the head by the settings, lets the clock's time pass
// where that moves the head, and sends off what the station says. Thread-safe where nothing else is said.
#pragma once

#include <atomic>
#include <mutex>

#include "cerberus/private/element.hpp"
#include "head_controller.hpp"
#include "head_settings.hpp"
#include "shared/times.hpp"
#include "ticker.hpp"

namespace cerberus::plugin {

struct HeadSession {
  GstBaseSink* sink = nullptr;
  Adjustable<HeadSettings> settings;
  HeadController station;
  std::atomic<const char*> head = nullptr;  // its name, interned; that of the last one, if none is open
  std::atomic<double> field_of_view = 0;
  std::atomic<bool> clock_driven = false, playing = false;
  std::atomic<bool> watched = true;  // false: there is no thread to watch over a head that needs one
  std::mutex changing;               // who holds it keeps the clock's time from passing

  // false: the sink has said why. From READY to PAUSED and back.
  bool open();
  void close();
  // Passes on what the settings are now.
  void configure();
  void halt(const char* reason);
  void end();  // of the stream
  void resume();
  // Once the stream has told.
  void set_live(bool live);
  // Lets the clock's time pass from now on, if it moves the head; until pause(). False: there is no thread for it, and
  // the caller says so when it holds no lock.
  bool run();
  void pause();
  // What is to be done then: the head stops, and an error says why. With no lock held.
  void halt_unwatched();

  // A downstream event; a decision between two frames is obeyed.
  void heed(GstEvent* event);

  std::optional<motion::Time> now() const { return clock_now(sink); }
  DeferredNotifications outbox() { return DeferredNotifications(outgoing_, head); }
  void tell(const DeferredNotifications& out) const { out.send(sink); }
  // act(station, now, outbox) -> done
  template <typename Act>
  gboolean by_hand(Act act) {
    return guarded(sink, FALSE, [&]() -> gboolean {
      DeferredNotifications out = outbox();
      const bool done = act(station, now(), out);
      tell(out);
      return done;
    });
  }

 private:
  void hear_soon();
  void hear();
  bool start_ticker();
  GstClockTime tick(GstClockTime time);

  Outgoing outgoing_;
  bool real_ = false;       // the head has a clock of its own
  std::mutex configuring_;  // the newest settings come last
  std::mutex ticker_lock_;  // start and stop; never held by the ticker's own thread
  bool running_ = false;    // from run() to pause(); with that lock
  Ticker ticker_;
};

}  // namespace cerberus::plugin
