// SPDX-License-Identifier: LGPL-2.1-or-later
// cerberus-annotate: what ./pipelines/demo runs once everything is built. A video file goes in, and beside
// the video with boxes comes one JSON line a frame. The line is the one of annotate.launch, with three things
// more that a launch line cannot do: progress, a summary, and a window that may be missing or be closed
// without disturbing the work.

#include <glib-unix.h>
#include <glib/gstdio.h>
#include <gst/app/app.h>
#include <gst/gst.h>
#include <gst/video/gstvideometa.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <mutex>
#include <set>
#include <string>

using namespace std::string_literals;

namespace {

// The JSON branch has no limit in its queue: x264enc holds dozens of frames before the first comes out, and a
// branch that stopped taking frames meanwhile would stall both. Lines are small, frames are not, so the queue
// stands behind motionjson. Encoders want even sizes; deinterlace and videoflip (turned phones) let other
// video through untouched.
constexpr const char* kPipeline =
    "filesrc name=file ! decodebin name=decoder ! videoconvert ! deinterlace ! videoflip "
    "video-direction=auto ! "
    "motiondetect name=detect ! tee name=t "
    "t. ! motionjson ! queue max-size-buffers=0 max-size-bytes=0 max-size-time=0 ! filesink name=json "
    "async=false "
    "t. ! queue ! motionoverlay ! videoconvert ! videoscale ! "
    "video/x-raw,format=I420,width=[2,16384,2],height=[2,16384,2] ! tee name=drawn "
    "drawn. ! queue max-size-buffers=3 ! x264enc speed-preset=veryfast pass=qual quantizer=21 ! mp4mux ! "
    "filesink name=mp4 "
    "drawn. ! queue leaky=downstream max-size-buffers=1 ! appsink name=shown async=false sync=false "
    "drop=true "
    "max-buffers=1";

constexpr int kFirstFrameSeconds = 20, kNextFrameSeconds = 60;  // how long the watchdog waits for a frame

struct Run {
  GstElement* pipeline = nullptr;
  GMainLoop* loop = nullptr;
  GstElement* window = nullptr;
  std::string file, folder, error;
  std::chrono::steady_clock::time_point started;
  bool terminal = false;
  bool interrupted = false;
  std::atomic<guint64> frames = 0;
  std::atomic<GstClockTime> position = 0;
  guint64 frames_before = 0;  // of the watchdog
  int idle = 0;               // watchdog's ticks without a new frame
  std::mutex mutex;
  std::set<gint> objects;  // distinct identities so far

  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count();
  }
};

// Runs in the streaming thread for every frame that motiondetect has looked at.
GstPadProbeReturn on_frame(GstPad*, GstPadProbeInfo* info, gpointer data) {
  auto& run = *static_cast<Run*>(data);
  GstBuffer* buffer = GST_PAD_PROBE_INFO_BUFFER(info);
  ++run.frames;
  if (GST_BUFFER_PTS_IS_VALID(buffer)) run.position = GST_BUFFER_PTS(buffer);
  static const GQuark motion = g_quark_from_static_string("motion");
  gpointer state = nullptr;
  std::lock_guard lock(run.mutex);
  while (GstMeta* meta =
             gst_buffer_iterate_meta_filtered(buffer, &state, GST_VIDEO_REGION_OF_INTEREST_META_API_TYPE)) {
    auto* region = reinterpret_cast<GstVideoRegionOfInterestMeta*>(meta);
    if (region->roi_type == motion) run.objects.insert(region->id);
  }
  return GST_PAD_PROBE_OK;
}

GstClockTime duration(Run& run) {
  GstElement* detect = gst_bin_get_by_name(GST_BIN(run.pipeline), "detect");
  GstPad* pad = gst_element_get_static_pad(detect, "sink");
  gint64 length = -1;
  if (!gst_pad_peer_query_duration(pad, GST_FORMAT_TIME, &length)) length = -1;
  gst_object_unref(pad);
  gst_object_unref(detect);
  return length > 0 ? static_cast<GstClockTime>(length) : GST_CLOCK_TIME_NONE;
}

// A terminal gets one line that moves, anything else (a log) a line every ten seconds.
gboolean show_progress(gpointer data) {
  auto& run = *static_cast<Run*>(data);
  const guint64 frames = run.frames;
  if (frames == 0) return G_SOURCE_CONTINUE;
  std::size_t objects;
  {
    std::lock_guard lock(run.mutex);
    objects = run.objects.size();
  }
  std::string percent;
  const GstClockTime length = duration(run);
  if (length != GST_CLOCK_TIME_NONE)
    percent =
        std::to_string(std::min<guint64>(100, gst_util_uint64_scale(run.position, 100, length))) + " %, ";
  std::fprintf(stderr, "%s%s%" G_GUINT64_FORMAT " frames, %.1f a second, %zu objects%s",
               run.terminal ? "\r\033[K" : "", percent.c_str(), frames, frames / run.seconds(), objects,
               run.terminal ? "" : "\n");
  return G_SOURCE_CONTINUE;
}

std::string not_a_video(const Run& run) {
  return run.file +
         " is not a video that can be read here (damaged, cut off, of an unknown kind, or without a "
         "picture): ";
}

// A damaged file can leave decodebin waiting for ever (GStreamer 1.22 may swallow a demuxer's error).
gboolean watchdog(gpointer data) {
  auto& run = *static_cast<Run*>(data);
  run.idle = run.frames == run.frames_before ? run.idle + 1 : 0;
  run.frames_before = run.frames;
  if (run.idle < (run.frames == 0 ? kFirstFrameSeconds : kNextFrameSeconds)) return G_SOURCE_CONTINUE;
  run.error = run.frames == 0 ? not_a_video(run) + "no frame came out of it"
                              : run.file + ": no frame follows frame " + std::to_string(run.frames.load());
  g_main_loop_quit(run.loop);
  return G_SOURCE_REMOVE;
}

gboolean on_interrupt(gpointer data) {
  auto& run = *static_cast<Run*>(data);
  if (run.interrupted) {  // the second time: at once, and the MP4 is not finished
    run.error = "interrupted";
    g_main_loop_quit(run.loop);
    return G_SOURCE_CONTINUE;
  }
  run.interrupted = true;
  std::fprintf(stderr, "\ndemo: stopping, and finishing the files\n");
  gst_element_send_event(run.pipeline, gst_event_new_eos());
  return G_SOURCE_CONTINUE;
}

// What went wrong, for somebody who does not know GStreamer.
std::string explain(const Run& run, GstMessage* message) {
  GError* error = nullptr;
  gchar* debug = nullptr;
  gst_message_parse_error(message, &error, &debug);
  const std::string source = GST_OBJECT_NAME(GST_MESSAGE_SRC(message));
  std::string text;
  if (g_error_matches(error, GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_NO_SPACE_LEFT)) {
    text = "no space left for " + run.folder;
  } else if (source == "json" || source == "mp4") {
    text = "cannot write to " + run.folder + ": " + error->message;
  } else if (source == "file") {
    text = "cannot read " + run.file + ": " + error->message;
  } else if (run.frames == 0) {
    text = not_a_video(run) + error->message;
  } else {
    text = run.file + ", after frame " + std::to_string(run.frames.load()) + ": " + error->message;
  }
  if (debug && g_getenv("GST_DEBUG")) text += std::string("\n") + debug;
  g_error_free(error);
  g_free(debug);
  return text;
}

gboolean on_message(GstBus*, GstMessage* message, gpointer data) {
  auto& run = *static_cast<Run*>(data);
  if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR) {
    if (run.error.empty()) run.error = explain(run, message);
    g_main_loop_quit(run.loop);
  } else if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS) {
    g_main_loop_quit(run.loop);
  }
  return G_SOURCE_CONTINUE;
}

// decodebin has found every stream. A file with sound only has nothing to link to, and would end in silence.
void on_no_more_pads(GstElement* decoder, gpointer) {
  bool linked = false;
  GstIterator* pads = gst_element_iterate_src_pads(decoder);
  GValue item = G_VALUE_INIT;
  while (gst_iterator_next(pads, &item) == GST_ITERATOR_OK) {
    linked |= gst_pad_is_linked(GST_PAD(g_value_get_object(&item)));
    g_value_reset(&item);
  }
  g_value_unset(&item);
  gst_iterator_free(pads);
  if (!linked)
    GST_ELEMENT_ERROR(decoder, STREAM, WRONG_TYPE, ("There is no picture in it, or no decoder for it."),
                      (nullptr));
}

// The window is a pipeline of its own: whatever happens to it (no display after all, closed by its user) ends
// here. The sinks are tried by hand: autovideosink also tries those for DirectFB, which can crash where there
// is none.
void open_window(Run& run) {
  const bool wayland = g_getenv("WAYLAND_DISPLAY"), x11 = g_getenv("DISPLAY");
  if (!wayland && !x11) return;
  for (const char* name : {"waylandsink", "xvimagesink", "ximagesink"}) {
    if (!(name == "waylandsink"s ? wayland : x11)) continue;
    GstElementFactory* factory = gst_element_factory_find(name);
    if (!factory) continue;
    gst_object_unref(factory);
    const std::string line =
        "appsrc name=in format=time max-buffers=2 max-bytes=0 leaky-type=downstream ! videoconvert ! "s +
        name + " sync=false";
    run.window = gst_parse_launch(line.c_str(), nullptr);
    if (!run.window) continue;
    if (gst_element_set_state(run.window, GST_STATE_READY) != GST_STATE_CHANGE_FAILURE) {
      gst_element_set_state(run.window, GST_STATE_PLAYING);
      return;
    }
    gst_element_set_state(run.window, GST_STATE_NULL);
    gst_clear_object(&run.window);
  }
  std::fprintf(stderr, "demo: no window: the display cannot be opened\n");
}

GstFlowReturn on_shown(GstAppSink* sink, gpointer data) {
  auto& run = *static_cast<Run*>(data);
  GstSample* sample = gst_app_sink_pull_sample(sink);
  if (sample && run.window) {
    GstElement* in = gst_bin_get_by_name(GST_BIN(run.window), "in");
    gst_app_src_push_sample(GST_APP_SRC(in), sample);  // what it answers is the window's own affair
    gst_object_unref(in);
  }
  if (sample) gst_sample_unref(sample);
  return GST_FLOW_OK;
}

void set_location(Run& run, const char* name, const std::string& path) {
  GstElement* element = gst_bin_get_by_name(GST_BIN(run.pipeline), name);
  g_object_set(element, "location", path.c_str(), nullptr);
  gst_object_unref(element);
}

bool build(Run& run) {
  GError* error = nullptr;
  run.pipeline = gst_parse_launch(kPipeline, &error);
  if (error) {
    run.error = std::string("a part of GStreamer is missing: ") + error->message;
    g_error_free(error);
    return false;
  }
  set_location(run, "file", run.file);
  set_location(run, "json", run.folder + "/objects.jsonl");
  set_location(run, "mp4", run.folder + "/annotated.mp4");

  GstElement* detect = gst_bin_get_by_name(GST_BIN(run.pipeline), "detect");
  GstPad* pad = gst_element_get_static_pad(detect, "src");
  gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_BUFFER, on_frame, &run, nullptr);
  gst_object_unref(pad);
  gst_object_unref(detect);

  GstElement* decoder = gst_bin_get_by_name(GST_BIN(run.pipeline), "decoder");
  g_signal_connect(decoder, "no-more-pads", G_CALLBACK(on_no_more_pads), nullptr);
  gst_object_unref(decoder);

  GstElement* shown = gst_bin_get_by_name(GST_BIN(run.pipeline), "shown");
  GstAppSinkCallbacks callbacks = {};
  callbacks.new_sample = on_shown;
  gst_app_sink_set_callbacks(GST_APP_SINK(shown), &callbacks, &run, nullptr);
  gst_object_unref(shown);
  return true;
}

// Runs to the end; false with run.error set when that was not the file's end.
bool work(Run& run) {
  if (!build(run)) return false;
  open_window(run);
  run.loop = g_main_loop_new(nullptr, FALSE);
  GstBus* bus = gst_element_get_bus(run.pipeline);
  gst_bus_add_watch(bus, on_message, &run);
  g_unix_signal_add(SIGINT, on_interrupt, &run);
  g_unix_signal_add(SIGTERM, on_interrupt, &run);
  run.terminal = isatty(STDERR_FILENO);
  g_timeout_add(run.terminal ? 200 : 10000, show_progress, &run);
  g_timeout_add_seconds(1, watchdog, &run);
  run.started = std::chrono::steady_clock::now();
  gst_element_set_state(run.pipeline, GST_STATE_PLAYING);
  g_main_loop_run(run.loop);
  gst_bus_remove_watch(bus);
  gst_object_unref(bus);
  return run.error.empty();
}

}  // namespace

int main(int argc, char** argv) {
  gchar* folder = nullptr;
  gchar** files = nullptr;
  const GOptionEntry entries[] = {
      {"output", 'o', 0, G_OPTION_ARG_FILENAME, &folder, "Folder for annotated.mp4 and objects.jsonl", "DIR"},
      {G_OPTION_REMAINING, 0, 0, G_OPTION_ARG_FILENAME_ARRAY, &files, nullptr, "FILE"},
      {}};
  GOptionContext* context = g_option_context_new("- finds the moving people in a video");
  g_option_context_add_main_entries(context, entries, nullptr);
  g_option_context_add_group(context, gst_init_get_option_group());
  GError* error = nullptr;
  if (!g_option_context_parse(context, &argc, &argv, &error) || !files || files[1]) {
    std::fprintf(stderr, "demo: %s\n", error ? error->message : "which FILE? (--help)");
    return 2;
  }
  g_option_context_free(context);

  Run run;
  run.file = files[0];
  run.folder = folder ? folder : "demo-output";
  if (g_mkdir_with_parents(run.folder.c_str(), 0777) != 0) {
    std::fprintf(stderr, "demo: cannot make the folder %s: %s\n", run.folder.c_str(), g_strerror(errno));
    return 2;
  }
  bool good = work(run);
  const double seconds = run.seconds();
  const GstClockTime length = run.pipeline ? duration(run) : GST_CLOCK_TIME_NONE;
  if (run.pipeline) gst_element_set_state(run.pipeline, GST_STATE_NULL);
  if (run.window) gst_element_set_state(run.window, GST_STATE_NULL);
  if (run.terminal && run.frames > 0) std::fprintf(stderr, "\r\033[K");
  if (good && run.frames == 0) {
    run.error = run.file + " has no frame that could be decoded";
    good = false;
  }
  if (!good) {
    std::fprintf(stderr, "demo: %s\n", run.error.c_str());
  } else {
    if (!run.interrupted && length != GST_CLOCK_TIME_NONE &&
        run.position + run.position / 10 + GST_SECOND < length)
      std::fprintf(stderr,
                   "demo: %s says it lasts %.1f s, but its frames end at %.1f s: it is cut off or damaged\n",
                   run.file.c_str(), length / 1e9, run.position / 1e9);
    std::printf("%" G_GUINT64_FORMAT
                " frames, %.1f frames per second, %zu objects seen: %s/annotated.mp4 and "
                "%s/objects.jsonl\n",
                run.frames.load(), run.frames / seconds, run.objects.size(), run.folder.c_str(),
                run.folder.c_str());
  }
  gst_clear_object(&run.pipeline);
  gst_clear_object(&run.window);
  g_strfreev(files);
  g_free(folder);
  return good ? 0 : 1;
}
