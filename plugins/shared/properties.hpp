// SPDX-License-Identifier: LGPL-2.1-or-later
// Properties as a table: one line a property names the member of Settings that it sets, its range and its blurb. The
// default is the member's own initialiser, and nothing else.
#pragma once

#include <gst/gst.h>

#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <variant>

namespace cerberus::plugin {

template <typename Settings>
struct Property {
  // An int member with `choices` is an enumeration; a guint64 member a GstClockTime.
  using Member = std::variant<int Settings::*, double Settings::*, bool Settings::*, guint64 Settings::*,
                              std::string Settings::*>;
  const char* name;
  Member member;
  double minimum, maximum;  // of numbers
  GType (*choices)();
  const char* blurb;
  GParamFlags when = GParamFlags(0);  // GST_PARAM_MUTABLE_...; 0: as the whole table

  constexpr Property read_at_start() const {
    Property later = *this;
    later.when = GParamFlags(GST_PARAM_MUTABLE_READY);
    return later;
  }
};

template <typename Settings, typename Member>
constexpr Property<Settings> property(const char* name, Member Settings::* member, const char* blurb) {
  return {name, member, 0, 0, nullptr, blurb};
}
template <typename Settings, typename Member>
constexpr Property<Settings> property(const char* name, Member Settings::* member, double minimum,
                                      double maximum, const char* blurb) {
  return {name, member, minimum, maximum, nullptr, blurb};
}
template <typename Settings>
constexpr Property<Settings> property(const char* name, int Settings::* member, GType (*choices)(),
                                      const char* blurb) {
  return {name, member, 0, 0, choices, blurb};
}

// Settings that the application writes in any thread and the streaming thread reads once a buffer.
template <typename Settings>
class Adjustable {
 public:
  using Table = std::span<const Property<Settings>>;

  // Property ids count from 1 in the table's order. `when`: GST_PARAM_MUTABLE_...
  static void install(GObjectClass* klass, Table table,
                      GParamFlags when = GParamFlags(GST_PARAM_MUTABLE_PLAYING)) {
    const Settings defaults;
    guint id = 0;
    for (const auto& entry : table)
      g_object_class_install_property(klass, ++id, spec(entry, defaults, entry.when ? entry.when : when));
  }

  void set(Table table, guint id, const GValue* value) {
    const auto& entry = table[id - 1];
    const std::lock_guard guard(lock_);
    std::visit([&](auto member) { read(value, settings_.*member, entry.choices != nullptr); }, entry.member);
    changed_ = true;
  }
  void get(Table table, guint id, GValue* value) const {
    const auto& entry = table[id - 1];
    const std::lock_guard guard(lock_);
    std::visit([&](auto member) { write(value, settings_.*member, entry.choices != nullptr); }, entry.member);
  }

  // Several at once: change(settings) under the lock.
  template <typename Change>
  void adjust(Change change) {
    const std::lock_guard guard(lock_);
    change(settings_);
    changed_ = true;
  }

  Settings snapshot() const {
    const std::lock_guard guard(lock_);
    return settings_;
  }
  // The settings when they changed since the last call (and at the first one).
  std::optional<Settings> changes() {
    const std::lock_guard guard(lock_);
    if (!changed_) return std::nullopt;
    changed_ = false;
    return settings_;
  }
  // Makes the next changes() return all settings again, for a new start.
  void refresh() {
    const std::lock_guard guard(lock_);
    changed_ = true;
  }

 private:
  // noinline: GCC 12 otherwise follows each member pointer into each property and warns of what never happens.
  [[gnu::noinline]] static GParamSpec* spec(const Property<Settings>& entry, const Settings& defaults,
                                            GParamFlags when) {
    const auto flags = static_cast<GParamFlags>(G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS | when);
    const auto* e = &entry;
    return std::visit(
        [&](auto member) -> GParamSpec* {
          const auto& value = defaults.*member;
          using T = std::decay_t<decltype(value)>;
          if constexpr (std::is_same_v<T, bool>)
            return g_param_spec_boolean(e->name, nullptr, e->blurb, value, flags);
          else if constexpr (std::is_same_v<T, double>)
            return g_param_spec_double(e->name, nullptr, e->blurb, e->minimum, e->maximum, value, flags);
          else if constexpr (std::is_same_v<T, guint64>)
            return g_param_spec_uint64(e->name, nullptr, e->blurb, 0, G_MAXUINT64, value, flags);
          else if constexpr (std::is_same_v<T, std::string>)
            return g_param_spec_string(e->name, nullptr, e->blurb, value.empty() ? nullptr : value.c_str(),
                                       flags);
          else if (e->choices)
            return g_param_spec_enum(e->name, nullptr, e->blurb, e->choices(), value, flags);
          else
            return g_param_spec_int(e->name, nullptr, e->blurb, static_cast<int>(e->minimum),
                                    static_cast<int>(e->maximum), value, flags);
        },
        entry.member);
  }

  static void read(const GValue* value, int& to, bool choice) {
    to = choice ? g_value_get_enum(value) : g_value_get_int(value);
  }
  static void read(const GValue* value, double& to, bool) { to = g_value_get_double(value); }
  static void read(const GValue* value, bool& to, bool) { to = g_value_get_boolean(value); }
  static void read(const GValue* value, guint64& to, bool) { to = g_value_get_uint64(value); }
  static void read(const GValue* value, std::string& to, bool) {
    const gchar* text = g_value_get_string(value);
    to = text ? text : "";
  }
  static void write(GValue* value, int from, bool choice) {
    choice ? g_value_set_enum(value, from) : g_value_set_int(value, from);
  }
  static void write(GValue* value, double from, bool) { g_value_set_double(value, from); }
  static void write(GValue* value, bool from, bool) { g_value_set_boolean(value, from); }
  static void write(GValue* value, guint64 from, bool) { g_value_set_uint64(value, from); }
  static void write(GValue* value, const std::string& from, bool) {
    g_value_set_string(value, from.empty() ? nullptr : from.c_str());
  }

  mutable std::mutex lock_;
  Settings settings_;
  bool changed_ = true;
};

template <typename Self>
auto& settings_of(GObject* object) {
  return static_cast<Self*>(static_cast<gpointer>(object))->priv->settings;
}

// In class_init: the table's properties for the type Self, whose private object has them as its member `settings`.
template <typename Self, const auto& table>
void install_properties(GObjectClass* klass) {
  klass->set_property = [](GObject* object, guint id, const GValue* value, GParamSpec*) {
    settings_of<Self>(object).set(table, id, value);
  };
  klass->get_property = [](GObject* object, guint id, GValue* value, GParamSpec*) {
    settings_of<Self>(object).get(table, id, value);
  };
  std::decay_t<decltype(settings_of<Self>(nullptr))>::install(klass, table);
}

}  // namespace cerberus::plugin
