// SPDX-License-Identifier: LGPL-2.1-or-later
// People on vtest.avi: where they are by the ground truth, where the elements found them, and how well the two agree
// under the scoring of the data folder's README.
#pragma once

#include <gst/gst.h>

#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "counts.h"
#include "vision/geometry/box.h"

namespace cerberus::bench {

struct Person {
  int id = 0;
  vision::Box box;
};
using People = std::map<int, std::vector<Person>>;  // by frame, from 0

// vtest.avi's truth ends here: boxes that go on beyond it are left out on both sides.
constexpr double kTruthEnds = 736;

// frame (from 1), id, x, y, w, h and perhaps a flag a line; 0 in the flag: not to be scored. Boxes that end beyond
// `truth_ends` are left out.
People read_people(const std::filesystem::path& file, double truth_ends = kTruthEnds);
// x, y, w, h a line, of one person in frame after frame; pixels are counted from 1.
std::vector<vision::Box> read_boxes(const std::filesystem::path& file);
// What is on the frame.
std::vector<vision::Box> found_boxes(GstBuffer* frame);
// Greedy by overlap, IoU >= 0.5.
void match(Counts& counts, std::span<const vision::Box> found, std::span<const vision::Box> truth);

// Calls `each` with every sample that comes out of `line`, which must name an appsink "out". `begin` sees the pipeline
// before it plays. False where nothing came, or an error ended it.
bool for_each_sample(const std::string& line, const std::function<void(GstSample*, int)>& each,
                     const std::function<void(GstElement*)>& begin = {});

}  // namespace cerberus::bench
