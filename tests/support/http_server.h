// SPDX-License-Identifier: LGPL-2.1-or-later
// A small HTTP/1.1 server on loopback for emulated devices: one thread, several connections kept open, answers that are
// late on purpose. Written from RFC 9112; it knows POST with Content-Length, which is all that SOAP needs.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <string>
#include <thread>
#include <vector>

namespace cerberus::tests {

struct HttpMessage {
  std::string path, headers, body;

  // The value of a header; empty: it is not there.
  std::string header(const std::string& name) const {
    std::string small = headers, wanted = "\r\n" + name + ":";
    for (std::string* text : {&small, &wanted})
      std::transform(text->begin(), text->end(), text->begin(),
                     [](unsigned char c) { return std::tolower(c); });
    const auto at = small.find(wanted);
    if (at == small.npos) return {};
    const auto begin = headers.find_first_not_of(' ', at + wanted.size());
    return headers.substr(begin, headers.find("\r\n", begin) - begin);
  }
};

struct HttpReply {
  int status = 200;
  std::string body;
  std::string headers;  // further ones, each with its line end
  std::chrono::milliseconds delay{0};
  bool lost = false;  // no answer at all
};

class HttpServer {
 public:
  using Clock = std::chrono::steady_clock;
  using Answer = std::function<HttpReply(const HttpMessage&)>;

  explicit HttpServer(Answer answer) : answer_(std::move(answer)) {
    listen_on(0);
    thread_ = std::thread([this] { run(); });
  }
  ~HttpServer() {
    end_ = true;
    thread_.join();
    close_all();
  }
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;
  int port() const { return port_; }
  // Silent: requests are read, neither obeyed nor answered. Gone: connections are refused.
  void set_silent(bool silent) { silent_ = silent; }
  void set_gone(bool gone) { gone_ = gone; }

 private:
  struct Connection {
    int fd;
    std::string in;
    struct Late {
      Clock::time_point due;
      std::string bytes;
    };
    std::vector<Late> out;
  };

  void listen_on(int port) {
    listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    const int yes = 1;
    ::setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_port = htons(static_cast<std::uint16_t>(port));
    at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof at;
    if (::bind(listener_, reinterpret_cast<sockaddr*>(&at), size) != 0 || ::listen(listener_, 16) != 0)
      std::abort();
    ::getsockname(listener_, reinterpret_cast<sockaddr*>(&at), &size);
    port_ = ntohs(at.sin_port);
  }
  void close_all() {
    for (const Connection& connection : connections_) ::close(connection.fd);
    connections_.clear();
    if (listener_ >= 0) ::close(listener_);
    listener_ = -1;
  }

  void run() {
    while (!end_) {
      if (gone_ && listener_ >= 0) close_all();
      if (!gone_ && listener_ < 0) listen_on(port_);
      std::vector<pollfd> fds{{listener_, POLLIN, 0}};
      for (const Connection& connection : connections_) fds.push_back({connection.fd, POLLIN, 0});
      ::poll(fds.data(), fds.size(), 2);
      for (std::size_t i = connections_.size(); i-- > 0;)
        if (!serve(connections_[i], fds[i + 1].revents != 0)) {
          ::close(connections_[i].fd);
          connections_.erase(connections_.begin() + static_cast<std::ptrdiff_t>(i));
        }
      if (listener_ >= 0 && fds[0].revents)
        connections_.push_back({::accept(listener_, nullptr, nullptr), {}, {}});
    }
  }

  // False: the far side has closed the connection.
  bool serve(Connection& connection, bool readable) {
    if (readable) {
      char bytes[8192];
      const ssize_t got = ::recv(connection.fd, bytes, sizeof bytes, MSG_DONTWAIT);
      if (got <= 0) return false;
      connection.in.append(bytes, static_cast<std::size_t>(got));
    }
    while (take(connection)) continue;
    for (std::size_t i = 0; i < connection.out.size();) {
      if (connection.out[i].due > Clock::now()) {
        ++i;
        continue;
      }
      const std::string& bytes = connection.out[i].bytes;
      ::send(connection.fd, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      connection.out.erase(connection.out.begin() + static_cast<std::ptrdiff_t>(i));
    }
    return true;
  }

  bool take(Connection& connection) {
    const auto end = connection.in.find("\r\n\r\n");
    if (end == std::string::npos) return false;
    HttpMessage message;
    message.headers = connection.in.substr(0, end + 2);
    const std::size_t length = std::strtoul(message.header("Content-Length").c_str(), nullptr, 10);
    if (connection.in.size() < end + 4 + length) return false;
    message.body = connection.in.substr(end + 4, length);
    connection.in.erase(0, end + 4 + length);
    const auto from = message.headers.find(' ') + 1;
    message.path = message.headers.substr(from, message.headers.find(' ', from) - from);
    if (silent_) return true;
    const HttpReply reply = answer_(message);
    if (reply.lost) return true;
    std::string bytes = "HTTP/1.1 " + std::to_string(reply.status) + (reply.status == 200 ? " OK" : " No") +
                        "\r\nContent-Type: application/soap+xml; charset=utf-8\r\n" + reply.headers +
                        "Content-Length: " + std::to_string(reply.body.size()) + "\r\n\r\n" + reply.body;
    connection.out.push_back({Clock::now() + reply.delay, std::move(bytes)});
    return true;
  }

  Answer answer_;
  int listener_ = -1, port_ = 0;
  std::vector<Connection> connections_;
  std::atomic<bool> end_{false}, silent_{false}, gone_{false};
  std::thread thread_;
};

}  // namespace cerberus::tests
