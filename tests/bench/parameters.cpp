// SPDX-License-Identifier: LGPL-2.1-or-later
#include "parameters.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <initializer_list>
#include <utility>

namespace cerberus::bench {
namespace {

using namespace vision;

// The numbers of one stage.
class Numbers {
 public:
  Numbers(std::vector<NamedNumber>& all, std::string stage) : all_(all), stage_(std::move(stage)) {}
  Numbers part(const char* name) { return {all_, stage_ + '.' + name}; }
  struct Number {
    const char* name;
    std::variant<double*, int*> number;
    int least = 0;
  };
  void add(std::initializer_list<Number> numbers) {
    for (const Number& n : numbers) all_.push_back({stage_ + '.' + n.name, n.number, n.least});
  }

 private:
  std::vector<NamedNumber>& all_;
  std::string stage_;
};

// A member of a struct's table: a name cannot stand for another member. tests/unit/parameters finds missing ones.
#define N(member)      \
  Numbers::Number {    \
    #member, &p.member \
  }
// The same of a number that is 1 at least, as a divisor.
#define D(member) Numbers::Number{#member, &p.member, 1}

void name(Numbers n, BlobParting::Parameters& p) {
  n.add({N(least_height), N(trunk), N(valley), N(changed)});
}

void name(Numbers n, RegionParameters& p) {
  n.add({N(least_share), N(narrowest),  N(widest), N(least_filled), N(tallest),   N(usual_least),
         N(usual_most),  N(alone),      N(across), N(down),         N(joined),    N(least_unknown),
         N(walked),      N(stirs),      N(beside), N(loose),        N(feet),      N(slack),
         N(explained),   N(same_block), N(young),  N(rim),          N(confidence)});
}

void name(Numbers n, PeopleFinder::Part& p) {
  n.add({N(top), N(bottom), N(core), N(reach), N(core_moving), N(side_moving)});
}

void name(Numbers n, PeopleFinder::Parameters& p) {
  n.add({N(elsewhere),    N(price),      N(height_weight), N(spread),      N(unknown_spread), N(unknown_step),
         N(other_height), N(least_gain), N(aspect),        D(cells),       N(above),          N(below),
         N(least_feet),   D(least_part), D(edge_part),     D(edge_step),   N(one_wide),       N(solid),
         N(block_width),  N(gaps),       N(gaps_after),    N(gaps_unknown)});
  name(n.part("free_space"), p.free_space);
  name(n.part("head"), p.body[0]);
  name(n.part("trunk"), p.body[1]);
  name(n.part("legs"), p.body[2]);
}

void name(Numbers n, HeightPrior::Parameters& p) {
  n.add({N(spread), N(agree), N(share), N(least), N(uncertain), N(repeats), N(guesses), D(through_horizon),
         D(slope_spread), N(baseline), D(refit)});
}

void name(Numbers n, OutlineFinder::Parameters& p) {
  n.add({N(skirt), N(reach), N(thickness), N(shadow_zone), N(knee), N(slope), N(toes), D(least_leg)});
}

void name(Numbers n, BoxEdgeParameters& p) {
  n.add({N(blur), N(most)});
}

void name(Numbers n, PersonBoxParameters& p) {
  n.add({N(aspect),    N(measured),    N(reach),       N(column),     N(below_head),   N(above_feet),
         N(rests),     N(changes),     N(trunk),       N(head_reach), N(head_row),     N(head_rise),
         N(head_fall), N(leg_reach),   N(foot_row),    N(foot_fall),  N(shadow_reach), N(legs_from),
         N(legs_to),   N(shadow_wide), N(shadow_from), N(shadow_tip)});
}

void name(Numbers n, FreeHeadParameters& p) {
  n.add({N(rows), N(core), N(beside_from), N(beside_to), N(least_core), N(most_beside)});
}

void name(Numbers n, WalkingBodies::Parameters& p) {
  n.add({N(step_x), N(step_y), N(same_height), N(least_frames), N(stride)});
}

void name(Numbers n, TwoFrameConfirmation::Parameters& p) {
  n.add({N(frames), N(first), N(small), N(speck), N(common), N(reach), N(slack)});
}

void name(Numbers n, TrackParameters& p) {
  n.add({N(acceleration),
         N(panned_acceleration),
         N(fast),
         N(birth_speed),
         N(position_noise),
         N(grain),
         N(blob_noise),
         N(size_noise),

         N(border_wander),
         N(fade),

         N(brake),

         N(same_extent),

         N(stride),
         N(gate_noise),
         N(gate),
         N(fragment),
         N(fragment_gate),
         N(size_cost),
         N(gate_cost),
         N(border),

         N(cut_margin),

         N(end_speed),
         N(upright),

         N(lasts),

         N(extent_known),

         N(thing_group),
         N(stand_speed),
         N(settled),
         N(appearance_time),
         N(appearance_frames),
         N(found_noise),

         N(apart),
         N(different),
         N(covered),
         N(travelled)});
}

void name(Numbers n, LifeCycle::Parameters& p) {
  n.add(
      {N(least_travel), N(least_hits), N(confirm_slack), N(hit_share), N(coast_share), N(certain), N(seen)});
}

void name(Numbers n, DataAssociation::Parameters& p) {
  n.add({N(unmatched), N(shared), N(leap), N(usual_change), N(appearance_cost), N(known_cost), N(known_time),
         N(sudden_change), N(larger), N(inside), N(occluded_overlap)});
}

void name(Numbers n, RegionAppearances::Parameters& p) {
  n.add({D(samples), D(rough_samples), N(reach), N(displacement), N(steps), N(inside)});
}

void name(Numbers n, AppearanceParameters& p) {
  n.add({N(dark)});
}

#undef D
#undef N

std::string quoted(std::string_view text) {
  return '"' + std::string(text) + '"';
}

// "names: track.gate track.gate_noise ...", of one stage if there is such a stage.
std::string names_like(const std::vector<NamedNumber>& all, std::string_view name) {
  const std::string stage(name.substr(0, name.find('.') + 1));
  const auto is_like = [&](const NamedNumber& n) { return !stage.empty() && n.name.starts_with(stage); };
  const bool known = std::ranges::any_of(all, is_like);
  std::string names;
  for (const NamedNumber& n : all)
    if (!known || is_like(n)) names += ' ' + n.name;
  return "; the names are:" + names;
}

}  // namespace

std::vector<NamedNumber> named_numbers(DetectorParameters& p) {
  std::vector<NamedNumber> all;
  const auto stage = [&](const char* of, auto& numbers) { name({all, of}, numbers); };
  stage("parting", p.detection.parting);
  stage("regions", p.detection.regions);
  stage("people", p.detection.people);
  stage("height", p.detection.height);
  stage("outline", p.detection.outline);
  stage("box", p.detection.box);
  stage("edge", p.edge);
  stage("head", p.detection.head);
  stage("bodies", p.detection.bodies);
  stage("confirmation", p.detection.confirmation);
  stage("track", p.tracking.track);
  stage("life", p.tracking.life);
  stage("association", p.tracking.association);
  stage("search", p.tracking.search);
  stage("appearance", p.tracking.appearance);
  return all;
}

std::string set_number(DetectorParameters& parameters, std::string_view assignment) {
  const auto all = named_numbers(parameters);
  const auto equals = assignment.find('=');
  if (equals == std::string_view::npos)
    return quoted(assignment) + " is not stage.name=value" + names_like(all, assignment);
  const std::string_view name = assignment.substr(0, equals), value = assignment.substr(equals + 1);
  const auto found = std::ranges::find(all, name, &NamedNumber::name);
  if (found == all.end()) return "no number is named " + quoted(name) + names_like(all, name);
  const auto read = [&](auto& number) {
    const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
    return error == std::errc() && end == value.data() + value.size();
  };
  std::string takes;
  if (int* const* whole = std::get_if<int*>(&found->number)) {
    constexpr int kMost = 1'000'000;  // no count of pixels, frames or samples is as large
    int number = 0;
    if (read(number) && number >= found->least && number <= kMost) {
      **whole = number;
      return {};
    }
    takes = "a whole number from " + std::to_string(found->least) + " to " + std::to_string(kMost);
  } else {
    double number = 0;
    if (read(number) && std::isfinite(number)) {
      *std::get<double*>(found->number) = number;
      return {};
    }
    takes = "a number";
  }
  return std::string(name) + " takes " + takes + ", not " + quoted(value) + names_like(all, name);
}

}  // namespace cerberus::bench
