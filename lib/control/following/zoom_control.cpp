// SPDX-License-Identifier: LGPL-2.1-or-later
#include "control/following/zoom_control.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cerberus::control {

namespace {

// Of the picture's height: a box that ends nearer to its upper or lower edge is cut by it. derived: three lines of 360, by
// which boxes of motion are off
constexpr double kEdge = .008;

ZoomKeeper::Sight sight_of(const fusion::Track& track, const vision::Size& picture, double field_of_view) {
  const double width = picture.width, height = picture.height;
  const double right = (track.x + track.width / 2) / (width / 2) - 1;
  const double down = (track.y + track.height / 2) / (height / 2) - 1;
  return {.height = track.height / height,
          .whole = track.y > kEdge * height && track.y + track.height < (1 - kEdge) * height,
          .off = std::max(std::abs(right), std::abs(down)),
          .field_of_view = field_of_view};
}

}  // namespace

std::optional<double> ZoomControl::on_frame(double taken, const Goal& goal,
                                            std::span<const fusion::Track> tracks,
                                            const vision::Size& picture, double field_of_view) {
  if (table_.empty() || picture.width <= 0 || picture.height <= 0) return std::nullopt;
  std::optional<ZoomKeeper::Sight> sight;
  if (goal.action == fusion::Action::track) {
    if (std::exchange(track_, goal.track) != goal.track) keeper_.reset();
    const auto target = std::ranges::find(tracks, goal.track, &fusion::Track::id);
    if (target != tracks.end() && target->state != fusion::TrackState::coasted)
      sight = sight_of(*target, picture, field_of_view);
  }
  constexpr double kLongest = 1;  // of the lens: beyond it a digital zoom shows nothing more
  const auto view = keeper_.update(taken, sight, {table_.field_of_view(0), table_.field_of_view(kLongest)});
  return view ? std::optional(table_.position_for(*view)) : std::nullopt;
}

}  // namespace cerberus::control
