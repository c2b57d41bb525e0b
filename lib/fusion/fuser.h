// SPDX-License-Identifier: LGPL-2.1-or-later
// The state machine of sensor fusion: decides one action for each frame from the camera's tracks and the PIR sensors.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string_view>

#include "fusion/complete.h"
#include "fusion/rules.h"

namespace cerberus::fusion {

using Time = std::chrono::nanoseconds;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

enum class RuleSet : std::uint8_t { complete, table };
enum class TargetChoice : std::uint8_t { nearest, largest, newest };

struct FuserOptions {
  RuleSet rules = RuleSet::complete;
  TargetChoice choice = TargetChoice::nearest;        // for a new target
  Time camera_hold = std::chrono::milliseconds(500);  // "camera found" lasts this long after the last track
  Time return_delay = std::chrono::seconds(5);        // without any detection before the head returns to zero
  Time hold_stopped = std::chrono::seconds(30);       // a target that stopped is held at least this long
  double hysteresis = sensing::radians(2);
  double lens = sensing::radians(60);    // horizontal field of view; 0: not known
  Interval limits = kDefaultLimits;      // of pan
  Time dwell = std::chrono::seconds(2);  // least time at a place before the next one is tried
};
// The options of the paper: its table, and nothing that lasts longer than what causes it.
FuserOptions paper_options();

enum class TrackState : std::uint8_t { seen, coasted, stopped };

// What the choice of a target depends on, of a confirmed track of this frame: the input of the fuser, which knows no
// vision. It is less than vision::Track: no speeds, kind, bearing or confidence.
struct Track {
  std::uint32_t id = 0;                        // not 0
  double x = 0, y = 0, width = 0, height = 0;  // frame pixels
  double distance = kUnknown;                  // metres
  Time age{};
  TrackState state = TrackState::seen;
  bool person = false;  // a person detector has seen it
};

struct Input {
  Time time{};                            // running time of the frame and its tracks
  Time sensor_time = Time::min();         // running time of sensors, pan and base, if that is later
  std::span<const Track> tracks;          // any order
  std::span<const std::uint8_t> sensors;  // 0, 1, 2 = invalid (as in the PIR caps); others count as invalid
  double pan = kUnknown;                  // radians
  double base_yaw_rate = kUnknown;        // radians a second
  double base_speed = kUnknown;           // metres a second, straight ahead
  double lens = 0;  // horizontal field of view, radians, of a zoom; 0: as the options say
};

struct Decision {
  Action action = Action::hold;
  int rule = 0;  // number of the table's rule; complete: 1 (camera) and 7 (zero), 0 for the rest
  std::string_view
      rule_name;  // of the table's rule; complete: "camera", "overlap", "sector", "doubt", "return", "zero";
  // "stopped", "return": the reason for deferring rule 7. Valid until the next change of rules.
  std::uint32_t target = 0;  // id of the track to follow; 0: none
  Interval sector{
      kUnknown,
      kUnknown};  // turn: the destination; search: the sweep from edge to edge, already within the limits
                  // and moved in by half a field of view: the head turns to and fro. Else NaN.
  double pan = kUnknown;  // as used
  bool limited = false;   // the wanted place lies (partly) beyond the pan limits
  bool camera_found = false;
  SensorBits fired = 0;        // sensors that detect and count
  bool onset_in_view = false;  // one of them begins to detect, and covers a part of the picture
  SensorBits doubtful =
      0;  // read 1 perhaps because of the base's own motion (sensing/own_motion.h): not counted
  SensorBits invalid = 0;  // read 2: not counted
  bool immediate = false;  // a table's rule says hold or zero: it ends what the head does by itself
  bool changed =
      false;  // rule, action, target, sector, limited, camera_found, or a sensor differs from last frame
};

// Not thread-safe: one caller at a time. Steady state allocates nothing. The same inputs give the same decisions.
class Fuser {
 public:
  Fuser();
  ~Fuser();
  Fuser(Fuser&&) noexcept;
  Fuser& operator=(Fuser&&) noexcept;

  // May be called at any time, also between frames of a running stream. The state of tracks and sensors is kept, and so
  // is a search unless the rule set changes.
  void set_options(const FuserOptions& options);
  const FuserOptions& options() const;
  // Sets the sensors from the PIR caps; the default is the paper's three.
  void set_geometry(const Geometry& geometry);
  // Sets the table of RuleSet::table; the default is paper_rules(). It must have passed check().
  void set_table(RuleTable table);

  // Clears tracks, detections and timers (flush, DISCONT, new segment). Options, geometry and table are kept.
  void reset();
  // Decides for one frame. A time before that of the last frame resets first; an earlier `sensor_time` is raised to
  // the last one. Timers expire during long gaps as with frames. The same frame may be passed again with newer sensor
  // readings.
  const Decision& update(const Input& input);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace cerberus::fusion
