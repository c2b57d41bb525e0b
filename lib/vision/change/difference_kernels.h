// SPDX-License-Identifier: LGPL-2.1-or-later
// Inner loops of the differences, chosen for the processor at run time.
#pragma once

#include <array>
#include <cstdint>

namespace cerberus::vision {

// out[x] = |a[x] - b[x]| (Eq. 2).
void difference_row(const std::uint8_t* a, const std::uint8_t* b, int count, std::uint8_t* out);

// out[x] = how far a[x] is outside the levels of the nine neighbours of x in three rows, whose pixels -1 and `count` are
// read too.
void tolerant_difference_row(const std::uint8_t* a, const std::uint8_t* above, const std::uint8_t* row,
                             const std::uint8_t* below, int count, std::uint8_t* out);

// Counts grey levels. Nearly all of a difference is noise: the lowest levels are counted by comparing whole vectors,
// the others one by one.
class LevelCounter {
 public:
  void add(const std::uint8_t* row, int count);
  void store(std::array<std::uint32_t, 256>& histogram);

  static constexpr int kNear = 8, kLanes = 64;
  struct Counts {
    alignas(64) std::array<std::array<std::uint8_t, kLanes>, kNear> near{};  // by lane of the vector
    int vectors = 0;                                                         // since `near` was emptied
    std::array<std::uint32_t, 256> levels{};
    void empty_near();
  };

 private:
  Counts counts_;
};

}  // namespace cerberus::vision
