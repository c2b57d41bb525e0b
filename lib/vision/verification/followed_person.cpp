// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/verification/followed_person.h"

#include <algorithm>
#include <cmath>

#include "vision/verification/patch_matching.h"

namespace cerberus::vision {

namespace {

Box core_of(const Box& box, const VerificationParameters& p) {
  return {box.x + box.width * (1 - p.core_width) / 2, box.y + box.height * (1 - p.core_height) / 2,
          box.width * p.core_width, box.height * p.core_height};
}

Point middle_of(const Box& box) {
  return {box.x + box.width / 2, box.y + box.height / 2};
}

// About its middle, by a share of the difference.
void resize(Box& box, const Box& to, double share) {
  const double wider = share * (to.width - box.width), higher = share * (to.height - box.height);
  box = {box.x - wider / 2, box.y - higher / 2, box.width + wider, box.height + higher};
}

}  // namespace

void PictureHistory::add(GrayView picture, Size frame, const Transform& motion) {
  Past& now = past_[++number_ % kKept];
  frame_ = frame;
  now.picture.resize(picture.size());
  for (int y = 0; y < picture.height; ++y)
    std::copy_n(picture.row(y), picture.width, now.picture.view().row(y));
  now.motion = motion.rescaled(frame, picture.size());
}

Box PictureHistory::reduced(const Box& box) const {
  return {box.x * across(), box.y * down(), box.width * across(), box.height * down()};
}

Box PictureHistory::seen(const Box& box) const {
  const double left = std::max(box.x, 0.0), top = std::max(box.y, 0.0);
  return {left, top, std::max(std::min(box.right(), double(frame_.width)) - left, 0.0),
          std::max(std::min(box.bottom(), double(frame_.height)) - top, 0.0)};
}

void FollowedPerson::shift(double dx, double dy) {
  box_.x += dx, box_.y += dy, way_.x += dx, way_.y += dy;
}

void FollowedPerson::keep(const PictureHistory& pictures) {
  places_[pictures.number() % PictureHistory::kKept] = {box_, way_};
}

void FollowedPerson::begin(const Box& found, std::uint64_t number, const PictureHistory& pictures,
                           const VerificationParameters& p) {
  box_ = found;
  looks_ = 1, look_number_ = number;
  places_[number % PictureHistory::kKept] = {box_, way_};
  for (std::uint64_t n = number + 1; n <= pictures.number(); ++n) follow(n, pictures, p);
}

// Two looks show how fast the person goes. The picture then only corrects that a little, because whoever passes in front
// or behind draws the comparison away; until then it is the picture that says so.
void FollowedPerson::follow(std::uint64_t to, const PictureHistory& pictures,
                            const VerificationParameters& p) {
  const GrayView before = pictures.picture(to - 1), now = pictures.picture(to);
  if (to < 2 || before.size() != now.size()) return;
  const double sx = pictures.across(), sy = pictures.down();
  const Box small = pictures.reduced(box_);
  const Point middle = middle_of(small), moved = pictures.motion(to).apply(middle);
  const Point camera{moved.x - middle.x, moved.y - middle.y};
  Point step{camera.x + sx * velocity_.x, camera.y + sy * velocity_.y};
  const bool known = looks_ > 1, whole = pictures.seen(box_).area() > p.whole * box_.area();
  if (!known || whole) {  // of a person whom the picture's edge cuts the picture says little
    const int reach = known ? std::max(1, static_cast<int>(std::lround(p.reach_known * small.height)))
                            : std::max(2, static_cast<int>(std::ceil(p.reach * small.height)));
    step = match_patch(before, now, core_of(small, p), step, reach);
  }
  const Point own{(step.x - camera.x) / sx, (step.y - camera.y) / sy};
  if (!known)
    velocity_ = {p.inertia * velocity_.x + (1 - p.inertia) * own.x,
                 p.inertia * velocity_.y + (1 - p.inertia) * own.y};
  box_.x += camera.x / sx, box_.y += camera.y / sy;
  shift(own.x, own.y);
  moved_ = moved_ || std::hypot(way_.x, way_.y) > p.moved * box_.width;
  places_[to % PictureHistory::kKept] = {box_, way_};
}

void FollowedPerson::correct(const Box& found, std::uint64_t number, const PictureHistory& pictures,
                             const VerificationParameters& p) {
  const Place& then = places_[number % PictureHistory::kKept];
  const Point was = middle_of(then.box), is = middle_of(found);
  const Point error{is.x - was.x, is.y - was.y};
  const Point way{then.way.x + error.x, then.way.y + error.y};
  // The box of a person whom the picture's edge cuts ends there: its middle is not the person's.
  if (number > look_number_ && pictures.seen(then.box).area() > p.whole * then.box.area()) {
    const double frames = static_cast<double>(number - look_number_);
    const double share = looks_ > 1 ? p.velocity_gain : 1;
    velocity_.x += share * ((way.x - look_way_.x) / frames - velocity_.x);
    velocity_.y += share * ((way.y - look_way_.y) / frames - velocity_.y);
  }
  Point by{p.place_gain * error.x, p.place_gain * error.y};
  if (looks_ == 1) {  // what the picture said of the way since then is not needed any more
    const double since = static_cast<double>(pictures.number() - number);
    by = {way.x + since * velocity_.x - way_.x, way.y + since * velocity_.y - way_.y};
  }
  ++looks_, look_way_ = way, look_number_ = number;
  shift(by.x, by.y);
  resize(box_, found, p.size_gain);
  keep(pictures);
}

void FollowedPerson::pull(const Box& to, double place, double size, const PictureHistory& pictures,
                          const VerificationParameters& p) {
  const Point at = middle_of(box_), there = middle_of(to);
  const Point by{place * (there.x - at.x), place * (there.y - at.y)};
  shift(by.x, by.y);
  resize(box_, to, size);
  velocity_.x += (1 - p.inertia) * by.x, velocity_.y += (1 - p.inertia) * by.y;
  keep(pictures);
}

}  // namespace cerberus::vision
