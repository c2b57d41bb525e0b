// SPDX-License-Identifier: LGPL-2.1-or-later
// Where the head turns when a sensor fires and no person is in the picture.
#include "fuser_stream.h"

#include <array>
#include <cmath>

using namespace stream;

START_TEST(a_sensor_makes_the_head_turn_and_then_sweep) {
  Stream stream;
  stream.pan = 100;
  stream.sensors = {0, 1, 0};
  const Decision& decision = stream.frame();
  assert_says(decision, Action::turn_left, 0, "sector");
  assert_sector(decision, -170, -60);  // infer2's 120 degrees, as far as the head turns
  ck_assert_int_eq(decision.fired, 0b010);
  stream.pan = -59;
  stream.frame();
  assert_says(decision, Action::turn_left, 0, "sector");
  stream.pan = -61;
  stream.frame();
  assert_says(decision, Action::search, 0, "sector");
  assert_sector(decision, -150, -90);
  ck_assert(!decision.limited);
  stream.pan = -58.5;  // hysteresis
  stream.frame();
  assert_says(decision, Action::search, 0, "sector");
  stream.pan = -57.5;
  stream.frame();
  assert_says(decision, Action::turn_left, 0, "sector");
}
END_TEST

START_TEST(another_sensor_is_a_new_question) {
  Stream stream;
  stream.pan = -59;
  stream.sensors = {1, 0, 0};
  const Decision& decision = stream.frame();
  ck_assert(decision.action == Action::search);
  stream.sensors = {0, 1, 0};  // one degree away: that is outside, hysteresis belongs to the old place
  stream.frame();
  ck_assert(decision.action == Action::turn_left);
}
END_TEST

START_TEST(a_search_outlives_its_sensor_by_the_return_delay) {
  Stream stream;
  stream.pan = -100;
  const Decision& decision = stream.glimpse({0, 1, 0});
  stream.frames(5s - 1ms);
  assert_says(decision, Action::search, 0, "return");
  assert_sector(decision, -150, -90);
  stream.frames(1ms);
  assert_says(decision, Action::zero, 7, "zero");
}
END_TEST

START_TEST(options_that_change_end_no_search) {
  const FuserOptions before{};
  FuserOptions patient = before;
  patient.return_delay = 60s;
  patient.camera_hold = 1s;
  for (const FuserOptions& after : {before, patient}) {
    Stream stream(before);
    stream.pan = -100;
    const Decision& decision = stream.glimpse({0, 1, 0});
    stream.frame();
    stream.fuser.set_options(after);
    stream.fuser.set_table(paper_rules());
    ck_assert(!stream.frame().changed);
    assert_says(decision, Action::search, 0, "return");
    assert_sector(decision, -150, -90);
  }
}
END_TEST

START_TEST(a_search_goes_on_within_other_limits_and_with_another_lens) {
  FuserOptions options;
  Stream stream(options);
  stream.pan = -100;
  const Decision& decision = stream.glimpse({0, 1, 0});
  stream.frame();
  options.limits = {radians(-120), radians(120)};
  stream.fuser.set_options(options);
  stream.frame();
  assert_says(decision, Action::search, 0, "return");
  assert_sector(decision, -120, -90);
  ck_assert(decision.limited);
  options.lens = radians(20);
  stream.fuser.set_options(options);
  stream.frame();
  assert_says(decision, Action::search, 0, "return");
  assert_sector(decision, -120, -70);
  // What the head's zoom reports counts in place of the options, while it reports it.
  stream.lens = 40;
  stream.frame();
  assert_sector(decision, -120, -80);
  stream.lens = 0;
  stream.frame();
  assert_sector(decision, -120, -70);
  stream.fuser.reset();  // and nothing is left of it
  stream.fuser.set_options(options);
  stream.frame();
  assert_says(decision, Action::hold, 0, "return");
}
END_TEST

START_TEST(the_same_rules_again_are_no_news) {
  FuserOptions options = paper_options();
  Stream stream(options);
  stream.sensors = {1, 0, 0};
  const Decision& decision = stream.frame();
  assert_says(decision, Action::hold, 2, "rule 2");
  stream.fuser.set_table(paper_rules());
  ck_assert(!stream.frame().changed);
  RuleTable table = paper_rules();
  table.rules.back().name = "unused";  // another rule than the one that applies
  stream.fuser.set_table(table);
  ck_assert(!stream.frame().changed);
  for (Rule& rule : table.rules) rule.name = "mine";
  stream.fuser.set_table(table);
  ck_assert(stream.frame().changed);
  assert_says(decision, Action::hold, 2, "mine");
}
END_TEST

START_TEST(the_same_rules_again_keep_the_hysteresis) {
  Stream stream(FuserOptions{.rules = RuleSet::table});
  stream.pan = 45;
  stream.sensors = {1, 0, 0};
  const Decision& decision = stream.frame();
  assert_says(decision, Action::turn_left, 2, "rule 2");
  stream.pan = 44;
  for (int i = 0; i < 2; ++i) {
    ck_assert(!stream.frame().changed);
    stream.fuser.set_table(paper_rules());
  }
  ck_assert(!stream.frame().changed);
}
END_TEST

START_TEST(a_search_ends_when_a_person_is_found) {
  Stream stream;
  stream.sensors = {1, 0, 0};
  const Decision& decision = stream.frame();
  ck_assert(decision.action == Action::search);
  stream.tracks = {person(1)};
  stream.frame();
  assert_says(decision, Action::track, 1, "camera");
  ck_assert(std::isnan(decision.sector.from));
}
END_TEST

START_TEST(two_sectors_without_a_common_part_are_both_searched) {
  Geometry apart;
  ck_assert(apart.set(std::vector<double>{radians(-90), radians(90)}, radians(90)));
  Stream stream;
  stream.fuser.set_geometry(apart);
  stream.sensors = {1, 1};
  stream.pan = -5;
  bool left = false, right = false;
  for (int i = 0; i < 25 * 40; ++i) {
    const Decision& decision = stream.frame();
    ck_assert(decision.action != Action::zero && decision.action != Action::hold);
    if (i < 25) ck_assert(decision.action == Action::turn_left);  // the nearest first
    stream.obey(decision);
    left = left || stream.pan < -100;
    right = right || stream.pan > 100;
  }
  ck_assert(left && right);
}
END_TEST

START_TEST(equally_near_sectors_go_to_the_sensor_that_fired_last) {
  Geometry apart;
  ck_assert(apart.set(std::vector<double>{radians(-90), radians(90)}, radians(90)));
  for (const bool left_first : {true, false}) {
    Stream stream;
    stream.fuser.set_geometry(apart);
    stream.tracks = {person(1)};  // busy with a person ahead
    stream.sensors = {left_first, !left_first};
    stream.frame();
    stream.sensors = {1, 1};
    stream.frame();
    stream.tracks.clear();
    const Decision& decision = stream.frames(600ms);
    ck_assert(decision.action == (left_first ? Action::turn_right : Action::turn_left));
  }
  Stream stream;  // at the same time: the lower number
  stream.fuser.set_geometry(apart);
  stream.sensors = {1, 1};
  ck_assert(stream.frame().action == Action::turn_left);
}
END_TEST

// For every geometry, whatever fires, a head that obeys has shown every direction it can show before a minute is over.
START_TEST(a_search_leaves_nothing_unseen) {
  for (int count = 1; count <= 8; ++count)
    for (const double width : {40.0, 75.0, 120.0, 180.0}) {
      std::vector<double> bearings;
      for (int i = 0; i < count; ++i) bearings.push_back(radians(360.0 * i / count));
      Geometry sensors;
      ck_assert(sensors.set(bearings, radians(width)));
      for (unsigned fired = 1; fired < 1U << count; fired += count < 5 ? 1 : 29) {
        Stream stream;
        stream.fuser.set_geometry(sensors);
        stream.sensors.assign(static_cast<unsigned>(count), 0);
        for (unsigned i = 0; i < static_cast<unsigned>(count); ++i) stream.sensors[i] = fired >> i & 1;
        std::array<bool, 360> seen{};
        for (int i = 0; i < 25 * 200; ++i) {
          stream.obey(stream.frame());
          for (int away = -30; away <= 30; ++away)
            seen[static_cast<unsigned>((static_cast<int>(std::lround(stream.pan)) + away + 720) % 360)] =
                true;
        }
        for (int direction = 0; direction < 360; ++direction)
          for (int s = 0; s < count; ++s) {
            if (!(fired >> s & 1)) continue;
            const double apart =
                std::abs(degrees(cerberus::sensing::wrap(radians(direction) - sensors.bearing(s))));
            if (apart > width / 2 - 3) continue;  // dead band of the head, whole degrees here
            if (!seen[static_cast<unsigned>(direction)])
              ck_abort_msg("%d sensors, %g degrees, fired %#x: %d was never in the picture", count, width,
                           fired, direction);
          }
      }
    }
}
END_TEST

START_TEST(a_sector_beyond_the_limits_is_approached_and_reported_as_limited) {
  Stream stream(FuserOptions{.limits = {radians(-40), radians(40)}});
  stream.sensors = {0, 1, 0};
  const Decision& decision = stream.frame();
  assert_says(decision, Action::turn_left, 0, "sector");
  ck_assert(decision.limited);
  stream.pan = -39.5;
  stream.frame();
  assert_says(decision, Action::search, 0, "sector");
  assert_sector(decision, -40, -40);
  ck_assert(decision.limited);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "fuser_search",
      {a_sensor_makes_the_head_turn_and_then_sweep, another_sensor_is_a_new_question,
       a_search_outlives_its_sensor_by_the_return_delay, options_that_change_end_no_search,
       a_search_goes_on_within_other_limits_and_with_another_lens, the_same_rules_again_are_no_news,
       the_same_rules_again_keep_the_hysteresis, a_search_ends_when_a_person_is_found,
       two_sectors_without_a_common_part_are_both_searched,
       equally_near_sectors_go_to_the_sensor_that_fired_last, a_search_leaves_nothing_unseen,
       a_sector_beyond_the_limits_is_approached_and_reported_as_limited});
}
