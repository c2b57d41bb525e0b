// SPDX-License-Identifier: LGPL-2.1-or-later
#include "rtsp_server/rtsp_server.h"

#include <gst/video/video.h>

#include <algorithm>

#include "publish/streams/payloaders.h"
#include "rtsp_server/client_connection.h"
#include "rtsp_server/limited_auth.h"
#include "rtsp_server/whole_pictures.h"

namespace cerberus::rtsp {
namespace {

constexpr char kRole[] = "viewer";
constexpr guint kMostClients = 128;         // connections, with and without a session
constexpr guint kMostSessionsOfClient = 4;  // a player needs one
constexpr guint kMostSessions = 256;        // of all clients: above those that one address may have (48 * 4)
constexpr int kThreads = 8;  // for all clients: one that waits for a mount's first frame blocks its thread
constexpr guint kCleaningPeriod = 2;   // seconds after which sessions without a client are looked for
constexpr gulong kEndingPause = 5000;  // microseconds between looks whether connections have ended
constexpr int kEndingTries = 40;       // looks: .2 s, in which the caller's main loop stands

std::string source_name(std::size_t stream) {
  return "cerberus_source_" + std::to_string(stream);
}

// As gst-rtsp-server looks for it.
std::string payloader_name(std::size_t stream) {
  return "pay" + std::to_string(stream);
}

// The sources of one media: fed until the media ends.
struct Feed {
  std::string folder;
  std::vector<std::pair<std::shared_ptr<EncodedStream>, Ref<GstAppSrc>>> sources;

  ~Feed() { stop(); }
  void stop() {
    for (const auto& [stream, source] : sources) stream->remove(source.get());
  }
};

constexpr char kFeed[] = "cerberus-feed";  // of a GstRTSPMedia: its Feed

// A client that lost packets asks for a keyframe (RTCP), and rtpbin hands that on upstream.
GstPadProbeReturn on_upstream_event(GstPad*, GstPadProbeInfo* info, gpointer stream) {
  if (gst_video_event_is_force_key_unit(GST_PAD_PROBE_INFO_EVENT(info)))
    static_cast<EncodedStream*>(stream)->request_keyframe();
  return GST_PAD_PROBE_OK;
}

// What a factory makes its media of.
struct Served {
  std::string folder;
  GstClockTime base_time;                               // of the pipeline that encodes
  std::vector<std::shared_ptr<EncodedStream>> streams;  // pay0, pay1
};

// The media of a mount is made for the first client that describes it. It counts time as the pipeline does that
// encodes, so that buffers keep their stamps and the streams of a mount their distance.
void on_media_configure(GstRTSPMediaFactory*, GstRTSPMedia* media, gpointer data) {
  const auto& [folder, base_time, streams] = *static_cast<Served*>(data);
  g_autoptr(GstElement) element = gst_rtsp_media_get_element(media);
  g_autoptr(GstObject) whole = gst_object_get_parent(GST_OBJECT(element));
  gst_element_set_start_time(GST_ELEMENT(whole),
                             GST_CLOCK_TIME_NONE);  // it keeps the base time that it is given
  gst_element_set_base_time(GST_ELEMENT(whole), base_time);
  auto* feed = new Feed{folder, {}};
  for (std::size_t k = 0; k < streams.size(); ++k) {
    GstElement* source = gst_bin_get_by_name(GST_BIN(element), source_name(k).c_str());
    if (!source) continue;
    feed->sources.emplace_back(streams[k], GST_APP_SRC(source));
    g_autoptr(GstPad) pad = gst_element_get_static_pad(source, "src");
    gst_pad_add_probe(pad, GST_PAD_PROBE_TYPE_EVENT_UPSTREAM, on_upstream_event, streams[k].get(), nullptr);
    g_autoptr(GstElement) payloader = gst_bin_get_by_name(GST_BIN(element), payloader_name(k).c_str());
    send_whole_pictures(payloader);
    streams[k]->add(GST_APP_SRC(source));
  }
  g_object_set_data_full(G_OBJECT(media), kFeed, feed,
                         [](gpointer gone) { delete static_cast<Feed*>(gone); });
  g_signal_connect(media, "unprepared",
                   G_CALLBACK(+[](GstRTSPMedia*, gpointer ended) { static_cast<Feed*>(ended)->stop(); }),
                   feed);
}

void on_play(GstRTSPClient*, GstRTSPContext* context, gpointer) {
  if (!context->media) return;
  if (const auto* feed = static_cast<Feed*>(g_object_get_data(G_OBJECT(context->media), kFeed)))
    for (const auto& [stream, source] : feed->sources) stream->play(source.get());
}

// Filters that find the clients of a folder: those that have set up media of it.
GstRTSPFilterResult find_media(GstRTSPSession*, GstRTSPSessionMedia* of_session, gpointer folder) {
  GstRTSPMedia* media = gst_rtsp_session_media_get_media(of_session);
  const auto* feed = static_cast<Feed*>(g_object_get_data(G_OBJECT(media), kFeed));
  const bool same = feed && feed->folder == *static_cast<const std::string*>(folder);
  return same ? GST_RTSP_FILTER_REF : GST_RTSP_FILTER_KEEP;
}

GstRTSPFilterResult find_session(GstRTSPClient*, GstRTSPSession* session, gpointer folder) {
  GList* found = gst_rtsp_session_filter(session, find_media, folder);
  const bool any = found != nullptr;
  g_list_free_full(found, g_object_unref);
  return any ? GST_RTSP_FILTER_REF : GST_RTSP_FILTER_KEEP;
}

// Closes the connection of a client of the folder.
GstRTSPFilterResult end_of_folder(GstRTSPServer*, GstRTSPClient* client, gpointer folder) {
  GList* found = gst_rtsp_client_session_filter(client, find_session, folder);
  if (found) shut_down(client);
  g_list_free_full(found, g_object_unref);
  return GST_RTSP_FILTER_KEEP;
}

// Refuses a request that would begin one session too many of its connection.
GstRTSPStatusCode on_setup(GstRTSPClient* client, GstRTSPContext* context, gpointer) {
  note_session(client);
  if (context->session) return GST_RTSP_STS_OK;
  GList* sessions = gst_rtsp_client_session_filter(client, nullptr, nullptr);
  const guint count = g_list_length(sessions);
  g_list_free_full(sessions, g_object_unref);
  return count < kMostSessionsOfClient ? GST_RTSP_STS_OK : GST_RTSP_STS_SERVICE_UNAVAILABLE;
}

constexpr char kIdleSince[] = "cerberus-idle-since";  // of a GstRTSPClient: seconds of the monotonic clock

gsize seconds_now() {
  return static_cast<gsize>(g_get_monotonic_time() / G_USEC_PER_SEC);
}

// Closes a connection that has had no session for `idle` seconds.
GstRTSPFilterResult end_of_idle(GstRTSPServer*, GstRTSPClient* client, gpointer idle) {
  GList* sessions = gst_rtsp_client_session_filter(client, nullptr, nullptr);
  const bool is_used = sessions != nullptr;
  g_list_free_full(sessions, g_object_unref);
  const gsize since = GPOINTER_TO_SIZE(g_object_get_data(G_OBJECT(client), kIdleSince));
  if (is_used || since == 0)
    g_object_set_data(G_OBJECT(client), kIdleSince, GSIZE_TO_POINTER(seconds_now()));
  else if (seconds_now() - since > *static_cast<const gsize*>(idle))
    shut_down(client);
  return GST_RTSP_FILTER_KEEP;
}

}  // namespace

RtspServer::RtspServer(ServerSettings settings)
    : settings_(std::move(settings)), server_(gst_rtsp_server_new()) {}

RtspServer::~RtspServer() {
  if (cleaner_) g_source_remove(cleaner_);
  if (listener_) {
    g_source_destroy(listener_);
    g_source_unref(listener_);
  }
  g_signal_handlers_disconnect_by_data(server_.get(), this);
  const auto end = [](GstRTSPServer*, GstRTSPClient* client, gpointer) {
    shut_down(client);
    return GST_RTSP_FILTER_REF;
  };
  // A client that is still there after that keeps the server's object, and is torn down by its thread later.
  for (int k = 0; k < kEndingTries; ++k) {
    GList* left = gst_rtsp_server_client_filter(server_.get(), end, nullptr);
    const bool any = left != nullptr;
    g_list_free_full(left, g_object_unref);
    if (!any) break;
    g_usleep(kEndingPause);
  }
  g_clear_object(&certificate_);
}

// Before the client has a thread.
void RtspServer::accept(GstRTSPClient* client) {
  note_connection(client);
  GList* all = gst_rtsp_server_client_filter(server_.get(), nullptr, nullptr);
  guint others = 0, of_address = 0;
  for (GList* one = all; one; one = one->next) {
    if (one->data == client) continue;
    ++others;
    of_address += g_strcmp0(address_of(GST_RTSP_CLIENT(one->data)), address_of(client)) == 0;
  }
  g_list_free_full(all, g_object_unref);
  if (others >= kMostClients || of_address >= settings_.most_of_address) {
    shut_down(client);
    return;
  }
  g_object_set_data(G_OBJECT(client), kIdleSince, GSIZE_TO_POINTER(seconds_now()));
  g_signal_connect(client, "pre-setup-request", G_CALLBACK(on_setup), nullptr);
  g_signal_connect(client, "play-request", G_CALLBACK(on_play), nullptr);
}

// Ends the sessions that are not kept alive, and the connections that have none.
void RtspServer::clean() {
  g_autoptr(GstRTSPSessionPool) pool = gst_rtsp_server_get_session_pool(server_.get());
  gst_rtsp_session_pool_cleanup(pool);
  gsize idle = static_cast<gsize>(settings_.idle.count());
  gst_rtsp_server_client_filter(server_.get(), end_of_idle, &idle);
}

std::string RtspServer::prepare() {
  if (!settings_.certificate.empty()) {
    const std::string& key = settings_.key.empty() ? settings_.certificate : settings_.key;
    g_autoptr(GError) error = nullptr;
    if (!g_tls_backend_supports_tls(g_tls_backend_get_default()))
      return "TLS needs the package glib-networking, which is not installed";
    certificate_ = g_tls_certificate_new_from_files(settings_.certificate.c_str(), key.c_str(), &error);
    if (!certificate_) {
      const bool same = settings_.key.empty();
      return "the certificate " + settings_.certificate + (same ? "" : " with the key " + key) +
             " cannot be used: " + error->message + (same ? " (--key names another file)" : "");
    }
  }
  return {};
}

// The text of the media of one mount. `kinds` says what the streams are. Returns what is wrong, or nothing.
std::string RtspServer::make_line(const std::vector<std::shared_ptr<EncodedStream>>& streams,
                                  std::string& line, std::string& kinds) {
  for (std::size_t k = 0; k < streams.size(); ++k) {
    g_autoptr(GstCaps) caps = streams[k]->caps();
    if (!caps) return "the stream " + streams[k]->name() + " has not begun";
    const std::string kind = gst_structure_get_name(gst_caps_get_structure(caps, 0));
    const std::string payloader(publish::payloader_of(kind));
    if (payloader.empty())
      return "the stream " + streams[k]->name() + " is " + kind +
             ", which is not sent over RTSP: encode it as H.264, H.265, VP8, VP9 or JPEG";
    const std::string element = payloader.substr(0, payloader.find(' '));
    g_autoptr(GstElementFactory) found = gst_element_factory_find(element.c_str());
    if (!found) return "the element " + element + " is missing, which sends " + kind;
    // The queues of the sources are limited by EncodedStream.
    line += "appsrc name=" + source_name(k) + " is-live=true format=time max-bytes=0 ! " + payloader +
            " name=" + payloader_name(k) + " pt=" + std::to_string(96 + k) + " ";
    kinds += (kinds.empty() ? "" : " + ") + kind;
  }
  return {};
}

std::string RtspServer::add(const std::string& folder, const PipelineStreams& streams) {
  g_autoptr(GstRTSPMountPoints) mounts = gst_rtsp_server_get_mount_points(server_.get());
  for (const auto& stream : streams.streams()) {
    std::vector<std::shared_ptr<EncodedStream>> together = {stream};
    if (streams.metadata()) together.push_back(streams.metadata());
    std::string line, kinds;
    if (std::string wrong = make_line(together, line, kinds); !wrong.empty()) {
      remove(folder);
      return wrong;
    }
    GstRTSPMediaFactory* factory = gst_rtsp_media_factory_new();
    gst_rtsp_media_factory_set_launch(factory, ("( " + line + ")").c_str());
    gst_rtsp_media_factory_set_shared(factory, TRUE);
    // Only what goes through the connection itself is encrypted by TLS. Multicast is never offered.
    const int udp = settings_.certificate.empty() ? GST_RTSP_LOWER_TRANS_UDP : 0;
    gst_rtsp_media_factory_set_protocols(factory,
                                         static_cast<GstRTSPLowerTrans>(udp | GST_RTSP_LOWER_TRANS_TCP));
    g_autoptr(GstClock) clock = gst_system_clock_obtain();
    gst_rtsp_media_factory_set_clock(factory, clock);
    gst_rtsp_media_factory_add_role(factory, kRole, GST_RTSP_PERM_MEDIA_FACTORY_ACCESS, G_TYPE_BOOLEAN, TRUE,
                                    GST_RTSP_PERM_MEDIA_FACTORY_CONSTRUCT, G_TYPE_BOOLEAN, TRUE, nullptr);
    auto* served = new Served{folder, streams.base_time(), std::move(together)};
    g_object_set_data_full(G_OBJECT(factory), "cerberus-served", served,
                           [](gpointer gone) { delete static_cast<Served*>(gone); });
    g_signal_connect(factory, "media-configure", G_CALLBACK(on_media_configure), served);
    const std::string path = (folder.empty() ? "/" : "/" + folder + "/") + stream->name();
    gst_rtsp_mount_points_add_factory(mounts, path.c_str(), factory);
    mounts_.push_back({folder, path, kinds});
  }
  return {};
}

void RtspServer::remove(const std::string& folder) {
  g_autoptr(GstRTSPMountPoints) points = gst_rtsp_server_get_mount_points(server_.get());
  for (const Mount& mount : mounts_)
    if (mount.folder == folder) gst_rtsp_mount_points_remove_factory(points, mount.path.c_str());
  std::erase_if(mounts_, [&](const Mount& mount) { return mount.folder == folder; });
  g_list_free_full(
      gst_rtsp_server_client_filter(server_.get(), end_of_folder, const_cast<std::string*>(&folder)),
      g_object_unref);
}

// With users each request that names a mount needs one, by HTTP digest; without, only the connection may be protected.
void RtspServer::protect() {
  if (settings_.users.empty() && !certificate_) return;
  g_autoptr(GstRTSPAuth) auth = limited_auth_new();
  g_autoptr(GstRTSPToken) token =
      gst_rtsp_token_new(GST_RTSP_TOKEN_MEDIA_FACTORY_ROLE, G_TYPE_STRING, kRole, nullptr);
  if (certificate_) gst_rtsp_auth_set_tls_certificate(auth, certificate_);
  if (settings_.users.empty()) gst_rtsp_auth_set_default_token(auth, token);
  gst_rtsp_auth_set_supported_methods(auth, GST_RTSP_AUTH_DIGEST);
  gst_rtsp_auth_set_realm(auth, "cerberus");
  for (const publish::User& user : settings_.users)
    gst_rtsp_auth_add_digest(auth, user.name.c_str(), user.password.c_str(), token);
  gst_rtsp_server_set_auth(server_.get(), auth);
}

std::string RtspServer::listen() {
  gst_rtsp_server_set_address(server_.get(), settings_.address.c_str());
  gst_rtsp_server_set_service(server_.get(), std::to_string(settings_.port).c_str());
  protect();
  g_autoptr(GstRTSPThreadPool) threads = gst_rtsp_server_get_thread_pool(server_.get());
  gst_rtsp_thread_pool_set_max_threads(threads, kThreads);
  g_signal_connect(server_.get(), "client-connected",
                   G_CALLBACK(+[](GstRTSPServer*, GstRTSPClient* client, gpointer server) {
                     static_cast<RtspServer*>(server)->accept(client);
                   }),
                   this);

  g_autoptr(GError) error = nullptr;
  listener_ = gst_rtsp_server_create_source(server_.get(), nullptr, &error);
  if (!listener_) {
    const std::string where = "port " + std::to_string(settings_.port) + " of " + settings_.address;
    if (g_error_matches(error, G_IO_ERROR, G_IO_ERROR_ADDRESS_IN_USE))
      return where + " is in use: end the program that has it, or take another port";
    return where + " cannot be opened: " + error->message;
  }
  g_source_attach(listener_, nullptr);

  g_autoptr(GstRTSPSessionPool) sessions = gst_rtsp_server_get_session_pool(server_.get());
  gst_rtsp_session_pool_set_max_sessions(sessions, kMostSessions);
  const auto clean = +[](gpointer server) -> gboolean {
    static_cast<RtspServer*>(server)->clean();
    return G_SOURCE_CONTINUE;
  };
  cleaner_ = g_timeout_add_seconds(kCleaningPeriod, clean, this);
  return {};
}

int RtspServer::port() const {
  return gst_rtsp_server_get_bound_port(server_.get());
}

std::vector<std::string> RtspServer::mounts() const {
  std::vector<std::string> addresses;
  const bool six = settings_.address.find(':') != std::string::npos;
  const std::string host = six ? "[" + settings_.address + "]" : settings_.address;
  for (const Mount& mount : mounts_)
    addresses.push_back((certificate_ ? "rtsps://" : "rtsp://") + host + ":" + std::to_string(port()) +
                        mount.path + "  " + mount.kinds);
  return addresses;
}

}  // namespace cerberus::rtsp
