// SPDX-License-Identifier: LGPL-2.1-or-later
// pantiltsink's action signal `follow`: the application chooses the track that the head follows.
#include <vector>

#include "cerberus/private/follow_query.hpp"
#include "head_rig.h"

namespace {

using namespace head_rig;

constexpr double kFirst = -10, kSecond = 10;  // bearings

// Two people stand there. The usual choice is the first: the feet are lower, and a fusion decision, if any, names it.
struct Scene {
  Rig rig{"tilt-min=0 tilt-max=0"};  // the persons are drawn for a level camera
  bool fused;
  int next = 0;
  double pan = 0;  // when the next frame is taken

  explicit Scene(bool with_fusion = false) : fused(with_fusion) {}

  void frames(int count, bool first = true, bool second = true) {
    for (; count > 0; --count) {
      GstBuffer* buffer = frame_at(next++ * kFrame);
      if (first) stand(buffer, 1, kFirst, 20);
      if (second) stand(buffer, 2, kSecond, 0);
      if (fused) add(buffer, first ? CERBERUS_FUSION_TRACK : CERBERUS_FUSION_HOLD, first ? 1 : 0);
      rig.push(buffer);
      for (const CerberusPose& pose : rig.poses()) {  // they reach further than the next frame
        if (pose.valid_from <= next * kFrame && next * kFrame <= pose.valid_until)
          cerberus_pose_evaluate(&pose, next * kFrame, &pan, nullptr);
      }
    }
  }
  void assert_looks_at(double bearing) const {
    fail_unless(std::fabs(pan - bearing) <= 0.7, "%d: %g, not %g", next, pan, bearing);
  }
  std::string last_reason() {
    const auto messages = rig.messages();
    return messages.empty() ? "" : messages.back().reason;
  }
  void assert_says(const char* reason) {
    const std::string last = last_reason();
    fail_unless(last.ends_with(reason), "%d: '%s', not '%s'", next, last.c_str(), reason);
  }
  void assert_warns_of(const char* track) {
    const std::string text = rig.warnings();
    fail_unless(text.starts_with(std::string("Track ") + track +
                                 ", which was to be followed, is on no frame for 5 s: "),
                "%d: '%s'", next, text.c_str());
    fail_unless(text.find('\n') == text.size() - 1, "%s", text.c_str());  // one
  }
  void assert_no_warning() {
    const std::string text = rig.warnings();
    fail_unless(text.empty(), "%d: %s", next, text.c_str());
  }

 private:
  void stand(GstBuffer* buffer, guint id, double bearing, double lower) const {
    Person shown = person(id, bearing - pan);
    shown.y += lower;
    add(buffer, shown);
  }
};

GST_START_TEST(the_chosen_one_is_followed_whatever_the_usual_choice_is_until_auto) {
  for (const bool fused : {false, true}) {
    Scene scene(fused);
    scene.frames(50);
    scene.assert_looks_at(kFirst);
    fail_unless(scene.rig.follow(2));
    scene.frames(1);
    scene.assert_says("follows the chosen track 2");
    scene.frames(500);
    scene.assert_looks_at(kSecond);
    scene.assert_says("");  // nothing more
    fail_unless(scene.rig.call("auto"));
    scene.frames(50);
    scene.assert_looks_at(kFirst);
    scene.assert_says("track 1");
    scene.assert_no_warning();
  }
}
GST_END_TEST

GST_START_TEST(while_the_chosen_track_is_away_no_other_is_followed) {
  for (const bool fused : {false, true}) {
    Scene scene(fused);
    fail_unless(scene.rig.follow(2));
    scene.frames(50);
    scene.assert_looks_at(kSecond);
    scene.frames(120, true, false);  // 4.8 s
    scene.assert_looks_at(kSecond);
    scene.assert_says("waits for the chosen track 2");
    scene.frames(10);
    scene.assert_says("follows the chosen track 2");
    scene.frames(120, true, false);
    scene.assert_looks_at(kSecond);
    scene.assert_no_warning();
  }
}
GST_END_TEST

// No track is left in the picture, and a sensor on the left detects: it may be the chosen person.
GST_START_TEST(while_the_chosen_one_is_away_sensors_are_obeyed) {
  Scene scene;
  fail_unless(scene.rig.follow(2));
  scene.frames(50);
  for (int k = 0; k < 50; ++k) {
    GstBuffer* buffer = frame_at(scene.next++ * kFrame);
    add(buffer, CERBERUS_FUSION_TURN_LEFT);
    scene.rig.push(buffer);
  }
  fail_unless(scene.rig.poses().back().pan < kSecond - 40);
  scene.assert_no_warning();
}
GST_END_TEST

GST_START_TEST(a_chosen_track_that_stays_away_is_warned_of_once_and_given_up) {
  for (const bool fused : {false, true}) {
    Scene scene(fused);
    fail_unless(scene.rig.follow(2));
    scene.frames(50);
    scene.frames(124, true, false);  // 4.96 s since the last frame with it
    scene.assert_looks_at(kSecond);
    scene.assert_no_warning();
    scene.frames(1, true, false);
    scene.assert_warns_of("2");
    scene.frames(200);
    scene.assert_looks_at(kFirst);
    scene.assert_no_warning();
  }
}
GST_END_TEST

GST_START_TEST(a_chosen_track_that_never_comes_is_warned_of_and_the_usual_choice_goes_on_meanwhile) {
  Scene scene;
  fail_unless(scene.rig.follow(4000000000));
  scene.frames(50);
  scene.assert_looks_at(kFirst);
  scene.frames(75);
  scene.assert_no_warning();
  scene.frames(1);  // the 126th: 5 s after the first
  scene.assert_warns_of("4000000000");
  scene.frames(200);
  scene.assert_looks_at(kFirst);
  scene.assert_no_warning();
}
GST_END_TEST

GST_START_TEST(of_what_the_application_asks_for_the_last_counts) {
  Scene scene;
  fail_unless(scene.rig.call("move-to", 40, 0));
  scene.frames(50);
  scene.assert_looks_at(40);
  fail_unless(scene.rig.follow(2));
  scene.frames(50);
  scene.assert_looks_at(kSecond);
  fail_unless(scene.rig.follow(1));
  scene.frames(50);
  scene.assert_looks_at(kFirst);
  fail_unless(scene.rig.follow(2));
  fail_unless(scene.rig.call("stop"));
  fail_unless(scene.rig.call("auto"));  // gives back to the usual choice, not to an earlier one
  scene.frames(50);
  scene.assert_looks_at(kFirst);
}
GST_END_TEST

GST_START_TEST(no_track_is_chosen_without_a_head_nor_without_an_identity) {
  Scene scene;
  fail_if(scene.rig.follow(0));
  scene.frames(5);
  scene.assert_says("track 1");
  fail_unless(scene.rig.follow(2));
  gst_element_set_state(scene.rig.element, GST_STATE_NULL);
  fail_if(scene.rig.follow(2));
  // Another start is another stream with other tracks.
  gst_element_set_state(scene.rig.element, GST_STATE_PLAYING);
  scene.rig.begin();
  scene.rig.poses();
  scene.next = 0;
  scene.pan = 0;
  scene.frames(50);
  scene.assert_looks_at(kFirst);
}
GST_END_TEST

GST_START_TEST(a_refused_choice_leaves_the_one_before_with_the_fusion_that_holds_it) {
  std::vector<guint> asked;  // of a pirfusion upstream, which takes every choice
  Scene scene;
  gst_pad_set_query_function_full(
      scene.rig.harness->srcpad,
      [](GstPad* pad, GstObject* parent, GstQuery* query) -> gboolean {
        std::string_view head;
        guint track = 0;
        if (!cerberus::parse_follow_query(query, head, track))
          return gst_pad_query_default(pad, parent, query);
        static_cast<std::vector<guint>*>(pad->querydata)->push_back(track);
        return TRUE;
      },
      &asked, nullptr);
  fail_unless(scene.rig.follow(31));
  fail_if(scene.rig.follow(0));
  fail_unless(asked == std::vector<guint>{31});
  fail_unless(scene.rig.call("auto"));
  fail_unless(asked == (std::vector<guint>{31, 0}));
  fail_unless(scene.rig.call("auto"));
  fail_unless(asked.size() == 2);
}
GST_END_TEST

GST_START_TEST(a_flush_does_not_unmake_the_choice) {
  Scene scene;
  fail_unless(scene.rig.follow(2));
  scene.frames(50);
  fail_unless(gst_harness_push_event(scene.rig.harness, gst_event_new_flush_start()));
  fail_unless(gst_harness_push_event(scene.rig.harness, gst_event_new_flush_stop(TRUE)));
  scene.rig.begin();
  scene.rig.poses();
  scene.next = 0;
  scene.frames(50);
  scene.assert_looks_at(kSecond);
  scene.frames(150);
  fail_unless(gst_harness_push_event(scene.rig.harness, gst_event_new_flush_start()));
  fail_unless(gst_harness_push_event(scene.rig.harness, gst_event_new_flush_stop(TRUE)));
  scene.rig.begin();
  scene.rig.poses();
  scene.next = 0;
  scene.frames(125, true, false);
  scene.assert_no_warning();
  scene.frames(1, true, false);  // 5 s of the time that has begun anew
  scene.assert_warns_of("2");
}
GST_END_TEST

Suite* pantiltsink_follow_suite() {
  Suite* suite = suite_create("pantiltsink follow");
  TCase* tests = tcase_create("all");
  suite_add_tcase(suite, tests);
  tcase_set_timeout(tests, 60);
  tcase_add_checked_fixture(tests, watch_library_log, nullptr);
  tcase_add_test(tests, the_chosen_one_is_followed_whatever_the_usual_choice_is_until_auto);
  tcase_add_test(tests, while_the_chosen_track_is_away_no_other_is_followed);
  tcase_add_test(tests, while_the_chosen_one_is_away_sensors_are_obeyed);
  tcase_add_test(tests, a_chosen_track_that_stays_away_is_warned_of_once_and_given_up);
  tcase_add_test(tests, a_chosen_track_that_never_comes_is_warned_of_and_the_usual_choice_goes_on_meanwhile);
  tcase_add_test(tests, of_what_the_application_asks_for_the_last_counts);
  tcase_add_test(tests, no_track_is_chosen_without_a_head_nor_without_an_identity);
  tcase_add_test(tests, a_refused_choice_leaves_the_one_before_with_the_fusion_that_holds_it);
  tcase_add_test(tests, a_flush_does_not_unmake_the_choice);
  return suite;
}

}  // namespace

GST_CHECK_MAIN(pantiltsink_follow);
