// SPDX-License-Identifier: LGPL-2.1-or-later
#include "tracks.h"

#include <set>
#include <vector>

namespace cerberus::bench {
namespace {

constexpr double kLeastOverlap = 0.5;

}  // namespace

std::span<const int> TrackScore::add(std::span<const Person> truth, std::span<const Person> found) {
  const std::size_t n = truth.size(), m = found.size();
  std::vector<double> cost(n * m, vision::Assignment::kForbidden);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < m; ++j) {
      const double overlap = vision::intersection_over_union(truth[i].box, found[j].box);
      if (overlap < kLeastOverlap) continue;
      overlapped_[{truth[i].id, found[j].id}] += 1;
      const auto last = last_.find(truth[i].id);
      const bool kept = last != last_.end() && last->second == found[j].id;
      // A kept pair goes before any other: it is cheaper than all others of a frame together.
      cost[i * m + j] = kept ? 0 : static_cast<double>(n + m) + 1 - overlap;
    }
  const auto partner = assignment_.solve(cost, static_cast<int>(n), static_cast<int>(m));
  double hits = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (partner[i] < 0) continue;
    ++hits;
    const int track = found[static_cast<std::size_t>(partner[i])].id;
    const auto [last, is_new] = last_.try_emplace(truth[i].id, track);
    if (last->second != track) ++switches_;
    last->second = track;
  }
  hits_ += hits;
  missed_ += static_cast<double>(n) - hits;
  extra_ += static_cast<double>(m) - hits;
  return partner;
}

double TrackScore::mota() const {
  const double all = hits_ + missed_;
  return all > 0 ? 1 - (missed_ + extra_ + switches_) / all : 0;
}

double TrackScore::idf1() const {
  std::set<int> people, tracks;
  double most = 0;
  for (const auto& [pair, frames] : overlapped_) {
    people.insert(pair.first), tracks.insert(pair.second);
    most = std::max(most, frames);
  }
  if (people.empty()) return 0;
  const std::vector<int> rows(people.begin(), people.end()), columns(tracks.begin(), tracks.end());
  std::vector<double> frames;
  for (const int person : rows)
    for (const int track : columns) {
      const auto pair = overlapped_.find({person, track});
      frames.push_back(pair == overlapped_.end() ? 0 : pair->second);
    }
  std::vector<double> cost(frames.size());
  for (std::size_t i = 0; i < cost.size(); ++i) cost[i] = most - frames[i];
  vision::Assignment assignment;
  const std::vector<double> unmatched(rows.size(), most);
  const auto partner =
      assignment.solve(cost, static_cast<int>(rows.size()), static_cast<int>(columns.size()), unmatched);
  double right = 0;
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (partner[i] >= 0) right += frames[i * columns.size() + static_cast<std::size_t>(partner[i])];
  return 2 * right / (2 * hits_ + missed_ + extra_);
}

}  // namespace cerberus::bench
