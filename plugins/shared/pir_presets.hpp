// SPDX-License-Identifier: LGPL-2.1-or-later
// The PIR modules that are known, as an enumeration: 0 is none, then those of sensing::pir_presets() in their order.
#pragma once

#include <gst/gst.h>

#include <string>
#include <vector>

#include "sensing/pir_model.h"

namespace cerberus::plugin {

// Once for each type name: each module of the project needs its own.
inline GType register_pir_presets(const char* type_name) {
  static const auto values = [] {
    std::vector<GEnumValue> list{{0, "No module in particular: what the properties say", "none"}};
    for (const auto& preset : sensing::pir_presets()) {
      const gchar* name = g_intern_string(std::string(preset.name).c_str());
      list.push_back({static_cast<gint>(list.size()), name, name});
    }
    list.push_back({0, nullptr, nullptr});
    return list;
  }();
  return g_enum_register_static(type_name, values.data());
}

// Of a value of that enumeration; nullptr: none.
inline const sensing::PirPreset* pir_preset(int value) {
  const auto all = sensing::pir_presets();
  const auto number = static_cast<std::size_t>(value);
  return value > 0 && number <= all.size() ? &all[number - 1] : nullptr;
}

}  // namespace cerberus::plugin
