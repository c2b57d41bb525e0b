// SPDX-License-Identifier: LGPL-2.1-or-later
// Slip detection for one axis: does the turn of the picture follow the commanded turn of the head?
//
// A robot's own turn moves the picture too, so that speeds cannot be compared, only their changes: when the commanded
// speed changes, the picture's must change by as much, whatever the robot does besides.
//
//   bins of kBin; of each the mean speeds h (head, as commanded) and r (picture)
//   pairs of bins with one between them: e = h(j) - h(j-2), d = r(j) - r(j-2); counted where |e| >= kLeastChange
//   episode: pairs in a row; gain = sum d e / sum e^2; stir = max - min of r - gain h over the episode's bins
//   all this for heads that are 0 .. (kLags - 1) kLag late: the lag that leaves the least stir counts
//   finding: least_episodes() in a row of the same fault, and kLeastTravel
//
// One case looks like a head that slips and is none: a head that holds a target while the robot turns below it moves,
// and the picture stands. It cannot do so without being late, though (it sees the robot turn before it answers), and
// the picture jerks at every change. So a picture that jerks (stirs) is no evidence but of a head that follows or turns
// the wrong way, which no robot's turning looks like. And a gain that is another one at each change is the robot's
// doing, or a person's: a wrong lens or gear is always wrong by the same. Twice in a row it may be the same by chance,
// three times hardly, while one that slips or is reversed is so much off that two are enough. (Simulated: in the three
// days of robots and people that tests/unit/slip.cpp makes with CERBERUS_SLIP_SEEDS=100, nothing wrong was found; with
// two for a wrong scale, 17 times.)
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "sensing/angles.h"

namespace cerberus::control {

enum class SlipFault : std::uint8_t {
  none,
  slips,     // the picture stands: the head does not turn at all
  reversed,  // the picture turns the other way
  scale,     // it turns by another angle: the lens or the gear is not as set
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
  // As well. The end of a fault needs as much evidence as a fault.
  static constexpr int least_episodes(SlipFault fault) {
    return fault == SlipFault::slips || fault == SlipFault::reversed ? 2 : 3;
  }
  static constexpr unsigned kLags = 10;
  static constexpr double kLag = 0.0125;  // seconds

  // Forgets everything.
  void reset() { *this = {}; }
  // The next frame: `seconds` after the one before it, in which the picture turned by `picture` and the head was
  // commanded to turn by `head`, radians. picture NaN: unknown. Returns a fault once, when it is found; the same fault is
  // found again only after the head has followed in between.
  std::optional<SlipFinding> add(double seconds, double picture, double head);
  SlipFault fault() const { return fault_; }  // that stands

 private:
  // The same for a head that is that many kLag late.
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
    // Range of the picture's speed less the head's part (gain x commanded speed).
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
  // Commanded turn since the beginning, and when.
  struct Told {
    double time = 0, head = 0;
  };

  void forget_frames();
  double told_at(double time) const;
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
  // As many frames as a head may be late, at 240 a second. Never empty: it begins with nothing told.
  static constexpr unsigned kTold = 32;
  std::array<Told, kTold> told_{};
  unsigned newest_ = 0, told_count_ = 1;
};

}  // namespace cerberus::control
