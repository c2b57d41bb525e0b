// SPDX-License-Identifier: LGPL-2.1-or-later
#include "robot.h"

#include <glib-unix.h>
#include <glib/gstdio.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>

#include "page_log.h"
#include "settings_trial.h"
#include "text/file.h"
#if HAVE_SYSTEMD
#include <systemd/sd-daemon.h>
#endif

namespace cerberus::robot {

namespace {

// Seconds within which every camera stops: its files are finished in 3, its pipeline needs a little longer.
constexpr int kPatience = 10;

std::int64_t offset_of_zone(std::int64_t utc) {
  const auto seconds = static_cast<time_t>(utc);
  tm parts{};
  localtime_r(&seconds, &parts);
  return parts.tm_gmtoff;
}

std::int64_t now() {
  return g_get_real_time() / G_USEC_PER_SEC;
}

bool have_stopped(const std::vector<std::unique_ptr<Camera>>& cameras) {
  return std::ranges::all_of(cameras, [](const auto& camera) { return camera->is_stopped(); });
}

std::string stamp_of(const Settings& settings, const std::string& owner) {
  const auto found = settings.stamps.find(owner);
  return found == settings.stamps.end() ? std::string() : found->second;
}

// Whether the page must be made anew: where it listens, or what it says once to each browser.
bool page_differs(const Settings& before, const Settings& after) {
  const auto description = [](const Settings& settings) {
    std::string all = settings.name;
    for (const CameraSettings& camera : settings.cameras)
      all += '\n' + camera.name + (camera.head ? " head" : "") + (camera.recorder ? " recorder" : "") +
             (camera.sensors ? " sensors" : "");
    return all;
  };
  PageSettings page = before.page;
  page.picture_width = after.page.picture_width;  // of the cameras' pipelines
  page.quality = after.page.quality;
  // The page has its own connection to the broker, for the cameras of others.
  return page != after.page || before.base != after.base || before.mqtt != after.mqtt ||
         before.list_cameras != after.list_cameras || stamp_of(before, "page") != stamp_of(after, "page") ||
         stamp_of(before, "mqtt") != stamp_of(after, "mqtt") || description(before) != description(after);
}

void notify([[maybe_unused]] const std::string& text) {
#if HAVE_SYSTEMD
  sd_notify(0, text.c_str());
#endif
}

}  // namespace

bool Robot::open(Settings settings, std::string& error) {
  settings_ = std::move(settings);
  if (settings_.state_folder.empty()) settings_.state_folder = default_state_folder();
  if (g_mkdir_with_parents(settings_.state_folder.c_str(), 0700) != 0) {
    error = settings_.state_folder + ", where the mode is kept, cannot be made: " + g_strerror(errno);
    return false;
  }
  mode_ = std::make_unique<ModeKeeper>(settings_.mode.start, settings_.mode.schedule);
  const std::string path = settings_.state_folder + "/mode";
  const text::File file = text::read_file(path, 4096);
  const bool is_first = file.fault == text::File::Fault::failed && file.error == ENOENT;
  if (!is_first && (file.fault != text::File::Fault::none || !mode_->restore(file.text, now()))) {
    mode_->set(Mode::privacy, now());
    g_printerr("cerberusd: %s cannot be read: privacy mode, until another is set\n", path.c_str());
    save_mode();
  }
  mode_->tick(now(), offset_of_zone);
#if HAVE_PAGE
  collect_log();
#endif
  open_base();
  open_webhook();
  set_publishing();
  take_topics();
  rtsp_.configure(settings_);
  for (const CameraSettings& camera : settings_.cameras) cameras_.push_back(make_camera(camera));
#if HAVE_PAGE
  if (settings_.page.enabled) open_page();
#else
  if (settings_.page.enabled)
    g_printerr("cerberusd: this build has no page (it needs libsoup 3 and libargon2)\n");
#endif
  return true;
}

void Robot::make_folder(const CameraSettings& settings) {
  if (settings.recorder && g_mkdir_with_parents(settings.recorder->folder.c_str(), 0750) != 0)
    g_printerr("cerberusd: %s: the folder of recordings %s cannot be made: %s\n", settings.name.c_str(),
               settings.recorder->folder.c_str(), g_strerror(errno));
}

std::unique_ptr<Camera> Robot::make_camera(const CameraSettings& settings) {
  make_folder(settings);
  auto camera = std::make_unique<Camera>(settings, shared(settings), rtsp_,
                                         [this](const std::string& order) { on_order(order); });
#if HAVE_PAGE
  camera->set_on_publish([this](const Camera& from, const std::string& topic, const std::string& payload) {
    if (webhook_) webhook_->add(from.settings().name, topic, payload);
  });
  camera->set_on_base_request([this](double yaw_rate) {
    if (base_) base_->ask(this->mode() == Mode::privacy || shutting_down_ > 0 ? 0 : yaw_rate);
  });
#endif
  return camera;
}

void Robot::set_publishing() {
  publishing_ = settings_.mqtt;
#if HAVE_PAGE
  // What the webhook sends comes from mqttpublish, which works without a broker too.
  if (webhook_) {
    if (!publishing_) publishing_ = Properties{{"host", ""}};
    publishing_->push_back({"post-topics", settings_.webhook->topics});
  }
#endif
}

void Robot::take_topics() {
#if HAVE_MQTT
  retired_topics_.take(settings_);
#endif
}

// A pipeline with an encoder that is not installed would not run at all: the camera is not served then.
std::optional<RtspSettings> Robot::rtsp_of(const CameraSettings& camera) const {
  if (!settings_.rtsp || !RtspOutput::is_built()) return std::nullopt;
  const RtspSettings& rtsp = *settings_.rtsp;
  const bool encodes_plain = rtsp.plain && !camera.recorder && camera.source.kind != SourceKind::rtsp;
  if (!rtsp.annotated && !encodes_plain) return rtsp;
  g_autoptr(GstElementFactory) encoder = gst_element_factory_find(rtsp.encoder.element.c_str());
  if (encoder) return rtsp;
  g_printerr(
      "cerberusd: %s: RTSP: the encoder %s is not installed (\"encoder\" of [rtsp]); nothing is served\n",
      camera.name.c_str(), rtsp.encoder.element.c_str());
  return std::nullopt;
}

SharedSettings Robot::shared(const CameraSettings& camera) const {
  return {settings_.page, publishing_, rtsp_of(camera),
          stamp_of(settings_, "camera " + camera.name) + stamp_of(settings_, "mqtt")};
}

void Robot::open_base() {
#if HAVE_PAGE
  base_.reset();
  if (!settings_.base) return;
  base_ = std::make_unique<BaseOutput>(*settings_.base);
  base_->set_on_speed([this](double speed) {
    for (const auto& camera : cameras_) camera->note_base_speed(speed);
  });
#endif
}

void Robot::open_webhook() {
#if HAVE_PAGE
  webhook_.reset();
  if (!settings_.webhook) return;
  std::string error;
  g_autoptr(GstElementFactory) publisher = gst_element_factory_find("mqttpublish");
  if (!publisher) error = "this build has no element mqttpublish (libmosquitto), which collects its events";
  webhook_ = std::make_unique<Webhook>(*settings_.webhook, settings_.name);
  if (error.empty() && webhook_->open(error)) return;
  webhook_.reset();
  g_printerr("cerberusd: there is no webhook: %s\n", error.c_str());
#else
  if (settings_.webhook) g_printerr("cerberusd: this build has no webhook (it needs libsoup 3)\n");
#endif
}

#if HAVE_PAGE
// The robot goes on without the page, which is tried again.
void Robot::open_page() {
  page_ = std::make_unique<PageServer>(PageServer::House{settings_, base_.get(), cameras_,
                                                         [this] { return this->mode(); },
                                                         [this](Mode mode) { set_mode(mode); }});
  page_fault_.clear();
  if (page_->open(page_fault_)) return;
  page_.reset();
  const auto wait = page_backoff_.failed(std::chrono::steady_clock::now());
  g_printerr("cerberusd: %s; it is tried again in %d s\n", page_fault_.c_str(),
             static_cast<int>(std::chrono::duration_cast<std::chrono::seconds>(wait).count()));
}
#endif

void Robot::save_mode() {
  const std::string path = settings_.state_folder + "/mode", text = mode_->state();
  g_autoptr(GError) error = nullptr;
  const auto how =
      static_cast<GFileSetContentsFlags>(G_FILE_SET_CONTENTS_CONSISTENT | G_FILE_SET_CONTENTS_DURABLE);
  if (!g_file_set_contents_full(path.c_str(), text.data(), static_cast<gssize>(text.size()), how, 0600,
                                &error))
    g_printerr("cerberusd: the mode will not survive a restart: %s\n", error->message);
}

void Robot::set_mode(Mode mode) {
  mode_->set(mode, now());
  save_mode();
  apply_mode();
}

// By MQTT, after mqttpublish found it allowed. Orders for the head are carried out already.
void Robot::on_order(const std::string& order) {
  const std::optional<Mode> mode = order == "arm"       ? std::optional(Mode::armed)
                                   : order == "disarm"  ? std::optional(Mode::disarmed)
                                   : order == "privacy" ? std::optional(Mode::privacy)
                                                        : std::nullopt;
  g_printerr("cerberusd: MQTT: %s\n", order.c_str());
  // A camera that still publishes while privacy begins must not end it.
  if (mode && this->mode() != Mode::privacy) set_mode(*mode);
}

void Robot::apply_mode() {
  g_printerr("cerberusd: mode %s\n", std::string(name(mode())).c_str());
  for (const auto& camera : cameras_) camera->set_mode(mode());
}

// A configuration with mistakes changes nothing.
void Robot::reload() {
  if (shutting_down_ > 0) return;
  notify("RELOADING=1\nMONOTONIC_USEC=" + std::to_string(g_get_monotonic_time()));
  SettingsFile file = load_();
  refused_ = !file.settings;
  if (refused_)
    g_printerr("%s\ncerberusd: the configuration is refused, and the robot goes on as before\n",
               file.errors.c_str());
  else
    take(*std::move(file.settings));
  notify("READY=1");
}

void Robot::take(Settings settings) {
  if (settings.state_folder.empty()) settings.state_folder = default_state_folder();
  if (settings.state_folder != settings_.state_folder)
    g_printerr("cerberusd: \"state-folder\" stays %s until cerberusd is started anew\n",
               settings_.state_folder.c_str());
  settings.state_folder = settings_.state_folder;
  mode_->set_schedule(settings.mode.schedule);
  [[maybe_unused]] const bool new_page = page_differs(settings_, settings);
#if HAVE_PAGE
  if (new_page) page_.reset();  // before the cameras that it shows
#endif
  const bool new_webhook = settings_.webhook != settings.webhook || settings_.name != settings.name ||
                           stamp_of(settings_, "webhook") != stamp_of(settings, "webhook");
  const bool new_rtsp =
      settings_.rtsp != settings.rtsp || stamp_of(settings_, "rtsp") != stamp_of(settings, "rtsp");
  const bool new_base = settings_.base != settings.base;
  settings_ = std::move(settings);
  if (new_webhook) open_webhook();
  if (new_base) open_base();
  set_publishing();
  take_topics();
  if (new_rtsp) rtsp_.configure(settings_);

  std::vector<std::unique_ptr<Camera>> before = std::move(cameras_);
  cameras_.clear();
  for (const CameraSettings& camera : settings_.cameras) {
    const auto same = [&](const auto& one) { return one && one->settings().name == camera.name; };
    const auto found = std::ranges::find_if(before, same);
    const char* how = "new";
    if (found == before.end()) {
      cameras_.push_back(make_camera(camera));
      cameras_.back()->set_mode(mode());
    } else {
      cameras_.push_back(std::move(*found));
      make_folder(camera);
      switch (cameras_.back()->change(camera, shared(camera))) {
        case Camera::Change::none:
          continue;
        case Camera::Change::live:
          how = "changed while it runs";
          break;
        case Camera::Change::restarts:
          how = "changed, its pipeline starts anew";
          break;
      }
    }
    g_printerr("cerberusd: %s: %s\n", camera.name.c_str(), how);
  }
  for (auto& camera : before) {
    if (!camera) continue;
    g_printerr("cerberusd: %s: removed\n", camera->settings().name.c_str());
    camera->shut_down();
    leaving_.push_back(std::move(camera));
  }
  g_printerr("cerberusd: the configuration is taken\n");
#if HAVE_PAGE
  if (new_page && settings_.page.enabled) open_page();
#endif
}

void Robot::report(const std::string& text) const {
  notify("STATUS=" + text);
}

void Robot::tick() {
  if (shutting_down_ > 0) {
    const bool stopped = have_stopped(cameras_) && have_stopped(leaving_);
    if (stopped || --shutting_down_ == 0) {
      if (!stopped) g_printerr("cerberusd: a camera does not stop\n");
      g_main_loop_quit(loop_);
    }
  } else if (mode_->tick(now(), offset_of_zone)) {
    save_mode();
    apply_mode();
  }
  bool sound = true;
  std::string status(name(mode()));
  for (const auto& camera : cameras_) {
    camera->tick();
    sound = sound && camera->is_sound();
    status += ", " + camera->settings().name + ' ' + robot::name(camera->state());
    if (!camera->fault().empty()) status += " (" + camera->fault() + ')';
  }
  for (const auto& camera : leaving_) {
    camera->tick();
    sound = sound && camera->is_sound();
  }
  std::erase_if(leaving_, [](const auto& camera) { return camera->is_stopped(); });
#if HAVE_MQTT
  const auto stops = [](const auto& camera) { return camera->is_stopping(); };
  if (shutting_down_ == 0) retired_topics_.tick(leaving_.empty() && std::ranges::none_of(cameras_, stops));
#endif
  if (refused_) status += ", configuration refused";
  if (shutting_down_ == 0) rtsp_.tick();
  if (!rtsp_.fault().empty()) status += ", RTSP (" + rtsp_.fault() + ')';
#if HAVE_PAGE
  if (!page_ && settings_.page.enabled && shutting_down_ == 0 &&
      page_backoff_.is_due(std::chrono::steady_clock::now()))
    open_page();
  if (page_) page_->tick();
  if (webhook_) webhook_->tick();
  if (base_) base_->tick();
  if (!page_fault_.empty()) status += ", page (" + page_fault_ + ')';
#endif
  if (sound) notify("WATCHDOG=1");
  if (status != status_) {
    status_ = status;
    report(status);
  }
}

void Robot::begin_shut_down() {
  if (shutting_down_ > 0) {  // the second time: at once
    g_main_loop_quit(loop_);
    return;
  }
  shutting_down_ = kPatience;
  notify("STOPPING=1");
#if HAVE_PAGE
  // From now on nothing steers or drives.
  page_.reset();
  if (base_) base_->stop();
#endif
  for (const auto& camera : cameras_) camera->shut_down();
}

int Robot::run() {
  loop_ = g_main_loop_new(nullptr, FALSE);
  const auto on_signal = [](gpointer robot) {
    static_cast<Robot*>(robot)->begin_shut_down();
    return static_cast<gboolean>(G_SOURCE_CONTINUE);
  };
  g_unix_signal_add(SIGTERM, on_signal, this);
  g_unix_signal_add(SIGINT, on_signal, this);
  g_unix_signal_add(
      SIGHUP,
      [](gpointer robot) {
        static_cast<Robot*>(robot)->reload();
        return static_cast<gboolean>(G_SOURCE_CONTINUE);
      },
      this);
  g_timeout_add_seconds(
      1,
      [](gpointer robot) {
        static_cast<Robot*>(robot)->tick();
        return static_cast<gboolean>(G_SOURCE_CONTINUE);
      },
      this);
  apply_mode();
  notify("READY=1");
  g_main_loop_run(loop_);
  g_main_loop_unref(loop_);
  const bool stopped = have_stopped(cameras_) && have_stopped(leaving_);
#if HAVE_PAGE
  page_.reset();
  webhook_.reset();
  base_.reset();
#endif
  if (!stopped) {
    // To stop a pipeline here could wait for ever for the element that does not stop.
    std::fflush(nullptr);
    _exit(1);
  }
  cameras_.clear();
  leaving_.clear();
  return 0;
}

}  // namespace cerberus::robot
