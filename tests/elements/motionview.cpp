// SPDX-License-Identifier: LGPL-2.1-or-later
// What is shown is compared pixel by pixel with what was put in: nearest neighbour by the definition (the sample that
// covers the centre of the pixel), in floating point.
#include <algorithm>
#include <cmath>
#include <functional>

#include "records.h"

#include "outputs.h"
#include "scene.h"

using namespace outputs;

namespace {

struct Picture {
  GstVideoInfo info;
  std::vector<guint8> data;
  int width() const { return info.width; }
  int height() const { return info.height; }
  bool gray() const { return GST_VIDEO_INFO_FORMAT(&info) == GST_VIDEO_FORMAT_GRAY8; }
  // GRAY8: the level; BGRx: 0xRRGGBB.
  guint32 at(int x, int y) const {
    const guint8* p = data.data() + static_cast<std::size_t>(y) * info.stride[0] +
                      static_cast<std::size_t>(x) * (gray() ? 1 : 4);
    return gray() ? p[0] : guint32{p[2]} << 16 | guint32{p[1]} << 8 | p[0];
  }
  bool all(guint32 value) const {
    for (int y = 0; y < height(); ++y)
      for (int x = 0; x < width(); ++x)
        if (at(x, y) != value) return false;
    return true;
  }
};

Picture shown(GstHarness* h, GstBuffer* in) {
  fail_unless_equals_int(gst_harness_push(h, in), GST_FLOW_OK);
  GstBuffer* out = gst_harness_pull(h);
  Picture picture;
  GstCaps* caps = gst_pad_get_current_caps(h->sinkpad);
  fail_unless(gst_video_info_from_caps(&picture.info, caps));
  gst_caps_unref(caps);
  picture.data = bytes(out);
  fail_unless_equals_uint64(picture.data.size(), picture.info.size);
  gst_buffer_unref(out);
  return picture;
}

Harness started(const std::string& line, const std::string& caps, const char* sink_caps = nullptr) {
  Harness h = harness(line.c_str());
  if (sink_caps) gst_harness_set_sink_caps_str(h.get(), sink_caps);
  gst_harness_set_src_caps_str(h.get(), caps.c_str());
  return h;
}

enum Plane { LUMA, DIFFERENCE, PREVIOUS, MASK, LABELS };

namespace vision = cerberus::vision;
vision::Size last_frame;

GstBuffer* new_frame(const GstVideoInfo& info, int number = 0) {
  last_frame = {info.width, info.height};
  return outputs::frame(info, number);
}

template <typename T>
T& open(vision::Field<T>& field) {
  return field ? field.stored() : field.write();
}

// A picture of width x height samples in the record of the frame made last, by value(x, y).
void add_plane(GstBuffer* buffer, Plane kind, int width, int height,
               const std::function<int(int, int)>& value) {
  const vision::Record record = records::on(buffer, last_frame);
  if (kind == LABELS) {
    open(record->regions).labels = records::picture<guint16>({width, height}, value);
    return;
  }
  (kind == LUMA         ? open(record->luma)
   : kind == DIFFERENCE ? open(record->differences).current
   : kind == PREVIOUS   ? open(record->differences).previous
                        : open(record->regions).mask) = records::picture<guint8>({width, height}, value);
}

void add_histogram(GstBuffer* buffer, const std::function<int(int)>& count, int threshold = 0) {
  const vision::Record record = records::on(buffer, last_frame);
  for (int x = 0; x < 256; ++x)
    open(record->differences).histogram[static_cast<std::size_t>(x)] = static_cast<guint32>(count(x));
  if (threshold > 0) record->foreground.write().result = {threshold, threshold, 1, true};
}

int sample_at(int pixel, int pixels, int samples) {
  return static_cast<int>(std::floor((pixel + 0.5) * samples / pixels));
}

int checkers(int x, int y) {
  return (x * 7 + y * 13) % 3 ? 0 : 255;
}
int ramp(int x, int y) {
  return (x * 5 + y * 11) % 256;
}

const std::vector<std::pair<int, int>> kSizes = {{64, 48}, {33, 35}, {320, 240}, {321, 1}, {1, 1}, {640, 97}};

}  // namespace

GST_START_TEST(the_mask_is_enlarged_by_nearest_neighbour) {
  for (const auto& [width, height] : kSizes)
    for (const auto& [w, h] : {std::pair{32, 24}, {5, 3}, {64, 48}, {320, 240}, {1, 1}}) {
      const std::string caps = caps_string("I420", width, height);
      Harness harness = started("motionview stage=mask", caps);
      GstBuffer* in = new_frame(info_of(caps));
      add_plane(in, MASK, w, h, checkers);
      const Picture p = shown(harness.get(), in);
      fail_unless(p.gray());
      fail_unless_equals_int(p.width(), width);
      fail_unless_equals_int(p.height(), height);
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
          fail_unless_equals_int(p.at(x, y), checkers(sample_at(x, width, w), sample_at(y, height, h)));
    }
}
GST_END_TEST

GST_START_TEST(grey_stages_show_their_plane_in_grey_and_in_colour_pixels) {
  const std::pair<const char*, Plane> stages[] = {
      {"luma", LUMA}, {"difference", DIFFERENCE}, {"previous-difference", PREVIOUS}, {"mask", MASK}};
  const std::string caps = caps_string("NV12", 66, 50);
  for (const auto& [stage, kind] : stages)
    for (const char* out : {"video/x-raw,format=GRAY8", "video/x-raw,format=BGRx"}) {
      Harness harness = started(std::string("motionview stage=") + stage, caps, out);
      GstBuffer* in = new_frame(info_of(caps));
      for (const auto& other : stages)
        add_plane(in, other.second, 33, 25, other.second == kind ? ramp : checkers);
      const Picture p = shown(harness.get(), in);
      for (int y = 0; y < 50; ++y)
        for (int x = 0; x < 66; ++x)
          fail_unless_equals_int(p.at(x, y), guint32(ramp(x / 2, y / 2)) * (p.gray() ? 1 : 0x010101));
    }
}
GST_END_TEST

GST_START_TEST(gain_brightens_the_differences_and_stops_at_white) {
  const std::string caps = caps_string("GRAY8", 64, 4);
  Harness harness = started("motionview stage=difference gain=2.5", caps);
  GstBuffer* in = new_frame(info_of(caps));
  add_plane(in, DIFFERENCE, 64, 4, [](int x, int) { return x * 4; });
  const Picture p = shown(harness.get(), in);
  for (int x = 0; x < 64; ++x)
    fail_unless_equals_int(p.at(x, 2), std::min<long>(255, std::lround(x * 4 * 2.5)));
}
GST_END_TEST

GST_START_TEST(equal_pictures_are_equal_bytes_between_the_rows_too) {
  const std::string caps = caps_string("I420", 33, 35);  // rows of 36 bytes
  Harness harness = started("motionview stage=mask", caps);
  for (int k = 0; k < 4; ++k) {
    GstBuffer* in = new_frame(info_of(caps), k);
    add_plane(in, MASK, 33, 35, checkers);
    const Picture p = shown(harness.get(), in);
    fail_unless_equals_int(p.info.stride[0], 36);
    for (int y = 0; y < 35; ++y)
      for (int x = 33; x < 36; ++x) fail_unless_equals_int(p.data[y * 36 + x], 0);
  }
}
GST_END_TEST

GST_START_TEST(every_label_has_a_colour_and_the_background_none) {
  const std::string caps = caps_string("I420", 64, 32);
  Harness harness = started("motionview stage=labels", caps);
  GstBuffer* in = new_frame(info_of(caps));
  add_plane(in, LABELS, 8, 1, [](int x, int) { return x == 7 ? 65535 : x; });
  const Picture p = shown(harness.get(), in);
  fail_if(p.gray());
  std::vector<guint32> colors;
  for (int label = 0; label < 8; ++label) colors.push_back(p.at(label * 8 + 4, 16));
  fail_unless_equals_int(colors[0], 0);
  // As the identity of the same number has it: Okabe and Ito's orange (.902, .624, 0), their sky blue (.337, .706, .914).
  fail_unless_equals_int(colors[1], 0xe69f00);
  fail_unless_equals_int(colors[2], 0x56b4e9);
  for (int i = 1; i < 7; ++i)
    for (int j = 0; j < i; ++j) fail_if(colors[i] == colors[j]);
  fail_if(colors[7] == 0);
}
GST_END_TEST

// The threshold's upright line: the column with most pixels of its colour, in the upper half.
static int threshold_column(const Picture& p) {
  int best = -1, most = 0;
  for (int x = 0; x < p.width(); ++x) {
    int n = 0;
    for (int y = p.height() / 8; y < p.height() / 2; ++y) {
      const guint32 c = p.at(x, y);
      n += (c >> 16) > 200 && (c >> 8 & 255) < 140 && (c & 255) < 120;
    }
    if (n > most) most = n, best = x;
  }
  return best;
}

static GstBuffer* with_histogram(const GstVideoInfo& info, guint threshold) {
  GstBuffer* in = new_frame(info);
  add_histogram(in, [](int x) { return x < 60 ? 4000 / (1 + x * x) : 0; }, static_cast<int>(threshold));
  return in;
}

GST_START_TEST(the_histogram_shows_the_threshold_where_it_is) {
  const std::string caps = caps_string("I420", 640, 480);
  Harness harness = started("motionview stage=histogram", caps);
  // The axis has 64 levels: steps of the threshold are steps of equal width.
  const int a = threshold_column(shown(harness.get(), with_histogram(info_of(caps), 10)));
  const int b = threshold_column(shown(harness.get(), with_histogram(info_of(caps), 20)));
  const int c = threshold_column(shown(harness.get(), with_histogram(info_of(caps), 40)));
  fail_unless(a > 0 && b > a && c > b, "%d %d %d", a, b, c);
  fail_unless(std::abs((c - b) - 2 * (b - a)) <= 3, "%d %d %d", a, b, c);
}
GST_END_TEST

// The seeds of background and objects, blue and orange bars as the panel's dark paper shows through them: the column in
// the middle of those of a colour.
GST_START_TEST(the_histogram_shows_which_levels_are_seeds) {
  const std::string caps = caps_string("I420", 640, 480);
  Harness harness = started("motionview stage=histogram", caps);
  const Picture p = shown(harness.get(), with_histogram(info_of(caps), 20));
  const auto middle = [&p](guint32 color) {
    const auto is_near = [](guint32 a, guint32 b) { return std::abs(int(a & 255) - int(b & 255)) <= 4; };
    double sum = 0;
    int count = 0;
    for (int y = 0; y < p.height() / 2; ++y)
      for (int x = 0; x < p.width(); ++x) {
        const guint32 c = p.at(x, y);
        if (!is_near(c >> 16, color >> 16) || !is_near(c >> 8, color >> 8) || !is_near(c, color)) continue;
        sum += x, ++count;
      }
    fail_unless(count > 20, "%06x: %d pixels", color, count);
    return sum / count;
  };
  fail_unless(middle(0x3b7596) < middle(0x92680a));
}
GST_END_TEST

// The lower panel's curves, blue and orange: the row of each in a column, -1 where it is not.
static std::pair<double, double> curves_at(const Picture& p, int x) {
  double blue = 0, orange = 0;
  int blues = 0, oranges = 0;
  for (int y = p.height() * 57 / 100; y < p.height() * 94 / 100; ++y) {
    const guint32 c = p.at(x, y);
    const int r = c >> 16, b = c & 255;
    if (b > 150 && r < 130) blue += y, ++blues;
    if (r > 150 && b < 60 && (c >> 8 & 255) > 110) orange += y, ++oranges;
  }
  return {blues ? blue / blues : -1, oranges ? orange / oranges : -1};
}

// Linear, subset: what is above the threshold is nearer to the objects (Eq. 10), so the curves cross at its line. The
// curves of other options cross elsewhere.
GST_START_TEST(the_curves_are_those_of_the_options_that_were_used) {
  const std::string caps = scene::caps("GRAY8", 640, 480);
  Harness harness = started("motiondetect preset=paper weighting=linear ! motionview stage=histogram", caps);
  scene::World world;
  world.width = 640;
  world.height = 480;
  int checked = 0;
  for (int k = 0; k < 12; ++k) {
    const Picture p = shown(harness.get(), scene::grey_buffer(world, k));
    const int threshold = threshold_column(p);
    if (k < 3 || threshold < 0) continue;
    // From the left, the first column from which the object's index lies below the background's (rows count downwards).
    int crossing = -1;
    for (int x = 0; x < p.width() && crossing < 0; ++x) {
      const auto [background, object] = curves_at(p, x);
      if (background >= 0 && object >= 0 && object > background + 1) crossing = x;
    }
    const int level = p.width() / 32;  // the widest that one may be drawn
    fail_unless(std::abs(crossing - threshold) <= level, "frame %d: crossing at %d, threshold at %d", k,
                crossing, threshold);
    ++checked;
  }
  fail_unless(checked >= 6, "%d", checked);
}
GST_END_TEST

// Each of the options alone moves the curves: the options of fuzzythreshold arrive.
GST_START_TEST(each_option_of_the_threshold_moves_the_curves) {
  const char* const options[] = {"", "weighting=linear", "extremes=subset", "order=3", "clip=false"};
  std::vector<std::vector<std::pair<double, double>>> curves;
  for (const char* option : options) {
    Harness harness = started(std::string("fuzzythreshold ") + option + " ! motionview stage=histogram",
                              scene::caps("GRAY8", scene::kWidth, scene::kHeight));
    Picture p;
    for (int k = 0; k < 8; ++k) p = shown(harness.get(), scene::grey_buffer(scene::World{}, k));
    curves.emplace_back();
    for (int x = 0; x < p.width(); ++x) curves.back().push_back(curves_at(p, x));
  }
  // By columns with both curves in both pictures, away from the
  // upright lines, which hide them: more than a line's width.
  for (std::size_t i = 1; i < curves.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      double farthest = 0;
      for (std::size_t x = 0; x < curves[i].size(); ++x) {
        const auto& [a, b] = curves[i][x];
        const auto& [c, d] = curves[j][x];
        if (std::min({a, b, c, d}) < 0) continue;
        farthest = std::max({farthest, std::abs(a - c), std::abs(b - d)});
      }
      fail_unless(farthest > 4, "\"%s\" as \"%s\": %.1f", options[i], options[j], farthest);
    }
}
GST_END_TEST

GST_START_TEST(the_histogram_is_drawn_at_every_size) {
  for (const auto& [width, height] : kSizes) {
    const std::string caps = caps_string("I420", width, height);
    Harness harness = started("motionview stage=histogram", caps);
    const Picture p = shown(harness.get(), with_histogram(info_of(caps), 10));
    fail_if(p.all(0));
    GstBuffer* empty = new_frame(info_of(caps), 1);
    add_histogram(empty, [](int) { return 0; });
    shown(harness.get(), empty);
    GstBuffer* full = new_frame(info_of(caps), 2);
    add_histogram(full, [](int) { return -1; });  // 2^32 - 1 each
    shown(harness.get(), full);
  }
}
GST_END_TEST

GST_START_TEST(a_missing_plane_is_black_and_warned_of_once) {
  for (const char* stage : {"difference", "previous-difference", "mask", "labels", "histogram", "burnt-in"}) {
    const std::string caps = caps_string("I420", 64, 48);
    Harness harness = started(std::string("motionview stage=") + stage, caps);
    Bus bus(harness.get());
    for (int start = 0; start < 2; ++start) {
      for (int k = 0; k < 3; ++k) fail_unless(shown(harness.get(), new_frame(info_of(caps), k)).all(0));
      std::string text;
      fail_unless_equals_int(bus.count(GST_MESSAGE_WARNING, &text), 1);
      fail_unless(text.find(std::string("stage=") + stage) != std::string::npos, "%s", text.c_str());
      // A restart is reported again.
      gst_element_set_state(harness.get()->element, GST_STATE_READY);
      gst_element_set_state(harness.get()->element, GST_STATE_PLAYING);
      gst_harness_set_src_caps_str(harness.get(), caps.c_str());
    }
  }
}
GST_END_TEST

GST_START_TEST(each_stage_that_misses_its_plane_is_warned_of_once) {
  const std::string caps = caps_string("I420", 64, 48);
  Harness harness = started("motionview stage=mask", caps);
  GstElement* element = gst_harness_find_element(harness.get(), "motionview");
  Bus bus(harness.get());
  int number = 0;
  for (const char* stage : {"mask", "difference", "previous-difference", "mask", "difference"}) {
    gst_util_set_object_arg(G_OBJECT(element), "stage", stage);
    for (int k = 0; k < 2; ++k) fail_unless(shown(harness.get(), frame(info_of(caps), number++)).all(0));
  }
  fail_unless_equals_int(bus.count(GST_MESSAGE_WARNING), 3);
  gst_object_unref(element);
}
GST_END_TEST

// Grey of level 77 in every format: what is shown is what cameramotion would have analysed.
GST_START_TEST(a_repeated_picture_shows_the_last_mask_unless_it_is_from_before_a_break) {
  enum { NONE, FLUSH, RESTART };
  const std::string caps = caps_string("GRAY8", 32, 32);
  for (const int kind : {NONE, FLUSH, RESTART}) {
    Harness harness = started("motionview stage=mask", caps);
    GstBuffer* in = new_frame(info_of(caps));
    add_plane(in, MASK, 32, 32, [](int, int) { return 255; });
    fail_unless_equals_int(shown(harness.get(), in).at(5, 5), 255);
    if (kind == FLUSH) push_flush(harness.get());
    if (kind == RESTART) {
      gst_element_set_state(harness->element, GST_STATE_READY);
      gst_element_set_state(harness->element, GST_STATE_PLAYING);
      gst_harness_push_event(harness.get(), gst_event_new_stream_start("again"));
      gst_harness_set_src_caps_str(harness.get(), caps.c_str());
    }
    GstBuffer* again = new_frame(info_of(caps), 1);
    GST_BUFFER_FLAG_SET(again, GST_BUFFER_FLAG_GAP);
    fail_unless_equals_int(shown(harness.get(), again).at(5, 5), kind == NONE ? 255 : 0);
  }
}
GST_END_TEST

GST_START_TEST(luma_is_made_here_where_no_stage_made_it) {
  for (const char* format : kFormats) {
    const std::string caps = caps_string(format, 354, 66);
    Harness harness = started("motionview stage=luma", caps);
    GstBuffer* in = frame(info_of(caps), 0, 77);
    const Picture p = shown(harness.get(), in);
    fail_unless(p.all(77), "%s: %d", format, p.at(3, 3));
  }
}
GST_END_TEST

GST_START_TEST(a_buffer_without_a_picture_is_black_and_warned_of_once) {
  const std::string caps = caps_string("I420", 64, 48);
  Harness harness = started("motionview stage=luma", caps);
  Bus bus(harness.get());
  for (int k = 0; k < 3; ++k) fail_unless(shown(harness.get(), gst_buffer_new()).all(0));
  fail_unless_equals_int(bus.count(GST_MESSAGE_WARNING), 1);
}
GST_END_TEST

GST_START_TEST(a_request_for_planes_is_answered_yes) {
  Harness harness = started("motionview ! identity", caps_string("I420", 64, 48));
  fail_unless(cerberus::plugin::ask_for_record(harness->srcpad) == records::kRecordForReaders);
}
GST_END_TEST

GST_START_TEST(what_was_found_stays_on_the_picture_but_planes_do_not) {
  const std::string caps = caps_string("I420", 64, 48);
  Harness harness = started("motionview stage=mask", caps);
  GstBuffer* in = new_frame(info_of(caps), 5);
  add_plane(in, MASK, 32, 24, checkers);
  add(in, region(3, 10, 12, 20, 16));
  cerberus::plugin::set_threshold_facts(in, {});
  CerberusCameraMotion motion;
  cerberus_camera_motion_init(&motion);
  motion.matrix[2] = 2;
  cerberus_buffer_set_camera_motion(in, &motion);
  gst_harness_push(harness.get(), in);
  GstBuffer* out = gst_harness_pull(harness.get());
  fail_unless_equals_uint64(GST_BUFFER_PTS(out), 200 * GST_MSECOND);
  fail_unless_equals_uint64(GST_BUFFER_DURATION(out), 40 * GST_MSECOND);
  fail_if(static_cast<bool>(records::record_of(out)));
  fail_unless(records::threshold_facts_of(out));
  fail_unless(cerberus_buffer_peek_camera_motion(out)->matrix[2] == 2);
  GPtrArray* regions = cerberus_buffer_get_regions(out);
  fail_unless_equals_int(regions->len, 1);
  fail_unless(static_cast<CerberusRegion*>(g_ptr_array_index(regions, 0))->x == 10);
  g_ptr_array_unref(regions);
  gst_buffer_unref(out);
}
GST_END_TEST

GST_START_TEST(the_stage_changes_while_playing_and_the_format_with_it) {
  const std::string caps = caps_string("I420", 64, 48);
  Harness harness = started("motionview stage=mask", caps);
  GstElement* element = gst_harness_find_element(harness.get(), "motionview");
  int number = 0;
  for (const char* stage : {"mask", "labels", "difference", "histogram", "luma"}) {
    gst_util_set_object_arg(G_OBJECT(element), "stage", stage);
    for (int k = 0; k < 2; ++k) {
      GstBuffer* in = with_histogram(info_of(caps), 9);
      GST_BUFFER_PTS(in) = number++ * 40 * GST_MSECOND;
      for (const auto kind : {MASK, DIFFERENCE, LUMA})
        add_plane(in, kind, 32, 24, [&](int, int) { return 10 + kind; });
      add_plane(in, LABELS, 32, 24, [](int, int) { return 1; });
      const Picture p = shown(harness.get(), in);
      const std::string name = stage;
      fail_unless_equals_int(p.gray(), name != "labels" && name != "histogram");
      if (name == "mask") fail_unless(p.all(10 + MASK));
      if (name == "difference") fail_unless(p.all(10 + DIFFERENCE));
      if (name == "luma") fail_unless(p.all(10 + LUMA));
      fail_if(p.all(0));
    }
  }
  gst_object_unref(element);
}
GST_END_TEST

GST_START_TEST(every_format_is_taken) {
  for (const char* format : kFormats) {
    const std::string caps = caps_string(format, 33, 35);
    Harness harness = started("motionview stage=mask", caps);
    GstBuffer* in = new_frame(info_of(caps));
    add_plane(in, MASK, 33, 35, checkers);
    const Picture p = shown(harness.get(), in);
    for (int y = 0; y < 35; ++y)
      for (int x = 0; x < 33; ++x) fail_unless_equals_int(p.at(x, y), checkers(x, y));
  }
}
GST_END_TEST

GST_START_TEST(the_output_keeps_size_rate_and_pixel_aspect) {
  Harness harness = started("motionview stage=mask",
                            caps_string("I420", 64, 48, ",pixel-aspect-ratio=8/9,colorimetry=bt709"));
  GstBuffer* in = new_frame(info_of(caps_string("I420", 64, 48)));
  add_plane(in, MASK, 32, 24, checkers);
  const Picture p = shown(harness.get(), in);
  fail_unless_equals_int(p.info.par_n * 9, p.info.par_d * 8);
  fail_unless_equals_int(p.info.fps_n, 25);
  Harness still = started("motionview", "video/x-raw,format=I420,width=64,height=48,framerate=0/1");
  shown(still.get(), new_frame(info_of(caps_string("I420", 64, 48))));
}
GST_END_TEST

GST_START_TEST(interlaced_video_is_refused_naming_deinterlace) {
  std::string alternate = caps_string("I420", 64, 48, ",interlace-mode=alternate");
  alternate.insert(alternate.find(','), "(format:Interlaced)");
  for (const std::string& caps : {caps_string("I420", 64, 48, ",interlace-mode=interleaved"), alternate}) {
    Harness harness = outputs::harness("motionview");
    Bus bus(harness.get());
    gst_harness_set_src_caps_str(harness.get(), caps.c_str());
    for (int start = 0; start < 2; ++start) {
      fail_unless_equals_int(gst_harness_push(harness.get(), new_frame(info_of(caps))),
                             GST_FLOW_NOT_NEGOTIATED);
      fail_unless_equals_int(gst_harness_push(harness.get(), new_frame(info_of(caps))),
                             GST_FLOW_NOT_NEGOTIATED);
      std::string text;
      fail_unless_equals_int(bus.count(GST_MESSAGE_ERROR, &text), 1);
      fail_unless(text.find("deinterlace") != std::string::npos, "%s", text.c_str());
      // A restart is reported again.
      gst_element_set_state(harness.get()->element, GST_STATE_READY);
      gst_element_set_state(harness.get()->element, GST_STATE_PLAYING);
      gst_harness_set_src_caps_str(harness.get(), caps.c_str());
    }
  }
}
GST_END_TEST

GST_START_TEST(a_new_frame_size_a_flush_and_eos) {
  const std::string caps = caps_string("I420", 64, 48), odd = caps_string("YUY2", 33, 35);
  Harness harness = started("motionview stage=mask", caps);
  for (int k = 0; k < 6; ++k) {
    if (k == 2) push_flush(harness.get());
    if (k == 4) gst_harness_set_src_caps_str(harness.get(), odd.c_str());
    const GstVideoInfo info = info_of(k < 4 ? caps : odd);
    GstBuffer* in = new_frame(info, k);
    add_plane(in, MASK, 32, 24, [](int, int) { return 255; });
    const Picture p = shown(harness.get(), in);
    fail_unless_equals_int(p.width(), info.width);
    fail_unless(p.all(255));
  }
  fail_unless(gst_harness_push_event(harness.get(), gst_event_new_eos()));
  fail_unless(event_came(harness.get(), GST_EVENT_EOS));
}
GST_END_TEST

GST_START_TEST(upstream_may_use_any_stride_and_nothing_is_delayed) {
  const std::string text = caps_string("I420", 64, 48);
  Harness harness = started("motionview", text);
  shown(harness.get(), new_frame(info_of(text)));
  GstCaps* caps = gst_caps_from_string(text.c_str());
  GstQuery* query = gst_query_new_allocation(caps, TRUE);
  fail_unless(gst_pad_peer_query(harness->srcpad, query));
  fail_unless(gst_query_find_allocation_meta(query, GST_VIDEO_META_API_TYPE, nullptr));
  gst_query_unref(query);
  gst_caps_unref(caps);
  gst_harness_set_upstream_latency(harness.get(), 5 * GST_MSECOND);
  fail_unless_equals_uint64(gst_harness_query_latency(harness.get()), 5 * GST_MSECOND);
}
GST_END_TEST

// A box of 6 x 4 samples at (3, 2) in a picture of 32 x 24, enlarged twice: its outline is the two pixels of a sample wide.
GST_START_TEST(what_is_burnt_in_is_outlined_over_the_picture) {
  const std::string caps = caps_string("I420", 64, 48);
  Harness harness = started("motionview stage=burnt-in", caps);
  GstBuffer* in = new_frame(info_of(caps));
  add_plane(in, LUMA, 32, 24, ramp);
  vision::BurntInBoxes& found = open(records::on(in, last_frame)->foreground).burnt_in.emplace();
  found.box[found.count++] = {3, 2, 6, 4};
  const Picture p = shown(harness.get(), in);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x) {
      const int u = x / 2, v = y / 2;
      const bool inside = u >= 3 && u <= 8 && v >= 2 && v <= 5;
      const bool outline = inside && (u == 3 || u == 8 || v == 2 || v == 5);
      fail_unless_equals_int(p.at(x, y), outline ? 0xe69f00 : guint32(ramp(u, v)) * 0x010101);
    }
}
GST_END_TEST

// Learnt, and nothing found; not learnt.
GST_START_TEST(burnt_in_is_warned_of_where_it_is_not_learnt_only) {
  for (const bool learns : {true, false}) {
    Harness harness = started(
        std::string("motiondetect burnt-in=") + (learns ? "true" : "false") + " ! motionview stage=burnt-in",
        scene::caps("GRAY8", scene::kWidth, scene::kHeight));
    Bus bus(harness.get());
    for (int k = 0; k < 4; ++k)
      fail_unless_equals_int(shown(harness.get(), scene::grey_buffer(scene::World{}, k)).all(0), !learns);
    fail_unless_equals_int(bus.count(GST_MESSAGE_WARNING), learns ? 0 : 1);
  }
}
GST_END_TEST

static Suite* motionview_suite() {
  watch_library_log();
  Suite* s = suite_create("motionview");
  TCase* tc = tcase_create("pictures");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, the_mask_is_enlarged_by_nearest_neighbour);
  tcase_add_test(tc, grey_stages_show_their_plane_in_grey_and_in_colour_pixels);
  tcase_add_test(tc, gain_brightens_the_differences_and_stops_at_white);
  tcase_add_test(tc, equal_pictures_are_equal_bytes_between_the_rows_too);
  tcase_add_test(tc, every_label_has_a_colour_and_the_background_none);
  tcase_add_test(tc, the_histogram_shows_the_threshold_where_it_is);
  tcase_add_test(tc, the_histogram_shows_which_levels_are_seeds);
  tcase_add_test(tc, the_curves_are_those_of_the_options_that_were_used);
  tcase_add_test(tc, each_option_of_the_threshold_moves_the_curves);
  tcase_add_test(tc, the_histogram_is_drawn_at_every_size);
  tcase_add_test(tc, what_is_burnt_in_is_outlined_over_the_picture);
  tcase_add_test(tc, burnt_in_is_warned_of_where_it_is_not_learnt_only);
  tcase_add_test(tc, a_missing_plane_is_black_and_warned_of_once);
  tcase_add_test(tc, each_stage_that_misses_its_plane_is_warned_of_once);
  tcase_add_test(tc, a_repeated_picture_shows_the_last_mask_unless_it_is_from_before_a_break);
  tcase_add_test(tc, luma_is_made_here_where_no_stage_made_it);
  tcase_add_test(tc, a_buffer_without_a_picture_is_black_and_warned_of_once);
  tc = tcase_create("stream");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, a_request_for_planes_is_answered_yes);
  tcase_add_test(tc, what_was_found_stays_on_the_picture_but_planes_do_not);
  tcase_add_test(tc, the_stage_changes_while_playing_and_the_format_with_it);
  tcase_add_test(tc, every_format_is_taken);
  tcase_add_test(tc, the_output_keeps_size_rate_and_pixel_aspect);
  tcase_add_test(tc, interlaced_video_is_refused_naming_deinterlace);
  tcase_add_test(tc, a_new_frame_size_a_flush_and_eos);
  tcase_add_test(tc, upstream_may_use_any_stride_and_nothing_is_delayed);
  return s;
}

GST_CHECK_MAIN(motionview)
