// SPDX-License-Identifier: LGPL-2.1-or-later
#include "mqtt_client.hpp"

#include <mosquitto.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <deque>
#include <map>
#include <mutex>
#include <thread>
#include <utility>

namespace cerberus::plugin {

namespace {

constexpr int kKeepalive = 10;              // seconds; the broker sends the will after 15
constexpr std::size_t kMostWaiting = 1000;  // messages that are not retained
constexpr std::chrono::seconds kBetweenTries{1}, kPatience{2}, kFlush{1};
constexpr std::size_t kLongestPayload = 256;       // bytes of a command
constexpr std::size_t kLongestMessage = 4u << 20;  // bytes of any other message: a picture

struct Library {
  Library() { mosquitto_lib_init(); }
};

}  // namespace

class MqttClient::Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(MqttServer server, Listener listener)
      : server_(std::move(server)),
        listener_(std::move(listener)),
        wake_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {}
  ~Connection() {
    if (client_ != nullptr) mosquitto_destroy(client_);
    if (wake_ >= 0) ::close(wake_);
  }

  void start() {
    // The thread keeps the connection alive, also where stop() did not wait for it.
    std::thread([self = shared_from_this()] { self->run(); }).detach();
  }

  void publish(publish::MqttMessage message) {
    {
      const std::lock_guard guard(lock_);
      if (message.retain)
        retained_[message.topic] = {std::move(message.payload), true};
      else if (connected_ && waiting_.size() < kMostWaiting)
        waiting_.push_back(std::move(message));
    }
    wake();
  }

  bool is_settled() {
    const std::lock_guard guard(lock_);
    return connected_ && waiting_.empty() && unacknowledged_ == 0 &&
           std::ranges::none_of(retained_, [](const auto& one) { return one.second.due; });
  }

  void stop() {
    {
      // A callback that runs now ends first; none begins afterwards.
      const std::lock_guard callbacks(callback_lock_);
      listener_ = {};
    }
    std::unique_lock guard(lock_);
    quit_ = true;
    pause_.notify_all();
    wake();
    ended_.wait_for(guard, kPatience, [this] { return done_; });
  }

 private:
  struct Retained {
    std::string payload;
    bool due = true;
  };

  void wake() const {
    const std::uint64_t one = 1;
    [[maybe_unused]] const ssize_t written = ::write(wake_, &one, sizeof one);
  }

  void run() {
    static const Library library;
    // OpenSSL writes to sockets without MSG_NOSIGNAL: a broker that is gone must not end the process by SIGPIPE.
    sigset_t pipe;
    sigemptyset(&pipe);
    sigaddset(&pipe, SIGPIPE);
    pthread_sigmask(SIG_BLOCK, &pipe, nullptr);
    while (!quits()) {
      if (client_ != nullptr || make()) {
        const int result = mosquitto_connect(client_, server_.host.c_str(), server_.port, kKeepalive);
        if (result == MOSQ_ERR_SUCCESS)
          serve();
        else
          fault(result == MOSQ_ERR_ERRNO ? std::strerror(errno) : mosquitto_strerror(result));
      }
      std::unique_lock guard(lock_);
      connected_ = false;
      waiting_.clear();
      for (auto& [topic, message] : retained_) message.due = true;
      if (!quit_) pause_.wait_for(guard, kBetweenTries, [this] { return quit_; });
    }
    const std::lock_guard guard(lock_);
    done_ = true;
    ended_.notify_all();
  }

  bool make() {
    client_ = mosquitto_new(server_.client.empty() ? nullptr : server_.client.c_str(), true, this);
    if (client_ == nullptr) {
      fault("the library gives no client");
      return false;
    }
    if (!server_.status.empty()) mosquitto_will_set(client_, server_.status.c_str(), 7, "offline", 1, true);
    int result = MOSQ_ERR_SUCCESS;
    if (!server_.user.empty())
      result = mosquitto_username_pw_set(client_, server_.user.c_str(), server_.password.c_str());
    if (result == MOSQ_ERR_SUCCESS && !server_.ca_file.empty())
      result = mosquitto_tls_set(client_, server_.ca_file.c_str(), nullptr, nullptr, nullptr, nullptr);
    if (result != MOSQ_ERR_SUCCESS) {
      fault(result == MOSQ_ERR_ERRNO ? std::strerror(errno) : mosquitto_strerror(result));
      mosquitto_destroy(std::exchange(client_, nullptr));
      return false;
    }
    mosquitto_connect_callback_set(
        client_, [](mosquitto*, void* self, int code) { static_cast<Connection*>(self)->on_connect(code); });
    mosquitto_publish_callback_set(
        client_, [](mosquitto*, void* self, int) { --static_cast<Connection*>(self)->unacknowledged_; });
    mosquitto_message_callback_set(client_, [](mosquitto*, void* self, const mosquitto_message* message) {
      static_cast<Connection*>(self)->on_message(*message);
    });
    return true;
  }

  // Until the connection is lost or stop() is called.
  void serve() {
    int result = MOSQ_ERR_SUCCESS;
    while (result == MOSQ_ERR_SUCCESS) {
      if (quits()) {
        send_waiting();
        if (is_connected() && !server_.status.empty()) send({server_.status, "offline", true});
        flush();
        mosquitto_disconnect(client_);
        while (mosquitto_want_write(client_) && mosquitto_loop_write(client_, 1) == MOSQ_ERR_SUCCESS) {
        }
        return;
      }
      send_waiting();
      pollfd files[2] = {{mosquitto_socket(client_), POLLIN, 0}, {wake_, POLLIN, 0}};
      if (mosquitto_want_write(client_)) files[0].events |= POLLOUT;
      ::poll(files, 2, 1000);
      std::uint64_t count = 0;
      while (::read(wake_, &count, sizeof count) > 0) {
      }
      if (files[0].revents & (POLLIN | POLLHUP | POLLERR)) result = mosquitto_loop_read(client_, 1);
      if (result == MOSQ_ERR_SUCCESS && mosquitto_want_write(client_))
        result = mosquitto_loop_write(client_, 1);
      if (result == MOSQ_ERR_SUCCESS) result = mosquitto_loop_misc(client_);
    }
    if (!refused_) fault(result == MOSQ_ERR_ERRNO ? std::strerror(errno) : mosquitto_strerror(result));
    mosquitto_disconnect(client_);
  }

  // Gives what is unsent to the socket until the broker has acknowledged all of it: the library keeps back what is more
  // than 20 messages ahead.
  void flush() {
    const auto end = std::chrono::steady_clock::now() + kFlush;
    int result = MOSQ_ERR_SUCCESS;
    while (result == MOSQ_ERR_SUCCESS && unacknowledged_ > 0 && std::chrono::steady_clock::now() < end) {
      pollfd file{mosquitto_socket(client_), POLLIN, 0};
      if (mosquitto_want_write(client_)) file.events |= POLLOUT;
      ::poll(&file, 1, 100);
      if (file.revents & (POLLIN | POLLHUP | POLLERR)) result = mosquitto_loop_read(client_, 1);
      if (result == MOSQ_ERR_SUCCESS && mosquitto_want_write(client_))
        result = mosquitto_loop_write(client_, 1);
    }
  }

  void send(const publish::MqttMessage& message) {
    ++unacknowledged_;
    give(message);
  }
  void give(const publish::MqttMessage& message) {
    const int result =
        mosquitto_publish(client_, nullptr, message.topic.c_str(), static_cast<int>(message.payload.size()),
                          message.payload.data(), 1, message.retain);
    if (result != MOSQ_ERR_SUCCESS) --unacknowledged_;
  }

  void on_connect(int code) {
    refused_ = code != 0;
    if (refused_) {
      fault(mosquitto_connack_string(code));
      return;
    }
    reported_ = false;
    if (!server_.status.empty()) send({server_.status, "online", true});
    for (const std::string& topic : server_.topics) mosquitto_subscribe(client_, nullptr, topic.c_str(), 1);
    if (!server_.commands.empty()) mosquitto_subscribe(client_, nullptr, (server_.commands + '+').c_str(), 1);
    const std::lock_guard guard(lock_);
    connected_ = true;
  }

  // Retained orders are old ones: their senders may not want them any more.
  void on_message(const mosquitto_message& message) {
    const std::string topic = message.topic;
    const bool command = !server_.commands.empty() && topic.starts_with(server_.commands);
    if (command && message.retain) return;
    if (!command && message.payloadlen > static_cast<int>(kLongestMessage)) return;
    const std::size_t size = std::min(command ? kLongestPayload : kLongestMessage,
                                      static_cast<std::size_t>(std::max(message.payloadlen, 0)));
    std::string payload(static_cast<const char*>(message.payload), size);
    const std::lock_guard callbacks(callback_lock_);
    if (!command) {
      if (listener_.on_message) listener_.on_message(topic, std::move(payload));
      return;
    }
    if (listener_.on_command) listener_.on_command(topic.substr(server_.commands.size()), payload);
  }

  void send_waiting() {
    std::deque<publish::MqttMessage> all;
    {
      const std::lock_guard guard(lock_);
      if (!connected_) return;
      for (auto& [topic, message] : retained_)
        if (std::exchange(message.due, false)) all.push_back({topic, message.payload, true});
      for (publish::MqttMessage& message : waiting_) all.push_back(std::move(message));
      waiting_.clear();
      unacknowledged_ += static_cast<int>(all.size());
    }
    for (const publish::MqttMessage& message : all) give(message);
  }

  void fault(const std::string& text) {
    if (std::exchange(reported_, true)) return;
    const std::lock_guard callbacks(callback_lock_);
    if (listener_.on_fault) listener_.on_fault(text);
  }
  bool quits() {
    const std::lock_guard guard(lock_);
    return quit_;
  }
  bool is_connected() {
    const std::lock_guard guard(lock_);
    return connected_;
  }

  const MqttServer server_;
  std::atomic<int> unacknowledged_ =
      0;                         // messages; the library sends them again after a loss of the connection
  mosquitto* client_ = nullptr;  // this and the next two: the client's thread only
  bool reported_ = false, refused_ = false;
  std::mutex callback_lock_;  // of listener_, held while it is called; never together with lock_
  Listener listener_;
  int wake_;

  std::mutex lock_;  // of what follows
  std::condition_variable pause_, ended_;
  bool connected_ = false, quit_ = false, done_ = false;
  std::deque<publish::MqttMessage> waiting_;
  std::map<std::string, Retained> retained_;
};

MqttClient::MqttClient() = default;

MqttClient::~MqttClient() {
  stop();
}

void MqttClient::start(const MqttServer& server, Listener listener) {
  stop();
  auto connection = std::make_shared<Connection>(server, std::move(listener));
  connection->start();
  const std::lock_guard guard(lock_);
  connection_ = std::move(connection);
}

void MqttClient::publish(publish::MqttMessage message) {
  std::shared_ptr<Connection> connection;
  {
    const std::lock_guard guard(lock_);
    connection = connection_;
  }
  if (connection) connection->publish(std::move(message));
}

bool MqttClient::is_settled() const {
  const std::lock_guard guard(lock_);
  return connection_ && connection_->is_settled();
}

void MqttClient::stop() {
  std::shared_ptr<Connection> connection;
  {
    const std::lock_guard guard(lock_);
    connection = std::exchange(connection_, nullptr);
  }
  if (connection) connection->stop();
}

}  // namespace cerberus::plugin
