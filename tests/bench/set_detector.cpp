// SPDX-License-Identifier: LGPL-2.1-or-later
#include "set_detector.h"

#include <gst/video/video.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <optional>
#include <string>

namespace cerberus::bench {

using Time = vision::FrameHistory::Time;

namespace {

DetectorSettings settings_with(const vision::DetectorParameters& numbers) {
  DetectorSettings settings;
  settings.numbers = numbers;
  return settings;
}

}  // namespace

SetDetector::SetDetector(const vision::DetectorParameters& numbers, int analysis_width)
    : SetDetector(settings_with(numbers), analysis_width) {}

SetDetector::SetDetector(const DetectorSettings& settings, int analysis_width)
    : options_(settings.options), camera_motion_(settings.camera_motion) {
  options_.analysis_width = analysis_width;
  detector_.set_options(options_);
  detector_.set_parameters(settings.numbers);
}

std::vector<Found> SetDetector::find(GstSample* sample, const View& view) {
  GstVideoInfo info;
  GstVideoFrame mapped;
  GstBuffer* buffer = gst_sample_get_buffer(sample);
  if (!gst_video_info_from_caps(&info, gst_sample_get_caps(sample)) ||
      !gst_video_frame_map(&mapped, &info, buffer, GST_MAP_READ))
    return {};
  vision::GrayView picture{static_cast<const std::uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&mapped, 0)),
                           info.width, info.height, GST_VIDEO_FRAME_PLANE_STRIDE(&mapped, 0)};
  if (view) picture = view(picture);
  const vision::Record record =
      detector_.begin({picture.data, picture.width, picture.height, picture.stride, 1, false, 0, 0, 0});
  gst_video_frame_unmap(&mapped);
  std::optional<Time> time;
  if (GST_BUFFER_PTS_IS_VALID(buffer)) time = Time(GST_BUFFER_PTS(buffer));
  const double nominal =
      GST_VIDEO_INFO_FPS_N(&info) > 0 ? 1.0 * GST_VIDEO_INFO_FPS_D(&info) / GST_VIDEO_INFO_FPS_N(&info) : 0;
  if (GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_DISCONT) && !history_.misses_frames(time, nominal))
    history_.drop();
  vision::FrameHistory history = history_;
  const vision::FrameHistory::Step step = history.next(time, nominal);
  vision::DetectorFrame frame;
  frame.size = picture.size();
  frame.fresh = step.fresh;
  frame.seconds = step.seconds;
  frame.number = number_ + 1;
  if (GST_BUFFER_FLAG_IS_SET(buffer, GST_BUFFER_FLAG_GAP) ||
      detector_.repeats(*record, frame, step.repeatable)) {
    const auto repeated = history_.repeat(time, nominal);
    std::erase_if(tracks_, [&](const vision::Track& t) {
      return !repeated || !vision::outlasts(t.state, repeated->seconds, options_.tracks);
    });
    return found();
  }
  history_ = history;
  number_ = frame.number;
  if (camera_motion_) {
    detector_.run(*record, frame);
  } else {
    record->camera.write().still = true;
    detector_.complete(*record, frame, vision::Stage::regions);
    detector_.track(*record, frame, record->regions->regions);
  }
  calm_ = record->camera->calm;
  tracks_.assign(record->tracks->begin(), record->tracks->end());
  return found();
}

std::vector<Found> SetDetector::found() const {
  std::vector<Found> all;
  for (const vision::Track& t : tracks_)
    all.push_back({{static_cast<int>(t.id), t.box}, t.kind == vision::RegionKind::group});
  return all;
}

bool parse_numbers(int argc, char** argv, vision::DetectorParameters& numbers) {
  for (int i = 1; i < argc; i += 2) {
    const bool is_set = std::strcmp(argv[i], "--set") == 0 && i + 1 < argc;
    const std::string wrong =
        is_set ? set_number(numbers, argv[i + 1]) : std::string(argv[i]) + " is no option";
    if (wrong.empty()) continue;
    std::fprintf(stderr, "%s\nusage: %s [--set STAGE.NAME=VALUE]...\n", wrong.c_str(), argv[0]);
    return false;
  }
  return true;
}

}  // namespace cerberus::bench
