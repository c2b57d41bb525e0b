// SPDX-License-Identifier: LGPL-2.1-or-later
#include "overlay/marks/labels.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "text/numbers.h"

namespace cerberus::overlay {

namespace {

// In sizes of the font: height of a label, margin before and behind the text, gap between its parts, width of the two
// bars.
constexpr double kHeight = 1.35, kPad = 0.4, kGap = 0.45, kBars = 0.5;

double base_line(double font) {
  return 1 + font * (kHeight / 2 + 0.36);
}

// Returns the colour of text on this colour.
Color ink_on(Color c) {
  const double luminance = 0.299 * c.r + 0.587 * c.g + 0.114 * c.b;
  return luminance > 0.45 ? Color{0.05, 0.05, 0.05} : Color{1, 1, 1};
}

void append_number(std::string& text, double value) {
  text += text::fixed(std::min(value, 99999.0), value < 10 ? 1 : 0).string_view();
}

struct Pill {
  float left, top, right, bottom, radius;

  // Returns the share of the pixel that lies inside.
  float covered(int x, int y) const {
    const float px = static_cast<float>(x) + 0.5f, py = static_cast<float>(y) + 0.5f;
    const float dx = std::max({left + radius - px, px - right + radius, 0.0f}),
                dy = std::max({top + radius - py, py - bottom + radius, 0.0f});
    const float depth = dx > 0 && dy > 0 ? radius - std::sqrt(dx * dx + dy * dy)
                                         : std::min({px - left, right - px, py - top, bottom - py});
    return std::clamp(depth + 0.5f, 0.0f, 1.0f);
  }
};

// Draws two pills, one on the other: except at their ends, rows have one colour.
void fill(vision::View<std::uint32_t> picture, const Pill& rim, const Premultiplied& rim_color,
          const Pill& body, const Premultiplied& body_color) {
  const int round = static_cast<int>(std::ceil(rim.radius)) + 2;
  const auto word = [&](int x, int y) {
    return (body_color * body.covered(x, y)).over(rim_color * rim.covered(x, y)).word();
  };
  for (int y = 0; y < picture.height; ++y) {
    std::uint32_t* row = picture.row(y);
    std::fill(row, row + picture.width, word(picture.width / 2, y));
    for (int x = 0; x < std::min(round, picture.width); ++x) {
      row[x] = word(x, y);
      row[picture.width - 1 - x] = word(picture.width - 1 - x, y);
    }
  }
}

// Draws an upright bar on opaque or nearly opaque pixels.
void draw_bar(vision::View<std::uint32_t> picture, double left, double top, double width, double height,
              Color color) {
  const auto share = [](int at, double low, double high) {
    return std::clamp(std::min(at + 1.0, high) - std::max(static_cast<double>(at), low), 0.0, 1.0);
  };
  for (int y = std::max(0, static_cast<int>(top));
       y < std::min(picture.height, static_cast<int>(top + height) + 1); ++y)
    for (int x = std::max(0, static_cast<int>(left));
         x < std::min(picture.width, static_cast<int>(left + width) + 1); ++x) {
      const double covered = share(x, left, left + width) * share(y, top, top + height);
      const std::uint32_t below = picture.at(x, y), ink = Premultiplied(color, 1).word();
      std::uint32_t word = 0;
      for (int shift = 0; shift < 32; shift += 8)
        word |= static_cast<std::uint32_t>(
                    std::lround(covered * (ink >> shift & 255) + (1 - covered) * (below >> shift & 255)))
                << shift;
      picture.at(x, y) = word;
    }
}

}  // namespace

void Labels::begin(double font, PicturePool& pool) {
  pool_ = &pool;
  if (font != font_) labels_.clear();
  font_ = font;
  bold_.select(font, true);
  small_.select(0.85 * font, false);
  for (auto& entry : labels_) entry.second.used = false;
}

void Labels::end() {
  std::erase_if(labels_, [](const auto& entry) { return !entry.second.used; });
}

void Labels::write_details(const Object& object, bool speeds) {
  details_.clear();
  if (speeds && object.state != ObjectState::stopped && std::isfinite(object.speed)) {
    append_number(details_, object.speed);
    details_ += " px/s";
  }
  if (std::isfinite(object.distance) && object.distance > 0) {
    if (!details_.empty()) details_ += "  ";
    append_number(details_, object.distance);
    details_ += " m";
  }
}

std::shared_ptr<const Picture> Labels::label(const Object& object, bool detailed, bool speeds) {
  details_.clear();
  if (detailed) write_details(object, speeds);
  Label& label = labels_[std::uint64_t{object.id} << 1 | std::uint64_t{detailed}];
  label.used = true;
  if (label.state != object.state) label.drawn = false, label.plain = nullptr;
  if (!label.drawn || label.details != details_) {
    label.drawn = true;
    label.state = object.state;
    label.details = details_;
    draw(object, label);
  }
  return label.picture;
}

// Draws the label without its details, into a picture of this size.
void Labels::draw_plain(const Object& object, std::string_view id, int width, int height, Label& label) {
  label.plain = pool_->take_unwritten(width, height);
  const auto view = label.plain->view();
  const auto w = static_cast<float>(width - 2), h = static_cast<float>(kHeight * font_),
             f = static_cast<float>(font_);
  const Color color = identity_color(object.id), ink = ink_on(color);
  fill(view, {0.5f, 0.5f, w + 1.5f, h + 1.5f, 0.35f * f}, {Color{}, 0.55}, {1, 1, w + 1, h + 1, 0.3f * f},
       {color, object.state == ObjectState::coasted ? 0.8 : 0.95});
  label.details_x = 1 + kPad * font_;
  if (!id.empty()) {
    bold_.draw(id, label.details_x, base_line(font_), ink, view);
    label.details_x += bold_.width(id) + kGap * font_;
  }
  if (object.state == ObjectState::stopped) {
    for (const double at : {0.0, 0.32 * font_})
      draw_bar(view, label.details_x + at, 1 + kHeight * font_ / 4, 0.16 * font_, kHeight * font_ / 2, ink);
    label.details_x += (kBars + kGap) * font_;
  }
}

void Labels::draw(const Object& object, Label& label) {
  char digits[12];
  const std::string_view id(
      digits, object.id ? static_cast<std::size_t>(
                              std::to_chars(digits, digits + sizeof digits, object.id).ptr - digits)
                        : 0);
  const bool bars = object.state == ObjectState::stopped;
  const int parts = !id.empty() + bars + !label.details.empty();
  label.picture = nullptr;
  if (parts == 0) return;
  const double room = bold_.width(id) + small_.width(label.details) +
                      font_ * (2 * kPad + (bars ? kBars : 0) + (parts - 1) * kGap);
  const int width = static_cast<int>(std::ceil(room)) + 2,
            height = static_cast<int>(std::ceil(kHeight * font_)) + 2;
  if (!label.plain || label.plain->width != width) draw_plain(object, id, width, height, label);
  if (label.details.empty()) {
    label.picture = label.plain;
    return;
  }
  label.picture = pool_->take_unwritten(width, height);
  label.picture->words = label.plain->words;
  small_.draw(label.details, label.details_x, base_line(font_) - 0.03 * font_,
              ink_on(identity_color(object.id)), label.picture->view());
}

}  // namespace cerberus::overlay
