// SPDX-License-Identifier: LGPL-2.1-or-later
// Tracks by two witnesses, as regions: feeds vision::EvidenceTracker with the frames of a stream, the regions of what
// moves and the looks of a person detector.
#pragma once

#include <cerberus/cerberus.h>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "shared/frame_zones.hpp"
#include "shared/person_looks.hpp"
#include "vision/detector.h"
#include "vision/tracking/evidence/evidence_tracker.h"

namespace cerberus::plugin {

struct EvidenceInput {
  vision::Size size;  // of the frame
  vision::LumaSource
      luma;  // its picture, of the frame's or a smaller size; without data: that of the frame before
  double seconds = 0;         // since the previous frame
  bool fresh = false;         // it begins a scene
  vision::CameraStep motion;  // since the previous frame
  double calm = 1;            // vision::SceneCalm::share()
  ZonesOfFrame zones;         // where tracks count that motion does not show
};

class EvidenceRegions {
 public:
  void reset();
  // motion: regions of what moves; those that are no tracks get identities that they keep from frame to frame. Returns the
  // regions to be published, by identity; they live until the next call. persons_only: those that a look has shown.
  std::vector<CerberusRegion>& update(const EvidenceInput& frame, std::span<const CerberusRegion> motion,
                                      const PersonLooks& looks, bool persons_only);

  // As they are published without update(): they get their identities, and are sorted by them.
  void publish_alone(std::vector<CerberusRegion>& motion);
  // The detector looks on no more: as reset(), but what is published alone keeps its identities.
  void end_looks();

 private:
  std::optional<vision::EvidenceLook> result(const PersonLooks& looks);

  vision::EvidenceTracker tracker_;
  vision::LumaScaler scaler_;
  vision::Image<std::uint8_t> picture_;
  std::vector<vision::Track> motion_, motion_before_;  // of this frame, and of the one before
  std::uint32_t last_untracked_ = 0;                   // identities given to regions without one so far
  std::vector<CerberusRegion> regions_;
  GstClockTime time_ = 0;                     // since the reset
  guint look_ = 0;                            // in progress; 0: none
  GstClockTime begun_ = 0;                    // when it began
  std::optional<GstClockTime> begun_before_;  // when the last one with a result did
};

}  // namespace cerberus::plugin
