// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frame_zones.hpp"

#include <cerberus/cerberus.h>
#include <gst/video/video.h>

#include <cmath>
#include <new>

#include "camera_mount.hpp"
#include "shared_meta.hpp"

namespace cerberus::plugin {
namespace {

struct ZonesMeta {
  GstMeta meta;
  Crop crop;  // of the buffer when they were attached
  FrameZones zones;
};

ZonesMeta& zones_in(GstMeta* meta) {
  return *reinterpret_cast<ZonesMeta*>(meta);
}

const GstMetaInfo* zones_info() {
  static const GstMetaInfo* const info = register_shared_meta<ZonesMeta>(
      "CerberusFrameZonesMetaAPI", "CerberusFrameZonesMeta",
      [](GstMeta* meta, gpointer, GstBuffer*) -> gboolean {
        ::new (&zones_in(meta).zones) FrameZones();
        return TRUE;
      },
      [](GstMeta* meta, GstBuffer*) { zones_in(meta).zones.~FrameZones(); },
      [](GstBuffer* to, GstMeta* meta, GstBuffer*, GQuark type, gpointer data) -> gboolean {
        if (!rescaling(type, data)) return FALSE;
        set_frame_zones(to, zones_in(meta).zones);
        return TRUE;
      },
      GST_META_TAG_VIDEO_STR, GST_META_TAG_VIDEO_SIZE_STR);
  return info;
}

}  // namespace

void set_frame_zones(GstBuffer* buffer, const FrameZones& zones) {
  if (GstMeta* old = gst_buffer_get_meta(buffer, zones_info()->api)) gst_buffer_remove_meta(buffer, old);
  if (!zones.zones) return;
  GstMeta* meta = gst_buffer_add_meta(buffer, zones_info(), nullptr);
  if (!meta) return;
  zones_in(meta).crop = crop_of(buffer);
  zones_in(meta).zones = zones;
}

ZonesOfFrame::ZonesOfFrame(GstBuffer* buffer, GstClockTime running_time, vision::Size size) : size_(size) {
  GstMeta* meta = gst_buffer_get_meta(buffer, zones_info()->api);
  if (!meta || zones_in(meta).crop != crop_of(buffer)) return;
  const FrameZones& found = zones_in(meta).zones;
  zones_ = found.zones;
  const CerberusPose* pose = cerberus_buffer_peek_pose(buffer);
  const auto look = pose && zones_->need_orientation() ? look_of(*pose, running_time) : std::nullopt;
  if (!look) return;
  const double zoomed = field_of_view_of(*pose);
  const vision::Lens lens(zoomed > 0 ? zoomed : found.field_of_view, size);
  if (lens.known() && !std::isnan(zoomed)) camera_ = {lens, look->pan, look->tilt};
}

bool ZonesOfFrame::contain(const vision::Box& box) const {
  if (!zones_) return true;
  const vision::Point middle{box.x + box.width / 2, box.y + box.height / 2};
  std::optional<vision::Direction> direction;
  if (camera_) direction = camera_->direction(middle);
  return zones_->contain({middle.x / size_.width, middle.y / size_.height}, direction);
}

}  // namespace cerberus::plugin
