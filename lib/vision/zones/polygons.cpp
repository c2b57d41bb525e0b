// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/zones/polygons.h"

#include <algorithm>
#include <charconv>
#include <utility>

namespace cerberus::vision {
namespace {

constexpr std::string_view kBlank = " \t\r";
constexpr std::string_view kWorld = "world";

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

// A whole word that is a number from `least` to `most`.
bool parse_number(std::string_view word, double least, double most, double& value) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc{} && end == word.data() + word.size() && value >= least && value <= most;
}

bool parse_corner(std::string_view word, bool world, Point& corner) {
  const auto comma = word.find(',');
  if (comma == std::string_view::npos) return false;
  const std::string_view x = word.substr(0, comma), y = word.substr(comma + 1);
  return world ? parse_number(x, -180, 180, corner.x) && parse_number(y, -90, 90, corner.y)
               : parse_number(x, 0, 1, corner.x) && parse_number(y, 0, 1, corner.y);
}

class Parser {
 public:
  explicit Parser(const PolygonSyntax& syntax) : syntax_(syntax) {}

  // Reads one polygon, which is not blank. Returns what is wrong.
  std::string read(std::string_view text, TypedPolygon& polygon) const {
    const std::string_view whole = text;
    if (!syntax_.words.empty()) {
      polygon.word = take(text, kBlank);
      if (std::ranges::find(syntax_.words, polygon.word) == syntax_.words.end())
        return wrong(polygon.word, std::string(" is neither ")
                                       .append(syntax_.words[0])
                                       .append(" nor ")
                                       .append(syntax_.words[1])
                                       .append(": begin each polygon with one of them"));
    }
    if (std::string_view rest = trimmed(text); syntax_.world && take(rest, kBlank) == kWorld) {
      polygon.world = true;
      text = rest;
    }
    while (!(text = trimmed(text)).empty()) {
      const std::string_view word = take(text, kBlank);
      if (!parse_corner(word, polygon.world, polygon.corners.emplace_back()))
        return wrong(
            word, polygon.world
                      ? " is not a corner: write pan,tilt in degrees with decimal points and without blanks"
                      : " is not a corner: write x,y as fractions of the picture from 0 to 1 with decimal "
                        "points and without blanks");
    }
    if (polygon.corners.size() < 3)
      return wrong(whole, " has " + std::to_string(polygon.corners.size()) +
                              " corners: a polygon needs at least three");
    return {};
  }

 private:
  std::string wrong(std::string_view word, const std::string& why) const {
    std::string text(syntax_.property);
    text.append(": \"").append(word.substr(0, 60)).append("\"").append(why);
    return text.append(", for example: ").append(syntax_.example);
  }

  const PolygonSyntax& syntax_;
};

}  // namespace

std::string parse_polygons(std::string_view text, const PolygonSyntax& syntax,
                           std::vector<TypedPolygon>& polygons) {
  std::vector<TypedPolygon> found;
  const Parser parser(syntax);
  while (!text.empty()) {
    const std::string_view part = trimmed(take(text, ";\n"));
    if (part.empty()) continue;
    if (std::string error = parser.read(part, found.emplace_back()); !error.empty()) return error;
  }
  polygons = std::move(found);
  return {};
}

}  // namespace cerberus::vision
