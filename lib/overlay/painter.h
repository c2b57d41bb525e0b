// SPDX-License-Identifier: LGPL-2.1-or-later
// Draws a scene in patches, one or a few for each object: the cost is that of the drawn pixels, whatever the size of
// the frame. The pictures of unchanged labels, boxes and of the unchanged panel are reused from frame to frame.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "overlay/marks/labels.h"
#include "overlay/marks/outline.h"
#include "overlay/marks/system_panel.h"
#include "overlay/marks/trail_line.h"
#include "overlay/picture.h"
#include "overlay/scene.h"

namespace cerberus::overlay {

// Returns a readable line width for a frame of this size, pixels: 1.3 at 240 rows, 6 at 2160.
double automatic_line_width(vision::Size frame);

class Painter {
 public:
  // Appends the scene's patches in the order of drawing.
  void paint(const Scene& scene, std::vector<Patch>& patches);
  // Drops all pictures of earlier frames.
  void reset();

 private:
  struct Box {
    Object object;  // as it was drawn
    bool used = false;
    std::vector<Patch> patches;
  };
  void paint_box(const Object& object, std::vector<Patch>& patches);
  void draw_box(const Object& object, std::vector<Patch>& patches);
  void paint_label(const Object& object, std::vector<Patch>& patches);
  void paint_crosshair(std::vector<Patch>& patches);
  bool is_free(const Area& area) const;

  const Scene* scene_ = nullptr;  // during paint()
  Area frame_;
  double line_ = 1, font_ = 10;
  PicturePool pool_;
  Labels labels_;
  TrailLine trail_line_;
  SystemPanel panel_;
  Patch crosshair_;
  std::unordered_map<std::uint32_t, Box> boxes_;  // by identity
  std::vector<Area> taken_;                       // by labels of this frame
  std::vector<Object> objects_;                   // clipped to the frame
};

}  // namespace cerberus::overlay
