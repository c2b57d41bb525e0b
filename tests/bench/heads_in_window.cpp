// SPDX-License-Identifier: LGPL-2.1-or-later
// Do the drivers of real heads keep a person in the picture? A window over vtest.avi shows what an emulated head does,
// and nothing reports to the pipeline where it really looks, but the driver. The share of frames with the person inside
// is compared with what `simulated` reaches. Beside it: how far the poses that the head publishes are off at the time of
// the frames. All in step with the frames (stepped_loop.h); `real-time` as the first argument adds VISCA cameras that
// pantiltsink drives through cerberus-head and UDP, which needs a machine that keeps up, and some minutes.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "asked.h"
#include "boxes.h"
#include "in_window.h"
#include "stepped_loop.h"
#include "support/data.h"
#include "support/visca_camera.h"
#if HAVE_ONVIF
#include "support/onvif_plant.h"
#endif

using namespace cerberus;
using namespace cerberus::bench;
using tests::ViscaCamera;
using tests::ViscaFaults;

namespace {

constexpr double kShare = 0.9;      // of what `simulated` reaches
constexpr double kPoseError = 1.5;  // degrees, median over the frames
// Of the ground truth: who is followed, and from which frames on. One run says little: whether the tracker keeps a person
// whom a window shows from a little further left is chance, also for `simulated`. All starts count together.
struct Followed {
  int person;
  std::vector<int> from;
};
const Followed kFollowed[] = {{9, {4, 14, 24, 34, 44, 354, 364, 374, 384, 394}},
                              {14, {354, 358, 362, 366, 370, 374}}};

// What runs from several starts show together.
struct Pool {
  int middle = 0, annotated = 0, chosen = 0;
  std::vector<double> errors;  // of the published poses, degrees
  void add(const Run& run) {
    middle += run.middle;
    annotated += run.annotated;
    chosen += run.chosen != 0;
  }
  double share() const { return static_cast<double>(middle) / std::max(annotated, 1); }
};

struct Emulation {
  ViscaCamera* camera;
  std::vector<vision::Box> windows;  // of the frames
  std::vector<double> errors;        // degrees
  CerberusPose published{};
  bool any = false;
};

// A camera's stream is live: what is upstream says so.
GstPadProbeReturn answer_live(GstPad*, GstPadProbeInfo* info, gpointer) {
  GstQuery* query = GST_PAD_PROBE_INFO_QUERY(info);
  if (GST_QUERY_TYPE(query) != GST_QUERY_LATENCY) return GST_PAD_PROBE_OK;
  gst_query_set_latency(query, TRUE, 0, GST_CLOCK_TIME_NONE);
  return GST_PAD_PROBE_HANDLED;
}

// A frame enters the window: it shows what the camera sees now.
GstPadProbeReturn aim(GstPad* pad, GstPadProbeInfo* info, gpointer data) {
  Emulation& emulation = *static_cast<Emulation*>(data);
  GstBuffer* frame = GST_PAD_PROBE_INFO_BUFFER(info);
  CerberusPose pose;
  cerberus_pose_init(&pose);
  pose.head = "emulated";
  pose.pan = emulation.camera->pan();
  pose.tilt = emulation.camera->tilt();
  pose.valid_from = GST_BUFFER_PTS(frame);
  pose.valid_until = GST_CLOCK_TIME_NONE;
  emulation.windows.push_back(window_at(pose.pan / kRadian, pose.tilt / kRadian));
  if (emulation.any) {
    double pan = 0, tilt = 0;
    cerberus_pose_evaluate(&emulation.published, GST_BUFFER_PTS(frame), &pan, &tilt);
    emulation.errors.push_back(std::max(std::abs(pan - pose.pan), std::abs(tilt - pose.tilt)));
  }
  GstElement* window = GST_ELEMENT(GST_PAD_PARENT(pad));
  GstPad* out = gst_element_get_static_pad(window, "src");
  gst_pad_send_event(out, cerberus_event_new_pose(&pose));
  gst_object_unref(out);
  return GST_PAD_PROBE_OK;
}

// Behind the window: the pipeline must not know.
GstPadProbeReturn forget_pose(GstPad*, GstPadProbeInfo* info, gpointer) {
  GstBuffer* frame = gst_buffer_make_writable(GST_PAD_PROBE_INFO_BUFFER(info));
  GST_PAD_PROBE_INFO_DATA(info) = frame;
  cerberus_buffer_set_pose(frame, nullptr);
  return GST_PAD_PROBE_OK;
}

GstPadProbeReturn note_pose(GstPad*, GstPadProbeInfo* info, gpointer data) {
  Emulation& emulation = *static_cast<Emulation*>(data);
  g_autoptr(CerberusPose) pose = cerberus_event_parse_pose(GST_PAD_PROBE_INFO_EVENT(info));
  if (!pose || g_strcmp0(pose->head, "head") != 0) return GST_PAD_PROBE_OK;
  emulation.published = *pose;
  emulation.any = true;
  return GST_PAD_PROBE_OK;
}

void add_probe(GstElement* pipeline, const char* element, const char* pad_name, GstPadProbeType type,
               GstPadProbeCallback callback, gpointer data) {
  GstElement* at = gst_bin_get_by_name(GST_BIN(pipeline), element);
  GstPad* pad = gst_element_get_static_pad(at, pad_name);
  gst_pad_add_probe(pad, type, callback, data, nullptr);
  gst_object_unref(pad);
  gst_object_unref(at);
}

// In real time, from a source that is live.
constexpr char kPace[] = " ! identity sync=true name=live";
void make_live(GstElement* pipeline) {
  add_probe(pipeline, "live", "src", GST_PAD_PROBE_TYPE_QUERY_UPSTREAM, answer_live, nullptr);
}

std::string line_for(const std::string& source, const std::string& pace, const std::string& window,
                     const std::string& head) {
  return source + pace + " ! virtualptz name=window width=320 height=240 wide-fov=60 " + window +
         " ! motiondetect name=detect horizontal-fov=" + std::to_string(kFov) + " ! pirfusion " +
         window_angles() + " ! tee name=t  t. ! queue ! pantiltsink name=head " + window_angles() + " " +
         window_tilt() + " " + head + "  t. ! queue ! appsink name=out sync=false";
}

// A head in step with the frames.
struct SteppedCase {
  const char* name;
  tests::SteppedHead::MakePlant make;
  std::chrono::milliseconds latency;
};

struct SteppedRun {
  SteppedLoop loop;
  std::vector<vision::Box> windows;  // of the frames
  std::vector<double> errors;        // degrees
};

void show(GstPad* pad, double pan, double tilt, GstClockTime time) {
  CerberusPose pose;
  cerberus_pose_init(&pose);
  pose.head = "emulated";
  pose.pan = pan;
  pose.tilt = tilt;
  pose.valid_from = time;
  pose.valid_until = GST_CLOCK_TIME_NONE;
  GstPad* out = gst_element_get_static_pad(GST_ELEMENT(GST_PAD_PARENT(pad)), "src");
  gst_pad_send_event(out, cerberus_event_new_pose(&pose));
  gst_object_unref(out);
}

GstPadProbeReturn aim_stepped(GstPad* pad, GstPadProbeInfo* info, gpointer data) {
  SteppedRun& run = *static_cast<SteppedRun*>(data);
  const GstClockTime time = GST_BUFFER_PTS(GST_PAD_PROBE_INFO_BUFFER(info));
  const SteppedLoop::Look look = run.loop.look_at(plugin::time_of(time));
  run.windows.push_back(window_at(look.pan / kRadian, look.tilt / kRadian));
  if (look.error) run.errors.push_back(*look.error);
  show(pad, look.pan, look.tilt, time);
  return GST_PAD_PROBE_OK;
}

GstPadProbeReturn analysed(GstPad* pad, GstPadProbeInfo* info, gpointer data) {
  static_cast<SteppedRun*>(data)->loop.on_frame(GST_PAD_PROBE_INFO_BUFFER(info), pad);
  return GST_PAD_PROBE_OK;
}

std::vector<SteppedCase> stepped_cases() {
  using std::chrono::milliseconds;
  using Made = std::unique_ptr<tests::HeadPlant>;
  static constexpr milliseconds kSlow{150};
  return {
      {"stepper-gpio", [](auto&) -> Made { return std::make_unique<tests::StepperPlant>(); },
       milliseconds(0)},
      {"servo-pwm", [](auto&) -> Made { return std::make_unique<tests::ServoPlant>(); }, milliseconds(0)},
      {"v4l2, 100 ms",
       [](auto&) -> Made { return std::make_unique<tests::CameraPlant>(0, 0, milliseconds(100)); },
       milliseconds(75)},  // parts are sent 50 ms ahead, and reached on average after half of that
      {"pelco-d without, 150 ms", [](auto&) -> Made { return std::make_unique<tests::PelcoPlant>(kSlow); },
       kSlow},
      {"visca without, 150 ms", [](auto&) -> Made { return std::make_unique<tests::ViscaPlant>(kSlow); },
       kSlow},
#if HAVE_ONVIF
      {"onvif without, 150 ms", [](auto&) -> Made { return std::make_unique<tests::OnvifPlant>(kSlow); },
       kSlow},
#endif
  };
}

void print(const char* name, int person, const Pool& pool) {
  std::printf("%6d  %-26s %6d %7d %7.3f", person, name, pool.chosen, pool.annotated, pool.share());
}

void judge(Asked& asked, const char* name, int person, Pool& pool, const Pool& reference) {
  std::ranges::sort(pool.errors);
  const auto at = [&](double part) {
    return pool.errors.empty()
               ? 0.0
               : pool.errors[static_cast<std::size_t>(part * static_cast<double>(pool.errors.size() - 1))];
  };
  const std::string what = std::string(name) + ", person " + std::to_string(person);
  const double part = pool.share() / reference.share();
  print(name, person, pool);
  std::printf(" %13.3f %14.2f %5.2f%s%s\n", part, at(0.5), at(0.95),
              asked.at_least(what, part, kShare).c_str(),
              asked.at_most(what + ": pose error", at(0.5), kPoseError).c_str());
  std::fflush(stdout);
}

void ignore(GstSample*, int) {}

bool run_stepped(const SteppedCase& c, const std::string& source, Run run, Pool& pool) {
  SteppedRun stepped{SteppedLoop(c.make, c.latency), {}, {}};
  run.window = [&](int frame) { return stepped.windows.at(static_cast<std::size_t>(frame)); };
  run.stop = [&] { return stepped.loop.stop(); };
  run.follow = [&](guint track) { return stepped.loop.follow(track); };
  const std::string line = source +
                           " ! virtualptz name=window width=320 height=240 wide-fov=60 head=emulated"
                           " ! motiondetect name=detect horizontal-fov=" +
                           std::to_string(kFov) + " ! pirfusion " + window_angles() +
                           " ! identity name=head ! appsink name=out sync=false";
  const bool done = for_each_sample(line, ignore, [&](GstElement* pipeline) {
    add_probe(pipeline, "window", "sink", GST_PAD_PROBE_TYPE_BUFFER, aim_stepped, &stepped);
    add_probe(pipeline, "window", "src", GST_PAD_PROBE_TYPE_BUFFER, forget_pose, nullptr);
    watch_head(pipeline, run);
    add_probe(pipeline, "head", "sink", GST_PAD_PROBE_TYPE_BUFFER, analysed, &stepped);
  });
  pool.add(run);
  pool.errors.insert(pool.errors.end(), stepped.errors.begin(), stepped.errors.end());
  return done;
}

// driver=simulated, in step with the frames, or at a pace.
bool run_simulated(const std::string& source, const char* pace, Run run, Pool& pool) {
  const bool live = pace == kPace;
  const bool done =
      for_each_sample(line_for(source, pace, "", "driver=simulated"), ignore, [&](GstElement* pipeline) {
        if (live) make_live(pipeline);
        watch_head(pipeline, run);
      });
  pool.add(run);
  return done;
}

// A VISCA camera that pantiltsink drives in real time.
struct RealCase {
  const char* name;
  ViscaFaults faults;
  std::string options;
};

bool run_real(const RealCase& c, const std::string& source, Run run, Pool& pool) {
  ViscaCamera camera(ViscaCamera::Line::udp, c.faults);
  Emulation emulation{&camera, {}, {}, {}, false};
  run.window = [&](int frame) { return emulation.windows.at(static_cast<std::size_t>(frame)); };
  const std::string head = "driver=visca device=" + camera.device() + " " + c.options;
  const bool done =
      for_each_sample(line_for(source, kPace, "head=emulated", head), ignore, [&](GstElement* pipeline) {
        make_live(pipeline);
        add_probe(pipeline, "window", "sink", GST_PAD_PROBE_TYPE_BUFFER, aim, &emulation);
        add_probe(pipeline, "window", "src", GST_PAD_PROBE_TYPE_BUFFER, forget_pose, nullptr);
        add_probe(pipeline, "detect", "src", GST_PAD_PROBE_TYPE_EVENT_UPSTREAM, note_pose, &emulation);
        watch_head(pipeline, run);
      });
  pool.add(run);
  pool.errors = std::move(emulation.errors);
  return done;
}

}  // namespace

int main(int argc, char** argv) {
  gst_init(&argc, &argv);
  const bool real_time = argc > 1 && std::string(argv[1]) == "real-time";
  const auto real = tests::real_video();
  if (!real) return tests::kSkipped;
  const People truth = read_people(real->data / "pets09_s2l1_view1" / "gt_interpolated.txt");
  using std::chrono::milliseconds;
  const RealCase real_cases[] = {
      {"visca with, real time", {.dead_time = milliseconds(60)}, "latency=60000000"},
      {"visca without, real time",
       {.reports = false, .dead_time = milliseconds(150)},
       "device-options=no-feedback latency=150000000"},
  };
  Asked asked;
  std::printf(
      "person  head                       chosen  frames  inside  of simulated   pose error median, 95 %%\n");
  for (const auto& [person, starts] : kFollowed) {
    int last = 0;
    for (const auto& [frame, people] : truth)
      for (const Person& p : people)
        if (p.id == person) last = frame;
    const std::string source = real->vtest + " ! identity eos-after=" + std::to_string(last + 1);
    Pool reference;
    for (const int from : starts)
      if (!run_simulated(source, "", Run(&truth, person, from), reference)) return 1;
    print("simulated, in step", person, reference);
    std::printf("\n");
    for (const SteppedCase& c : stepped_cases()) {
      Pool pool;
      for (const int from : starts)
        if (!run_stepped(c, source, Run(&truth, person, from), pool)) return 1;
      judge(asked, c.name, person, pool, reference);
    }
    if (!real_time) continue;
    Pool first, live;
    const Run run(&truth, person, starts.front());
    if (!run_simulated(source, "", run, first) || !run_simulated(source, kPace, run, live)) return 1;
    print("simulated, real time", person, live);
    std::printf(" %13.3f\n", live.share() / first.share());
    for (const RealCase& c : real_cases) {
      Pool pool;
      if (!run_real(c, source, run, pool)) return 1;
      judge(asked, c.name, person, pool, first);
    }
  }
  return asked.verdict();
}
