// SPDX-License-Identifier: LGPL-2.1-or-later
// How a robot saw people and kept them in its picture, frame after frame.
//
// A person counts while at least half of the person is in the picture and not hidden. Who is seen less does not count: a
// box that does not overlap anybody who counts by an IoU of .5, and of which more than half lies inside a person's box,
// is neither right nor wrong, and a person without a box is not missed. Boxes of persons end where the picture does.
#pragma once

#include <map>
#include <set>
#include <span>
#include <vector>

#include "people_sequences.h"
#include "tracks.h"

namespace cerberus::bench {

// A person of the truth on a frame.
struct Subject {
  Person person;
  double visible = 1;    // share of the person that is in the picture and not hidden
  double bearing = 0;    // degrees, from the camera's axis
  bool in_sight = true;  // no wall is between the camera and the person, wherever the camera looks
  bool moves = true;
};

struct PatrolFigures {
  double in_picture_after = 0;  // s, since a person moves in sight; the first of several. Infinite: never
  double found_after = 0;       // s, from where a person counts to the first box: of several persons the last
  double in_picture =
      0;           // share of the time since then with somebody in sight, in which somebody is in the picture
  double off = 0;  // RMS in degrees, from kSettled after the first box: who is nearest the axis
  double precision = 0, recall = 0;  // of boxes, IoU .5
  double identities = 0;             // a person who has a box, the mean
  double false_identities = 0;       // a minute: tracks that are on nobody in any frame
};

class PatrolScore {
 public:
  static constexpr double kSettled = 2;  // s
  // half_view: degrees.
  PatrolScore(vision::Size size, double half_view) : size_(size), half_view_(half_view) {}

  void add(const std::vector<Subject>& subjects, const std::vector<Found>& found, double seconds);
  PatrolFigures figures() const;

 private:
  struct Life {
    double counts_since = -1, found = -1;  // s
    std::set<int> tracks;
  };
  void add_gaze(const std::vector<Subject>& subjects, double seconds);
  void add_boxes(const std::vector<Subject>& subjects, const std::vector<Found>& found, double seconds);
  vision::Box seen_part(const vision::Box& box) const;

  vision::Size size_;
  double half_view_;
  TrackScore score_;
  std::map<int, Life> lives_;
  std::set<int> tracks_, on_somebody_;
  double first_ = -1, last_ = 0, moves_since_ = -1, in_picture_since_ = -1, found_since_ = -1;
  int frames_ = 0, in_sight_ = 0, in_picture_ = 0, settled_ = 0;
  double squares_ = 0;
};

}  // namespace cerberus::bench
