// SPDX-License-Identifier: LGPL-2.1-or-later
// The outputs of NanoDet (RangiLyu, github.com/RangiLyu/nanodet): each cell of the picture has scores of the classes, and
// for each side of a box a distribution over its distance from the cell.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vision/persons/network_layout.h"
#include "vision/persons/person_detector.h"

namespace cerberus::vision {

struct NanodetLayout {
  // Cells of one output or of a pair.
  struct Part {
    int scores_output = 0, distances_output = 0;  // the same where one holds both
    int numbers = 0, distance_numbers = 0;        // of a cell, in each of them
    bool by_box = true;
    int first_distance = 0;      // column
    int bins = 0;                // of a side's distribution: distances of 0, 1, ... cells
    std::array<int, 4> sides{};  // of the cells in pixels, as cells_of()
    bool from_middle = true;     // distances are from the cell's middle, else from its corner
  };
  std::vector<Part> parts;
  int person = 0;  // column of the scores
};

// What NanoDet takes: (level - mean) * scale, planes in the order blue, green, red.
inline constexpr std::array<double, 3> kNanodetMean{103.53, 116.28, 123.675};
inline constexpr std::array<double, 3> kNanodetScale{1 / 57.375, 1 / 57.12, 1 / 58.395};

// NanoDet: for cells of 8, 16 and 32 (and 64) pixels one output of scores and one of distances each. NanoDet-Plus: one
// output, N x (C + 32). nullopt: the outputs are others'; with a reason in `wrong`, they are NanoDet's and cannot be
// read.
std::optional<NanodetLayout> find_nanodet(std::span<const NetworkOutput> outputs, Size input,
                                          const PersonClass& person, std::string& wrong);

// Appends the persons with a score of at least `threshold`, boxes in pixels of the input. Returns what is wrong, or
// nothing.
std::string read_nanodet(const NanodetLayout& layout, std::span<const NetworkOutput> outputs, Size input,
                         double threshold, std::vector<PersonDetection>& hits);

}  // namespace cerberus::vision
