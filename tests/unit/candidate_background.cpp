// SPDX-License-Identifier: LGPL-2.1-or-later
// A second background of each pixel. The scene behind somebody who has left has stripes of 4 pixels, 40 grey levels apart.
#include "vision/background/candidate_background.h"

#include <algorithm>

#include "support/suite.h"

using namespace cerberus::vision;

namespace {

constexpr Size kSize{96, 64};
constexpr int kX = 40, kY = 30;  // a pixel beside an edge

struct Place {
  Image<std::uint8_t> frame{kSize}, age{kSize}, quiet{kSize};
  BitMask foreground;
  std::array<double, kBrightness> noise;
  CandidateBackground candidates;

  explicit Place(double seconds, int learnt) {
    age.fill_bytes(static_cast<std::uint8_t>(learnt));
    quiet.fill_bytes(3);
    foreground.resize(bit_mask_size(kSize));
    for (int y = 0; y < kSize.height; ++y) set_bits(foreground.view().row(y), 0, kSize.width);
    noise.fill(1);
    candidates.preallocate(kSize);
    candidates.set_period(seconds);
  }
  // frame_at(x, y): grey levels.
  template <typename FrameAt>
  void see_frames(FrameAt&& frame_at, int frames) {
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) frame.view().at(x, y) = static_cast<std::uint8_t>(frame_at(x, y));
    for (int n = 0; n < frames; ++n)
      candidates.update({frame.view(), foreground.view(), age.view(), quiet.view()}, noise);
  }
  // The scene, or a coat of one grey level before it.
  void see(int coat, int frames) {
    see_frames([coat](int x, int) { return coat > 0 ? coat : x / 4 % 2 ? 140 : 100; }, frames);
  }
  bool lasts() const { return bit_at(candidates.lasting().row(kY), kX); }
};

}  // namespace

START_TEST(what_was_seen_for_half_a_second_in_all_lasts_and_passers_take_off_what_they_hide) {
  Place place(0.04, 20);  // .45 s are 11 frames
  place.see(0, 8);
  place.see(30, 2);
  place.see(0, 4);  // 8 - 2 + 4
  ck_assert(!place.lasts());
  place.see(0, 1);
  ck_assert(place.lasts());
  place.see(30, 1);
  ck_assert(!place.lasts());
  place.see(0, 1);
  ck_assert(place.lasts());
}
END_TEST

START_TEST(edges_across_count_as_those_along) {
  Place place(0.04, 20);
  place.see_frames([](int, int y) { return y / 4 % 2 ? 140 : 100; }, 12);
  ck_assert(place.lasts());  // rows 28 and 32 are 140 and 100
}
END_TEST

// Five standard deviations are the same, nine levels at least.
START_TEST(what_is_the_same_depends_on_the_noise) {
  struct Case {
    double sigma;
    int difference;
    bool same;
  };
  for (const Case& c : {Case{1, 9, true}, {1, 10, false}, {3, 15, true}, {3, 16, false}}) {
    Place place(0.04, 20);
    place.noise.fill(c.sigma);
    place.see(0, 12);
    place.see(place.frame.view().at(kX, kY) + c.difference, 1);
    ck_assert_int_eq(place.lasts(), c.same);
  }
}
END_TEST

START_TEST(even_coats_are_no_candidate) {
  Place place(0.04, 20);
  place.see(30, 200);
  ck_assert(!place.lasts());
}
END_TEST

START_TEST(what_the_model_has_known_for_four_times_as_long_is_the_background) {
  Place place(0.04, 120);
  place.see(0, 30);
  ck_assert(!place.lasts());
  place.see(0, 1);
  ck_assert(place.lasts());
}
END_TEST

START_TEST(five_frames_at_least_are_needed) {
  Place place(0.5, 1);
  place.see(0, 4);
  ck_assert(!place.lasts());
  place.see(0, 1);
  ck_assert(place.lasts());
}
END_TEST

START_TEST(after_a_turn_all_is_new) {
  Place place(0.04, 20);
  place.see(0, 20);
  place.candidates.reset();
  ck_assert(!place.lasts());
  place.see(0, 10);
  ck_assert(!place.lasts());
  place.see(0, 1);
  ck_assert(place.lasts());
}
END_TEST

// The grey level rises by 2 from frame to frame and by 40 in all; 9 are the same.
START_TEST(a_candidate_follows_the_light) {
  Place place(0.04, 20);
  place.see(0, 1);
  for (int n = 1; n <= 20; ++n)
    place.see_frames([n](int x, int) { return (x / 4 % 2 ? 140 : 100) + 2 * n; }, 1);
  ck_assert(place.lasts());
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "candidate_background",
      {what_was_seen_for_half_a_second_in_all_lasts_and_passers_take_off_what_they_hide,
       edges_across_count_as_those_along, what_is_the_same_depends_on_the_noise, even_coats_are_no_candidate,
       what_the_model_has_known_for_four_times_as_long_is_the_background, five_frames_at_least_are_needed,
       after_a_turn_all_is_new, a_candidate_follows_the_light});
}
