// SPDX-License-Identifier: LGPL-2.1-or-later
// Persons in the output of a neural network that detects objects.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vision/persons/nanodet.h"
#include "vision/persons/network_input.h"
#include "vision/persons/network_layout.h"
#include "vision/persons/person_detector.h"

namespace cerberus::vision {

// Reads the outputs of a network, run by run. The first run that returns any box decides the layout (N boxes, C classes;
// N x K may also be K x N, with a batch of 1 or without one):
// - YOLO 5, 6 and 7: N x (4 + 1 + C), the middle, width and height, the score that there is an object, scores of the classes;
// - YOLO 8 and 11: (4 + C) x N, the same without the object's score; numbers behind the classes are left out;
// - YOLOX: as YOLO 5, with one box for each cell; boxes in cells and logarithms are decoded;
// - end to end (YOLO 10): N x 6, left, top, right, bottom, score, class; N x 5, the same with one class;
// - SSD: 1 x 1 x N x 7, picture, class, score, left, top, right, bottom; or two outputs, N x 4 (left, top, right, bottom)
//   and N x C, whose first class is the background where the scores of each box add up to 1;
// - NanoDet and NanoDet-Plus (nanodet.h);
// - the yolo layers of darknet, an output each, N x (5 + C) in shares of the input.
// Of several outputs those are taken that have such a shape. Coordinates are in pixels of the input, or in shares of it
// where none is larger than a share can be. Layouts of one shape are told apart by the number of boxes (YOLO has 1 or 3
// for each cell of its input), by what the numbers can be, and by the number of classes; where that does not suffice, and
// where scores are beyond 0 to 1 or most boxes have no size, the outputs are refused. A single box without a size is no
// person.
class NetworkReader {
 public:
  // input: width and height of the network's picture in pixels. darknet_classes: of a darknet model that OpenCV runs,
  // with one output for each of its yolo layers; 0: another network.
  NetworkReader(Size input, PersonClass person, int darknet_classes = 0)
      : input_(input), person_(person), darknet_classes_(darknet_classes) {}

  // Of the pictures from now on, where a network takes several sizes.
  void set_input(Size input) { input_ = input; }

  // Appends the persons with a score (0 to 1) of at least `threshold`: boxes in pixels of the input. Returns nullopt, or
  // the end of a sentence: "its output 1 x 6 x 300 cannot be read: ...".
  std::optional<std::string> read(std::span<const NetworkOutput> outputs, double threshold,
                                  std::vector<PersonDetection>& hits);

  // What networks with this layout take. Known once the layout is; before, 0 to 1.
  NetworkInput usual_input() const;

 private:
  std::string decide(std::span<const NetworkOutput> outputs);
  void decide_darknet(std::span<const NetworkOutput> outputs, std::string& wrong);
  std::string read_rows(const NetworkLayout& layout, std::span<const NetworkOutput> outputs, double threshold,
                        std::vector<PersonDetection>& hits) const;

  Size input_;
  PersonClass person_;
  int darknet_classes_;
  // Empty and nullopt: the layout is not known yet.
  std::vector<NetworkLayout> layouts_;
  std::optional<NanodetLayout> nanodet_;
};

}  // namespace cerberus::vision
