// SPDX-License-Identifier: LGPL-2.1-or-later
// virtualptz with the head behind it that turns it: a person walks before a wall, 320 x 240 pixels; the window of 160
// x 120 reaches 16.1 degrees (80 pixels) to each side.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <future>
#include <set>
#include <string>
#include <vector>

// gst-check's macros bite standard headers: last.
#include "loop.h"

namespace {

std::string line(int frames, const std::string& detect = "", const std::string& head = "") {
  return loop::film(frames) + "virtualptz name=ptz width=160 height=120 ! motiondetect " + detect +
         " ! queue name=queue ! pantiltsink name=head driver=simulated horizontal-fov=32.2 pan-min=-16 "
         "pan-max=16 " +
         head;
}

// A person who walks to the right, and into the window at its start position.
scene::World stroll() {
  scene::World world;
  world.start = 44;
  world.speed = 0.8;
  return world;
}

// Where the middle of that figure is in a window that looks along `pan`, by hand.
double place(int frame, double pan) {
  constexpr double kFocal = 277.128;  // 160 / tan 30 degrees
  return stroll().figure_left(frame) + scene::kFigureWidth / 2.0 - 80 - kFocal * std::tan(pan * M_PI / 180);
}

struct Seen {
  double place = 0;
  std::vector<CerberusRegion> regions;
};

// The head is moved by hand: at rest, away from the figure at frame kAway, back at frame kBack.
constexpr int kAway = 75, kBack = 105, kFrames = 140;

std::vector<Seen> sweep(const std::string& detect) {
  std::vector<Seen> all;
  loop::Pipeline pipeline(line(kFrames, detect), stroll());
  GstElement* head = gst_bin_get_by_name(GST_BIN(pipeline.element()), "head");
  auto see = [&](GstBuffer* buffer) {
    const int frame = static_cast<int>(all.size());
    const CerberusPose* pose = cerberus_buffer_peek_pose(buffer);
    fail_unless(pose != nullptr);
    Seen& seen = all.emplace_back(Seen{place(frame, pose->pan), {}});
    GPtrArray* regions = cerberus_buffer_get_regions(buffer);
    for (guint i = 0; i < regions->len; ++i)
      seen.regions.push_back(*static_cast<CerberusRegion*>(g_ptr_array_index(regions, i)));
    g_ptr_array_unref(regions);
    gboolean done = TRUE;
    if (frame == 0 || frame == kAway || frame == kBack)
      g_signal_emit_by_name(head, "move-to", frame == kAway ? 16.0 : 0.0, 0.0, &done);
    fail_unless(done);
  };
  pipeline.watch("head", see);
  pipeline.play();
  pipeline.wait_for_end();
  gst_object_unref(head);
  fail_unless_equals_int(all.size(), kFrames);
  return all;
}

// The identity of the track at the figure's place.
guint identity(const Seen& seen) {
  fail_unless_equals_int(seen.regions.size(), 1);
  const CerberusRegion& r = seen.regions[0];
  fail_unless(r.tracked && r.x < seen.place && seen.place < r.x + r.width, "at %g, seen from %g to %g",
              seen.place, r.x, r.x + r.width);
  return r.id;
}

}  // namespace

GST_START_TEST(a_person_who_leaves_the_window_has_the_same_identity_on_return) {
  // Without the lens's angle the camera's turn is estimated from the picture's own motion.
  for (const char* detect : {"", "horizontal-fov=32.2"}) {
    const std::vector<Seen> all = sweep(detect);
    int away = 0;
    for (int frame = kAway; frame < kFrames; ++frame) away += all[frame].place < -scene::kFigureWidth / 2.0;
    fail_unless(away > 20, "away for %d frames only", away);
    fail_unless_equals_int(identity(all.back()), identity(all[kAway]));
  }
}
GST_END_TEST

// ---- a person who walks past the head's limit

// The head follows as far as 8 degrees: 40 pixels, so that its window ends at 280. Walking pace: 2 pixels a frame, .7 of
// the figure's height a second.
const std::string kNarrow = "pan-min=-8 pan-max=8";
constexpr double kPace = 2, kOutside = 300;

// Walks along straight lines between left edges, and stands at one for so many frames where two are equal.
class Path {
 public:
  explicit Path(double from) : at_{from} {}
  Path& to(double end) {
    for (const double step = end < at_.back() ? -kPace : kPace; std::abs(end - at_.back()) > kPace / 2;)
      at_.push_back(at_.back() + step);
    return *this;
  }
  Path& wait(int frames) {
    at_.insert(at_.end(), static_cast<std::size_t>(frames), at_.back());
    return *this;
  }
  // Elsewhere in the next frame.
  Path& appear(double place) {
    at_.push_back(place);
    return *this;
  }
  int frames() const { return static_cast<int>(at_.size()); }
  double left(int frame) const { return at_[static_cast<std::size_t>(std::min(frame, frames() - 1))]; }

 private:
  std::vector<double> at_;
};

// The identities of the frames in which all of the figure is in the window and one region is, visit by visit.
struct Visit {
  int frames = 0, found = 0;
  std::set<guint> identities;
};

std::vector<Visit> visits(const Path& path, const std::string& detect) {
  constexpr double kFocal = 277.128, kMargin = scene::kFigureWidth;
  scene::World world;
  world.path = [path](int frame) { return path.left(frame); };
  std::vector<Visit> all;
  bool inside = false;
  int frame = 0;
  loop::Pipeline pipeline(line(path.frames(), detect, kNarrow), world);
  auto see = [&](GstBuffer* buffer) {
    const CerberusPose* pose = cerberus_buffer_peek_pose(buffer);
    const double left = path.left(frame++) - 80 - kFocal * std::tan(pose->pan * M_PI / 180);
    const bool whole = left > kMargin && left + scene::kFigureWidth < 160 - kMargin;
    if (left + scene::kFigureWidth < 0 || left > 160) inside = false;
    if (!whole) return;
    if (!inside) all.emplace_back();
    inside = true;
    ++all.back().frames;
    const scene::Regions regions(buffer);
    for (guint i = 0; i < regions.size(); ++i)
      if (regions[i].tracked) all.back().identities.insert(regions[i].id);
    all.back().found += regions.size() == 1;
  };
  pipeline.watch("head", see);
  pipeline.play();
  pipeline.wait_for_end();
  fail_unless_equals_int(frame, path.frames());
  for (const Visit& visit : all)
    fail_unless(visit.found > visit.frames / 2, "found in %d of %d frames", visit.found, visit.frames);
  return all;
}

GST_START_TEST(a_person_who_returns_to_the_head_s_limit_has_the_same_identity) {
  for (const char* detect : {"", "horizontal-fov=32.2"}) {
    Path path(44);
    path.to(kOutside);
    for (const int seconds : {2, 5, 10}) path.wait(25 * seconds).to(180).to(kOutside);
    const std::vector<Visit> all = visits(path, detect);
    fail_unless_equals_int(all.size(), 4);
    for (const Visit& visit : all) {
      fail_unless_equals_int(visit.identities.size(), 1);
      fail_unless_equals_int(*visit.identities.begin(), *all[0].identities.begin());
    }
  }
}
GST_END_TEST

// They look the same: the side by which they come tells them apart.
GST_START_TEST(another_person_on_the_other_side_does_not_get_it) {
  for (const int seconds : {0, 2, 8}) {
    const Path path = Path(44).to(kOutside).wait(25 * seconds).appear(-30).to(200);
    const std::vector<Visit> all = visits(path, "");
    fail_unless_equals_int(all.size(), 2);
    for (const Visit& visit : all) fail_unless_equals_int(visit.identities.size(), 1);
    fail_if(all[1].identities == all[0].identities);
  }
}
GST_END_TEST

// ---- frames that are missing

GST_START_TEST(frames_may_be_missing) {
  auto missing = [](int frame) {
    return frame % 7 == 3 || (frame > 20 && frame < 26) || (frame > 40 && frame < 120);
  };
  for (const char* latency : {"0", "60000000"}) {
    loop::Pipeline pipeline(line(150, "", std::string("latency=") + latency));
    pipeline.leave_out(missing);
    int come = 0;
    auto count = [&](GstBuffer*) { ++come; };
    pipeline.watch("head", count);
    pipeline.play();
    pipeline.wait_for_end();
    int there = 0;
    for (int frame = 0; frame < 150; ++frame) there += !missing(frame);
    fail_unless_equals_int(come, there);
  }
}
GST_END_TEST

// A leaky queue, or another element that drops frames between window and head. (Each costs half a second.)
GST_START_TEST(a_frame_may_be_lost_on_its_way_to_the_head) {
  for (const char* latency : {"0", "60000000"}) {
    loop::Pipeline pipeline(line(30, "name=detect", std::string("latency=") + latency));
    g_autoptr(GstElement) detect = gst_bin_get_by_name(GST_BIN(pipeline.element()), "detect");
    g_autoptr(GstPad) pad = gst_element_get_static_pad(detect, "src");
    int number = 0;
    gst_pad_add_probe(
        pad, GST_PAD_PROBE_TYPE_BUFFER,
        [](GstPad*, GstPadProbeInfo*, gpointer count) {
          const int frame = (*static_cast<int*>(count))++;
          return frame == 0 || frame == 9 || frame == 10 ? GST_PAD_PROBE_DROP : GST_PAD_PROBE_OK;
        },
        &number, nullptr);
    int come = 0;
    auto count = [&](GstBuffer*) { ++come; };
    pipeline.watch("head", count);
    pipeline.play();
    pipeline.wait_for_end();
    fail_unless_equals_int(come, 27);
  }
}
GST_END_TEST

// Holds a frame back on its way to the head until the window takes it for lost.
struct Held {
  std::atomic<int> frame = -1;  // none
  int number = 0;
  std::promise<void> gap;
};

std::vector<double> pans(int held_frame) {
  loop::Pipeline pipeline(line(100), stroll());
  Held held;
  held.frame = held_frame;
  const auto watch = [&](const char* name, const char* pad_name, GstPadProbeType type,
                         GstPadProbeCallback see) {
    g_autoptr(GstElement) element = gst_bin_get_by_name(GST_BIN(pipeline.element()), name);
    g_autoptr(GstPad) pad = gst_element_get_static_pad(element, pad_name);
    gst_pad_add_probe(pad, type, see, &held, nullptr);
  };
  watch("ptz", "src", GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM, [](GstPad*, GstPadProbeInfo* info, gpointer data) {
    auto& held = *static_cast<Held*>(data);
    if (GST_EVENT_TYPE(GST_PAD_PROBE_INFO_EVENT(info)) == GST_EVENT_GAP && held.frame.exchange(-1) >= 0)
      held.gap.set_value();
    return GST_PAD_PROBE_OK;
  });
  watch("queue", "src", GST_PAD_PROBE_TYPE_BUFFER, [](GstPad*, GstPadProbeInfo*, gpointer data) {
    auto& held = *static_cast<Held*>(data);
    if (held.number++ == held.frame) held.gap.get_future().wait();
    return GST_PAD_PROBE_OK;
  });
  std::vector<double> all;
  auto see = [&](GstBuffer* buffer) { all.push_back(cerberus_buffer_peek_pose(buffer)->pan); };
  pipeline.watch("head", see);
  pipeline.play();
  pipeline.wait_for_end();
  fail_unless_equals_int(held.frame.load(), -1);  // it was held
  return all;
}

GST_START_TEST(a_frame_that_was_late_and_not_lost_changes_nothing) {
  const std::vector<double> all = pans(-1);
  fail_unless(all.size() == 100 && all[60] != 0);
  for (const int held : {5, 60}) fail_unless(pans(held) == all);
}
GST_END_TEST

// At half the speed a frame lasts twice as long as its duration.
GST_START_TEST(it_may_be_played_slowly) {
  loop::Pipeline pipeline(line(30, "", "latency=0"));
  int come = 0;
  auto count = [&](GstBuffer*) { ++come; };
  pipeline.watch("head", count);
  fail_if(gst_element_set_state(pipeline.element(), GST_STATE_PAUSED) == GST_STATE_CHANGE_FAILURE);
  fail_unless(gst_element_seek(pipeline.element(), 0.5, GST_FORMAT_TIME, GST_SEEK_FLAG_FLUSH,
                               GST_SEEK_TYPE_SET, 0, GST_SEEK_TYPE_SET, 20 * scene::kStep));
  come = 0;
  pipeline.play();
  pipeline.wait_for_end();
  fail_unless_equals_int(come, 20);
}
GST_END_TEST

static Suite* virtualptz_loop_suite() {
  watch_library_log();
  Suite* s = suite_create("virtualptz_loop");
  TCase* tc = tcase_create("all");
  suite_add_tcase(s, tc);
  tcase_set_timeout(tc, 60);
  tcase_add_test(tc, a_person_who_leaves_the_window_has_the_same_identity_on_return);
  tcase_add_test(tc, a_person_who_returns_to_the_head_s_limit_has_the_same_identity);
  tcase_add_test(tc, another_person_on_the_other_side_does_not_get_it);
  tcase_add_test(tc, frames_may_be_missing);
  tcase_add_test(tc, a_frame_may_be_lost_on_its_way_to_the_head);
  tcase_add_test(tc, a_frame_that_was_late_and_not_lost_changes_nothing);
  tcase_add_test(tc, it_may_be_played_slowly);
  return s;
}

GST_CHECK_MAIN(virtualptz_loop)
