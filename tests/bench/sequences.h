// SPDX-License-Identifier: LGPL-2.1-or-later
// The sequences with known moving pixels, in the format that the data folder's README describes.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>

#include "counts.h"
#include "frames.h"

namespace cerberus::bench {

struct Sequence {
  const char* name;
  const char* source;            // launch line with one %s for the data folder
  const char* truth;             // multifilesrc's pattern below the data folder
  int first, last;               // numbers of the files of `truth` ...
  int ahead;                     // ... and how many frames come before the first of them
  int positive_from;             // truth values from here on count as moving
  int ignored_from, ignored_to;  // values that are not scored (from > to: none)
  const char* reference;         // F of others, from the data folder's README
};

std::span<const Sequence> sequences();
// A camera follows somebody near, or a vehicle. The references are of the pictures before they were made smaller.
std::span<const Sequence> followed_sequences();
const Sequence& sequence(const std::string& name);
std::string source_of(const Sequence& s, const std::filesystem::path& data);
// The truth from frame `ahead` on, at its own size or at this one, by nearest neighbour.
std::optional<Frames> load_truth(const Sequence& s, const std::filesystem::path& data, int width = 0,
                                 int height = 0);

// Which frame of the truth is scored with frame n of the sequence: none with the first three, nor before it begins.
std::optional<std::size_t> scored_truth(const Sequence& s, const Frames& truth, int n);
// The mask is scaled to the truth by nearest neighbour.
void score(Counts& counts, vision::GrayView mask, vision::GrayView truth, const Sequence& s);

}  // namespace cerberus::bench
