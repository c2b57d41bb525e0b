// SPDX-License-Identifier: LGPL-2.1-or-later
// The RTSP server of pipelines/rtsp, with clients over loopback. What a client gets is compared with what the encoder
// and onvifmeta gave out in the same process. Nothing here depends on how long anything takes.
#include <algorithm>
#include <cstdio>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <utility>
#include <vector>

#include "rtsp_server/rtsp_server.h"
#include "rtsp_server/whole_pictures.h"
#include "support.h"
#include "support/temporary_file.h"

using namespace cerberus::rtsp;
using cerberus::tests::temporary_file;

namespace {

// For this test only: made with `openssl ca`, for 127.0.0.1, from 2020 to 2120.
constexpr char kKey[] =
    "-----BEGIN PRIVATE KEY-----\n"
    "MIGHAgEAMBMGByqGSM49AgEGCCqGSM49AwEHBG0wawIBAQQgsAe8lxna/MZaHsmh\n"
    "pUBvGbEgzRYIZlsZP8m3gaXhFhGhRANCAASN4pYdpDLf/xQGpvF/npAyDRnHsf+T\n"
    "LcSaCRYNvZcfaElA4nx/MCXX0ZI7Fiy+53+bSMco8jK6lHsaIZ9DAJ0Z\n"
    "-----END PRIVATE KEY-----\n";
constexpr char kCertificate[] =
    "-----BEGIN CERTIFICATE-----\n"
    "MIIBdjCCAR2gAwIBAgIUBnJVqiKWaXo9FgzIEbWabfgwUrAwCgYIKoZIzj0EAwIw\n"
    "GDEWMBQGA1UEAwwNY2VyYmVydXMtdGVzdDAgFw0yMDAxMDEwMDAwMDBaGA8yMTIw\n"
    "MDEwMTAwMDAwMFowGDEWMBQGA1UEAwwNY2VyYmVydXMtdGVzdDBZMBMGByqGSM49\n"
    "AgEGCCqGSM49AwEHA0IABI3ilh2kMt//FAam8X+ekDINGcex/5MtxJoJFg29lx9o\n"
    "SUDifH8wJdfRkjsWLL7nf5tIxyjyMrqUexohn0MAnRmjQzBBMA8GA1UdEwEB/wQF\n"
    "MAMBAf8wDwYDVR0RBAgwBocEfwAAATAdBgNVHQ4EFgQU2ZSV+9522PV9ELtVjmOn\n"
    "0zjG92YwCgYIKoZIzj0EAwIDRwAwRAIgAqWADgcCWMVTGH+aAJVNYYWogEQOmOsj\n"
    "PRe7FJbzXygCIBnNgsRocVyJNIu/LPgoCuR/YCdP4dWfC30E0PqYZV8W\n"
    "-----END CERTIFICATE-----\n";

#define ENCODER                                                                               \
  "videoconvert ! video/x-raw,format=I420 ! x264enc name=encoder tune=zerolatency threads=1 " \
  "speed-preset=ultrafast key-int-max=250 ! video/x-h264,stream-format=byte-stream ! appsink "
constexpr char kPlain[] =
    "videotestsrc is-live=true ! video/x-raw,width=160,height=120,framerate=25/1 ! " ENCODER "name=plain";
constexpr char kIdle[] =
    "videotestsrc is-live=true ! video/x-raw,width=160,height=120,framerate=25/1 ! "
    "valve name=plain-valve drop-mode=forward-sticky-events ! " ENCODER "name=plain";
constexpr char kAnnotated[] =
    "videotestsrc is-live=true pattern=ball ! video/x-raw,width=160,height=120,framerate=25/1 ! motiondetect "
    "! "
    "tee name=t t. ! queue ! motionoverlay ! " ENCODER
    "name=annotated t. ! queue ! onvifmeta name=documents ! appsink name=metadata";

void assert_text(const std::string& text, const std::string& expected) {
  fail_unless(text == expected, "\"%s\" is not \"%s\"", text.c_str(), expected.c_str());
}

// Serves the default main context until it holds: the patience is that of a hang.
void wait_for(const char* what, const std::function<bool()>& condition) {
  const gint64 end = g_get_monotonic_time() + 150 * G_USEC_PER_SEC;
  while (!condition()) {
    fail_unless(g_get_monotonic_time() < end, "waited in vain for %s", what);
    g_main_context_iteration(nullptr, FALSE);
    g_usleep(2000);
  }
}

std::string bytes_of(GstBuffer* buffer) {
  std::string bytes(gst_buffer_get_size(buffer), '\0');
  gst_buffer_extract(buffer, 0, bytes.data(), bytes.size());
  return bytes;
}

// The coded picture of an access unit in byte-stream format: its slices, without parameter sets and delimiters, which a
// payloader adds and removes.
std::string slices_of(const std::string& unit) {
  const std::string start_code("\0\0\1", 3);
  std::string slices;
  for (auto at = unit.find(start_code); at != unit.npos;) {
    const auto begin = at + 3, next = unit.find(start_code, begin);
    std::string nal = unit.substr(begin, next == unit.npos ? next : next - begin);
    while (!nal.empty() && nal.back() == '\0') nal.pop_back();
    if (!nal.empty() && (nal[0] & 31) >= 1 && (nal[0] & 31) <= 5) slices += nal;
    at = next;
  }
  return slices;
}

bool is_keyframe(const std::string& slices) {
  return (slices[0] & 31) == 5;
}

// What was given out in this order, from other threads.
class Log {
 public:
  void add(std::string text) {
    const std::lock_guard lock(mutex_);
    entries_.push_back(std::move(text));
  }
  std::vector<std::string> all() const {
    const std::lock_guard lock(mutex_);
    return entries_;
  }
  std::size_t size() const { return all().size(); }

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> entries_;
};

// Each test runs in a process of its own (but for CK_FORK=no).
bool is_forked() {
  return g_strcmp0(g_getenv("CK_FORK"), "no") != 0;
}

// A pipeline with this line, served.
class Served {
 public:
  explicit Served(const char* line, ServerSettings settings = {}) {
    settings.port = 0;
    g_autoptr(GError) error = nullptr;
    pipeline_ = gst_parse_launch(line, &error);
    fail_unless(pipeline_ && !error, "%s", error ? error->message : "");
    watch("encoder", [](Log& log, GstBuffer* buffer) { log.add(slices_of(bytes_of(buffer))); }, pictures);
    watch("documents", [](Log& log, GstBuffer* buffer) { log.add(bytes_of(buffer)); }, documents);
    server_ = std::make_unique<RtspServer>(settings);
    assert_text(server_->prepare(), "");
    assert_text(streams_.collect(pipeline_), "");
    gst_element_set_state(pipeline_, GST_STATE_PLAYING);
    wait_for("the first pictures", [this] { return streams_.has_begun(); });
    wrong = server_->add({}, streams_);
    if (wrong.empty()) wrong = server_->listen();
  }
  // As a camera that is hidden, and shown again below a folder.
  void hide() {
    streams_.close();
    server_->remove({});
  }
  void show(const std::string& folder) {
    streams_.reopen();
    assert_text(server_->add(folder, streams_), "");
  }
  ~Served() {
    server_.reset();
    gst_element_set_state(pipeline_, GST_STATE_NULL);
    gst_object_unref(pipeline_);
    if (is_forked()) gst_rtsp_thread_pool_cleanup();  // it ends the threads of every server to come, too
  }
  int port() const { return server_->port(); }
  std::string address(const std::string& mount, const char* scheme = "rtsp") const {
    return std::string(scheme) + "://127.0.0.1:" + std::to_string(port()) + "/" + mount;
  }
  int encoders() const {
    int count = 0;
    GstIterator* all = gst_bin_iterate_recurse(GST_BIN(pipeline_));
    GValue item = G_VALUE_INIT;
    while (gst_iterator_next(all, &item) == GST_ITERATOR_OK) {
      GstElementFactory* factory = gst_element_get_factory(GST_ELEMENT(g_value_get_object(&item)));
      if (gst_element_factory_list_is_type(factory, GST_ELEMENT_FACTORY_TYPE_ENCODER)) ++count;
      g_value_unset(&item);
    }
    gst_iterator_free(all);
    return count;
  }
  bool is_idle() const {
    g_autoptr(GstElement) valve = gst_bin_get_by_name(GST_BIN(pipeline_), "plain-valve");
    gboolean closed = FALSE;
    g_object_get(valve, "drop", &closed, nullptr);
    return closed;
  }

  Log pictures;   // slices of each frame that the encoder gave out
  Log documents;  // that onvifmeta gave out
  std::string wrong;

 private:
  using Note = void (*)(Log&, GstBuffer*);
  void watch(const char* element, Note note, Log& log) {
    g_autoptr(GstElement) found = gst_bin_get_by_name(GST_BIN(pipeline_), element);
    if (!found) return;
    g_autoptr(GstPad) pad = gst_element_get_static_pad(found, "src");
    auto* to = new std::pair<Log*, Note>(&log, note);
    gst_pad_add_probe(
        pad, GST_PAD_PROBE_TYPE_BUFFER,
        [](GstPad*, GstPadProbeInfo* info, gpointer data) {
          const auto& [into, each] = *static_cast<std::pair<Log*, Note>*>(data);
          each(*into, GST_PAD_PROBE_INFO_BUFFER(info));
          return GST_PAD_PROBE_OK;
        },
        to, [](gpointer gone) { delete static_cast<std::pair<Log*, Note>*>(gone); });
  }

  GstElement* pipeline_ = nullptr;
  PipelineStreams streams_;
  std::unique_ptr<RtspServer> server_;
};

// A player: what it received.
class Client {
 public:
  explicit Client(const std::string& address, const std::string& settings = "",
                  GTlsDatabase* trusted = nullptr) {
    const std::string line =
        "rtspsrc name=source latency=0 location=" + address + " " + settings +
        " rtph264depay name=depay ! video/x-h264,stream-format=byte-stream,alignment=au ! "
        "fakesink name=video async=false sync=false signal-handoffs=true "
        "fakesink name=metadata async=false sync=false signal-handoffs=true";
    g_autoptr(GError) error = nullptr;
    pipeline_ = gst_parse_launch(line.c_str(), &error);
    fail_unless(pipeline_ && !error, "%s", error ? error->message : "");
    g_autoptr(GstElement) source = gst_bin_get_by_name(GST_BIN(pipeline_), "source");
    if (trusted) g_object_set(source, "tls-database", trusted, nullptr);
    // Here and not in the line: links that gst_parse_launch() delays disturb each other when two pads come at once.
    g_signal_connect(
        source, "pad-added", G_CALLBACK(+[](GstElement*, GstPad* pad, GstElement* pipeline) {
          g_autoptr(GstCaps) caps = gst_pad_get_current_caps(pad);
          const GstStructure* structure = gst_caps_get_structure(caps, 0);
          const bool video = g_strcmp0(gst_structure_get_string(structure, "media"), "video") == 0;
          g_autoptr(GstElement) next = gst_bin_get_by_name(GST_BIN(pipeline), video ? "depay" : "metadata");
          g_autoptr(GstPad) sink = gst_element_get_static_pad(next, "sink");
          fail_unless_equals_int(gst_pad_link(pad, sink), GST_PAD_LINK_OK);
        }),
        pipeline_);
    connect("video", G_CALLBACK(+[](GstElement*, GstBuffer* buffer, GstPad*, Client* client) {
              if (std::string slices = slices_of(bytes_of(buffer)); !slices.empty())
                client->pictures.add(std::move(slices));
            }));
    connect("metadata", G_CALLBACK(+[](GstElement*, GstBuffer* packet, GstPad*, Client* client) {
              // RTP (RFC 3550): 12 bytes of header where there are neither sources nor extensions
              const std::string bytes = bytes_of(packet);
              client->document_ += bytes.substr(12);
              if (bytes[1] & '\x80') client->documents.add(std::exchange(client->document_, {}));
            }));
    gst_element_set_state(pipeline_, GST_STATE_PLAYING);
  }
  ~Client() {
    gst_element_set_state(pipeline_, GST_STATE_NULL);
    gst_object_unref(pipeline_);
  }
  // The code of the error that came, if one came.
  int error() const {
    g_autoptr(GstBus) bus = gst_element_get_bus(pipeline_);
    g_autoptr(GstMessage) message = gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR);
    if (!message) return 0;
    g_autoptr(GError) error = nullptr;
    gst_message_parse_error(message, &error, nullptr);
    return error->domain == GST_RESOURCE_ERROR ? error->code : -1;
  }

  Log pictures, documents;

 private:
  void connect(const char* name, GCallback handler) {
    g_autoptr(GstElement) sink = gst_bin_get_by_name(GST_BIN(pipeline_), name);
    g_signal_connect(sink, "handoff", handler, this);
  }

  GstElement* pipeline_ = nullptr;
  std::string document_;  // so far
};

void wait_for_pictures(const Client& client, std::size_t count) {
  wait_for("pictures", [&] { return client.pictures.size() >= count; });
}

// Where the encoder gave out each of these pictures: fails for one that it did not.
std::vector<std::size_t> places_in(const std::vector<std::string>& encoded,
                                   const std::vector<std::string>& received) {
  std::vector<std::size_t> places;
  for (const std::string& picture : received) {
    const auto from = encoded.begin() + static_cast<std::ptrdiff_t>(places.empty() ? 0 : places.back() + 1);
    const auto found = std::find(from, encoded.end(), picture);
    fail_unless(found != encoded.end(),
                "a client has a picture that the encoder did not give out in this order");
    places.push_back(static_cast<std::size_t>(found - encoded.begin()));
  }
  return places;
}

std::size_t first_keyframe(const std::vector<std::string>& pictures) {
  return static_cast<std::size_t>(std::find_if(pictures.begin(), pictures.end(), is_keyframe) -
                                  pictures.begin());
}

bool is_xml(const std::string& text) {
  const GMarkupParser parser = {};
  g_autoptr(GMarkupParseContext) context =
      g_markup_parse_context_new(&parser, static_cast<GMarkupParseFlags>(0), nullptr, nullptr);
  return g_markup_parse_context_parse(context, text.data(), static_cast<gssize>(text.size()), nullptr) &&
         g_markup_parse_context_end_parse(context, nullptr);
}

ServerSettings with_user() {
  ServerSettings settings;
  settings.users = {{"anna", "right horse"}};
  return settings;
}

std::string prepared(const char* line, const std::string& certificate = "") {
  ServerSettings settings;
  settings.certificate = certificate;
  g_autoptr(GstElement) pipeline = gst_parse_launch(line, nullptr);
  RtspServer server(settings);
  const std::string wrong = server.prepare();
  return wrong.empty() ? PipelineStreams().collect(pipeline) : wrong;
}

}  // namespace

GST_START_TEST(two_clients_get_the_pictures_of_one_encoder_and_the_second_begins_at_once) {
  Served served(kAnnotated);
  assert_text(served.wrong, "");
  Client first(served.address("annotated"), "protocols=udp");
  wait_for_pictures(first, 30);  // well within the GOP of 250
  Client second(served.address("annotated"), "protocols=tcp");
  wait_for("the second client's keyframe", [&] {
    const auto pictures = second.pictures.all();
    return first_keyframe(pictures) + 5 < pictures.size();
  });
  wait_for("metadata", [&] { return second.documents.size() >= 5; });

  fail_unless_equals_int(served.encoders(), 1);
  const auto of_first = first.pictures.all(), of_second = second.pictures.all();
  const auto encoded = served.pictures.all();
  const auto places = places_in(encoded, of_first), second_places = places_in(encoded, of_second);
  fail_unless(is_keyframe(of_first[0]));
  // Frames from the moment that the second one plays to its first keyframe. Without asking for one there are more than
  // 200, as the next one of the GOP comes 250 frames after that of the first client.
  const auto waited = second_places[first_keyframe(of_second)] - second_places[0];
  fail_unless(waited < 100, "the second client waited for %d frames", static_cast<int>(waited));
  const std::set<std::size_t> had_first(places.begin(), places.end());
  fail_unless(
      std::ranges::any_of(second_places, [&](std::size_t place) { return had_first.contains(place); }),
      "the two have no picture in common");

  const auto made = served.documents.all();
  for (const std::string& document : second.documents.all()) {
    fail_unless(is_xml(document), "no XML: %s", document.c_str());
    fail_unless(std::ranges::count(made, document) > 0, "onvifmeta did not write %s", document.c_str());
  }
}
GST_END_TEST

GST_START_TEST(a_mount_that_every_client_left_encodes_nothing_and_is_served_again) {
  Served served(kIdle);
  for (int k = 0; k < 2; ++k) {
    wait_for("an idle encoder", [&] { return served.is_idle(); });
    Client client(served.address("plain"), "protocols=tcp");
    wait_for_pictures(client, 5);
    fail_unless(!served.is_idle());
    const auto received = client.pictures.all();
    fail_unless(is_keyframe(received[0]));
    places_in(served.pictures.all(), received);
  }
}
GST_END_TEST

GST_START_TEST(a_mount_that_is_removed_ends_for_its_clients_and_may_come_back_below_a_folder) {
  Served served(kIdle);
  Client first(served.address("plain"), "protocols=tcp");
  wait_for_pictures(first, 3);
  served.hide();
  wait_for("an idle encoder", [&] { return served.is_idle(); });
  Client refused(served.address("plain"), "protocols=tcp");
  int error = 0;
  wait_for("a refusal", [&] { return (error = refused.error()) != 0; });
  fail_unless_equals_int(error, GST_RESOURCE_ERROR_NOT_FOUND);
  fail_unless(refused.pictures.size() == 0);
  served.show("front");
  Client second(served.address("front/plain"), "protocols=tcp");
  wait_for_pictures(second, 3);
}
GST_END_TEST

GST_START_TEST(only_a_user_with_the_right_password_plays) {
  Served served(kPlain, with_user());
  const std::string address = served.address("plain");
  for (const char* login : {"", "user-id=anna user-pw=wrong", "user-id=bo user-pw=\"right horse\""}) {
    Client client(address, login);
    int error = 0;
    wait_for("a refusal", [&] { return (error = client.error()) != 0; });
    fail_unless_equals_int(error, GST_RESOURCE_ERROR_NOT_AUTHORIZED);
    fail_unless_equals_int(client.pictures.size(), 0);
  }
  Client client(address, "user-id=anna user-pw=\"right horse\"");
  wait_for_pictures(client, 3);
}
GST_END_TEST

GST_START_TEST(an_address_with_wrong_passwords_is_refused_for_a_while_and_longer_each_time) {
  Served served(kPlain, with_user());
  const std::string address = served.address("plain");
  const auto is_refused = [&](const char* password) {
    Client client(address, std::string("user-id=anna user-pw=") + password);
    int error = 0;
    wait_for("an answer", [&] { return (error = client.error()) != 0 || client.pictures.size() > 0; });
    fail_unless(error == 0 || error == GST_RESOURCE_ERROR_NOT_AUTHORIZED, "error %d", error);
    return error != 0;
  };
  for (int k = 0; k < 2; ++k) fail_unless(is_refused("wrong"));
  fail_if(is_refused("\"right horse\""));  // which begins anew
  // After about five clients there is a delay of 1, 2, 4 ... 60 s, of which a slow machine needs a longer one.
  for (int count = 6;; ++count) {
    fail_unless(count < 12, "the right password is never refused");
    for (int k = 0; k < count; ++k) fail_unless(is_refused("wrong"));
    if (is_refused("\"right horse\"")) break;
  }
  wait_for("the end of the delay", [&] { return !is_refused("\"right horse\""); });
}
GST_END_TEST

// Whether the other end has closed the connection.
bool is_closed(GSocketConnection* connection) {
  char byte = 0;
  return g_socket_receive_with_blocking(g_socket_connection_get_socket(connection), &byte, 1, FALSE, nullptr,
                                        nullptr) == 0;
}

// Connections that ask for nothing.
std::vector<GSocketConnection*> connect(const Served& served, int count) {
  g_autoptr(GSocketClient) connector = g_socket_client_new();
  std::vector<GSocketConnection*> all;
  for (int k = 0; k < count; ++k) {
    all.push_back(g_socket_client_connect_to_host(connector, "127.0.0.1", static_cast<guint16>(served.port()),
                                                  nullptr, nullptr));
    fail_unless(all.back());
    while (g_main_context_iteration(nullptr, FALSE)) {
    }
  }
  return all;
}

GST_START_TEST(an_address_has_few_connections) {
  ServerSettings settings;
  settings.most_of_address = 3;
  Served served(kPlain, settings);
  const std::vector<GSocketConnection*> all = connect(served, 5);
  for (const int k : {3, 4}) wait_for("the end of a connection", [&] { return is_closed(all[k]); });
  for (int k = 0; k < 3; ++k) fail_if(is_closed(all[k]), "connection %d is closed", k);
  for (GSocketConnection* each : all) g_object_unref(each);
}
GST_END_TEST

// The status of the answer to a request on this connection.
int answer_to(GSocketConnection* connection, const std::string& request) {
  GSocket* socket = g_socket_connection_get_socket(connection);
  fail_unless_equals_int(g_socket_send(socket, request.data(), request.size(), nullptr, nullptr),
                         static_cast<int>(request.size()));
  std::string answer;
  wait_for("an answer", [&] {
    char bytes[512];
    const gssize count = g_socket_receive_with_blocking(socket, bytes, sizeof bytes, FALSE, nullptr, nullptr);
    if (count > 0) answer.append(bytes, static_cast<std::size_t>(count));
    return count == 0 || answer.find("\r\n\r\n") != answer.npos;
  });
  int status = 0;
  std::sscanf(answer.c_str(), "RTSP/1.0 %d", &status);
  return status;
}

GST_START_TEST(a_connection_has_few_sessions) {
  Served served(kPlain);
  const std::vector<GSocketConnection*> all = connect(served, 1);
  for (int k = 0; k < 6; ++k) {
    const std::string channels = std::to_string(2 * k) + "-" + std::to_string(2 * k + 1);
    const int status = answer_to(
        all[0], "SETUP " + served.address("plain") + "/stream=0 RTSP/1.0\r\nCSeq: " + std::to_string(k + 1) +
                    "\r\nTransport: RTP/AVP/TCP;unicast;interleaved=" + channels + "\r\n\r\n");
    fail_unless_equals_int(status, k < 4 ? 200 : 503);
  }
  Client other(served.address("plain"), "protocols=tcp");
  wait_for_pictures(other, 3);
  for (GSocketConnection* each : all) g_object_unref(each);
}
GST_END_TEST

GST_START_TEST(a_connection_without_a_session_ends_after_a_while_and_a_player_goes_on) {
  ServerSettings settings;
  settings.idle = std::chrono::seconds(5);
  Served served(kPlain, settings);
  std::unique_ptr<Client> client;
  wait_for("a player", [&] {  // a slow machine may let one be idle for too long
    client = std::make_unique<Client>(served.address("plain"), "protocols=tcp");
    wait_for("an answer", [&] { return client->error() != 0 || client->pictures.size() > 0; });
    return client->pictures.size() > 0;
  });
  const std::vector<GSocketConnection*> all = connect(served, 1);
  wait_for("the end of a connection", [&] { return is_closed(all[0]); });
  for (GSocketConnection* each : all) g_object_unref(each);
  wait_for_pictures(*client, client->pictures.size() + 3);
  fail_unless_equals_int(client->error(), 0);
}
GST_END_TEST

GST_START_TEST(connections_are_limited_and_others_take_the_place_of_those_that_end) {
  ServerSettings settings;
  settings.most_of_address = 200;
  Served served(kPlain, settings);
  std::vector<GSocketConnection*> all = connect(served, 130);
  for (const int k : {128, 129}) wait_for("the end of a connection", [&] { return is_closed(all[k]); });
  for (int k = 0; k < 128; ++k) fail_if(is_closed(all[k]), "connection %d is closed", k);
  for (GSocketConnection* each : all) g_object_unref(each);
  // The server needs a moment until it has noticed.
  wait_for("a player", [&] {
    Client client(served.address("plain"), "protocols=tcp");
    wait_for("an answer", [&] { return client.error() != 0 || client.pictures.size() >= 3; });
    return client.pictures.size() >= 3;
  });
}
GST_END_TEST

GST_START_TEST(tls_plays_with_the_certificate_that_was_given_and_not_in_the_clear) {
  if (!g_tls_backend_supports_tls(g_tls_backend_get_default())) {
    g_print("skipped: TLS needs glib-networking\n");
    return;
  }
  ServerSettings settings = with_user();
  settings.certificate = temporary_file(kCertificate);
  settings.key = temporary_file(kKey);
  {
    Served served(kPlain, settings);
    assert_text(served.wrong, "");
    g_autoptr(GTlsDatabase) trusted = g_tls_file_database_new(settings.certificate.c_str(), nullptr);
    const std::string login = "user-id=anna user-pw=\"right horse\" ";
    Client client(served.address("plain", "rtsps"), login, trusted);
    wait_for_pictures(client, 3);
    // Nothing travels beside the encrypted connection, and nothing is served without it.
    for (const auto& [scheme, protocols] : {std::pair("rtsps", "protocols=udp"), {"rtsp", "protocols=tcp"}}) {
      Client other(served.address("plain", scheme), login + protocols, trusted);
      wait_for("a refusal", [&] { return other.error() != 0; });
      fail_unless_equals_int(other.pictures.size(), 0);
    }
  }
  const std::string keyless = prepared("videotestsrc ! appsink", settings.certificate);
  const std::string expected = "the certificate " + settings.certificate +
                               " cannot be used: No PEM-encoded private key found (--key names another file)";
  assert_text(keyless, expected);
  std::remove(settings.certificate.c_str());
  std::remove(settings.key.c_str());
}
GST_END_TEST

GST_START_TEST(what_cannot_be_served_is_named) {
  Served served(kPlain);
  g_autoptr(GstElement) second = gst_parse_launch(kPlain, nullptr);
  ServerSettings settings;
  settings.port = served.port();
  {
    RtspServer server(settings);
    PipelineStreams streams;
    assert_text(server.prepare(), "");
    assert_text(streams.collect(second), "");
    assert_text(server.add({}, streams), "the stream plain has not begun");
    gst_element_set_state(second, GST_STATE_PLAYING);
    wait_for("the first pictures", [&] { return streams.has_begun(); });
    assert_text(server.add({}, streams), "");
    fail_unless(server.listen().find("port " + std::to_string(served.port()) + " of 127.0.0.1 is in use") ==
                0);
    gst_element_set_state(second, GST_STATE_NULL);
  }
  Served raw("videotestsrc is-live=true ! video/x-raw,width=32,height=32 ! appsink name=raw");
  fail_unless_equals_string(
      raw.wrong.c_str(),
      "the stream raw is video/x-raw, which is not sent over RTSP: encode it as H.264, H.265, "
      "VP8, VP9 or JPEG");
  fail_unless(prepared("videotestsrc ! fakesink").find("the line has no appsink") == 0);
  fail_unless(prepared("videotestsrc ! appsink name=a/b").find("the appsink \"a/b\" cannot be a mount") == 0);
  const std::string wrong = prepared("videotestsrc ! appsink", "/no/such/file.pem");
  fail_unless(wrong.find("the certificate /no/such/file.pem cannot be used: ") == 0, "%s", wrong.c_str());
}
GST_END_TEST

// What a pad sends: the number of packets of each list, and of those that come alone.
struct Sent {
  std::vector<guint> lists;
  guint alone = 0, markers_within = 0;
};

GstPadProbeReturn note(GstPad*, GstPadProbeInfo* info, gpointer data) {
  auto& sent = *static_cast<Sent*>(data);
  const auto has_marker = [](GstBuffer* packet) { return (bytes_of(packet)[1] & 0x80) != 0; };
  if ((GST_PAD_PROBE_INFO_TYPE(info) & GST_PAD_PROBE_TYPE_BUFFER_LIST) != 0) {
    GstBufferList* list = gst_pad_probe_info_get_buffer_list(info);
    const guint count = gst_buffer_list_length(list);
    sent.lists.push_back(count);
    for (guint k = 0; k + 1 < count; ++k) sent.markers_within += has_marker(gst_buffer_list_get(list, k));
  } else {
    ++sent.alone;
  }
  return GST_PAD_PROBE_OK;
}

void note_what(GstElement* payloader, Sent& sent) {
  g_autoptr(GstPad) pad = gst_element_get_static_pad(payloader, "src");
  gst_pad_add_probe(pad,
                    static_cast<GstPadProbeType>(GST_PAD_PROBE_TYPE_BUFFER | GST_PAD_PROBE_TYPE_BUFFER_LIST),
                    note, &sent, nullptr);
}

// A client that joins between two packets would begin with half of a picture.
GST_START_TEST(the_slices_of_a_picture_are_sent_together) {
  g_autoptr(GstElement) pipeline = gst_parse_launch(
      "videotestsrc pattern=snow num-buffers=20 ! "
      "video/x-raw,format=I420,width=320,height=240,framerate=25/1 ! "
      "x264enc tune=zerolatency threads=4 sliced-threads=true speed-preset=ultrafast key-int-max=10 ! "
      "video/x-h264,stream-format=byte-stream ! rtph264pay name=pay config-interval=1 "
      "aggregate-mode=none ! "
      "fakesink",
      nullptr);
  g_autoptr(GstElement) payloader = gst_bin_get_by_name(GST_BIN(pipeline), "pay");
  Sent sent;
  send_whole_pictures(payloader);
  note_what(payloader, sent);
  gst_element_set_state(pipeline, GST_STATE_PLAYING);
  g_autoptr(GstBus) bus = gst_element_get_bus(pipeline);
  g_autoptr(GstMessage) end = gst_bus_timed_pop_filtered(
      bus, GST_CLOCK_TIME_NONE, static_cast<GstMessageType>(GST_MESSAGE_EOS | GST_MESSAGE_ERROR));
  fail_unless_equals_int(GST_MESSAGE_TYPE(end), GST_MESSAGE_EOS);
  gst_element_set_state(pipeline, GST_STATE_NULL);
  fail_unless_equals_int(sent.alone, 0);
  fail_unless_equals_int(sent.lists.size(), 20);
  fail_unless_equals_int(sent.markers_within, 0);
  for (const guint packets : sent.lists) fail_unless(packets >= 4, "%u packets for four slices", packets);
}
GST_END_TEST

// An element in place of a payloader, whose packets come from the test.
GstHarness* payloader_of(Sent& sent) {
  GstHarness* harness = gst_harness_new("identity");
  send_whole_pictures(harness->element);
  note_what(harness->element, sent);
  gst_harness_set_src_caps_str(harness, "application/x-rtp");
  return harness;
}

void push_packet(GstHarness* harness, int stamp, bool marker) {
  const guint8 header[12] = {
      0x80, static_cast<guint8>(96 | (marker ? 0x80 : 0)), 0, 0, 0, 0, 0, static_cast<guint8>(stamp)};
  GstBuffer* packet = gst_buffer_new_memdup(header, sizeof header);
  fail_unless_equals_int(gst_harness_push(harness, packet), GST_FLOW_OK);
}

GST_START_TEST(a_picture_without_a_marker_is_sent_when_the_next_one_begins) {
  Sent sent;
  GstHarness* harness = payloader_of(sent);
  for (const auto& [stamp, marker] :
       {std::pair{1, false}, {1, false}, {2, false}, {3, false}, {3, true}, {4, true}})
    push_packet(harness, stamp, marker);
  fail_unless(sent.lists == std::vector<guint>({2, 1, 2, 1}) && sent.alone == 0);
  gst_harness_teardown(harness);
}
GST_END_TEST

GST_START_TEST(the_last_picture_is_sent_at_the_end_without_a_marker_too) {
  Sent sent;
  GstHarness* harness = payloader_of(sent);
  for (int k = 0; k < 3; ++k) push_packet(harness, 1, false);
  fail_unless_equals_int(gst_harness_buffers_received(harness), 0);
  fail_unless(gst_harness_push_event(harness, gst_event_new_eos()));
  fail_unless_equals_int(gst_harness_buffers_received(harness), 3);
  gst_harness_teardown(harness);
}
GST_END_TEST

GST_START_TEST(a_flush_drops_the_picture_that_has_begun) {
  Sent sent;
  GstHarness* harness = payloader_of(sent);
  push_packet(harness, 1, false);
  gst_harness_push_event(harness, gst_event_new_flush_start());
  gst_harness_push_event(harness, gst_event_new_flush_stop(TRUE));
  GstSegment segment;
  gst_segment_init(&segment, GST_FORMAT_TIME);
  gst_harness_push_event(harness, gst_event_new_segment(&segment));
  push_packet(harness, 2, false);
  push_packet(harness, 2, true);
  fail_unless(sent.lists == std::vector<guint>({2}));
  gst_harness_teardown(harness);
}
GST_END_TEST

// A payloader with neither markers nor time stamps.
GST_START_TEST(what_has_no_end_is_sent_in_parts) {
  constexpr int kCount = 50000;
  Sent sent;
  GstHarness* harness = payloader_of(sent);
  for (int k = 0; k < kCount; ++k) push_packet(harness, 1, false);
  int packets = 0;
  for (const guint list : sent.lists) packets += list;
  fail_unless(packets > kCount / 2, "%d of %d packets were sent", packets, kCount);
  fail_unless(sent.lists.front() > 10000, "a picture of %u packets is not sent whole", sent.lists.front());
  gst_harness_teardown(harness);
}
GST_END_TEST

static Suite* rtsp_suite() {
  Suite* suite = suite_create("rtsp");
  TCase* cases = tcase_create("general");
  tcase_set_timeout(cases, 200);
  tcase_add_test(cases, two_clients_get_the_pictures_of_one_encoder_and_the_second_begins_at_once);
  tcase_add_test(cases, a_mount_that_every_client_left_encodes_nothing_and_is_served_again);
  tcase_add_test(cases, a_mount_that_is_removed_ends_for_its_clients_and_may_come_back_below_a_folder);
  tcase_add_test(cases, only_a_user_with_the_right_password_plays);
  tcase_add_test(cases, an_address_with_wrong_passwords_is_refused_for_a_while_and_longer_each_time);
  tcase_add_test(cases, an_address_has_few_connections);
  tcase_add_test(cases, a_connection_has_few_sessions);
  tcase_add_test(cases, a_connection_without_a_session_ends_after_a_while_and_a_player_goes_on);
  tcase_add_test(cases, connections_are_limited_and_others_take_the_place_of_those_that_end);
  tcase_add_test(cases, tls_plays_with_the_certificate_that_was_given_and_not_in_the_clear);
  tcase_add_test(cases, what_cannot_be_served_is_named);
  tcase_add_test(cases, the_slices_of_a_picture_are_sent_together);
  tcase_add_test(cases, a_picture_without_a_marker_is_sent_when_the_next_one_begins);
  tcase_add_test(cases, the_last_picture_is_sent_at_the_end_without_a_marker_too);
  tcase_add_test(cases, a_flush_drops_the_picture_that_has_begun);
  tcase_add_test(cases, what_has_no_end_is_sent_in_parts);
  suite_add_tcase(suite, cases);
  return suite;
}

GST_CHECK_MAIN(rtsp)
