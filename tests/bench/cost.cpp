// SPDX-License-Identifier: LGPL-2.1-or-later
// The cost of the chain, beside its peers on the same frames in the same run. Single-threaded everywhere: figures are
// CPU time of the one streaming thread (or of the calling thread), medians of five rounds, in each of which every
// candidate runs once; quote the ratios.
#include <gst/app/gstappsrc.h>
#include <gst/gst.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/background_segm.hpp>

#include "frames.h"
#include "launch.h"
#include "support/allocations.h"
#include "support/chain.h"
#include "support/data.h"

using namespace cerberus;
using namespace cerberus::bench;

namespace {

constexpr int kRounds = 5;

// What is measured.
struct Row {
  const char* name;
  // Seconds a frame of one run; negative: it does not run; none: it is not there.
  std::function<double()> run;
  const char* most = nullptr;  // the largest ratio that is asked for, if any; time is not judged
};

// Thread CPU time of the streaming thread between the first buffer and the end of the stream.
struct StreamClock {
  double begin = -1, last = 0;
  std::size_t seen = 0;
};

GstPadProbeReturn on_source_item(GstPad*, GstPadProbeInfo* info, gpointer data) {
  auto* clock = static_cast<StreamClock*>(data);
  if (GST_PAD_PROBE_INFO_TYPE(info) & GST_PAD_PROBE_TYPE_BUFFER) {
    if (clock->begin < 0) clock->begin = thread_seconds();
    clock->last = thread_seconds();
    ++clock->seen;
  }
  return GST_PAD_PROBE_OK;
}

// Seconds a frame of one run of `elements` over `count` frames pushed from memory; negative when it does not
// run.
double run_pipeline(const std::string& elements, const Frames& frames, std::size_t count) {
  const std::string line = "appsrc name=in format=time block=true max-bytes=0 max-buffers=8 ! " + elements +
                           " ! fakesink name=out sync=false";
  GstElement* pipeline = launch(line);
  if (!pipeline) return -1;
  GstElement* in = gst_bin_get_by_name(GST_BIN(pipeline), "in");
  GstCaps* caps = gst_caps_from_string((frames.caps + ", framerate=(fraction)30/1").c_str());
  g_object_set(in, "caps", caps, nullptr);
  gst_caps_unref(caps);
  StreamClock clock;
  GstPad* pad = gst_element_get_static_pad(in, "src");
  gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, on_source_item, &clock, nullptr);
  gst_object_unref(pad);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  for (std::size_t n = 0; n < count; ++n) {
    const auto& frame = frames.data[frames.loop(n)];
    GstBuffer* buffer =
        gst_buffer_new_wrapped_full(GST_MEMORY_FLAG_READONLY, const_cast<std::uint8_t*>(frame.data()),
                                    frame.size(), 0, frame.size(), nullptr, nullptr);
    GST_BUFFER_PTS(buffer) = gst_util_uint64_scale(n, GST_SECOND, 30);
    GST_BUFFER_DURATION(buffer) = GST_SECOND / 30;
    if (gst_app_src_push_buffer(GST_APP_SRC(in), buffer) != GST_FLOW_OK) break;
  }
  gst_app_src_end_of_stream(GST_APP_SRC(in));
  GstBus* bus = gst_element_get_bus(pipeline);
  GstMessage* message = gst_bus_timed_pop_filtered(
      bus, 120 * GST_SECOND, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
  const bool finished = message && GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS && clock.seen == count;
  if (message) gst_message_unref(message);
  gst_object_unref(bus);
  gst_element_set_state(pipeline, GST_STATE_NULL);
  gst_object_unref(in);
  gst_object_unref(pipeline);
  return finished ? (clock.last - clock.begin) / static_cast<double>(count - 1) : -1;
}

// Seconds a frame of one run of `work` over `count` frames.
double run_loop(const Frames& frames, std::size_t count, const std::function<void(const cv::Mat&)>& work) {
  const double begin = thread_seconds();
  for (std::size_t n = 0; n < count; ++n) {
    auto& frame = frames.data[frames.loop(n)];
    work(cv::Mat(frames.height, frames.width, CV_8UC1, const_cast<std::uint8_t*>(frame.data())));
  }
  return (thread_seconds() - begin) / static_cast<double>(count);
}

// The first row is the unit. A machine's speed may jump from one second to the next: every candidate therefore runs
// once in each round, and is compared with the unit of that round.
void compare(const std::vector<Row>& rows) {
  std::vector<std::vector<double>> seconds(rows.size()), ratios(rows.size());
  std::vector<bool> there(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) there[i] = rows[i].run != nullptr;
  for (int round = 0; round < kRounds; ++round)
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (!there[i]) continue;
      const double a_frame = rows[i].run();
      there[i] = a_frame >= 0;
      seconds[i].push_back(a_frame);
      if (there[0]) ratios[i].push_back(a_frame / seconds[0].back());
    }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!there[i]) {
      std::printf("  %-58s %s\n", rows[i].name,
                  rows[i].run ? "does not run" : "not there (package gstreamer1.0-opencv)");
      continue;
    }
    const auto [low, high] = std::ranges::minmax(seconds[i]);
    std::printf("  %-58s %8.3f ms  (%.3f .. %.3f)", rows[i].name, 1e3 * median(seconds[i]), 1e3 * low,
                1e3 * high);
    if (there[0]) std::printf("   %6.2f", median(ratios[i]));
    if (there[0] && rows[i].most) std::printf("   asked: at most %s", rows[i].most);
    std::printf("\n");
  }
}

bool has(const char* element) {
  GstElementFactory* factory = gst_element_factory_find(element);
  if (factory) gst_object_unref(factory);
  return factory != nullptr;
}

void stages(const Frames& frames, const char* what) {
  tests::Chain chain;
  const std::size_t count = 600;
  std::printf("\nStages, %s (%dx%d), ns an analysis pixel and allocations a frame (after 50 frames)\n", what,
              frames.width, frames.height);
  std::array<double, tests::Chain::kStages> spent{};
  std::array<std::size_t, tests::Chain::kStages> allocated{};
  for (std::size_t n = 0; n < count; ++n) {
    const auto& frame = frames.data[frames.loop(n)];
    chain.begin({frame.data(), frames.width, frames.height, frames.width, 1, false, 0, 0, 0}, 1.0 / 30);
    for (std::size_t s = 0; s < tests::Chain::kStages; ++s) {
      const std::size_t before = tests::allocations();
      const double begin = thread_seconds();
      chain.run_stage(s);
      if (n < 50) continue;
      spent[s] += thread_seconds() - begin;
      allocated[s] += tests::allocations() - before;
    }
  }
  const double pixels = static_cast<double>(chain.analysis_size().area());
  double total = 0;
  for (std::size_t s = 0; s < tests::Chain::kStages; ++s) {
    const double seconds = spent[s] / static_cast<double>(count - 50);
    total += seconds;
    std::printf("  %-58s %8.2f ns  %8.3f ms  %5.1f allocations\n", tests::Chain::stage_name(s),
                1e9 * seconds / pixels, 1e3 * seconds,
                static_cast<double>(allocated[s]) / static_cast<double>(count - 50));
  }
  std::printf("  %-58s %8.2f ns  %8.3f ms  %5.1f bytes held an analysis pixel\n", "all", 1e9 * total / pixels,
              1e3 * total, static_cast<double>(chain.bytes()) / pixels);
}

// A word about the column that compare() prints last.
constexpr char kLastColumn[] = "last column: median of the rounds' ratios to";

void against_opencv(const Frames& frames, const char* what) {
  const std::size_t count = 300;
  std::printf("\n%s, %dx%d grey, cost a frame (%s MOG2)\n", what, frames.width, frames.height, kLastColumn);
  auto mog2 = cv::createBackgroundSubtractorMOG2();
  auto knn = cv::createBackgroundSubtractorKNN();
  cv::Mat mask;
  const auto pipeline = [&](const char* elements) {
    return [&frames, elements] { return run_pipeline(elements, frames, count); };
  };
  const auto apply = [&](auto& subtractor) {
    return [&] { return run_loop(frames, count, [&](const cv::Mat& f) { subtractor->apply(f, mask); }); };
  };
  compare({{"OpenCV MOG2", apply(mog2)},
           {"OpenCV KNN", apply(knn)},
           {"motiondetect", pipeline("motiondetect"), "1.00"},
           {"motiondetect preset=paper", pipeline("motiondetect preset=paper")},
           {"no element at all", pipeline("identity")}});
}

void against_gstreamer(const Frames& frames) {
  const std::size_t count = frames.width > 1000 ? 120 : 240;
  std::printf("\nThrough GStreamer, %dx%d I420, cost a frame (%s videoconvert ! motioncells)\n", frames.width,
              frames.height, kLastColumn);
  const auto pipeline = [&](const char* elements) -> std::function<double()> {
    return [&frames, count, elements] { return run_pipeline(elements, frames, count); };
  };
  const auto peer = [&](const char* element, const char* elements) {
    return has(element) ? pipeline(elements) : nullptr;
  };
  constexpr char kStages[] = "cameramotion ! threeframediff ! fuzzythreshold ! motionregions ! motiontrack";
  compare({{"videoconvert ! motioncells", peer("motioncells", "videoconvert n-threads=1 ! motioncells")},
           {"videoconvert ! segmentation method=mog2",
            peer("segmentation", "videoconvert n-threads=1 ! segmentation method=mog2")},
           {"motiondetect", pipeline("motiondetect"), frames.width == 1920 ? "0.20" : nullptr},
           {kStages, pipeline(kStages)}});
}

}  // namespace

int main(int argc, char** argv) {
  gst_init(&argc, &argv);
  cv::setNumThreads(1);
  const auto source = tests::vtest_source();
  if (!source) {
    std::printf("skipped: %s\n", tests::kNoVtest);
    return 77;
  }
  const auto grey = load_frames(*source, "GRAY8", 320, 240, 90);
  if (!grey) return 1;
  stages(*grey, "still camera (vtest.avi)");
  against_opencv(*grey, "Still camera (vtest.avi)");
  if (const auto data = tests::data_folder()) {
    const std::string frames = (*data / "davis_tennis" / "frames" / "%05d.jpg").string();
    const auto tennis =
        load_frames("multifilesrc location=" + frames +
                        " start-index=0 stop-index=69 caps=image/jpeg,framerate=24/1 ! jpegdec",
                    "GRAY8", 320, 240, 70);
    if (tennis) {
      stages(*tennis, "moving camera (tennis)");
      against_opencv(*tennis, "Moving camera (tennis)");
    }
  } else {
    std::printf("\n%s: the moving camera is left out\n", tests::kNoData);
  }
  for (const auto& [width, height, count] : {std::array{320, 240, 90}, {768, 576, 60}, {1920, 1080, 40}})
    if (const auto frames = load_frames(*source, "I420", width, height, count)) against_gstreamer(*frames);
  return 0;
}
