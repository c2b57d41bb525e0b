// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/helper/helper_head.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <vector>

#include "drivers/helper/helper_client.h"
#include "drivers/helper/helper_process.h"
#include "drivers/helper/option_words.h"
#include "drivers/helper/passwords.h"
#include "drivers/helper/program_check.h"
#include "text/numbers.h"

namespace cerberus::drivers {
namespace {

using motion::Pose;
using Clock = std::chrono::steady_clock;

struct Parameters {
  Time ready_timeout = std::chrono::seconds(5);  // derived: a slow network camera logs in within it
  Time restart_delay =
      std::chrono::seconds(1);  // derived: issue "used again when it returns", without a busy loop
  // For a helper that was refused, which has moved nothing; derived: the error comes before users give up.
  std::chrono::milliseconds refused_patience{500};
};
constexpr Parameters kParameters;
constexpr std::string_view kFault = "fault ";  // what such an answer of a helper begins with

// HeadSetup::options as words; blanks part them, single quotes keep them.
std::vector<std::string> own_helper(const std::string& driver, const HeadSetup& setup) {
  std::vector<std::string> words{setup.helper, driver, "--device=" + setup.device};
  for (const std::string& word : quoted_words(setup.options)) words.push_back("--" + word);
  return words;
}

// What is wrong with the settings that every helper has.
std::string settings_fault(const std::string& driver, const HeadSetup& setup) {
  const bool external = driver == "external";
  if (external && setup.command.empty()) return "the driver external needs a helper to run (command=)";
  if (!external && setup.device.empty()) return "the driver " + driver + " needs a device (device=)";
  if (setup.lock_zoom && driver != "visca" && driver != "v4l2" && driver != "onvif")
    return "the driver " + driver + " keeps no zoom: lock-zoom is for visca, v4l2 and onvif";
  for (const std::string& setting : {setup.device, setup.options})
    if (std::string wrong = refuse_password(setting); !wrong.empty()) return wrong;
  if (setup.helper_timeout < std::chrono::milliseconds(1) || setup.helper_timeout > std::chrono::seconds(10))
    return "helper-timeout must be 1 ms to 10 s, and is " +
           text::significant(motion::seconds(setup.helper_timeout), 6).string() + " s";
  return {};
}

Time since_start(Clock::time_point at) {
  return std::chrono::duration_cast<Time>(at.time_since_epoch());
}

}  // namespace

// Shared with the thread that talks to the helper. `lock` guards everything.
struct HelperHead::Core {
  std::mutex lock;
  std::condition_variable answered;
  HelperClient client{[this](const std::string& line) { send(line); }};
  std::vector<std::string> arguments;
  std::string name;  // of the helper, for messages
  HelperProcess process;
  LineBuffer lines;
  bool open = false, ended = false, fails = false;
  Time epoch{};  // running time 0 on the steady clock
  Time next_alive{}, next_start{};
  int wake = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);

  ~Core() { ::close(wake); }
  void run();
  std::string start();
  void start_again();
  void lose(const std::string& why);
  bool read_lines();
  void send(const std::string& line);
  void poke() const {
    const std::uint64_t one = 1;
    [[maybe_unused]] const ssize_t written = ::write(wake, &one, sizeof one);
  }
  Time running_time() const { return since_start(Clock::now()) - epoch; }
};

std::string HelperHead::Core::start() {
  lines = {};
  next_alive = Time{};
  if (std::string wrong = process.start(arguments); !wrong.empty()) return wrong;
  client.begin(running_time());
  return {};
}

void HelperHead::Core::start_again() {
  if (const std::string wrong = start(); !wrong.empty()) lose(wrong);
}

// The helper ended, or does not read any more. A command starts it again after restart_delay.
void HelperHead::Core::lose(const std::string& why) {
  process.hang_up();
  const std::string helper = "the head's helper `" + name + "` ";
  client.lose(why == client.fault() ? why
              : open                ? helper + "is gone: " + why
                     : helper + "did not become ready: " + why + " (its standard error may say why)");
  next_start = since_start(Clock::now()) + kParameters.restart_delay;
  answered.notify_all();
}

void HelperHead::Core::send(const std::string& line) {
  if (!process.running() || process.send(line)) return;
  const bool full = errno == EAGAIN || errno == EWOULDBLOCK;
  if (std::exchange(fails, true)) return;  // what answers its last lines
  read_lines();                            // which may contain the reason
  fails = false;
  lose(!client.fault().empty() ? client.fault() : full ? "it does not read its input" : "it ended");
}

// False: the helper has closed its end.
bool HelperHead::Core::read_lines() {
  std::string bytes;
  const bool alive = process.receive(bytes);
  lines.append(bytes);
  while (const auto text = lines.take()) client.handle(*text, running_time());
  answered.notify_all();
  return alive;
}

void HelperHead::Core::run() {
  std::unique_lock guard(lock);
  while (!ended) {
    const Time now = since_start(Clock::now());
    if (process.running() && now >= next_alive) {
      next_alive = now + client.setup().helper_timeout / 4;
      send("alive\n");
    }
    const Time due = client.serve(running_time());
    // A helper that ended may have left its head turning: only a new one can stop it.
    if (!process.running() && now >= next_start && process.end()) start_again();
    Time until = process.running() ? next_alive : now + kParameters.restart_delay;
    if (due != motion::kNever) until = std::min(until, due + epoch);
    const auto wait = std::chrono::ceil<std::chrono::milliseconds>(until - since_start(Clock::now()));
    pollfd fds[2]{{wake, POLLIN, 0}, {process.fd(), POLLIN, 0}};  // a negative descriptor is skipped
    guard.unlock();
    ::poll(fds, 2, static_cast<int>(std::clamp<long>(wait.count(), 0, 1000)));
    guard.lock();
    std::uint64_t count;
    [[maybe_unused]] const ssize_t drained = ::read(wake, &count, sizeof count);
    if (fds[1].revents && process.fd() == fds[1].fd && !read_lines())
      lose(client.fault().empty() ? "it ended" : client.fault());
  }
  send("stop\nquit\n");
  guard.unlock();
  process.finish();
}

std::vector<std::string> helper_arguments(const std::string& driver, const HeadSetup& setup) {
  if (driver == "external") return {"/bin/sh", "-c", "exec " + setup.command};
  return own_helper(driver, setup);
}

HelperHead::~HelperHead() {
  close();
}

// Asks the helper, too, which knows its options.
std::string HelperHead::check(const HeadSetup& setup) const {
  if (std::string wrong = settings_fault(driver_, setup); !wrong.empty()) return wrong;
  if (driver_ == "external") {
    const std::string wrong = command_fault(setup.command);
    return wrong.empty() ? wrong : "the command: " + wrong;
  }
  std::vector<std::string> words = helper_arguments(driver_, setup);
  words.insert(words.begin() + 1, "--check");
  const std::string said = first_line_of(words);
  return said.starts_with(kFault) ? said.substr(kFault.size()) + " (device-options)" : "";
}

std::string HelperHead::open(const HeadSetup& setup) {
  close();
  if (std::string wrong = settings_fault(driver_, setup); !wrong.empty()) return wrong;
  const bool external = driver_ == "external";
  auto core = std::make_shared<Core>();
  std::unique_lock guard(core->lock);
  if (std::string wrong = core->client.open(setup); !wrong.empty()) return wrong;
  core->arguments = helper_arguments(driver_, setup);
  // Not the whole command: its arguments may hold a password.
  core->name = external ? setup.command.substr(0, setup.command.find(' ')) : driver_ + " of " + setup.device;
  core->epoch = since_start(Clock::now());
  if (std::string wrong = core->start(); !wrong.empty()) return wrong;
  core_ = core;
  worker_.emplace([core] { core->run(); });
  const auto over = [&] { return core->client.ready() || !core->client.fault().empty(); };
  const bool came = core->answered.wait_for(guard, kParameters.ready_timeout, over);
  core->open = core->client.ready();
  const std::string fault = core->client.fault(), name = core->name;
  guard.unlock();
  if (core->open) return {};
  leave(came ? Clock::duration(kParameters.refused_patience) : 2 * HelperProcess::kPatience);
  return came ? fault : "the head's helper `" + name + "` does not answer with `ready 1 ...`";
}

void HelperHead::close() noexcept {
  leave(2 * HelperProcess::kPatience);
}

// A helper that does not end within `patience` is left to its thread.
void HelperHead::leave(std::chrono::steady_clock::duration patience) noexcept {
  if (!core_) return;
  {
    const std::lock_guard guard(core_->lock);
    core_->ended = true;
    core_->open = false;
  }
  core_->poke();
  if (worker_) worker_->leave(patience);
  worker_.reset();
  core_.reset();
}

void HelperHead::stop(Time now) noexcept {
  if (!core_) return;
  const std::lock_guard guard(core_->lock);
  core_->client.stop(now);
}

std::string HelperHead::command(const HeadCommand& command) {
  if (!core_ || !core_->open) return "the head's helper is not open";
  const std::lock_guard guard(core_->lock);
  Core& c = *core_;
  if (std::string wrong = c.client.accept(command); !wrong.empty()) return wrong;
  c.epoch = since_start(Clock::now()) - command.time;
  if (!c.process.running() && since_start(Clock::now()) >= c.next_start) c.start_again();
  std::string wrong = c.client.execute(c.running_time());
  c.poke();
  return wrong;
}

std::string HelperHead::limit(Time now, const motion::Limits& limits) {
  if (!core_ || !core_->open) return "the head's helper is not open";
  const std::lock_guard guard(core_->lock);
  std::string wrong = core_->client.limit(now, limits);
  core_->poke();
  return wrong;
}

bool HelperHead::emergency() {
  if (!core_) return false;
  const std::lock_guard guard(core_->lock);
  return core_->client.emergency();
}

std::string HelperHead::fault() {
  if (!core_ || !core_->open) return {};
  const std::lock_guard guard(core_->lock);
  return core_->client.fault_at_rest();
}

std::string HelperHead::home(Time now) {
  if (!core_ || !core_->open) return "the head's helper is not open";
  const std::lock_guard guard(core_->lock);
  return core_->client.home(now);
}

std::string HelperHead::state(Time time, Pose& pose) {
  if (!core_ || !core_->open) return "the head's helper is not open";
  const std::lock_guard guard(core_->lock);
  return core_->client.state(time, pose);
}

}  // namespace cerberus::drivers
