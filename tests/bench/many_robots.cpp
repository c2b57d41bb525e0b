// SPDX-License-Identifier: LGPL-2.1-or-later
// 100 robots at one mosquitto on loopback: what the broker needs, what is lost, how late messages are.
//
//   bench-many_robots [ROBOTS [SECONDS]]
//
// Each robot publishes what mqttpublish would of a busy place: a person in sight who is updated once a second, a head that
// moves, a rule that changes. One subscriber reads all. Skipped (77) where mosquitto is not installed.
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "publish/mqtt_client.hpp"
#include "publish/mqtt_report.h"

namespace {

using namespace cerberus;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;
using std::chrono::seconds;

// Processor time of a process in seconds: utime and stime of proc(5).
double cpu_seconds(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string text((std::istreambuf_iterator<char>(file)), {});
  unsigned long user = 0, system = 0;
  const std::size_t end = text.rfind(')');
  if (end == text.npos ||
      std::sscanf(text.c_str() + end + 1, " %*c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %lu %lu", &user,
                  &system) != 2)
    return 0;
  return static_cast<double>(user + system) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

std::int64_t now_ns() {
  return std::chrono::duration_cast<nanoseconds>(Clock::now().time_since_epoch()).count();
}

struct Broker {
  pid_t process = -1;
  std::filesystem::path folder;
  int port = 0;

  bool start() {
    char name[] = "/tmp/many-robots-XXXXXX";
    if (mkdtemp(name) == nullptr) return false;
    folder = name;
    port = 20000 + static_cast<int>(getpid() % 20000);
    // Queues hold what a burst of all robots makes.
    std::ofstream(folder / "mosquitto.conf")
        << "listener " << port << " 127.0.0.1\nallow_anonymous true\npersistence false\n"
        << "max_queued_messages 100000\nmax_inflight_messages 1000\n";
    process = fork();
    if (process == 0) {
      const std::string file = (folder / "mosquitto.conf").string();
      [[maybe_unused]] const bool quiet = freopen("/dev/null", "w", stderr) != nullptr;
      setenv("PATH", "/usr/sbin:/usr/bin:/sbin:/bin", 1);
      execlp("mosquitto", "mosquitto", "-c", file.c_str(), nullptr);
      _exit(127);
    }
    return process > 0;
  }
  ~Broker() {
    if (process > 0) {
      kill(process, SIGTERM);
      waitpid(process, nullptr, 0);
    }
    std::error_code ignored;
    if (!folder.empty()) std::filesystem::remove_all(folder, ignored);
  }
};

// The track's bearing carries the number of the message, and its utc is replaced by the time of sending.
struct Received {
  std::mutex lock;
  std::vector<double> delays;  // ms
  std::size_t messages = 0, tracks = 0;
};

}  // namespace

int main(int argc, char** argv) {
  const int robots = argc > 1 ? std::atoi(argv[1]) : 100, length = argc > 2 ? std::atoi(argv[2]) : 20;
  Broker broker;
  if (!broker.start()) return 1;
  std::this_thread::sleep_for(milliseconds(500));
  if (waitpid(broker.process, nullptr, WNOHANG) != 0) {
    broker.process = -1;
    std::puts("skipped: mosquitto is not installed");
    return 77;
  }
  Received received;
  plugin::MqttClient subscriber;
  plugin::MqttServer all;
  all.host = "127.0.0.1";
  all.port = broker.port;
  all.topics = {"cerberus/+/+"};
  subscriber.start(all, {.on_command = {},
                         .on_message =
                             [&](const std::string& topic, const std::string& payload) {
                               const std::lock_guard guard(received.lock);
                               ++received.messages;
                               if (!topic.ends_with("/track")) return;
                               ++received.tracks;
                               const std::size_t at = payload.find("\"sent\":");
                               std::int64_t sent = 0;
                               if (at != payload.npos)
                                 std::from_chars(payload.data() + at + 7, payload.data() + payload.size(),
                                                 sent);
                               if (sent != 0)
                                 received.delays.push_back(static_cast<double>(now_ns() - sent) / 1e6);
                             },
                         .on_fault = {}});
  std::vector<std::unique_ptr<plugin::MqttClient>> clients;
  std::vector<publish::MqttReport> reports;
  std::atomic<int> faults = 0;
  for (int k = 0; k < robots; ++k) {
    const std::string name = "robot" + std::to_string(k);
    plugin::MqttServer server;
    server.host = "127.0.0.1";
    server.port = broker.port;
    server.status = "cerberus/" + name + "/status";
    reports.emplace_back("cerberus", name);
    clients.push_back(std::make_unique<plugin::MqttClient>());
    clients.back()->start(
        server, {.on_command = {}, .on_message = {}, .on_fault = [&](const std::string&) { ++faults; }});
  }
  // All are connected when each status has arrived.
  const Clock::time_point patience = Clock::now() + seconds(60);
  for (;;) {
    {
      const std::lock_guard guard(received.lock);
      if (received.messages >= static_cast<std::size_t>(robots)) break;
    }
    if (Clock::now() > patience) {
      std::puts("many_robots: the robots do not connect");
      return 1;
    }
    std::this_thread::sleep_for(milliseconds(50));
  }
  {
    const std::lock_guard guard(received.lock);
    received.messages = received.tracks = 0;
  }
  const double cpu_before = cpu_seconds(broker.process);
  const Clock::time_point begin = Clock::now();
  std::size_t published = 0, tracks = 0;
  constexpr int kFrames = 10;  // a second
  for (int frame = 0; frame < length * kFrames; ++frame) {
    for (int k = 0; k < robots; ++k) {
      publish::MqttObject person;
      person.id = static_cast<std::uint32_t>(1 + frame / (30 * kFrames));  // another one every half minute
      person.type = "person";
      person.kind = "person-like";
      person.state = "seen";
      person.x = frame;
      person.bearing = k;
      publish::MqttFrame facts;
      facts.time = milliseconds(1000 / kFrames) * (frame + 1);
      facts.analysed = true;
      facts.objects = {&person, 1};
      facts.head = publish::MqttFrame::Head{static_cast<double>(frame % 90), 0, true};
      facts.decision = publish::MqttFrame::Decision{1 + frame / 20 % 2, "camera", "track", 1};
      for (publish::MqttMessage& message : reports[static_cast<std::size_t>(k)].update(facts)) {
        if (message.topic.ends_with("/track")) {
          ++tracks;
          message.payload.insert(1, "\"sent\":" + std::to_string(now_ns()) + ",");
        }
        ++published;
        clients[static_cast<std::size_t>(k)]->publish(std::move(message));
      }
    }
    std::this_thread::sleep_until(begin + milliseconds(1000 / kFrames) * (frame + 1));
  }
  const double took = std::chrono::duration<double>(Clock::now() - begin).count();
  const double cpu = cpu_seconds(broker.process) - cpu_before;
  for (std::size_t before = 0;;) {  // until nothing more arrives
    std::this_thread::sleep_for(seconds(1));
    const std::lock_guard guard(received.lock);
    if (received.messages == before) break;
    before = received.messages;
  }
  for (auto& client : clients) client->stop();
  subscriber.stop();
  std::ranges::sort(received.delays);
  const auto share = [&](double of) {
    return received.delays.empty()
               ? 0.
               : received
                     .delays[static_cast<std::size_t>(of * static_cast<double>(received.delays.size() - 1))];
  };
  std::printf("many_robots: %d robots, %.0f s: %zu messages (%.0f a second), broker %.1f %% of a core\n",
              robots, took, published, static_cast<double>(published) / took, 100 * cpu / took);
  std::printf(
      "many_robots: tracks: %zu sent, %zu lost; delay median %.1f ms, 99 %% %.1f ms, most %.1f ms; %d "
      "faults\n",
      tracks, tracks - std::min(tracks, received.tracks), share(.5), share(.99), share(1), faults.load());
  // Track events are sent with QoS 1: none is lost at a broker that lives. Retained states may be overtaken by newer ones.
  return received.tracks == tracks && faults == 0 ? 0 : 1;
}
