// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frame_notes.hpp"

#include <cerberus/cerberus.h>

#include <algorithm>

#include "record/best_moment.h"
#include "shared/frame_line.hpp"

namespace cerberus::plugin {

namespace {

constexpr GstClockTime kLongestEncoding = 5 * GST_SECOND;
// The levels of a JPEG fill the full range: the steps of lib/publish/streams/encoders.list, which says why.
constexpr const char* kToJpeg[] = {"video/x-raw,format=BGRx", "video/x-raw,format=I420,colorimetry=1:4:0:0",
                                   "image/jpeg"};

// A map of a frame for reading, while it lives.
class MappedFrame {
 public:
  MappedFrame(const GstVideoInfo& info, GstBuffer* buffer)
      : mapped_(gst_video_frame_map(&frame_, &info, buffer, GST_MAP_READ)) {}
  ~MappedFrame() {
    if (mapped_) gst_video_frame_unmap(&frame_);
  }
  MappedFrame(const MappedFrame&) = delete;
  MappedFrame& operator=(const MappedFrame&) = delete;
  explicit operator bool() const { return mapped_; }
  GstVideoFrame* get() { return &frame_; }

 private:
  GstVideoFrame frame_;
  bool mapped_;
};

// The luma plane; an empty view where the format has none of whole bytes.
vision::GrayView luma_of(GstVideoFrame& frame) {
  const GstVideoFormatInfo* format = frame.info.finfo;
  const bool plain = (GST_VIDEO_FORMAT_INFO_IS_YUV(format) || GST_VIDEO_FORMAT_INFO_IS_GRAY(format)) &&
                     GST_VIDEO_FORMAT_INFO_DEPTH(format, 0) == 8 &&
                     GST_VIDEO_FRAME_COMP_PSTRIDE(&frame, 0) == 1;
  if (!plain) return {};
  return {static_cast<const std::uint8_t*>(GST_VIDEO_FRAME_COMP_DATA(&frame, 0)),
          GST_VIDEO_FRAME_COMP_WIDTH(&frame, 0), GST_VIDEO_FRAME_COMP_HEIGHT(&frame, 0),
          GST_VIDEO_FRAME_COMP_STRIDE(&frame, 0)};
}

bool is_analysed(GstBuffer* buffer) {
  return cerberus_buffer_regions_known(buffer) || cerberus_buffer_peek_fusion(buffer) ||
         cerberus_buffer_peek_camera_motion(buffer) || cerberus_buffer_peek_pose(buffer);
}

record::Picture sample_of(GstBuffer* buffer, GstCaps* caps) {
  return {gst_sample_new(buffer, caps, nullptr, nullptr),
          [](void* sample) { gst_sample_unref(static_cast<GstSample*>(sample)); }};
}

// A copy of the pixels alone, so that no buffer of the stream's pool is held.
record::Picture copy_of(GstVideoFrame& frame, GstCaps* caps) {
  GstVideoInfo plain;
  if (!gst_video_info_set_format(&plain, GST_VIDEO_INFO_FORMAT(&frame.info),
                                 GST_VIDEO_INFO_WIDTH(&frame.info), GST_VIDEO_INFO_HEIGHT(&frame.info)))
    return nullptr;
  g_autoptr(GstBuffer) buffer = gst_buffer_new_allocate(nullptr, GST_VIDEO_INFO_SIZE(&plain), nullptr);
  GstVideoFrame to;
  if (!buffer || !gst_video_frame_map(&to, &plain, buffer, GST_MAP_WRITE)) return nullptr;
  const bool copied = gst_video_frame_copy(&to, &frame);
  gst_video_frame_unmap(&to);
  if (!copied) return nullptr;
  return sample_of(buffer, caps);
}

}  // namespace

void FrameNotes::set_caps(GstCaps* caps) {
  const GstStructure* structure = gst_caps_get_structure(caps, 0);
  size_ = {};
  gst_structure_get_int(structure, "width", &size_.width);
  gst_structure_get_int(structure, "height", &size_.height);
  raw_.reset();
  const GstCapsFeatures* features = gst_caps_get_features(caps, 0);
  GstVideoInfo info;
  if (gst_structure_has_name(structure, "video/x-raw") &&
      gst_caps_features_is_equal(features, GST_CAPS_FEATURES_MEMORY_SYSTEM_MEMORY) &&
      gst_video_info_from_caps(&info, caps))
    raw_ = info;
  jpeg_ = gst_structure_has_name(structure, "image/jpeg");
  caps_ = {gst_caps_ref(caps), gst_caps_unref};
}

void FrameNotes::reset() {
  frames_ = 0;
}

// Returns the score of the object that can be seen best; all are equally sharp where `luma` is empty.
double FrameNotes::read_objects(GstBuffer* buffer, record::Note& note, vision::GrayView luma) const {
  g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(buffer);
  double best = 0;
  for (guint k = 0; k < regions->len; ++k) {
    const auto* region = static_cast<const CerberusRegion*>(g_ptr_array_index(regions, k));
    note.kinds.push_back(cerberus_region_kind_get_nick(region->kind));
    if (region->tracked) note.tracks.push_back(region->id);
    const bool person = region->person || region->kind == CERBERUS_REGION_KIND_PERSON_LIKE;
    if (region->tracked) note.people += region->kind == CERBERUS_REGION_KIND_GROUP ? 2 : person ? 1 : 0;
    const vision::Box box{region->x, region->y, region->width, region->height};
    best = std::max(best, record::view_score(box, size_, luma.empty() ? 0 : record::sharpness(luma, box)));
  }
  return best;
}

std::optional<record::Note> FrameNotes::note(GstBuffer* buffer, const CerberusStamp& stamp, record::Time time,
                                             const record::FrameJournal& journal, Wanted wanted) {
  const guint64 number = frames_++;
  const bool pictured = has_pictures() && wanted.picture && gst_buffer_get_size(buffer) > 0;
  const bool analysed = raw_ || is_analysed(buffer);
  if (!pictured && !analysed) return std::nullopt;
  record::Note note;
  note.time = time;
  if (analysed && wanted.line)
    note.line = write_frame_line(line_, buffer, stamp, {number, size_.width, size_.height});
  std::optional<MappedFrame> mapped;
  if (pictured && raw_) mapped.emplace(*raw_, buffer);
  GstVideoFrame* frame = mapped && *mapped ? mapped->get() : nullptr;
  note.score = read_objects(buffer, note, frame ? luma_of(*frame) : vision::GrayView{});
  if (pictured && (frame || jpeg_) && journal.wants_picture(time, note.score))
    note.picture = frame ? copy_of(*frame, caps_.get()) : sample_of(buffer, caps_.get());
  if (!analysed && !note.picture) return std::nullopt;
  if (const CerberusFusion* fusion = cerberus_buffer_peek_fusion(buffer);
      fusion && fusion->action != CERBERUS_FUSION_ZERO && fusion->action != CERBERUS_FUSION_HOLD &&
      fusion->rule_name)
    note.rule = fusion->rule_name;
  return note;
}

std::uint64_t size_of(const record::Picture& picture) {
  return picture ? gst_buffer_get_size(gst_sample_get_buffer(static_cast<GstSample*>(picture.get()))) : 0;
}

GstSample* encode_jpeg(const record::Picture& picture, std::string& fault) {
  auto* sample = static_cast<GstSample*>(picture.get());
  if (gst_structure_has_name(gst_caps_get_structure(gst_sample_get_caps(sample), 0), "image/jpeg"))
    return gst_sample_ref(sample);
  GstSample* converted = gst_sample_ref(sample);
  for (const char* step : kToJpeg) {
    g_autoptr(GstSample) before = converted;
    g_autoptr(GstCaps) caps = gst_caps_from_string(step);
    g_autoptr(GError) error = nullptr;
    converted = gst_video_convert_sample(before, caps, kLongestEncoding, &error);
    if (converted) continue;
    fault = error ? error->message : "the encoder failed";
    return nullptr;
  }
  return converted;
}

}  // namespace cerberus::plugin
