// SPDX-License-Identifier: LGPL-2.1-or-later
// Where a person is between the looks of a detector: by the velocity that the pictures around the first look and all looks
// since have shown, and by the picture.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "vision/geometry/box.h"
#include "vision/geometry/transform.h"
#include "vision/image/image.h"
#include "vision/verification/verification_parameters.h"

namespace cerberus::vision {

// The last pictures of a stream, reduced, and the camera's motion from each to the next.
class PictureHistory {
 public:
  static constexpr std::size_t kKept = 32;  // a second at 30 frames a second

  PictureHistory() : past_(kKept) {}
  void reset() { number_ = 0; }
  // picture: any size, the same in every frame of a stream; motion: from the frame before, in pixels of the frame.
  void add(GrayView picture, Size frame, const Transform& motion);
  std::uint64_t number() const { return number_; }  // of the present picture, from 1
  bool holds(std::uint64_t number) const { return number <= number_ && number_ - number < kKept; }
  GrayView picture(std::uint64_t number) const { return past_[number % kKept].picture.view(); }
  const Transform& motion(std::uint64_t number) const {
    return past_[number % kKept].motion;
  }  // reduced pixels
  Size frame() const { return frame_; }
  double across() const { return static_cast<double>(picture(number_).width) / frame_.width; }
  double down() const { return static_cast<double>(picture(number_).height) / frame_.height; }
  Box reduced(const Box& box) const;  // of frame pixels
  Box seen(const Box& box) const;     // the part that lies in the frame

 private:
  struct Past {
    Image<std::uint8_t> picture;
    Transform motion;
  };
  std::vector<Past> past_;
  std::uint64_t number_ = 0;
  Size frame_;
};

// All in frame pixels; velocities a frame, camera motion taken out.
class FollowedPerson {
 public:
  // A look at frame `number` shows the person for the first time, who is followed to the present frame.
  void begin(const Box& found, std::uint64_t number, const PictureHistory& pictures,
             const VerificationParameters& p);
  // To frame `to`, from the one before.
  void follow(std::uint64_t to, const PictureHistory& pictures, const VerificationParameters& p);
  // A look at frame `number` shows where the person was then.
  void correct(const Box& found, std::uint64_t number, const PictureHistory& pictures,
               const VerificationParameters& p);
  // Towards a box of the present frame, by these shares of the distance and of the difference in size.
  void pull(const Box& to, double place, double size, const PictureHistory& pictures,
            const VerificationParameters& p);

  const Box& box() const { return box_; }
  const Box& box_at(std::uint64_t number) const { return places_[number % PictureHistory::kKept].box; }
  Point velocity() const { return velocity_; }
  int looks() const { return looks_; }
  // Has it ever been away from where it was first seen by this share of its width?
  bool moved() const { return moved_; }
  // The pictures around the first look fit a velocity much better than rest.
  bool walks() const { return walks_; }

 private:
  struct Place {
    Box box;
    Point way;
  };
  static constexpr int kMostAround = 12;  // pictures that are compared, before a look and after it
  bool find_velocity(std::uint64_t number, const PictureHistory& pictures, const VerificationParameters& p);
  void shift(double dx, double dy);
  void keep(const PictureHistory& pictures);

  Box box_;
  Point velocity_;
  Point way_;                    // of the box's middle from where it was first seen
  bool velocity_known_ = false;  // from the pictures around the first look
  int looks_ = 0;                // that showed the person
  Point look_way_;
  std::uint64_t look_number_ = 0;
  bool moved_ = false, walks_ = false;
  std::array<Place, PictureHistory::kKept> places_;
};

}  // namespace cerberus::vision
