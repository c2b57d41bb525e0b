// SPDX-License-Identifier: LGPL-2.1-or-later
// Detects a stream whose scenes end before a track can be confirmed, for a reason that is not in the picture: frames
// are dropped between the stages, or timestamps jump. Nothing can be found in it, without a visible cause. Not
// thread-safe.
#pragma once

namespace cerberus::vision {

class SceneBreaks {
 public:
  // Guarded by unit-scene_breaks.
  struct Parameters {
    // What a scene must have had to count as long enough. Derived: the first regions are those of its third frame, and
    // a track is confirmed after two more of them and the default confirm-time.
    int frames = 5;
    double seconds = .19;  // from the third frame on
    int scenes = 8;        // too short ones in a row that are reported; chosen: a few breaks are no fault
  };

  SceneBreaks() = default;
  explicit SceneBreaks(const Parameters& parameters) : parameters_(parameters) {}

  // Adds a frame. fresh: it begins a scene. broken: it does so although the picture shows no cut. seconds: since the
  // frame before. Returns whether the last `scenes` scenes were too short; until a longer one was seen.
  bool add(bool fresh, bool broken, double seconds);

 private:
  Parameters parameters_;
  int frames_ = 0;      // of this scene so far
  double seconds_ = 0;  // likewise, from its third frame on
  int broken_ = 0;      // too short scenes in a row, up to this one
};

}  // namespace cerberus::vision
