// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/gop_ring.h"

#include <check.h>

#include "support/suite.h"

using namespace cerberus;
using namespace cerberus::record;
using std::chrono::seconds;

namespace {

// A frame a second; each `gop`th is a keyframe.
Unit frame(int second, int gop) {
  Unit unit;
  unit.decode = unit.presentation = seconds(second);
  unit.keyframe = second % gop == 0;
  unit.bytes = 10;
  return unit;
}

GopRing ring_of(int frames, int gop) {
  GopRing ring;
  for (int k = 0; k < frames; ++k) ring.push(frame(k, gop), false);
  return ring;
}

}  // namespace

START_TEST(frames_before_the_first_keyframe_are_dropped_unless_they_continue_a_file) {
  GopRing ring;
  ck_assert(!ring.push(frame(1, 4), false));
  ck_assert(ring.empty());
  ck_assert(ring.push(frame(1, 4), true));
  ck_assert(!ring.keyframe_at(seconds(5)));
  ck_assert(ring.push(frame(4, 4), false));
  ck_assert_uint_eq(*ring.keyframe_at(seconds(5)), 1);
}
END_TEST

START_TEST(a_file_begins_with_the_newest_keyframe_that_is_not_later) {
  const GopRing ring = ring_of(12, 4);  // keyframes 0, 4, 8
  ck_assert_uint_eq(*ring.keyframe_at(seconds(3)), 0);
  ck_assert_uint_eq(*ring.keyframe_at(seconds(4)), 4);
  ck_assert_uint_eq(*ring.keyframe_at(seconds(7)), 4);
  ck_assert_uint_eq(*ring.keyframe_at(seconds(100)), 8);
  ck_assert_uint_eq(*ring.keyframe_at(seconds(-1)), 0);
  ck_assert_uint_eq(*ring.keyframe_from(5), 8);
  ck_assert(!ring.keyframe_from(9));
  ck_assert(!GopRing().keyframe_at(seconds(0)));
}
END_TEST

START_TEST(whole_gops_are_kept_and_no_more_than_are_needed) {
  GopRing ring = ring_of(12, 4);
  ring.keep_from(seconds(7), ring.end());
  ck_assert_uint_eq(ring.begin(), 4);
  ck_assert_uint_eq(ring.bytes(), 80);
  ring.keep_from(seconds(8), ring.end());
  ck_assert_uint_eq(ring.begin(), 8);
  ring.keep_from(seconds(100), ring.end());
  ck_assert_uint_eq(ring.begin(), 8);  // the last GOP always
}
END_TEST

START_TEST(what_lies_behind_the_limit_is_kept) {
  GopRing ring = ring_of(12, 4);
  ring.keep_from(seconds(100), 7);
  ck_assert_uint_eq(ring.begin(), 4);
}
END_TEST

START_TEST(a_gop_is_dropped_with_all_its_bytes) {
  GopRing ring = ring_of(6, 4);
  ring.drop_gop();
  ck_assert_uint_eq(ring.begin(), 4);
  ck_assert_uint_eq(ring.bytes(), 20);
  ring.drop_gop();
  ck_assert(ring.empty());
  ck_assert_uint_eq(ring.bytes(), 0);
}
END_TEST

int main() {
  return tests::run_suite(
      "gop ring", {frames_before_the_first_keyframe_are_dropped_unless_they_continue_a_file,
                   a_file_begins_with_the_newest_keyframe_that_is_not_later,
                   whole_gops_are_kept_and_no_more_than_are_needed, what_lies_behind_the_limit_is_kept,
                   a_gop_is_dropped_with_all_its_bytes});
}
