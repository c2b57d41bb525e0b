// SPDX-License-Identifier: LGPL-2.1-or-later
// Reads what is attached to the frames of one stream into notes for the files that will have them: a line of JSON, the
// facts for the index, and a copy of the picture where it may be the best one of its file.
#pragma once

#include <gst/video/video.h>

#include <optional>

#include "record/frame_journal.h"
#include "shared/stamps.hpp"
#include "text/json_line.h"
#include "vision/image/image.h"

namespace cerberus::plugin {

class FrameNotes {
 public:
  // A stream with these caps begins: raw frames, or encoded ones whose metadata survived the encoder.
  void set_caps(GstCaps* caps);
  void reset();
  // Of the frames; zero: not known.
  vision::Size size() const { return size_; }

  struct Wanted {
    bool line = true, picture = true;
  };
  // `time`: running time. nullopt: nothing is attached to the frame, and it has no picture.
  std::optional<record::Note> note(GstBuffer* buffer, const CerberusStamp& stamp, record::Time time,
                                   const record::FrameJournal& journal, Wanted wanted);

 private:
  double read_objects(GstBuffer* buffer, record::Note& note, vision::GrayView luma) const;
  bool has_pictures() const { return raw_ || jpeg_; }

  vision::Size size_;
  std::optional<GstVideoInfo> raw_;  // frames that can be mapped
  bool jpeg_ = false;                // frames that are pictures as they are
  std::shared_ptr<GstCaps> caps_;
  guint64 frames_ = 0;
  text::JsonLine line_;
};

// Bytes of a picture of a note as it is kept; 0: there is none.
std::uint64_t size_of(const record::Picture& picture);
// Encodes a picture of a note as JPEG, where it is none. Blocks, some ten milliseconds. nullptr, and what is wrong in `fault`: it failed.
GstSample* encode_jpeg(const record::Picture& picture, std::string& fault);

}  // namespace cerberus::plugin
