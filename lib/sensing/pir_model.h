// SPDX-License-Identifier: LGPL-2.1-or-later
// One PIR sensor as pure logic: converts the edges of its line, with their times, to presence.
//
//   line  ─┐_┌──────┐________      the module's output, after polarity
//   pulse: the line is active for `min_pulse` without a break; shorter ones are interference and ignored. A break
//   shorter than `debounce` ends no pulse.
//   a pulse is reported `min_pulse` after its rise (a detection must reach the motors within 60 ms), its end only after
//   `debounce` without edges: bounce is never reported and delays no pulse by more than its own length
//   presence = max(end of the pulse + debounce, begin of the last pulse + hold), then `block` during which nothing
//   triggers
//
// The model has no clock: the caller calls edge() for each edge and poll() at deadline(), and sleeps until deadline()
// or the next edge, whichever is first. All times are of one clock; a time earlier than the last one counts as the last
// one. Never allocates.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "sensing/angles.h"
#include "sensing/own_motion.h"

namespace cerberus::sensing {

enum class Presence : std::uint8_t { none = 0, detected = 1, invalid = 2 };
enum class PirFault : std::uint8_t { none, stuck_on, chattering };
// For a user: "stuck on", "chattering"; empty for none.
std::string_view describe(PirFault fault);

struct PirOptions {
  bool active_low = false;  // the line is low during a detection (open collector)
  bool retrigger = true;    // a pulse during hold extends it
  // Shorter pulses are none; 0: every pulse counts. derived: three times the dips of 3 ms that a motor's start puts on
  // all lines, a thirtieth of the shortest output of a module (kPresets: 300 ms), a sixth of the 60 ms that a detection
  // has to the motors. Guarded by unit-pir_model.
  Time min_pulse = std::chrono::milliseconds(10);
  Time debounce =
      std::chrono::milliseconds(20);  // time without edges before a fall counts; 0 .. 50 ms (clamped)
  Time hold{};     // least duration of a detection from its (last) pulse; 0: the line's own
  Time block{};    // after a detection nothing triggers for this long; 0: none
  Time warm_up{};  // from start(): readings are invalid; 0: none
  Time stuck_after = std::chrono::minutes(10);  // line active without a break: stuck on; 0: never
  unsigned chatter_edges = 64;  // rises of the raw line within chatter_window that mean chattering; 0: never
  Time chatter_window = std::chrono::seconds(10);
};

// Modules as data (the makers' data sheets; the paper's Table 1). module_hold and module_block describe what the module
// does to its output line itself; the model does not repeat it, the values are for the user's information. Equal ends:
// not adjustable; 0: not known.
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

  // Begins (again) at `now` with the line's present level, which counts as a pulse if it is active: warm-up starts,
  // history and faults are cleared.
  void start(Time now, bool level);
  // Forgets the line's level, history and faults, until the next edge() begins anew. The module kept its supply: a
  // warm-up that start() began goes on, and one that never began begins with that edge.
  void forget_level();
  // Sets the raw line to `level` from `time` on (a repeated level is no edge). Changes due until `time` are made first.
  void edge(Time time, bool level);
  // Advances the time. Returns deadline().
  Time poll(Time now);
  // Returns the time of the next change if no edge comes; kNever: no change. To get every single change with its exact
  // time (replay), poll(deadline()) until the deadline lies behind the next edge; a late poll gives the same state.
  Time deadline() const;

  // Presence is `invalid` in warm-up, before start() and during a fault.
  Presence presence() const { return presence_; }
  // Returns the time of the last change of presence or fault: that of the edge or of the deadline, even if poll() was
  // called late.
  Time changed() const { return changed_; }
  PirFault fault() const { return fault_; }
  // Returns true for a detection that the body's own motion may have caused or may hold (PulseDoubt).
  bool doubtful() const { return doubt_.doubtful(); }
  // Sets the rate at which standing things pass the sensor (passing_rate()) from `time` on, for kBaseLifetime or until
  // the next call (NaN: unknown, taken as 0).
  void base(Time time, double passing);

  const PirOptions& options() const { return options_; }

 private:
  void advance(Time until);
  void settle(Time now);
  void rise(Time now);
  void begin_pulse(Time now);
  Time past_rise(unsigned n) const;
  Time calm_time() const;
  Time end_time() const;

  static constexpr unsigned kRises = 256;  // chatter_edges is clamped to it

  PirOptions options_;
  Time now_{}, changed_{};
  std::optional<Time> warms_until_;  // of a line whose level was forgotten
  bool started_ = false, warming_ = false;
  bool line_ = false;                  // active, after polarity
  bool pulse_ = false;                 // and for long enough
  bool detecting_ = false;             // presence if nothing makes it invalid
  Time active_since_{}, last_fall_{};  // of the line
  Time rose_{}, pulse_end_{};          // the line's last rise; the end of the last pulse
  Time hold_until_{}, blocked_until_{}, warm_until_{};
  Presence presence_ = Presence::invalid;
  PirFault fault_ = PirFault::none;
  bool moves_ = false;  // the body
  Time moves_until_{};
  PulseDoubt doubt_;
  std::array<Time, kRises> rises_{};
  unsigned rise_count_ = 0;  // of all rises since start; the last kRises of them are kept
};

}  // namespace cerberus::sensing
