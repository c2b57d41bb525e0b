// SPDX-License-Identifier: LGPL-2.1-or-later
// The names of tuned numbers: all of them are there, and each sets its own.
#include "vision/parameters.h"

#include <check.h>

#include <cstdint>
#include <set>

#include "support/suite.h"
#include "vision/tracking/tracker.h"

using namespace cerberus::vision;

namespace {

constexpr Size kFrame{640, 480};

// Whether the numbers of a stage fill its struct from the first byte to the last, but for what alignment takes.
template <class P>
void check_all_are_named(DetectorParameters& parameters, const P& of) {
  const auto at = [](const auto* p) { return reinterpret_cast<std::uintptr_t>(p); };
  std::set<std::pair<std::uintptr_t, std::uintptr_t>> places;  // first byte, first byte behind
  for (const NamedNumber& n : named_numbers(parameters))
    std::visit(
        [&](auto* number) {
          if (at(number) >= at(&of) && at(number) < at(&of + 1)) places.insert({at(number), at(number + 1)});
        },
        n.number);
  std::uintptr_t end = at(&of);
  for (const auto& [first, behind] : places) {
    ck_assert_msg(first - end < sizeof(int) + (behind - first == sizeof(double)),
                  "%zu bytes of %s have no name", first - end, typeid(of).name());
    end = behind;
  }
  ck_assert_msg(at(&of + 1) - end <= sizeof(int), "the last numbers of %s have no name", typeid(of).name());
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
  check_all_are_named(p, d.regions);
  check_all_are_named(p, d.people);
  check_all_are_named(p, d.height);
  check_all_are_named(p, d.outline);
  check_all_are_named(p, d.box);
  check_all_are_named(p, d.head);
  check_all_are_named(p, d.bodies);
  check_all_are_named(p, d.confirmation);
  check_all_are_named(p, t.track);
  check_all_are_named(p, t.life);
  check_all_are_named(p, t.association);
  check_all_are_named(p, t.search);
  check_all_are_named(p, t.appearance);
  check_all_are_named(p, t.swap);
  check_all_are_named(p, t.view);
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
      {"gate=3", "no number is named \"gate\"", " view.newly_visible_share"},
      {"track.gate", "\"track.gate\" is not stage.name=value", " track.gate_noise "},
      {"", "\"\" is not stage.name=value", " life.still "},
      {"track.gate=", "track.gate takes a number, not \"\"", " track.gate "},
      {"track.gate=3,5", "track.gate takes a number, not \"3,5\"", " track.gate "},
      {"track.gate=nan", "track.gate takes a number, not \"nan\"", " track.gate "},
      {"track.gate=inf", "track.gate takes a number, not \"inf\"", " track.gate "},
      {"life.least_hits=2.5", "life.least_hits takes a whole number, not \"2.5\"", " life.least_hits "},
      {"life.least_hits=99999999999", "life.least_hits takes a whole number", " life.least_hits "},
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
       the_tracker_works_with_the_numbers_that_were_set,
       the_region_finder_works_with_the_numbers_that_were_set});
}
