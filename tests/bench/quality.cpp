// SPDX-License-Identifier: LGPL-2.1-or-later
// How right the results are: pixel F on masked sequences and box precision / recall on vtest.avi, through
// GStreamer and with no property set, under the scoring of the data folder's README. OpenCV's MOG2 and KNN
// are scored in the same run by the same code, as a check of the scoring itself.
#include <cerberus/cerberus.h>
#include <gst/video/video.h>

#include <cstdio>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/background_segm.hpp>

#include "boxes.h"
#include "support/data.h"

using namespace cerberus;
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

std::string text(const char* format, auto... values) {
  std::vector<char> out(static_cast<std::size_t>(std::snprintf(nullptr, 0, format, values...)) + 1);
  std::snprintf(out.data(), out.size(), format, values...);
  return out.data();
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

// The boxes that end before the truth does.
std::vector<vision::Box> scored(std::vector<vision::Box> boxes) {
  std::erase_if(boxes, [](const vision::Box& b) { return b.right() > kTruthEnds; });
  return boxes;
}

std::vector<vision::Box> boxes_of(std::span<const Person> people) {
  std::vector<vision::Box> boxes;
  for (const Person& p : people) boxes.push_back(p.box);
  return boxes;
}

void box_quality(const fs::path& data, const std::string& detector) {
  const fs::path folder = data / "pets09_s2l1_view1";
  const auto keys = read_people(folder / "gt_keyframes.txt"),
             between = read_people(folder / "gt_interpolated.txt");
  Counts on_keys, on_all;
  for_each_sample("filesrc location=" + (folder / "vtest.avi").string() + " ! decodebin ! " + detector +
                      " ! appsink name=out sync=false",
                  [&](GstSample* sample, int n) {
                    const auto found = scored(found_boxes(gst_sample_get_buffer(sample)));
                    if (const auto t = keys.find(n); t != keys.end())
                      match(on_keys, found, boxes_of(t->second));
                    if (const auto t = between.find(n); t != between.end())
                      match(on_all, found, boxes_of(t->second));
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
