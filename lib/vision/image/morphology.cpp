// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/image/morphology.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "vision/image/mask_kernels.h"

namespace cerberus::vision {

namespace {

using Word = std::uint64_t;

// Unites a row with itself moved by -radius .. +radius, radius at most 64; the reach doubles with every step. Bits
// shifted in from a neighbouring word need to be correct only as far as the reach. Most words
// are full, or empty between empty neighbours, and are skipped.
void spread_row(Word* row, int words, int radius) {
  Word before = 0;  // the word to the left before it was changed
  for (int i = 0; i < words; ++i) {
    const Word here = row[i], after = i + 1 < words ? row[i + 1] : 0;
    if (~here && (here | before | after)) {
      Word up = here, from_below = before, down = here, from_above = after;
      for (int reach = 0; reach < radius;) {
        const int step = std::min(reach + 1, radius - reach);  // at most 32
        up |= up << step | from_below >> (64 - step);
        from_below |= from_below << step;
        down |= down >> step | from_above << (64 - step);
        from_above |= from_above >> step;
        reach += step;
      }
      row[i] = up | down;
    }
    before = here;
  }
}

// Unites rows with their neighbours up to `radius` rows away, the reach doubling: first upwards, then downwards.
void spread_columns(MutableBitView bits, int radius) {
  const auto words = [&](int rows) { return static_cast<std::size_t>(rows) * bits.width; };
  const auto spread = [&](auto&& unite) {
    for (int reach = 0; reach < radius;) {
      const int step = std::min(reach + 1, radius - reach);
      if (step < bits.height) unite(bits.data, words(bits.height - step), words(step));
      reach += step;
    }
  };
  spread(unite_with_later);
  spread(unite_with_earlier);
}

void clear_beyond(MutableBitView bits, int width) {
  const Word last = last_word_bits(width);
  for (int y = 0; y < bits.height; ++y) bits.row(y)[bits.width - 1] &= last;
}

void invert(MutableBitView bits, int width) {
  for (long i = 0; i < bits.size().area(); ++i) bits.data[i] = ~bits.data[i];
  clear_beyond(bits, width);
}

// Seeds every run of `within` that holds a seed: the sum of seed and run carries a 1 through the rest of the run, and
// the changed bits are the run from the seed upwards. The other direction is done by shifting. Returns whether the row
// grew.
bool fill_runs(Word* seeds, const Word* within, int words) {
  bool grew = false;
  Word carry = 0;  // 1 when a seeded run continues from the word below
  for (int i = 0; i < words; ++i) {
    const Word mask = within[i];
    Word seed = (seeds[i] | carry) & mask;
    const Word sum = mask + seed;
    Word filled = (seed | (mask & (sum ^ mask))) & mask;
    // Towards lower x inside the word, by doubling.
    Word room = mask;
    for (int step = 1; step < 64; step *= 2) {
      filled |= room & (filled >> step);
      room &= room >> step;
    }
    grew |= filled != seeds[i];
    seeds[i] = filled;
    carry = filled >> 63;
  }
  for (int i = words - 2; i >= 0; --i) {  // runs that reach down over a word's edge
    Word filled = seeds[i];
    if (!(seeds[i + 1] & 1) || !(within[i] >> 63) || (filled >> 63)) continue;
    Word room = within[i];
    filled |= Word{1} << 63;
    for (int step = 1; step < 64; step *= 2) {
      filled |= room & (filled >> step);
      room &= room >> step;
    }
    grew |= filled != seeds[i];
    seeds[i] = filled;
  }
  return grew;
}

// Adds to a row's seeds the pixels of `within` that touch the neighbouring row's seeds (8-connected).
bool take_over(Word* row, const Word* neighbour, const Word* within, Word* scratch, int words) {
  Word any = 0;
  for (int i = 0; i < words; ++i) {
    Word reach = neighbour[i] | neighbour[i] << 1 | neighbour[i] >> 1;
    if (i > 0) reach |= neighbour[i - 1] >> 63;
    if (i + 1 < words) reach |= neighbour[i + 1] << 63;
    scratch[i] = reach & within[i] & ~row[i];
    any |= scratch[i];
  }
  if (!any) return false;
  for (int i = 0; i < words; ++i) row[i] |= scratch[i];
  fill_runs(row, within, words);
  return true;
}

// Sweeps down and up until nothing grows: a spiral needs many sweeps, ordinary shapes two or three.
void grow(MutableBitView seeds, BitView within, Word* scratch) {
  for (int y = 0; y < seeds.height; ++y) fill_runs(seeds.row(y), within.row(y), seeds.width);
  for (bool changed = true; changed;) {
    changed = false;
    for (int y = 1; y < seeds.height; ++y)
      changed |= take_over(seeds.row(y), seeds.row(y - 1), within.row(y), scratch, seeds.width);
    for (int y = seeds.height - 2; y >= 0; --y)
      changed |= take_over(seeds.row(y), seeds.row(y + 1), within.row(y), scratch, seeds.width);
  }
}

}  // namespace

void Morphology::dilate(MutableBitView bits, int width, int side) {
  if (side / 2 < 1 || bits.empty()) return;
  for (int y = 0; y < bits.height; ++y)
    for (int radius = side / 2; radius > 0; radius -= 64)
      spread_row(bits.row(y), bits.width, std::min(radius, 64));
  clear_beyond(bits, width);
  spread_columns(bits, side / 2);
}

void Morphology::erode(MutableBitView bits, int width, int side) {
  if (side / 2 < 1 || bits.empty()) return;
  invert(bits, width);
  dilate(bits, width, side);
  invert(bits, width);
}

void Morphology::close(MutableBitView bits, int width, int side) {
  dilate(bits, width, side);
  erode(bits, width, side);
}

void Morphology::open(MutableBitView bits, int width, int side) {
  erode(bits, width, side);
  dilate(bits, width, side);
}

// Counts by bit-sliced addition: three bits of sum for each row's triple, then the column's.
void Morphology::vote(MutableBitView bits, int width, int least) {
  if (bits.empty()) return;
  scratch_.resize({bits.width, 2});
  const auto copy = [&](int y, Word* to) {
    std::memcpy(to, bits.row(y), static_cast<std::size_t>(bits.width) * sizeof(Word));
  };
  // The row above and this one before they were changed.
  Word *above = scratch_.view().row(0), *here = scratch_.view().row(1);
  copy(0, here);
  for (int y = 0; y < bits.height; ++y) {
    const Word* const rows[] = {here, y > 0 ? above : nullptr,
                                y + 1 < bits.height ? bits.row(y + 1) : nullptr};
    for (int i = 0; i < bits.width; ++i) {
      if (here[i] == 0) continue;  // most words are empty; vote() only keeps pixels that are set
      Word ones = 0, twos = 0, fours = 0, eights = 0;
      const auto add = [&](Word value) {
        Word carry = ones & value;
        ones ^= value;
        Word next = twos & carry;
        twos ^= carry;
        carry = fours & next;
        fours ^= next;
        eights |= carry;
      };
      for (const Word* row : rows) {
        if (!row) continue;
        add(row[i]);
        add(row[i] << 1 | (i > 0 ? row[i - 1] >> 63 : 0));
        add(row[i] >> 1 | (i + 1 < bits.width ? row[i + 1] << 63 : 0));
      }
      Word keep = 0;
      for (int n = std::max(least, 0); n <= 9; ++n) {
        const auto is = [](Word slice, int bit) { return bit ? slice : ~slice; };
        keep |= is(ones, n & 1) & is(twos, n >> 1 & 1) & is(fours, n >> 2 & 1) & is(eights, n >> 3 & 1);
      }
      bits.row(y)[i] = keep & here[i];
    }
    std::swap(above, here);
    if (y + 1 < bits.height) copy(y + 1, here);
  }
  clear_beyond(bits, width);
}

void Morphology::reconstruct(MutableBitView seeds, BitView within) {
  if (seeds.empty()) return;
  scratch_.resize({seeds.width, 2});
  intersect(seeds, within, seeds);
  grow(seeds, within, scratch_.view().row(0));
}

namespace {

void extreme_reference(GrayView mask, int side, MutableGrayView out, bool largest) {
  const int radius = side / 2;
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x) {
      bool found = false;
      for (int v = std::max(y - radius, 0); v <= std::min(y + radius, mask.height - 1); ++v)
        for (int u = std::max(x - radius, 0); u <= std::min(x + radius, mask.width - 1); ++u)
          found |= (mask.at(u, v) != 0) == largest;
      out.at(x, y) = found == largest ? 255 : 0;
    }
}

}  // namespace

void dilate_reference(GrayView mask, int side, MutableGrayView out) {
  extreme_reference(mask, side, out, true);
}
void erode_reference(GrayView mask, int side, MutableGrayView out) {
  extreme_reference(mask, side, out, false);
}

}  // namespace cerberus::vision
