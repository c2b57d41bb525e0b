// SPDX-License-Identifier: LGPL-2.1-or-later
#include "head_session.hpp"

#include "head_opening.hpp"

namespace cerberus::plugin {

namespace {

// As kOpenPatience.
constexpr auto kHaltPatience = std::chrono::milliseconds(30);

}  // namespace

// On a thread of GStreamer's: a message may keep whoever posts it, and a driver's thread is not to be kept.
void HeadSession::hear_soon() {
  gst_element_call_async(
      GST_ELEMENT(sink),
      [](GstElement*, gpointer conductor) {
        auto* self = static_cast<HeadSession*>(conductor);
        guarded(self->sink, [&] { self->hear(); });
      },
      this, nullptr);
}

void HeadSession::hear() {
  DeferredNotifications out = outbox();
  station.hear(out);
  tell(out);
}

bool HeadSession::open() {
  const HeadSettings s = settings.snapshot();
  auto runner = open_head(GST_ELEMENT(sink), s, [this] { ticker_.wake(); }, [this] { hear_soon(); });
  if (!runner) return false;
  head = g_intern_string(s.head.c_str());
  clock_driven = real_ = !runner->simulated();
  station.open(std::move(runner), head_setup(s));
  station.set_clock_driven(clock_driven);
  configure();  // what has changed meanwhile, too
  hear();       // what the driver said while the station had no head
  return true;
}

void HeadSession::close() {
  pause();
  halt("stopped");
  station.close(kClosePatience);
}

void HeadSession::configure() {
  std::string wrong;
  {
    const std::lock_guard guard(configuring_);
    const HeadSettings s = settings.snapshot();
    field_of_view = s.horizontal_fov;
    station.set_options(law_options(s), fuser_options(s), time_of(s.watchdog_timeout));
    wrong = station.set_limits(head_limits(s), now());
  }
  if (!wrong.empty())
    CERBERUS_ELEMENT_WARNING(sink, RESOURCE, SETTINGS, ("%s. The limits stay as they were.", wrong.c_str()),
                             ("head %s", head.load()));
}

void HeadSession::halt(const char* reason) {
  DeferredNotifications out = outbox();
  station.halt(reason, now(), kHaltPatience, out);
  tell(out);
}

void HeadSession::end() {
  DeferredNotifications out = outbox();
  station.end(now(), kHaltPatience, out);
  tell(out);
}

void HeadSession::resume() {
  DeferredNotifications out = outbox();
  station.resume(now(), out);
  tell(out);
}

void HeadSession::set_live(bool live) {
  clock_driven = live || real_;
  station.set_clock_driven(clock_driven);
  bool new_lack = false;
  {
    const std::lock_guard guard(ticker_lock_);
    new_lack = watched && !start_ticker();
  }
  if (new_lack) halt_unwatched();
}

void HeadSession::heed(GstEvent* event) {
  g_autoptr(CerberusFusion) fusion = cerberus_event_parse_fusion(event);
  if (!fusion || !playing || (fusion->head && !g_str_equal(fusion->head, head.load()))) return;
  const auto at = now();
  if (!at) return;
  DeferredNotifications out = outbox();
  station.heed(*fusion, *at, out);
  tell(out);
}

GstClockTime HeadSession::tick(GstClockTime time) {
  {
    const std::lock_guard wait(changing);
  }
  DeferredNotifications out = outbox();
  GstClockTime next = time + 20 * GST_MSECOND;
  if (const auto running = now())
    guarded(sink, [&] { next = time + clock_time(station.tick(*running, out) - *running); });
  tell(out);
  return next;
}

// False: there is no thread. With ticker_lock_ held.
bool HeadSession::start_ticker() {
  if (!running_ || !clock_driven) return true;
  g_autoptr(GstClock) clock = gst_element_get_clock(GST_ELEMENT(sink));
  if (!clock) return true;
  const bool started = ticker_.start(clock, [this](GstClockTime time) { return tick(time); });
  watched = started;
  return started;
}

bool HeadSession::run() {
  const std::lock_guard guard(ticker_lock_);
  running_ = true;
  return start_ticker();
}

void HeadSession::halt_unwatched() {
  DeferredNotifications out = outbox();
  station.halt("nobody watches over it", now(), kHaltPatience, out);
  CERBERUS_ELEMENT_ERROR(sink, RESOURCE, FAILED,
                         ("The head \"%s\" is not moved: there is no thread to watch over it.", head.load()),
                         ("the system gives none: too many of this user or process, or too little memory"));
  tell(out);
}

void HeadSession::pause() {
  const std::lock_guard guard(ticker_lock_);
  playing = running_ = false;
  ticker_.stop();
  watched = true;
}

}  // namespace cerberus::plugin
