// SPDX-License-Identifier: LGPL-2.1-or-later
// The WebSockets of open pages: what they are sent, and what they ask for.
#include <sys/resource.h>

#include <algorithm>

#include "page_request.h"
#include "record/archive/folder.h"
#include "robot/page/live_settings.h"
#include "sensing/pir_model.h"
#include "text/json_line.h"
#include "text/numbers.h"

namespace cerberus::robot {

namespace {

constexpr std::size_t kMostViewers = 16, kMostOfSession = 4;
constexpr guint kKeepalive = 10;   // seconds between pings; a vanished peer is noticed by TCP then
constexpr double kTurnSpeed = 40;  // degrees a second, as `turn-speed` of pantiltsink by default

AccessTime now() {
  return std::chrono::steady_clock::now();
}

double property(const std::optional<Properties>& properties, std::string_view name, double otherwise) {
  if (properties)
    for (const Property& one : *properties)
      if (one.name == name) return g_ascii_strtod(one.value.c_str(), nullptr);
  return otherwise;
}

std::string property(const Properties& properties, std::string_view name, std::string otherwise) {
  for (const Property& one : properties)
    if (one.name == name) return one.value;
  return otherwise;
}

// The module that the sensors are; nullptr: none in particular.
const sensing::PirPreset* module_of(const Properties& sensors) {
  const std::string name = property(sensors, "preset", std::string("none"));
  const auto all = sensing::pir_presets();
  const auto found = std::ranges::find(all, name, &sensing::PirPreset::name);
  return found == all.end() ? nullptr : &*found;
}

double turn_speed(const Camera& camera) {
  const double speed = property(camera.settings().head, "turn-speed", kTurnSpeed);
  return speed > 0 ? speed : kTurnSpeed;
}

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) / 1e6;
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

}  // namespace

void PageServer::open_socket(SoupServerMessage* message, SoupWebsocketConnection* connection) {
  const Session* session = session_of(message);  // checked by authorize()
  const auto of_session = [&] {
    return std::ranges::count_if(viewers_, [&](const auto& one) { return one->token() == session->token; });
  };
  if (session == nullptr || house_.cameras.empty() || viewers_.size() >= kMostViewers ||
      static_cast<std::size_t>(of_session()) >= kMostOfSession) {
    soup_websocket_connection_close(connection, SOUP_WEBSOCKET_CLOSE_POLICY_VIOLATION,
                                    "too many pages are open");
    return;
  }
  listener_.note(soup_server_message_get_remote_address(message), PageListener::Step::became_socket);
  soup_websocket_connection_set_max_incoming_payload_size(connection, kLongestCommand);
  soup_websocket_connection_set_keepalive_interval(connection, kKeepalive);
  const std::string label = std::string(name(session->role)) + '@' + session->address;
  viewers_.push_back(
      std::make_unique<Viewer>(connection, session->token, label, house_.cameras.front().get()));
  g_signal_connect(connection, "message",
                   G_CALLBACK(+[](SoupWebsocketConnection* from, gint type, GBytes* bytes, gpointer data) {
                     auto& page = *static_cast<PageServer*>(data);
                     gsize size = 0;
                     const auto* text = static_cast<const char*>(g_bytes_get_data(bytes, &size));
                     for (const auto& viewer : page.viewers_) {
                       if (viewer->connection() != from) continue;
                       page.on_text(*viewer, type == SOUP_WEBSOCKET_DATA_TEXT ? std::string_view(text, size)
                                                                              : std::string_view());
                       return;
                     }
                   }),
                   this);
  g_signal_connect(connection, "closed", G_CALLBACK(+[](SoupWebsocketConnection* from, gpointer page) {
                     static_cast<PageServer*>(page)->leave(from);
                   }),
                   this);
  log_access(label, "watches");
  viewers_.back()->send(hello(*session));
  viewers_.back()->send_state(state());
  update_watched();
}

void PageServer::leave(SoupWebsocketConnection* connection) {
  const auto found =
      std::ranges::find(viewers_, connection, [](const auto& viewer) { return viewer->connection(); });
  if (found == viewers_.end()) return;
  const std::unique_ptr<Viewer> viewer = std::move(*found);
  viewers_.erase(found);
  g_signal_handlers_disconnect_by_data(connection, this);
  // A turn ends by itself after 500 ms; here it ends at once.
  const bool another =
      std::ranges::any_of(viewers_, [&](const auto& one) { return one->token() == viewer->token(); });
  if (!another) steering_.let_go(viewer->token());
  if (!another && steering_.is_held_by(viewer->token(), now())) {
    viewer->camera()->turn(0, 0);
    if (house_.base != nullptr) house_.base->stop();
    steering_.release();
  }
  log_access(viewer->label(), "left");
  update_watched();
}

void PageServer::update_watched() {
  for (const auto& camera : house_.cameras)
    camera->set_watched(
        std::ranges::any_of(viewers_, [&](const auto& viewer) { return viewer->camera() == camera.get(); }));
}

// Closes the pages whose session ended, and those that no longer answer.
void PageServer::close_strangers() {
  for (std::size_t k = viewers_.size(); k-- > 0;)
    if (sessions_.find(viewers_[k]->token(), now()) == nullptr || viewers_[k]->is_silent(now()))
      viewers_[k]->close(SOUP_WEBSOCKET_CLOSE_POLICY_VIOLATION);
}

void PageServer::on_text(Viewer& viewer, std::string_view text) {
  const std::optional<PageCommand> command = parse_command(text);
  const Session* session = sessions_.find(viewer.token(), now());
  if (!command || session == nullptr || session->must_set_password) {
    viewer.close(SOUP_WEBSOCKET_CLOSE_POLICY_VIOLATION);
    return;
  }
  if (session->role < needed(*command, house_.mode())) {
    viewer.send("{\"refused\":\"" + std::string(name(session->role)) + " may not do that\"}");
    return;
  }
  execute(viewer, *session, *command);
}

void PageServer::execute(Viewer& viewer, const Session& session, const PageCommand& command) {
  using Kind = PageCommand::Kind;
  switch (command.kind) {
    case Kind::ack:
      if (!viewer.acknowledge_picture(command.number)) viewer.close(SOUP_WEBSOCKET_CLOSE_POLICY_VIOLATION);
      return;
    case Kind::seen:
      if (!viewer.acknowledge_state(command.number)) viewer.close(SOUP_WEBSOCKET_CLOSE_POLICY_VIOLATION);
      return;
    case Kind::camera:
      if (Camera* other = camera(command.name)) {
        // What was sent before is of the camera before.
        viewer.send("{\"shows\":\"" + command.name + "\"}");
        viewer.show(other);
        update_watched();
      }
      return;
    case Kind::mode:
      log_access(viewer.label(), "sets mode " + std::string(name(command.mode)));
      house_.set_mode(command.mode);
      tick();
      return;
    case Kind::stage:
      log_access(viewer.label(), "shows stage " + command.name + " of " + viewer.camera()->settings().name);
      viewer.camera()->set_stage(command.name);
      return;
    case Kind::set:
      if (set(viewer, command)) return;
      viewer.send("{\"refused\":\"this camera has no such setting now\"}");
      return;
    default:
      break;
  }
  // Stop is for everyone who may steer, whoever steers now, and the head is theirs then.
  if (command.kind == Kind::stop) steering_.stop(session.token);
  if (command.kind == Kind::turn || command.kind == Kind::drive) {
    if (command.pan == 0 && command.tilt == 0) steering_.let_go(session.token);
    if (steering_.must_let_go(session.token)) {
      viewer.send("{\"refused\":\"stopped from another page: let go, then steer again\"}");
      return;
    }
  }
  const bool held = steering_.is_held_by(session.token, now());
  if (!steering_.take(session.token, now())) {
    viewer.send("{\"refused\":\"somebody else is steering\"}");
    return;
  }
  if (!held || command.kind == Kind::stop)
    log_access(viewer.label(),
               (command.kind == Kind::stop ? "stops " : "steers ") + viewer.camera()->settings().name);
  steer(viewer, command);
}

void PageServer::steer(Viewer& viewer, const PageCommand& command) {
  using Kind = PageCommand::Kind;
  Camera& camera = *viewer.camera();
  bool done = false;
  if (command.kind == Kind::stop) {
    if (house_.base != nullptr) house_.base->stop();
    done = camera.order("stop") || house_.base != nullptr;
    // A head that may turn the base is stopped with it, whichever camera is shown.
    for (const auto& other : house_.cameras)
      if (property(other->settings().head, "base-turn", 0) > 0) other->order("stop");
    if (done) viewer.send("{\"done\":\"stopped\"}");
  } else if (command.kind == Kind::drive) {
    if (house_.base == nullptr || house_.mode() == Mode::privacy ||
        !house_.base->drive(command.pan, command.tilt))
      viewer.send("{\"refused\":\"the base does not take this order now\"}");
    return;
  } else if (command.kind == Kind::home) {
    done = camera.order("home");
  } else if (command.kind == Kind::automatic) {
    done = camera.order("auto");
    steering_.release();
  } else if (command.kind == Kind::follow) {
    done = camera.follow(static_cast<guint>(command.number));
  } else if (command.kind == Kind::turn) {
    done = camera.turn(command.pan * turn_speed(camera), command.tilt * turn_speed(camera));
  }
  if (!done) viewer.send("{\"refused\":\"the head does not take this order now\"}");
}

bool PageServer::set(Viewer& viewer, const PageCommand& command) {
  const LiveSetting* setting = find_live_setting(command.name);
  if (setting == nullptr ||
      !viewer.camera()->set_live(std::string(setting->element).c_str(),
                                 std::string(setting->property).c_str(), command.value * setting->scale))
    return false;
  log_access(viewer.label(), "sets " + command.name + " of " + viewer.camera()->settings().name + " to " +
                                 text::exact(command.value).string());
  return true;
}

std::string PageServer::hello(const Session& session) const {
  text::JsonLine line;
  line.open('{').key("hello").open('{').key("robot").text(house_.settings.name);
  line.key("role").string(name(session.role)).key("base").boolean(house_.base != nullptr);
  line.key("settings").open('[');
  for (const LiveSetting& one : kLiveSettings) {
    line.open('{').key("name").string(one.name).key("words").text(one.words);
    line.key("least")
        .fixed(one.least, 2)
        .key("most")
        .fixed(one.most, 2)
        .key("head")
        .boolean(one.head)
        .close('}');
  }
  line.close(']').key("cameras").open('[');
  for (const auto& camera : house_.cameras) {
    const CameraSettings& is = camera->settings();
    line.open('{').key("name").text(is.name).key("fov").fixed(is.horizontal_fov, 2);
    line.key("head").boolean(is.head.has_value()).key("recorder").boolean(is.recorder.has_value());
    line.key("pan-min").fixed(property(is.head, "pan-min", -170), 2);
    line.key("pan-max").fixed(property(is.head, "pan-max", 170), 2);
    if (is.sensors) {
      line.key("bearings").text(property(*is.sensors, "bearings", std::string("0,-120,120")));
      const sensing::PirPreset* module = module_of(*is.sensors);
      const double view = module ? sensing::degrees(module->field_of_view) : 120;
      line.key("sensor-fov").fixed(property(is.sensors, "field-of-view", view), 1);
      line.key("sensor-range").fixed(property(is.sensors, "range", module ? module->range : 0), 1);
    }
    line.close('}');
  }
  return std::string(line.close(']').close('}').close('}').finish());
}

std::string PageServer::state() {
  text::JsonLine line;
  line.open('{').key("mode").string(name(house_.mode())).key("cpu");
  const double used = cpu_seconds();
  const gint64 time = g_get_monotonic_time();
  if (measured_ != 0 && time > measured_)
    line.fixed((used - cpu_seconds_) * 1e8 / static_cast<double>(time - measured_), 0);
  else
    line.null();
  // Another number whenever a list of events is out of date: cameras may share a folder.
  guint64 events = changes_;
  for (const auto& camera : house_.cameras) events += camera->changes_of_recordings();
  line.key("events").integer(events);
  line.key("viewers").integer(viewers_.size()).key("cameras").open('[');
  for (const auto& camera : house_.cameras) {
    line.open('{')
        .key("name")
        .text(camera->settings().name)
        .key("state")
        .string(robot::name(camera->state()));
    line.key("fault").text(camera->fault()).key("rate").fixed(camera->frames_a_second(), 1);
    line.key("head").text(camera->head_state()).key("head-reason").text(camera->head_reason());
    line.key("stopped").boolean(camera->waits_for_order());
    line.key("recording").boolean(camera->is_recording());
    line.key("recording-fault").text(camera->recording_fault());
    line.key("settings").open('{');
    for (const LiveSetting& one : kLiveSettings)
      if (const auto value =
              camera->live(std::string(one.element).c_str(), std::string(one.property).c_str()))
        line.key(one.name).fixed(*value / one.scale, 2);
    line.close('}');
    line.key("stage").string(camera->stage()).key("latency").fixed(camera->latency(), 1);
    if (camera->settings().recorder) {
      const auto free = record::Folder(camera->settings().recorder->folder).free_bytes();
      line.key("free").integer(free.value_or(0) >> 20);  // MiB
    }
    line.close('}');
  }
  const std::string_view text = line.close(']').close('}').finish();
  std::string members(text.substr(1, text.size() - 3));
#if HAVE_MQTT
  if (fleet_) members += ",\"fleet\":" + fleet_->fleet().json();
#endif
  return members;
}

void PageServer::tick() {
  end_revoked_devices();
  close_strangers();
  const std::string now_is = state();
  for (const auto& viewer : viewers_) viewer->send_state(now_is);
  cpu_seconds_ = cpu_seconds();
  measured_ = g_get_monotonic_time();
}

}  // namespace cerberus::robot
