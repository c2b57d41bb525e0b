// SPDX-License-Identifier: LGPL-2.1-or-later
// One tracker for two witnesses: tracks of what moves, and the bodies that a people detector finds a few times a second.
//
// Each track has one sum of evidence, a sequential test (A. Wald, "Sequential analysis", 1947) to which every witness
// adds its share; it is published once the sum suffices and ends when nothing is left of it. While the scene is calm and
// a motion track fits, the track is where that is; otherwise it follows the picture from look to look. A look's result
// is late: it meets the box of its own frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "vision/persons/person_detector.h"
#include "vision/tracking/assignment.h"
#include "vision/tracking/evidence/evidence_track.h"
#include "vision/tracking/tracker.h"

namespace cerberus::vision {

struct EvidenceFrame {
  double seconds = 0;         // since the previous frame
  bool fresh = false;         // it begins a scene
  Size size;                  // pixels
  GrayView picture;           // of the frame, reduced: of one size in a scene; copied
  Transform motion;           // of the camera since the previous frame, frame pixels
  bool still = false;         // the camera stands
  double calm = 1;            // SceneCalm::share()
  bool persons_only = false;  // tracks that no look has shown are not published
  // Whether a track at this box (frame pixels) is published that motion does not show; empty: everywhere. Called by update() only.
  std::function<bool(const Box&)> counts;
};

// What a look at an earlier frame has shown: one box for each body (hits_to_bodies()), frame pixels. A score of .5 is the least of a
// person whom no track has; 1 is a person beyond doubt, 0 and less is most likely none.
struct EvidenceLook {
  std::span<const PersonDetection> bodies;
  double seconds = 0.25;       // since the look before
  bool of_this_frame = false;  // it has begun at the frame that it is passed with
  // Boxes enclose the body whatever its pose, as a network's do; a window's have one shape for all.
  bool encloses = false;
};

struct EvidenceResult {
  std::uint32_t id = 0;
  Box box;                // frame pixels, inside the frame
  Point velocity;         // frame pixels a second relative to the scene
  double age = 0;         // s
  double confidence = 0;  // that it is a person: the evidence of looks, 0..1
  bool person = false;    // looks have shown it, and go on doing so
  bool moves = false;     // motion has shown it within the last second
  int motion = -1;        // index of the motion track whose place it has
  RegionKind kind = RegionKind::person_like;
  TrackState state = TrackState::seen;
};

class EvidenceTracker {
 public:
  EvidenceTracker() = default;
  explicit EvidenceTracker(const EvidenceParameters& parameters) : p_(parameters) {}

  void reset();
  // The same, but motion tracks that have been published keep their identities, and stay published.
  void drop_tracks();
  // The last frame of update() is looked at: the next look that is passed shows it.
  void begin_look();
  // The identity of a motion track that is published without update().
  std::uint32_t publish_alone(std::uint32_t motion_id);
  // motion: tracks of what moves in this frame, published or not. Returns the tracks to be published, by identity; the
  // span lives until the next call. Identities count from 1 in the order of publication, and none is given twice.
  std::span<const EvidenceResult> update(const EvidenceFrame& frame, std::span<const Track> motion,
                                         const std::optional<EvidenceLook>& look = {});
  std::size_t bytes() const;

 private:
  struct Known {                          // of a motion track
    std::uint32_t motion_id = 0, id = 0;  // id 0: not published yet
    bool person = false, published = false;
    double person_evidence = 0, least_seen = EvidenceTrack::kNever;
  };
  Known& know(std::uint32_t motion_id);
  double shown_time() const;
  bool camera_stands() const { return camera_stood_ >= p_.moving_time; }
  Box reduced(const Box& box) const;
  bool should_be_seen(const EvidenceTrack& track) const;
  bool inside_moves(const Box& box, bool calm) const;
  bool is_piece(const EvidenceTrack& track, const Box& body) const;
  bool gives_way(const EvidenceTrack& track, const Box& body) const;
  void take_look(const EvidenceLook& look);
  template <typename Overlap, typename Use>
  void pair_by_overlap(const Overlap& overlap_of, const Use& use);
  void match_look(bool sure);
  void begin_at(const PersonDetection& body);
  void take_motion(std::span<const Track> motion);
  void mirror(EvidenceTrack& track, const Track& motion) const;
  void match_motion(std::span<const Track> motion);
  void begin_mirror(const Track& motion);
  void judge_look(const EvidenceLook& look);
  void end_tracks();
  void remember_motion();
  Box in_frame(const Box& reduced) const;
  bool counts(const EvidenceTrack& track) const;
  double area_of_persons_in(const Box& box) const;
  void publish(std::span<const Track> motion);

  EvidenceParameters p_;
  std::vector<EvidenceTrack> tracks_;
  std::vector<Known> known_;  // those that were asked for last are at the end
  std::vector<EvidenceResult> results_;
  std::vector<PersonDetection> bodies_;  // of the look, reduced pixels
  std::vector<double> cost_;
  std::vector<std::size_t> rows_, columns_;
  std::vector<char> used_;  // of the bodies, or of the motion tracks: they have a track
  Assignment assignment_;
  EvidenceFrame frame_;
  Image<std::uint8_t> pictures_[2], looked_;
  Pyramid pyramids_[2], looked_pyramid_;
  int present_ = 0;
  std::uint64_t number_ = 0, look_number_ = 0;
  Transform motion_, since_look_;  // reduced pixels
  double last_seconds_ = 0;        // from the last look but one to the last
  double period_ =
      0;  // s from look to look: of the last two the longer, as one may have come between two others
  bool looks_enclose_ = false;  // EvidenceLook::encloses of the last one
  double camera_stood_ = 0;     // s
  std::uint32_t last_id_ = 0;   // that has been given
};

}  // namespace cerberus::vision
