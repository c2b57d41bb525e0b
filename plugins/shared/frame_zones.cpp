// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frame_zones.hpp"

#include <cerberus/cerberus.h>

#include <cmath>

#include "camera_mount.hpp"
#include "shared_meta.hpp"

namespace cerberus::plugin {
namespace {

struct ZonesKind {
  using Value = FrameZones;
  static constexpr char kApi[] = "CerberusFrameZonesMetaAPI", kName[] = "CerberusFrameZonesMeta";

  static void rescale(FrameZones&, const Rescaling&) {}  // shares of the picture
};

}  // namespace

void set_frame_zones(GstBuffer* buffer, const FrameZones& zones) {
  if (zones.zones)
    PictureMeta<ZonesKind>::set(buffer, zones);
  else
    PictureMeta<ZonesKind>::remove(buffer);
}

ZonesOfFrame::ZonesOfFrame(GstBuffer* buffer, GstClockTime running_time, vision::Size size) : size_(size) {
  const FrameZones* found = PictureMeta<ZonesKind>::find(buffer);
  if (!found) return;
  zones_ = found->zones;
  const CerberusPose* pose = cerberus_buffer_peek_pose(buffer);
  const auto look = pose && zones_->need_orientation() ? look_of(*pose, running_time) : std::nullopt;
  if (!look) return;
  const double zoomed = field_of_view_of(*pose);
  if (std::isnan(zoomed)) return;
  camera_ = {vision::Lens(zoomed > 0 ? zoomed : found->field_of_view, size), look->pan, look->tilt};
}

bool ZonesOfFrame::contain(const vision::Box& box) const {
  return !zones_ || zones_->contain({box.x + box.width / 2, box.y + box.height / 2}, size_, camera_);
}

}  // namespace cerberus::plugin
