// SPDX-License-Identifier: LGPL-2.1-or-later
// All sequences of the data folder by which a number or a mechanism is chosen, as its README describes them, and what is
// measured on each kind.
#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "boxes.h"
#include "people_sequences.h"
#include "tracks.h"

namespace cerberus::bench {

enum class Labels {
  all,     // each object that matters, with its identity
  one,     // one object of several
  nobody,  // the scene has no object
};
inline constexpr std::array kLabels{Labels::all, Labels::one, Labels::nobody};

struct DevelopmentSequence {
  std::string name;
  Labels labels;
  std::string source;           // launch line that ends in decoded video
  std::filesystem::path truth;  // MOT rows (all), one box a frame (one); empty for nobody
};
// In the order of their names. A folder of the other kinds is not listed.
std::vector<DevelopmentSequence> development_sequences(const std::filesystem::path& data);

// The figures of a run; what they are depends on the labels: figure_names().
using Figures = std::array<double, 4>;
const std::array<const char*, 4>& figure_names(Labels labels);

// One run over a sequence. add() takes what was found on frame after frame; mirrored: the pictures were, and the truth is.
//   all     MOTA (a run below -1 counts as -1), IDF1, precision, recall, at IoU .5; groups claim no person
//   one     recall at IoU .3 and .5 of the labelled object, its identities, other boxes a frame
//   nobody  identities a minute, share of the frames with a box
class DevelopmentRun {
 public:
  DevelopmentRun(const DevelopmentSequence& sequence, bool mirrored);
  // time: of the frame, in seconds.
  void add(const std::vector<Found>& found, int width, double time);
  Figures figures() const;

 private:
  void add_labelled(const std::vector<Found>& found, vision::Box box);

  Labels labels_;
  bool mirrored_;
  People people_;                   // all
  std::vector<vision::Box> boxes_;  // one
  TrackScore score_;
  std::set<int> identities_;
  int frames_ = 0, with_box_ = 0;
  int labelled_ = 0, overlapped_ = 0, right_ = 0, others_ = 0;
  double first_ = 0, last_ = 0;
};

}  // namespace cerberus::bench
