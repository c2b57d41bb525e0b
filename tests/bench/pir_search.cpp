// SPDX-License-Identifier: LGPL-2.1-or-later
// A robot with PIR sensors that moves (lib/sim/patrols.h): how soon a person who comes out of sight is in the picture,
// and what the robot's own motion makes of its sensors while no person is there. Sensor fusion and the control law are
// this project's; time is the bench's own.
//
//   bench-pir_search                      all, judged
//   bench-pir_search FB patrol,drive [40] these heads (lib/sim/head_kinds.h) and patrols, this number of seeds
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "asked.h"
#include "drivers/helper/option_words.h"
#include "project_law.h"
#include "sim/patrols.h"

using namespace cerberus;
using namespace cerberus::bench;
using std::chrono::milliseconds;

namespace {

constexpr char kHeads[] = "FB";
constexpr int kSeeds = 40, kSeedsAlone = 10;
constexpr unsigned kDraws = 4;                 // seeds of a run
constexpr double kPatience = 30, kAlone = 60;  // seconds: after the person came; without one
constexpr double kNever = 99;                  // seconds

// Sensors all around.
struct Layout {
  int count;
  double field;  // degrees
};
constexpr Layout kLayouts[] = {{3, 110}, {6, 60}};

class Sensors {
 public:
  explicit Sensors(const Layout& layout) : readings_(static_cast<std::size_t>(layout.count)) {
    sim::PirTraits traits;
    const double field = sensing::radians(layout.field);
    traits.zones = static_cast<int>(std::lround(traits.zones * field / traits.field));
    traits.field = field;
    std::vector<double> bearings;
    for (int i = 0; i < layout.count; ++i)
      bearings.push_back(sensing::wrap(sensing::radians(360. / layout.count * i)));
    for (const double bearing : bearings) sensors_.emplace_back(traits, bearing);
    geometry_.set(bearings, field);
  }
  void elapse(Time now, std::span<const sim::Warmth> things) {
    for (std::size_t i = 0; i < sensors_.size(); ++i) {
      sensors_[i].elapse(now, things);
      readings_[i] = sensors_[i].output();
    }
  }
  const std::vector<std::uint8_t>& readings() const { return readings_; }
  const sensing::Geometry& geometry() const { return geometry_; }

 private:
  std::vector<sim::PirSensor> sensors_;
  std::vector<std::uint8_t> readings_;
  sensing::Geometry geometry_;
};

// What the decisions of a run were.
struct Tally {
  int frames = 0, alarmed = 0, looking = 0, looks = 0;
};

class Decider {
 public:
  Decider(const sim::Patrol& patrol, const Sensors& sensors, ProjectLaw& law, double lens)
      : patrol_(patrol), sensors_(sensors), law_(law) {
    fusion::FuserOptions options;
    options.lens = lens;
    fuser_.set_options(options);
    fuser_.set_geometry(sensors.geometry());
  }
  fusion::Decision operator()(Time taken, std::span<const fusion::Track> tracks) {
    constexpr int kConfirmed = 5;  // pictures with the person until there is a track
    constexpr double kStep = .02;  // seconds, of the odometry
    pictures_ = tracks.empty() ? 0 : pictures_ + 1;
    const double t = motion::seconds(taken);
    fusion::Input input;
    input.time = taken;
    if (pictures_ >= kConfirmed) input.tracks = tracks;
    input.sensors = sensors_.readings();
    input.pan = law_.look(taken);
    input.base_yaw_rate = (patrol_.yaw(t) - patrol_.yaw(t - kStep)) / kStep;
    input.base_speed = patrol_.speed;
    const fusion::Decision& decision = fuser_.update(input);
    count(decision);
    return decision;
  }
  const Tally& tally() const { return tally_; }

 private:
  void count(const fusion::Decision& decision) {
    using fusion::Action;
    const bool looks = decision.action == Action::turn_left || decision.action == Action::turn_right ||
                       decision.action == Action::search;
    ++tally_.frames;
    if (decision.fired != 0) ++tally_.alarmed;
    if (looks) ++tally_.looking;
    if (looks && !looks_) ++tally_.looks;
    looks_ = looks;
  }

  const sim::Patrol& patrol_;
  const Sensors& sensors_;
  ProjectLaw& law_;
  fusion::Fuser fuser_;
  Tally tally_;
  int pictures_ = 0;
  bool looks_ = false;
};

// One robot with its head, its sensors and its surroundings.
class Robot {
 public:
  Robot(char letter, const std::string& name, const Layout& layout, unsigned seed)
      : kind_(sim::head_kind(letter, draw(seed, 0))),
        patrol_(sim::patrol(name, draw(seed, 1))),
        head_(kind_.traits, draw(seed, 2)),
        camera_(traits_, draw(seed, 3)),
        sensors_(layout),
        law_(kind_, head_, traits_),
        decider_(patrol_, sensors_, law_, traits_.field_of_view) {
    law_.decide_with(
        [this](Time taken, std::span<const fusion::Track> tracks) { return decider_(taken, tracks); });
  }
  // Returns the seconds until the person is in the picture.
  double find() {
    while (motion::seconds(now_) < patrol_.comes + kPatience)
      if (elapse(true)) return motion::seconds(now_) - patrol_.comes;
    return kNever;
  }
  const Tally& patrol_alone() {
    while (motion::seconds(now_) < kAlone) elapse(false);
    return decider_.tally();
  }

 private:
  static unsigned draw(unsigned seed, unsigned n) { return 104729 * (kDraws * seed + n); }

  // A millisecond. Returns whether the person is in the picture.
  bool elapse(bool comes) {
    now_ += milliseconds(1);
    const double t = motion::seconds(now_), yaw = patrol_.yaw(t);
    const bool there = comes && t >= patrol_.comes;
    head_.elapse(now_);
    if (there && !came_from_) came_from_ = yaw + head_.camera() + patrol_.first;
    const double bearing = there ? *came_from_ + patrol_.walked(t - patrol_.comes) - yaw : 0;
    const double off = sensing::wrap(bearing - head_.camera());
    if (there && std::abs(off) < traits_.field_of_view / 2) return true;
    if (now_ % milliseconds(10) == Time::zero()) {
      patrol_.look(t, things_);
      things_.push_back(there ? patrol_.person(bearing) : sim::Warmth{});
      sensors_.elapse(now_, things_);
    }
    if (now_ >= camera_.next()) take(off, yaw, there);
    const auto delay = milliseconds(std::lround(traits_.delay * 1000));
    for (; !coming_.empty() && coming_.front().picture.taken + delay <= now_; coming_.pop_front())
      law_.on_picture(coming_.front(), now_);
    law_.elapse(now_);
    return false;
  }
  void take(double off, double yaw, bool there) {
    Seen seen;
    seen.picture = camera_.take(now_, off, yaw + head_.camera(), there);
    seen.base_turn = yaw - last_yaw_;
    seen.base_yaw = last_yaw_ = yaw;
    seen.base_reported = true;
    coming_.push_back(seen);
  }

  sim::CameraTraits traits_;
  sim::HeadKind kind_;
  sim::Patrol patrol_;
  sim::PanHead head_;
  sim::Camera camera_;
  Sensors sensors_;
  ProjectLaw law_;
  Decider decider_;
  Time now_{};
  std::vector<sim::Warmth> things_;
  std::deque<Seen> coming_;
  std::optional<double> came_from_;  // bearing in the world
  double last_yaw_ = 0;
};

struct Figures {
  double found = 0, found_mostly = 0;          // seconds: the median, nine of ten
  double alarmed = 0, looking = 0, looks = 0;  // without a person: percent of the time, percent, a minute
};

Figures measure(char letter, const std::string& name, const Layout& layout, int seeds) {
  std::vector<double> found;
  Figures figures;
  for (int seed = 1; seed <= seeds; ++seed)
    found.push_back(Robot(letter, name, layout, static_cast<unsigned>(seed)).find());
  std::ranges::sort(found);
  const auto at = [&](double part) {
    return found[static_cast<std::size_t>(part * static_cast<double>(found.size() - 1))];
  };
  figures.found = at(.5);
  figures.found_mostly = at(.9);
  for (int seed = 1; seed <= kSeedsAlone; ++seed) {
    Robot robot(letter, name, layout, static_cast<unsigned>(seed));
    const Tally& tally = robot.patrol_alone();
    figures.alarmed += 100. * tally.alarmed / tally.frames / kSeedsAlone;
    figures.looking += 100. * tally.looking / tally.frames / kSeedsAlone;
    figures.looks += 60. / kAlone * tally.looks / kSeedsAlone;
  }
  return figures;
}

// What is asked. Seconds until a person is in the picture, the median.
double latest(const sim::Patrol& patrol) {
  return patrol.speed != 0 ? 3.5 : 3;
}
// Looks a minute without a person: none where nothing warm is, or nothing moves.
double most_looks(const sim::Patrol& patrol) {
  return patrol.things.empty() || patrol.name == "around" ? 0 : 18;
}

void print_row(Asked& asked, char letter, const std::string& name, const Layout& layout, int seeds) {
  const Figures f = measure(letter, name, layout, seeds);
  const sim::Patrol patrol = sim::patrol(name, 1);
  const std::string what = std::string(1, letter) + ", " + std::to_string(layout.count) + " sensors, " + name;
  std::printf("%4c %4d x %3.0f %-7s %6.2f%s %11.2f %9.1f %%%s %6.1f%s %7.0f %%\n", letter, layout.count,
              layout.field, name.c_str(), f.found,
              asked.at_most(what + ", in the picture", f.found, latest(patrol)).c_str(), f.found_mostly,
              f.alarmed, asked.at_most(what + ", alarmed", f.alarmed, 0).c_str(), f.looks,
              asked.at_most(what + ", looks", f.looks, most_looks(patrol)).c_str(), f.looking);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  Asked asked;
  const bool chosen = argc > 2;
  const std::string heads = chosen ? argv[1] : kHeads;
  const std::vector<std::string> names =
      chosen ? drivers::split(argv[2], ',')
             : std::vector<std::string>(std::begin(sim::kPatrols), std::end(sim::kPatrols));
  const int seeds = argc > 3 ? std::atoi(argv[3]) : kSeeds;
  std::printf(
      "seconds until a person is in the picture: median of %d seeds, and nine of ten; without a person: the "
      "time "
      "in which a sensor counts, looks a minute, and the time that they take\n"
      "head  sensors patrol  in picture  nine of ten  alarmed  looks  looking\n",
      seeds);
  for (const char letter : heads)
    for (const Layout& layout : kLayouts)
      for (const std::string& name : names) print_row(asked, letter, name, layout, seeds);
  return chosen ? 0 : asked.verdict();
}
