// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/detection/zones.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

namespace cerberus::vision {
namespace {

constexpr std::string_view kBlank = " \t\r";
constexpr std::string_view kExample = "for example: include 0.1,0.1 0.9,0.1 0.9,0.9";

std::string_view trimmed(std::string_view text) {
  const auto from = text.find_first_not_of(kBlank);
  if (from == std::string_view::npos) return {};
  return text.substr(from, text.find_last_not_of(kBlank) - from + 1);
}

// Takes the first of the words (or polygons) off the text.
std::string_view take(std::string_view& text, std::string_view separators) {
  const auto end = std::min(text.find_first_of(separators), text.size());
  const std::string_view word = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return word;
}

std::string quoted(std::string_view word) {
  std::string text(1, '"');
  text += word.substr(0, 60);
  return text += '"';
}

// A whole word that is a fraction 0..1.
bool parse_fraction(std::string_view word, double& value) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc{} && end == word.data() + word.size() && value >= 0 && value <= 1;
}

std::string parse_corner(std::string_view word, Point& corner) {
  const auto comma = word.find(',');
  if (comma != std::string_view::npos && parse_fraction(word.substr(0, comma), corner.x) &&
      parse_fraction(word.substr(comma + 1), corner.y))
    return {};
  std::string text = "zones: " + quoted(word) +
                     " is not a corner: write x,y as fractions of the picture from 0 to 1 " +
                     "with decimal points and without blanks, " + std::string(kExample);
  return text;
}

// Columns, in pixels, where the polygon's edges cross the height y of a row of pixel centres; sorted. An edge
// owns its upper end and not its lower one, so that a corner is counted once.
void crossings(const std::vector<Point>& corners, Size size, double y, std::vector<double>& columns) {
  columns.clear();
  Point a = corners.back();
  for (const Point& b : corners) {
    const double ay = a.y * size.height, by = b.y * size.height;
    if ((ay <= y) != (by <= y)) columns.push_back((a.x + (b.x - a.x) * (y - ay) / (by - ay)) * size.width);
    a = b;
  }
  std::sort(columns.begin(), columns.end());
}

}  // namespace

std::string Zones::parse(std::string_view text) {
  std::vector<Polygon> polygons;
  while (!text.empty()) {
    std::string_view part = trimmed(take(text, ";\n"));
    if (part.empty()) continue;
    const std::string_view whole = part;
    const std::string_view word = take(part, kBlank);
    Polygon polygon;
    if (word != "include" && word != "exclude")
      return "zones: " + quoted(word) +
             " is neither include nor exclude: begin each polygon with one of them, " + std::string(kExample);
    polygon.include = word == "include";
    while (!(part = trimmed(part)).empty()) {
      Point corner;
      if (std::string error = parse_corner(take(part, kBlank), corner); !error.empty()) return error;
      polygon.corners.push_back(corner);
    }
    if (polygon.corners.size() < 3)
      return "zones: " + quoted(whole) + " has " + std::to_string(polygon.corners.size()) +
             " corners: a polygon needs at least three, " + std::string(kExample);
    polygons.push_back(std::move(polygon));
  }
  polygons_ = std::move(polygons);
  drawn_ = nowhere_ = false;
  return {};
}

void Zones::draw(MutableGrayView plane) const {
  const bool limited =
      std::any_of(polygons_.begin(), polygons_.end(), [](const Polygon& p) { return p.include; });
  std::vector<double> columns;
  for (int y = 0; y < plane.height; ++y) {
    std::uint8_t* row = plane.row(y);
    std::fill(row, row + plane.width, limited ? 0 : 255);
    for (const bool include : {true, false})  // excludes have the last word
      for (const Polygon& polygon : polygons_) {
        if (polygon.include != include) continue;
        crossings(polygon.corners, plane.size(), y + 0.5, columns);
        for (std::size_t i = 0; i + 1 < columns.size(); i += 2) {
          // Pixels whose centre x + 0.5 lies in [columns[i], columns[i + 1]).
          const int from = std::clamp(static_cast<int>(std::ceil(columns[i] - 0.5)), 0, plane.width);
          const int to = std::clamp(static_cast<int>(std::ceil(columns[i + 1] - 0.5)), from, plane.width);
          std::fill(row + from, row + to, include ? 255 : 0);
        }
      }
  }
}

void Zones::apply(MutableGrayView mask) {
  if (everywhere()) return;
  if (plane_.resize(mask.size()) || !drawn_) {
    draw(plane_.view());
    drawn_ = true;
    nowhere_ = true;
    for (int y = 0; y < mask.height && nowhere_; ++y) {
      const std::uint8_t* row = plane_.view().row(y);
      nowhere_ = std::find(row, row + mask.width, 255) == row + mask.width;
    }
  }
  for (int y = 0; y < mask.height; ++y) {
    std::uint8_t* row = mask.row(y);
    const std::uint8_t* counts = plane_.view().row(y);
    for (int x = 0; x < mask.width; ++x) row[x] &= counts[x];
  }
}

}  // namespace cerberus::vision
