// SPDX-License-Identifier: LGPL-2.1-or-later
#include "files.hpp"

#include "record/file_names.h"

namespace cerberus::plugin {

namespace {

// Bytes that may wait for the disk, beside those that a file takes out of the ring at its beginning. Derived: a minute of
// 8 Mbit/s. Guarded by the test of a disk that does not answer.
constexpr std::uint64_t kMostPending = 64 << 20;

bool is_one_of(GstCaps* caps, std::initializer_list<const char*> names) {
  for (const char* name : names)
    if (gst_structure_has_name(gst_caps_get_structure(caps, 0), name)) return true;
  return false;
}

}  // namespace

int Files::format_of(GstCaps* caps) {
  for (std::size_t k = 0; k < formats_.size(); ++k)
    if (gst_caps_is_equal(formats_[k].get(), caps)) return static_cast<int>(k);
  formats_.emplace_back(gst_caps_ref(caps), gst_caps_unref);
  return static_cast<int>(formats_.size()) - 1;
}

void Files::forget() {
  formats_.clear();
  open_.clear();
  abandoned_.clear();
  stamps_.reset();
}

bool Files::fits_mp4(const record::FileStart& start) const {
  for (std::size_t k = 0; k < start.formats.size(); ++k) {
    if (start.formats[k] < 0) continue;
    GstCaps* caps = formats_[static_cast<std::size_t>(start.formats[k])].get();
    if (k == 0 && !is_one_of(caps, {"video/x-h264", "video/x-h265"})) return false;
    if (k > 0 && settings_.matroska_allowed &&
        !is_one_of(caps, {"audio/mpeg", "audio/x-ac3", "audio/x-opus"}))
      return false;
  }
  return true;
}

void Files::open(const record::FileStart& start) {
  auto spec = std::make_shared<FileSpec>();
  spec->start = start;
  for (const int format : start.formats)
    spec->caps.push_back(format < 0 ? nullptr : formats_[static_cast<std::size_t>(format)]);
  spec->mp4 = settings_.mp4_allowed && fits_mp4(start);
  const CerberusStamp stamp = stamps_.at(clock_time(std::max(start.begin, record::Time::zero())));
  spec->camera = stamp.camera_name ? stamp.camera_name : settings_.camera;
  spec->utc = stamp.utc;
  const GstClockTime now = static_cast<GstClockTime>(g_get_real_time()) * GST_USECOND;
  spec->when = GST_CLOCK_TIME_IS_VALID(stamp.utc) ? stamp.utc : now;
  spec->name =
      record::expand_name(settings_.name, {time_of(spec->when), spec->camera, start.event, start.part});
  open_[start.file] = {start.origin, kMostPending + start.ring};
  journal_.open(start);
  writer_.open(std::move(spec));
}

void Files::write(std::uint32_t file, int track, const record::Unit& unit) {
  if (track == 0) journal_.written(file, unit.presentation);
  const auto open = open_.find(file);
  if (open == open_.end() || abandoned_.contains(file)) return;
  if (!patient_ && writer_.pending() > open->second.waiting) {
    abandoned_.insert(file);
    writer_.abandon(file, "the disk is too slow");
    return;
  }
  auto* source = static_cast<GstBuffer*>(unit.payload.get());
  GstBuffer* buffer = gst_buffer_new();
  gst_buffer_copy_into(
      buffer, source,
      GstBufferCopyFlags(GST_BUFFER_COPY_FLAGS | GST_BUFFER_COPY_TIMESTAMPS | GST_BUFFER_COPY_MEMORY), 0,
      static_cast<gsize>(-1));
  const auto in_file = [&](record::Time time) {
    return clock_time(std::max(time - open->second.origin, record::Time::zero()));
  };
  GST_BUFFER_PTS(buffer) = in_file(unit.presentation);
  GST_BUFFER_DTS(buffer) = GST_BUFFER_DTS_IS_VALID(source) ? in_file(unit.decode) : GST_CLOCK_TIME_NONE;
  writer_.write(file, track, buffer);
}

void Files::drop(std::uint32_t file) {
  open_.erase(file);
  abandoned_.erase(file);
  journal_.drop(file);
}

void Files::close(const record::FileEnd& end) {
  open_.erase(end.file);
  abandoned_.erase(end.file);
  journal_.close(end);
}

// The line begins with the time in the file, which is known only now.
void Files::write_line(std::uint32_t file, record::Time time, std::string_view line) {
  if (abandoned_.contains(file)) return;
  std::string text = "{\"file-time\":" + std::to_string(time.count()) + ',';
  text += line.substr(1);
  writer_.write_line(file, std::move(text));
}

void Files::complete(const record::FileEnd& end, record::Findings findings) {
  if (!patient_ && writer_.pending() > kMostPending) findings.picture.reset();
  writer_.close(end, std::move(findings));
}

}  // namespace cerberus::plugin
