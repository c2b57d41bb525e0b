// SPDX-License-Identifier: LGPL-2.1-or-later
#include "fusion/sensor_snapshot.h"

#include <algorithm>

namespace cerberus::fusion {

void SensorSnapshot::add(const Reading& reading) {
  const auto known = std::min(static_cast<std::size_t>(reading.array->count), sensors.size() - count);
  for (std::size_t i = 0; i < known; ++i, ++count) {
    sensors[count] = reading.values[i];
    bearings[count] = reading.array->bearings[i];
    fields_of_view[count] = reading.array->field_of_view;
  }
}

}  // namespace cerberus::fusion
