// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sim/house/house.h"

#include <algorithm>
#include <cmath>

#include "sim/house/textures.h"

namespace cerberus::sim {
namespace {

constexpr Time kStep = std::chrono::milliseconds(10);  // of the sensors, and of what gives way to what
constexpr double kClearance = .35;                     // metres: ways from walls
constexpr double kLeast = .24;                         // metres: people from walls, half of a body's width
constexpr double kApart = 1;                           // metres: people from each other and from the robot

// Numbers of one seed, the same on every machine (the distributions of the standard library are not).
class Dice {
 public:
  explicit Dice(std::uint32_t seed) : seed_(seed) {}
  double between(double from, double to) { return from + (to - from) * (next() / 4294967296.); }
  std::size_t below(std::size_t count) { return std::size_t(next()) * count >> 32; }
  bool chance(double share) { return between(0, 1) < share; }

 private:
  std::uint32_t next() { return scramble(seed_, ++drawn_, 11); }
  std::uint32_t seed_, drawn_ = 0;
};

std::string spot_text(const Spot& spot) {
  const auto text = [](double value) {
    const long centimetres = std::lround(100 * value);
    std::string word = std::to_string(std::abs(centimetres) / 100);
    if (long rest = std::abs(centimetres) % 100) {
      word += rest < 10 ? ".0" : ".";
      word += std::to_string(rest % 10 == 0 ? rest / 10 : rest);
    }
    return (centimetres < 0 ? "-" : "") + word;
  };
  return text(spot.x) + " " + text(spot.y);
}

std::string blocked(const Spot& from, const Spot& to) {
  return "no free way leads from " + spot_text(from) + " to " + spot_text(to) +
         ", .35 m from walls and things";
}

std::string taken(const Spot& spot) {
  return spot_text(spot) + " is not free, .35 m from walls and things";
}

std::vector<Leg> legs_along(const std::vector<Spot>& way, double speed) {
  std::vector<Leg> legs;
  for (const Spot& corner : way) legs.push_back({Leg::drive, corner.x, corner.y, 0, speed});
  return legs;
}

// To the middle of each room and back to the first one; in each it looks all around.
struct Start {
  Spot at;
  double heading = 0;
  std::vector<Leg> legs;
};
std::variant<Start, std::string> patrol_of(const FloorPlan& plan, const Ways& ways, double speed) {
  std::vector<Spot> stations;
  for (const Space& space : plan.spaces) {
    if (space.doorway) continue;
    const double x = (space.area.left + space.area.right) / 2, y = (space.area.top + space.area.bottom) / 2;
    const auto places = ways.places(space);
    if (places.empty()) continue;
    stations.push_back(*std::ranges::min_element(
        places, {}, [&](const Spot& spot) { return std::hypot(spot.x - x, spot.y - y); }));
  }
  if (stations.empty()) return "no room has a free place";
  Start start{stations[0], 0, {}};
  for (std::size_t i = 0; i < stations.size(); ++i) {
    start.legs.push_back({Leg::turn, 0, 0, sensing::radians(360)});
    const Spot &here = stations[i], &next = stations[(i + 1) % stations.size()];
    if (stations.size() == 1) break;
    const auto way = ways.way(here, next);
    if (way.empty()) return blocked(here, next);
    for (const Leg& leg : legs_along(way, speed)) start.legs.push_back(leg);
  }
  return start;
}

std::variant<Start, std::string> start_of(const Route& route, const Ways& ways, double speed) {
  Start start{route.begin, route.heading, {}};
  if (!ways.free(route.begin)) return taken(route.begin);
  Spot here = route.begin;
  const auto drive = [&](const Spot& to, double fast) {
    const auto way = ways.way(here, to);
    for (const Leg& leg : legs_along(way, fast)) start.legs.push_back(leg);
    if (way.empty()) return blocked(here, to);
    here = to;
    return std::string();
  };
  for (const RouteStep& step : route.steps) {
    if (step.kind == RouteStep::go) {
      if (const auto wrong = drive(step.to, step.speed > 0 ? step.speed : speed); !wrong.empty())
        return wrong;
    } else if (step.kind == RouteStep::turn) {
      start.legs.push_back({Leg::turn, 0, 0, step.angle});
    } else {
      start.legs.push_back({Leg::wait, 0, 0, 0, 0, step.seconds});
    }
  }
  if (here.x != route.begin.x || here.y != route.begin.y)
    if (const auto wrong = drive(route.begin, speed); !wrong.empty()) return wrong;
  return start;
}

// Where the robot's way leads below a ceiling that its camera would touch: a sentence without its point.
std::string hits_ceiling(const FloorPlan& plan, Spot at, const std::vector<Leg>& legs, double camera) {
  const auto below = [&](const Spot& spot) {
    const int space = plan.space_at(spot.x, spot.y);
    return space >= 0 && plan.spaces[space].height <= camera ? plan.spaces[space].name : std::string();
  };
  std::string low = below(at);
  for (const Leg& leg : legs) {
    if (leg.kind != Leg::drive) continue;
    constexpr double kStride = .05;  // metres: less than a wall's thickness
    const double way = std::hypot(leg.x - at.x, leg.y - at.y);
    for (double gone = 0; gone < way && low.empty(); gone += kStride)
      low = below({at.x + gone / way * (leg.x - at.x), at.y + gone / way * (leg.y - at.y)});
    at = {leg.x, leg.y};
  }
  return low.empty() ? low : "the camera is as high as the ceiling of '" + low + "', where the robot goes";
}

struct Walk {
  Spot begin;
  double heading = 0;
  std::vector<Instruction> instructions;
};

// Along a way, at rest at its end.
void walk_along(const std::vector<Spot>& way, double speed, Walk& walk) {
  for (std::size_t i = 0; i < way.size(); ++i)
    walk.instructions.push_back({Instruction::go, way[i].x, way[i].y, speed, 0, i + 1 == way.size()});
}

constexpr double kUsual = 1.2;  // metres a second

std::variant<Walk, std::string> walk_of(const Route& route, const Ways& ways) {
  Walk walk{route.begin, route.heading, {}};
  if (!ways.free(route.begin)) return taken(route.begin);
  Spot here = route.begin;
  double speed = kUsual;
  const auto go = [&](const Spot& to) {
    const auto way = ways.way(here, to);
    walk_along(way, speed, walk);
    if (way.empty()) return blocked(here, to);
    here = to;
    return std::string();
  };
  for (const RouteStep& step : route.steps) {
    if (step.kind == RouteStep::go) {
      speed = step.speed > 0 ? step.speed : kUsual;
      if (const auto wrong = go(step.to); !wrong.empty()) return wrong;
    } else {
      walk.instructions.push_back(
          {step.kind == RouteStep::gesture ? Instruction::gesture : Instruction::stand, 0, 0, 0,
           step.seconds});
    }
  }
  if (here.x != route.begin.x || here.y != route.begin.y)
    if (const auto wrong = go(route.begin); !wrong.empty()) return wrong;
  return walk;
}

// From place to place through all rooms, with rests and gestures.
Walk wander(const FloorPlan& plan, const Ways& ways, Dice& dice) {
  std::vector<std::vector<Spot>> rooms;
  for (const Space& space : plan.spaces)
    if (auto places = ways.places(space); !space.doorway && !places.empty())
      rooms.push_back(std::move(places));
  Walk walk;
  if (rooms.empty()) return walk;
  const auto place = [&] {
    const std::vector<Spot>& room = rooms[dice.below(rooms.size())];
    return room[dice.below(room.size())];
  };
  walk.begin = place();
  walk.heading = dice.between(-3, 3);
  Spot here = walk.begin;
  constexpr int kPlaces = 12;
  for (int i = 0; i < kPlaces; ++i) {
    const Spot to = i + 1 < kPlaces ? place() : walk.begin;
    const auto way = ways.way(here, to);
    if (way.empty()) continue;
    walk_along(way, dice.between(.5, 1.6), walk);
    here = to;
    walk.instructions.push_back(
        {dice.chance(.3) ? Instruction::gesture : Instruction::stand, 0, 0, 0, dice.between(.5, 4)});
  }
  return walk;
}

}  // namespace

House::House(FloorPlan plan, const HouseSettings& settings, DrivenBase base)
    : settings_(settings),
      camera_(std::move(plan), settings.lens, settings.seed),
      room_to_step_(camera_.plan(), kLeast),
      base_(std::move(base)) {
  const bool by_hand = settings.shake_kind == ShakeKind::hand;
  for (std::uint32_t i = 0; i < 3; ++i)
    shakes_.emplace_back(settings.shake, by_hand ? .5 : 1.5, by_hand ? 3 : 8, scramble(settings.seed, i, 12));
  for (const double bearing : settings.pir_bearings) sensors_.emplace_back(settings.pir, bearing);
}

std::variant<std::unique_ptr<House>, std::string> House::build(FloorPlan plan,
                                                               const HouseSettings& settings) {
  const Ways ways(plan, kClearance);
  auto start = settings.path.empty() ? patrol_of(plan, ways, settings.speed)
                                     : start_of(settings.path[0], ways, settings.speed);
  if (const auto* wrong = std::get_if<std::string>(&start)) return "the robot's path: " + *wrong;
  auto& [at, heading, legs] = std::get<Start>(start);
  if (const auto wrong = hits_ceiling(plan, at, legs, settings.camera_height); !wrong.empty()) return wrong;
  std::vector<Walk> walks;
  Dice dice(settings.seed);
  for (const Route& route : settings.walks) {
    auto walk = walk_of(route, ways);
    if (const auto* wrong = std::get_if<std::string>(&walk)) return "a person's walk: " + *wrong;
    walks.push_back(std::get<Walk>(std::move(walk)));
  }
  if (settings.walks.empty())
    for (int i = 0; i < settings.people; ++i) walks.push_back(wander(plan, ways, dice));

  DrivenBase::Traits traits;
  traits.yaw_rate = settings.yaw_rate;
  std::unique_ptr<House> house(
      new House(std::move(plan), settings, DrivenBase(at.x, at.y, heading, std::move(legs), traits)));
  for (std::size_t i = 0; i < walks.size(); ++i)
    house->people_.push_back({Walker(walks[i].begin.x, walks[i].begin.y, walks[i].heading,
                                     std::move(walks[i].instructions), {dice.between(1.5, 1.9)}),
                              clothes_of(scramble(settings.seed, std::uint32_t(i), 13))});
  for (const Person& person : house->people_)
    house->subjects_.push_back({&person.walker.stance(), &person.clothes, person.walker.height()});
  // Radiators, windows and screens, two a room: as in lib/sim/patrols.h.
  for (const Space& space : house->camera_.plan().spaces)
    for (int i = 0; i < 2 && !space.doorway; ++i) {
      const Rectangle& area = space.area;
      const double along = dice.between(.2, .8), contrast = dice.between(8, 25);
      const double x = area.left + along * (area.right - area.left),
                   y = area.top + along * (area.bottom - area.top);
      const Spot places[] = {
          {area.left + .1, y}, {x, area.top + .1}, {area.right - .1, y}, {x, area.bottom - .1}};
      house->things_.push_back({places[dice.below(4)], 1, dice.chance(.5) ? contrast : -contrast});
    }
  return house;
}

// A person who would walk into somebody, the robot, a wall or a thing slides along it.
void House::keep_off(Person& person, const Spot& before) const {
  constexpr double kBody = .4;  // metres: a person beside another one, or beside the robot
  Walker& walker = person.walker;
  const auto touch = [&](const Spot& other) {
    const Spot away{walker.stance().x - other.x, walker.stance().y - other.y};
    const double here = std::hypot(away.x, away.y);
    const double least = std::min(kBody, std::hypot(before.x - other.x, before.y - other.y));
    if (here < least && here > 0)
      walker.touch({other.x + least / here * away.x, other.y + least / here * away.y},
                   {away.x / here, away.y / here});
  };
  for (const Person& other : people_)
    if (&other != &person) touch({other.walker.stance().x, other.walker.stance().y});
  touch({base_.x(), base_.y()});
  const Spot now{walker.stance().x, walker.stance().y};
  for (const Spot& allowed : {now, Spot{before.x, now.y}, Spot{now.x, before.y}, before})
    if (room_to_step_.free(allowed)) return walker.stop_at(allowed);
}

// Those who come near each other, or near the robot, slow down and go past to the right.
void House::step_aside() {
  constexpr double kAhead = 2, kFast = 2;  // seconds, and metres a second (assumed)
  for (Person& person : people_) {
    const Stance& own = person.walker.stance();
    const Instruction& now = person.walker.now();
    const bool goes = now.kind == Instruction::go;
    // It looks ahead until it stops.
    double most = kAhead;
    if (goes && now.stops)
      most = std::min(most, std::hypot(now.x - own.x, now.y - own.y) / std::max(own.speed, .1));
    Spot away{}, right{};  // from the others, and past them
    const auto avoid = [&](const Spot& other, const Spot& velocity) {
      const Spot from{own.x - other.x, own.y - other.y};
      const Spot going{person.walker.velocity().x - velocity.x, person.walker.velocity().y - velocity.y};
      const double square = going.x * going.x + going.y * going.y;
      const double nearer = -(from.x * going.x + from.y * going.y);
      const double in = nearer > 0 ? std::min(nearer / square, most) : 0;  // seconds: they are nearest
      const double least = std::hypot(from.x + in * going.x, from.y + in * going.y);
      const double here = std::hypot(from.x, from.y);
      if (least >= kApart || here < 1e-6) return;
      const double share = std::min((kApart - least) / std::max(in, least), kFast) / here;
      away.x += share * from.x, away.y += share * from.y;
      right.x += share * from.y, right.y -= share * from.x;
    };
    for (const Person& other : people_)
      if (&other != &person)
        avoid({other.walker.stance().x, other.walker.stance().y}, other.walker.velocity());
    avoid({base_.x(), base_.y()},
          {base_.speed() * std::cos(base_.yaw()), base_.speed() * std::sin(base_.yaw())});
    constexpr double kSoon = .1;  // seconds: at .2 people meet in doorways more often
    const auto possible = [&](const Spot& push) {
      const Spot aside{own.x + kSoon * push.x, own.y + kSoon * push.y};
      return room_to_step_.leads(aside, goes ? Spot{now.x, now.y} : aside);
    };
    const Spot both{away.x + right.x, away.y + right.y};
    person.walker.give_way(possible(both) ? both : possible(away) ? away : Spot{});
  }
}

// A place beside somebody counts as reached, and who gets no further goes back and comes again.
void House::see_progress() {
  constexpr double kSoon = 1, kLong = 3;  // seconds (assumed; at 2, deadlocks with six people in the office)
  const auto lead = [this](Walker& walker) {
    walker.lead(room_to_step_.way({walker.stance().x, walker.stance().y}, walker.destination()));
  };
  for (Person& person : people_) {
    Walker& walker = person.walker;
    const Instruction &now = walker.now(), &then = walker.then();
    if (now.kind != Instruction::go || walker.held_up() < kSoon) continue;
    const Spot here{walker.stance().x, walker.stance().y}, place{now.x, now.y};
    const auto beside = [&](double x, double y) { return std::hypot(x - place.x, y - place.y) < kApart; };
    const bool taken = beside(base_.x(), base_.y()) || std::ranges::any_of(people_, [&](const Person& other) {
                         return &other != &person && beside(other.walker.stance().x, other.walker.stance().y);
                       });
    if (now.stops ? taken && std::hypot(here.x - place.x, here.y - place.y) < 2 * kApart
                  : then.kind == Instruction::go && room_to_step_.leads(here, {then.x, then.y})) {
      walker.arrive();
    } else if (!room_to_step_.leads(here, place)) {
      lead(walker);
    } else if (walker.held_up() > kLong) {
      if (walker.returns())
        lead(walker);
      else
        walker.send_back(room_to_step_.way(here, walker.origin()));
    }
  }
}

// The robot waits for those who are before it. While it backs it heeds what is behind it, walls too.
void House::heed_people() {
  constexpr double kAhead = .9, kBehind = .5, kAside = .4;  // metres
  const double side = base_.backs() ? -1 : 1;
  const double way_x = side * std::cos(base_.yaw()), way_y = side * std::sin(base_.yaw());
  const bool walled =
      base_.backs() && !room_to_step_.leads({base_.x(), base_.y()},
                                            {base_.x() + kBehind * way_x, base_.y() + kBehind * way_y});
  base_.block(walled || std::ranges::any_of(people_, [&](const Person& person) {
                const double x = person.walker.stance().x - base_.x(),
                             y = person.walker.stance().y - base_.y();
                const double ahead = x * way_x + y * way_y, aside = y * way_x - x * way_y;
                return ahead > 0 && ahead < kAhead && std::abs(aside) < kAside;
              }));
}

void House::sense(Time now) {
  seen_.clear();
  const Spot here{base_.x(), base_.y()};
  const auto add = [&](const Spot& at, double width, double contrast) {
    const double x = at.x - here.x, y = at.y - here.y;
    const double away = std::max(std::hypot(x, y), .1);
    const bool hidden = !room_to_step_.sees(here, at);
    seen_.push_back({sensing::wrap(std::atan2(y, x) - base_.yaw()),
                     hidden ? 0 : 2 * std::atan(width / 2 / away), contrast, away});
  };
  for (const Person& person : people_)
    add({person.walker.stance().x, person.walker.stance().y}, kPersonWidth, kPersonContrast);
  for (const Thing& thing : things_) add(thing.at, thing.width, thing.contrast);
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    const bool before = sensors_[i].output();
    sensors_[i].elapse(now, seen_);
    if (sensors_[i].output() != before) edges_.push_back({now, int(i), sensors_[i].output()});
  }
}

void House::elapse(Time now) {
  const auto move = [&](Time until) {
    base_.elapse(until);
    for (Person& person : people_) {
      const Spot before{person.walker.stance().x, person.walker.stance().y};
      person.walker.elapse(until);
      keep_off(person, before);
    }
  };
  for (; stepped_ + kStep <= now; stepped_ += kStep) {
    move(stepped_ + kStep);
    step_aside();
    see_progress();
    heed_people();
    sense(stepped_ + kStep);
  }
  move(now);
}

Pose House::pose(Time now, const Gaze& gaze) const {
  // A robot that stands does not shake.
  const double robot =
      std::min(1., std::abs(base_.speed()) / .6 + std::abs(base_.yaw_rate()) / sensing::radians(45));
  const double moves = settings_.shake_kind == ShakeKind::hand ? 1 : robot;
  const double t = motion::seconds(now);
  return {base_.x(),
          base_.y(),
          settings_.camera_height,
          base_.yaw() + gaze.pan + moves * shakes_[0].at(t),
          gaze.tilt + moves * shakes_[1].at(t),
          moves * shakes_[2].at(t)};
}

void House::take(Time time, const std::function<Gaze(Time)>& gaze, std::vector<std::uint8_t>& i420) {
  edges_.clear();
  for (std::size_t i = 0; i < camera_.plan().lamps.size(); ++i) {
    const Lamp& lamp = camera_.plan().lamps[i];
    if (const bool lit = lamp.lit(motion::seconds(time)); lit != lamp.on) camera_.switch_lamp(int(i), lit);
  }
  const Time begin = std::max(time - settings_.exposure, stepped_);
  elapse(begin);
  const Pose first = pose(begin, gaze(begin));
  Pose last = pose(time, gaze(time));
  last.yaw += base_.yaw_rate() * motion::seconds(time - begin);
  const int parts = camera_.parts(first, last);
  for (int i = 0; i < parts; ++i) {
    const Time now = begin + (time - begin) * (i + 1) / parts;
    elapse(now);
    camera_.expose(pose(now, gaze(now)), subjects_);
  }
  camera_.develop(i420);
}

}  // namespace cerberus::sim
