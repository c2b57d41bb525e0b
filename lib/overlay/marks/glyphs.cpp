// SPDX-License-Identifier: LGPL-2.1-or-later
#include "overlay/marks/glyphs.h"

#include <algorithm>
#include <cmath>

#include "overlay/cairo_helpers.h"

namespace cerberus::overlay {

void Glyphs::select(double size, bool bold) {
  if (size == size_ && bold == bold_) return;
  size_ = size;
  bold_ = bold;
  glyphs_ = {};
}

Glyphs::Glyph* Glyphs::glyph(char letter) {
  const auto code = static_cast<unsigned char>(letter);
  if (code < ' ' || code >= glyphs_.size()) return nullptr;
  Glyph& found = glyphs_[code];
  if (!found.known) render(letter, found);
  return &found;
}

void Glyphs::render(char letter, Glyph& glyph) const {
  glyph.known = true;
  const char text[2] = {letter, '\0'};
  const ContextPtr measure = measuring_context();
  select_font(measure.get(), size_, bold_);
  cairo_text_extents_t extents;
  cairo_text_extents(measure.get(), text, &extents);
  glyph.advance = extents.x_advance;
  glyph.left = static_cast<int>(std::floor(extents.x_bearing)) - 1;
  glyph.top = static_cast<int>(std::floor(extents.y_bearing)) - 1;
  glyph.width = static_cast<int>(std::ceil(extents.x_bearing + extents.width)) + 1 - glyph.left;
  glyph.height = static_cast<int>(std::ceil(extents.y_bearing + extents.height)) + 1 - glyph.top;
  const SurfacePtr surface(cairo_image_surface_create(CAIRO_FORMAT_A8, glyph.width, glyph.height));
  const ContextPtr cr(cairo_create(surface.get()));
  select_font(cr.get(), size_, bold_);
  cairo_move_to(cr.get(), -glyph.left, -glyph.top);
  cairo_show_text(cr.get(), text);
  cairo_surface_flush(surface.get());
  glyph.coverage.assign(static_cast<std::size_t>(glyph.width) * static_cast<std::size_t>(glyph.height), 0);
  if (cairo_status(cr.get()) != CAIRO_STATUS_SUCCESS) return;
  const unsigned char* from = cairo_image_surface_get_data(surface.get());
  const int stride = cairo_image_surface_get_stride(surface.get());
  for (int y = 0; y < glyph.height; ++y)
    std::copy_n(from + static_cast<std::ptrdiff_t>(y) * stride, glyph.width,
                glyph.coverage.begin() + static_cast<std::ptrdiff_t>(y) * glyph.width);
}

double Glyphs::width(std::string_view text) {
  double sum = 0;
  for (const char letter : text)
    if (const Glyph* each = glyph(letter)) sum += each->advance;
  return sum;
}

void Glyphs::draw(std::string_view text, double x, double base, Color color,
                  vision::View<std::uint32_t> picture) {
  const std::uint32_t ink[4] = {static_cast<std::uint32_t>(std::lround(255 * color.b)),
                                static_cast<std::uint32_t>(std::lround(255 * color.g)),
                                static_cast<std::uint32_t>(std::lround(255 * color.r)), 255};
  for (const char letter : text) {
    const Glyph* each = glyph(letter);
    if (!each) continue;
    const int left = static_cast<int>(std::lround(x)) + each->left,
              top = static_cast<int>(std::lround(base)) + each->top;
    for (int j = std::max(0, -top); j < std::min(each->height, picture.height - top); ++j)
      for (int i = std::max(0, -left); i < std::min(each->width, picture.width - left); ++i) {
        const std::uint32_t share = each->coverage[static_cast<std::size_t>(j * each->width + i)];
        if (share == 0) continue;
        std::uint32_t& word = picture.at(left + i, top + j);
        std::uint32_t mixed = 0;
        for (int k = 0; k < 4; ++k)
          mixed |= (ink[k] * share + (word >> (8 * k) & 255) * (255 - share) + 127) / 255 << (8 * k);
        word = mixed;
      }
    x += each->advance;
  }
}

}  // namespace cerberus::overlay
