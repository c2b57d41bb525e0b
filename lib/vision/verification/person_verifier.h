// SPDX-License-Identifier: LGPL-2.1-or-later
// Persons that a detector confirmed, beside the tracks of motion: follows them between its looks, binds them to tracks,
// and replaces a track that holds several.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "vision/geometry/transform.h"
#include "vision/tracking/tracker.h"
#include "vision/verification/changed_places.h"
#include "vision/verification/look_schedule.h"
#include "vision/verification/person_detector.h"
#include "vision/verification/verification_parameters.h"

namespace cerberus::vision {

// A region of a frame as the verifier receives it.
struct Candidate {
  std::uint32_t id = 0;  // of the track; > 0
  Box box;               // frame pixels
  TrackState state = TrackState::seen;
  RegionKind kind = RegionKind::person_like;
};

// Gives regions without an identity (id 0), in the order of `now`, the one of the region of the frame before that they
// overlap most, by an intersection over union above 0.3, each once; else the next one after `last`, which counts on.
void keep_identities(std::span<const Candidate> before, std::span<Candidate> now, std::uint32_t& last);

// What stands for the candidates after the verification.
struct VerifiedRegion {
  int candidate =
      -1;  // index of the candidate whose other values hold; -1: a person without a track of its own
  std::uint32_t id = 0;  // identity to publish
  Box box;               // frame pixels
  bool person = false;
  double confidence = 0;  // of a person, 0 to 1
  RegionKind kind = RegionKind::person_like;
  double vx = 0, vy = 0;  // of a person, frame pixels a second relative to the scene
  double age = 0;         // of a person, s
};

class PersonVerifier {
 public:
  // A look that was taken: pass it back with what was found.
  struct Look {
    LookRegion region;
    std::uint64_t frame = 0;  // number
  };
  // First identity of persons without a track of their own; tracks count from 1.
  static constexpr std::uint32_t kFirstOwn = 1'000'001;

  void reset();
  // The next frame. picture: its luma, reduced (any size, the same in every frame of a stream); motion: frame k-1 to k
  // in pixels of the frame; seconds: since frame k-1, > 0.
  void update(GrayView picture, Size frame, const Transform& motion, double seconds,
              std::span<const Candidate> candidates);
  // Where the detector is to look in the present frame, the most doubtful first; nullopt: nowhere.
  std::optional<Look> choose();
  // Takes in what a look showed, up to kKept frames later: boxes in pixels of the frame, merged (merge_hits()), which
  // are carried on to the present frame. certain: the score that counts as certain; floor: the least there is.
  void apply(const Look& look, std::span<const PersonDetection> found, double floor, double certain);
  // What is published for the present frame: persons, and the candidates that they do not replace. Valid until the next
  // call.
  std::span<const VerifiedRegion> result();

 private:
  static constexpr std::size_t kKept = 32;  // pictures: a second at 30 frames a second

  struct Person {
    std::uint32_t id = 0, track = 0;  // track: id of the one that is bound; 0: none
    Box box;
    double vx = 0, vy = 0;  // reduced pixels a frame, camera motion taken out
    double evidence = 0, confidence = 0, age = 0, since_seen = 0, since_look = 0;
    double since_support = 0;   // s since the person lay on a track
    double wayx = 0, wayy = 0;  // frame pixels from where it was first seen, camera motion taken out
    bool moved = false;
    bool missed = false;  // by the last look at its place
    int candidate = -1;   // of this frame
    // Without a track of its own, and missed, it may have been drawn away from the person: it waits for a further look.
    bool is_shown() const { return candidate >= 0 || !missed; }
  };
  struct TrackRecord {
    std::uint32_t id = 0;
    double since_look = 1e9, since_seen = 0;
    int refuted = 0;
  };
  struct Past {
    Image<std::uint8_t> picture;
    Transform motion;  // from the picture before, reduced pixels
  };

  TrackRecord& record(std::uint32_t id);
  Past& past(std::uint64_t number) { return past_[number % kKept]; }
  void follow(Person& person, std::uint64_t to);
  Box carried(Box box, std::uint64_t from, double& vx, double& vy);
  bool is_part(const Box& box) const;
  double share_on_tracks(const Box& box) const;
  void bind();
  bool is_explained(const Candidate& candidate, bool& group) const;

  bool is_supported(const Box& box) const;
  Box reduced(const Box& box) const;
  void compare();

  VerificationParameters p_;
  ChangedPlaces changes_;
  std::vector<Box> hidden_;
  std::vector<Person> people_;
  std::vector<TrackRecord> records_;
  std::vector<Candidate> candidates_;
  std::vector<VerifiedRegion> result_;
  std::vector<char> taken_, hit_;  // of candidates, of people
  std::vector<LookTarget> targets_;
  std::vector<Past> past_ = std::vector<Past>(kKept);
  std::uint64_t number_ = 0;  // of the present frame, from 1
  std::uint32_t next_own_ = kFirstOwn;
  Size frame_;
  double seconds_ = 0;
};

}  // namespace cerberus::vision
