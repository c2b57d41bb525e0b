// SPDX-License-Identifier: LGPL-2.1-or-later
// One object as two witnesses show it: motion, and the looks of a people detector. Lengths are in h, the height of the
// track's box; places in pixels of the reduced picture.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "vision/detection/region.h"
#include "vision/geometry/box.h"
#include "vision/geometry/transform.h"
#include "vision/image/pyramid.h"
#include "vision/tracking/evidence/evidence_parameters.h"

namespace cerberus::vision {

struct EvidenceTrack {
  static constexpr std::size_t kKept = 25;  // places of the last second
  static constexpr double kNever = 1e9;

  std::uint32_t id = 0;         // 0: it has not been published yet
  std::uint32_t motion_id = 0;  // of the motion track that it was last matched with; 0: none
  // It is where that motion track is, and ends with it.
  bool mirrors = false;
  bool holds_several = false;  // it mirrors a group, or a look has found several bodies in it
  bool person = false;         // looks have shown it, and go on doing so
  bool published = false;      // its evidence has sufficed
  bool travelled = false;      // its place has moved
  bool moved = false;          // the same, or its inside has moved
  bool followed = false;       // the picture has shown where it went to this frame
  bool hit = false;            // observed in this frame
  RegionKind kind = RegionKind::person_like;
  int piece_looks = 0;  // in a row that show it as a piece of a body
  double evidence = 0;
  double person_evidence = 0;  // what looks alone have added, 0 at least
  double least_seen = kNever;  // its smallest height, pixels, at which a sure look has shown it
  double quality = 0;  // mean of what the last looks gave: of two tracks of one body the better one stays
  double age = 0, unseen = 0, since_motion = 1e9, since_look = 1e9;  // s; since a look has shown it
  double moving = 0;             // s for which its inside has moved more than what is around it
  Point centre, velocity;        // velocity: h/s relative to the scene
  double height = 0, shape = 0;  // shape: width / height
  double place_variance = 0, height_variance = 0;  // pixels^2; of the logarithm

  static EvidenceTrack begin(const Box& box);

  Box box() const { return {centre.x - shape * height / 2, centre.y - height / 2, shape * height, height}; }
  void set_box(const Box& box);
  // To the present frame: by the picture, else by its velocity. before, now: of the last two frames; before is nullptr
  // where there is none. motion: of the camera, reduced pixels.
  void follow(const Pyramid* before, const Pyramid& now, const Transform& motion, double seconds,
              const EvidenceParameters& p);
  // Whether a sure look has shown it.
  bool shown() const { return least_seen < kNever; }
  // A look begins at the present frame.
  void begin_look() { looked_ = box(); }
  // Where it was then. No area: it has begun since.
  const Box& looked() const { return looked_; }
  // A look has shown it in this box then.
  void correct(const Box& seen, const EvidenceParameters& p);
  // Its box is as good as unknown: the next one that corrects it decides.
  void distrust();
  // Keeps its way for travels() and rested(); once a frame.
  void keep(const EvidenceParameters& p);
  // Whether it has gone so far, h, from any of its places of the last second, or has grown or shrunk by this in both
  // directions (logarithm).
  bool travels(double distance) const;
  // s for which it has not gone, grown or shrunk by EvidenceParameters::travel.
  double rested() const { return age - rest_.age; }
  void add(double more, const EvidenceParameters& p);
  void add_person(double more, const EvidenceParameters& p);

 private:
  struct Place {
    Point way, growth;
    double age = -1e9;
  };
  bool is_far(const Place& from, double distance) const;

  Box looked_;
  // Since it began, relative to the scene: h, and logarithms of width and height.
  Point way_, growth_;
  std::size_t next_ = 0;
  std::array<Place, kKept> places_;
  Place rest_{{}, {}, 0};  // since when it has not gone far
};

}  // namespace cerberus::vision
