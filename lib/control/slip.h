// SPDX-License-Identifier: LGPL-2.1-or-later
// Slip detection for one axis: does the turn of the picture follow the commanded turn of the head?
//
// A robot's own turn moves the picture too, so that only changes of speed can be compared: when the commanded speed
// changes, the picture's speed must change by as much, whatever the robot does.
//
//   bins of kBin; of each the mean speeds h (head, as commanded) and r (picture)
//   pairs of bins with one between them: e = h(j) - h(j-2), d = r(j) - r(j-2); counted where |e| >= kLeastChange
//   episode: pairs in a row; gain = sum d e / sum e^2; stir = max - min of r - gain h over the episode's bins
//   both for lags of the head of 0 .. (kLags - 1) kLag: the lag with the least stir is used
//   finding: least_episodes() in a row of the same fault, and kLeastTravel
//
// One case resembles a head that slips: a head that holds a target while the robot turns below it moves, and the
// picture stands. Such a head reacts late, so that the picture jerks at every change. An episode with a large stir is
// therefore evidence only of a head that follows or is reversed, which a turning robot cannot imitate. A gain that
// differs from change to change is caused by the robot or a person: a wrong lens or gear gives the same gain every
// time. Two equal gains may be chance, three hardly; a slipping or reversed head differs so much that two episodes are
// enough. (Simulated: in the three days of robots and people of tests/unit/slip.cpp with CERBERUS_SLIP_SEEDS=100 there
// was no false finding; with two episodes for a wrong scale there were 17.)
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "sensing/angles.h"

namespace cerberus::control {

enum class SlipFault : std::uint8_t {
  none,
  slips,     // the picture stands: the head does not turn
  reversed,  // the picture turns the other way
  scale,     // the picture turns by another angle: lens or gear differ from the settings
};

struct SlipFinding {
  SlipFault fault = SlipFault::none;
  double gain = 1;    // turn of the picture / commanded turn
  double travel = 0;  // radians commanded in the evidence
};

class SlipWatch {
 public:
  static constexpr double kBin = 0.2;                           // seconds
  static constexpr double kLeastChange = sensing::radians(15);  // a second
  static constexpr double kLeastTravel = sensing::radians(20);  // of evidence before a finding
  // Episodes in a row that a finding needs as well. The end of a fault needs as much evidence as a fault.
  static constexpr int least_episodes(SlipFault fault) {
    return fault == SlipFault::slips || fault == SlipFault::reversed ? 2 : 3;
  }
  static constexpr unsigned kLags = 10;
  static constexpr double kLag = 0.0125;  // seconds

  // Clears all state.
  void reset() { *this = {}; }
  // Adds a frame: in the `seconds` since the one before, the picture turned by `picture` and the head was commanded to
  // turn by `head`, radians. picture NaN: unknown. Returns a fault once, when it is found; the same fault is found
  // again only after the head has followed in between.
  std::optional<SlipFinding> add(double seconds, double picture, double head);
  SlipFault fault() const { return fault_; }  // the present fault

 private:
  // One value for each lag, in units of kLag.
  using Lagged = std::array<double, kLags>;
  struct Bin {
    double picture = 0;  // radians a second
    Lagged head{};       // radians a second
    double travel = 0;   // radians, until an episode counted it
  };
  struct Episode {
    static constexpr int kMost = 8;
    std::array<Bin, kMost> bin;
    int bins = 0, pairs = 0;
    Lagged de{}, ee{};
    double largest = 0;
    double travel = 0;
    void see(Bin& seen);
    void add(const Bin& now, const Bin& before);
    double gain(unsigned lag) const { return de[lag] / ee[lag]; }
    // Returns the range of the picture's speed minus the head's part (gain x commanded speed), radians a second.
    double stir(unsigned lag) const;
    unsigned lag() const;
  };
  // Episodes in a row with the same fault.
  struct Run {
    SlipFault fault = SlipFault::none;
    int episodes = 0;
    double gains = 0, travel = 0;
    bool goes_on(SlipFault next, double gain) const;
  };
  // The commanded turn since the beginning, radians, at a time in seconds.
  struct Commanded {
    double time = 0, head = 0;
  };

  void forget_frames();
  double commanded_at(double time) const;
  std::optional<SlipFinding> close_bin();
  std::optional<SlipFinding> close_episode();
  static std::optional<SlipFault> judge(const Episode& episode, unsigned lag);

  std::array<Bin, 4> bins_{};  // the newest first
  int bin_count_ = 0;
  Episode episode_;
  Run run_;
  SlipFault fault_ = SlipFault::none;

  // The bin that is being filled.
  double span_ = 0, seen_ = 0, picture_ = 0, travel_ = 0;
  Lagged head_{};
  // The frames of the longest lag at 240 a second. Never empty: it begins with a turn of 0.
  static constexpr unsigned kCommanded = 32;
  std::array<Commanded, kCommanded> commanded_{};
  unsigned newest_ = 0, commanded_count_ = 1;
};

}  // namespace cerberus::control
