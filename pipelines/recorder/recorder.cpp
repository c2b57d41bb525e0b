// SPDX-License-Identifier: LGPL-2.1-or-later
// A recorder in one file, to begin an own one with: records the encoded video of a camera or a file as it came, around
// what moves in it, and prints what it records and whom it follows.
//
//   recorder rtsp://192.168.1.64/main /var/lib/recordings
//   recorder file:///home/me/yard.mp4 .
//
// SIGUSR1 begins an event, SIGUSR2 ends it. Ctrl-C ends the program: open files are completed first.
//   g++ -std=c++20 recorder.cpp -o recorder $(pkg-config --cflags --libs cerberus-1.0)
#include <cerberus/cerberus.h>
#include <glib-unix.h>

#include <csignal>
#include <cstdio>
#include <string>

namespace {

// Encoded video goes to the recorder; a decoded branch is analysed. Queues without limits: the recorder, not a full
// queue, decides what is kept.
constexpr char kPipeline[] =
    "urisourcebin name=source ! parsebin ! video/x-h264 ! tee name=encoded "
    "eventrecorder name=recorder "
    "encoded. ! queue max-size-buffers=0 max-size-bytes=0 max-size-time=0 ! h264parse ! recorder.video "
    "encoded. ! queue max-size-buffers=0 max-size-bytes=0 max-size-time=0 ! avdec_h264 ! videoconvert ! "
    "motiondetect ! recorder.analysis";

struct Program {
  const char* uri = nullptr;
  GMainLoop* loop = nullptr;
  GstElement* pipeline = nullptr;
  GstElement* recorder = nullptr;
  int status = 0;
};

void print_recording(const GstStructure* facts) {
  const char* location = gst_structure_get_string(facts, "location");
  const char* reason = gst_structure_get_string(facts, "reason");
  std::printf("%s %s (%s)", gst_structure_get_string(facts, "state"), location ? location : "-",
              reason ? reason : "-");
  guint64 duration = 0, size = 0;
  if (gst_structure_get(facts, "duration", G_TYPE_UINT64, &duration, "size", G_TYPE_UINT64, &size, nullptr))
    std::printf(" %.1f s, %" G_GUINT64_FORMAT " bytes", static_cast<double>(duration) / GST_SECOND, size);
  std::printf("\n");
  std::fflush(stdout);
}

// Messages of detection: each track that appears and leaves.
void print_track(GstMessage* message) {
  g_autoptr(CerberusTrack) track = cerberus_message_parse_track(message);
  if (!track || track->state == CERBERUS_TRACK_UPDATED) return;
  std::printf("track %u %s at %.0f, %.0f\n", track->region.id,
              track->state == CERBERUS_TRACK_LEFT ? "left" : "appeared", track->region.x, track->region.y);
}

gboolean on_message(GstBus*, GstMessage* message, gpointer data) {
  auto& program = *static_cast<Program*>(data);
  g_autoptr(GError) error = nullptr;
  switch (GST_MESSAGE_TYPE(message)) {
    case GST_MESSAGE_ELEMENT:
      if (gst_message_has_name(message, "cerberus-recording"))
        print_recording(gst_message_get_structure(message));
      else
        print_track(message);
      break;
    case GST_MESSAGE_WARNING:
      gst_message_parse_warning(message, &error, nullptr);
      std::fprintf(stderr, "%s\n", error->message);
      break;
    case GST_MESSAGE_ERROR:
      gst_message_parse_error(message, &error, nullptr);
      std::fprintf(stderr, "%s: %s\n", program.uri, error->message);
      program.status = 1;
      [[fallthrough]];
    case GST_MESSAGE_EOS:
      g_main_loop_quit(program.loop);
      break;
    default:
      break;
  }
  return G_SOURCE_CONTINUE;
}

// EOS passes through the pipeline, so that the recorder completes its files; its message ends the loop.
gboolean on_interrupt(gpointer data) {
  gst_element_send_event(static_cast<Program*>(data)->pipeline, gst_event_new_eos());
  return G_SOURCE_CONTINUE;
}

gboolean on_start(gpointer data) {
  g_signal_emit_by_name(static_cast<Program*>(data)->recorder, "start-event", "manual");
  return G_SOURCE_CONTINUE;
}

gboolean on_stop(gpointer data) {
  g_signal_emit_by_name(static_cast<Program*>(data)->recorder, "stop-event");
  return G_SOURCE_CONTINUE;
}

}  // namespace

int main(int argc, char** argv) {
  gst_init(&argc, &argv);
  if (argc != 3) {
    std::fprintf(stderr, "usage: %s URI FOLDER\n", argv[0]);
    return 2;
  }
  Program program;
  program.uri = argv[1];
  g_autoptr(GError) error = nullptr;
  program.pipeline = gst_parse_launch(kPipeline, &error);
  if (error) {  // an element is missing: its name is in the message
    std::fprintf(stderr, "%s\n", error->message);
    gst_clear_object(&program.pipeline);
    return 1;
  }
  program.recorder = gst_bin_get_by_name(GST_BIN(program.pipeline), "recorder");
  g_autoptr(GstElement) source = gst_bin_get_by_name(GST_BIN(program.pipeline), "source");
  g_object_set(source, "uri", program.uri, nullptr);
  g_object_set(program.recorder, "location", argv[2], "pre-roll", guint64{3 * GST_SECOND}, "post-roll",
               guint64{3 * GST_SECOND}, nullptr);

  program.loop = g_main_loop_new(nullptr, FALSE);
  g_autoptr(GstBus) bus = gst_element_get_bus(program.pipeline);
  gst_bus_add_watch(bus, on_message, &program);
  g_unix_signal_add(SIGINT, on_interrupt, &program);
  g_unix_signal_add(SIGTERM, on_interrupt, &program);
  g_unix_signal_add(SIGUSR1, on_start, &program);
  g_unix_signal_add(SIGUSR2, on_stop, &program);

  gst_element_set_state(program.pipeline, GST_STATE_PLAYING);  // a failure is an error message on the bus
  g_main_loop_run(program.loop);
  gst_element_set_state(program.pipeline, GST_STATE_NULL);

  gst_bus_remove_watch(bus);
  gst_object_unref(program.recorder);
  gst_object_unref(program.pipeline);
  g_main_loop_unref(program.loop);
  return program.status;
}
