// SPDX-License-Identifier: LGPL-2.1-or-later
#include "rtsp_source.h"

#include <gio/gio.h>

#include <algorithm>
#include <string_view>
#include <utility>

namespace cerberus::robot {

namespace {

constexpr guint kPatience = 5;  // seconds: longer than TCP's second try takes, which a lost packet costs
constexpr guint16 kPort = 554;  // RFC 2326

RtspProblem problem_of(const GError* error) {
  if (error == nullptr) return RtspProblem::other;
  if (error->domain == G_RESOLVER_ERROR) return RtspProblem::unknown_host;
  if (g_error_matches(error, G_IO_ERROR, G_IO_ERROR_CONNECTION_REFUSED)) return RtspProblem::refused;
  if (g_error_matches(error, G_IO_ERROR, G_IO_ERROR_HOST_UNREACHABLE) ||
      g_error_matches(error, G_IO_ERROR, G_IO_ERROR_NETWORK_UNREACHABLE))
    return RtspProblem::unreachable;
  if (g_error_matches(error, G_IO_ERROR, G_IO_ERROR_TIMED_OUT)) return RtspProblem::no_answer;
  return RtspProblem::other;
}

// GStreamer's own words, whose detail stands in the last line of the text for developers.
std::string words(const GError* error, const gchar* debug) {
  std::string text = error->message;
  const std::string_view all = debug ? debug : "";
  const std::size_t line = all.rfind('\n');
  if (line != all.npos && line + 1 < all.size()) text += " (" + std::string(all.substr(line + 1)) + ')';
  return text;
}

// rtspsrc has one error for all that keeps a connection from being made: it is tried here again.
struct Connection {
  SourceSettings source;
  std::string uri, detail;
  std::function<void(const std::string&)> done;

  static void finish(GObject* client, GAsyncResult* result, gpointer data) {
    const std::unique_ptr<Connection> self(static_cast<Connection*>(data));
    g_autoptr(GError) error = nullptr;
    g_autoptr(GSocketConnection) made =
        g_socket_client_connect_to_uri_finish(G_SOCKET_CLIENT(client), result, &error);
    self->done(
        describe(problem_of(error), self->source, self->uri, {}, made ? self->detail : error->message));
  }
};

}  // namespace

void RtspSource::watch(GstElement* rtspsrc, Codec codec) {
  {
    const std::lock_guard lock(offer_->lock);
    offer_->encoding = rtp_encoding(codec);
    offer_->streams.clear();
  }
  using Holder = std::shared_ptr<Offer>;
  const auto select = +[](GstElement*, guint, GstCaps* caps, gpointer data) -> gboolean {
    Offer& offer = **static_cast<Holder*>(data);
    const GstStructure* is = gst_caps_get_structure(caps, 0);
    const gchar *media = gst_structure_get_string(is, "media"),
                *encoding = gst_structure_get_string(is, "encoding-name");
    const std::lock_guard lock(offer.lock);
    offer.streams.push_back({media ? media : "", encoding ? encoding : ""});
    return g_strcmp0(media, "video") == 0 && offer.encoding == offer.streams.back().encoding;
  };
  g_signal_connect_data(
      rtspsrc, "select-stream", G_CALLBACK(select), new Holder(offer_),
      [](gpointer holder, GClosure*) { delete static_cast<Holder*>(holder); }, GConnectFlags(0));
}

void RtspSource::diagnose(const SourceSettings& source, const std::string& uri, const GError* error,
                          const gchar* debug, std::function<void(const std::string&)> done) const {
  std::vector<RtspStream> streams;
  bool right = false;
  {
    const std::lock_guard lock(offer_->lock);
    streams = offer_->streams;
    right = std::ranges::any_of(streams, [&](const RtspStream& one) {
      return one.media == "video" && one.encoding == offer_->encoding;
    });
  }
  const auto say = [&](RtspProblem problem) {
    done(describe(problem, source, uri, streams, words(error, debug)));
  };
  if (!streams.empty() && !right) return say(RtspProblem::streams);
  if (g_error_matches(error, GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_NOT_AUTHORIZED))
    return say(RtspProblem::unauthorized);
  if (g_error_matches(error, GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_NOT_FOUND))
    return say(RtspProblem::not_found);
  const std::string_view detail = debug ? debug : "";
  if (detail.find("(401)") != detail.npos || detail.find("(403)") != detail.npos)
    return say(RtspProblem::unauthorized);
  if (detail.find("arse error") != detail.npos) return say(RtspProblem::no_rtsp);
  if (!g_error_matches(error, GST_RESOURCE_ERROR, GST_RESOURCE_ERROR_OPEN_READ_WRITE))
    return say(RtspProblem::other);
  auto* connection = new Connection{source, uri, words(error, debug), std::move(done)};
  g_autoptr(GSocketClient) client = g_socket_client_new();
  g_socket_client_set_timeout(client, kPatience);
  g_socket_client_set_enable_proxy(client, FALSE);
  g_socket_client_connect_to_uri_async(client, uri.c_str(), kPort, nullptr, Connection::finish, connection);
}

}  // namespace cerberus::robot
