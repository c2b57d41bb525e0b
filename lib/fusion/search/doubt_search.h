// SPDX-License-Identifier: LGPL-2.1-or-later
// Where the camera looks while sensors are blind: their outputs are high because of the body's own motion, so that a
// person before them changes nothing. The camera takes their place, one sector after the other. A sector that it has
// just seen is left alone, which bounds what the head does without any person.
#pragma once

#include <optional>

#include "fusion/complete.h"
#include "fusion/search/seen_around.h"

namespace cerberus::fusion {

class DoubtSearch {
 public:
  struct Parameters {
    // A look begins at a sector whose mean age (SeenAround::Unseen) is the first, and ends when that of what it is to
    // see is below the second. swept on bench-pir_search: begun at 2 s, the head looks around for 80 instead of 50 % of the
    // time, at 6 s a person is in the picture .7 s later.
    Time begins = std::chrono::seconds(4), ends = std::chrono::seconds(3);
  };
  struct View {
    double pan = 0, lens = 0;  // radians, of the camera now
    sensing::Interval limits;  // of pan
    double hysteresis = 0;
  };
  // What the head is to do.
  struct Look {
    Action action;
    Place place;
  };

  // Call at each frame, also while nothing is doubtful.
  void see(Time time, double pan, double lens, double yaw_rate) { around_.see(time, pan, lens, yaw_rate); }
  // Returns where to look for the sensors that are doubtful; nothing: all of it was seen a moment ago, or the pan is not
  // known.
  std::optional<Look> look(const Geometry& geometry, SensorBits doubtful, const View& view);
  // Ends the look in progress.
  void forget() { place_.reset(); }

 private:
  bool is_over(SensorBits doubtful) const;
  void choose(const Geometry& geometry, SensorBits doubtful, const View& view);

  Parameters parameters_;
  SeenAround around_;
  std::optional<Place> place_;
  bool inside_ = false;
};

}  // namespace cerberus::fusion
