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

#include "drivers/head/reach.h"
#include "drivers/helper/helper_client.h"
#include "drivers/helper/helper_process.h"
#include "drivers/helper/helper_watch.h"
#include "drivers/helper/option_words.h"
#include "drivers/helper/passwords.h"
#include "drivers/helper/program_check.h"
#include "text/numbers.h"

namespace cerberus::drivers {
namespace {

using motion::Pose;
using Clock = std::chrono::steady_clock;

struct Parameters {
  // From one start to the next; derived: used again when it returns, without a busy loop.
  Time restart_delay = std::chrono::seconds(1);
  // From one `alive` to the next at most, however long the helper's timeout is; derived: half of what its answer may take.
  Time alive_period = std::chrono::milliseconds(250);
  // For a helper that was refused, which has moved nothing; derived: the error comes before users give up.
  std::chrono::milliseconds refused_patience{500};
};
constexpr Parameters kParameters;
constexpr std::string_view kFault = "fault ";  // what such an answer of a helper begins with
// While a helper ends it is looked at this often.
constexpr std::chrono::milliseconds kLook{20};

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
  if (setup.moves_zoom && !external && driver != "visca" && driver != "pelco-d" && driver != "v4l2" &&
      driver != "onvif")
    return "the driver " + driver +
           " moves no zoom: keep-size is for visca, pelco-d, v4l2, onvif, external and simulated";
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
  HelperWatch watch;
  bool open = false, ended = false, fails = false;
  bool was_ready = false;  // a helper was: the head may have been turned
  Time epoch{};            // running time 0 on the steady clock
  Time next_alive{}, started{}, next_start{};
  int wake = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);

  ~Core() { ::close(wake); }
  void run();
  std::string start();
  void start_again();
  void lose(const std::string& why);
  void lose_hung(const std::string& why);
  void ask_alive(Time now);
  void check_hung(Time now);
  void wait(std::unique_lock<std::mutex>& guard, Time until);
  void finish(std::unique_lock<std::mutex>& guard);
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
  started = since_start(Clock::now());
  watch.begin(started);
  if (std::string wrong = process.start(arguments); !wrong.empty()) return wrong;
  client.begin(running_time());
  return {};
}

void HelperHead::Core::start_again() {
  if (const std::string wrong = start(); !wrong.empty()) lose(wrong);
}

// The helper ended. It is started again after restart_delay.
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
  if (full) return lose_hung("it does not read its input");
  lose(!client.fault().empty() ? client.fault() : "it ended");
}

// The helper hangs. Before it was ready it has moved nothing; else it may have left its head turning. Another one is started as soon as it is gone, unless it was started
// within the last restart_delay.
void HelperHead::Core::lose_hung(const std::string& why) {
  process.kill();
  client.lose("the head's helper `" + name + "` " +
              (open ? "hangs: " + why + ". It was killed, and is started again to stop the head"
                    : "does not answer with `ready 1 ...`: " + why + ". It was killed"));
  next_start = (open ? started : since_start(Clock::now())) + kParameters.restart_delay;
  answered.notify_all();
}

void HelperHead::Core::ask_alive(Time now) {
  next_alive = now + std::min(client.setup().helper_timeout / 4, kParameters.alive_period);
  send(std::string(kAlive) + '\n');
  watch.ask();
}

// Called after the lines that have come were read.
void HelperHead::Core::check_hung(Time now) {
  if (!process.running()) return;
  if (const std::string why = watch.judge(now, client.turns(running_time())); !why.empty()) lose_hung(why);
}

// False: the helper has closed its end.
bool HelperHead::Core::read_lines() {
  std::string bytes;
  const bool alive = process.receive(bytes);
  lines.append(bytes);
  while (const auto text = lines.take())
    if (const auto line = client.handle(*text, running_time())) watch.take(*line);
  was_ready = was_ready || client.ready();
  answered.notify_all();
  return alive;
}

// Waits for lines, for poke() and until `until` on the steady clock, and reads the lines.
void HelperHead::Core::wait(std::unique_lock<std::mutex>& guard, Time until) {
  const auto patience = std::chrono::ceil<std::chrono::milliseconds>(until - since_start(Clock::now()));
  pollfd fds[2]{{wake, POLLIN, 0}, {process.fd(), POLLIN, 0}};  // a negative descriptor is skipped
  guard.unlock();
  ::poll(fds, 2, static_cast<int>(std::clamp<long>(patience.count(), 0, 1000)));
  guard.lock();
  std::uint64_t count;
  [[maybe_unused]] const ssize_t drained = ::read(wake, &count, sizeof count);
  if (fds[1].revents && process.fd() == fds[1].fd && !read_lines())
    lose(client.fault().empty() ? "it ended" : client.fault());
}

void HelperHead::Core::run() {
  std::unique_lock guard(lock);
  while (!ended) {
    const Time now = since_start(Clock::now());
    if (process.running() && now >= next_alive) ask_alive(now);
    const Time due = client.serve(running_time());
    // A helper that ended may have left its head turning: only a new one can stop it.
    if (!process.running() && now >= next_start && process.end()) start_again();
    Time until = process.running() ? next_alive : std::max(next_start, now + kLook);
    if (process.running() && watch.waits()) until = std::min(until, now + HelperWatch::kPeriod);
    if (due != motion::kNever) until = std::min(until, due + epoch);
    wait(guard, until);
    check_hung(since_start(Clock::now()));
  }
  finish(guard);
}

// Stops the head and ends the helper. One that hangs or is gone is replaced by another one, which stops the head.
void HelperHead::Core::finish(std::unique_lock<std::mutex>& guard) {
  const auto settle = [&] {
    while (process.running() && watch.waits()) {
      wait(guard, since_start(Clock::now()) + kLook);
      check_hung(since_start(Clock::now()));
    }
  };
  send("stop\n");
  if (was_ready && process.running()) {
    ask_alive(since_start(Clock::now()));
    settle();
  }
  if (was_ready && !process.running()) {
    guard.unlock();
    process.finish();
    guard.lock();
    start_again();
    settle();
    send("stop\n");
  }
  send("quit\n");
  guard.unlock();
  process.finish();
}

std::string helper_name(const std::string& driver, const HeadSetup& setup) {
  if (driver == "external") return setup.command.substr(0, setup.command.find(' '));
  return setup.helper.substr(setup.helper.rfind('/') + 1) + " " + driver + " of " + setup.device;
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
  if (std::string wrong = SimulatedHead().check(setup); !wrong.empty()) return wrong;
  if (driver_ == "external") {
    const std::string wrong = command_fault(setup.command);
    return wrong.empty() ? wrong : "the command: " + wrong;
  }
  std::vector<std::string> words = helper_arguments(driver_, setup);
  words.insert(words.begin() + 1, "--check");
  const std::string said = first_line_of(words);
  if (said.starts_with(kFault)) return said.substr(kFault.size()) + " (device-options)";
  return beyond_reach(driver_, option_words(setup.options), setup.limits);
}

std::string HelperHead::open(const HeadSetup& setup) {
  close();
  if (std::string wrong = settings_fault(driver_, setup); !wrong.empty()) return wrong;
  auto core = std::make_shared<Core>();
  std::unique_lock guard(core->lock);
  if (std::string wrong = core->client.open(setup); !wrong.empty()) return wrong;
  core->arguments = helper_arguments(driver_, setup);
  core->name = helper_name(driver_, setup);
  core->epoch = since_start(Clock::now());
  if (std::string wrong = core->start(); !wrong.empty()) return wrong;
  core_ = core;
  worker_.emplace([core] { core->run(); });
  const auto over = [&] { return core->client.ready() || !core->client.fault().empty(); };
  core->answered.wait(guard, over);  // the thread gives up one that does not become ready
  core->open = core->client.ready();
  std::string fault = core->client.fault();
  if (core->open && setup.moves_zoom && !core->client.moves_zoom()) {
    core->open = false;
    fault = "its helper `" + core->name + "` has no zoom to move (keep-size)";
  }
  guard.unlock();
  if (core->open) return {};
  leave(kParameters.refused_patience);
  return fault;
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
  if (!c.process.running() && since_start(Clock::now()) >= c.next_start && c.process.end()) c.start_again();
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

void HelperHead::learn(const motion::SpeedMap& pan, const motion::SpeedMap& tilt) {
  if (!core_) return;
  const std::lock_guard guard(core_->lock);
  core_->client.learn(pan, tilt);
}

bool HelperHead::emergency() {
  if (!core_) return false;
  const std::lock_guard guard(core_->lock);
  return core_->client.emergency();
}

bool HelperHead::parted() {
  if (!core_) return false;
  const std::lock_guard guard(core_->lock);
  return core_->client.parted();
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
