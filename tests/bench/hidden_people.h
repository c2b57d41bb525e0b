// SPDX-License-Identifier: LGPL-2.1-or-later
// Who was hidden for a moment, and whether he has the same identity afterwards.
#pragma once

#include <map>
#include <span>
#include <vector>

#include "boxes.h"

namespace cerberus::bench {

// What is known of one person in one frame.
struct Seen {
  double time = 0;      // s
  bool hidden = false;  // nearer people cover more than half of him
  int track = -1;       // the one that is matched
};
using Lives = std::map<int, std::vector<Seen>>;  // by person, in the order of time

// Do people whose feet are lower in the picture, and who are nearer therefore, cover more than half of his box?
bool is_covered(const Person& person, std::span<const Person> all);

struct HiddenPeople {
  int asked = 0, kept = 0;
};
// Times of at most 3 s in which a person is hidden, or not annotated between two frames in which he is, and had a track in
// the second before. frame: s from one to the next.
HiddenPeople hidden_people(const Lives& lives, double frame);

}  // namespace cerberus::bench
