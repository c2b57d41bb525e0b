// SPDX-License-Identifier: LGPL-2.1-or-later
#include "overlay/threshold_figure.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "overlay/cairo_helpers.h"
#include "text/numbers.h"

namespace cerberus::overlay {

namespace {

constexpr Color kPaper{0.075, 0.085, 0.10}, kGrid{0.22, 0.24, 0.27}, kText{0.82, 0.84, 0.86};
constexpr Color kBars{0.45, 0.49, 0.54}, kBackground{0.337, 0.706, 0.914}, kObject{0.902, 0.624, 0.0};
constexpr Color kThreshold{1.0, 0.35, 0.25};

// Anchors: 0 left / top, 0.5 middle, 1 right / bottom of the text.
void text(cairo_t* cr, double x, double y, double anchor_x, double anchor_y, const std::string& what,
          Color color) {
  cairo_font_extents_t font;
  cairo_font_extents(cr, &font);
  const double width = text_width(cr, what.c_str());
  set_color(cr, color);
  cairo_move_to(cr, x - anchor_x * width, y + (1 - anchor_y) * font.ascent - anchor_y * font.descent * 0.5);
  cairo_show_text(cr, what.c_str());
}

void line(cairo_t* cr, double x0, double y0, double x1, double y1) {
  cairo_move_to(cr, x0, y0);
  cairo_line_to(cr, x1, y1);
  cairo_stroke(cr);
}

struct Panel {
  double left = 0, top = 0, width = 0, height = 0;
  int levels = 256;  // shown along x

  double x(double level) const { return left + (level + 0.5) * width / levels; }
  double y(double share) const { return top + height * (1 - std::clamp(share, 0.0, 1.0)); }
};

// Returns the number of levels along x: all levels present, rounded up to a few fixed ranges so that the axis is
// steady.
int shown_levels(const ThresholdFigure& figure) {
  const int highest = std::max({figure.curves.highest, figure.threshold, figure.fuzzy_threshold});
  for (const int levels : {32, 64, 128, 192})
    if (highest + 2 <= levels) return levels;
  return 256;
}

void draw_levels_axis(cairo_t* cr, const Panel& panel, double font, bool labels) {
  const int every = panel.levels <= 32 ? 8 : panel.levels <= 64 ? 16 : 32;
  cairo_set_line_width(cr, 1);
  for (int level = 0; level <= panel.levels; level += every) {
    const double x = std::floor(panel.left + level * panel.width / panel.levels) + 0.5;
    set_color(cr, kGrid);
    line(cr, x, panel.top, x, panel.top + panel.height);
    if (!labels) continue;
    const double anchor = level == panel.levels ? 1 : 0.5;  // the last one stays inside the picture
    text(cr, x, panel.top + panel.height + 0.25 * font, anchor, 0, std::to_string(level), kText);
  }
  set_color(cr, kText, 0.6);
  line(cr, panel.left, panel.top + panel.height + 0.5, panel.left + panel.width,
       panel.top + panel.height + 0.5);
}

void draw_histogram(cairo_t* cr, const Panel& panel, const ThresholdFigure& figure, double font,
                    bool labels) {
  const auto& counts = *figure.histogram;
  const double most = *std::max_element(counts.begin(), counts.end());
  const double decades = std::max(1.0, std::ceil(std::log10(std::max(most, 1.0) + 1)));
  const auto height = [&](double count) { return std::log10(count + 1) / decades; };
  draw_levels_axis(cr, panel, font, false);
  for (int decade = 0; decade <= decades; ++decade) {
    const double y = std::floor(panel.y(decade / decades)) + 0.5;
    set_color(cr, kGrid);
    line(cr, panel.left, y, panel.left + panel.width, y);
    static constexpr const char* kNames[] = {"1",  "10",  "100",  "1k", "10k", "100k",
                                             "1M", "10M", "100M", "1G", "10G"};
    if (labels && decade > 0 && decade <= 10)
      text(cr, panel.left - 0.4 * font, y, 1, 0.5, kNames[decade], kText);
  }
  // Bars: the colour shows the seed subset of a level (B up to j, W from r); grey is the fuzzy region.
  const double step = panel.width / panel.levels, gap = step >= 3 ? 1 : 0;
  for (int level = 0; level < panel.levels && level < 256; ++level) {
    if (!counts[level]) continue;
    const auto& c = figure.curves;
    const bool seeds = c.seed_high > c.seed_low;
    set_color(cr,
              seeds && level <= c.seed_low    ? kBackground
              : seeds && level >= c.seed_high ? kObject
                                              : kBars,
              0.6);
    const double y = panel.y(height(counts[level]));
    cairo_rectangle(cr, panel.left + level * step, y, step - gap, panel.top + panel.height - y);
    cairo_fill(cr);
  }
  // Membership: object rises with the level, background is its complement.
  for (const bool object : {false, true}) {
    cairo_new_path(cr);
    for (int level = 0; level < panel.levels && level < 256; ++level) {
      const double share = figure.curves.membership[level];
      cairo_line_to(cr, panel.x(level), panel.y(object ? share : 1 - share));
    }
    set_color(cr, object ? kObject : kBackground);
    cairo_set_line_width(cr, std::max(1.2, font / 7));
    cairo_stroke(cr);
  }
}

void draw_fuzziness(cairo_t* cr, const Panel& panel, const ThresholdFigure& figure, double font,
                    bool labels) {
  const auto& c = figure.curves;
  draw_levels_axis(cr, panel, font, labels);
  // The curves are close together: the axis covers their range, rounded to tenths.
  double least = 1, most = 0;
  for (int x = c.seed_low + 1; x < c.seed_high; ++x) {
    least = std::min({least, c.beta[x], c.omega[x]});
    most = std::max({most, c.beta[x], c.omega[x]});
  }
  int low = 0, high = 10;  // tenths
  if (least <= most) {
    low = static_cast<int>(std::floor(std::clamp(least, 0.0, 99.0) * 10));
    high = std::max(low + 2, static_cast<int>(std::ceil(std::clamp(most, 0.0, 99.0) * 10)));
  }
  const auto height = [&](double value) { return (value * 10 - low) / (high - low); };
  const int every = 1 + (high - low - 1) / 5;
  for (int tenths = low; tenths <= high; tenths += every) {
    const double y = std::floor(panel.y(height(tenths / 10.0))) + 0.5;
    set_color(cr, kGrid);
    cairo_set_line_width(cr, 1);
    line(cr, panel.left, y, panel.left + panel.width, y);
    if (labels) text(cr, panel.left - 0.4 * font, y, 1, 0.5, text::fixed(tenths / 10.0, 1).string(), kText);
  }
  for (const bool object : {false, true}) {
    cairo_new_path(cr);
    for (int x = c.seed_low + 1; x < c.seed_high && x < 256; ++x)
      cairo_line_to(cr, panel.x(x), panel.y(height(object ? c.omega[x] : c.beta[x])));
    set_color(cr, object ? kObject : kBackground);
    cairo_set_line_width(cr, std::max(1.5, font / 6));
    cairo_stroke(cr);
  }
}

// Draws the vertical line of a level through a panel: levels to its right are motion (Eq. 3: above Th).
void draw_threshold(cairo_t* cr, const Panel& panel, int level, bool dashed, double font) {
  if (level < 0 || level >= panel.levels) return;
  const double dashes[] = {0.5 * font, 0.35 * font};
  const double x = panel.left + (level + 1) * panel.width / panel.levels;
  cairo_set_dash(cr, dashes, dashed ? 2 : 0, 0);
  cairo_set_line_width(cr, std::max(1.5, font / 6));
  set_color(cr, kThreshold, dashed ? 0.75 : 1);
  line(cr, x, panel.top, x, panel.top + panel.height);
  cairo_set_dash(cr, nullptr, 0, 0);
}

// An entry of the legend, a name in its colour. Entries are drawn from the right edge to the left; those without room
// are left out.
struct Entry {
  std::string name;
  Color color;
};
void draw_legend(cairo_t* cr, double left, double right, double y, double font,
                 std::initializer_list<Entry> entries) {
  double x = right;
  for (const Entry& entry : entries) {
    if (entry.name.empty()) continue;
    x -= text_width(cr, entry.name.c_str());
    if (x < left) return;
    text(cr, x, y, 0, 0, entry.name, entry.color);
    x -= font;
  }
}

void draw_figure(cairo_t* cr, int width, int height, const ThresholdFigure& figure) {
  set_color(cr, kPaper);
  cairo_paint(cr);
  const bool labels = width >= 200 && height >= 150;  // smaller text is not readable
  const double font = std::max(9.0, 9.5 * std::pow(std::min(width * 0.75, double(height)) / 240, 0.75));
  select_font(cr, font);

  Panel upper, lower;
  upper.levels = lower.levels = shown_levels(figure);
  const double margin = labels ? 0.6 * font : 1, head = labels ? 1.6 * font : 1,
               foot = labels ? 1.7 * font : 1;
  upper.left = lower.left = labels ? 3.2 * font : 1;
  upper.width = lower.width = width - upper.left - margin;
  const double room = height - 2 * head - foot - 0.3 * font;
  upper.top = head;
  upper.height = height >= 100 ? 0.56 * room : height - 2;
  lower.top = upper.top + upper.height + head + 0.3 * font;
  lower.height = height - foot - lower.top;

  const bool any = std::accumulate(figure.histogram->begin(), figure.histogram->end(), std::uint64_t{0}) > 0;
  const auto panels = [&](const Panel& panel) {
    if (figure.threshold != figure.fuzzy_threshold)
      draw_threshold(cr, panel, figure.fuzzy_threshold, true, font);
    draw_threshold(cr, panel, figure.threshold >= 0 ? figure.threshold : figure.fuzzy_threshold, false, font);
  };
  draw_histogram(cr, upper, figure, font, labels);
  if (any) panels(upper);
  if (height >= 100) {
    draw_fuzziness(cr, lower, figure, font, labels);
    if (any) panels(lower);
  }
  if (!labels) return;
  if (!any) {
    text(cr, upper.left + upper.width / 2, upper.top + upper.height / 2, 0.5, 0.5, "no difference yet",
         kText);
    return;
  }

  std::string chosen =
      "Th " + std::to_string(figure.threshold >= 0 ? figure.threshold : figure.fuzzy_threshold);
  if (figure.threshold >= 0 && figure.threshold != figure.fuzzy_threshold)
    chosen += " (fuzzy " + std::to_string(figure.fuzzy_threshold) + ")";
  std::string noise;
  if (figure.noise > 0) noise = "noise " + text::fixed(std::min(figure.noise, 255.0), 1).string();
  const double right = upper.left + upper.width;
  text(cr, upper.left, 0.25 * font, 0, 0, "|difference|", kText);
  draw_legend(cr, upper.left + text_width(cr, "|difference|") + font, right, 0.25 * font, font,
              {{chosen, kThreshold}, {"object", kObject}, {"background", kBackground}, {noise, kText}});
  const double second = upper.top + upper.height + 0.5 * font;
  text(cr, lower.left, second, 0, 0, "index of fuzziness", kText);
  draw_legend(cr, lower.left + text_width(cr, "index of fuzziness") + font, right, second, font,
              {{"omega", kObject}, {"beta (normalised)", kBackground}});
}

}  // namespace

bool draw_threshold_figure(const ThresholdFigure& figure, const Canvas& canvas) {
  const SurfacePtr surface(cairo_image_surface_create_for_data(
      canvas.data, CAIRO_FORMAT_RGB24, canvas.width, canvas.height, static_cast<int>(canvas.stride)));
  const ContextPtr cairo(cairo_create(surface.get()));
  draw_figure(cairo.get(), canvas.width, canvas.height, figure);
  cairo_surface_flush(surface.get());
  return cairo_status(cairo.get()) == CAIRO_STATUS_SUCCESS;
}

}  // namespace cerberus::overlay
