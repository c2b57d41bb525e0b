// SPDX-License-Identifier: LGPL-2.1-or-later
// Where PIR sensors look, from words of a user.
#pragma once

#include <cerberus/pir.h>

#include <cmath>
#include <string>
#include <vector>

#include "drivers/helper/option_words.h"

namespace cerberus::plugin {

// The caps of sensors at these bearings (degrees, separated by commas). Returns an empty text, or an error for the user.
inline std::string pir_info(const std::string& bearings, double field_of_view, CerberusPirInfo& info) {
  cerberus_pir_info_init(&info);
  info.field_of_view = field_of_view;
  const auto words = drivers::comma_list(bearings);
  if (words.empty() || words.size() > CERBERUS_PIR_MAX_SENSORS)
    return "bearings=\"" + bearings + "\" must name 1 to 16 directions";
  info.sensors = static_cast<guint>(words.size());
  for (std::size_t i = 0; i < words.size(); ++i) {
    gchar* end = nullptr;
    const double bearing = g_ascii_strtod(words[i].c_str(), &end);
    if (words[i].empty() || *end || !(std::abs(bearing) <= 360))
      return "bearings=\"" + bearings + "\": \"" + words[i] + "\" is no direction in degrees";
    info.bearings[i] =
        bearing >= -180 && bearing < 180 ? bearing : bearing - 360 * std::floor((bearing + 180) / 360);
  }
  return "";
}

}  // namespace cerberus::plugin
