// SPDX-License-Identifier: LGPL-2.1-or-later
// Drawn people and drawn boxes on frames, and regions on them: which of them are persons.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "outputs.h"
#include "support/bodies.h"
#include "support/darknet.h"
#include "support/onnx.h"
#include "support/temporary_file.h"
#include "support/temporary_folder.h"

#include <gst/check/gsttestclock.h>

using namespace outputs;

namespace {

// A file with this text, until the end of its life.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& text) : path_(cerberus::tests::temporary_file(text)) {}
  ~TemporaryFile() { std::remove(path_.c_str()); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

constexpr int kWide = 320, kHigh = 240;
constexpr guint8 kWall = 170, kDark = 60;
constexpr int kPersonHeight = 100, kPersonWidth = 40;

void draw_box(std::vector<guint8>& picture, int x, int y, int width, int height) {
  for (int row = y; row < y + height; ++row)
    std::fill_n(picture.begin() + static_cast<std::ptrdiff_t>(row) * kWide + x, width, kDark);
}

std::string caps() {
  return caps_string("GRAY8", kWide, kHigh);
}

// Frame `number` of a scene: drawn persons at `people`, a box at 20,100 where `thing`.
GstBuffer* scene(int number, const std::vector<double>& people, bool thing = false) {
  std::vector<guint8> picture(static_cast<std::size_t>(kWide) * kHigh, kWall);
  for (const double x : people)
    cerberus::tests::draw_person({picture.data(), kWide, kHigh, kWide}, x, 90, kPersonHeight, kDark);
  if (thing) draw_box(picture, 20, 100, 60, 40);
  GstBuffer* buffer = frame(info_of(caps()), number);
  gst_buffer_fill(buffer, 0, picture.data(), picture.size());
  return buffer;
}

CerberusRegion person_track(guint id, double x) {
  return region(id, x, 90, kPersonWidth, kPersonHeight);
}

struct Verifier {
  Harness h;
  explicit Verifier(const char* properties, bool live = false)
      : h(harness((std::string("personverify ") + properties).c_str())) {
    gst_harness_set_live(h.get(), live);
    gst_harness_set_src_caps_str(h.get(), caps().c_str());
  }
  GstBuffer* through(GstBuffer* in) {
    fail_unless_equals_int(gst_harness_push(h.get(), in), GST_FLOW_OK);
    return gst_harness_pull(h.get());
  }
};

// The regions after `frames` frames of a scene that moves to the right by `step` pixels a frame.
std::vector<CerberusRegion> regions_after(Verifier& verifier, int frames, const std::vector<double>& people,
                                          bool thing, const std::vector<CerberusRegion>& tracks,
                                          int step = 1) {
  std::vector<CerberusRegion> found;
  for (int n = 0; n < frames; ++n) {
    std::vector<double> moved = people;
    for (double& x : moved) x += step * n;
    GstBuffer* in = scene(n, moved, thing);
    for (CerberusRegion track : tracks) {
      track.x += step * n;
      add(in, track);
    }
    GstBuffer* out = verifier.through(in);
    found.clear();
    g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(out);
    for (guint i = 0; i < regions->len; ++i)
      found.push_back(*static_cast<const CerberusRegion*>(g_ptr_array_index(regions, i)));
    gst_buffer_unref(out);
  }
  std::ranges::sort(found, {}, &CerberusRegion::x);
  return found;
}

// What rests and no look has shown is not published.
bool holds_person(const GPtrArray* regions) {
  fail_unless(regions->len <= 1);
  return regions->len == 1 && static_cast<const CerberusRegion*>(g_ptr_array_index(regions, 0))->person;
}

// The middle of a region, compared with that of a drawn person.
void expect_place(const CerberusRegion& r, double x) {
  fail_unless(std::abs(r.x + r.width / 2 - (x + kPersonWidth / 2)) < 10, "at %.0f, not %.0f", r.x, x);
  fail_unless(r.height > 75 && r.height < 125, "%.0f high", r.height);
}

}  // namespace

GST_START_TEST(a_track_that_is_a_person_is_published_as_one) {
  for (const char* detector : {"detector=daimler", "detector=hog"}) {
    Verifier verifier(detector);
    const auto found = regions_after(verifier, 50, {100}, false, {person_track(7, 100)});
    fail_unless_equals_int(found.size(), 1);
    fail_unless(found[0].person && found[0].tracked, "%s", detector);
    fail_unless_equals_int(found[0].id, 1);
    fail_unless(found[0].confidence > 0.5 && found[0].confidence <= 1, "%s: %f", detector,
                found[0].confidence);
    fail_unless(found[0].motion);
    expect_place(found[0], 149);
  }
}
GST_END_TEST

GST_START_TEST(who_is_seen_by_the_detector_alone_has_no_other_witness) {
  Verifier verifier("");
  for (int n = 0; n < 24; ++n) {
    GstBuffer* in = scene(n, {100.0 + 3 * n});
    g_autoptr(GPtrArray) none = g_ptr_array_new();
    cerberus_buffer_set_regions(in, none);
    GstBuffer* out = verifier.through(in);
    g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(out);
    if (n > 12) {
      fail_unless_equals_int(regions->len, 1);
      const auto* each = static_cast<const CerberusRegion*>(g_ptr_array_index(regions, 0));
      fail_unless(each->person && !each->motion);
    }
    gst_buffer_unref(out);
  }
}
GST_END_TEST

GST_START_TEST(a_track_that_is_no_person_stays_unless_persons_are_required) {
  for (const char* properties : {"", "detector=hog", "require=person", "detector=hog require=person"}) {
    const bool required = g_strstr_len(properties, -1, "require");
    Verifier verifier(properties);
    CerberusRegion thing = region(3, 20, 100, 60, 40);
    const auto found = regions_after(verifier, 10, {}, true, {thing}, 4);
    fail_unless_equals_int(found.size(), required ? 0 : 1);
    for (const auto& each : found) fail_unless(!each.person && each.motion && each.id == 1);
  }
}
GST_END_TEST

GST_START_TEST(a_track_that_holds_two_people_becomes_two_persons) {
  Verifier verifier("");
  CerberusRegion both = region(5, 100, 88, 105, 104);
  both.kind = CERBERUS_REGION_KIND_GROUP;
  const auto found = regions_after(verifier, 24, {100, 165}, false, {both}, 2);
  fail_unless_equals_int(found.size(), 2);
  expect_place(found[0], 146);
  expect_place(found[1], 211);
  fail_unless(found[0].person && found[1].person && found[0].id != found[1].id);
}
GST_END_TEST

// Not live, 10 ms a frame: the look at the first frame counts from 40 ms on, however long it takes.
GST_START_TEST(a_result_counts_40_ms_of_running_time_after_its_frame) {
  Verifier verifier("");
  for (int n = 0; n < 6; ++n) {
    GstBuffer* in = scene(n, {140});
    GST_BUFFER_PTS(in) = static_cast<GstClockTime>(n) * 10 * GST_MSECOND;
    add(in, person_track(7, 140));
    GstBuffer* out = verifier.through(in);
    g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(out);
    fail_unless(holds_person(regions) == (n >= 4), "frame %d", n);
    gst_buffer_unref(out);
  }
}
GST_END_TEST

GST_START_TEST(two_runs_give_the_same_regions) {
  std::vector<CerberusRegion> runs[2];
  for (auto& run : runs) {
    Verifier verifier("rate=10");
    CerberusRegion both = region(5, 100, 88, 105, 104);
    both.kind = CERBERUS_REGION_KIND_GROUP;
    run = regions_after(verifier, 24, {100, 165}, false, {both}, 2);
  }
  fail_unless(runs[0].size() == 2 && runs[1].size() == 2);
  for (std::size_t i = 0; i < 2; ++i) {
    const CerberusRegion &a = runs[0][i], &b = runs[1][i];
    fail_unless(a.id == b.id && a.x == b.x && a.y == b.y && a.width == b.width && a.height == b.height &&
                a.vx == b.vx && a.confidence == b.confidence);
  }
}
GST_END_TEST

GST_START_TEST(the_first_look_is_put_off_by_the_phase) {
  Verifier verifier("rate=5 phase=0.6");  // 120 ms: frame 3, and its result at frame 4
  for (int n = 0; n < 8; ++n) {
    GstBuffer* in = scene(n, {140});
    add(in, person_track(7, 140));
    GstBuffer* out = verifier.through(in);
    g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(out);
    fail_unless(holds_person(regions) == (n >= 4), "frame %d", n);
    gst_buffer_unref(out);
  }
}
GST_END_TEST

// Looks are two seconds apart: that of the onset at frame 20 comes between, and its result is there one frame later.
GST_START_TEST(an_onset_is_looked_at_at_once) {
  for (const bool onset : {false, true}) {
    Verifier verifier("rate=0.5");
    for (int n = 0; n < 30; ++n) {
      const bool there = n >= 10;
      if (n == 20 && onset)
        gst_harness_push_upstream_event(
            verifier.h.get(),
            gst_event_new_custom(GST_EVENT_CUSTOM_UPSTREAM, gst_structure_new_empty("cerberus-onset")));
      GstBuffer* in = there ? scene(n, {140}) : scene(n, {});
      if (there) add(in, person_track(7, 140));
      GstBuffer* out = verifier.through(in);
      g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(out);
      fail_unless(holds_person(regions) == (onset && n >= 21), "frame %d", n);
      gst_buffer_unref(out);
    }
  }
}
GST_END_TEST

// Live, the result comes when it does: every frame leaves at once, and one of them has it.
GST_START_TEST(live_no_frame_waits_and_the_result_comes_later) {
  Verifier verifier("", true);
  bool person = false;
  const gint64 patience = g_get_monotonic_time() + 60 * G_USEC_PER_SEC;
  gulong pause = 1000;  // microseconds, growing: the result must come within 32 frames
  for (int n = 0; !person; ++n) {
    fail_unless(g_get_monotonic_time() < patience, "no result within a minute");
    GstBuffer* in = scene(n, {140});
    add(in, person_track(7, 140));
    GstBuffer* out = verifier.through(in);
    g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(out);
    person = holds_person(regions);
    gst_buffer_unref(out);
    g_usleep(pause);
    pause = std::min<gulong>(pause * 3 / 2, G_USEC_PER_SEC / 2);
  }
}
GST_END_TEST

// The camera is measured no more at the frame after the one that is looked at: another scene. The shortest of ten times is
// little where nothing waits, and nearly a whole look where the frame waits for its end.
GST_START_TEST(live_no_frame_waits_at_a_cut_during_a_look) {
  const auto seconds = [](Verifier& verifier, GstBuffer* in) {
    const gint64 begun = g_get_monotonic_time();
    gst_buffer_unref(verifier.through(in));
    return static_cast<double>(g_get_monotonic_time() - begun) / G_USEC_PER_SEC;
  };
  double look = 1e9, cut = 1e9;
  for (int n = 0; n < 10; ++n) {
    Verifier waiting(""), live("", true);
    gst_buffer_unref(waiting.through(scene(0, {140})));
    look = std::min(look, seconds(waiting, scene(1, {140})));  // 40 ms later: it waits for the result
    GstBuffer* in = scene(0, {140});
    CerberusCameraMotion motion;
    cerberus_camera_motion_init(&motion);
    motion.scene_age = 1;
    cerberus_buffer_set_camera_motion(in, &motion);
    gst_buffer_unref(live.through(in));
    cut = std::min(cut, seconds(live, scene(1, {140})));
  }
  fail_unless(cut < look / 2, "%.4f s, of %.4f s for a look", cut, look);
}
GST_END_TEST

// The look that the cut has overtaken says nothing, and the next one begins all the same.
GST_START_TEST(live_after_a_cut_the_detector_looks_on) {
  Verifier verifier("", true);
  bool person = false;
  const gint64 patience = g_get_monotonic_time() + 60 * G_USEC_PER_SEC;
  for (int n = 0; !person; ++n) {
    fail_unless(g_get_monotonic_time() < patience, "no result within a minute");
    GstBuffer* in = scene(n, {140});
    add(in, person_track(7, 140));
    if (n == 0) {
      CerberusCameraMotion motion;
      cerberus_camera_motion_init(&motion);
      motion.scene_age = 1;
      cerberus_buffer_set_camera_motion(in, &motion);
    }
    GstBuffer* out = verifier.through(in);
    g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(out);
    person = holds_person(regions);
    gst_buffer_unref(out);
    g_usleep(10 * 1000);
  }
}
GST_END_TEST

GST_START_TEST(regions_of_interest_of_other_elements_are_verified_too) {
  for (const bool required : {false, true}) {
    Verifier verifier(required ? "require=person" : "");
    GstBuffer* out = nullptr;
    for (int n = 0; n < 8; ++n) {
      gst_clear_buffer(&out);
      GstBuffer* in = scene(n, {200}, true);
      gst_buffer_add_video_region_of_interest_meta(in, "face", 200, 90, kPersonWidth, kPersonHeight);
      gst_buffer_add_video_region_of_interest_meta(in, "thing", 20, 100, 60, 40);
      out = verifier.through(in);
    }
    g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(out);
    fail_unless_equals_int(regions->len, 1);
    const auto* each = static_cast<const CerberusRegion*>(g_ptr_array_index(regions, 0));
    fail_unless(each->person && !each->motion);
    expect_place(*each, 200);
    int others = 0;
    gpointer state = nullptr;
    while (GstMeta* meta =
               gst_buffer_iterate_meta_filtered(out, &state, GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE))
      others +=
          reinterpret_cast<GstVideoRegionOfInterestMeta*>(meta)->roi_type != g_quark_from_string("person");
    fail_unless_equals_int(others, required ? 0 : 2);
    gst_buffer_unref(out);
  }
}
GST_END_TEST

// A network that sees a person of 16 x 60 in the middle of every picture of 64 x 64.
GST_START_TEST(a_model_of_the_users_finds_people_in_place_of_the_usual_detector) {
  const TemporaryFile model(cerberus::tests::onnx::constant_yolo(64, {32, 32, 16, 60, 0.1f, 0.9f})),
      labels("cat\nperson\r\n");
  Verifier verifier(("model=" + model.path() + " labels=" + labels.path()).c_str());
  // The frame's 320 columns are the network's 64: its box is 80 x 300 pixels.
  const auto found = regions_after(verifier, 8, {}, true, {region(3, 115, 20, 80, 200)});
  fail_unless_equals_int(found.size(), 1);
  fail_unless(found[0].person && found[0].id == 1);
  // The track of what moves knows better where that ends.
  fail_unless(found[0].width == 80 && found[0].height == 200);
}
GST_END_TEST

namespace {

// The persons that a network finds in a picture with one moving thing.
std::size_t persons_by(const std::string& network, const char* properties = "") {
  const TemporaryFile model(network);
  Verifier verifier(("model=" + model.path() + " " + properties).c_str());
  const auto found = regions_after(verifier, 8, {}, true, {region(3, 100, 80, 117, 90)});
  return static_cast<std::size_t>(
      std::ranges::count_if(found, [](const CerberusRegion& r) { return r.person; }));
}

// `boxes` rows: the first one, and zeros.
std::vector<float> rows(int boxes, std::vector<float> first) {
  first.resize(first.size() * static_cast<std::size_t>(boxes), 0);
  return first;
}

}  // namespace

// 20 x 6: left, top, right, bottom, score, class. Read as YOLO 5's, the car (class 2) is a person with a score of 1.76.
GST_START_TEST(a_car_of_a_network_with_boxes_end_to_end_is_no_person) {
  namespace onnx = cerberus::tests::onnx;
  const auto network = [](float kind) {
    return onnx::constant_network(64, {{"output0", {1, 20, 6}, rows(20, {24, 2, 40, 62, .88f, kind})}});
  };
  fail_unless_equals_int(persons_by(network(2)), 0);
  fail_unless_equals_int(persons_by(network(0)), 1);
}
GST_END_TEST

// OpenCV 4.6 does not multiply 1 x 4 x 64 by 1 x 64.
GST_START_TEST(a_network_whose_boxes_are_multiplied_by_the_size_of_their_cells_runs) {
  fail_unless_equals_int(
      persons_by(cerberus::tests::onnx::constant_yolo_in_cells(64, {4, 4, 2, 7.5f}, {.9f, .1f})), 1);
}
GST_END_TEST

GST_START_TEST(of_several_outputs_of_a_model_the_list_of_boxes_is_read) {
  namespace onnx = cerberus::tests::onnx;
  std::vector<float> map(3 * 8 * 8 * 7, -4), list = rows(252, {32, 32, 16, 60, .9f, .9f, .1f});
  fail_unless_equals_int(persons_by(onnx::constant_network(64, {{"map", {1, 3, 8, 8, 7}, map},
                                                                {"list", {1, 252, 7}, list},
                                                                {"other", {1, 3, 4, 16, 7}, map}})),
                         1);
}
GST_END_TEST

GST_START_TEST(a_model_without_a_folder_is_found_among_the_users_data) {
  const TemporaryFolder data;
  const std::string models = data.path + "/cerberus/models";
  g_mkdir_with_parents(models.c_str(), 0700);
  const std::vector<cerberus::tests::darknet::Anchor> person{{16, 60, 9, {9}}};
  const std::string weights = cerberus::tests::darknet::weights(64, person),
                    cfg = cerberus::tests::darknet::cfg(64, person);
  g_file_set_contents((models + "/body.weights").c_str(), weights.data(), static_cast<gssize>(weights.size()),
                      nullptr);
  g_file_set_contents((models + "/body.cfg").c_str(), cfg.data(), static_cast<gssize>(cfg.size()), nullptr);
  // A process of its own: GLib reads the variable once.
#if defined(__SANITIZE_ADDRESS__)
  const std::string sanitizer =
      "LD_PRELOAD=\"$(gcc -print-file-name=libasan.so)\" ";  // loaded before all else
#else
  const std::string sanitizer;
#endif
  const std::string line =
      sanitizer + "XDG_DATA_HOME=" + data.path +
      " gst-launch-1.0 -q fakesrc num-buffers=0 ! personverify model=body.weights ! fakesink";
  fail_unless_equals_int(std::system(line.c_str()), 0);
}
GST_END_TEST

GST_START_TEST(a_wrong_model_is_an_error_that_names_it) {
  namespace onnx = cerberus::tests::onnx;
  const TemporaryFile good(onnx::constant_yolo(64, {32, 32, 16, 60, 0.9f})), text("not a model"),
      labels("cat\ndog\n"), shapeless(onnx::model(onnx::bytes(11, onnx::value_info("x", {1, 3, 0, 0})))),
      strange(onnx::constant_yolo(64, {1, 2, 3, 4})),
      logits(onnx::constant_yolo(64, {32, 32, 16, 60, -4.5f})),
      sizeless(onnx::constant_yolo(64, {32, 32, -1, 60, .9f, .1f}));
  const struct {
    std::string properties, says;
  } cases[] = {
      {"model=/nowhere.onnx", "/nowhere.onnx cannot be read"},
      {"model=" + text.path(), text.path() + " is no ONNX file"},
      {"model=" + shapeless.path(), "fixed size"},
      {"model=" + strange.path(), strange.path() + " cannot be used: its output 1 x 4 x 64 cannot be read"},
      {"model=" + logits.path(), "1 x 5 x 64 cannot be read: scores are no probabilities (-4.5"},
      {"model=" + sizeless.path(), "1 x 6 x 64 cannot be read: boxes have no size"},
      {"model=" + good.path() + " labels=/nowhere.txt", "/nowhere.txt cannot be read"},
      {"model=" + good.path() + " labels=" + labels.path(), "no line that says person"}};
  for (const auto& each : cases) {
    GstElement* element = gst_parse_launch(("personverify " + each.properties).c_str(), nullptr);
    GstBus* bus = gst_bus_new();
    gst_element_set_bus(element, bus);
    fail_unless_equals_int(gst_element_set_state(element, GST_STATE_PAUSED), GST_STATE_CHANGE_FAILURE);
    GstMessage* message = gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR);
    fail_unless(message != nullptr);
    GError* error = nullptr;
    gst_message_parse_error(message, &error, nullptr);
    fail_unless(g_strstr_len(error->message, -1, each.says.c_str()), "%s", error->message);
    g_clear_error(&error);
    gst_message_unref(message);
    gst_element_set_bus(element, nullptr);
    gst_element_set_state(element, GST_STATE_NULL);
    gst_object_unref(element);
    gst_object_unref(bus);
  }
}
GST_END_TEST

// A black picture has scores of .9, one of light more than 100: the trial at the start does not see it.
GST_START_TEST(a_model_that_is_refused_by_a_later_picture_is_the_same_error) {
  const TemporaryFile model(cerberus::tests::onnx::constant_yolo(64, {32, 32, 16, 60, .9f}, 1));
  Verifier verifier(("model=" + model.path()).c_str());
  Bus bus(verifier.h.get());
  GstFlowReturn flow = GST_FLOW_OK;
  for (int n = 0; n < 8 && flow == GST_FLOW_OK; ++n) {
    GstBuffer* in = scene(n, {140});
    add(in, person_track(7, 140));
    flow = gst_harness_push(verifier.h.get(), in);
  }
  fail_unless_equals_int(flow, GST_FLOW_ERROR);
  GstMessage* message = gst_bus_pop_filtered(bus.bus, GST_MESSAGE_ERROR);
  fail_unless(message != nullptr);
  GError* error = nullptr;
  gst_message_parse_error(message, &error, nullptr);
  fail_unless(g_error_matches(error, GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_SETTINGS), "%s", error->message);
  const std::string begins =
      "The model " + model.path() +
      " cannot be used: its output 1 x 5 x 64 cannot be read: scores are no probabilities (";
  fail_unless(g_str_has_prefix(error->message, begins.c_str()), "%s", error->message);
  fail_unless(g_strstr_len(error->message, -1, "export it with the sigmoid"), "%s", error->message);
  g_clear_error(&error);
  gst_message_unref(message);
  fail_unless_equals_int(bus.count(GST_MESSAGE_ERROR), 0);
}
GST_END_TEST

// Frame 12 of 20 is stamped three hours ahead: a person is a person after it, and looks go on.
GST_START_TEST(a_single_time_that_is_far_off_forgets_nobody) {
  Verifier verifier("");
  for (int n = 0; n < 20; ++n) {
    GstBuffer* in = scene(n, {140.0 + n});
    if (n == 12) GST_BUFFER_PTS(in) += 3 * 3600 * GST_SECOND;
    CerberusRegion track = person_track(7, 140);
    track.x += n;
    add(in, track);
    GstBuffer* out = verifier.through(in);
    g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(out);
    fail_unless(n < 8 || holds_person(regions), "frame %d", n);
    gst_buffer_unref(out);
  }
}
GST_END_TEST

// A live camera is silent for 12 s, as the clock confirms: another person may stand there.
GST_START_TEST(after_a_long_silence_of_a_live_camera_it_begins_anew) {
  Verifier verifier("", true);
  gst_harness_use_testclock(verifier.h.get());
  g_autoptr(GstTestClock) clock = gst_harness_get_testclock(verifier.h.get());
  const auto is_person = [&](GstBuffer* in) {
    gst_test_clock_set_time(clock, GST_BUFFER_PTS(in));
    add(in, person_track(7, 140));
    GstBuffer* out = verifier.through(in);
    g_autoptr(GPtrArray) regions = cerberus_buffer_get_regions(out);
    const bool person = holds_person(regions);
    gst_buffer_unref(out);
    return person;
  };
  const gint64 patience = g_get_monotonic_time() + 60 * G_USEC_PER_SEC;
  int n = 0;
  while (!is_person(scene(n, {140}))) {
    fail_unless(g_get_monotonic_time() < patience, "no result within a minute");
    g_usleep(10 * 1000);
    ++n;
  }
  GstBuffer* late = scene(n + 1, {140});
  GST_BUFFER_PTS(late) += 12 * GST_SECOND;
  fail_unless(!is_person(late));
}
GST_END_TEST

GST_START_TEST(the_mark_of_a_repeated_picture_stays) {
  Verifier verifier("");
  for (const bool repeated : {false, true}) {
    GstBuffer* in = scene(repeated, {140});
    if (repeated) GST_BUFFER_FLAG_SET(in, GST_BUFFER_FLAG_GAP);
    GstBuffer* out = verifier.through(in);
    fail_unless_equals_int(GST_BUFFER_FLAG_IS_SET(out, GST_BUFFER_FLAG_GAP), repeated);
    gst_buffer_unref(out);
  }
}
GST_END_TEST

GST_START_TEST(after_a_flush_and_with_other_caps_it_begins_anew) {
  Verifier verifier("");
  regions_after(verifier, 8, {140}, false, {person_track(7, 140)});
  push_flush(verifier.h.get());
  auto found = regions_after(verifier, 1, {140}, false, {person_track(8, 140)});
  fail_unless(found.empty());
  gst_harness_set_src_caps_str(verifier.h.get(), caps_string("I420", 64, 48).c_str());
  GstBuffer* out = verifier.through(frame(info_of(caps_string("I420", 64, 48)), 9));
  fail_unless(!cerberus_buffer_regions_known(out));
  gst_buffer_unref(out);
}
GST_END_TEST

namespace {

Suite* personverify_suite() {
  watch_library_log();
  Suite* suite = suite_create("personverify");
  TCase* tests = tcase_create("all");
  tcase_set_timeout(tests, 120);
  suite_add_tcase(suite, tests);
  tcase_add_test(tests, a_track_that_is_a_person_is_published_as_one);
  tcase_add_test(tests, who_is_seen_by_the_detector_alone_has_no_other_witness);
  tcase_add_test(tests, a_track_that_is_no_person_stays_unless_persons_are_required);
  tcase_add_test(tests, a_track_that_holds_two_people_becomes_two_persons);
  tcase_add_test(tests, a_result_counts_40_ms_of_running_time_after_its_frame);
  tcase_add_test(tests, two_runs_give_the_same_regions);
  tcase_add_test(tests, the_first_look_is_put_off_by_the_phase);
  tcase_add_test(tests, an_onset_is_looked_at_at_once);
  tcase_add_test(tests, live_no_frame_waits_and_the_result_comes_later);
  tcase_add_test(tests, live_no_frame_waits_at_a_cut_during_a_look);
  tcase_add_test(tests, live_after_a_cut_the_detector_looks_on);
  tcase_add_test(tests, regions_of_interest_of_other_elements_are_verified_too);
  tcase_add_test(tests, a_model_of_the_users_finds_people_in_place_of_the_usual_detector);
  tcase_add_test(tests, a_car_of_a_network_with_boxes_end_to_end_is_no_person);
  tcase_add_test(tests, a_network_whose_boxes_are_multiplied_by_the_size_of_their_cells_runs);
  tcase_add_test(tests, of_several_outputs_of_a_model_the_list_of_boxes_is_read);
  tcase_add_test(tests, a_model_without_a_folder_is_found_among_the_users_data);
  tcase_add_test(tests, a_wrong_model_is_an_error_that_names_it);
  tcase_add_test(tests, a_model_that_is_refused_by_a_later_picture_is_the_same_error);
  tcase_add_test(tests, a_single_time_that_is_far_off_forgets_nobody);
  tcase_add_test(tests, after_a_long_silence_of_a_live_camera_it_begins_anew);
  tcase_add_test(tests, the_mark_of_a_repeated_picture_stays);
  tcase_add_test(tests, after_a_flush_and_with_other_caps_it_begins_anew);
  return suite;
}

}  // namespace

GST_CHECK_MAIN(personverify)
