// SPDX-License-Identifier: LGPL-2.1-or-later
// A paved place with people of given appearances, and a tracker of its frames.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "vision/tracking/tracker.h"

namespace cerberus::tests {

using vision::Box;
using vision::GrayView;
using vision::Image;
using vision::Region;
using vision::Sight;
using vision::Size;
using vision::Track;
using vision::Tracker;
using vision::TrackState;
using vision::Transform;

constexpr Size kFrame{320, 240};
constexpr double kWidth = 30, kHeight = 75;

struct Person {
  double x = 0, y = 0;  // centre
  int coat = 0, legs = 0;
  Box box() const { return {x - kWidth / 2, y - kHeight / 2, kWidth, kHeight}; }
};
constexpr int kBlack = 20, kJeans = 80, kGrey = 100, kWhite = 220;

// 10 frames a second of people on a paved place. People who touch are one blob.
struct Place {
  Tracker tracker;
  Image<std::uint8_t> luma{kFrame}, mask{kFrame}, background{kFrame};
  double gain = 1;
  double shift = 0;     // of the camera, so far
  bool looking = true;  // the tracker is given the picture
  std::vector<Track> tracks;

  // The first is drawn last: it stands in front.
  std::span<const Track> step(const std::vector<Person>& people, double pan = 0,
                              std::optional<std::vector<Region>> given = {}) {
    shift += pan;
    for (int y = 0; y < kFrame.height; ++y)
      for (int x = 0; x < kFrame.width; ++x) {
        const int slab = (static_cast<int>(std::floor((x - shift) / 24)) + y / 24) & 1;
        paint(x, y, 130 + 30 * slab);
      }
    for (int y = 0; y < kFrame.height; ++y)
      std::copy_n(luma.view().row(y), kFrame.width, background.view().row(y));
    mask.fill_bytes(0);
    for (auto p = people.rbegin(); p != people.rend(); ++p) {
      const Box b = p->box();
      for (int y = std::max(0, static_cast<int>(b.y)); y < std::min<double>(b.bottom(), kFrame.height); ++y)
        for (int x = std::max(0, static_cast<int>(b.x)); x < std::min<double>(b.right(), kFrame.width); ++x) {
          paint(x, y, y < p->y ? p->coat : p->legs);
          mask.view().at(x, y) = 255;
        }
    }
    const std::vector<Region> regions = given ? *given : blobs(people);
    const Sight sight =
        looking ? Sight{luma.view(), mask.view(), pan == 0 ? GrayView(background.view()) : GrayView{}}
                : Sight{};
    const auto found = tracker.update(regions, pan != 0 ? Transform::translation(pan, 0) : Transform{}, 0.1,
                                      kFrame, {}, sight);
    tracks.assign(found.begin(), found.end());
    return tracks;
  }
  // The track at a place; 0: none.
  std::uint32_t at(double x) const {
    for (const Track& t : tracks)
      if (std::abs(t.box.x + t.box.width / 2 - x) < 12 && t.state == TrackState::seen) return t.id;
    return 0;
  }

 private:
  void paint(int x, int y, int grey) {
    luma.view().at(x, y) = static_cast<std::uint8_t>(std::min(255.0, grey * gain));
  }
  static std::vector<Region> blobs(const std::vector<Person>& people) {
    std::vector<Region> regions;
    for (const Person& p : people) {
      Box b = p.box();
      const double right = std::min<double>(b.right(), kFrame.width);
      b.x = std::max(b.x, 0.0);
      b.width = right - b.x;
      if (b.width < 4) continue;
      bool joined = false;
      for (Region& r : regions) {
        if (overlap_area({r.box.x - 4, r.box.y, r.box.width + 8, r.box.height}, b) <= 0) continue;
        const double x1 = std::max(r.box.right(), b.right()), y1 = std::max(r.box.bottom(), b.bottom());
        r.box.x = std::min(r.box.x, b.x);
        r.box.y = std::min(r.box.y, b.y);
        r.box.width = x1 - r.box.x;
        r.box.height = y1 - r.box.y;
        joined = true;
      }
      if (!joined) regions.push_back({b, b.area(), 0.4, 1});
    }
    return regions;
  }
};

}  // namespace cerberus::tests
