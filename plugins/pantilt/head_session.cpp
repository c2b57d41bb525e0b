// SPDX-License-Identifier: LGPL-2.1-or-later
#include "head_session.hpp"

#include <cerberus/cerberus.h>

#include "cerberus/private/messages.hpp"
#include "drivers/head/head_calibration.h"
#include "drivers/head/head_lease.h"
#include "drivers/head/head_place.h"
#include "drivers/iio/iio_gyro.h"
#include "shared/choices.hpp"
#include "shared/poses.hpp"

namespace cerberus::plugin {

namespace {

// A change of state takes at most these together, whatever the driver does (100 ms is promised).
constexpr auto kOpenPatience = std::chrono::milliseconds(60);
constexpr auto kClosePatience = std::chrono::milliseconds(30);
constexpr auto kHaltPatience = std::chrono::milliseconds(30);

CerberusPose pose_of(const char* head, const motion::Pose& pose) {
  CerberusPose out = to_c(pose);
  if (head) out.head = head;
  return out;
}

void refuse(GstElement* element, const char* head, const std::string& why) {
  CERBERUS_ELEMENT_ERROR(
      element, RESOURCE, OPEN_READ_WRITE,
      ("The head \"%s\" cannot be opened: %s%s", head, why.c_str(), why.ends_with('.') ? "" : "."),
      (nullptr));
}

static_assert(static_cast<int>(control::HeadState::stopped) == CERBERUS_PANTILT_STOPPED &&
              static_cast<int>(control::HeadState::holding) == CERBERUS_PANTILT_HOLDING &&
              static_cast<int>(control::HeadState::homing) == CERBERUS_PANTILT_HOMING);

// Posts one notice.
struct Posting {
  GstElement* sink;
  const char* head;
  const Stamps& stamps;

  void operator()(const control::Status& status) const {
    CerberusPantilt pantilt;
    cerberus_pantilt_init(&pantilt);
    pantilt.state = static_cast<CerberusPantiltState>(status.state);
    pantilt.pose = pose_of(head, status.pose);
    std::string reason = status.reason;
    pantilt.reason = reason.data();
    pantilt.waits_for_order = status.waits_for_order;
    const CerberusStamp stamp = stamps.at(clock_time(status.time));
    gst_element_post_message(sink, cerberus_message_new_pantilt(GST_OBJECT(sink), &stamp, &pantilt));
  }
  void operator()(const control::Refusal& refusal) const { refuse(sink, head, refusal.why); }
  void operator()(const control::Fault& fault) const {
    CERBERUS_ELEMENT_WARNING(sink, RESOURCE, WRITE, ("The head \"%s\" fails: %s", head, fault.what.c_str()),
                             (nullptr));
  }
  void operator()(const control::UnknownZoom&) const {
    CERBERUS_ELEMENT_WARNING(
        sink, RESOURCE, SETTINGS,
        ("The head \"%s\" has a zoom, and every angle depends on it: set zoom-table, or keep "
         "the zoom by lock-zoom.",
         head),
        (nullptr));
  }
  void operator()(const control::BaseTurnRequest& request) const {
    gst_element_post_message(
        sink, gst_message_new_element(
                  GST_OBJECT(sink),
                  gst_structure_new("cerberus-base-request", "head", G_TYPE_STRING, head, "yaw-rate",
                                    G_TYPE_DOUBLE, sensing::degrees(request.yaw_rate), nullptr)));
  }
  void operator()(const control::MissingGyro&) const {
    CERBERUS_ELEMENT_WARNING(
        sink, RESOURCE, SETTINGS,
        ("The body below the head \"%s\" turns while the head does, the head reports no position, and "
         "nothing "
         "measures the body's turn: a gyro is missing (base-gyro, or cerberus-base events). Where the head "
         "looks is uncertain meanwhile.",
         head),
        (nullptr));
  }
  void operator()(const control::Lost& lost) const {
    CERBERUS_ELEMENT_WARNING(
        sink, RESOURCE, NOT_FOUND,
        ("Track %u, which was to be followed, is on no frame for %d s: the usual choice goes on.", lost.id,
         static_cast<int>(fusion::TargetOverride::kPatience / std::chrono::seconds(1))),
        ("head %s", head));
  }
};

// The head's driver, and its setup complete; nullptr: `wrong` has the reason.
std::unique_ptr<drivers::Head> prepare(const HeadSettings& s, drivers::HeadSetup& setup, std::string& wrong) {
  if (!g_utf8_validate(s.head.c_str(), -1, nullptr))  // no event could carry it
    wrong.append("The head's name \"").append(s.head).append("\" is no UTF-8: give it another (head=)");
  if (wrong.empty()) wrong = motion::check(setup.limits);
  if (wrong.empty() && !s.calibration.empty())
    wrong = drivers::use_calibration(s.calibration, s.driver, setup);
  if (wrong.empty()) {
    wrong = setup.zoom_table.parse(s.zoom_table);
    if (!wrong.empty()) wrong += " (zoom-table)";
  }
  if (wrong.empty() && s.keep_size && s.lock_zoom >= 0)
    wrong = "lock-zoom keeps the zoom that keep-size moves: set one of them";
  if (wrong.empty() && s.keep_size && setup.zoom_table.empty())
    wrong =
        "keep-size needs a zoom-table: no protocol says what the camera sees at the positions of its zoom";
  auto head = drivers::make_head(s.driver);
  if (wrong.empty() && !head)
    wrong.append("There is no head driver \"").append(s.driver).append("\": take one of ") +=
        drivers::head_drivers();
  return wrong.empty() ? std::move(head) : nullptr;
}

// A head that is open, or being opened, and that no other sink of this process drives. nullptr: `element` has posted
// why not. moved, refused: as of the runner.
std::unique_ptr<drivers::HeadRunner> open_head(GstElement* element, const HeadSettings& s,
                                               drivers::HeadSetup& setup, std::function<void()> moved,
                                               std::function<void()> refused) {
  const char* name = s.head.c_str();
  std::string wrong;
  auto head = prepare(s, setup, wrong);
  if (!head) {
    CERBERUS_ELEMENT_ERROR(element, RESOURCE, SETTINGS, (wrong + "."), ("head %s", name));
    return nullptr;
  }
  const std::string place = drivers::head_place(s.driver, setup.device, drivers::option_words(setup.options));
  auto lease = drivers::HeadLease::take(s.head, place);
  if (!lease) {
    const bool named = drivers::HeadLease::is_taken(s.head);
    CERBERUS_ELEMENT_ERROR(element, RESOURCE, BUSY,
                           ("Another pantiltsink drives the head %s%s%s already: %s.", named ? "\"" : "at ",
                            named ? name : place.c_str(), named ? "\"" : "",
                            named ? "give each its own name (head=)" : "a head has one sink"),
                           (nullptr));
    return nullptr;
  }
  auto runner = std::make_unique<drivers::HeadRunner>(std::move(head), std::move(lease), std::move(moved),
                                                      std::move(refused));
  runner->set_close_patience(kClosePatience);
  if (runner->open(setup, kOpenPatience) == drivers::HeadRunner::Answer::failed) {
    refuse(element, name, runner->refusal());
    return nullptr;
  }
  return runner;
}

}  // namespace

control::FusionDecision from_c(const CerberusFusion& fusion) {
  control::FusionDecision decision;
  decision.made.action = static_cast<fusion::Action>(fusion.action);
  decision.made.rule = fusion.rule;
  decision.made.rule_name = fusion.rule_name;
  decision.made.target = fusion.target;
  decision.made.immediate = fusion.immediate;
  decision.made.sector = {sensing::radians(fusion.sector_from), sensing::radians(fusion.sector_to)};
  if (GST_CLOCK_TIME_IS_VALID(fusion.decided)) decision.decided = time_of(fusion.decided);
  return decision;
}

std::string HeadSession::settings_fault() const {
  const HeadSettings s = settings.snapshot();
  drivers::HeadSetup setup = head_setup(s);
  std::string wrong;
  const auto head = prepare(s, setup, wrong);
  if (head) wrong = head->check(setup);
  drivers::GyroSetup gyro_setup;
  if (wrong.empty() && !s.base_gyro.empty()) {
    wrong = drivers::parse_gyro(s.base_gyro, gyro_setup);
    if (!wrong.empty()) wrong += " (base-gyro)";
  }
  return wrong;
}

void HeadSession::send(const Reports& reports) const {
  reports.send(
      [this](const char* whose, const motion::Pose& pose) {
        const CerberusPose event = pose_of(whose, pose);
        gst_pad_push_event(GST_BASE_SINK_PAD(sink), cerberus_event_new_pose(&event));
      },
      [this](const char* whose, const control::Notice& notice) {
        std::visit(Posting{GST_ELEMENT(sink), whose, stamps}, notice);
      });
}

// On a thread of GStreamer's: posting a message may take long, and the driver's thread must not wait for it.
void HeadSession::refusal_soon() {
  gst_element_call_async(
      GST_ELEMENT(sink),
      [](GstElement*, gpointer session) {
        auto* self = static_cast<HeadSession*>(session);
        guarded(self->sink, [&] {
          Reports out = self->reports();
          self->controller.on_refusal(out);
          self->send(out);
        });
      },
      this, nullptr);
}

// False: an error was posted. A gyro that cannot be opened is an error later.
bool HeadSession::start_gyro(const std::string& which) {
  const auto publish = [this](motion::Time time, double rate) {
    CerberusBase base;
    cerberus_base_init(&base);
    base.yaw_rate = sensing::degrees(rate);
    base.valid_from = clock_time(time);
    gst_pad_push_event(GST_BASE_SINK_PAD(sink), cerberus_event_new_base(&base));
  };
  const auto report = [this](const drivers::SensorError& error, bool final) {
    if (final)
      CERBERUS_ELEMENT_ERROR(sink, RESOURCE, OPEN_READ, (error.text), (error.detail));
    else if (error)
      CERBERUS_ELEMENT_WARNING(sink, RESOURCE, READ, (error.text + " The picture's estimate counts."),
                               (error.detail));
    else
      CERBERUS_ELEMENT_INFO(sink, RESOURCE, READ, ("The base's gyro works again."), (nullptr));
  };
  const std::string wrong = gyro.start(which, {[this] { return now(); }, publish, report});
  if (!wrong.empty()) CERBERUS_ELEMENT_ERROR(sink, RESOURCE, SETTINGS, (wrong + " (base-gyro)."), (nullptr));
  return wrong.empty();
}

bool HeadSession::open() {
  const HeadSettings s = settings.snapshot();
  drivers::HeadSetup setup = head_setup(s);
  auto runner =
      open_head(GST_ELEMENT(sink), s, setup, [this] { ticker_.wake(); }, [this] { refusal_soon(); });
  if (!runner || !start_gyro(s.base_gyro)) return false;
  head = g_intern_string(s.head.c_str());
  camera_name = s.camera_name;
  stamps.reset();
  clock_driven = real_ = !runner->simulated();
  {
    const std::lock_guard guard(configuring_);
    in_force_ = s;
    opened_ = true;
  }
  controller.open(std::move(runner), setup);
  controller.set_clock_driven(clock_driven);
  configure();  // what has changed meanwhile, too
  Reports out = reports();
  controller.on_refusal(out);  // what the driver reported while the controller had no head
  send(out);
  return true;
}

void HeadSession::close() {
  gyro.stop();
  pause();
  halt("stopped");
  controller.close(kClosePatience);
  const std::lock_guard guard(configuring_);
  opened_ = false;
}

void HeadSession::configure() {
  std::string wrong;
  {
    const std::lock_guard guard(configuring_);
    const HeadSettings s = settings.snapshot();
    field_of_view = s.horizontal_fov;
    controller.set_manual_timeout(time_of(s.manual_timeout));
    controller.set_options(law_options(s), fuser_options(s), time_of(s.watchdog_timeout));
    if (opened_) wrong = controller.set_limits(head_limits(s), now());
    if (wrong.empty())
      in_force_ = s;
    else
      settings.adjust([this](HeadSettings& set) { copy_limits(in_force_, set); });
  }
  if (!wrong.empty())
    CERBERUS_ELEMENT_WARNING(sink, RESOURCE, SETTINGS, ("%s. The limits stay as they were.", wrong.c_str()),
                             ("head %s", head.load()));
}

void HeadSession::halt(const char* reason) {
  Reports out = reports();
  controller.halt(reason, now(), kHaltPatience, out);
  send(out);
}

void HeadSession::end() {
  Reports out = reports();
  controller.end(now(), kHaltPatience, out);
  send(out);
}

void HeadSession::resume() {
  Reports out = reports();
  controller.resume(now(), out);
  send(out);
}

void HeadSession::set_live(bool live) {
  clock_driven = live || real_;
  controller.set_clock_driven(clock_driven);
  bool new_lack = false;
  {
    const std::lock_guard guard(ticker_lock_);
    new_lack = watched && !start_ticker();
  }
  if (new_lack) halt_unwatched();
}

void HeadSession::on_decision(GstEvent* event) {
  g_autoptr(CerberusFusion) fusion = cerberus_event_parse_fusion(event);
  if (!fusion || !playing || (fusion->head && !g_str_equal(fusion->head, head.load()))) return;
  const auto at = now();
  if (!at) return;
  Reports out = reports();
  controller.on_decision(from_c(*fusion), *at, out);
  send(out);
}

GstClockTime HeadSession::tick(GstClockTime time) {
  {
    const std::lock_guard wait(changing);
  }
  Reports out = reports();
  GstClockTime next = time + 20 * GST_MSECOND;
  if (const auto running = now())
    guarded(sink, [&] { next = time + clock_time(controller.tick(*running, out) - *running); });
  send(out);
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
  Reports out = reports();
  controller.halt("no thread for the watchdog", now(), kHaltPatience, out);
  CERBERUS_ELEMENT_ERROR(sink, RESOURCE, FAILED,
                         ("The head \"%s\" is not moved: there is no thread to watch over it.", head.load()),
                         ("the system gives none: too many of this user or process, or too little memory"));
  send(out);
}

void HeadSession::pause() {
  const std::lock_guard guard(ticker_lock_);
  playing = running_ = false;
  ticker_.stop();
  watched = true;
}

}  // namespace cerberus::plugin
