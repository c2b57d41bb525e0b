// SPDX-License-Identifier: LGPL-2.1-or-later
// cerberus-demo: runs the line of closed-loop.launch or of patrol.launch as gst-launch-1.0 would, with what a line cannot
// do: the view is made to fit a video, there is progress and a summary, and a window on the screen that may be missing or
// be closed.
//
//   pipelines/run --with build/pipelines/cerberus-demo closed-loop FILE=... MP4=... JSON=...
#include <glib/gstdio.h>
#include <gst/gst.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "job.h"
#include "screen.h"
#include "video_file.h"
#include "vision/geometry/window.h"

namespace cerberus::demo {
namespace {

constexpr double kDegree = G_PI / 180;
// What virtualptz shows is as large as this at least, so that one can read what motionoverlay writes on it.
constexpr vision::Size kReadable{640, 480};
constexpr int kPatrolRate = 30;  // frames a second of patrolsimsrc, unless downstream asks for others

// The elements of the line that the demo has to do with; borrowed from the pipeline. A patrol has no file: its robot is
// camera and world.
struct Parts {
  GstElement *robot, *file, *camera, *fusion, *head, *drawn, *json, *mp4;
};

bool find_parts(GstElement* pipeline, Parts& parts) {
  const auto find = [&](const char* name) {
    g_autoptr(GstElement) found = gst_bin_get_by_name(GST_BIN(pipeline), name);
    return found;  // the pipeline holds it
  };
  parts.robot = find("robot");
  const std::array<std::pair<GstElement**, const char*>, 7> all{{{&parts.file, "file"},
                                                                 {&parts.camera, "camera"},
                                                                 {&parts.fusion, "fusion"},
                                                                 {&parts.head, "head"},
                                                                 {&parts.drawn, "drawn"},
                                                                 {&parts.json, "json"},
                                                                 {&parts.mp4, "mp4"}}};
  for (const auto& [part, name] : all) {
    *part = find(name);
    const bool of_a_file = part == &parts.file || part == &parts.camera;
    if (!*part && !(parts.robot && of_a_file)) {
      std::fprintf(stderr,
                   "demo: the line has no element called %s: it is not that of closed-loop.launch or of "
                   "patrol.launch\n",
                   name);
      return false;
    }
  }
  return true;
}

std::string location(GstElement* element) {
  g_autofree gchar* text = nullptr;
  g_object_get(element, "location", &text, nullptr);
  return text ? text : "";
}

// The line says which angles; here they meet the video's size: the view gets the video's shape, in pixels of the video
// or larger, and the head the limits at which the view ends.
void fit_view(const Parts& parts, vision::Size video) {
  double wide = 0, view = 0;
  g_object_get(parts.camera, "wide-fov", &wide, "horizontal-fov", &view, nullptr);
  const double share = std::tan(view * kDegree / 2) / std::tan(wide * kDegree / 2);
  const double grow = std::max(
      1.0, std::min(kReadable.width / (share * video.width), kReadable.height / (share * video.height)));
  const auto even = [](double pixels) { return std::max(2, 2 * static_cast<int>(std::lround(pixels / 2))); };
  const vision::Size size{even(grow * share * video.width), even(grow * share * video.height)};
  g_object_set(parts.camera, "width", size.width, "height", size.height, nullptr);

  const vision::WindowGeometry geometry(wide * kDegree, video, size, view * kDegree);
  const double pan = geometry.pan_reach() / kDegree, tilt = geometry.tilt_reach() / kDegree;
  for (GstElement* element : {parts.fusion, parts.head})
    g_object_set(element, "pan-min", -pan, "pan-max", pan, nullptr);
  g_object_set(parts.head, "tilt-min", -tilt, "tilt-max", tilt, nullptr);
}

int run(GstElement* pipeline) {
  Parts parts;
  if (!find_parts(pipeline, parts)) return 2;
  const std::string mp4 = location(parts.mp4), json = location(parts.json);
  g_autofree gchar* folder = g_path_get_dirname(mp4.c_str());
  if (g_mkdir_with_parents(folder, 0777) != 0) {
    std::fprintf(stderr, "demo: cannot make the folder %s: %s\n", folder, g_strerror(errno));
    return 2;
  }
  std::string path;
  VideoFile video;
  if (parts.robot) {
    gint frames = 0;
    g_object_get(parts.robot, "num-buffers", &frames, nullptr);
    if (frames > 0) video.duration = static_cast<guint64>(frames) * GST_SECOND / kPatrolRate;
  } else {
    path = location(parts.file);
    video = look_at(path);
    if (!video.error.empty()) {
      std::fprintf(stderr, "demo: %s\n", video.error.c_str());
      return 1;
    }
    fit_view(parts, video.size);
  }

  Job job(pipeline, path, folder, video);
  Screen screen;
  g_autoptr(GstPad) drawn = gst_element_get_static_pad(parts.drawn, "src");
  screen.show(drawn);
  const bool good = job.run();
  const double seconds = job.seconds();
  gst_element_set_state(pipeline, GST_STATE_NULL);
  if (!good) {
    std::fprintf(stderr, "demo: %s\n", job.error().c_str());
    return 1;
  }
  if (const double end = job.ends_early_at(); end > 0)
    std::fprintf(stderr,
                 "demo: %s says it lasts %.1f s, but its frames end at %.1f s: it is cut off or damaged\n",
                 path.c_str(), static_cast<double>(video.duration) / GST_SECOND, end);
  std::printf("%" G_GUINT64_FORMAT " frames, %.1f frames per second, %zu objects seen: %s and %s\n",
              job.frames(), static_cast<double>(job.frames()) / seconds, job.objects(), mp4.c_str(),
              json.c_str());
  return 0;
}

}  // namespace
}  // namespace cerberus::demo

int main(int argc, char** argv) {
  gst_init(&argc, &argv);
  if (argc < 2) {
    std::fprintf(
        stderr,
        "demo: which line? (pipelines/demo gives the one of closed-loop.launch or of patrol.launch)\n");
    return 2;
  }
  g_autoptr(GError) error = nullptr;
  g_autoptr(GstElement) pipeline = gst_parse_launchv(const_cast<const gchar**>(argv + 1), &error);
  if (error) {
    std::fprintf(stderr, "demo: a part of GStreamer is missing, or the line is wrong: %s\n", error->message);
    return 2;
  }
  return cerberus::demo::run(pipeline);
}
