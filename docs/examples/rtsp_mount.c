/* SPDX-License-Identifier: LGPL-2.1-or-later
 * Annotated pictures and ONVIF metadata as a mount of your own gst-rtsp-server.
 *
 *   cc rtsp_mount.c $(pkg-config --cflags --libs gstreamer-rtsp-server-1.0 gstreamer-video-1.0) -o rtsp_mount
 *   GST_PLUGIN_PATH=... ./rtsp_mount [PORT [SOURCE]]      rtsp://127.0.0.1:8554/annotated
 *
 * The mount is shared: the camera is opened, and its picture analysed and encoded, once for all clients, while there is
 * one. SOURCE is the beginning of a launch line (v4l2src).
 */
#include <gst/rtsp-server/rtsp-server.h>
#include <gst/video/video.h>

#include <stdio.h>
#include <stdlib.h>

/* What follows the source. pay0 is the first stream, pay1 the second. Both queues are needed: the encoder and the
 * metadata each have a thread. */
#define ANNOTATED                                                              \
  "videoconvert ! motiondetect ! tee name=t "                                  \
  "t. ! queue ! motionoverlay ! videoconvertscale ! "                          \
  "video/x-raw,format=I420,width=[2,8192,2],height=[2,8192,2] ! "              \
  "x264enc tune=zerolatency key-int-max=250 ! "                                \
  "rtph264pay name=pay0 pt=96 config-interval=1 aggregate-mode=zero-latency "  \
  "t. ! queue ! onvifmeta ! rtponvifmetapay name=pay1 pt=97"

/* A client begins to play. Without a keyframe it would show nothing until the next one: 10 s at 250 frames a GOP. */
static void on_play(GstRTSPClient* client, GstRTSPContext* context, gpointer data) {
  (void)client, (void)data;
  GstElement* element = gst_rtsp_media_get_element(context->media);
  GstElement* payloader = gst_bin_get_by_name(GST_BIN(element), "pay0");
  if (payloader) {
    /* Upstream from the payloader: the first encoder on the way takes it. */
    GstPad* pad = gst_element_get_static_pad(payloader, "sink");
    gst_pad_push_event(pad, gst_video_event_new_upstream_force_key_unit(GST_CLOCK_TIME_NONE, TRUE, 0));
    gst_object_unref(pad);
    gst_object_unref(payloader);
  }
  gst_object_unref(element);
}

static void on_client(GstRTSPServer* server, GstRTSPClient* client, gpointer data) {
  (void)server;
  g_signal_connect(client, "play-request", G_CALLBACK(on_play), data);
}

int main(int argc, char** argv) {
  gst_init(&argc, &argv);
  GstRTSPServer* server = gst_rtsp_server_new();
  gst_rtsp_server_set_address(server, "127.0.0.1");
  gst_rtsp_server_set_service(server, argc > 1 ? argv[1] : "8554");
  g_signal_connect(server, "client-connected", G_CALLBACK(on_client), NULL);

  GstRTSPMediaFactory* factory = gst_rtsp_media_factory_new();
  gchar* line = g_strdup_printf("( %s ! " ANNOTATED " )", argc > 2 ? argv[2] : "v4l2src");
  gst_rtsp_media_factory_set_launch(factory, line);
  gst_rtsp_media_factory_set_shared(factory, TRUE);
  g_free(line);
  GstRTSPMountPoints* mounts = gst_rtsp_server_get_mount_points(server);
  gst_rtsp_mount_points_add_factory(mounts, "/annotated", factory);
  g_object_unref(mounts);

  if (gst_rtsp_server_attach(server, NULL) == 0) {
    fprintf(stderr, "the port cannot be opened: is it in use?\n");
    return EXIT_FAILURE;
  }
  printf("rtsp://127.0.0.1:%d/annotated\n", gst_rtsp_server_get_bound_port(server));
  fflush(stdout);
  g_main_loop_run(g_main_loop_new(NULL, FALSE));
  return EXIT_SUCCESS;
}
