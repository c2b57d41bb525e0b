// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sensing/pir_model.h"

#include <check.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <string_view>
#include <vector>

#include "support/suite.h"

using namespace cerberus::sensing;
using namespace std::chrono_literals;

namespace {

// Nothing but the line: no warm-up, no faults.
constexpr PirOptions kPlain{.min_pulse = 0s, .debounce = 20ms, .stuck_after = 0s, .chatter_edges = 0};

PirModel started(const PirOptions& options, Time now = 0ms) {
  PirModel model(options);
  model.start(now, options.active_low);
  return model;
}

int presence(const PirModel& model) {
  return static_cast<int>(model.presence());
}

struct Edge {
  Time time;
  bool level;
};

// Bursts of bounce and long rests, the level alternating.
std::vector<Edge> random_edges(std::mt19937& random, int count) {
  std::vector<Edge> edges;
  Time now = 0ms;
  for (int i = 0; i < count; ++i) {
    const int most = std::vector<int>{8, 60, 900, 4000}[random() % 4];
    now += std::chrono::milliseconds(1 + random() % static_cast<unsigned>(most));
    edges.push_back({now, i % 2 == 0});
  }
  return edges;
}

// Presence at `time` straight from the definition, with the whole history at hand: the line is active, or fell less
// than `debounce` ago, or rose less than `hold` ago. For models that retrigger and have no block time.
bool defined_presence(const std::vector<Edge>& edges, Time time, Time debounce, Time hold) {
  for (std::size_t i = 0; i < edges.size() && edges[i].time <= time; ++i) {
    const Time until = i + 1 < edges.size() ? edges[i + 1].time : kNever;
    if (edges[i].level && (time < until || time - until < debounce || time - edges[i].time < hold))
      return true;
  }
  return false;
}

}  // namespace

START_TEST(a_rise_is_reported_at_once_and_a_fall_after_the_debounce_time) {
  PirModel model = started(kPlain);
  ck_assert_int_eq(presence(model), 0);
  ck_assert(model.deadline() == kNever);
  model.edge(1000ms, true);
  ck_assert_int_eq(presence(model), 1);
  ck_assert(model.changed() == 1000ms);
  model.edge(3000ms, false);
  ck_assert_int_eq(presence(model), 1);
  ck_assert(model.deadline() == 3020ms);
  model.poll(3020ms - 1ns);
  ck_assert_int_eq(presence(model), 1);
  ck_assert(model.poll(3020ms) == kNever);
  ck_assert_int_eq(presence(model), 0);
}
END_TEST

START_TEST(bounce_does_not_show) {
  PirModel model = started(kPlain);
  model.edge(1000ms, true);
  for (Time at = 1001ms; at < 1030ms; at += 2ms) {
    model.edge(at, false);
    ck_assert_int_eq(presence(model), 1);
    model.edge(at + 1ms, true);
    ck_assert_int_eq(presence(model), 1);
  }
  ck_assert(model.changed() == 1000ms);
}
END_TEST

START_TEST(a_late_poll_still_reports_the_exact_time) {
  PirModel model = started(kPlain);
  model.edge(1000ms, true);
  model.edge(2000ms, false);
  model.poll(9000ms);
  ck_assert_int_eq(presence(model), 0);
  ck_assert(model.changed() == 2020ms);
}
END_TEST

START_TEST(the_debounce_time_is_limited_to_50_ms) {
  ck_assert(PirModel(PirOptions{.debounce = 10s}).options().debounce == 50ms);
  ck_assert(PirModel(PirOptions{.debounce = -10s}).options().debounce == 0ms);
}
END_TEST

START_TEST(dips_of_3_ms_on_all_lines_are_no_detection_of_any_module) {
  // What the supply of a motor that starts does to lines: a dip of a line at rest that is high, a spike of one that is
  // low, alone and many in a row.
  std::vector<PirOptions> modules{PirOptions{}};
  for (const PirPreset& preset : pir_presets()) modules.push_back(preset.options);
  for (const PirOptions& options : modules) {
    for (const Time length : {1us, 3000us, 9999us}) {
      PirModel model(options);
      model.start(0s, options.active_low);
      Time at = 100s;
      for (int i = 0; i < 30; ++i, at += 25ms) {
        model.edge(at, !options.active_low);
        ck_assert_int_eq(presence(model), 0);
        model.edge(at + length, options.active_low);
        model.poll(at + 20ms);
        ck_assert_int_eq(presence(model), 0);
      }
      ck_assert(model.changed() < 100s && model.fault() == PirFault::none);
      model.edge(200s, !options.active_low);  // a pulse of a module
      model.poll(200s + 10ms);
      ck_assert_int_eq(presence(model), 1);
      ck_assert(model.changed() == 200s + 10ms);
    }
  }
}
END_TEST

START_TEST(a_pulse_counts_from_its_least_length_on) {
  PirOptions options = kPlain;
  options.min_pulse = 10ms;
  PirModel model = started(options);
  model.edge(1s, true);
  ck_assert(model.deadline() == 1010ms);
  model.edge(1010ms - 1ns, false);
  ck_assert(model.deadline() == kNever);
  ck_assert_int_eq(presence(model), 0);
  model.edge(2s, true);
  model.edge(2010ms, false);  // just long enough, and seen late
  ck_assert_int_eq(presence(model), 1);
  ck_assert(model.changed() == 2010ms);
  model.poll(2030ms);
  ck_assert_int_eq(presence(model), 0);
  // Bounce at the begin delays the pulse by its own length; breaks below the debounce time do not end it.
  for (Time at = 3s; at < 3004ms; at += 2ms) {
    model.edge(at, true);
    model.edge(at + 1ms, false);
  }
  model.edge(3004ms, true);
  model.poll(3100ms);
  ck_assert(presence(model) == 1 && model.changed() == 3014ms);
  for (Time at = 4s; at < 4100ms; at += 19ms) {
    model.edge(at, false);
    model.edge(at + 18ms, true);
    ck_assert_int_eq(presence(model), 1);
  }
  ck_assert(model.changed() == 3014ms);
  // A line that is active at the start has been for long.
  model.start(10s, true);
  ck_assert_int_eq(presence(model), 1);
}
END_TEST

START_TEST(a_pulse_that_is_too_short_extends_no_detection) {
  PirOptions options = kPlain;
  options.min_pulse = 10ms;
  options.hold = 2s;
  PirModel model = started(options);
  model.edge(1s, true);
  model.edge(1100ms, false);
  ck_assert(model.deadline() == 3010ms);
  model.edge(2s, true);
  model.edge(2003ms, false);
  ck_assert(model.deadline() == 3010ms);
  model.edge(3009ms, true);  // it is short until it is not
  ck_assert(model.deadline() == 3010ms);
  model.poll(3012ms);
  ck_assert_int_eq(presence(model), 0);
  model.poll(3019ms);
  ck_assert_int_eq(presence(model), 1);
}
END_TEST

START_TEST(an_open_collector_module_detects_while_its_line_is_low) {
  PirOptions options = kPlain;
  options.active_low = true;
  PirModel model = started(options);
  ck_assert_int_eq(presence(model), 0);
  model.edge(1s, false);
  ck_assert_int_eq(presence(model), 1);
  model.edge(2s, true);
  model.poll(3s);
  ck_assert_int_eq(presence(model), 0);
}
END_TEST

START_TEST(readings_are_invalid_before_the_start_and_in_warm_up) {
  PirOptions options = kPlain;
  options.warm_up = 60s;
  PirModel model(options);
  ck_assert_int_eq(presence(model), 2);
  ck_assert(model.poll(5s) == kNever);
  model.start(10s, false);
  ck_assert(model.deadline() == 70s);
  model.edge(20s, true);  // the spurious pulses of a module that warms up
  ck_assert_int_eq(presence(model), 2);
  model.edge(21s, false);
  model.poll(70s - 1ns);
  ck_assert_int_eq(presence(model), 2);
  model.poll(70s);
  ck_assert_int_eq(presence(model), 0);
  ck_assert(model.changed() == 70s);

  model.start(100s, true);  // a person stands there already
  model.poll(160s);
  ck_assert_int_eq(presence(model), 1);
}
END_TEST

START_TEST(hold_keeps_a_detection_and_a_new_rise_extends_it_where_the_module_retriggers) {
  PirOptions options = kPlain;
  options.hold = 2s;
  for (const bool retrigger : {true, false}) {
    options.retrigger = retrigger;
    PirModel model = started(options);
    model.edge(10s, true);
    model.edge(10s + 100ms, false);
    model.edge(11s, true);
    model.edge(11s + 100ms, false);
    ck_assert(model.deadline() == (retrigger ? 13s : 12s));
    model.poll(20s);
    ck_assert_int_eq(presence(model), 0);
    ck_assert(model.changed() == (retrigger ? 13s : 12s));
  }
}
END_TEST

START_TEST(without_retrigger_a_line_that_stays_is_a_new_detection_after_the_block_time) {
  PirOptions options = kPlain;
  options.hold = 2s;
  options.block = 3s;
  options.retrigger = false;
  PirModel model = started(options);
  model.edge(10s, true);
  ck_assert(model.poll(12s) == 15s);
  ck_assert_int_eq(presence(model), 0);
  ck_assert(model.poll(15s) == 17s);
  ck_assert_int_eq(presence(model), 1);
  options.block = 0s;  // nothing between the two: it never shows
  model = started(options);
  model.edge(10s, true);
  model.poll(12s);
  ck_assert_int_eq(presence(model), 1);
  ck_assert(model.changed() == 10s);
}
END_TEST

START_TEST(nothing_triggers_in_the_block_time) {
  PirOptions options = kPlain;
  options.block = 2s;
  PirModel model = started(options);
  model.edge(10s, true);
  model.edge(11s, false);
  model.edge(12s, true);
  model.edge(12s + 500ms, false);
  ck_assert_int_eq(presence(model), 0);
  ck_assert(model.changed() == 11s + 20ms);
  model.edge(14s, true);
  ck_assert_int_eq(presence(model), 1);
}
END_TEST

START_TEST(a_line_that_never_rests_is_stuck_until_it_does) {
  PirOptions options = kPlain;
  options.stuck_after = 600s;
  PirModel model = started(options);
  model.edge(10s, true);
  ck_assert(model.deadline() == 610s);
  model.edge(300s, false);  // a gap of 5 ms is no rest
  model.edge(300s + 5ms, true);
  model.poll(610s);
  ck_assert(model.fault() == PirFault::stuck_on);
  ck_assert_str_eq(describe(model.fault()).data(), "stuck on");
  ck_assert_int_eq(presence(model), 2);
  model.edge(700s, false);
  ck_assert_int_eq(presence(model), 2);
  model.poll(700s + 20ms);
  ck_assert(model.fault() == PirFault::none);
  ck_assert_int_eq(presence(model), 0);

  model.edge(800s, true);  // a rest starts the count anew
  model.edge(900s, false);
  model.edge(901s, true);
  ck_assert(model.deadline() == 1501s);
}
END_TEST

START_TEST(a_line_that_chatters_is_invalid_until_it_calms_down) {
  PirOptions options = kPlain;
  options.chatter_edges = 20;
  options.chatter_window = 2s;
  PirModel model = started(options);
  Time at = 1s;
  for (int i = 1; i <= 20; ++i, at += 60ms) {
    model.edge(at, true);
    ck_assert(model.fault() == (i < 20 ? PirFault::none : PirFault::chattering));
    model.edge(at + 30ms, false);
  }
  ck_assert_int_eq(presence(model), 2);
  ck_assert_str_eq(describe(model.fault()).data(), "chattering");
  // Rises at 1.00 + 0.06 i; the tenth from the end, at 1.60, leaves the window at 3.60 and fewer than half are left.
  ck_assert(model.poll(3s) == 3600ms);
  ck_assert_int_eq(presence(model), 2);
  model.poll(3600ms);
  ck_assert(model.fault() == PirFault::none);
  ck_assert_int_eq(presence(model), 0);

  for (at = 5s; at < 9s; at += 4ms) {  // however long it goes on
    model.edge(at, true);
    model.edge(at + 2ms, false);
    ck_assert(model.fault() == (at < 5s + 76ms ? PirFault::none : PirFault::chattering));
  }
  model.poll(20s);
  ck_assert(model.fault() == PirFault::none);

  for (at = 20s; at < 50s; at += 150ms) {  // often, but not that often
    model.edge(at, true);
    model.edge(at + 75ms, false);
    ck_assert(model.fault() == PirFault::none);
  }
}
END_TEST

START_TEST(no_module_of_the_list_chatters_by_its_own_timing) {
  for (const PirPreset& preset : pir_presets()) {
    if (preset.module_hold.least == 0s) continue;
    PirModel model(preset.options);
    model.start(0s, false);
    for (Time at = 100s; at < 160s; at += preset.module_hold.least + preset.module_block.least) {
      model.edge(at, true);
      model.edge(at + preset.module_hold.least, false);
      ck_assert(model.fault() == PirFault::none);
    }
    ck_assert(preset.options.stuck_after > preset.module_hold.most);
  }
}
END_TEST

START_TEST(a_turning_base_makes_detections_doubtful) {
  PirModel model = started(kPlain);
  model.base(1s, radians(4.9));
  model.edge(1s, true);
  ck_assert(!model.doubtful());
  model.edge(1500ms, false);
  model.base(2s, radians(-5.1));
  model.edge(2100ms, true);
  ck_assert(model.doubtful() && presence(model) == 1);
  model.base(3s, 0);
  ck_assert(model.doubtful());  // modules hold what the turn did to them
  ck_assert(model.deadline() == 6s);
  model.poll(6s);
  ck_assert(!model.doubtful());

  model.edge(7s, false);
  model.base(8s, 1);
  ck_assert(!model.doubtful());  // nothing detected: nothing to doubt
  model.edge(8900ms, true);
  ck_assert(model.doubtful());
  model.base(10s, std::numeric_limits<double>::quiet_NaN());
  model.edge(11s, false);
  model.poll(11s + 20ms);
  ck_assert(!model.doubtful());
  model.edge(12s, true);
  ck_assert(!model.doubtful());
}
END_TEST

START_TEST(a_base_without_further_reports_is_taken_as_standing) {
  PirModel model = started(kPlain);
  model.base(2s, 1);
  model.edge(2s, true);
  ck_assert(model.deadline() == 3s);
  model.base(2900ms, 1);  // reported again
  ck_assert(model.deadline() == 3900ms);
  model.poll(3900ms);
  ck_assert(model.doubtful());  // the module holds what the turn did to it
  ck_assert(model.deadline() == 6900ms);
  model.poll(6900ms - 1ns);
  ck_assert(model.doubtful());
  model.poll(6900ms);
  ck_assert(!model.doubtful());
  // Also without a poll in between.
  model.edge(8s, false);
  model.base(10s, 1);
  model.edge(10s, true);
  model.poll(14s - 1ns);
  ck_assert(model.doubtful());
  model.poll(14s);
  ck_assert(!model.doubtful());
}
END_TEST

START_TEST(a_detection_from_before_a_motion_becomes_doubtful_in_it) {
  PirModel model = started(kPlain);
  model.edge(1s, true);
  for (Time at = 10s; at < 14s; at += 500ms) {
    model.base(at, 1);
    ck_assert(model.doubtful() == (at >= 13s));
  }
}
END_TEST

START_TEST(a_time_that_goes_back_counts_as_the_last_one) {
  PirModel model = started(kPlain, 10s);
  model.edge(20s, true);
  model.edge(5s, false);
  ck_assert(model.deadline() == 20s + 20ms);
  model.poll(1s);
  ck_assert_int_eq(presence(model), 1);
  model.edge(kNever, true);  // and the end of all time is no trap
  model.poll(kNever);
  ck_assert(model.deadline() == kNever);
}
END_TEST

START_TEST(presence_follows_its_definition_on_random_lines) {
  std::mt19937 random(3);
  for (int round = 0; round < 300; ++round) {
    PirOptions options = kPlain;
    options.debounce = std::chrono::milliseconds(random() % 51);
    options.hold = std::chrono::milliseconds(random() % 3 ? random() % 3000 : 0);
    PirModel model = started(options);
    const std::vector<Edge> edges = random_edges(random, 60);
    Time now = 0ms;
    for (std::size_t next = 0; now < 60s; now += std::chrono::milliseconds(1 + random() % 40)) {
      for (; next < edges.size() && edges[next].time <= now; ++next) {
        model.edge(edges[next].time, edges[next].level);
        const bool expected = defined_presence(edges, edges[next].time, options.debounce, options.hold);
        if (presence(model) != expected) ck_abort_msg("round %d, at an edge", round);
        if (edges[next].level && presence(model) != 1)
          ck_abort_msg("round %d, a rise was not reported", round);
      }
      model.poll(now);
      const bool expected = defined_presence(edges, now, options.debounce, options.hold);
      if (presence(model) != expected)
        ck_abort_msg("round %d, %g s: presence is not %d", round, static_cast<double>(now.count()) / 1e9,
                     expected);
    }
  }
}
END_TEST

// With everything on: deadlines are honest, a late poll leads to the same state, and each option keeps its promise.
START_TEST(sleeping_until_the_deadline_misses_nothing) {
  std::mt19937 random(11);
  for (int round = 0; round < 300; ++round) {
    PirOptions options;
    options.retrigger = random() % 2;
    options.debounce = std::chrono::milliseconds(random() % 51);
    options.hold = std::chrono::milliseconds(random() % 2 ? random() % 3000 : 0);
    options.block = std::chrono::milliseconds(random() % 2 ? random() % 3000 : 0);
    options.warm_up = std::chrono::milliseconds(random() % 2 ? random() % 9000 : 0);
    options.stuck_after = std::chrono::milliseconds(random() % 2 ? 1000 + random() % 3000 : 0);
    options.chatter_edges = random() % 2 ? 5 + random() % 30 : 0;
    options.chatter_window = 2s;
    PirModel sleeper = started(options), restless = started(options), late = started(options);
    const std::vector<Edge> edges = random_edges(random, 80);
    Time now = 0ms, ended = Time(-1h);
    int last = presence(sleeper);
    const auto follow = [&](Time at) {  // `sleeper` at a moment when something may change
      if (presence(sleeper) == last) return;
      if (sleeper.changed() != at) ck_abort_msg("round %d: changed at another time than reported", round);
      if (at < options.warm_up && presence(sleeper) != 2) ck_abort_msg("round %d: valid in warm-up", round);
      if (last == 0 && presence(sleeper) == 1 && at - ended < options.block)
        ck_abort_msg("round %d: blocked", round);
      if (last == 1 && presence(sleeper) == 0) ended = at;
      last = presence(sleeper);
    };
    for (const Edge& edge : edges) {
      while (sleeper.deadline() <= edge.time) {
        const Time due = sleeper.deadline();
        if (due < now) ck_abort_msg("round %d: a deadline in the past", round);
        now = due;
        sleeper.poll(due);
        if (sleeper.deadline() <= due) ck_abort_msg("round %d: a deadline that does not go away", round);
        follow(due);
      }
      for (Time at = std::max(now, edge.time - 100ms); at < edge.time; at += 7ms) {
        const Presence before = restless.presence();
        const bool expected = restless.deadline() <= at;
        restless.poll(at);
        if (restless.presence() != before && !expected)
          ck_abort_msg("round %d: a change without deadline", round);
      }
      now = edge.time;
      for (PirModel* model : {&sleeper, &restless, &late}) model->edge(edge.time, edge.level);
      follow(edge.time);
      for (const PirModel* other : {&restless, &late}) {
        if (other->presence() != sleeper.presence() || other->fault() != sleeper.fault() ||
            other->changed() != sleeper.changed() || other->deadline() != sleeper.deadline())
          ck_abort_msg("round %d: the state depends on when it was asked for", round);
      }
    }
  }
}
END_TEST

START_TEST(the_modules_are_there_by_name) {
  std::map<std::string_view, const PirPreset*> named;
  for (const PirPreset& preset : pir_presets()) named[preset.name] = &preset;
  ck_assert_int_eq(static_cast<int>(named.size()), 3);
  const PirPreset* hc = named.at("hc-sr501");
  ck_assert(!hc->options.active_low && hc->options.warm_up == 60s && hc->module_hold.least == 300ms &&
            hc->module_hold.most == 200s && hc->range == 7);
  const PirPreset* am = named.at("am312");
  ck_assert(am->module_hold.least == 2s && am->module_hold.most == 2s && am->module_block.most == 2s);
  const PirPreset* sk = named.at("sk-11");  // the paper's Table 1
  ck_assert(sk->options.active_low && sk->range == 12);
  ck_assert_double_eq_tol(degrees(sk->field_of_view), 120, 1e-9);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "pir_model", {a_rise_is_reported_at_once_and_a_fall_after_the_debounce_time,
                    bounce_does_not_show,
                    a_late_poll_still_reports_the_exact_time,
                    the_debounce_time_is_limited_to_50_ms,
                    dips_of_3_ms_on_all_lines_are_no_detection_of_any_module,
                    a_pulse_counts_from_its_least_length_on,
                    a_pulse_that_is_too_short_extends_no_detection,
                    an_open_collector_module_detects_while_its_line_is_low,
                    readings_are_invalid_before_the_start_and_in_warm_up,
                    hold_keeps_a_detection_and_a_new_rise_extends_it_where_the_module_retriggers,
                    without_retrigger_a_line_that_stays_is_a_new_detection_after_the_block_time,
                    nothing_triggers_in_the_block_time,
                    a_line_that_never_rests_is_stuck_until_it_does,
                    a_line_that_chatters_is_invalid_until_it_calms_down,
                    no_module_of_the_list_chatters_by_its_own_timing,
                    a_turning_base_makes_detections_doubtful,
                    a_detection_from_before_a_motion_becomes_doubtful_in_it,
                    a_base_without_further_reports_is_taken_as_standing,
                    a_time_that_goes_back_counts_as_the_last_one,
                    presence_follows_its_definition_on_random_lines,
                    sleeping_until_the_deadline_misses_nothing,
                    the_modules_are_there_by_name});
}
