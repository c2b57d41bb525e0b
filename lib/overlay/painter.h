// SPDX-License-Identifier: LGPL-2.1-or-later
// What motionoverlay draws, as cairo pictures: knows no GStreamer. Everything is drawn into small patches,
// one or a few an object, so that the cost follows what is drawn and not the size of the frame.
#pragma once

#include <cairo.h>

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "overlay/trails.h"

namespace cerberus::overlay {

struct Color {
  double r = 0, g = 0, b = 0;
};

// Eight colours that people with any colour vision tell apart (Okabe and Ito, 2008, its black left out for
// white); 0 = no identity is white, every other identity takes the next of the seven.
Color identity_color(std::uint32_t id);

struct SurfaceDeleter {
  void operator()(cairo_surface_t* s) const { cairo_surface_destroy(s); }
};
using SurfacePtr = std::unique_ptr<cairo_surface_t, SurfaceDeleter>;
struct ContextDeleter {
  void operator()(cairo_t* c) const { cairo_destroy(c); }
};
using ContextPtr = std::unique_ptr<cairo_t, ContextDeleter>;

// A sans-serif face at `size` pixels.
void select_font(cairo_t* cairo, double size, bool bold = false);
// Width that the context's font gives `text`, pixels.
double text_width(cairo_t* cairo, const char* text);

struct Area {
  int x = 0, y = 0, width = 0, height = 0;
  bool empty() const { return width <= 0 || height <= 0; }
  Area intersection(const Area& other) const;
};

// Where a picture (premultiplied ARGB32, cairo's) goes in the frame; never beyond its edges.
struct Patch {
  Area area;
  SurfacePtr pixels;
};

enum class ObjectState { seen, coasted, stopped };

struct Object {
  std::uint32_t id = 0;  // 0: none
  double x = 0, y = 0, width = 0, height = 0;
  double speed = 0;     // pixels a second; not finite: unknown
  double distance = 0;  // metres; not finite: unknown
  ObjectState state = ObjectState::seen;
  bool target = false;  // the one whom the head follows
};

struct Light {
  int sensor = 0;            // its number, from 1
  std::uint8_t reading = 2;  // 0 nothing, 1 somebody, else invalid
};

// Where a head looks, and what it was told to do.
struct System {
  bool pose = false, decision = false;  // what of the following is known
  double pan = 0, tilt = 0;             // degrees
  std::string rule, action;
  std::vector<Light> lights;  // from left to right
};

struct Scene {
  vision::Size frame;
  System system;
  std::span<const Object> objects;
  std::span<const Trails::Trail> trails;
  std::span<const Area> covered;  // by what others drew, which lies on top: labels keep clear of it
  double time = 0;                // s, of this frame
  double trail_time = 2;          // s, after which a trail has faded
  double line_width = 0;          // pixels, 0: from the frame's size
  bool boxes = true, ids = true, speeds = true, crosshair = false;
};

// Line width that reads well in a frame of this size, pixels: 1.3 at 240 rows, 6 at 2160.
double automatic_line_width(vision::Size frame);

class Painter {
 public:
  // Appends the scene's patches, those to be drawn first in front.
  void paint(const Scene& scene, std::vector<Patch>& patches);
  void reset() { labels_.clear(); }

 private:
  struct Label {
    SurfacePtr pixels;
    int width = 0, height = 0;
    bool used = false;
  };
  const Label& label(const Object& object, bool detailed);
  void draw_label(Label& label, Color color, ObjectState look, const std::string& id,
                  const std::string& more);
  void paint_trail(const Trails::Trail& trail, std::vector<Patch>& patches);
  void stroke_trail(cairo_t* cairo, Color color, std::size_t first, std::size_t last);
  void paint_box(const Object& object, std::vector<Patch>& patches);
  void paint_target(const Object& object, std::vector<Patch>& patches);
  void paint_label(const Object& object, std::vector<Patch>& patches);
  void paint_crosshair(std::vector<Patch>& patches);
  void paint_system(std::vector<Patch>& patches);

  const Scene* scene_ = nullptr;  // during paint()
  Area frame_;
  double line_ = 1, font_ = 10;
  std::map<std::string, Label> labels_;  // drawn once, kept while in use
  std::vector<Area> taken_;              // labels of this frame
  std::vector<TrailPoint> smooth_;
  std::vector<Object> objects_;  // clipped to the frame
};

}  // namespace cerberus::overlay
