// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/components/component_origins.h"

#include "support/suite.h"

using namespace cerberus::vision;

namespace {

constexpr Size kSize{100, 4};
using Origin = ComponentOrigins::Origin;

Run run(int first, int end) {
  Run r;
  r.row = 2, r.first = static_cast<std::uint16_t>(first), r.end = static_cast<std::uint16_t>(end);
  return r;
}

struct Frames {
  ComponentOrigins origins;
  BitMask differs, gone;
  Frames() {
    origins.preallocate(kSize);
    for (auto* bits : {&differs, &gone}) bits->resize(bit_mask_size(kSize));
  }
  void see(const Run& r, Origin origin, const Run& taken = {}) {
    for (auto* bits : {&differs, &gone}) bits->fill_bytes(0);
    set_bits(differs.view().row(r.row), r.first, r.end);
    set_bits(gone.view().row(taken.row), taken.first, taken.end);
    origins.record(r, origin);
    origins.step(differs.view(), gone.view());
  }
  void expect(const Run& r, int differed, int inside) const {
    ComponentOrigins::Overlap before;
    origins.add_overlap(r, before);
    ck_assert_int_eq(before.differed, differed);
    ck_assert_int_eq(before.inside, inside);
  }
};

}  // namespace

START_TEST(nothing_has_differed_at_the_start) {
  Frames f;
  f.expect(run(0, 100), 0, 0);
  f.see(run(10, 80), Origin::inside);
  f.expect(run(0, 100), 70, 70);
  f.origins.reset();
  f.expect(run(0, 100), 0, 0);
}
END_TEST

START_TEST(overlap_is_searched_two_pixels_to_either_side) {
  Frames f;
  f.see(run(10, 20), Origin::inside);
  f.expect(run(21, 40), 1, 1);
  f.expect(run(22, 40), 0, 0);
  f.expect(run(4, 8), 0, 0);
  f.expect(run(4, 9), 1, 1);
  f.see(run(90, 100), Origin::inside);
  f.expect(run(95, 100), 7, 7);  // at the picture's edge
}
END_TEST

START_TEST(each_pixel_keeps_its_origin_and_new_ones_take_the_component_s) {
  Frames f;
  f.see(run(10, 20), Origin::inside);
  f.see(run(10, 40), Origin::outside);  // an object from outside has joined it
  f.expect(run(12, 38), 30, 10);
  f.see(run(10, 50), Origin::inside);
  f.expect(run(12, 48), 40, 20);
}
END_TEST

START_TEST(absorbed_pixels_and_those_that_fit_again_lose_their_origin) {
  Frames f;
  f.see(run(10, 40), Origin::inside, run(10, 20));
  f.expect(run(10, 40), 20, 20);
  f.see(run(30, 40), Origin::outside);
  f.expect(run(10, 40), 10, 10);
  f.see(run(10, 40), Origin::outside);
  f.expect(run(10, 40), 30, 10);
  f.gone.fill_bytes(0);
  set_bits(f.gone.view().row(2), 35, 40);
  f.origins.forget(f.gone.view());  // a part of those that began inside
  f.expect(run(10, 40), 25, 5);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "component_origins", {nothing_has_differed_at_the_start, overlap_is_searched_two_pixels_to_either_side,
                            each_pixel_keeps_its_origin_and_new_ones_take_the_component_s,
                            absorbed_pixels_and_those_that_fit_again_lose_their_origin});
}
