// SPDX-License-Identifier: LGPL-2.1-or-later
// Levels of PIR lines over time as text. Two forms, distinguished by the first significant character:
//
//   time,infer1,infer2,infer3          {"time": 0, "pir": [0, 0, 0]}
//   0,0,0,0                            {"time": 2.5, "pir": [1, 0, 0]}
//   2.5,1,0,0                          {"pts": 4000000000, "pir": [0, 0, 0]}
//   # a comment                        (motionjson writes this form)
//
// CSV: seconds, then a level (0, 1) a sensor; a heading, empty lines and lines that begin with # are skipped.
// JSON lines: `time` in seconds or `pts` in nanoseconds, and `pir`.
// 2: the reading is invalid until the next 0 or 1. Times never go back. Readings of an analogue sensor are written in
// volts, on all lines or on none: 0,0.1V,3.2V,0V or {"time": 0, "volts": [...]}.
#pragma once

#include <string_view>
#include <vector>

#include "drivers/sensor/sensor.h"

namespace cerberus::drivers {

struct Recording {
  std::vector<SensorEdge> edges;  // in order of time; those of one line of text have one time
  Time end{};                     // of the last line
  bool volts = false;             // it holds volts and no levels: each edge's `level` is still to be computed
};

// Parses `text` into `recording`. `name`: of the file, for error messages. An error names the file and the line (from
// 1); `recording` then holds the lines before it.
SensorError parse_recording(std::string_view text, std::string_view name, int sensors, Recording& recording);

// Parses seconds in plain decimal ("2.5"), whatever the locale. Returns false for other text, a negative number, or
// more than 100 years.
bool parse_seconds(std::string_view text, Time& time);

}  // namespace cerberus::drivers
