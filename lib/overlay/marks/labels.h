// SPDX-License-Identifier: LGPL-2.1-or-later
// The labels of objects: a pill in the colour of the identity, with the identity, two bars for an object that stands,
// speed and distance. A label is stored as long as it is shown; only its numbers are drawn again when those change.
#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>

#include "overlay/marks/glyphs.h"
#include "overlay/picture.h"
#include "overlay/scene.h"

namespace cerberus::overlay {

class Labels {
 public:
  // Begins a frame. font: size of the text, pixels.
  void begin(double font, PicturePool& pool);
  // Returns the label of an object; `detailed`: with speed (if `speeds`) and distance if they are known. Null if the
  // label would be empty. Numbers have about two digits: 3.2, 45.
  std::shared_ptr<const Picture> label(const Object& object, bool detailed, bool speeds);
  // Drops the labels that were not shown since begin().
  void end();
  void clear() { labels_.clear(); }

 private:
  struct Label {
    ObjectState state = ObjectState::seen;
    std::string details;
    PicturePtr picture, plain;  // with and without the details
    double details_x = 0;       // where those begin
    bool drawn = false, used = false;
  };
  void write_details(const Object& object, bool speeds);
  void draw(const Object& object, Label& label);
  void draw_plain(const Object& object, std::string_view id, int width, int height, Label& label);

  double font_ = 0;
  PicturePool* pool_ = nullptr;  // from begin() on
  Glyphs bold_, small_;
  std::string details_;                              // of the object at hand
  std::unordered_map<std::uint64_t, Label> labels_;  // by identity and detail
};

}  // namespace cerberus::overlay
