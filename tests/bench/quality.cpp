// SPDX-License-Identifier: LGPL-2.1-or-later
// How right the results are: pixel F on masked sequences and box precision / recall on vtest.avi, through
// GStreamer and with no property set, under the scoring of the data folder's README. OpenCV's MOG2 and KNN
// are scored in the same run by the same code, as a check of the scoring itself.
#include <cerberus/cerberus.h>
#include <gst/app/gstappsink.h>
#include <gst/video/video.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <functional>
#include <map>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/background_segm.hpp>
#include <sstream>

#include "frames.h"
#include "support/data.h"

using namespace cerberus::bench;
namespace fs = std::filesystem;

namespace {

struct Sequence {
  const char* name;
  const char* source;            // launch line with one %s for the data folder
  const char* truth;             // printf pattern below the data folder
  int first;                     // number of the first frame in `truth`
  int positive_from;             // truth values that count as moving: >= this ...
  int positive_to;               // ... and <= this
  int ignored_from, ignored_to;  // values that are not scored (from > to: none)
  const char* reference;         // figures of others, from the data folder's README
};

// CDnet: 255 moving, 0 and 50 not, the rest ignored. DAVIS: > 0 moving (tennis: 170 ignored).
const Sequence kSequences[] = {
    {"jitter_traffic",
     "multifilesrc location=%s/cdnet_jitter_traffic/input/in%%06d.jpg start-index=950 stop-index=1050 "
     "caps=image/jpeg,framerate=30/1 ! jpegdec",
     "cdnet_jitter_traffic/groundtruth/gt%06d.png", 950, 255, 255, 51, 254, "MOG2 .509  KNN .485  SGM .574"},
    {"dogs-jump", "filesrc location=%s/davis_dogs-jump/dogs_jump_orig.mp4 ! decodebin",
     "davis_dogs-jump/gt/%05d.png", 0, 1, 255, 256, 0, "MOG2 .453  KNN .536  SGM .589"},
    {"tennis",
     "multifilesrc location=%s/davis_tennis/frames/%%05d.jpg start-index=0 stop-index=69 "
     "caps=image/jpeg,framerate=24/1 ! jpegdec",
     "davis_tennis/gt/%05d.png", 0, 255, 255, 170, 170, "MOG2 .325  KNN .265  SGM .766"},
    {"highway",
     "multifilesrc location=%s/cdnet_baseline_highway/input/in%%06d.jpg start-index=300 stop-index=700 "
     "caps=image/jpeg,framerate=30/1 ! jpegdec",
     "cdnet_baseline_highway/groundtruth/gt%06d.png", 300, 255, 255, 51, 254,
     "MOG2 .781  KNN .839  SGM .721"},
};

struct Counts {
  double hit = 0, extra = 0, missed = 0;
  double precision() const { return hit + extra > 0 ? hit / (hit + extra) : 0; }
  double recall() const { return hit + missed > 0 ? hit / (hit + missed) : 0; }
  double f() const { return hit > 0 ? 2 * hit / (2 * hit + extra + missed) : 0; }
};

std::string text(const char* format, auto... values) {
  std::vector<char> out(static_cast<std::size_t>(std::snprintf(nullptr, 0, format, values...)) + 1);
  std::snprintf(out.data(), out.size(), format, values...);
  return out.data();
}

// Calls `each` with every buffer that comes out of `line` (which must name an appsink "out").
bool for_each_sample(const std::string& line, const std::function<void(GstSample*, int)>& each) {
  GError* error = nullptr;
  GstElement* pipeline = gst_parse_launch(line.c_str(), &error);
  if (error) {
    std::fprintf(stderr, "bench: %s\n", error->message);
    g_clear_error(&error);
    if (pipeline) gst_object_unref(pipeline);
    return false;
  }
  GstElement* out = gst_bin_get_by_name(GST_BIN(pipeline), "out");
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  int n = 0;
  while (GstSample* sample = gst_app_sink_pull_sample(GST_APP_SINK(out))) {
    each(sample, n++);
    gst_sample_unref(sample);
  }
  GstBus* bus = gst_element_get_bus(pipeline);
  if (GstMessage* message = gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR)) {
    GError* what = nullptr;
    gst_message_parse_error(message, &what, nullptr);
    std::fprintf(stderr, "bench: %s\n", what->message);
    g_clear_error(&what);
    gst_message_unref(message);
  }
  gst_object_unref(bus);
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(out);
  gst_object_unref(pipeline);
  return n > 0;
}

// The first plane of a GRAY8 sample, or of any format with a luma plane first.
cv::Mat grey(GstSample* sample) {
  GstVideoInfo info;
  GstVideoFrame frame;
  cv::Mat copy;
  if (!gst_video_info_from_caps(&info, gst_sample_get_caps(sample)) ||
      !gst_video_frame_map(&frame, &info, gst_sample_get_buffer(sample), GST_MAP_READ))
    return copy;
  cv::Mat(info.height, info.width, CV_8UC1, GST_VIDEO_FRAME_PLANE_DATA(&frame, 0),
          static_cast<std::size_t>(GST_VIDEO_FRAME_PLANE_STRIDE(&frame, 0)))
      .copyTo(copy);
  gst_video_frame_unmap(&frame);
  return copy;
}

void score(Counts& counts, const cv::Mat& mask, const cv::Mat& truth, const Sequence& s) {
  cv::Mat scaled;
  cv::resize(mask, scaled, truth.size(), 0, 0, cv::INTER_NEAREST);
  for (int y = 0; y < truth.rows; ++y) {
    const auto* t = truth.ptr<std::uint8_t>(y);
    const auto* m = scaled.ptr<std::uint8_t>(y);
    for (int x = 0; x < truth.cols; ++x) {
      if (t[x] >= s.ignored_from && t[x] <= s.ignored_to) continue;
      const bool positive = t[x] >= s.positive_from && t[x] <= s.positive_to;
      if (m[x] && positive) counts.hit += 1;
      if (m[x] && !positive) counts.extra += 1;
      if (!m[x] && positive) counts.missed += 1;
    }
  }
}

cv::Mat truth_of(const Sequence& s, const fs::path& data, int n) {
  if (n < 3) return {};  // the first three frames are not scored
  const fs::path file = data / text(s.truth, s.first + n);
  return fs::exists(file) ? cv::imread(file.string(), cv::IMREAD_GRAYSCALE) : cv::Mat();
}

Counts mask_quality(const Sequence& s, const fs::path& data, const std::string& detector) {
  Counts counts;
  for_each_sample(
      text(s.source, data.c_str()) + " ! " + detector +
          " ! motionview stage=mask ! videoconvert ! video/x-raw,format=GRAY8 ! appsink name=out sync=false",
      [&](GstSample* sample, int n) {
        const cv::Mat truth = truth_of(s, data, n);
        if (!truth.empty()) score(counts, grey(sample), truth, s);
      });
  return counts;
}

Counts peer_quality(const Sequence& s, const fs::path& data, cv::BackgroundSubtractor& peer) {
  Counts counts;
  for_each_sample(text(s.source, data.c_str()) +
                      " ! videoconvert ! video/x-raw,format=GRAY8 ! appsink name=out sync=false",
                  [&](GstSample* sample, int n) {
                    cv::Mat frame = grey(sample), small, mask;
                    cv::resize(frame, small, {320, 320 * frame.rows / frame.cols}, 0, 0, cv::INTER_AREA);
                    peer.apply(small, mask);
                    mask = mask > 0;  // what the peer calls a shadow counts too, as in the README's table
                    const cv::Mat truth = truth_of(s, data, n);
                    if (!truth.empty()) score(counts, mask, truth, s);
                  });
  return counts;
}

using Boxes = std::vector<cv::Rect2d>;

double overlap(const cv::Rect2d& a, const cv::Rect2d& b) {
  const double both = (a & b).area();
  return both / (a.area() + b.area() - both);
}

// Greedy by overlap, IoU >= 0.5.
void match(Counts& counts, const Boxes& found, const Boxes& truth) {
  std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < found.size(); ++i)
    for (std::size_t j = 0; j < truth.size(); ++j)
      if (const double o = overlap(found[i], truth[j]); o >= 0.5) pairs.emplace_back(o, i, j);
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

// frame (from 1), id, x, y, w, h a line; boxes that end beyond x = 736 are left out, as on our side.
std::map<int, Boxes> read_boxes(const fs::path& file) {
  std::map<int, Boxes> boxes;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    double frame, id, x, y, w, h;
    if (!(fields >> frame >> id >> x >> y >> w >> h)) continue;
    auto& list = boxes[static_cast<int>(frame) - 1];
    if (x + w <= 736) list.emplace_back(x, y, w, h);
  }
  return boxes;
}

void box_quality(const fs::path& data, const std::string& detector) {
  const fs::path folder = data / "pets09_s2l1_view1";
  const auto keys = read_boxes(folder / "gt_keyframes.txt"),
             between = read_boxes(folder / "gt_interpolated.txt");
  Counts on_keys, on_all;
  for_each_sample("filesrc location=" + (folder / "vtest.avi").string() + " ! decodebin ! " + detector +
                      " ! appsink name=out sync=false",
                  [&](GstSample* sample, int n) {
                    Boxes found;
                    GPtrArray* regions = cerberus_buffer_get_regions(gst_sample_get_buffer(sample));
                    for (guint i = 0; i < regions->len; ++i) {
                      const auto* r = static_cast<CerberusRegion*>(g_ptr_array_index(regions, i));
                      if (r->x + r->width <= 736) found.emplace_back(r->x, r->y, r->width, r->height);
                    }
                    g_ptr_array_unref(regions);
                    if (const auto t = keys.find(n); t != keys.end()) match(on_keys, found, t->second);
                    if (const auto t = between.find(n); t != between.end()) match(on_all, found, t->second);
                  });
  std::printf("%-34s precision %.3f  recall %.3f   (interpolated frames: %.3f  %.3f)\n", detector.c_str(),
              on_keys.precision(), on_keys.recall(), on_all.precision(), on_all.recall());
}

}  // namespace

int main(int argc, char** argv) {
  gst_init(&argc, &argv);
  cv::setNumThreads(1);
  const auto data = cerberus::tests::data_folder();
  if (!data) {
    std::printf("skipped: %s\n", cerberus::tests::kNoData);
    return 77;
  }
  std::vector<std::string> detectors{"motiondetect", "motiondetect preset=paper"};
  if (argc > 1) detectors.assign(argv + 1, argv + argc);
  for (const std::string& detector : detectors) {
    std::printf("\nMasks, %s, 320 wide            F  precision  recall   others\n", detector.c_str());
    double sum = 0;
    for (const Sequence& s : kSequences) {
      const Counts c = mask_quality(s, *data, detector);
      sum += c.f();
      std::printf("  %-16s %20.3f %10.3f %7.3f   %s\n", s.name, c.f(), c.precision(), c.recall(),
                  s.reference);
    }
    std::printf("  %-16s %20.3f\n", "mean", sum / std::size(kSequences));
  }
  std::printf("\nThe same scoring on OpenCV's subtractors in this run (F)\n");
  for (const Sequence& s : kSequences) {
    auto mog2 = cv::createBackgroundSubtractorMOG2();
    auto knn = cv::createBackgroundSubtractorKNN();
    std::printf("  %-16s MOG2 %.3f  KNN %.3f\n", s.name, peer_quality(s, *data, *mog2).f(),
                peer_quality(s, *data, *knn).f());
  }
  std::printf("\nBoxes on vtest.avi, IoU >= 0.5\n");
  for (const std::string& detector : detectors) box_quality(*data, detector);
  return 0;
}
