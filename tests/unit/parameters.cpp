// SPDX-License-Identifier: LGPL-2.1-or-later
// The names of tuned numbers: all of them are there, and each sets its own.
#include "bench/parameters.h"

#include <check.h>

#include <cstdint>
#include <set>
#include <string>
#include <utility>

#include "support/suite.h"
#include "vision/detection/regions.h"
#include "vision/tracking/tracker.h"

using namespace cerberus::vision;
using namespace cerberus::bench;

namespace {

constexpr Size kFrame{640, 480};

// The number of a struct's members: the most values that it can be initialised with.
struct AnyValue {
  template <class T>
  operator T() const;
};
template <class P, class... Values>
constexpr std::size_t members() {
  if constexpr (requires { P{std::declval<Values>()..., std::declval<AnyValue>()}; })
    return members<P, Values..., AnyValue>();
  else
    return sizeof...(Values);
}

// The names of a stage; each one's number lies in `of`, and has no other name.
template <class P>
std::size_t names_in(DetectorParameters& parameters, const char* stage, const P& of) {
  const auto at = [](const auto* p) { return reinterpret_cast<std::uintptr_t>(p); };
  std::set<std::uintptr_t> places;
  for (const NamedNumber& n : named_numbers(parameters)) {
    if (!n.name.starts_with(std::string(stage) + '.')) continue;
    const std::uintptr_t place = std::visit(at, n.number);
    ck_assert_msg(place >= at(&of) && place < at(&of + 1) && places.insert(place).second, "%s",
                  n.name.c_str());
  }
  return places.size();
}

// Tracks after a person has walked for a second.
std::size_t tracks_with(const char* assignment) {
  DetectorParameters parameters;
  ck_assert(set_number(parameters, assignment).empty());
  Tracker tracker;
  tracker.set_parameters(parameters.tracking);
  std::size_t tracks = 0;
  for (int k = 0; k < 10; ++k) {
    const Region region{{100.0 + 10 * k, 100, 40, 100}, 4000, 0.9, 1, RegionKind::person_like};
    tracks = tracker.update({&region, 1}, {}, 0.1, kFrame).size();
  }
  return tracks;
}

}  // namespace

START_TEST(every_number_of_every_stage_has_a_name_of_its_own) {
  DetectorParameters p;
  const DetectionParameters& d = p.detection;
  const TrackingParameters& t = p.tracking;
  const auto all_are_named = [&]<class P>(const char* stage, const P& of) {
    ck_assert_msg(names_in(p, stage, of) == members<P>(), "%s has %zu members", stage, members<P>());
  };
  all_are_named("parting", d.parting);
  all_are_named("regions", d.regions);
  const std::size_t parts = 1 + d.people.body.size();  // each a member of its own or of an array
  ck_assert_uint_eq(names_in(p, "people", d.people),
                    members<PeopleFinder::Parameters>() - 2 + parts * members<PeopleFinder::Part>());
  all_are_named("height", d.height);
  all_are_named("outline", d.outline);
  all_are_named("box", d.box);
  all_are_named("edge", p.edge);
  all_are_named("head", d.head);
  all_are_named("bodies", d.bodies);
  all_are_named("confirmation", d.confirmation);
  all_are_named("track", t.track);
  all_are_named("life", t.life);
  all_are_named("association", t.association);
  all_are_named("search", t.search);
  all_are_named("appearance", t.appearance);
  std::set<std::string> names;
  for (const NamedNumber& n : named_numbers(p))
    ck_assert_msg(names.insert(n.name).second, "%s", n.name.c_str());
}
END_TEST

START_TEST(an_assignment_sets_the_number_of_that_name_only) {
  DetectorParameters p;
  ck_assert(set_number(p, "track.gate=3.5").empty());
  ck_assert(set_number(p, "life.least_hits=7").empty());
  ck_assert(set_number(p, "people.head.reach=-1e-2").empty());
  ck_assert_double_eq(p.tracking.track.gate, 3.5);
  ck_assert_int_eq(p.tracking.life.least_hits, 7);
  ck_assert_double_eq(p.detection.people.body[0].reach, -0.01);
  ck_assert_double_eq(p.tracking.track.gate_noise, TrackParameters().gate_noise);
  ck_assert_double_eq(p.detection.people.body[1].reach, PeopleFinder::Parameters().body[1].reach);
}
END_TEST

START_TEST(a_wrong_assignment_changes_nothing_and_the_error_lists_the_names) {
  const struct {
    const char *assignment, *says, *lists;
  } wrong[] = {
      {"track.gates=3", "no number is named \"track.gates\"", " track.gate "},
      {"tracks.gate=3", "no number is named \"tracks.gate\"", " regions.least_share "},
      {"gate=3", "no number is named \"gate\"", " appearance.dark"},
      {"track.gate", "\"track.gate\" is not stage.name=value", " track.gate_noise "},
      {"", "\"\" is not stage.name=value", " life.seen "},
      {"track.gate=", "track.gate takes a number, not \"\"", " track.gate "},
      {"track.gate=3,5", "track.gate takes a number, not \"3,5\"", " track.gate "},
      {"track.gate=nan", "track.gate takes a number, not \"nan\"", " track.gate "},
      {"track.gate=inf", "track.gate takes a number, not \"inf\"", " track.gate "},
      {"life.least_hits=2.5", "life.least_hits takes a whole number from 0 to 1000000, not \"2.5\"",
       " life.least_hits "},
      {"life.least_hits=99999999999", "life.least_hits takes a whole number", " life.least_hits "},
      {"life.least_hits=-1", "life.least_hits takes a whole number", " life.least_hits "},
      {"people.cells=1000001", "people.cells takes a whole number from 1 to 1000000", " people.cells "},
  };
  for (const auto& w : wrong) {
    DetectorParameters p;
    const std::string error = set_number(p, w.assignment);
    ck_assert_msg(error.starts_with(w.says), "%s: %s", w.assignment, error.c_str());
    ck_assert_msg((error + ' ').find(w.lists) != std::string::npos, "%s: %s", w.assignment, error.c_str());
    ck_assert_double_eq(p.tracking.track.gate, TrackParameters().gate);
    ck_assert_int_eq(p.tracking.life.least_hits, LifeCycle::Parameters().least_hits);
  }
}
END_TEST

START_TEST(a_number_by_which_something_is_divided_is_at_least_1) {
  for (const std::string name :
       {"people.cells", "people.least_part", "people.edge_part", "people.edge_step", "height.through_horizon",
        "height.refit", "search.samples", "search.rough_samples"}) {
    DetectorParameters p;
    ck_assert(set_number(p, name + "=0").starts_with(name + " takes a whole number from 1 "));
    ck_assert(set_number(p, name + "=1").empty());
  }
  DetectorParameters p;
  ck_assert(set_number(p, "regions.young=0").empty());  // no frame is
}
END_TEST

START_TEST(the_tracker_works_with_the_numbers_that_were_set) {
  // Its age in the tenth frame is .9 s, confirm-time .2 s; it has gone 90 pixels, .9 of its length.
  ck_assert_uint_eq(tracks_with("life.confirm_slack=4.4"), 1);
  ck_assert_uint_eq(tracks_with("life.confirm_slack=4.6"), 0);
  ck_assert_uint_eq(tracks_with("life.least_travel=2"), 0);
}
END_TEST

START_TEST(the_region_finder_works_with_the_numbers_that_were_set) {
  for (const double share : {0.001, 0.1}) {  // a square of 40 in 320x240 is .021 of the picture
    DetectorParameters p;
    ck_assert(set_number(p, "regions.least_share=" + std::to_string(share)).empty());
    RegionFinder finder;
    finder.set_parameters(p.detection);
    std::vector<std::uint8_t> pixels(320 * 240);
    for (int y = 100; y < 140; ++y) std::fill_n(pixels.begin() + 320 * y + 100, 40, std::uint8_t{255});
    ck_assert_uint_eq(finder.update({pixels.data(), 320, 240, 320}, {}, {}).size(), share < 0.05 ? 1 : 0);
  }
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "parameters",
      {every_number_of_every_stage_has_a_name_of_its_own, an_assignment_sets_the_number_of_that_name_only,
       a_wrong_assignment_changes_nothing_and_the_error_lists_the_names,
       a_number_by_which_something_is_divided_is_at_least_1, the_tracker_works_with_the_numbers_that_were_set,
       the_region_finder_works_with_the_numbers_that_were_set});
}
