// SPDX-License-Identifier: LGPL-2.1-or-later
// What the stages hold: what they say of it, how much it is, and that it does not grow.
#include <random>

#include "support/allocations.h"
#include "support/chain.h"
#include "support/pictures.h"
#include "support/suite.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

// A camera that pans by a pixel and a half a frame over a textured wall, people who walk, and sensor noise; every tenth
// frame a shower of specks. The first frame is empty.
class Street {
 public:
  explicit Street(Size size) : picture_(size), wall_({size.width + 200, size.height}) {
    look(Scene(5), {}, wall_.view());
  }
  LumaSource frame(int k) {
    const Size size = picture_.size();
    const MutableGrayView out = picture_.view();
    const int pan = 3 * k / 2 % 200;
    for (int y = 0; y < size.height; ++y) std::copy_n(wall_.view().row(y) + pan, size.width, out.row(y));
    for (int person = 0; person < 5 && k > 0; ++person)
      block(size.width * person / 5 + (person % 2 ? k : -k), size.height / 3 + 8 * person, 12, 34,
            person % 2 ? 20 : 230);
    if (k % 10 == 9)
      for (int speck = 0; speck < 300; ++speck)
        block(static_cast<int>(random_() % static_cast<unsigned>(size.width)),
              static_cast<int>(random_() % static_cast<unsigned>(size.height)), 4, 4, 255);
    add_noise(out, 1, 3, random_);
    return {out.data, size.width, size.height, out.stride, 1, false, 0, 0, 0};
  }

 private:
  void block(int left, int top, int width, int height, std::uint8_t value) {
    for (int y = std::max(0, top); y < std::min(top + height, picture_.size().height); ++y)
      for (int x = std::max(0, left); x < std::min(left + width, picture_.size().width); ++x)
        picture_.view().at(x, y) = value;
  }
  Image<std::uint8_t> picture_, wall_;
  std::mt19937 random_{1};
};

constexpr Size kSizes[] = {{320, 240}, {320, 180}, {640, 480}, {160, 120}};

}  // namespace

// What tracks take grows with the number of objects, not with the picture: it is counted apart.
constexpr std::size_t kPictureStages = Chain::kStages - 1;

START_TEST(the_stages_hold_what_they_say_and_that_is_at_most_18_bytes_a_pixel_and_60_kB) {
  for (const Size size : kSizes) {
    Street street(size);
    std::ptrdiff_t before = held_bytes();
    const Tracker tracker;
    const std::ptrdiff_t of_a_tracker = held_bytes() - before;
    before = held_bytes();
    Chain chain;
    std::ptrdiff_t held = held_bytes() - before - of_a_tracker;
    chain.set_analysis_width(0);
    for (int k = 0; k < 40; ++k) {
      const LumaSource frame = street.frame(k);
      before = held_bytes();
      chain.begin(frame, 0.04);
      for (std::size_t s = 0; s < kPictureStages; ++s) chain.run_stage(s);
      held += held_bytes() - before;
      chain.run_stage(kPictureStages);
    }
    const auto said = static_cast<double>(chain.bytes());
    held -= static_cast<std::ptrdiff_t>(chain.own_bytes());
    // The heap's rounding.
    ck_assert_double_le(said, static_cast<double>(held));
    ck_assert_double_ge(said, 0.97 * static_cast<double>(held));
    // A label picture has two more; tests/elements/memory.cpp has what elements take beside.
    ck_assert_double_le(said, 18.0 * static_cast<double>(size.area()) + 60e3);
  }
}
END_TEST

START_TEST(a_tracker_uses_the_bytes_it_reports_and_more_only_for_more_tracks_than_ever) {
  std::mt19937 random(3);
  const std::ptrdiff_t before = held_bytes();
  Tracker tracker;
  const auto see = [&](std::size_t number) {
    std::vector<Region> regions(number);
    for (Region& r : regions)
      r.box = {static_cast<double>(random() % 640), static_cast<double>(random() % 480), 8, 16};
    const std::size_t taken = allocations();
    tracker.update(regions, {}, 0.04, {640, 480});
    return allocations() - taken;
  };
  const auto check = [&](double most) {
    const auto held = static_cast<double>(held_bytes() - before), said = static_cast<double>(tracker.bytes());
    ck_assert_double_le(said, held);
    ck_assert_double_ge(said, 0.97 * held);
    ck_assert_double_le(held, most);
  };
  check(25e3);
  ck_assert_uint_eq(see(5), 0);
  check(25e3);
  for (int k = 0; k < 3; ++k) see(1000);
  check(500e3);
  for (std::size_t number = 0; number < 2000; number += 50) ck_assert_uint_eq(see(number), 0);
}
END_TEST

START_TEST(nothing_is_taken_after_the_first_frames_whatever_moves) {
  for (const Size size : kSizes) {
    Street street(size);
    Chain chain;
    chain.set_analysis_width(0);
    std::array<std::size_t, Chain::kStages> taken{};
    for (int k = 0; k < 60; ++k) {
      chain.begin(street.frame(k), 0.04);
      for (std::size_t s = 0; s < Chain::kStages; ++s) {
        const std::size_t before = allocations();
        chain.run_stage(s);
        if (k >= 3) taken[s] += allocations() - before;
      }
    }
    for (std::size_t s = 0; s < kPictureStages; ++s)
      ck_assert_msg(taken[s] == 0, "%s: %zu at %d x %d", Chain::stage_name(s), taken[s], size.width,
                    size.height);
  }
}
END_TEST

int main() {
  return run_suite("memory", {the_stages_hold_what_they_say_and_that_is_at_most_18_bytes_a_pixel_and_60_kB,
                              a_tracker_uses_the_bytes_it_reports_and_more_only_for_more_tracks_than_ever,
                              nothing_is_taken_after_the_first_frames_whatever_moves});
}
