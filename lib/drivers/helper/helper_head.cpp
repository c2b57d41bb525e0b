// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/helper/helper_head.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <utility>
#include <vector>

#include "drivers/helper/head_lines.h"
#include "drivers/helper/helper_process.h"
#include "drivers/helper/passwords.h"
#include "drivers/simulated/simulated_head.h"
#include "motion/reckoning.h"
#include "text/numbers.h"

namespace cerberus::drivers {
namespace {

using motion::AxisCommand;
using motion::AxisState;
using motion::Pose;
using Clock = std::chrono::steady_clock;
using Kind = AxisCommand::Kind;

struct Parameters {
  Time ready_timeout = std::chrono::seconds(5);  // derived: a slow network camera logs in within it
  Time restart_delay =
      std::chrono::seconds(1);  // derived: issue "used again when it returns", without a busy loop
  Time fresh =
      std::chrono::milliseconds(500);  // feedback older than this corrects nothing and measures no pose
  double correction_gain =
      0.3;                     // share of the difference to a reported pose; derived: settles in ten reports
  double least_change = 1e-4;  // radians a second: slower changes of a speed are not sent
  // Radians a second for each radian between the model and the reckoned pose when a command takes effect. derived: a
  // step that is 20 % too fast at 20 degrees a second stays within 1.3 degrees.
  double follow_gain = 3;
  // derived: 340 degrees at a camera's slow 10 degrees a second, and its start
  Time home_timeout = std::chrono::seconds(45);
};
constexpr Parameters kParameters;

// HeadSetup::options as words; blanks part them, single quotes keep them.
std::vector<std::string> own_helper(const std::string& driver, const HeadSetup& setup) {
  std::vector<std::string> words{setup.helper, driver, "--device=" + setup.device};
  bool quoted = false, begun = false;
  for (const char c : setup.options) {
    if (c == '\'') quoted = !quoted;
    const bool blank = c == ' ' && !quoted;
    if (!blank && !begun) words.emplace_back("--");
    begun = !blank;
    if (!blank && c != '\'') words.back() += c;
  }
  return words;
}

Time since_start(Clock::time_point at) {
  return std::chrono::duration_cast<Time>(at.time_since_epoch());
}

}  // namespace

// Shared with the thread that talks to the helper. `lock` guards everything.
struct HelperHead::Core {
  std::mutex lock;
  std::condition_variable answered;
  HeadSetup setup;
  std::vector<std::string> arguments;
  std::string name;  // of the helper, for messages
  HelperProcess process;
  LineBuffer lines;
  SimulatedHead model;
  HeadAbilities abilities;
  bool open = false, ready = false, ended = false, follows = false;
  bool pressed = false, was_pressed = false;  // the emergency stop: now; since the last emergency()
  std::string fault;                          // of the head, as the helper reports it
  std::string notice;                         // what the next command() returns, once
  Time epoch{};                               // running time 0 on the steady clock
  HeadCommand last;                           // of the caller
  std::string last_move;                      // as sent
  Time next_follow{}, next_alive{}, next_start{};
  double pan_correction = 0, tilt_correction = 0;  // radians: what to add to the model
  std::optional<Time> measured;                    // running time of the last report
  motion::Reckoning reckoning;                     // of a head that reports speeds instead of positions
  bool reckons = false;                            // it does
  std::optional<Time> homing;                      // since when the head looks for its reference
  int wake = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);

  ~Core() { ::close(wake); }
  void run();
  std::string start();
  void lose(const std::string& why);
  bool read_lines();
  void handle(const HelperLine& line);
  void send(const std::string& line);
  void send_command();
  void send_stop();
  void follow(Time now);
  void check_homing(Time now);
  void poke() const {
    const std::uint64_t one = 1;
    [[maybe_unused]] const ssize_t written = ::write(wake, &one, sizeof one);
  }
  // Whether the last report is young enough to correct the model with.
  bool is_fresh(Time now) const { return measured && now - *measured < kParameters.fresh; }
  Time running_time() const { return since_start(Clock::now()) - epoch; }
  Time period() const { return Time(static_cast<Time::rep>(1e9 / abilities.rate)); }
};

std::string HelperHead::Core::start() {
  ready = pressed = false;
  fault.clear();
  lines = {};
  last_move.clear();
  pan_correction = tilt_correction = 0;
  measured.reset();
  homing.reset();
  reckons = false;
  next_alive = Time{};
  if (std::string wrong = process.start(arguments); !wrong.empty()) return wrong;
  HeadSetup now = setup;
  if (Pose pose; model.state(running_time(), pose).empty()) {
    now.pan = pose.pan.position;
    now.tilt = pose.tilt.position;
  }
  send(hello_line(now, setup.helper_timeout));
  return {};
}

// The helper ended, or does not read any more. A command starts it again after restart_delay.
void HelperHead::Core::lose(const std::string& why) {
  ready = false;
  process.hang_up();
  fault = why == fault ? why : "the head's helper `" + name + "` is gone: " + why;
  next_start = since_start(Clock::now()) + kParameters.restart_delay;
  answered.notify_all();
}

void HelperHead::Core::send(const std::string& line) {
  if (!process.running() || process.send(line)) return;
  const bool full = errno == EAGAIN || errno == EWOULDBLOCK;
  read_lines();  // the last lines may contain the reason
  lose(!fault.empty() ? fault : full ? "it does not read its input" : "it ended");
}

void HelperHead::Core::send_command() {
  const auto direct = [this](const AxisCommand& c) {
    return c.kind == Kind::hold || (c.kind == Kind::position && abilities.position) ||
           (c.kind == Kind::velocity && abilities.velocity && abilities.position);
  };
  follows = !direct(last.pan) || !direct(last.tilt);
  if (follows) {
    next_follow = Time{};
    follow(running_time());
    return;
  }
  const std::string line = move_line(last.pan, last.tilt);
  if (line != last_move) send(line);
  last_move = line;
}

// The protocol's stop, which ends homing, too.
void HelperHead::Core::send_stop() {
  follows = false;
  last_move.clear();
  send("stop\n");
}

// Makes the head do what the model does.
void HelperHead::Core::follow(Time now) {
  if (now < next_follow) return;
  next_follow = now + period();
  Pose ahead;
  if (!model.state(now + setup.latency, ahead).empty()) return;
  const bool corrected = is_fresh(now) && !reckons;
  const Pose reckoned = reckoning.at(now + setup.latency);
  const auto error = [&](const AxisState& model_axis, const AxisState& reckoned_axis, double correction) {
    if (reckons) return kParameters.follow_gain * (reckoned_axis.position - model_axis.position);
    return corrected ? correction : 0;
  };
  const auto axis = [&](const AxisState& state, double correction, const motion::AxisLimits& limits,
                        const motion::SpeedMap& map) -> AxisCommand {
    if (!abilities.velocity) return {Kind::position, state.position, std::abs(state.speed)};
    const double speed = std::clamp(state.speed - correction, -limits.speed, limits.speed);
    return std::abs(speed) < kParameters.least_change
               ? AxisCommand{}
               : AxisCommand{Kind::velocity, map.command_for(speed), 0};
  };
  const std::string line = move_line(
      axis(ahead.pan, error(ahead.pan, reckoned.pan, pan_correction), setup.limits.pan, setup.pan_speeds),
      axis(ahead.tilt, error(ahead.tilt, reckoned.tilt, tilt_correction), setup.limits.tilt,
           setup.tilt_speeds));
  if (line != last_move) send(line);
  last_move = line;
  if (ahead.settled && !measured && (!reckons || reckoned.settled)) follows = false;
}

void HelperHead::Core::check_homing(Time now) {
  if (!homing || now - *homing < kParameters.home_timeout) return;
  homing.reset();
  send("stop\n");
  notice = "the head did not find its reference";
}

void HelperHead::Core::handle(const HelperLine& line) {
  if (const auto* came = std::get_if<ReadyLine>(&line)) {
    abilities = came->abilities;
    ready = true;
    fault.clear();
  } else if (const auto* reported = std::get_if<FaultLine>(&line)) {
    if (fault.empty()) process.send("stop\n");
    fault = reported->text;
  } else if (std::get_if<RecoveredLine>(&line)) {
    fault.clear();
    last_move.clear();
  } else if (const auto* emergency = std::get_if<EmergencyLine>(&line)) {
    pressed = emergency->pressed;
    was_pressed = was_pressed || pressed;
  } else if (const auto* halted = std::get_if<StoppedLine>(&line)) {
    notice = "the helper stopped the head: " + halted->text;
    last_move.clear();
  } else if (const auto* pose = std::get_if<PoseLine>(&line)) {
    const Time at = running_time() - Time(static_cast<Time::rep>(std::min(pose->age, 10.0) * 1e9));
    measured = at;
    if (reckons) return reckoning.place(at, {pose->pan.position, pose->tilt.position});
    Pose expected;
    if (!model.state(at, expected).empty()) return;
    const auto correct = [](double& correction, double difference) {
      correction += kParameters.correction_gain * (difference - correction);
    };
    correct(pan_correction, pose->pan.position - expected.pan.position);
    correct(tilt_correction, pose->tilt.position - expected.tilt.position);
  } else if (const auto* speeds = std::get_if<SpeedsLine>(&line)) {
    const Time at =
        running_time() - Time(static_cast<Time::rep>(std::min(speeds->age, 1.0) * 1e9)) + setup.latency;
    Pose here;
    if (!std::exchange(reckons, true) && model.state(running_time(), here).empty())
      reckoning.begin(at, {here.pan.position, here.tilt.position});
    reckoning.turn(
        at, {setup.pan_speeds.actual(speeds->speed.pan), setup.tilt_speeds.actual(speeds->speed.tilt)});
  } else if (const auto* homed = std::get_if<HomedLine>(&line)) {
    if (!std::exchange(homing, std::nullopt)) return;
    measured = running_time();
    reckons = true;
    reckoning.begin(*measured, homed->at);
  }
  answered.notify_all();
}

// False: the helper has closed its end.
bool HelperHead::Core::read_lines() {
  std::string bytes;
  const bool alive = process.receive(bytes);
  lines.append(bytes);
  while (const auto text = lines.take())
    if (const auto line = parse_helper_line(*text)) handle(*line);
  return alive;
}

void HelperHead::Core::run() {
  std::unique_lock guard(lock);
  while (!ended) {
    const Time now = since_start(Clock::now());
    if (process.running() && now >= next_alive) {
      next_alive = now + setup.helper_timeout / 4;
      send("alive\n");
    }
    if (ready && follows && fault.empty()) follow(running_time());
    check_homing(running_time());
    // A helper that ended may have left its head turning: only a new one can stop it.
    if (!process.running() && now >= next_start && process.end())
      if (const std::string wrong = start(); !wrong.empty()) lose(wrong);
    Time until = process.running() ? next_alive : now + kParameters.restart_delay;
    if (ready && follows && fault.empty()) until = std::min(until, next_follow + epoch);
    const auto wait = std::chrono::ceil<std::chrono::milliseconds>(until - since_start(Clock::now()));
    pollfd fds[2]{{wake, POLLIN, 0}, {process.fd(), POLLIN, 0}};  // a negative descriptor is skipped
    guard.unlock();
    ::poll(fds, 2, static_cast<int>(std::clamp<long>(wait.count(), 0, 1000)));
    guard.lock();
    std::uint64_t count;
    [[maybe_unused]] const ssize_t drained = ::read(wake, &count, sizeof count);
    if (fds[1].revents && process.fd() == fds[1].fd && !read_lines())
      lose(fault.empty() ? "it ended" : fault);
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

std::string HelperHead::open(const HeadSetup& setup) {
  close();
  const bool external = driver_ == "external";
  if (external && setup.command.empty()) return "the driver external needs a helper to run (command=)";
  if (!external && setup.device.empty()) return "the driver " + driver_ + " needs a device (device=)";
  for (const std::string& setting : {setup.device, setup.options})
    if (std::string wrong = refuse_password(setting); !wrong.empty()) return wrong;
  if (setup.helper_timeout < std::chrono::milliseconds(1) || setup.helper_timeout > std::chrono::seconds(10))
    return "helper-timeout must be 1 ms to 10 s, and is " +
           text::significant(motion::seconds(setup.helper_timeout), 6).string() + " s";
  auto core = std::make_shared<Core>();
  HeadSetup rigid = setup;  // play would hide from the head the turn that takes it up
  rigid.backlash = 0;
  core->reckoning.set_play(setup.play);
  if (std::string wrong = core->model.open(rigid); !wrong.empty()) return wrong;
  std::unique_lock guard(core->lock);
  core->setup = setup;
  core->arguments = helper_arguments(driver_, setup);
  // Not the whole command: its arguments may hold a password.
  core->name = external ? setup.command.substr(0, setup.command.find(' ')) : driver_ + " of " + setup.device;
  core->epoch = since_start(Clock::now());
  if (std::string wrong = core->start(); !wrong.empty()) return wrong;
  core_ = core;
  worker_.emplace([core] { core->run(); });
  const auto over = [&] { return core->ready || !core->fault.empty(); };
  const bool came = core->answered.wait_for(guard, kParameters.ready_timeout, over);
  core->open = core->ready;
  const std::string fault = core->fault, name = core->name;
  guard.unlock();
  if (core->open) return {};
  close();
  return came ? fault : "the head's helper `" + name + "` does not answer with `ready 1 ...`";
}

void HelperHead::close() noexcept {
  if (!core_) return;
  {
    const std::lock_guard guard(core_->lock);
    core_->ended = true;
    core_->open = false;
  }
  core_->poke();
  if (worker_) worker_->leave(2 * HelperProcess::kPatience);
  worker_.reset();
  core_.reset();
}

void HelperHead::stop(Time now) noexcept {
  if (!core_) return;
  const std::lock_guard guard(core_->lock);
  core_->model.stop(now);
  core_->last.pan = core_->last.tilt = {};
  core_->homing.reset();
  core_->send_stop();
}

std::string HelperHead::command(const HeadCommand& command) {
  if (!core_ || !core_->open) return "the head's helper is not open";
  const std::lock_guard guard(core_->lock);
  Core& c = *core_;
  if (std::string wrong = c.model.command(command); !wrong.empty()) return wrong;
  c.last = command;
  if (std::exchange(c.homing, std::nullopt)) c.last_move.clear();
  c.epoch = since_start(Clock::now()) - command.time;
  if (!c.process.running() && since_start(Clock::now()) >= c.next_start)
    if (const std::string wrong = c.start(); !wrong.empty()) c.lose(wrong);
  if (!c.fault.empty()) return c.fault;
  if (!c.ready) return "the head's helper has been started again and is not ready yet";
  if (command.stop)
    c.send_stop();
  else
    c.send_command();
  c.poke();
  return std::exchange(c.notice, {});
}

std::string HelperHead::limit(Time now, const motion::Limits& limits) {
  if (!core_ || !core_->open) return "the head's helper is not open";
  const std::lock_guard guard(core_->lock);
  if (std::string wrong = core_->model.limit(now, limits); !wrong.empty()) return wrong;
  core_->setup.limits = limits;
  core_->send(limits_line(limits));
  // The model returns within the limits from wherever it rests: a head that only turns at speeds must be driven there.
  Pose ahead;
  const bool moves = core_->model.state(now + core_->setup.latency, ahead).empty() && !ahead.settled;
  if (moves && !core_->abilities.position) {
    core_->follows = true;
    core_->next_follow = Time{};
    core_->poke();
  }
  return {};
}

bool HelperHead::emergency() {
  if (!core_) return false;
  const std::lock_guard guard(core_->lock);
  return std::exchange(core_->was_pressed, core_->pressed) || core_->pressed;
}

std::string HelperHead::home(Time now) {
  if (!core_ || !core_->open) return "the head's helper is not open";
  const std::lock_guard guard(core_->lock);
  Core& c = *core_;
  if (!c.ready || !c.abilities.home) return Head::home(now);
  const AxisCommand zero{Kind::position, 0, c.setup.limits.pan.speed};
  if (std::string wrong = c.model.command({now, zero, zero}); !wrong.empty()) return wrong;
  c.follows = false;
  c.homing = now;
  c.send("home\n");
  return {};
}

std::string HelperHead::state(Time time, Pose& pose) {
  if (!core_ || !core_->open) return "the head's helper is not open";
  const std::lock_guard guard(core_->lock);
  if (std::string wrong = core_->model.state(time, pose); !wrong.empty()) return wrong;
  if (core_->reckons) pose = core_->reckoning.at(time);
  pose.measured = core_->is_fresh(time);
  if (core_->reckons) return {};
  if (!pose.measured) return {};
  pose.pan.position += core_->pan_correction;
  pose.tilt.position += core_->tilt_correction;
  return {};
}

}  // namespace cerberus::drivers
