// SPDX-License-Identifier: LGPL-2.1-or-later
// The properties of a camera's elements: before its pipeline starts, as the mode changes, when the configuration or the
// page changes them; and the orders for its head.
#include "camera.h"

#include <cerberus/cerberus.h>

#include <cmath>
#include <limits>

#include "element_properties.h"
#include "robot/settings_file.h"

namespace cerberus::robot {

bool Camera::apply(const PipelineText& text, std::string& error) {
  for (const Assignment& assignment : text.assignments) {
    g_autoptr(GstElement) found = element(assignment.element.c_str());
    if (found != nullptr && set_property(found, assignment, error)) continue;
    error = assignment.property + " = " + assignment.value + ": " + error;
    return false;
  }
  return true;
}

bool Camera::apply_secrets(std::string& error) {
  if (settings_.source.user.empty()) return true;
  const std::optional<std::string> password = read_secret(settings_.source.password_file, error);
  if (!password) return false;
  for (const char* name : {"source", "recorded"}) {
    g_autoptr(GstElement) source = element(name);
    if (source)
      g_object_set(source, "user-id", settings_.source.user.c_str(), "user-pw", password->c_str(), nullptr);
  }
  return true;
}

void Camera::set_triggers() {
  if (recorder_ == nullptr || !settings_.recorder)
    return;  // of a pipeline that ends, with settings of the next
  for (const Property& trigger : triggers(*settings_.recorder))
    gst_util_set_object_arg(G_OBJECT(recorder_), trigger.name.c_str(),
                            mode_ == Mode::armed ? trigger.value.c_str() : "false");
}

void Camera::publish_mode() {
  if (!shared_.mqtt || pipeline_ == nullptr) return;
  g_autoptr(GstElement) mqtt = element("mqtt");
  if (mqtt) g_object_set(mqtt, "mode", std::string(robot::name(mode_)).c_str(), nullptr);
}

// Sets what differs where all of it may change while the pipeline plays, else nothing.
bool Camera::change_live(const PipelineText& before, const PipelineText& after) {
  std::optional<std::vector<PropertyChange>> all = changes(before, after);
  if (!all) return false;
  // These follow the mode: set_triggers() sets them.
  if (settings_.recorder)
    for (const Property& trigger : triggers(*settings_.recorder))
      std::erase_if(*all, [&](const PropertyChange& one) {
        return one.element == "recorder" && one.property == trigger.name;
      });
  const auto spec_of = [](GstElement* element, const PropertyChange& one) {
    return g_object_class_find_property(G_OBJECT_GET_CLASS(element), one.property.c_str());
  };
  for (const PropertyChange& one : *all) {
    g_autoptr(GstElement) found = element(one.element.c_str());
    const GParamSpec* spec = found ? spec_of(found, one) : nullptr;
    if (spec == nullptr || (spec->flags & GST_PARAM_MUTABLE_PLAYING) == 0) return false;
  }
  std::string error;
  for (const PropertyChange& one : *all) {
    g_autoptr(GstElement) found = element(one.element.c_str());
    if (one.value) {
      set_property(found, {one.element, one.property, *one.value}, error);
    } else {
      GParamSpec* spec = spec_of(found, one);
      g_auto(GValue) value = G_VALUE_INIT;
      g_value_init(&value, G_PARAM_SPEC_VALUE_TYPE(spec));
      g_param_value_set_default(spec, &value);
      g_object_set_property(G_OBJECT(found), one.property.c_str(), &value);
    }
  }
  set_triggers();
  return true;
}

Camera::Change Camera::change(const CameraSettings& settings, SharedSettings shared) {
  const auto text = [this](Parts parts) { return pipeline_text(settings_, shared_, parts); };
  const PipelineText whole_before = text({}), before = text(parts_);
  const SourceSettings& source = settings.source;
  const bool same_secret = source.user == settings_.source.user &&
                           source.password_file == settings_.source.password_file &&
                           shared.stamp == shared_.stamp;
  settings_ = settings;
  shared_ = std::move(shared);
  const auto differences = changes(whole_before, text({}));
  if (differences && differences->empty() && same_secret) return Change::none;
  if (state_ == State::running && same_secret && change_live(before, text(parts_))) return Change::live;
  // A part that failed is tried with its new settings.
  parts_ = {};
  camera_backoff_ = head_backoff_ = recorder_backoff_ = {};
  if (state_ == State::running) {
    emit("stop");
    again_ = true;
    close();
  } else if (state_ == State::waiting) {
    start();
  } else if (state_ == State::parking) {
    stale_ = true;
  }
  return Change::restarts;
}

bool Camera::set_live(const char* name, const char* property, double value) {
  if (pipeline_ == nullptr || state_ != State::running) return false;
  g_autoptr(GstElement) found = element(name);
  if (!found) return false;
  GParamSpec* spec = g_object_class_find_property(G_OBJECT_GET_CLASS(found), property);
  if (spec == nullptr) return false;
  const GType type = G_PARAM_SPEC_VALUE_TYPE(spec);
  const bool is_whole = type != G_TYPE_DOUBLE && type != G_TYPE_FLOAT;
  g_auto(GValue) number = G_VALUE_INIT, wanted = G_VALUE_INIT, is = G_VALUE_INIT;
  g_value_init(&number, G_TYPE_DOUBLE);
  g_value_init(&wanted, type);
  g_value_init(&is, type);
  g_value_set_double(&number, is_whole ? std::round(value) : value);
  if (!g_value_transform(&number, &wanted)) return false;
  g_object_set_property(G_OBJECT(found), property, &wanted);
  g_object_get_property(G_OBJECT(found), property, &is);
  return gst_value_compare(&wanted, &is) == GST_VALUE_EQUAL;
}

std::optional<double> Camera::live(const char* name, const char* property) const {
  if (pipeline_ == nullptr || state_ != State::running) return std::nullopt;
  g_autoptr(GstElement) found = element(name);
  GParamSpec* spec = found ? g_object_class_find_property(G_OBJECT_GET_CLASS(found), property) : nullptr;
  if (spec == nullptr) return std::nullopt;
  g_auto(GValue) is = G_VALUE_INIT, number = G_VALUE_INIT;
  g_value_init(&is, G_PARAM_SPEC_VALUE_TYPE(spec));
  g_value_init(&number, G_TYPE_DOUBLE);
  g_object_get_property(G_OBJECT(found), property, &is);
  if (!g_value_transform(&is, &number)) return std::nullopt;
  return g_value_get_double(&number);
}

bool Camera::turn(double pan_speed, double tilt_speed) {
  gboolean done = FALSE;
  if (head_ != nullptr && state_ == State::running)
    g_signal_emit_by_name(head_, "turn", pan_speed, tilt_speed, &done);
  if (done && (pan_speed != 0 || tilt_speed != 0)) kept_stopped_ = false;
  return done;
}

bool Camera::order(const char* signal) {
  const bool done = emit(signal);
  note_order(signal, done);
  return done;
}

// A head that is not there now is kept stopped when it comes; only an order that moves it ends that.
void Camera::note_order(std::string_view order, bool done) {
  if (order == "stop")
    kept_stopped_ = done || settings_.head;
  else if (done && (order == "auto" || order == "home" || order == "follow" || order.starts_with("move-")))
    kept_stopped_ = false;
}

bool Camera::emit(const char* signal) {
  gboolean done = FALSE;
  if (head_ != nullptr) g_signal_emit_by_name(head_, signal, &done);
  return done;
}

// The turn is left to a gyro or the picture, which measure it.
void Camera::note_base_speed(double speed) {
  g_autoptr(GstElement) fusion = state_ == State::running ? element("fusion") : nullptr;
  if (!fusion) return;
  CerberusBase base;
  cerberus_base_init(&base);
  base.yaw_rate = std::numeric_limits<double>::quiet_NaN();
  base.speed = speed;
  base.valid_from = gst_element_get_current_running_time(pipeline_);
  if (GST_CLOCK_TIME_IS_VALID(base.valid_from))
    gst_element_send_event(fusion, cerberus_event_new_base(&base));
}

bool Camera::follow(guint track) {
  gboolean done = FALSE;
  if (head_ != nullptr && state_ == State::running) g_signal_emit_by_name(head_, "follow", track, &done);
  if (done) kept_stopped_ = false;
  return done;
}

}  // namespace cerberus::robot
