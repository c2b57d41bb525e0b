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
// The source as it is, or mirrored, as I420.
std::string line_of(const DevelopmentSequence& sequence, bool mirrored);
// Of one labelled object: those frames in which it is not absent.
People read_truth(const DevelopmentSequence& sequence);

// The figures of a run; what they are depends on the labels: figure_names().
using Figures = std::array<double, 4>;
const std::array<const char*, 4>& figure_names(Labels labels);

// When a labelled object had its first box with an IoU of .5 that is no group's.
struct FirstBox {
  int person = 0;
  double seconds = 0;  // since its first labelled frame; infinite: never
  // In that frame it was whole inside the picture, nearer people hid less than half of it, and it was as high as the
  // windows of the usual person detector can show: 1/5 to 3/4 of the picture.
  bool plain = true;
};

// What a run over a sequence gave, or several of one sequence.
struct Outcome {
  Figures figures{};  // means
  std::vector<FirstBox> first_boxes;
  // Of the boxes with an IoU of .3 that are no groups': their width and height over the labelled object's, where the
  // whole of it is in the picture.
  std::vector<double> widths, heights;
};

// One run over a sequence. add() takes what was found on frame after frame; mirrored: the pictures were, and the truth is.
//   all     MOTA (a run below -1 counts as -1), IDF1, precision, recall, at IoU .5; groups claim no person
//   one     recall at IoU .3 and .5 of the labelled object, its identities, other boxes a frame
//   nobody  identities a minute, share of the frames with a box
class DevelopmentRun {
 public:
  DevelopmentRun(const DevelopmentSequence& sequence, bool mirrored);
  // size: of the frame; time: in seconds.
  void add(const std::vector<Found>& found, vision::Size size, double time);
  Outcome outcome() const;

 private:
  struct Appearance {
    double since = 0;  // time of the first labelled frame
    FirstBox first;
  };

  void add_labelled(const std::vector<Found>& found, vision::Box box);
  void add_person(const Person& person, const std::vector<Person>& people, const std::vector<Person>& found,
                  vision::Size size, double time);
  Figures figures() const;

  Labels labels_;
  bool mirrored_;
  People people_;
  std::map<int, Appearance> appearances_;  // by person
  std::vector<double> widths_, heights_;
  TrackScore score_;
  std::set<int> identities_;
  int frames_ = 0, with_box_ = 0;
  int labelled_ = 0, overlapped_ = 0, right_ = 0, others_ = 0;
  double first_ = 0, last_ = 0;
};

}  // namespace cerberus::bench
