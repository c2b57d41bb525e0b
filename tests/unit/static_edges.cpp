// SPDX-License-Identifier: LGPL-2.1-or-later
// Edges that keep their place while the scene moves, counted by hand.
#include "vision/burnt_in/static_edges.h"

#include <cstdlib>
#include <random>

#include "support/pictures.h"
#include "support/targets.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

constexpr Size kSize{100, 30};

// A flat picture with a bright upright bar, columns left to left + 3 of all rows.
Image<std::uint8_t> bar(int left) {
  Image<std::uint8_t> image(kSize);
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) image.view().at(x, y) = x >= left && x < left + 4 ? 200 : 50;
  return image;
}

}  // namespace

// The bar at columns 20 to 23: pairs (x, x + 2) with a step have x = 18, 19 and 22, 23, all in the third block (16 to
// 23). Two sampled rows a block.
START_TEST(an_edge_that_stays_while_the_scene_moves_is_static) {
  StaticEdges edges;
  const BlockGrid grid(kSize);
  edges.resize(grid);
  const Image<std::uint8_t> picture = bar(20);
  ck_assert(!edges.compare(picture.view()));  // no reference yet
  edges.renew(picture.view(), 0.04);
  edges.follow(Transform::translation(4, 0));
  ck_assert(edges.compare(picture.view()));
  ck_assert_int_eq(edges.fixed(grid.at(2, 3)), 8);
  ck_assert_int_eq(edges.moved(grid.at(2, 3)), 0);
  ck_assert_int_eq(edges.fixed(grid.at(3, 3)), 0);
}
END_TEST

START_TEST(an_edge_that_moves_with_the_scene_is_not) {
  StaticEdges edges;
  const BlockGrid grid(kSize);
  edges.resize(grid);
  edges.renew(bar(20).view(), 0.04);
  edges.follow(Transform::translation(8, 0));
  ck_assert(edges.compare(bar(28).view()));
  ck_assert_int_eq(edges.fixed(grid.at(3, 3)), 0);
  ck_assert_int_eq(edges.moved(grid.at(3, 3)), 8);
}
END_TEST

// A caption is there for days.
START_TEST(what_was_static_for_long_stays_so) {
  StaticEdges edges;
  const BlockGrid grid(kSize);
  edges.resize(grid);
  const Image<std::uint8_t> picture = bar(20);
  bool was = false;
  for (int n = 0; n < 300; ++n) {
    edges.renew(picture.view(), 60.0 * n);
    edges.follow(Transform::translation(4, 0));
    ck_assert(edges.compare(picture.view()));
    const bool is = edges.is_candidate(grid.at(2, 3));
    ck_assert_msg(is || !was, "reference %d", n);
    was = is;
  }
  ck_assert(was);
}
END_TEST

// Moving along the bar, every bar looks static.
START_TEST(edges_along_the_motion_are_no_evidence) {
  StaticEdges edges;
  const BlockGrid grid(kSize);
  edges.resize(grid);
  edges.renew(bar(20).view(), 0.04);
  edges.follow(Transform::translation(0, 5));
  ck_assert(edges.compare(bar(20).view()));
  for (std::size_t i = 0; i < grid.count(); ++i) ck_assert_int_eq(edges.fixed(i) + edges.moved(i), 0);
}
END_TEST

START_TEST(a_scene_that_has_hardly_moved_is_no_evidence) {
  StaticEdges edges;
  const BlockGrid grid(kSize);
  edges.resize(grid);
  edges.renew(bar(20).view(), 0.04);
  edges.follow(Transform::translation(2, 0));
  edges.compare(bar(20).view());
  for (std::size_t i = 0; i < grid.count(); ++i) ck_assert_int_eq(edges.fixed(i), 0);
}
END_TEST

START_TEST(blocks_are_found_by_their_sampled_pixels_at_every_size) {
  std::mt19937 random(5);
  for (const Size size : {Size{1, 1}, Size{8, 4}, Size{65, 5}, Size{63, 7}, Size{320, 22}}) {
    Image<std::uint8_t> image(size);
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) image.view().at(x, y) = static_cast<std::uint8_t>(random() % 36);
    const BlockGrid grid(size);
    std::vector<std::uint64_t> bits(2 * static_cast<std::size_t>(grid.words));
    std::vector<std::uint8_t> found(grid.count());
    for (int row = 0; row < grid.rows; ++row) {
      int expected_count = 0;
      const int count = find_blocks(image.view(), 32, grid, row, bits, found.data() + grid.at(0, row));
      for (int column = 0; column < static_cast<int>(grid.stride()); ++column) {
        int above = 0;
        for (int y = 4 * row; y < std::min(4 * row + 4, size.height); y += 2)
          for (int x = 8 * column; x < std::min(8 * column + 8, size.width); ++x)
            above += image.view().at(x, y) > 32;
        ck_assert_int_eq(found[grid.at(column, row)], above > 0);
        expected_count += above > 0;
      }
      ck_assert_int_eq(count, expected_count);
    }
  }
}
END_TEST

int main() {
  return run_suite_on_every_target(
      "static_edges",
      {an_edge_that_stays_while_the_scene_moves_is_static, an_edge_that_moves_with_the_scene_is_not,
       what_was_static_for_long_stays_so, edges_along_the_motion_are_no_evidence,
       a_scene_that_has_hardly_moved_is_no_evidence, blocks_are_found_by_their_sampled_pixels_at_every_size});
}
