// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sim/house/floor_plan.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>

namespace cerberus::sim {
namespace {

constexpr std::array<const char*, kSurfaces> kNames{"plaster",  "brick",  "wood",  "carpet", "tiles",
                                                    "concrete", "panels", "books", "cloth",  "metal"};
constexpr double kThickestWall = .6;  // metres: rooms further apart have no wall in common
constexpr double kLargest = 200;      // metres, of a plan: light and ways are calculated every 10 cm
constexpr double kTouch = 1e-6;       // metres

bool number_of(std::string_view word, double& value) {
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size() && std::isfinite(value);
}

// The words of one line: first the plain ones, in their order, then options as key=value, in any order. What is first found
// wrong is kept, and values are replaced by harmless ones.
class Statement {
 public:
  explicit Statement(std::string_view line) {
    line = line.substr(0, line.find('#'));
    while (true) {
      const std::size_t begin = line.find_first_not_of(" \t\r");
      if (begin == line.npos) return;
      line.remove_prefix(begin);
      const std::size_t end = std::min(line.find_first_of(" \t\r"), line.size());
      const std::string word(line.substr(0, end));
      line.remove_prefix(end);
      if (const std::size_t equals = word.find('='); equals != word.npos)
        options_[word.substr(0, equals)] = word.substr(equals + 1);
      else
        words_.push_back(word);
    }
  }
  bool empty() const { return words_.empty() && options_.empty(); }
  const std::string& wrong() const { return wrong_; }
  bool fails() const { return !wrong_.empty(); }
  void fail(const std::string& text) {
    if (wrong_.empty()) wrong_ = text;
  }

  std::string word(const char* meaning) {
    if (next_ < words_.size()) return words_[next_++];
    fail(std::string(meaning) + " is missing");
    return {};
  }
  double number(const char* meaning) { return number_in(word(meaning), meaning); }
  double positive(const char* meaning) { return positive_in(number(meaning), meaning); }
  double number(const char* option, double otherwise) {
    const auto value = take(option);
    return value ? number_in(*value, option) : otherwise;
  }
  double positive(const char* option, double otherwise) {
    return positive_in(number(option, otherwise), option);
  }
  double required(const char* option) {
    if (!options_.contains(option)) fail(std::string(option) + "= is missing");
    return number(option, 0.);
  }
  Surface surface(const char* option, Surface otherwise) {
    const auto value = take(option);
    if (!value) return otherwise;
    const auto surface = surface_of(*value);
    if (!surface) fail("no texture is named '" + *value + "'");
    return surface.value_or(otherwise);
  }
  // True: all words were taken, and nothing is wrong.
  bool finish() {
    if (next_ != words_.size()) fail("'" + words_[next_] + "' is one word too many");
    if (!options_.empty()) fail("'" + options_.begin()->first + "=' means nothing here");
    return !fails();
  }

 private:
  std::optional<std::string> take(const char* option) {
    const auto found = options_.extract(option);
    return found.empty() ? std::nullopt : std::optional(found.mapped());
  }
  double number_in(const std::string& word, const char* meaning) {
    double value = 0;
    if (!number_of(word, value)) fail(std::string(meaning) + ": '" + word + "' is no number");
    return value;
  }
  double positive_in(double value, const char* meaning) {
    if (value > 0) return value;
    fail(std::string(meaning) + " must be above 0");
    return 1;
  }

  std::vector<std::string> words_;
  std::size_t next_ = 0;
  std::map<std::string, std::string> options_;
  std::string wrong_;
};

bool overlap(const Rectangle& a, const Rectangle& b) {
  return std::min(a.right, b.right) - std::max(a.left, b.left) > kTouch &&
         std::min(a.bottom, b.bottom) - std::max(a.top, b.top) > kTouch;
}

class Reader {
 public:
  void read(Statement& line) {
    const std::string kind = line.word("a statement");
    if (kind == "room" || kind == "corridor")
      room(line);
    else if (kind == "doorway")
      doorway(line);
    else if (kind == "box")
      box(line);
    else if (kind == "pillar")
      pillar(line);
    else if (kind == "lamp")
      lamp(line);
    else
      line.fail("'" + kind + "' is none of room, corridor, doorway, box, pillar, lamp");
  }
  FloorPlan plan;

 private:
  void room(Statement& line) {
    Space space;
    space.name = line.word("the name");
    if (index_of(space.name)) return line.fail("there is a room '" + space.name + "' already");
    space.area.left = line.number("x"), space.area.top = line.number("y");
    space.area.right = space.area.left + line.positive("the width");
    space.area.bottom = space.area.top + line.positive("the length");
    space.height = line.positive("height", space.height);
    space.wall = line.surface("wall", space.wall);
    space.floor = line.surface("floor", space.floor);
    space.ceiling = line.surface("ceiling", space.ceiling);
    if (line.finish()) add(space, line);
  }

  void doorway(Statement& line) {
    const int first = named(line, "the first room"), second = named(line, "the second room");
    if (line.fails()) return;
    Space space;
    const double at = line.required("at"), width = line.positive("width", .9);
    space.height = line.positive("height", 2.05);
    const Space &a = plan.spaces[first], &b = plan.spaces[second];
    space.name = a.name + "-" + b.name;
    space.doorway = true;
    space.wall = line.surface("wall", Surface::wood);
    space.floor = line.surface("floor", a.floor);
    space.ceiling = space.wall;
    if (!line.finish()) return;
    if (space.height > std::min(a.height, b.height)) return line.fail("the doorway is higher than its rooms");
    const bool beside = gap(a.area.right, b.area.left) || gap(b.area.right, a.area.left);
    if (!beside && !gap(a.area.bottom, b.area.top) && !gap(b.area.bottom, a.area.top))
      return line.fail("'" + a.name + "' and '" + b.name +
                       "' have no wall in common: leave one between them, up to .6 m thick");
    const double from = at - width / 2, to = at + width / 2;
    Opening in_first{}, in_second{};
    if (beside) {
      const bool is_right = gap(a.area.right, b.area.left);
      space.area = {std::min(a.area.right, b.area.right), from, std::max(a.area.left, b.area.left), to};
      in_first.side = is_right ? Opening::right : Opening::left;
      in_second.side = is_right ? Opening::left : Opening::right;
    } else {
      const bool is_below = gap(a.area.bottom, b.area.top);
      space.area = {from, std::min(a.area.bottom, b.area.bottom), to, std::max(a.area.top, b.area.top)};
      in_first.side = is_below ? Opening::bottom : Opening::top;
      in_second.side = is_below ? Opening::top : Opening::bottom;
    }
    const double least = beside ? std::max(a.area.top, b.area.top) : std::max(a.area.left, b.area.left);
    const double most =
        beside ? std::min(a.area.bottom, b.area.bottom) : std::min(a.area.right, b.area.right);
    if (from < least || to > most)
      return line.fail("the doorway is not within the wall that both rooms have");
    for (Opening* opening : {&in_first, &in_second}) opening->from = from, opening->to = to;
    const int between = int(plan.spaces.size());
    for (const auto& [room, opening] : {std::pair{first, in_first}, std::pair{second, in_second}})
      for (const Opening& other : plan.spaces[room].openings)
        if (other.side == opening.side && std::min(other.to, to) - std::max(other.from, from) > kTouch)
          return line.fail("the doorway meets another one");
    // Seen from within the doorway, each room is on the other's side.
    space.openings = {in_second, in_first};
    space.openings[0].space = first, space.openings[1].space = second;
    in_first.space = in_second.space = between;
    if (!add(space, line)) return;
    plan.spaces[first].openings.push_back(in_first);
    plan.spaces[second].openings.push_back(in_second);
  }

  void box(Statement& line) {
    Furniture box;
    box.area.left = line.number("x"), box.area.top = line.number("y");
    box.area.right = box.area.left + line.positive("the width");
    box.area.bottom = box.area.top + line.positive("the length");
    box.height = line.positive("the height");
    box.from = line.number("from", 0.);
    box.side = line.surface("side", box.side);
    box.top = line.surface("top", box.side);
    if (!line.finish()) return;
    if (box.from < 0 || box.from >= box.height) return line.fail("from must be from 0 to below the height");
    const int space = around(box.area, line);
    if (space < 0) return;
    if (box.height > plan.spaces[space].height) return line.fail("the box is higher than its room");
    for (const int other : plan.spaces[space].boxes)
      if (overlap(box.area, plan.boxes[other].area)) return line.fail("the box overlaps another one");
    plan.spaces[space].boxes.push_back(int(plan.boxes.size()));
    plan.boxes.push_back(box);
  }

  void pillar(Statement& line) {
    Pillar pillar;
    pillar.x = line.number("x"), pillar.y = line.number("y"), pillar.radius = line.positive("the radius");
    pillar.wall = line.surface("wall", pillar.wall);
    const double r = pillar.radius;
    if (!line.finish()) return;
    const int space = around({pillar.x - r, pillar.y - r, pillar.x + r, pillar.y + r}, line);
    if (space < 0) return;
    plan.spaces[space].pillars.push_back(int(plan.pillars.size()));
    plan.pillars.push_back(pillar);
  }

  void lamp(Statement& line) {
    Lamp lamp;
    lamp.x = line.number("x"), lamp.y = line.number("y");
    lamp.strength = line.positive("strength", lamp.strength);
    lamp.off_at = line.positive("off", lamp.off_at), lamp.on_at = line.positive("on", lamp.on_at);
    if (!line.finish()) return;
    lamp.space = around({lamp.x, lamp.y, lamp.x, lamp.y}, line);
    if (lamp.space >= 0) plan.lamps.push_back(lamp);
  }

  static bool gap(double end, double begin) { return begin - end > kTouch && begin - end <= kThickestWall; }
  bool add(const Space& space, Statement& line) {
    for (const Space& other : plan.spaces)
      if (overlap(space.area, other.area)) line.fail("'" + space.name + "' overlaps '" + other.name + "'");
    Rectangle all = space.area;
    for (const Space& other : plan.spaces)
      all = {std::min(all.left, other.area.left), std::min(all.top, other.area.top),
             std::max(all.right, other.area.right), std::max(all.bottom, other.area.bottom)};
    if (!(std::max(all.right - all.left, all.bottom - all.top) <= kLargest))
      line.fail("the plan is larger than 200 m: lengths are metres");
    if (!line.fails()) plan.spaces.push_back(space);
    return !line.fails();
  }
  std::optional<int> index_of(const std::string& name) const {
    const auto found = std::ranges::find(plan.spaces, name, &Space::name);
    if (found == plan.spaces.end()) return std::nullopt;
    return int(found - plan.spaces.begin());
  }
  int named(Statement& line, const char* meaning) const {
    const std::string name = line.word(meaning);
    const auto index = index_of(name);
    if (!index) line.fail("there is no room '" + name + "' above");
    return index.value_or(-1);
  }
  // The space that a thing stands in; -1: it is wrong.
  int around(const Rectangle& thing, Statement& line) const {
    for (std::size_t i = 0; i < plan.spaces.size(); ++i)
      if (const Rectangle& area = plan.spaces[i].area;
          area.contains(thing.left, thing.top) && area.contains(thing.right, thing.bottom))
        return int(i);
    line.fail("it is not within one room");
    return -1;
  }
};

}  // namespace

std::optional<Surface> surface_of(std::string_view name) {
  const auto found = std::ranges::find(kNames, name);
  if (found == kNames.end()) return std::nullopt;
  return Surface(found - kNames.begin());
}

int FloorPlan::space_at(double x, double y) const {
  const auto found = std::ranges::find_if(spaces, [&](const Space& s) { return s.area.contains(x, y); });
  return found == spaces.end() ? -1 : int(found - spaces.begin());
}

std::variant<FloorPlan, std::string> read_floor_plan(std::string_view text) {
  Reader reader;
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    Statement line(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.empty()) continue;
    reader.read(line);
    if (line.fails()) return "line " + std::to_string(number) + ": " + line.wrong();
  }
  if (reader.plan.spaces.empty()) return "the plan has no room";
  return std::move(reader.plan);
}

}  // namespace cerberus::sim
