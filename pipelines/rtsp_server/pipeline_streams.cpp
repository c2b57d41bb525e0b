// SPDX-License-Identifier: LGPL-2.1-or-later
#include "rtsp_server/pipeline_streams.h"

#include <algorithm>
#include <cctype>

namespace cerberus::rtsp {
namespace {

constexpr char kMetadata[] = "metadata";

// The mount's name is part of an address.
bool fits_address(const std::string& name) {
  return std::all_of(name.begin(), name.end(),
                     [](unsigned char c) { return std::isalnum(c) || c == '-' || c == '_'; });
}

}  // namespace

std::string PipelineStreams::collect(GstElement* pipeline, const std::string& prefix) {
  pipeline_.reset(GST_ELEMENT(gst_object_ref(pipeline)));
  // One clock for all, so that what the server sends has the stamps of the pipeline.
  g_autoptr(GstClock) clock = gst_system_clock_obtain();
  gst_pipeline_use_clock(GST_PIPELINE(pipeline), clock);
  std::string wrong;
  GstBin* bin = GST_BIN(pipeline);
  for (GList* child = g_list_last(bin->children); child; child = child->prev) {
    const std::string sink = GST_OBJECT_NAME(child->data);
    if (!GST_IS_APP_SINK(child->data) || !sink.starts_with(prefix)) continue;
    g_autoptr(GstElement) valve = gst_bin_get_by_name(bin, (sink + "-valve").c_str());
    const std::string name = sink.substr(prefix.size());
    auto stream = EncodedStream::make(GST_APP_SINK(child->data), valve, name);
    if (name == kMetadata)
      metadata_ = stream;
    else if (fits_address(name))
      streams_.push_back(stream);
    else
      wrong = "the appsink \"" + name +
              "\" cannot be a mount: name it by letters, digits, - and _ (appsink name=annotated)";
  }
  if (wrong.empty() && streams_.empty())
    wrong = "the line has no appsink: what follows an encoder is served by `appsink name=annotated`";
  return wrong;
}

std::string PipelineStreams::missing() const {
  std::string names;
  for_each([&names](const EncodedStream& stream) {
    g_autoptr(GstCaps) caps = stream.caps();
    if (!caps) names += (names.empty() ? "" : ", ") + stream.name();
  });
  return names;
}

void PipelineStreams::end() const {
  for_each([](EncodedStream& stream) { stream.end(); });
}

void PipelineStreams::close() const {
  for_each([](EncodedStream& stream) { stream.close(); });
}

void PipelineStreams::reopen() const {
  for_each([](EncodedStream& stream) { stream.reopen(); });
}

}  // namespace cerberus::rtsp
