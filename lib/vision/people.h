// SPDX-License-Identifier: LGPL-2.1-or-later
// A patch of moving pixels explained by as few standing people of known height as possible: fragments of one person
// come together and people side by side come apart by the same rule.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "vision/height_prior.h"
#include "vision/mask.h"
#include "vision/regions.h"

namespace cerberus::vision {

// Part of the picture: columns and rows from (left, top) up to but not including (right, bottom).
struct Window {
  int left = 0, top = 0, right = 0, bottom = 0;
  int width() const { return right - left; }
  int height() const { return bottom - top; }
};

struct Person {
  Box box;  // of the expected height and width, may leave the picture
  double score =
      0;  // evidence per pixel of the box; about 1 for a whole person seen well, kLeastScore at least
};

class PeopleFinder {
 public:
  // pixels: one bit a pixel of the picture. Looks at the window only. Returns nobody when the prior does not know the
  // heights there, or the window is too large to be judged. Deterministic; the span lives until the next call.
  std::span<const Person> find(BitView pixels, Size picture, const Window& window, const HeightPrior& prior);

  std::size_t bytes() const { return sums_.capacity() * sizeof(std::uint32_t); }

 private:
  struct Candidate {
    int left, top, right, bottom;  // picture pixels, may leave it
    double score;                  // log likelihood gained, less the price of a person
    double per_pixel;
  };
  void add_up(BitView pixels);
  std::uint32_t sum(int left, int top, int right, int bottom) const;
  Candidate judge(int left, int foot, double height) const;
  Candidate best(int from, int to) const;
  double explain(BitView pixels, bool from_the_left);
  void settle(BitView pixels);

  Size picture_;
  Window window_;
  const HeightPrior* prior_ = nullptr;
  std::vector<std::uint32_t> sums_;
  std::vector<Candidate> chosen_, other_;
  std::vector<Person> people_;
};

}  // namespace cerberus::vision
