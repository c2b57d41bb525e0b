// SPDX-License-Identifier: LGPL-2.1-or-later
// One PIR sensor as pure logic: edges of its line with their times in, presence out.
//
//   line  ──┐_┌──────┐________      the module's output, after polarity
//   rise reported at once (a person must reach the motors within 60 ms); a fall only after `debounce` of quiet, so
//   that bounce never shows and never costs time at the rise
//   presence = max(fall + debounce, last rise + hold), then `block` during which nothing triggers
//
// Driven by time alone: edge() for each edge, poll() at the deadline it asks for. An element sleeps until
// deadline() or the next edge, whichever is first, and misses nothing. Times come from one clock; a time earlier
// than the last one counts as the last one. No allocation ever.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <span>
#include <string_view>

#include "sensing/angles.h"

namespace cerberus::sensing {

using Time = std::chrono::nanoseconds;
constexpr Time kNever = Time::max();

enum class Presence : std::uint8_t { none = 0, detected = 1, invalid = 2 };
enum class PirFault : std::uint8_t { none, stuck_on, chattering };
// For a user: "stuck on", "chattering"; empty for none.
std::string_view describe(PirFault fault);

struct PirOptions {
  bool active_low = false;  // the line is low while somebody is detected (open collector)
  bool retrigger = true;    // a rise during hold extends it
  Time debounce = std::chrono::milliseconds(20);  // quiet needed before a fall counts; 0 .. 50 ms (clamped)
  Time hold{};     // least duration of a detection from its (last) rise; 0: the line's own
  Time block{};    // after a detection nothing triggers for this long; 0: none
  Time warm_up{};  // from start(): readings are invalid; 0: none
  Time stuck_after = std::chrono::minutes(10);     // line active without a break: stuck on; 0: never
  unsigned chatter_edges = 64;                     // so many rises of the raw line ...
  Time chatter_window = std::chrono::seconds(10);  // ... within this: chattering; 0 edges: never
};

// Modules as data (the makers' data sheets; the paper's Table 1). What the module does to its own output line (hold,
// block) the model need not do again; it is told here because a
// user should know. Equal ends: not adjustable; 0: not known.
struct PirPreset {
  struct Span {
    Time least{}, most{};
  };
  std::string_view name;  // "hc-sr501", "am312", "sk-11"
  PirOptions options;     // hold and block 0
  Span module_hold, module_block;
  double range = 0;          // metres
  double field_of_view = 0;  // radians
};
std::span<const PirPreset> pir_presets();

class PirModel {
 public:
  explicit PirModel(const PirOptions& options = {});

  // Begins (again) at `now` with the level the line has: warm-up starts, history and faults are forgotten.
  void start(Time now, bool level);
  // The raw line has `level` from `time` on (a repeated level is no edge). Everything due until `time` happens first.
  void edge(Time time, bool level);
  // Lets time pass. Returns deadline().
  Time poll(Time now);
  // When something changes next if no edge comes; kNever: nothing will. To see every single change with its exact
  // time (replay), poll(deadline()) until the deadline lies behind the next edge; a late poll gives the same state.
  Time deadline() const;

  // invalid in warm-up, before start() and while there is a fault.
  Presence presence() const { return presence_; }
  // When presence or fault changed last: the edge's own time or the deadline, however late poll() was called.
  Time changed() const { return changed_; }
  PirFault fault() const { return fault_; }
  // A detection that began or stood while the base turned faster than kDoubtfulTurn (see base()), until it ends or the
  // base has been calm for kDoubtLinger.
  bool doubtful() const { return doubtful_; }
  // The base turns with `yaw_rate` radians a second from `time` on, for kBaseLifetime or until the next call (NaN:
  // unknown, taken as standing still).
  void base(Time time, double yaw_rate);

  const PirOptions& options() const { return options_; }

 private:
  void advance(Time until);
  void settle(Time now);
  void rise(Time now);
  Time past_rise(unsigned n) const;
  Time calm_time() const;
  Time end_time() const;

  static constexpr unsigned kRises = 256;  // chatter_edges is clamped to it

  PirOptions options_;
  Time now_{}, changed_{};
  bool started_ = false, warming_ = false;
  bool line_ = false;       // active, after polarity
  bool detecting_ = false;  // what presence says when nothing makes it invalid
  Time active_since_{}, last_fall_{}, hold_until_{}, blocked_until_{}, warm_until_{};
  Presence presence_ = Presence::invalid;
  PirFault fault_ = PirFault::none;
  bool turning_ = false, doubtful_ = false;
  Time turning_until_{}, calm_since_{};
  std::array<Time, kRises> rises_{};
  unsigned rise_count_ = 0;  // of all rises since start; the last kRises of them are kept
};

// A body that turns faster than this trips its own PIR sensors: 5 degrees a second, an assumption.
constexpr double kDoubtfulTurn = radians(5);
// So long holds what was said of the base, if nothing more is: who knows how a robot turns says so many times a second,
// and who has been silent for so long is dead or gone, and must not be believed for ever.
constexpr Time kBaseLifetime = std::chrono::seconds(1);
// A module holds its output for some seconds after the turn that tripped it.
constexpr Time kDoubtLinger = std::chrono::seconds(3);

}  // namespace cerberus::sensing
