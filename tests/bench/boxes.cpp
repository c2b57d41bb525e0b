// SPDX-License-Identifier: LGPL-2.1-or-later
#include "boxes.h"

#include <cerberus/cerberus.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <tuple>

#include "launch.h"

namespace cerberus::bench {

using vision::Box;

People read_people(const std::filesystem::path& file, double truth_ends) {
  People people;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    double frame, id, x, y, w, h;
    if (!(fields >> frame >> id >> x >> y >> w >> h)) continue;
    if (double flag; fields >> flag && flag == 0) continue;
    auto& list = people[static_cast<int>(frame) - 1];
    if (x + w <= truth_ends) list.push_back({static_cast<int>(id), {x, y, w, h}});
  }
  return people;
}

std::vector<Box> read_boxes(const std::filesystem::path& file) {
  std::vector<Box> boxes;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    if (double x, y, w, h; fields >> x >> y >> w >> h) boxes.push_back({x - 1, y - 1, w, h});
  }
  return boxes;
}

std::vector<Box> found_boxes(GstBuffer* frame) {
  std::vector<Box> found;
  GPtrArray* regions = cerberus_buffer_get_regions(frame);
  for (guint i = 0; i < regions->len; ++i) {
    const auto* r = static_cast<const CerberusRegion*>(g_ptr_array_index(regions, i));
    found.push_back({r->x, r->y, r->width, r->height});
  }
  g_ptr_array_unref(regions);
  return found;
}

void match(Counts& counts, std::span<const Box> found, std::span<const Box> truth) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < found.size(); ++i)
    for (std::size_t j = 0; j < truth.size(); ++j)
      if (const double o = vision::intersection_over_union(found[i], truth[j]); o >= 0.5)
        pairs.emplace_back(o, i, j);
  std::sort(pairs.rbegin(), pairs.rend());
  std::vector<bool> used_found(found.size()), used_truth(truth.size());
  double hits = 0;
  for (const auto& [o, i, j] : pairs) {
    if (used_found[i] || used_truth[j]) continue;
    used_found[i] = used_truth[j] = true;
    ++hits;
  }
  counts.hit += hits;
  counts.extra += static_cast<double>(found.size()) - hits;
  counts.missed += static_cast<double>(truth.size()) - hits;
}

bool for_each_sample(const std::string& line, const std::function<void(GstSample*, int)>& each,
                     const std::function<void(GstElement*)>& begin) {
  GstElement* pipeline = launch(line);
  if (!pipeline) return false;
  if (begin) begin(pipeline);
  GstElement* out = gst_bin_get_by_name(GST_BIN(pipeline), "out");
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  int n = 0;
  bool failed = false;
  while (GstSample* sample = pull(pipeline, out, failed)) {
    each(sample, n++);
    gst_sample_unref(sample);
  }
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(out);
  gst_object_unref(pipeline);
  return n > 0 && !failed;
}

}  // namespace cerberus::bench
