// SPDX-License-Identifier: LGPL-2.1-or-later
// The private record of a frame, for tests: what is on a buffer, and records made by hand.
#pragma once

#include <gst/video/video.h>

#include <functional>
#include <utility>

#include "../../plugins/shared/record.hpp"

namespace records {

namespace vision = cerberus::vision;
using cerberus::plugin::kRecordForReaders;
using cerberus::plugin::kRecordForTracks;
using cerberus::plugin::record_of;
using cerberus::plugin::set_record;
using cerberus::plugin::threshold_facts_of;

inline vision::GrayView view(const vision::GrayPicture& picture) {
  return picture ? vision::GrayView(picture->view()) : vision::GrayView{};
}
// The moving area on a buffer; empty: there is none.
inline vision::GrayView mask_of(GstBuffer* buffer) {
  const vision::Record record = record_of(buffer);
  return record ? record->mask() : vision::GrayView{};
}
inline bool has_previous(GstBuffer* buffer) {
  const vision::Record record = record_of(buffer);
  return record && record->differences && record->differences->previous;
}

// The record on `buffer`, or a new one of a frame of this size that is put there.
inline vision::Record on(GstBuffer* buffer, vision::Size frame) {
  static cerberus::threads::Pool<vision::Analysis> pool;
  if (vision::Record record = record_of(buffer)) return record;
  vision::Record record = pool.take();
  record->frame = frame;
  set_record(buffer, record);
  return record;
}
template <typename T>
cerberus::threads::Shared<vision::Image<T>> picture(vision::Size size,
                                                    const std::function<int(int, int)>& value) {
  static cerberus::threads::Pool<vision::Image<T>> pool;
  auto made = pool.take();
  made->resize(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) made->view().at(x, y) = static_cast<T>(value(x, y));
  return made;
}

// An element downstream of a sink pad that wants records for readers.
inline void want_record(GstPad* sinkpad) {
  gst_pad_add_probe(
      sinkpad, GST_PAD_PROBE_TYPE_QUERY_DOWNSTREAM,
      [](GstPad*, GstPadProbeInfo* info, gpointer) {
        GstQuery* query = GST_PAD_PROBE_INFO_QUERY(info);
        if (cerberus::plugin::is_record_query(query)) cerberus::plugin::add_wanted(query, kRecordForReaders);
        return GST_PAD_PROBE_OK;
      },
      nullptr, nullptr);
}

}  // namespace records
