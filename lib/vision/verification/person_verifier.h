// SPDX-License-Identifier: LGPL-2.1-or-later
// Persons that a detector confirmed, beside the tracks of motion: follows them between its looks, binds them to tracks,
// and replaces a track that holds several.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "vision/geometry/transform.h"
#include "vision/tracking/appearance_model.h"
#include "vision/tracking/tracker.h"
#include "vision/verification/changed_places.h"
#include "vision/verification/followed_person.h"
#include "vision/verification/height_line.h"
#include "vision/verification/look_schedule.h"
#include "vision/persons/person_detector.h"
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
    LookRegions regions;
    std::uint64_t frame = 0;  // number
  };
  // First identity of persons without a track of their own; tracks count from 1.
  static constexpr std::uint32_t kFirstOwn = 1'000'001;

  void reset();
  // Time between two looks, s; .25 until it is set.
  void set_period(double seconds) { period_ = seconds; }
  // Shares of the detector's boxes above the head and below the feet: persons are followed with them, as their pictures
  // are compared, and published without. 0 until they are set.
  void set_margins(double above_head, double below_feet) {
    above_head_ = above_head, below_feet_ = below_feet;
  }
  // Whether the detector fits each region to its own input, as networks do: one region a look then, in which nobody is too
  // small. false until it is set.
  void set_fits_regions(bool fits) {
    most_regions_ = fits ? 1 : LookRegions::kMost, p_.fine = fits ? 0 : VerificationParameters{}.fine;
  }
  // The score down to which hits are of use: see VerificationParameters::weak.
  double least_score(double threshold) const { return p_.weak * threshold; }
  // The next frame. picture: its luma, reduced (any size, the same in every frame of a stream); motion: frame k-1 to k
  // in pixels of the frame; seconds: since frame k-1, > 0.
  void update(GrayView picture, Size frame, const Transform& motion, double seconds,
              std::span<const Candidate> candidates);
  // Where the detector is to look in the present frame, the most doubtful first; nullopt: nowhere.
  std::optional<Look> choose();
  // Takes in what a look showed, up to PictureHistory::kKept frames later: every hit down to least_score(threshold),
  // boxes in pixels of the frame. threshold: the score from which on a hit shows a person wherever it is; certain: the
  // score that counts as certain.
  void apply(const Look& look, std::span<const PersonDetection> hits, double threshold, double certain);
  // What is published for the present frame: persons, and the candidates that they do not replace. Valid until the next
  // call.
  std::span<const VerifiedRegion> result();

 private:
  struct Person : FollowedPerson {
    std::uint32_t id = 0, track = 0;  // track: id of the one that is bound; 0: none
    double evidence = 0, confidence = 0, age = 0, since_seen = 0, since_look = 0;
    double since_support = 0;    // s since something moved where the person is
    AppearanceModel appearance;  // at looks at which the person was alone
    int candidate = -1;          // of this frame
    // Looks in a row that showed the person where the bound track was then, and the boxes of that track by frame.
    int agreed = 0;
    std::array<Box, PictureHistory::kKept> track_boxes{};  // empty: none was bound
    bool missed = false;                                   // by the last look at its place
    bool weak = false;                                     // found first by a detection below the threshold
    bool published = false;                                // in some frame
    bool sure = false;  // a track has been there, the detector was certain, or the person walks; and not weak
    // Without a track of its own, and missed, it may have been drawn away from the person: it waits for a further look.
    // So does who was found once, weakly, or not certainly and where only the picture changed.
    bool is_shown() const {
      if (weak && looks() == 1) return false;
      return candidate >= 0 || (!missed && (sure || looks() > 1));
    }
  };
  // Somebody whom looks do not find any more, who may be hidden: carried on by the last velocity.
  struct Lost {
    std::uint32_t id = 0;
    Box box;
    Point velocity;
    double age = 0, since = 0;  // s
  };
  static constexpr std::size_t kMostLost = 32;

  struct Scores {  // of the detector
    double threshold = 0, certain = 0;
    double confidence(double score) const;
  };
  struct TrackRecord {
    std::uint32_t id = 0;
    double since_look = 1e9, since_seen = 0, age = 0;
    int refuted = 0;
  };
  TrackRecord& record(std::uint32_t id);
  // Takes those out who end, and keeps in mind whom looks had found repeatedly.
  template <typename Condition>
  void forget_if(Condition ends);
  void carry_lost(const Transform& motion);
  std::uint32_t lost_identity(Person& person);
  bool is_owned(std::uint32_t id) const;
  void take_persons(std::span<const PersonDetection> hits, double threshold);
  double height_in(const Candidate& candidate) const;
  bool is_part(const Box& box) const;
  bool is_part_of_another(const Box& box, std::size_t i, std::uint64_t frame) const;
  bool is_shown_by_look(std::size_t i) const;
  bool is_covered(std::size_t i, std::uint64_t frame) const;
  bool is_absorbed(std::size_t i) const;
  AppearanceModel appearance_at(const Box& box, std::uint64_t frame) const;
  bool is_alone(const Box& box, std::uint64_t frame, const Person* person) const;
  std::optional<double> likeness(const Person& person, const Box& box, std::uint64_t frame) const;
  void confirm_known(std::vector<PersonDetection>& found, std::uint64_t frame, const Scores& scores);
  void confirm(Person& person, const PersonDetection& found, std::uint64_t frame, const Scores& scores);
  void add(const PersonDetection& found, std::uint64_t frame, const Scores& scores);
  void miss(const Look& look, std::size_t known);
  double share_on_tracks(const Box& box) const;
  bool is_whole(const Candidate& c, const Person& person) const;
  void bind(Person& person, std::size_t candidate);
  void bind();
  bool is_explained(const Candidate& candidate, bool& group) const;
  bool is_supported(const Box& box) const;
  void compare();

  VerificationParameters p_;
  ChangedPlaces changes_;
  HeightLine line_;
  std::vector<PersonDetection> found_, weak_;
  std::vector<Box> boxes_;  // of all detections of the look
  std::vector<Box> hidden_;
  std::vector<Person> people_;
  std::vector<Lost> lost_;
  std::vector<TrackRecord> records_;
  std::vector<Candidate> candidates_;
  std::vector<VerifiedRegion> result_;
  std::vector<char> taken_, hit_;  // of candidates, of people
  std::vector<LookTarget> targets_;
  PictureHistory pictures_;
  BrightnessLevel level_;  // of the reduced pictures
  std::size_t most_regions_ = LookRegions::kMost;
  std::uint32_t next_own_ = kFirstOwn;
  double seconds_ = 0, period_ = 0.25, above_head_ = 0, below_feet_ = 0;
};

template <typename Condition>
void PersonVerifier::forget_if(Condition ends) {
  for (const Person& person : people_)
    if (ends(person) && person.id != 0 && person.looks() > 1 && lost_.size() < kMostLost)
      lost_.push_back({person.id, person.box(), person.velocity(), person.age, 0});
  std::erase_if(people_, ends);
}

}  // namespace cerberus::vision
