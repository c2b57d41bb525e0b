// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/tracking/track_events.h"

#include <check.h>

#include <string>

#include "support/suite.h"

using namespace cerberus::vision;
using namespace std::chrono_literals;

// Frames every 100 ms, the first at 0. A frame's events are written as "+1" (appeared), "=1" (updated), "-1" (left).
struct Stream {
  TrackEvents events;
  TrackEvents::Time now = -100ms;
  std::vector<TrackEvents::Event> last;

  std::string next(std::vector<std::uint32_t> ids, TrackEvents::Time hold = 300ms) {
    now += 100ms;
    std::vector<Track> tracks;
    for (const std::uint32_t id : ids) {
      Track& track = tracks.emplace_back();
      track.id = id;
      track.box.x = static_cast<double>(now / 1ms) + id;
    }
    return words(events.update(tracks, now, 100ms, hold));
  }
  std::string end() { return words(events.end()); }

 private:
  std::string words(std::span<const TrackEvents::Event> events) {
    last.assign(events.begin(), events.end());
    std::string result;
    for (const TrackEvents::Event& event : events)
      result += "+=-"[static_cast<int>(event.change)] + std::to_string(event.track.id) + " ";
    return result;
  }
};

START_TEST(a_track_appears_once_is_updated_once_a_second_and_leaves_once) {
  Stream stream;
  ck_assert(stream.next({}) == "");
  ck_assert(stream.next({7}) == "+7 ");  // at 100 ms
  for (int k = 0; k < 9; ++k) ck_assert(stream.next({7}) == "");
  ck_assert(stream.next({7}) == "=7 ");  // at 1100 ms
  for (int k = 0; k < 9; ++k) ck_assert(stream.next({7}) == "");
  ck_assert(stream.next({7}) == "=7 ");  // at 2100 ms
  ck_assert(stream.next({}) == "");
  ck_assert(stream.next({}) == "");
  ck_assert(stream.next({}) == "-7 ");  // unseen for 300 ms
  ck_assert(stream.next({}) == "");
}
END_TEST

START_TEST(each_event_carries_the_first_and_the_last_time_and_the_last_box) {
  Stream stream;
  stream.next({});
  stream.next({7});
  ck_assert(stream.last[0].first == 100ms && stream.last[0].last == 100ms);
  stream.next({7});
  for (int k = 0; k < 3; ++k) stream.next({});
  ck_assert(stream.last[0].first == 100ms && stream.last[0].last == 200ms);
  ck_assert(stream.last[0].track.box.x == 207);
}
END_TEST

START_TEST(a_return_within_the_hold_continues_the_visit_and_a_later_one_is_another) {
  Stream stream;
  stream.next({7});
  stream.next({});
  stream.next({});
  ck_assert(stream.next({7}) == "");
  ck_assert(stream.next({}) == "");
  ck_assert(stream.next({}) == "");
  ck_assert(stream.next({}) == "-7 ");
  ck_assert(stream.last[0].first == 0ms && stream.last[0].last == 300ms);
  ck_assert(stream.next({7}) == "+7 ");
  ck_assert(stream.last[0].first == 700ms);
}
END_TEST

START_TEST(an_unseen_track_is_not_updated_but_on_its_return) {
  Stream stream;
  stream.next({7}, 10s);
  for (int k = 0; k < 15; ++k) ck_assert(stream.next({}, 10s) == "");
  ck_assert(stream.next({7}, 10s) == "=7 ");
  ck_assert(stream.next({7}, 10s) == "");
}
END_TEST

START_TEST(without_a_hold_a_track_leaves_on_the_first_frame_without_it_and_before_another_appears) {
  Stream stream;
  ck_assert(stream.next({1, 2}, 0s) == "+1 +2 ");
  ck_assert(stream.next({2, 3}, 0s) == "-1 +3 ");
  ck_assert(stream.next({}, 0s) == "-2 -3 ");
}
END_TEST

START_TEST(at_the_end_all_leave_once) {
  Stream stream;
  stream.next({1, 2});
  stream.next({2});
  ck_assert(stream.end() == "-1 -2 ");
  ck_assert(stream.last[0].last == 0ms && stream.last[1].last == 100ms);
  ck_assert(stream.end() == "");
}
END_TEST

START_TEST(frames_without_times_count_as_25_a_second) {
  TrackEvents events;
  Track track;
  track.id = 1;
  ck_assert_uint_eq(events.update({&track, 1}, std::nullopt, 0ns, 80ms).size(), 1);
  ck_assert(!events.update({}, std::nullopt, 0ns, 80ms).size());
  const auto left = events.update({}, std::nullopt, 0ns, 80ms);
  ck_assert_uint_eq(left.size(), 1);
  ck_assert(!left[0].first && !left[0].last);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "track_events", {a_track_appears_once_is_updated_once_a_second_and_leaves_once,
                       each_event_carries_the_first_and_the_last_time_and_the_last_box,
                       a_return_within_the_hold_continues_the_visit_and_a_later_one_is_another,
                       an_unseen_track_is_not_updated_but_on_its_return,
                       without_a_hold_a_track_leaves_on_the_first_frame_without_it_and_before_another_appears,
                       at_the_end_all_leave_once, frames_without_times_count_as_25_a_second});
}
