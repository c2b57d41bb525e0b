// SPDX-License-Identifier: LGPL-2.1-or-later
// How the outputs of a neural network that detects objects are to be read.
#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vision/image/image.h"

namespace cerberus::vision {

struct NetworkOutput {
  std::span<const float> values;
  std::vector<int> shape;
};

// The class that is a person, as a file with the names of the classes tells.
struct PersonClass {
  int number = -1;  // -1: no such file; the first class, of SSD the first after the background
  int classes = 0;  // names in the file; 0: no such file
};

// An output of two dimensions: numbers of boxes.
struct NetworkTable {
  std::span<const float> values;
  int boxes = 0, numbers = 0;
  bool by_box = true;  // a box after the other, not number after number

  double at(int box, int n) const {
    const auto i = static_cast<std::size_t>(box), k = static_cast<std::size_t>(n);
    return values[by_box ? i * static_cast<std::size_t>(numbers) + k
                         : k * static_cast<std::size_t>(boxes) + i];
  }
  // The four numbers from `first` on are a box. Zeros fill the places of boxes that a network does not have; what is not
  // finite is no box either.
  bool holds_box(int i, int first) const {
    bool any = false;
    for (int n = first; n < first + 4; ++n) {
      if (!std::isfinite(at(i, n))) return false;
      any = any || at(i, n) != 0;
    }
    return any;
  }
};

struct NetworkLayout {
  enum class Box {
    middle,   // x and y of the middle, width, height
    corners,  // left, top, right, bottom
    cells     // the middle in cells from the cell that the box belongs to, logarithms of the size in cells
  };
  int boxes_output = 0, scores_output = 0;  // which outputs; the same where one holds boxes and scores
  int box_numbers = 0, score_numbers = 0;   // of a box, in each of them
  bool by_box = true;
  Box box = Box::middle;
  bool in_shares = false;             // of the input's width and height, not pixels
  int first = 0;                      // column of the first of a box's four numbers
  int score = 0, object_score = -1;   // columns; -1: there is none, scores are of the class alone
  int class_column = -1, person = 0;  // column of the class's number, and the number of persons
  bool takes_bytes = false;           // pictures have values from 0 to 255, not to 1
};

// The output as a table of boxes with so many numbers, or of so many boxes. nullopt: it has another shape.
std::optional<NetworkTable> table_of(const NetworkOutput& output, int numbers, bool by_box);
std::optional<NetworkTable> table_of_boxes(const NetworkOutput& output, int boxes, bool by_box);

// Whether a number can be a score, 0 to 1 but for rounding. What is not finite is no score of a person, and no mistake of
// the layout.
bool is_score(double value);

// The cells of an input of this size. Sides of 0 are none.
int count_cells(Size input, std::span<const int> sides);
// The cell of this number, below count_cells(): all sides row by row, the first side first.
struct NetworkCell {
  int column = 0, row = 0, side = 0;
};
NetworkCell cell_at(Size input, std::span<const int> sides, int number);

// Sides of the cells of a network with one box for each cell and an input of this size: 0 behind the last. nullopt: such
// a network has another number of boxes.
std::optional<std::span<const int>> cells_of(Size input, int boxes);

// input: width and height of the network's picture. nullopt and a reason in `wrong`: the outputs
// cannot be read; without one: they hold no box yet.
std::optional<NetworkLayout> decide_layout(std::span<const NetworkOutput> outputs, Size input,
                                           const PersonClass& person, std::string& wrong);

}  // namespace cerberus::vision
