// SPDX-License-Identifier: LGPL-2.1-or-later
#include "hidden_people.h"

#include <algorithm>

namespace cerberus::bench {
namespace {

constexpr double kHiddenFor = 3;  // s, issue: who was hidden for so long is the same
constexpr double kAround = 1;     // s before and after it in which the person must be matched to be judged

}  // namespace

bool is_covered(const Person& person, std::span<const Person> all) {
  constexpr int kSamples = 20;
  int behind = 0;
  for (int y = 0; y < kSamples; ++y)
    for (int x = 0; x < kSamples; ++x) {
      const double px = person.box.x + (x + 0.5) * person.box.width / kSamples;
      const double py = person.box.y + (y + 0.5) * person.box.height / kSamples;
      behind += std::ranges::any_of(all, [&](const Person& o) {
        return o.id != person.id && o.box.bottom() > person.box.bottom() && px >= o.box.x &&
               px < o.box.right() && py >= o.box.y && py < o.box.bottom();
      });
    }
  return 2 * behind > kSamples * kSamples;
}

HiddenPeople hidden_people(const Lives& lives, double frame) {
  HiddenPeople result;
  for (const auto& [id, life] : lives)
    for (std::size_t i = 1; i < life.size(); ++i) {
      const bool gap = life[i].time - life[i - 1].time > 1.5 * frame;
      if (life[i - 1].hidden || (!life[i].hidden && !gap)) continue;
      std::size_t end = i;
      while (end < life.size() && life[end].hidden) ++end;
      if (end == life.size()) break;
      const double from = life[i - 1].time, to = life[end].time;
      if (to - from > kHiddenFor) continue;
      int before = -1, after = -1;
      for (std::size_t k = 0; k < i; ++k)
        if (life[k].track >= 0 && from - life[k].time <= kAround) before = life[k].track;
      for (std::size_t k = end; k < life.size() && after < 0 && life[k].time - to <= kAround; ++k)
        after = life[k].track;
      if (before < 0) continue;
      ++result.asked;
      result.kept += before == after;
      i = end;
    }
  return result;
}

}  // namespace cerberus::bench
