// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/verification/followed_person.h"

#include <algorithm>
#include <cmath>

#include "vision/verification/patch_matching.h"

namespace cerberus::vision {

namespace {

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

// The velocity with which the pictures around frame `number` look most alike at the person, camera motion taken out.
// Several pictures before and after it count at once: somebody who passes hides the person in some of them only, and a
// pixel that differs much counts as hidden. False: the pictures say nothing, as there are too few, the picture's edge cuts
// the person, or every velocity fits alike.
bool FollowedPerson::find_velocity(std::uint64_t number, const PictureHistory& pictures,
                                   const VerificationParameters& p) {
  if (pictures.seen(box_).area() <= p.whole * box_.area()) return false;
  struct Other {
    GrayView picture;
    Point camera;  // reduced pixels that the camera's motion shifts the person, from frame `number`
    double frames;
  };
  std::array<Other, 2 * kMostAround> others;
  std::size_t n = 0;
  const auto most = static_cast<std::uint64_t>(std::clamp(p.velocity_frames, 0, kMostAround));
  const Box core = core_of(pictures.reduced(box_), p.core_width, p.core_height);
  const GrayView now = pictures.picture(number);
  const Point middle = middle_of(core);
  const auto add = [&](std::uint64_t k, const Point& at) {
    if (pictures.picture(k).size() != now.size()) return;
    others[n++] = {pictures.picture(k),
                   {at.x - middle.x, at.y - middle.y},
                   static_cast<double>(k) - static_cast<double>(number)};
  };
  Point at = middle;
  for (std::uint64_t k = number + 1; k <= std::min(number + most, pictures.number()); ++k)
    add(k, at = pictures.motion(k).apply(at));
  at = middle;
  for (std::uint64_t k = number; k > 1 && k + most > number && pictures.holds(k - 1); --k)
    add(k - 1, at = pictures.motion(k).inverse().apply(at));
  if (n < 2) return false;
  const auto difference = [&](const Point& v) {
    double sum = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const Other& o = others[i];
      const Point shift{o.camera.x + o.frames * v.x, o.camera.y + o.frames * v.y};
      sum += patch_difference(now, o.picture, core, shift, p.hidden_difference).value_or(p.hidden_difference);
    }
    return sum;
  };
  const int reach = static_cast<int>(std::ceil(p.reach * pictures.reduced(box_).height));
  Point best;
  const double at_rest = difference(best);
  double least = at_rest, most_different = at_rest;
  // Reduced pixels a frame. People go up and down the picture slowly: a pixel is 25 a second.
  for (const double step : {1.0, 0.5, 0.25}) {
    const int across = step == 1 ? reach : 1;
    const Point from = best;
    for (int x = -across; x <= across; ++x)
      for (int y = -1; y <= 1; ++y) {
        const Point v{from.x + step * x, from.y + step * y};
        const double d = difference(v);
        if (d < least) least = d, best = v;
        most_different = std::max(most_different, d);
      }
  }
  constexpr double kAlike = 1;  // grey level a pixel and picture: noise
  if (most_different - least < kAlike * static_cast<double>(n)) return false;
  velocity_ = {best.x / pictures.across(), best.y / pictures.down()};
  walks_ = least < p.walking * at_rest;
  return true;
}

void FollowedPerson::begin(const Box& found, std::uint64_t number, const PictureHistory& pictures,
                           const VerificationParameters& p) {
  box_ = found;
  velocity_known_ = find_velocity(number, pictures, p);
  looks_ = 1, look_number_ = number;
  places_[number % PictureHistory::kKept] = {box_, way_};
  for (std::uint64_t n = number + 1; n <= pictures.number(); ++n) follow(n, pictures, p);
}

// Once the velocity is known, by the pictures around the first look or by two looks, the picture only corrects it a little,
// because whoever passes in front or behind draws the comparison away. Until then the velocity is that of the picture.
void FollowedPerson::follow(std::uint64_t to, const PictureHistory& pictures,
                            const VerificationParameters& p) {
  const GrayView before = pictures.picture(to - 1), now = pictures.picture(to);
  if (to < 2 || before.size() != now.size()) return;
  const double sx = pictures.across(), sy = pictures.down();
  const Box small = pictures.reduced(box_);
  const Point middle = middle_of(small), moved = pictures.motion(to).apply(middle);
  const Point camera{moved.x - middle.x, moved.y - middle.y};
  Point step{camera.x + sx * velocity_.x, camera.y + sy * velocity_.y};
  const bool known = looks_ > 1 || velocity_known_,
             whole = pictures.seen(box_).area() > p.whole * box_.area();
  if (!known || whole) {  // of a person whom the picture's edge cuts the picture says little
    const int reach = known ? std::max(1, static_cast<int>(std::lround(p.reach_known * small.height)))
                            : std::max(2, static_cast<int>(std::ceil(p.reach * small.height)));
    step = match_patch(before, now, core_of(small, p.core_width, p.core_height), step, reach);
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
