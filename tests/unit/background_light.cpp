// SPDX-License-Identifier: LGPL-2.1-or-later
// The memory keeps the light it was learnt in, whatever the light of the frame is, until that has changed for good.
#include "vision/background/background_light.h"

#include <check.h>

#include <cmath>

#include "support/pictures.h"
#include "support/suite.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

constexpr Size kSize{160, 120};
constexpr int kBrightFrom = 120;  // columns of a lamp, too bright for the sensor

// A memory that has known its scene for long.
struct Memory {
  Image<std::uint16_t> mean{kSize};
  Image<std::uint8_t> spread{kSize}, age{kSize}, quiet{kSize}, present{kSize};
  Mosaic surroundings;
  BackgroundLight light;
  std::vector<RowSpan> shown{static_cast<std::size_t>(kSize.height), RowSpan{0, kSize.width}};

  Memory() {
    light.preallocate(kSize);
    light.begin();
    surroundings.preallocate(kSize);
    for (auto* plane : {&spread, &age, &quiet}) plane->fill_bytes(100);
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x)
        mean.view().at(x, y) = static_cast<std::uint16_t>(std::min(scene(x, y), 255) << 8);
  }
  static int scene(int x, int y) {
    static const Scene texture(3, 150);
    return x < kBrightFrom ? std::clamp(static_cast<int>(texture.at(x, y)), 40, 190) : 280;
  }
  // The frame in this light. True if it is a step.
  bool see(double light_now, bool still = true) {
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) present.view().at(x, y) = to_byte(light_now * scene(x, y));
    light.draw(mean.view());
    return light.compensate({mean.view(), spread.view(), age.view(), quiet.view()}, surroundings,
                            present.view(), shown, still);
  }
  // What nobody knows is learnt from the frame, as the memory does.
  void learn_unknown() {
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) {
        if (age.view().at(x, y)) continue;
        mean.view().at(x, y) = static_cast<std::uint16_t>(present.view().at(x, y) << 8);
        age.view().at(x, y) = 1;
      }
  }
  // Most grey levels that the memory, as it is compared, is off anywhere where it knows.
  int off() {
    int most = 0;
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x)
        if (age.view().at(x, y))
          most = std::max(most, std::abs(light.known().at(x, y) - present.view().at(x, y)));
    return most;
  }
};

}  // namespace

START_TEST(another_light_is_taken_out_and_what_was_white_may_be_anything_from_there_on) {
  for (const double light : {0.85, 0.9, 1.1, 1.2}) {
    Memory m;
    m.see(light);
    ck_assert_msg(m.off() <= 3, "in a light of %g it is %d off", light, m.off());
  }
}
END_TEST

START_TEST(what_is_remembered_of_a_frame_is_in_the_memorys_light) {
  for (const double light : {0.85, 1.0, 1.15}) {
    Memory m;
    m.see(light);
    for (int y = 0; y < kSize.height; y += 7) {
      const std::uint8_t* row = m.light.remembered(y, m.present.view().row(y));
      for (int x = 0; x < kBrightFrom; ++x) ck_assert_int_le(std::abs(row[x] - Memory::scene(x, y)), 3);
      if (light >= 1) ck_assert_int_ge(row[kBrightFrom], 250);  // white stays white
    }
  }
  Memory m;
  m.see(1.15);
  m.light.begin();  // another scene has no light but its own
  ck_assert_ptr_eq(m.light.remembered(5, m.present.view().row(5)), m.present.view().row(5));
}
END_TEST

// By less than a step a frame, until the memory itself takes the light over: no frame is compared wrongly, and whatever
// the light does afterwards white is no less known than everything else.
START_TEST(a_light_that_goes_away_slowly_is_never_seen) {
  Memory m;
  for (double light = 1; light > 0.6; light -= 0.02) {
    ck_assert(!m.see(light));
    ck_assert_msg(m.off() <= 3, "in a light of %g it is %d off", light, m.off());
    m.learn_unknown();
  }
  ck_assert_int_lt(m.mean.view().at(10, 10) >> 8, Memory::scene(10, 10) * 3 / 4);  // it was taken over
}
END_TEST

// Before the camera moves the light is adopted, and the next frame compared.
START_TEST(a_camera_that_begins_to_move_in_another_light_finds_nothing_wrong) {
  Memory m;
  m.see(0.85);
  ck_assert(m.light.is_other());
  m.light.adopt({m.mean.view(), m.spread.view(), m.age.view(), m.quiet.view()}, m.surroundings);
  ck_assert(!m.light.is_other());
  m.see(0.85, false);
  ck_assert_msg(m.off() <= 3, "it is %d off", m.off());
  ck_assert_int_gt(m.age.view().at(10, 10), 0);  // what was not white is still known
}
END_TEST

// Lamps' light in bands, under which nothing can be aligned: taken out for that, and not measured.
START_TEST(what_is_to_be_aligned_is_compared_in_the_light_of_each_row) {
  Memory m;
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x)
      m.present.view().at(x, y) = to_byte((1 + 0.08 * std::sin(y / 22.0)) * Memory::scene(x, y));
  m.light.draw(m.mean.view());
  const int before = m.off();
  m.light.relight_rows(m.present.view(), m.shown);
  ck_assert_int_gt(before, 12);
  ck_assert_msg(m.off() <= 5, "it is %d off", m.off());
  ck_assert_ptr_eq(m.light.remembered(28, m.present.view().row(28)), m.present.view().row(28));
  ck_assert(!m.light.is_other());
}
END_TEST

int main() {
  return run_suite(
      "scene_light",
      {another_light_is_taken_out_and_what_was_white_may_be_anything_from_there_on,
       what_is_remembered_of_a_frame_is_in_the_memorys_light, a_light_that_goes_away_slowly_is_never_seen,
       a_camera_that_begins_to_move_in_another_light_finds_nothing_wrong,
       what_is_to_be_aligned_is_compared_in_the_light_of_each_row});
}
