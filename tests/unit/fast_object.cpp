// SPDX-License-Identifier: LGPL-2.1-or-later
// The complete chain on an ellipse that crosses the picture within .6 s: its box follows without lag.
#include <algorithm>
#include <cmath>
#include <vector>

#include "support/chain.h"
#include "support/pictures.h"
#include "support/suite.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

constexpr Size kSize{1280, 720};
constexpr double kWidth = 60, kHeight = 40;  // of the ellipse, pixels
constexpr double kSpeed = 2000;              // pixels a second, to the right
constexpr double kMostOff = kWidth / 10;     // pixels between the middles of ellipse and box
constexpr int kAlone = 100;                  // frames of the scene before it comes
constexpr int kMostTurn = 12;                // columns by which the camera goes on from frame to frame
// Columns of the scene left and right of the view in which it comes: the camera has turned for as long before.
constexpr int kBeyond = kAlone * kMostTurn;

// The scene is wider than the picture, so that a camera can turn along it.
struct Wall {
  Wall() : pixels(static_cast<std::size_t>(kColumns) * kSize.height) {
    const Scene scene(3, 25);
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kColumns; ++x)
        pixels[static_cast<std::size_t>(y) * kColumns + x] = to_byte(scene.at(x, y));
  }
  static constexpr int kColumns = kSize.width + 2 * kBeyond;
  std::vector<std::uint8_t> pixels;
};

// The view from this column of the wall, with the ellipse's middle at (x, the picture's middle).
void draw(const Wall& wall, int column, double x, std::vector<std::uint8_t>& picture) {
  static const Scene coat(9, 30);
  const auto row = [&](int y) { return &picture[static_cast<std::size_t>(y) * kSize.width]; };
  for (int y = 0; y < kSize.height; ++y)
    std::copy_n(&wall.pixels[static_cast<std::size_t>(y) * Wall::kColumns + column], kSize.width, row(y));
  const double middle = kSize.height / 2.0;
  const int left = std::max(0, static_cast<int>(x - kWidth / 2)),
            right = std::min(kSize.width, static_cast<int>(x + kWidth / 2) + 1);
  for (int y = static_cast<int>(middle - kHeight / 2); y < middle + kHeight / 2; ++y)
    for (int c = left; c < right; ++c)
      if (std::hypot((c + 0.5 - x) / (kWidth / 2), (y + 0.5 - middle) / (kHeight / 2)) < 1)
        row(y)[c] = to_byte(coat.at(c - x, y - middle) + 70);
}

struct Followed {
  int whole = 0;            // frames in which all of the ellipse is in the picture
  std::vector<double> off;  // pixels by which the nearest box is off in those that have any track
};

// turn: columns of the wall by which the camera goes on from frame to frame.
Followed follow(const Wall& wall, double rate, int turn) {
  Chain chain;
  chain.set_burnt_in(true);  // as motiondetect has it
  Followed followed;
  std::vector<std::uint8_t> picture(static_cast<std::size_t>(kSize.area()));
  const double step = kSpeed / rate;
  for (int k = 0;; ++k) {
    const double x = -kWidth + step * (k - kAlone);
    if (x > kSize.width - kWidth / 2) return followed;
    draw(wall, kBeyond + turn * (k - kAlone), x, picture);
    LumaSource source;
    source.data = picture.data(), source.width = kSize.width, source.height = kSize.height,
    source.stride = kSize.width;
    chain.step(source, 1 / rate);
    if (x < kWidth / 2) continue;
    ++followed.whole;
    double least = kSize.width;
    for (const Track& t : chain.tracks())
      least = std::min(
          least, std::hypot(t.box.x + t.box.width / 2 - x, t.box.y + t.box.height / 2 - kSize.height / 2.0));
    if (!chain.tracks().empty()) followed.off.push_back(least);
  }
}

}  // namespace

// It is published .2 s after it has been seen for the first time; the box of its first frame may still be of a part.
START_TEST(an_ellipse_of_2000_pixels_a_second_is_boxed_within_a_tenth_of_its_length) {
  const Wall wall;
  for (const double rate : {25.0, 30.0, 60.0})
    for (const int turn : {0, 6, -kMostTurn}) {
      const Followed f = follow(wall, rate, turn);
      ck_assert_msg(2 * f.off.size() > static_cast<std::size_t>(f.whole),
                    "%g frames a second, turning by %d: seen in %zu of %d frames", rate, turn, f.off.size(),
                    f.whole);
      const double worst = *std::max_element(f.off.begin() + 1, f.off.end());
      ck_assert_msg(worst <= kMostOff, "%g frames a second, turning by %d: off by %.1f pixels", rate, turn,
                    worst);
    }
}
END_TEST

int main() {
  return run_suite("fast_object", {an_ellipse_of_2000_pixels_a_second_is_boxed_within_a_tenth_of_its_length},
                   300);  // s; half a minute under the sanitizers where nothing else runs
}
