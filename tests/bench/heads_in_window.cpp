// SPDX-License-Identifier: LGPL-2.1-or-later
// Do heads that report no position keep a person in the picture? A window over vtest.avi shows what an emulated camera
// does, in real time: pantiltsink drives it through cerberus-head, and nothing tells the pipeline where it really looks.
// The share of frames with the person inside is compared with what `simulated` reaches in step with the frames. Beside
// it: how far the poses that the head publishes are off at the time of the frames.
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
#include "support/data.h"
#include "support/visca_camera.h"

using namespace cerberus;
using namespace cerberus::bench;
using tests::ViscaCamera;
using tests::ViscaFaults;

namespace {

constexpr double kShare = 0.9;       // of what `simulated` reaches
constexpr double kPoseError = 1.5;   // degrees, median over the frames
constexpr int kPersons[] = {9, 14};  // of the ground truth

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

double share(const Run& run) {
  return static_cast<double>(run.middle) / std::max(run.annotated, 1);
}

}  // namespace

// An argument is the number of frames after which to end.
int main(int argc, char** argv) {
  gst_init(&argc, &argv);
  const auto data = tests::data_folder();
  const auto source = tests::vtest_source();
  if (!data || !source) {
    std::printf("skipped: %s\n", data ? tests::kNoVtest : tests::kNoData);
    return 77;
  }
  const People truth = read_people(*data / "pets09_s2l1_view1" / "gt_interpolated.txt");
  struct Case {
    const char* name;
    ViscaFaults faults;
    std::string options;
  };
  using std::chrono::milliseconds;
  const Case cases[] = {
      {"visca with positions", {.dead_time = milliseconds(60)}, "latency=60000000"},
      {"visca without, 150 ms",
       {.reports = false, .dead_time = milliseconds(150)},
       "device-options=no-feedback latency=150000000"},
  };
  Asked asked;
  std::printf(
      "person  head                      chosen at  frames  inside  of simulated   pose error median, 95 "
      "%%\n");
  for (const int person : kPersons) {
    int first = -1, last = 0;
    for (const auto& [frame, people] : truth)
      for (const Person& p : people)
        if (p.id == person) {
          if (first < 0) first = frame;
          last = frame;
        }
    const int frames = std::min(last + 1, argc > 1 ? std::atoi(argv[1]) : last + 1);
    Run reference(&truth, person, first);
    const std::string end = " ! identity eos-after=" + std::to_string(frames);
    const auto ignore = [](GstSample*, int) {};
    if (!for_each_sample(line_for(*source, end, "", "driver=simulated"), ignore,
                         [&](GstElement* pipeline) { watch_head(pipeline, reference); }))
      return 1;
    std::printf("%6d  %-24s %10d %7d %7.3f\n", person, "simulated, in step", reference.chosen_at,
                reference.annotated, share(reference));
    Run live(&truth, person, first);
    if (!for_each_sample(line_for(*source, end + kPace, "", "driver=simulated"), ignore,
                         [&](GstElement* pipeline) {
                           make_live(pipeline);
                           watch_head(pipeline, live);
                         }))
      return 1;
    std::printf("%6d  %-24s %10d %7d %7.3f %13.3f\n", person, "simulated, real time", live.chosen_at,
                live.annotated, share(live), share(live) / share(reference));
    for (const Case& c : cases) {
      ViscaCamera camera(ViscaCamera::Line::udp, c.faults);
      Emulation emulation{&camera, {}, {}, {}, false};
      Run run(&truth, person, first);
      run.window = [&](int frame) { return emulation.windows.at(static_cast<std::size_t>(frame)); };
      const std::string head = "driver=visca device=" + camera.device() + " " + c.options;
      if (!for_each_sample(
              line_for(*source, end + kPace, "head=emulated", head), ignore, [&](GstElement* pipeline) {
                make_live(pipeline);
                add_probe(pipeline, "window", "sink", GST_PAD_PROBE_TYPE_BUFFER, aim, &emulation);
                add_probe(pipeline, "window", "src", GST_PAD_PROBE_TYPE_BUFFER, forget_pose, nullptr);
                add_probe(pipeline, "detect", "src", GST_PAD_PROBE_TYPE_EVENT_UPSTREAM, note_pose,
                          &emulation);
                watch_head(pipeline, run);
              }))
        return 1;
      std::ranges::sort(emulation.errors);
      const auto at = [&](double part) {
        return emulation.errors.empty() ? 0.0
                                        : emulation.errors[static_cast<std::size_t>(
                                              part * static_cast<double>(emulation.errors.size() - 1))];
      };
      const std::string what = std::string(c.name) + ", person " + std::to_string(person);
      std::printf("%6d  %-24s %10d %7d %7.3f %13.3f %14.2f %5.2f%s%s\n", person, c.name, run.chosen_at,
                  run.annotated, share(run), share(run) / share(reference), at(0.5), at(0.95),
                  asked.at_least(what, share(run) / share(reference), kShare).c_str(),
                  asked.at_most(what + ": pose error", at(0.5), kPoseError).c_str());
      std::fflush(stdout);
    }
  }
  return asked.verdict();
}
