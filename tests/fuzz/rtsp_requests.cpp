// SPDX-License-Identifier: LGPL-2.1-or-later
// What a client of the RTSP server sends, over loopback: an input whose first byte is odd goes to a server with a user, any
// other to one without. The servers go on, and nothing is described or set up without the password. gst-rtsp-server parses
// the requests, the log-in is our part of it. Only by libFuzzer: each input is a connection.
#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>
#include <thread>

#include "rtsp_server/rtsp_server.h"

using namespace cerberus::rtsp;

// GStreamer's libraries keep what they have registered.
extern "C" const char* __asan_default_options() {
  return "detect_leaks=0";
}

namespace {

constexpr int kPatience = 100'000;  // milliseconds for an answer that must come
constexpr int kEnd = 200;           // milliseconds after which a connection is closed, which may play

[[noreturn]] void give_up(const std::string& why) {
  std::fprintf(stderr, "rtsp_requests: %s\n", why.c_str());
  std::abort();
}

// A pipeline of small JPEGs and a server of it, for as long as the process runs.
class Served {
 public:
  explicit Served(std::vector<cerberus::publish::User> users) {
    ServerSettings settings;
    settings.port = 0;
    settings.users = std::move(users);
    pipeline_ = gst_parse_launch(
        "videotestsrc is-live=true ! video/x-raw,format=I420,width=32,height=32,framerate=20/1 ! jpegenc ! "
        "appsink name=plain",
        nullptr);
    server_ = std::make_unique<RtspServer>(settings);
    std::string wrong = server_->prepare();
    if (wrong.empty()) wrong = streams_.collect(pipeline_);
    gst_element_set_state(pipeline_, GST_STATE_PLAYING);
    while (wrong.empty() && !streams_.has_begun()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    if (wrong.empty()) wrong = server_->add({}, streams_);
    if (wrong.empty()) wrong = server_->listen();
    if (!wrong.empty()) give_up(wrong);
  }
  int port() const { return server_->port(); }

 private:
  GstElement* pipeline_ = nullptr;
  PipelineStreams streams_;
  std::unique_ptr<RtspServer> server_;
};

struct Servers {
  Servers() : open({}), closed({{"anna", "right horse"}}) {
    std::thread([] { g_main_loop_run(g_main_loop_new(nullptr, FALSE)); }).detach();
  }
  Served open, closed;
};

// Sends the bytes and returns what is answered until the server closes the connection, `wanted` (where it is given) is in
// the answer, or `longest` milliseconds are over.
std::string talk(int port, std::string_view bytes, int longest, std::string_view wanted = {}) {
  const gint64 end = g_get_monotonic_time() + gint64{1000} * longest;
  const auto rest = [end] {
    return static_cast<int>(std::max<gint64>(0, end - g_get_monotonic_time()) / 1000);
  };
  const int line = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (connect(line, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) give_up("no connection");
  while (!bytes.empty()) {
    const ssize_t sent = send(line, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent <= 0) break;  // refused
    bytes.remove_prefix(static_cast<std::size_t>(sent));
  }
  if (wanted.empty()) shutdown(line, SHUT_WR);
  std::string answer;
  std::array<char, 4096> part;
  pollfd waiting{line, POLLIN, 0};
  while (poll(&waiting, 1, rest()) > 0) {
    const ssize_t got = recv(line, part.data(), part.size(), 0);
    if (got <= 0) break;
    if (answer.size() < 65536) answer.append(part.data(), static_cast<std::size_t>(got));
    if (!wanted.empty() && answer.find(wanted) != answer.npos) break;
  }
  close(line);
  return answer;
}

// Connections of one address are limited: those of before may have to end.
void check_that_it_answers(int port) {
  const gint64 end = g_get_monotonic_time() + gint64{1000} * kPatience;
  while (talk(port, "OPTIONS rtsp://127.0.0.1/plain RTSP/1.0\r\nCSeq: 1\r\n\r\n", kPatience, "RTSP/1.0 ")
             .empty())
    if (g_get_monotonic_time() > end) give_up("the server does not answer any more");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Servers* const servers = (gst_init(nullptr, nullptr), new Servers);
  static unsigned count = 0;
  if (size == 0) return 0;
  const bool is_closed = data[0] % 2;
  const std::string answer = talk((is_closed ? servers->closed : servers->open).port(),
                                  {reinterpret_cast<const char*>(data) + 1, size - 1}, kEnd);
  // At the beginning of a line: the value of CSeq is repeated in the answer, whatever it is.
  if (is_closed && (answer.find("\nContent-Type: application/sdp") != answer.npos ||
                    answer.find("\nSession:") != answer.npos))
    give_up("served without a password: " + answer);
  if (++count % 64 == 0) {
    check_that_it_answers(servers->open.port());
    check_that_it_answers(servers->closed.port());
  }
  return 0;
}
