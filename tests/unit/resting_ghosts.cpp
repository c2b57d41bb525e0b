// SPDX-License-Identifier: LGPL-2.1-or-later
// Ghosts within the foreground. Pictures are 160 x 120; a body is 20 x 60, 200 before a background of 100.
#include "vision/components/resting_ghosts.h"

#include <algorithm>
#include <array>
#include <bit>

#include "support/suite.h"

using namespace cerberus::vision;

namespace {

constexpr Size kSize{160, 120};
constexpr int kRested = 25;  // frames

struct Rect {
  int x, y, width, height;
};
constexpr Rect kPlace{60, 30, 20, 60};

struct Scene {
  Image<std::uint8_t> frame{kSize}, background{kSize}, quiet{kSize};
  BitMask mask, absorb;
  Labeller labeller;
  RestingGhosts ghosts;

  Scene() {
    for (auto* picture : {&frame, &background}) picture->fill_bytes(100);
    quiet.fill_bytes(200);
    for (auto* bits : {&mask, &absorb}) bits->resize(bit_mask_size(kSize));
    labeller.preallocate(kSize);
    ghosts.preallocate(kSize);
  }
  static void paint(Image<std::uint8_t>& picture, const Rect& r, int value) {
    for (int y = r.y; y < r.y + r.height; ++y)
      std::fill_n(picture.view().row(y) + r.x, r.width, static_cast<std::uint8_t>(value));
  }
  void differs(const Rect& r, int since) {
    for (int y = r.y; y < r.y + r.height; ++y) set_bits(mask.view().row(y), r.x, r.x + r.width);
    paint(quiet, r, since);
  }
  void remove() {
    ghosts.remove({frame.view(), background.view(), quiet.view(), {}, {{}, kSize.width}}, kRested, labeller,
                  mask.view(), absorb.view());
  }
};

int count(const BitMask& bits, const Rect& r) {
  int n = 0;
  for (int y = r.y; y < r.y + r.height; ++y)
    for_bits(bits.view().row(y), r.x, r.x + r.width, [&](int) { ++n; });
  return n;
}

int all(const Rect& r) {
  return r.width * r.height;
}

}  // namespace

START_TEST(a_ghost_that_people_pass_is_taken_and_they_stay) {
  Scene s;
  Scene::paint(s.background, kPlace, 200);  // somebody stood there when the scene began
  const Rect walker{80, 30, 24, 60};        // who touches it
  Scene::paint(s.frame, walker, 180);
  s.differs(kPlace, kRested);
  s.differs(walker, 0);
  s.remove();
  ck_assert_int_eq(count(s.mask, kPlace), 0);
  ck_assert_int_eq(count(s.absorb, kPlace), all(kPlace));
  ck_assert_int_eq(count(s.mask, walker), all(walker));
  ck_assert_int_eq(count(s.absorb, walker), 0);
}
END_TEST

START_TEST(who_has_stopped_stays) {
  Scene s;
  Scene::paint(s.frame, kPlace, 200);
  s.differs(kPlace, 100);
  s.remove();
  ck_assert_int_eq(count(s.mask, kPlace), all(kPlace));
  ck_assert_int_eq(count(s.absorb, kPlace), 0);
}
END_TEST

START_TEST(nothing_is_judged_before_it_has_rested_or_where_its_outline_is_hidden_or_short) {
  struct Case {
    Rect place;
    int since;
    bool hidden;
    bool taken;
  };
  for (const Case& c : {Case{kPlace, kRested, false, true},
                        {kPlace, kRested - 1, false, false},
                        {kPlace, kRested, true, false},
                        {{60, 30, 6, 5}, kRested, false, true},      // 30 pixels of 160 x 120
                        {{60, 30, 5, 5}, kRested, false, false}}) {  // 25
    Scene s;
    Scene::paint(s.background, c.place, 200);
    if (c.hidden) {  // on both sides, but for a fifth of the height
      s.differs({40, 30, 20, 48}, 0);
      s.differs({80, 30, 20, 48}, 0);
    }
    s.differs(c.place, c.since);
    s.remove();
    ck_assert_int_eq(count(s.mask, c.place), c.taken ? 0 : all(c.place));
    ck_assert_int_eq(count(s.absorb, c.place), c.taken ? all(c.place) : 0);
  }
}
END_TEST

// Beside the place ends what the frame covers, or what the model has learnt.
START_TEST(where_nothing_can_be_compared_is_no_outline) {
  struct Case {
    bool visible, learnt, taken;
  };
  for (const Case& c : {Case{true, true, true}, {false, true, false}, {true, false, false}}) {
    Scene s;
    Scene::paint(s.background, {0, 0, kPlace.x, kSize.height}, 0);
    std::array<RowSpan, kSize.height> rows;
    rows.fill({c.visible ? 0 : kPlace.x, kSize.width});
    Image<std::uint8_t> age{kSize};
    age.fill_bytes(30);
    if (!c.learnt) Scene::paint(age, {0, 0, kPlace.x, kSize.height}, 0);
    s.differs(kPlace, kRested);
    s.ghosts.remove({s.frame.view(), s.background.view(), s.quiet.view(), age.view(), {rows, kSize.width}},
                    kRested, s.labeller, s.mask.view(), s.absorb.view());
    ck_assert_int_eq(count(s.mask, kPlace), c.taken ? 0 : all(kPlace));
  }
}
END_TEST

// A wall's pattern lies behind the outline in the frame and in the model.
START_TEST(an_outline_that_is_an_edge_of_both_decides_nothing) {
  Scene s;
  for (auto* picture : {&s.frame, &s.background}) Scene::paint(*picture, {0, 0, kPlace.x, kSize.height}, 20);
  Scene::paint(s.background, kPlace, 110);
  s.differs(kPlace, kRested);
  s.remove();
  ck_assert_int_eq(count(s.mask, kPlace), all(kPlace));
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "resting_ghosts",
      {a_ghost_that_people_pass_is_taken_and_they_stay, who_has_stopped_stays,
       nothing_is_judged_before_it_has_rested_or_where_its_outline_is_hidden_or_short,

       an_outline_that_is_an_edge_of_both_decides_nothing, where_nothing_can_be_compared_is_no_outline});
}
