// SPDX-License-Identifier: LGPL-2.1-or-later
// What camera and sensors together decide. (Which track to follow is
// asked in follower.cpp, how to search in fuser_search.cpp.)
#include "fuser_stream.h"

#include <cmath>
#include <limits>
#include <random>

#include "support/allocations.h"

using namespace stream;

START_TEST(nothing_anywhere_means_zero) {
  Stream stream;
  const Decision& decision = stream.frame();
  stream.frames(5s);
  assert_says(decision, Action::zero, 7, "zero");
  ck_assert(decision.changed && !decision.camera_found && decision.target == 0 &&
            std::isnan(decision.sector.from));
  ck_assert(!stream.frame().changed);
}
END_TEST

// Detections before the first frame are unknown: the head must not leave a person to whom it was sent.
START_TEST(the_return_delay_counts_from_the_first_frame_and_from_a_reset) {
  for (FuserOptions options : {FuserOptions{}, FuserOptions{.rules = RuleSet::table}}) {
    Stream stream(options);
    stream.now = 1h;
    const Decision& decision = stream.frame();
    for (int round = 0; round < 2; ++round) {
      assert_says(decision, Action::hold, 0, "return");
      stream.frames(5s - 1ms);
      assert_says(decision, Action::hold, 0, "return");
      stream.frames(1ms);
      ck_assert(decision.action == Action::zero && decision.rule == 7);
      stream.fuser.reset();
      stream.frame();
    }
  }
}
END_TEST

START_TEST(the_head_returns_five_seconds_after_the_last_detection) {
  Stream stream;
  stream.tracks = {person(7)};
  const Decision& decision = stream.frame();
  stream.tracks.clear();
  stream.frames(500ms - kFrame);  // the last frame with "camera found"
  stream.frames(kFrame - 1ms);
  ck_assert(decision.camera_found);
  stream.frames(5s - 1ms);
  assert_says(decision, Action::hold, 0, "return");
  stream.frames(1ms);
  assert_says(decision, Action::zero, 7, "zero");
}
END_TEST

START_TEST(limits_without_zero_are_reported) {
  for (FuserOptions options : {FuserOptions{}, paper_options()}) {
    options.limits = {radians(20), radians(90)};
    Stream stream(options);
    const Decision& decision = stream.frame();
    stream.frames(5s);
    ck_assert(decision.action == Action::zero && decision.limited);
  }
}
END_TEST

START_TEST(invalid_readings_do_not_count_but_are_reported) {
  Stream stream;
  stream.sensors = {2, 0, 77};
  const Decision& decision = stream.frame();
  ck_assert(decision.action == Action::hold && decision.fired == 0 && decision.invalid == 0b101);
  stream.sensors = {};  // a PIR pad that never spoke
  stream.frame();
  ck_assert(decision.action == Action::hold && decision.invalid == 0);
}
END_TEST

// The sensors look ahead, left and right, 120 degrees each; the lens sees 60 degrees.
START_TEST(an_onset_is_in_view_where_its_sensor_covers_a_part_of_the_picture) {
  const struct {
    std::vector<std::uint8_t> sensors;
    double pan, zoom;  // degrees; 0: no zoom
    bool seen;
  } cases[] = {{{1, 0, 0}, 0, 0, true},         {{0, 1, 0}, 0, 0, false},   {{0, 1, 0}, -31, 0, true},
               {{0, 0, 1}, -31, 0, false},      {{0, 1, 1}, 31, 0, true},   {{1, 0, 0}, 91, 0, false},
               {{1, 0, 0}, 91, 70, true},       {{1, 0, 0}, 89, 50, false}, {{1, 0, 0}, kUnknown, 0, true},
               {{0, 1, 0}, kUnknown, 0, false}, {{2, 0, 0}, 0, 0, false},   {{0, 0, 0}, 0, 0, false}};
  for (const auto& each : cases) {
    Stream stream;
    stream.frame();
    stream.sensors = each.sensors, stream.pan = each.pan, stream.lens = each.zoom;
    const bool seen = stream.frame().onset_in_view;
    ck_assert_msg(seen == each.seen, "case %d", static_cast<int>(&each - cases));
    ck_assert(!stream.frame().onset_in_view);  // it goes on
  }
  FuserOptions unknown;
  unknown.lens = 0;
  Stream stream(unknown);
  stream.frame();
  stream.sensors = {0, 1, 0};
  ck_assert(stream.frame().onset_in_view);
}
END_TEST

START_TEST(what_a_turning_base_trips_is_doubtful_and_does_not_count) {
  Stream stream;
  stream.yaw_rate = 5.1;
  stream.sensors = {1, 0, 0};
  const Decision& decision = stream.frame();
  ck_assert(decision.action == Action::hold && decision.fired == 0 && decision.doubtful == 0b001);
  stream.yaw_rate = 0;
  stream.sensors = {1, 1, 0};  // the second came between the two frames
  stream.frames(PulseDoubt::kSettle);
  ck_assert_int_eq(decision.doubtful, 0b011);
  stream.sensors = {1, 1, 1};  // the third after the turn
  stream.frame();
  ck_assert_int_eq(decision.doubtful, 0b011);
  ck_assert_int_eq(decision.fired, 0b100);
  stream.frames(3s);
  ck_assert_int_eq(decision.doubtful, 0);
  ck_assert_int_eq(decision.fired, 0b111);

  for (const double rate : {-60.0, 4.9, kUnknown}) {
    stream.yaw_rate = rate;
    stream.frames(2900ms);  // what they detected before may still be held
    ck_assert_int_eq(decision.doubtful, 0);
    stream.frames(200ms);
    ck_assert_int_eq(decision.doubtful, rate < -5 ? 0b111 : 0);
    stream.yaw_rate = 0;
    stream.frames(4s);
  }
}
END_TEST

// Ahead a field of 60 degrees sees standing things pass half as fast as one to the side.
START_TEST(a_straight_way_makes_doubt_sensor_by_sensor) {
  Stream stream;
  Geometry geometry;
  ck_assert(geometry.set(std::array{0.0, radians(-90), radians(90)}, radians(60)));
  stream.fuser.set_geometry(geometry);
  stream.yaw_rate = 0;
  const auto doubtful = [&](double speed) {
    stream.speed = kUnknown;
    stream.sensors = {0, 0, 0};
    stream.frames(4s);
    stream.speed = speed;
    stream.frame();
    stream.sensors = {1, 1, 1};
    return stream.frame().doubtful;
  };
  ck_assert_int_eq(doubtful(.17), 0);  // 5 degrees a second are .174 m/s past what is 2 m away
  ck_assert_int_eq(doubtful(.18), 0b110);
  ck_assert_int_eq(doubtful(-.18), 0b110);
  ck_assert_int_eq(doubtful(.34), 0b110);
  ck_assert_int_eq(doubtful(.36), 0b111);
  ck_assert_int_eq(doubtful(kUnknown), 0);
}
END_TEST

START_TEST(a_doubtful_sensor_that_rests_is_believed_again) {
  Stream stream;
  stream.yaw_rate = -45;
  stream.sensors = {1, 0, 0};
  const Decision& decision = stream.frame();
  stream.yaw_rate = 0;
  stream.frame();
  ck_assert_int_eq(decision.doubtful, 1);
  stream.sensors = {0, 0, 0};
  stream.frames(PulseDoubt::kSettle);
  stream.sensors = {1, 0, 0};
  stream.frame();
  ck_assert_int_eq(decision.doubtful, 0);
  ck_assert_int_eq(decision.fired, 1);
}
END_TEST

// Readings after the frame count from their own time, although the frame is passed again with its own time.
START_TEST(sensors_and_base_have_a_time_of_their_own) {
  Fuser fuser;
  std::vector<std::uint8_t> sensors{1, 0, 0};
  const auto hear = [&](Time frame, Time sensor_time, double yaw_rate) -> const Decision& {
    return fuser.update({.time = frame,
                         .sensor_time = sensor_time,
                         .tracks = {},
                         .sensors = sensors,
                         .pan = 0,
                         .base_yaw_rate = radians(yaw_rate)});
  };
  ck_assert_int_eq(hear(0s, 0s, 30).doubtful, 1);
  ck_assert_int_eq(hear(0s, 900ms, 30).doubtful, 1);
  ck_assert_int_eq(hear(0s, 0s, 0).doubtful, 1);      // it stands: at 900 ms, for nothing goes back
  ck_assert_int_eq(hear(3500ms, 0s, 0).doubtful, 1);  // a frame without later readings
  ck_assert_int_eq(hear(3600ms, 3850ms, 0).doubtful, 1);
  ck_assert_int_eq(hear(3600ms, 3900ms, 0).doubtful, 0);

  ck_assert_int_eq(hear(3600ms, 4500ms, 0).fired, 1);  // the last detection
  sensors = {0, 0, 0};
  assert_says(hear(9s, 9490ms, 0), Action::search, 0, "return");
  assert_says(hear(9s, 9500ms, 0), Action::zero, 7, "zero");
  ck_assert_int_eq(hear(1s, 1s, 30).doubtful, 0);  // anew: no sensor has a reading
  assert_says(hear(2s, 2s, 0), Action::hold, 0, "return");
}
END_TEST

START_TEST(the_paper_holds_where_it_has_no_track) {
  Stream stream(paper_options());
  stream.sensors = {1, 0, 0};
  stream.pan = 0;
  const Decision& decision = stream.frame();
  assert_says(decision, Action::hold, 2, "rule 2");
  stream.pan = -45;
  stream.frame();
  assert_says(decision, Action::turn_right, 2, "rule 2");
  stream.pan = -44.9;  // no hysteresis
  stream.frame();
  assert_says(decision, Action::hold, 2, "rule 2");
  stream.sensors = {0, 0, 0};  // no return delay
  stream.frame();
  assert_says(decision, Action::zero, 7, "rule 7");
  stream.tracks = {person(3)};
  stream.sensors = {1, 1, 1};
  stream.frame();
  assert_says(decision, Action::track, 1, "rule 1");
  ck_assert_int_eq(decision.target, 3);
}
END_TEST

START_TEST(the_paper_ignores_a_fourth_sensor) {
  Stream stream(paper_options());
  stream.sensors = {0, 0, 0, 1};
  ck_assert(stream.frame().action == Action::zero);
  ck_assert_int_eq(stream.frame().fired, 0);
}
END_TEST

START_TEST(a_table_turns_no_further_than_the_stop) {
  Stream stream(paper_options());
  stream.fuser.set_options([] {
    FuserOptions options = paper_options();
    options.limits = {radians(-90), radians(50)};
    return options;
  }());
  stream.sensors = {0, 0, 1};  // rule 4 wants more than 60
  stream.pan = 49;
  const Decision& decision = stream.frame();
  ck_assert(decision.action == Action::turn_right && !decision.limited);
  stream.pan = 50;
  stream.frame();
  ck_assert(decision.action == Action::turn_right && decision.limited);
}
END_TEST

// What a rule does only because it has no target, and what is deferred, is not what the rule says.
START_TEST(a_tables_hold_and_zero_are_immediate) {
  const RuleTable table{
      .name = "mine",
      .sensors = 1,
      .precedence = Precedence::order,
      .rules = {{.number = 1, .name = "stay", .all = 1, .bands = {{.action = Action::hold}}},
                {.number = 2, .name = "follow", .camera = Camera::found, .bands = {{}}},
                {.number = 3, .name = "home", .bands = {{.action = Action::zero}}}}};
  Stream stream(FuserOptions{.rules = RuleSet::table});
  stream.fuser.set_table(table);
  stream.tracks = {person(3)};
  const Decision& decision = stream.frame();
  assert_says(decision, Action::track, 2, "follow");
  ck_assert(!decision.immediate);
  stream.tracks.clear();
  stream.frame();
  assert_says(decision, Action::hold, 2, "follow");  // it has no target
  ck_assert(!decision.immediate);
  stream.sensors = {1};
  stream.frame();
  assert_says(decision, Action::hold, 1, "stay");
  ck_assert(decision.immediate && decision.changed);
  stream.sensors = {0};
  stream.frames(4s);
  assert_says(decision, Action::hold, 0, "return");
  ck_assert(!decision.immediate);
  stream.frames(2s);
  assert_says(decision, Action::zero, 3, "home");
  ck_assert(decision.immediate);
  stream.tracks = {person(3, TrackState::stopped)};
  stream.frame();
  stream.tracks.clear();
  stream.frames(6s);
  assert_says(decision, Action::hold, 0, "stopped");
  ck_assert(!decision.immediate);

  Stream computed;
  computed.frames(6s);
  ck_assert(computed.frame().action == Action::zero && !computed.frame().immediate);
}
END_TEST

START_TEST(a_users_table_has_hysteresis_return_delay_and_searches) {
  RuleTable table{.name = "mine",
                  .sensors = 1,
                  .precedence = Precedence::order,
                  .rules = {{.number = 4,
                             .name = "look",
                             .all = 1,
                             .bands = {{.upper = radians(-30), .action = Action::turn_right},
                                       {.action = Action::search, .search = {radians(-20), radians(200)}}}},
                            {.number = 9, .name = "home", .bands = {{.action = Action::zero}}}}};
  Stream stream(FuserOptions{.rules = RuleSet::table});
  stream.fuser.set_table(table);
  stream.sensors = {1};
  stream.pan = -31;
  const Decision& decision = stream.frame();
  assert_says(decision, Action::turn_right, 4, "look");
  stream.pan = -28.5;
  stream.frame();
  ck_assert(decision.action == Action::turn_right);
  stream.pan = -27.5;
  stream.frame();
  ck_assert(decision.action == Action::search && decision.limited);
  assert_sector(decision, -20, 170);
  stream.pan = -31;  // back within hysteresis
  stream.frame();
  ck_assert(decision.action == Action::search);
  stream.sensors = {0};
  stream.frames(4s);
  assert_says(decision, Action::hold, 0, "return");
  stream.frames(2s);
  assert_says(decision, Action::zero, 9, "home");
}
END_TEST

START_TEST(an_unknown_pan_angle_commands_no_turn) {
  for (const FuserOptions& options : {FuserOptions{}, paper_options()}) {
    Stream stream(options);
    stream.pan = kUnknown;
    for (const std::vector<std::uint8_t>& sensors :
         {std::vector<std::uint8_t>{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}}) {
      stream.sensors = sensors;
      const Decision& decision = stream.frame();
      ck_assert(decision.action == Action::search || decision.action == Action::hold);
    }
  }
}
END_TEST

START_TEST(time_that_goes_back_starts_anew) {
  Stream stream;
  stream.tracks = {person(7, TrackState::stopped)};
  stream.sensors = {1, 0, 0};
  stream.frames(100s);
  stream.tracks.clear();
  stream.sensors = {0, 0, 0};
  const Decision& decision = stream.frame(-90s);
  assert_says(decision, Action::hold, 0, "return");
  ck_assert(decision.changed);
}
END_TEST

START_TEST(a_long_gap_lets_every_timer_expire) {
  Stream stream;
  stream.tracks = {person(7)};
  stream.sensors = {1, 0, 0};
  stream.frame();
  stream.tracks.clear();
  stream.sensors = {0, 0, 0};
  assert_says(stream.frame(1h), Action::zero, 7, "zero");
}
END_TEST

START_TEST(options_that_make_no_sense_are_put_right) {
  Fuser fuser;
  fuser.set_options({.camera_hold = -1s,
                     .return_delay = -1s,
                     .hysteresis = kUnknown,
                     .lens = 99,
                     .limits = {1, -1},
                     .dwell = -1s});
  ck_assert(fuser.options().camera_hold == 0s && fuser.options().return_delay == 0s);
  ck_assert(fuser.options().hysteresis == 0 && fuser.options().lens == 0 && fuser.options().dwell == 0s);
  ck_assert(fuser.options().limits.from == kDefaultLimits.from &&
            fuser.options().limits.to == kDefaultLimits.to);
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  for (const Interval& limits : {Interval{kUnknown, 1}, {-1, kUnknown}, {-kInfinite, 1}, {-1, kInfinite}}) {
    fuser.set_options({.limits = limits});
    ck_assert(fuser.options().limits.from == kDefaultLimits.from &&
              fuser.options().limits.to == kDefaultLimits.to);
  }
  fuser.set_options({.limits = {-1, 1}});
  ck_assert(fuser.options().limits.from == -1 && fuser.options().limits.to == 1);
}
END_TEST

START_TEST(whatever_comes_in_the_answer_is_sound_repeatable_and_free_of_allocations) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    FuserOptions options = seed % 3 == 0 ? paper_options() : FuserOptions{};
    options.limits = {radians(-170.0 + seed), radians(170.0 - 2 * seed)};
    Fuser one, two;
    one.set_options(options);
    two.set_options(options);
    std::mt19937 random(seed);
    Time now{};
    std::vector<Track> tracks;
    std::vector<std::uint8_t> sensors(3);
    tracks.reserve(8);
    Decision last;
    for (int i = 0; i < 3000; ++i) {
      now += random() % 500 == 0 ? Time(-3s) : std::chrono::milliseconds(random() % 300);
      if (random() % 20 == 0) {
        tracks.clear();
        for (unsigned n = random() % 4; n > 0; --n)
          tracks.push_back({.id = static_cast<std::uint32_t>(random() % 6),
                            .x = static_cast<double>(random() % 300),
                            .y = random() % 50 == 0 ? kUnknown : static_cast<double>(random() % 200),
                            .width = 20,
                            .height = 60,
                            .age = std::chrono::milliseconds(random() % 9000),
                            .state = static_cast<TrackState>(random() % 3)});
      }
      if (random() % 15 == 0) sensors[random() % 3] = static_cast<std::uint8_t>(random() % 4);
      const double pan = random() % 50 == 0 ? kUnknown : radians(static_cast<double>(random() % 360) - 180);
      const Input input{.time = now,
                        .tracks = tracks,
                        .sensors = sensors,
                        .pan = pan,
                        .base_yaw_rate = random() % 10 == 0 ? 0.5 : kUnknown};
      const std::size_t before = cerberus::tests::allocations();
      const Decision& a = one.update(input);
      if (cerberus::tests::allocations() != before) ck_abort_msg("seed %u: allocates", seed);
      const Decision& b = two.update(input);
      if (a.action != b.action || a.rule != b.rule || a.target != b.target || a.changed != b.changed ||
          (a.sector.from != b.sector.from && !std::isnan(a.sector.from)))
        ck_abort_msg("seed %u: two runs differ", seed);
      const bool followed = std::ranges::any_of(
          tracks, [&](const Track& track) { return track.id == a.target && track.id != 0; });
      if ((a.action == Action::track) != (a.target != 0)) ck_abort_msg("seed %u: tracks no target", seed);
      if (a.target != 0 && !followed) ck_abort_msg("seed %u: a target that is not there", seed);
      if ((a.fired & (a.doubtful | a.invalid)) != 0) ck_abort_msg("seed %u: counts what is not sure", seed);
      if (a.action == Action::search &&
          !(a.sector.from <= a.sector.to && a.sector.from >= options.limits.from &&
            a.sector.to <= options.limits.to))
        ck_abort_msg("seed %u: searches beyond the limits", seed);
      if (options.rules == RuleSet::complete && a.action == Action::turn_left && !(pan > options.limits.from))
        ck_abort_msg("seed %u: turns left at the left stop", seed);
      if (options.rules == RuleSet::complete && a.action == Action::turn_right && !(pan < options.limits.to))
        ck_abort_msg("seed %u: turns right at the right stop", seed);
      if (!a.changed && (a.action != last.action || a.target != last.target || a.fired != last.fired))
        ck_abort_msg("seed %u: a change is not reported", seed);
      last = a;
    }
  }
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "fuser", {nothing_anywhere_means_zero,
                the_return_delay_counts_from_the_first_frame_and_from_a_reset,
                the_head_returns_five_seconds_after_the_last_detection,
                limits_without_zero_are_reported,
                invalid_readings_do_not_count_but_are_reported,
                an_onset_is_in_view_where_its_sensor_covers_a_part_of_the_picture,
                what_a_turning_base_trips_is_doubtful_and_does_not_count,
                a_straight_way_makes_doubt_sensor_by_sensor,
                a_doubtful_sensor_that_rests_is_believed_again,
                sensors_and_base_have_a_time_of_their_own,
                the_paper_holds_where_it_has_no_track,
                the_paper_ignores_a_fourth_sensor,
                a_table_turns_no_further_than_the_stop,
                a_tables_hold_and_zero_are_immediate,
                a_users_table_has_hysteresis_return_delay_and_searches,
                an_unknown_pan_angle_commands_no_turn,
                time_that_goes_back_starts_anew,
                a_long_gap_lets_every_timer_expire,
                options_that_make_no_sense_are_put_right,
                whatever_comes_in_the_answer_is_sound_repeatable_and_free_of_allocations});
}
