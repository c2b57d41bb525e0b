// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/tracking/evidence/evidence_tracker.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "vision/tracking/evidence/picture_follower.h"

namespace cerberus::vision {

namespace {

constexpr int kLevels = 3;                // of the pyramids
constexpr std::size_t kMostKnown = 1024;  // motion tracks that are remembered: more than there are at a time

double visible_share(const Box& box, Size picture) {
  return share_within(box, {0, 0, double(picture.width), double(picture.height)});
}

// Whether the level differs by more than `most` from every pixel around (x, y): registration is good to a pixel.
bool differs_around(GrayView picture, int x, int y, int level, int most) {
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i)
      if (std::abs(picture.at(x + i, y + j) - level) <= most) return false;
  return true;
}

Box scaled(const Box& box, double across, double down) {
  return {box.x * across, box.y * down, box.width * across, box.height * down};
}

}  // namespace

void EvidenceTracker::reset() {
  drop_tracks();
  known_.clear();
}

void EvidenceTracker::drop_tracks() {
  tracks_.clear(), results_.clear();
  number_ = look_number_ = 0;
  period_ = last_seconds_ = 0;
  looks_enclose_ = false;
  camera_stood_ = p_.moving_time;
}

Box EvidenceTracker::reduced(const Box& box) const {
  return scaled(box, static_cast<double>(frame_.picture.width) / frame_.size.width,
                static_cast<double>(frame_.picture.height) / frame_.size.height);
}

// s without an observation for which a track is published.
double EvidenceTracker::shown_time() const {
  return std::max(p_.shown, p_.looks_shown * period_);
}

EvidenceTracker::Known& EvidenceTracker::know(std::uint32_t motion_id) {
  const auto found = std::ranges::find(known_, motion_id, &Known::motion_id);
  if (found != known_.end()) {
    std::rotate(found, found + 1, known_.end());
  } else {
    if (known_.size() == kMostKnown) known_.erase(known_.begin());
    known_.push_back({motion_id});
  }
  return known_.back();
}

std::uint32_t EvidenceTracker::publish_alone(std::uint32_t motion_id) {
  Known& known = know(motion_id);
  known.published = true;
  if (known.id == 0) known.id = ++last_id_;
  return known.id;
}

void EvidenceTracker::begin_look() {
  Image<std::uint8_t>& present = pictures_[present_];
  looked_.resize(present.size());
  std::memcpy(looked_.view().data, present.view().data, present.bytes());
  looked_pyramid_.borrow(looked_.view(), kLevels);
  look_number_ = number_;
  since_look_ = {};
  for (EvidenceTrack& t : tracks_) t.begin_look();
}

// Whether more of the box has changed since the last frame than the camera's motion explains.
bool EvidenceTracker::inside_moves(const Box& box, bool calm) const {
  if (number_ < 2) return false;
  const GrayView now = pictures_[present_].view(), before = pictures_[1 - present_].view();
  const auto column = [&](double x) { return std::clamp(static_cast<int>(std::lround(x)), 0, now.width); };
  const auto row = [&](double y) { return std::clamp(static_cast<int>(std::lround(y)), 0, now.height); };
  const int left = column(box.x), right = column(box.right());
  const int from = column(box.x - box.width / 2), to = column(box.right() + box.width / 2);
  const Transform back = motion_.inverse();
  int inside = 0, changed_inside = 0, around = 0, changed_around = 0;
  for (int y = row(box.y); y < row(box.bottom()); ++y)
    for (int x = from; x < to; ++x) {
      const Point was = back.apply({double(x), double(y)});
      const int u = static_cast<int>(std::lround(was.x)), v = static_cast<int>(std::lround(was.y));
      if (u < 1 || v < 1 || u >= before.width - 1 || v >= before.height - 1) continue;
      const bool changed = differs_around(before, u, v, now.at(x, y), p_.changed);
      if (x >= left && x < right)
        ++inside, changed_inside += changed;
      else
        ++around, changed_around += changed;
    }
  if (inside == 0) return false;
  const double share = static_cast<double>(changed_inside) / inside;
  const double other = around > 0 ? static_cast<double>(changed_around) / around : 0;
  return share > p_.inside && (calm || share > other);
}

// Pairs the tracks rows_ with the boxes columns_ so that the overlaps are largest in all; each pair reaches the gate.
// overlap_of: of a row's element and a column's. use: called with these two and their overlap.
template <typename Overlap, typename Use>
void EvidenceTracker::pair_by_overlap(const Overlap& overlap_of, const Use& use) {
  if (rows_.empty() || columns_.empty()) return;
  cost_.assign(rows_.size() * columns_.size(), Assignment::kForbidden);
  for (std::size_t i = 0; i < rows_.size(); ++i)
    for (std::size_t j = 0; j < columns_.size(); ++j) {
      const double overlap = overlap_of(rows_[i], columns_[j]);
      if (overlap >= p_.gate) cost_[i * columns_.size() + j] = 1 - overlap;
    }
  const auto pairs =
      assignment_.solve(cost_, static_cast<int>(rows_.size()), static_cast<int>(columns_.size()));
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    if (pairs[i] < 0) continue;
    const auto j = static_cast<std::size_t>(pairs[i]);
    const double cost = cost_[i * columns_.size() + j];
    if (cost < Assignment::kForbidden) use(rows_[i], columns_[j], 1 - cost);
  }
}

// Whether the track has the place of a motion track that shows a small part of this body only, as parallax leaves of a person
// ahead of a camera that moves, and as is left of one who comes straight at a camera.
bool EvidenceTracker::is_piece(const EvidenceTrack& t, const Box& body) const {
  return !looks_enclose_ && t.mirrors && share_within(t.looked(), body) >= p_.body.nested &&
         t.looked().area() < p_.leave * body.area();
}

bool EvidenceTracker::gives_way(const EvidenceTrack& t, const Box& body) const {
  return is_piece(t, body) && (!camera_stands() || t.piece_looks >= p_.piece_looks);
}

void EvidenceTracker::match_look(bool sure) {
  rows_.clear(), columns_.clear();
  for (std::size_t i = 0; i < tracks_.size(); ++i)
    if (!tracks_[i].hit && !tracks_[i].holds_several && tracks_[i].looked().area() > 0) rows_.push_back(i);
  for (std::size_t j = 0; j < bodies_.size(); ++j)
    if ((bodies_[j].score >= p_.sure) == sure && bodies_[j].score > p_.least) columns_.push_back(j);
  const auto overlap_of = [&](std::size_t i, std::size_t j) {
    const double overlap = intersection_over_union(tracks_[i].looked(), bodies_[j].box);
    return sure && gives_way(tracks_[i], bodies_[j].box) ? std::max(overlap, p_.gate) : overlap;
  };
  pair_by_overlap(overlap_of, [&](std::size_t i, std::size_t j, double overlap) {
    EvidenceTrack& t = tracks_[i];
    const PersonDetection& body = bodies_[j];
    const bool differs = looks_enclose_ && t.mirrors && !camera_stands() && overlap < p_.leave;
    if (sure && (differs || gives_way(t, body.box))) {
      t.mirrors = false;
      t.distrust();
    }
    if (!t.mirrors) t.correct(body.box, p_);
    t.add(std::max(body.score - (t.moved ? p_.neutral : p_.unmoved), p_.least), p_);
    t.quality += p_.quality_gain * (body.score - t.quality);
    t.add_person(sure ? body.score : -p_.missed_person, p_);
    t.person = t.person || sure;
    if (sure) t.least_seen = std::min(t.least_seen, t.looked().height);
    t.hit = true;
    t.unseen = 0;
    if (sure) t.since_look = 0;
    used_[j] = 1;
  });
}

// A track begins in the frame that was looked at, and follows the picture to the present one.
void EvidenceTracker::begin_at(const PersonDetection& body) {
  Box box = body.box;
  if (look_number_ < number_) {
    const Point then{box.x + box.width / 2, box.y + box.height / 2}, rest = since_look_.apply(then);
    Point shift{rest.x - then.x, rest.y - then.y};
    double growth = 1;
    if (const auto step = follow_box(looked_pyramid_, pyramids_[present_], box, shift))
      shift = step->shift, growth = step->growth;
    box = {box.x + shift.x - (growth - 1) * box.width / 2, box.y + shift.y - (growth - 1) * box.height / 2,
           growth * box.width, growth * box.height};
  }
  const auto covers = [&](const EvidenceTrack& t) {
    return !t.holds_several && is_one_body(box, t.box(), p_.body);
  };
  if (std::ranges::any_of(tracks_, covers)) return;
  EvidenceTrack t = EvidenceTrack::begin(box);
  t.person = t.hit = true;
  t.evidence = std::clamp(body.score - p_.unmoved, 0.0, p_.ceiling);
  t.add_person(body.score, p_);
  t.least_seen = t.height;
  t.quality = p_.quality_gain * body.score;
  tracks_.push_back(t);
}

void EvidenceTracker::take_look(const EvidenceLook& look) {
  looks_enclose_ = look.encloses;
  bodies_.clear();
  for (const PersonDetection& body : look.bodies) bodies_.push_back({reduced(body.box), body.score});
  for (EvidenceTrack& t : tracks_) {
    if (!t.mirrors || t.looked().area() <= 0) continue;
    const auto inside = std::ranges::count_if(bodies_, [&](const PersonDetection& body) {
      return body.score >= p_.sure && share_within(body.box, t.looked()) >= p_.body.nested;
    });
    t.holds_several = t.kind == RegionKind::group || inside > 1;
    const bool piece = std::ranges::any_of(
        bodies_, [&](const PersonDetection& body) { return body.score >= p_.sure && is_piece(t, body.box); });
    t.piece_looks = piece ? t.piece_looks + 1 : 0;
  }
  used_.assign(bodies_.size(), 0);
  match_look(true);
  for (std::size_t j = 0; j < bodies_.size(); ++j)
    if (bodies_[j].score >= p_.sure && !used_[j]) begin_at(bodies_[j]);
  match_look(false);
}

void EvidenceTracker::mirror(EvidenceTrack& t, const Track& motion) const {
  t.set_box(reduced(motion.box));
  t.mirrors = true;
  t.kind = motion.kind;
  t.holds_several = t.holds_several || t.kind == RegionKind::group;
  if (motion.state != TrackState::seen) {
    t.moving = 0;
    return;
  }
  t.since_motion = t.unseen = 0;
  if (t.published) return;  // it decides nothing else
  t.moving = inside_moves(t.box(), false) ? t.moving + frame_.seconds : 0;
}

void EvidenceTracker::match_motion(std::span<const Track> motion) {
  rows_.clear(), columns_.clear();
  for (std::size_t i = 0; i < tracks_.size(); ++i)
    if (!tracks_[i].mirrors) rows_.push_back(i);
  for (std::size_t j = 0; j < motion.size(); ++j)
    if (!used_[j] && motion[j].state == TrackState::seen && motion[j].kind != RegionKind::group)
      columns_.push_back(j);
  const auto overlap_of = [&](std::size_t i, std::size_t j) {
    return intersection_over_union(tracks_[i].box(), reduced(motion[j].box));
  };
  const bool stands = !looks_enclose_ && camera_stands();
  pair_by_overlap(overlap_of, [&](std::size_t i, std::size_t j, double overlap) {
    EvidenceTrack& t = tracks_[i];
    t.motion_id = motion[j].id;
    t.evidence = p_.ceiling;
    t.since_motion = t.unseen = 0;
    used_[j] = 1;
    if (overlap >= (stands ? p_.leave : p_.adopt)) mirror(t, motion[j]);
  });
}

void EvidenceTracker::begin_mirror(const Track& motion) {
  const Box box = reduced(motion.box);
  const auto covers = [&](const EvidenceTrack& t) { return is_one_body(box, t.box(), {.nested = p_.gate}); };
  if (std::ranges::any_of(tracks_, covers)) return;
  EvidenceTrack t = EvidenceTrack::begin(box);
  t.evidence = p_.publish;
  t.motion_id = motion.id;
  const Known& known = know(motion.id);
  if (known.id == 0 || std::ranges::find(tracks_, known.id, &EvidenceTrack::id) == tracks_.end())
    t.id = known.id, t.person = known.person, t.published = known.published,
    t.person_evidence = known.person_evidence, t.least_seen = known.least_seen;
  mirror(t, motion);
  tracks_.push_back(t);
}

void EvidenceTracker::take_motion(std::span<const Track> motion) {
  used_.assign(motion.size(), 0);
  std::erase_if(tracks_, [&](EvidenceTrack& t) {
    if (!t.mirrors) return false;
    const auto found = std::ranges::find(motion, t.motion_id, &Track::id);
    if (found == motion.end()) {
      // A person whom looks have shown since motion did stands there, and goes on by the picture. Without `since` that costs a
      // point of MOTA: who has left is shown for too long.
      t.mirrors = false;
      const bool stands = t.since_look < t.since_motion && t.since_look <= shown_time();
      t.person = t.person || stands;
      return !stands || t.holds_several;
    }
    mirror(t, *found);
    if (found->state == TrackState::seen) t.evidence = p_.ceiling;
    used_[static_cast<std::size_t>(found - motion.begin())] = 1;
    return false;
  });
  match_motion(motion);
  for (std::size_t j = 0; j < motion.size(); ++j)
    if (!used_[j]) begin_mirror(motion[j]);
}

// Whether a look must have shown the track if it is a person: looks have shown it smaller, and the frame does not cut it.
bool EvidenceTracker::should_be_seen(const EvidenceTrack& t) const {
  const Box& box = t.looked();
  const Size picture = frame_.picture.size();
  return box.height >= t.least_seen && !t.holds_several && box.x >= 1 && box.y >= 1 &&
         box.right() <= picture.width - 1 && box.bottom() <= picture.height - 1;
}

// What the look says of tracks that it does not show, and what their own motion says.
void EvidenceTracker::judge_look(const EvidenceLook& look) {
  const bool calm = frame_.calm >= p_.calm;
  period_ = std::max(look.seconds, last_seconds_);
  last_seconds_ = look.seconds;
  for (EvidenceTrack& t : tracks_) {
    const bool moving = inside_moves(t.box(), calm);
    t.moved = t.moved || moving;
    if (!t.hit) {
      const bool moves = t.since_motion <= look.seconds;
      if (!moves && t.looked().area() > 0) t.evidence -= p_.against;
      if (should_be_seen(t)) t.add_person(-p_.missed_person, p_);
      t.quality += p_.quality_gain * ((moves ? 1.0 : 0.0) - t.quality);
    }
    if (t.mirrors) {
      t.person = t.person && t.person_evidence > 0;
      t.evidence = std::max(t.evidence, 0.0);
      continue;
    }
    if (moving)
      t.add(p_.moving * std::min(look.seconds, 1.0), p_);
    else if (calm && !t.travels(p_.travel))
      t.evidence -= p_.against;
  }
}

void EvidenceTracker::end_tracks() {
  const Size picture = frame_.picture.size();
  for (EvidenceTrack& t : tracks_) {
    t.travelled = t.travelled || t.travels(p_.travel);
    t.moved = t.moved || t.travelled;
    const bool alone = t.mirrors && t.travelled && (camera_stands() || t.moving >= p_.moving_time);
    // Windows are mistaken at one place of a still picture again and again; a person there moves at some time.
    const bool person = t.shown() && (t.mirrors || t.moved || looks_enclose_ || !camera_stands());
    if (t.evidence >= p_.publish && (person || alone)) t.published = true;
  }
  std::erase_if(tracks_, [&](const EvidenceTrack& t) {
    return (t.evidence < 0 && !t.mirrors) || t.height <= p_.least_height ||
           visible_share(t.box(), picture) <= p_.least_visible;
  });
  std::ranges::sort(tracks_, [&](const EvidenceTrack& a, const EvidenceTrack& b) {
    if (a.published != b.published) return a.published;
    return a.quality != b.quality ? a.quality > b.quality : a.age > b.age;
  });
  std::size_t kept = 0;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const auto same = [&](const EvidenceTrack& other) {
      if ((tracks_[i].mirrors && other.mirrors) || tracks_[i].holds_several || other.holds_several)
        return false;
      return is_one_body(tracks_[i].box(), other.box(), p_.body);
    };
    if (std::any_of(tracks_.begin(), tracks_.begin() + static_cast<std::ptrdiff_t>(kept), same)) continue;
    if (kept != i) tracks_[kept] = tracks_[i];
    ++kept;
  }
  tracks_.resize(kept);
}

void EvidenceTracker::remember_motion() {
  for (EvidenceTrack& t : tracks_) {
    t.keep(p_);
    if (t.motion_id == 0 || t.since_motion > 0) continue;
    Known& known = know(t.motion_id);
    known.id = t.id, known.person = t.person, known.published = t.published;
    known.person_evidence = t.person_evidence, known.least_seen = t.least_seen;
  }
}

Box EvidenceTracker::in_frame(const Box& reduced) const {
  return inside(scaled(reduced, static_cast<double>(frame_.size.width) / frame_.picture.width,
                       static_cast<double>(frame_.size.height) / frame_.picture.height),
                frame_.size);
}

bool EvidenceTracker::counts(const EvidenceTrack& t) const {
  return t.published && (t.mirrors || !frame_.counts || frame_.counts(in_frame(t.box())));
}

// Published persons, one each, that lie in the box.
double EvidenceTracker::area_of_persons_in(const Box& box) const {
  double area = 0;
  for (const EvidenceTrack& t : tracks_)
    if (counts(t) && t.shown() && !t.holds_several && share_within(t.box(), box) >= p_.body.nested)
      area += t.box().area();
  return area;
}

void EvidenceTracker::publish(std::span<const Track> motion) {
  results_.clear();
  const double across = static_cast<double>(frame_.size.width) / frame_.picture.width;
  const double down = static_cast<double>(frame_.size.height) / frame_.picture.height;
  for (EvidenceTrack& t : tracks_) {
    if (!counts(t) || (!t.mirrors && t.unseen > shown_time())) continue;
    if (frame_.persons_only && !t.person) continue;
    if (t.holds_several && area_of_persons_in(t.box()) >= p_.filled * t.box().area()) continue;
    const Box box = in_frame(t.box());
    if (box.width < 1 || box.height < 1) continue;
    if (t.id == 0) t.id = ++last_id_;
    EvidenceResult r;
    r.id = t.id;
    r.box = box;
    r.velocity = {t.velocity.x * t.height * across, t.velocity.y * t.height * down};
    r.age = t.age;
    r.confidence = t.person_evidence / p_.ceiling;
    r.person = t.person, r.moves = t.since_motion < 1, r.kind = t.kind;
    r.state = !r.moves && t.rested() >= p_.stopped   ? TrackState::stopped
              : t.hit || t.unseen == 0 || t.followed ? TrackState::seen
                                                     : TrackState::coasted;
    if (t.mirrors) {
      const auto found = std::ranges::find(motion, t.motion_id, &Track::id);
      r.motion = static_cast<int>(found - motion.begin());
      r.state = found->state;
    }
    results_.push_back(r);
  }
  std::ranges::sort(results_, {}, &EvidenceResult::id);
}

std::span<const EvidenceResult> EvidenceTracker::update(const EvidenceFrame& frame,
                                                        std::span<const Track> motion,
                                                        const std::optional<EvidenceLook>& look) {
  if (frame.fresh)
    reset();
  else if (frame.picture.size() != pictures_[present_].size())
    drop_tracks();
  frame_ = frame;
  present_ = 1 - present_, ++number_;
  Image<std::uint8_t>& picture = pictures_[present_];
  picture.resize(frame.picture.size());
  for (int y = 0; y < frame.picture.height; ++y)
    std::copy_n(frame.picture.row(y), frame.picture.width, picture.view().row(y));
  pyramids_[present_].borrow(picture.view(), kLevels);
  motion_ = frame.motion.rescaled(frame.size, picture.size());
  since_look_ = motion_ * since_look_;
  if (!frame.fresh) camera_stood_ = frame.still ? camera_stood_ + frame.seconds : 0;
  for (EvidenceTrack& t : tracks_)
    t.follow(number_ > 1 ? &pyramids_[1 - present_] : nullptr, pyramids_[present_], motion_, frame.seconds,
             p_);
  if (look && look->of_this_frame) begin_look();
  if (look && look_number_ > 0) take_look(*look);
  if (frame.calm >= p_.calm)
    take_motion(motion);
  else
    for (EvidenceTrack& t : tracks_) t.mirrors = t.holds_several = false;
  if (look && look_number_ > 0) judge_look(*look);
  end_tracks();
  publish(motion);
  remember_motion();
  return results_;
}

std::size_t EvidenceTracker::bytes() const {
  const auto of = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
  return sizeof *this + of(tracks_) + of(known_) + of(results_) + of(bodies_) + of(cost_) + of(rows_) +
         of(columns_) + of(used_) + assignment_.bytes() + pictures_[0].bytes() + pictures_[1].bytes() +
         looked_.bytes() + pyramids_[0].bytes() + pyramids_[1].bytes() + looked_pyramid_.bytes();
}

}  // namespace cerberus::vision
