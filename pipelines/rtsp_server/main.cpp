// SPDX-License-Identifier: LGPL-2.1-or-later
// cerberus-rtsp: runs a line as gst-launch-1.0 would, and serves what ends in an appsink over RTSP.
//
//   cerberus-rtsp [OPTION ...] LINE          --help lists the options; pipelines/rtsp gives the line of rtsp.launch
#include <glib-unix.h>

#include <cstdio>

#include "rtsp_server/rtsp_server.h"
#include "rtsp_server/user_sources.h"

namespace cerberus::rtsp {
namespace {

constexpr guint kPeriod = 50;      // milliseconds between two looks at streams that have not begun
constexpr int kPatience = 10'000;  // milliseconds after which what has not begun is reported

// While the main loop runs.
struct Run {
  GstElement* pipeline;
  RtspServer& server;
  PipelineStreams& streams;
  GMainLoop* loop;
  int waited = 0;  // milliseconds
  bool interrupted = false;
  std::string error;

  void end(std::string wrong) {
    if (error.empty()) error = std::move(wrong);
    g_main_loop_quit(loop);
  }
};

gboolean on_begin(gpointer data) {
  Run& run = *static_cast<Run*>(data);
  run.waited += kPeriod;
  if (!run.streams.has_begun()) {
    if (run.waited == kPatience)
      std::fprintf(stderr, "rtsp: waiting for the first picture of: %s\n", run.streams.missing().c_str());
    return G_SOURCE_CONTINUE;
  }
  std::string wrong = run.server.add({}, run.streams);
  if (wrong.empty()) wrong = run.server.listen();
  if (!wrong.empty()) {
    run.end(std::move(wrong));
    return G_SOURCE_REMOVE;
  }
  for (const std::string& mount : run.server.mounts()) std::printf("%s\n", mount.c_str());
  std::fflush(stdout);
  return G_SOURCE_REMOVE;
}

gboolean on_message(GstBus*, GstMessage* message, gpointer data) {
  Run& run = *static_cast<Run*>(data);
  g_autoptr(GError) error = nullptr;
  g_autofree gchar* debug = nullptr;
  if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_EOS) {
    run.streams.end();
    run.end("");
  } else if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_WARNING) {
    gst_message_parse_warning(message, &error, &debug);
    std::fprintf(stderr, "rtsp: warning of %s: %s\n", GST_OBJECT_NAME(GST_MESSAGE_SRC(message)),
                 error->message);
  } else if (GST_MESSAGE_TYPE(message) == GST_MESSAGE_ERROR) {
    gst_message_parse_error(message, &error, &debug);
    run.end(std::string(GST_OBJECT_NAME(GST_MESSAGE_SRC(message))) + ": " + error->message +
            (debug && g_getenv("GST_DEBUG") ? std::string("\n") + debug : ""));
  }
  return G_SOURCE_CONTINUE;
}

// The first time, a recorder in the line completes its file.
gboolean on_interrupt(gpointer data) {
  Run& run = *static_cast<Run*>(data);
  if (run.interrupted) run.end("interrupted");
  run.interrupted = true;
  gst_element_send_event(run.pipeline, gst_event_new_eos());
  return G_SOURCE_CONTINUE;
}

int serve(GstElement* pipeline, const ServerSettings& settings) {
  RtspServer server(settings);
  PipelineStreams streams;
  Run run{pipeline, server, streams, g_main_loop_new(nullptr, FALSE), 0, false, server.prepare()};
  if (run.error.empty()) run.error = streams.collect(pipeline);
  if (run.error.empty()) {
    g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
    gst_bus_add_watch(bus, on_message, &run);
    g_unix_signal_add(SIGINT, on_interrupt, &run);
    g_unix_signal_add(SIGTERM, on_interrupt, &run);
    g_timeout_add(kPeriod, on_begin, &run);
    gst_element_set_state(pipeline, GST_STATE_PLAYING);
    g_main_loop_run(run.loop);
    gst_bus_remove_watch(bus);
    gst_element_set_state(pipeline, GST_STATE_NULL);
  }
  g_main_loop_unref(run.loop);
  if (run.error.empty()) return 0;
  std::fprintf(stderr, "rtsp: %s\n", run.error.c_str());
  return 1;
}

int wrong(const std::string& text) {
  std::fprintf(stderr, "rtsp: %s\n", text.c_str());
  return 2;
}

}  // namespace
}  // namespace cerberus::rtsp

int main(int argc, char** argv) {
  using namespace cerberus::rtsp;
  ServerSettings settings;
  cerberus::SecretSource users;
  g_autofree gchar *address = nullptr, *file = nullptr, *environment = nullptr, *credential = nullptr,
                   *certificate = nullptr, *key = nullptr;
  gboolean anyone = FALSE, version = FALSE;
  const GOptionEntry entries[] = {
      {"address", 0, 0, G_OPTION_ARG_STRING, &address, "Address to listen at (127.0.0.1: this machine only)",
       "IP"},
      {"port", 0, 0, G_OPTION_ARG_INT, &settings.port, "Port (8554); 0: any free one", "N"},
      {"users", 0, 0, G_OPTION_ARG_FILENAME, &file, "File of the users, a line NAME:PASSWORD each", "FILE"},
      {"users-env", 0, 0, G_OPTION_ARG_STRING, &environment, "Environment variable with such lines", "NAME"},
      {"users-credential", 0, 0, G_OPTION_ARG_STRING, &credential, "Credential of systemd with such lines",
       "NAME"},
      {"certificate", 0, 0, G_OPTION_ARG_FILENAME, &certificate, "Certificate (PEM): everything is encrypted",
       "FILE"},
      {"key", 0, 0, G_OPTION_ARG_FILENAME, &key, "Its private key (PEM), if that is another file", "FILE"},
      {"anyone", 0, 0, G_OPTION_ARG_NONE, &anyone,
       "Serve a network without users: whoever is in it may watch", nullptr},
      {"version", 0, 0, G_OPTION_ARG_NONE, &version, "Print the version", nullptr},
      {}};
  g_autoptr(GOptionContext) context =
      g_option_context_new("LINE - serves each appsink of a pipeline over RTSP");
  g_option_context_set_strict_posix(context, TRUE);
  g_option_context_add_main_entries(context, entries, nullptr);
  g_option_context_add_group(context, gst_init_get_option_group());
  g_autoptr(GError) error = nullptr;
  if (!g_option_context_parse(context, &argc, &argv, &error)) return wrong(error->message);
  if (version) {
    std::printf("cerberus-rtsp %s\n", CERBERUS_VERSION);
    return 0;
  }

  const auto text = [](const gchar* given) { return given ? std::string(given) : std::string(); };
  if (address) settings.address = address;
  settings.certificate = text(certificate);
  settings.key = text(key);
  if (std::string bad = read_users({text(file), text(environment), text(credential)}, settings.users);
      !bad.empty())
    return wrong(bad);
  if (settings.port < 0 || settings.port > 65535) return wrong("--port is 0 to 65535");
  g_autoptr(GInetAddress) listen = g_inet_address_new_from_string(settings.address.c_str());
  if (!listen)
    return wrong("--address " + settings.address + " is no IP address (0.0.0.0: all of this machine)");
  if (!g_inet_address_get_is_loopback(listen) && settings.users.empty() && !anyone)
    return wrong("at " + settings.address + " the whole network could watch: give --users FILE, or --anyone");
  if (settings.certificate.empty() && !settings.key.empty()) return wrong("--key needs --certificate");

  int words = argc - 1;
  char** line = argv + 1;
  if (words > 0 && g_str_equal(line[0], "--")) --words, ++line;
  if (words < 1) return wrong("which line? (pipelines/rtsp gives that of rtsp.launch)");
  g_autoptr(GstElement) pipeline = gst_parse_launchv(const_cast<const gchar**>(line), &error);
  if (error)
    return wrong(std::string("a part of GStreamer is missing, or the line is wrong: ") + error->message);
  if (!GST_IS_PIPELINE(pipeline))
    return wrong("the line is one element only: it needs a source and an appsink");
  return serve(pipeline, settings);
}
