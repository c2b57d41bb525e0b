// SPDX-License-Identifier: LGPL-2.1-or-later
// The complete chain, with a person present when a scene begins: the memory has the person's picture, and the place
// that he leaves is no region.
#include <algorithm>
#include <cmath>
#include <functional>

#include "support/room.h"
#include "support/suite.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

// The room, with a table on one dark leg where he stands.
float room_with_a_table(int x, int y) {
  if (y >= 96 && y < 102 && x >= 130 && x < 190) return 215;
  if (y >= 102 && y < 172 && x >= 158 && x < 162) return 40;
  return room(x, y);
}

// His head, a coat that is nearly as bright as the wall, trousers.
float person(int x, int y) {
  if (y < 14) return x >= 9 && x < 21 ? 50 : -1;
  return y < 52 ? 172 : 55;
}
constexpr int kWidth = 30, kHeight = 90;

struct Seen {
  int right = 0;  // frames with a region on him
  int wrong = 0;  // regions that are not on him
  int empty = 0;  // frames with a region in the empty room
};

// left_of: where he is in each frame. Counted from frame `from` on.
Seen watch(int frames, int from, const std::function<double(int)>& left_of) {
  constexpr int kTop = 85;
  RoomCamera camera;
  Seen seen;
  for (int k = 0; k < frames; ++k) {
    const int left = static_cast<int>(std::lround(left_of(k)));
    const Chain& chain = camera.see([left](int x, int y) {
      const bool inside = x >= left && x < left + kWidth && y >= kTop && y < kTop + kHeight;
      const float he = inside ? person(x - left, y - kTop) : -1;
      return he < 0 ? room_with_a_table(x, y) : he;
    });
    if (k < from) continue;
    const Box him{static_cast<double>(left), kTop, kWidth, kHeight};
    bool right = false;
    for (const Region& r : chain.regions()) {
      const bool on_him = overlap_area(r.box, him) > 0;
      right = right || on_him;
      seen.wrong += !on_him;
    }
    seen.right += right;
    seen.empty += left >= RoomCamera::kSize.width && !chain.regions().empty();
  }
  return seen;
}

}  // namespace

// At 4 pixels a frame he has gone as far as two pairs of the floor's boards when nine frames are over: they look as if
// they went along.
START_TEST(the_place_of_a_person_present_since_the_start_is_no_region) {
  struct Case {
    int stood;     // frames
    double speed;  // pixels a frame at which he leaves ...
    double aside;  // ... by as many pixels, or out of the picture
  };
  for (const Case& c : {Case{60, 1, 50},
                        {240, 1, 400},
                        {120, 2, 90},
                        {120, 2, 400},
                        {240, 2, 400},
                        {30, 4, 400},
                        {60, 4, 90}}) {
    const Seen seen = watch(c.stood + 180, 0, [&](int k) {
      return 145 + std::min(c.aside, c.speed * std::max(0, k - c.stood)) + std::sin(k / 5.0);
    });
    ck_assert_msg(seen.wrong == 0 && seen.empty == 0,
                  "stood %d frames, left at %.0f: %d regions wrong, %d frames in the empty room", c.stood,
                  c.speed, seen.wrong, seen.empty);
    ck_assert_msg(seen.right >= 40, "seen in only %d frames", seen.right);
  }
}
END_TEST

int main() {
  return run_suite("places", {the_place_of_a_person_present_since_the_start_is_no_region}, 60);
}
