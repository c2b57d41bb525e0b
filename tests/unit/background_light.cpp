// SPDX-License-Identifier: LGPL-2.1-or-later
// The background model keeps the light that it was learnt in until the light has changed for good.
#include "vision/background/background_light.h"

#include <check.h>

#include <algorithm>
#include <cmath>

#include "support/pictures.h"
#include "support/suite.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

constexpr Size kSize{160, 120};
constexpr int kBrightFrom = 120;  // columns of a lamp, too bright for the sensor

// A background model of great age.
struct Model {
  Image<std::uint16_t> mean{kSize};
  Image<std::uint8_t> spread{kSize}, age{kSize}, quiet{kSize}, frame{kSize};
  Mosaic mosaic;
  BackgroundLight light;
  std::vector<RowSpan> visible{static_cast<std::size_t>(kSize.height), RowSpan{0, kSize.width}};

  Model() {
    light.preallocate(kSize);
    light.reset();
    mosaic.preallocate(kSize);
    for (auto* plane : {&spread, &age, &quiet}) plane->fill_bytes(100);
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x)
        mean.view().at(x, y) = static_cast<std::uint16_t>(std::min(scene(x, y), 255) << 8);
  }
  static int scene(int x, int y) {
    static const Scene texture(3, 150);
    return x < kBrightFrom ? std::clamp(static_cast<int>(texture.at(x, y)), 40, 190) : 280;
  }
  // Compares a frame in this light. Returns true if it is a step.
  bool see(double light_now, bool still = true) {
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) frame.view().at(x, y) = to_byte(light_now * scene(x, y));
    light.load(mean.view());
    return light.compensate({mean.view(), spread.view(), age.view(), quiet.view()}, mosaic, frame.view(),
                            visible, still);
  }
  // Pixels without age are learnt from the frame, as the model does.
  void learn_missing() {
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) {
        if (age.view().at(x, y)) continue;
        mean.view().at(x, y) = static_cast<std::uint16_t>(frame.view().at(x, y) << 8);
        age.view().at(x, y) = 1;
      }
  }
  // The largest difference between frame and background where the model has an age, grey levels.
  int off() {
    int most = 0;
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x)
        if (age.view().at(x, y))
          most = std::max(most, std::abs(light.background().at(x, y) - frame.view().at(x, y)));
    return most;
  }
};

}  // namespace

START_TEST(a_change_of_light_is_compensated_and_white_pixels_lose_their_age) {
  for (const double light : {0.85, 0.9, 1.1, 1.2}) {
    Model m;
    m.see(light);
    ck_assert_msg(m.off() <= 3, "in a light of %g it is %d off", light, m.off());
  }
}
END_TEST

START_TEST(a_frame_is_learnt_in_the_light_of_the_model) {
  for (const double light : {0.85, 1.0, 1.15}) {
    Model m;
    m.see(light);
    for (int y = 0; y < kSize.height; y += 7) {
      const std::uint8_t* row = m.light.in_background_light(y, m.frame.view().row(y));
      for (int x = 0; x < kBrightFrom; ++x) ck_assert_int_le(std::abs(row[x] - Model::scene(x, y)), 3);
      if (light >= 1) ck_assert_int_ge(row[kBrightFrom], 250);  // white stays white
    }
  }
  Model m;
  m.see(1.15);
  m.light.reset();  // a new scene starts with its own light
  ck_assert_ptr_eq(m.light.in_background_light(5, m.frame.view().row(5)), m.frame.view().row(5));
}
END_TEST

// The light changes by less than a step a frame until the model adopts it. No frame is compared wrongly, and white pixels
// keep their age like all others.
START_TEST(a_light_that_fades_slowly_causes_no_difference) {
  Model m;
  for (double light = 1; light > 0.6; light -= 0.02) {
    ck_assert(!m.see(light));
    ck_assert_msg(m.off() <= 3, "in a light of %g it is %d off", light, m.off());
    m.learn_missing();
  }
  ck_assert_int_lt(m.mean.view().at(10, 10) >> 8, Model::scene(10, 10) * 3 / 4);  // it was adopted
}
END_TEST

// Before the camera moves the light is adopted, and the next frame compared.
START_TEST(a_camera_that_starts_to_move_in_another_light_sees_no_difference) {
  Model m;
  m.see(0.85);
  ck_assert(m.light.is_different());
  m.light.adopt({m.mean.view(), m.spread.view(), m.age.view(), m.quiet.view()}, m.mosaic);
  ck_assert(!m.light.is_different());
  m.see(0.85, false);
  ck_assert_msg(m.off() <= 3, "it is %d off", m.off());
  ck_assert_int_gt(m.age.view().at(10, 10), 0);  // pixels that were not white keep their age
}
END_TEST

// Bands of lamp light prevent alignment: they are removed for it, and the change of light is not recorded.
START_TEST(for_alignment_each_row_is_compared_in_its_own_light) {
  Model m;
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x)
      m.frame.view().at(x, y) = to_byte((1 + 0.08 * std::sin(y / 22.0)) * Model::scene(x, y));
  m.light.load(m.mean.view());
  const int before = m.off();
  m.light.relight_rows(m.frame.view(), m.visible);
  ck_assert_int_gt(before, 12);
  ck_assert_msg(m.off() <= 5, "it is %d off", m.off());
  ck_assert_ptr_eq(m.light.in_background_light(28, m.frame.view().row(28)), m.frame.view().row(28));
  ck_assert(!m.light.is_different());
}
END_TEST

int main() {
  return run_suite("background_light", {a_change_of_light_is_compensated_and_white_pixels_lose_their_age,
                                        a_frame_is_learnt_in_the_light_of_the_model,
                                        a_light_that_fades_slowly_causes_no_difference,
                                        a_camera_that_starts_to_move_in_another_light_sees_no_difference,
                                        for_alignment_each_row_is_compared_in_its_own_light});
}
