// SPDX-License-Identifier: LGPL-2.1-or-later
#include "shared/evidence_regions.hpp"

#include <algorithm>

#include "shared/clock_times.hpp"
#include "shared/region_conversion.hpp"
#include "vision/tracking/evidence/kept_identities.h"

namespace cerberus::plugin {
namespace {

// Columns of the reduced picture in which persons are followed. Chosen: as motiondetect's.
constexpr int kFollowedWidth = 320;

CerberusRegion region_of_person(const vision::EvidenceResult& found) {
  CerberusRegion region;
  cerberus_region_init(&region);
  region.vx = found.velocity.x, region.vy = found.velocity.y;
  region.age = clock_time(found.age);
  region.state = static_cast<CerberusRegionState>(found.state);
  return region;
}

}  // namespace

void EvidenceRegions::reset() {
  end_looks();
  tracker_.reset();
}

void EvidenceRegions::end_looks() {
  tracker_.drop_tracks();
  time_ = 0;
  look_ = 0;
  begun_before_.reset();
}

void EvidenceRegions::publish_alone(std::vector<CerberusRegion>& motion) {
  for (CerberusRegion& region : motion) region.id = tracker_.publish_alone(region.id);
  std::ranges::sort(motion, {}, &CerberusRegion::id);
}

// A result of another look than the one that is known to be in progress is of no use: the frame that was looked at was
// dropped on its way, or is of another scene.
std::optional<vision::EvidenceLook> EvidenceRegions::result(const PersonLooks& looks) {
  if (looks.of_this_frame)
    begun_ = time_;
  else if (looks.ends == 0 || looks.ends != look_)
    return std::nullopt;
  vision::EvidenceLook look{
      .bodies = looks.bodies, .of_this_frame = looks.of_this_frame, .encloses = looks.encloses};
  if (begun_before_) look.seconds = static_cast<double>(begun_ - *begun_before_) / GST_SECOND;
  begun_before_ = begun_;
  look_ = 0;
  return look;
}

std::vector<CerberusRegion>& EvidenceRegions::update(const EvidenceInput& frame,
                                                     std::span<const CerberusRegion> motion,
                                                     const PersonLooks& looks, bool persons_only) {
  if (frame.fresh) reset();
  time_ += clock_time(frame.seconds);
  if (frame.luma.data) {
    picture_.resize(vision::analysis_size({frame.luma.width, frame.luma.height}, kFollowedWidth));
    scaler_.scale(frame.luma, picture_.view());
  }
  regions_.clear();
  if (picture_.size().area() == 0) return regions_;
  std::swap(motion_, motion_before_);
  motion_.clear();
  for (const CerberusRegion& region : motion) {
    motion_.push_back(track_of(region));
    if (!region.tracked) motion_.back().id = 0;
  }
  vision::keep_identities(motion_before_, motion_, last_untracked_);

  vision::EvidenceFrame seen;
  seen.seconds = frame.seconds;
  seen.fresh = frame.fresh;
  seen.size = frame.size;
  seen.picture = picture_.view();
  seen.motion = frame.motion.transform;
  seen.still = frame.motion.still;
  seen.calm = frame.calm;
  seen.persons_only = persons_only;
  seen.counts = [&frame](const vision::Box& box) { return frame.zones.contain(box); };
  for (const vision::EvidenceResult& found : tracker_.update(seen, motion_, result(looks))) {
    CerberusRegion& region = regions_.emplace_back(
        found.motion >= 0 ? motion[static_cast<std::size_t>(found.motion)] : region_of_person(found));
    region.id = found.id, region.tracked = TRUE;
    region.x = found.box.x, region.y = found.box.y;
    region.width = found.box.width, region.height = found.box.height;
    region.person = found.person;
    region.motion = found.moves || found.motion >= 0;
    if (found.person) region.confidence = found.confidence;
    region.kind =
        found.person ? CERBERUS_REGION_KIND_PERSON_LIKE : static_cast<CerberusRegionKind>(found.kind);
  }
  if (looks.begins != 0) {
    tracker_.begin_look();
    look_ = looks.begins;
    begun_ = time_;
  }
  return regions_;
}

}  // namespace cerberus::plugin
