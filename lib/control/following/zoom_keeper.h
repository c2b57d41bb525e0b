// SPDX-License-Identifier: LGPL-2.1-or-later
// Keeps a target at a share of the picture's height by the zoom.
//
//   size  = log(height of its box x t),  t = tan(field of view / 2)    what the lens does not change; low-pass of `slowness`
//   error = size - log(share) - log t                                  > 0: it is too tall, the view is to become wider
//   the zoom moves from |error| > start on until |error| < stop, by at most `narrows` and `widens`, in steps
//
// Each step is a field of view of its own: without the next one the zoom stands. There is no step while the target is not
// seen, and none towards a narrower view while it is off the middle or has only just been found. A box that the picture's
// edge cuts is at least as tall as it looks. Radians and seconds; allocates nothing.
#pragma once

#include <optional>

namespace cerberus::control {

class ZoomKeeper {
 public:
  // Guarded by unit-zoom_keeper and bench-heads.
  struct Parameters {
    double share = 1. / 3;  // of the picture's height. chosen
    double slowness = 1;    // seconds. derived: two steps of a walker, whose box is taller and lower in turn
    double start = .26;  // derived: a factor of 1.3, the box of a walker with the arms up against one at rest
    double stop = .05;   // derived: a factor of 1.05, what a box's height is off by
    double narrows = .14;  // 1/s: derived, twice as near within five seconds
    double widens = .28;   // 1/s: derived, a walker at 1.4 m/s who comes, 5 m away: 1.4 / 5
    double period = .2;  // seconds from step to step. derived: cameras take five commands a second
    // The zoom that was asked for is at most this far ahead of the reported one, which comes twice a second. derived: the
    // age of a report, .7 s, and as much for the lens to get there.
    double lead = 1.4;  // seconds
    // Of the target's middle from the picture's, of half a picture: beyond, the view becomes no narrower. chosen
    double centred = .4;
    double settled =
        .5;  // seconds for which a target must have been seen. derived: as long as a track is coasted
    double pause = .5;  // seconds without it, after which it was lost
  };
  // The target in a picture.
  struct Sight {
    double height = 0;  // of its box, of the picture's height
    bool whole = true;  // the picture's edge cuts it neither above nor below
    double off = 0;     // of its middle from the picture's, of half the picture: the greater one of both axes
    double field_of_view = 0;  // when the picture was taken, by the report of the zoom
  };
  struct Range {
    double widest = 0, narrowest = 0;  // fields of view
  };

  void reset() { *this = {}; }
  // Adds a picture that was taken at `taken`; nothing: the target is not in it. Returns the field of view to go to; nothing:
  // the zoom is left as it is.
  std::optional<double> update(double taken, const std::optional<Sight>& sight, const Range& range);

 private:
  std::optional<double> size_;       // the low-pass
  std::optional<double> commanded_;  // log t
  double since_ = 0, seen_ = 0;      // since when the target is seen, and when it was last
  double stepped_ = 0;
  bool moves_ = false;
};

}  // namespace cerberus::control
