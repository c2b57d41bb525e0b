// SPDX-License-Identifier: LGPL-2.1-or-later
// A trail as a line that thins out and fades with age, in patches of bounded size.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "overlay/picture.h"
#include "overlay/trails.h"

namespace cerberus::overlay {

class TrailLine {
 public:
  struct Style {
    double time = 0;      // s, of this frame
    double duration = 2;  // s, after which the line has faded
    double line = 1;      // width at the newest end, pixels
  };

  // Appends the patches of the trail within `frame`. The foot of a measured box jitters by pixels: the line follows a
  // centred mean over up to seven points (the ends stay), and skips points that are closer than its width.
  void draw(const Trails::Trail& trail, const Style& style, Area frame, PicturePool& pool,
            std::vector<Patch>& patches);

 private:
  void smooth(std::span<const TrailPoint> points, double line);
  void draw_part(std::uint32_t id, const Style& style, Area area, std::size_t first, std::size_t last,
                 vision::View<std::uint32_t> picture);

  std::vector<TrailPoint> points_;  // smoothed
  std::vector<float> depth_;        // a pixel's depth inside the nearest stretch, and
  std::vector<float> strength_;     // the strength of that (0: of another patch); of the patch at hand
};

}  // namespace cerberus::overlay
