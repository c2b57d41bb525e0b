// SPDX-License-Identifier: LGPL-2.1-or-later
// The encoded streams of one pipeline, for the mounts of an RTSP server.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "rtsp_server/encoded_stream.h"

namespace cerberus::rtsp {

class PipelineStreams {
 public:
  // Takes over the appsinks of the pipeline itself (not those inside of its elements) whose names begin with `prefix`;
  // the rest of a name is the stream's. One called `metadata` accompanies all others. An element of the sink's name with
  // `-valve` is the valve before its encoder, which is closed while the stream has no client. Before the pipeline plays,
  // whose clock is the system's from now on. Returns what is wrong, or nothing.
  std::string collect(GstElement* pipeline, const std::string& prefix = {});

  // Without the metadata.
  const std::vector<std::shared_ptr<EncodedStream>>& streams() const { return streams_; }
  const std::shared_ptr<EncodedStream>& metadata() const { return metadata_; }  // or nullptr
  // Of the pipeline, which plays.
  GstClockTime base_time() const { return gst_element_get_base_time(pipeline_.get()); }

  // Whether every stream has begun, so that clients can be told what it is.
  bool has_begun() const { return missing().empty(); }
  // The streams that have not begun yet.
  std::string missing() const;
  // Ends the stream of every client.
  void end() const;
  // Until reopen() clients get nothing.
  void close() const;
  void reopen() const;

 private:
  template <typename Function>
  void for_each(Function function) const {
    for (const auto& stream : streams_) function(*stream);
    if (metadata_) function(*metadata_);
  }

  Ref<GstElement> pipeline_;
  std::vector<std::shared_ptr<EncodedStream>> streams_;
  std::shared_ptr<EncodedStream> metadata_;
};

}  // namespace cerberus::rtsp
