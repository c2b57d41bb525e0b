// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/stepper/stepper_head.h"

#include <algorithm>
#include <cstring>
#include <utility>
#include <vector>

namespace cerberus::drivers {
namespace {

void add_lines(const StepperAxisOptions& axis, std::vector<std::string>& outputs, std::vector<bool>& initial,
               std::vector<std::string>& inputs) {
  outputs.insert(outputs.end(), axis.lines.begin(), axis.lines.end());
  initial.resize(outputs.size(), false);
  if (axis.lines.size() == 3) initial.back() = !axis.enable_high;  // EN: off
  if (!axis.end_stop.empty()) inputs.push_back(axis.end_stop);
}

template <typename Act>
void for_each(std::optional<StepperAxis>& pan, std::optional<StepperAxis>& tilt, Act act) {
  for (auto* axis : {&pan, &tilt})
    if (*axis) act(**axis);
}

}  // namespace

StepperHead::StepperHead(StepperOptions options, std::unique_ptr<LinePort> port, std::FILE* record)
    : options_(std::move(options)), port_(std::move(port)), record_(record) {}

StepperHead::~StepperHead() {
  release({});
  port_->close();
}

std::string StepperHead::open_lines() {
  std::vector<std::string> outputs, inputs;
  std::vector<bool> initial;
  add_lines(options_.pan, outputs, initial, inputs);
  add_lines(options_.tilt, outputs, initial, inputs);
  return port_->open(outputs, initial, inputs);
}

std::optional<StepperAxis> StepperHead::make_axis(const char* name, const StepperAxisOptions& options,
                                                  std::size_t first_output, std::size_t& inputs) {
  if (options.lines.empty()) return std::nullopt;
  const MotorWiring wiring{first_output, static_cast<int>(options.lines.size()), options.invert,
                           options.enable_high};
  std::optional<std::size_t> end_stop;
  if (!options.end_stop.empty()) end_stop = inputs++;
  return StepperAxis(name, options, wiring, end_stop, options_.release_delay, options_.stale, *port_);
}

std::string StepperHead::check() const {
  if (options_.pan.lines.empty() && options_.tilt.lines.empty())
    return "stepper-gpio drives no motor: name the lines of an axis (pan='lines=17,18,27,22')";
  std::vector<std::string> outputs, inputs;
  std::vector<bool> initial;
  add_lines(options_.pan, outputs, initial, inputs);
  add_lines(options_.tilt, outputs, initial, inputs);
  outputs.insert(outputs.end(), inputs.begin(), inputs.end());
  for (auto line = outputs.begin(); line != outputs.end(); ++line)
    if (std::find(outputs.begin(), line, *line) != line)
      return "the GPIO line " + *line + " is named twice: each has one purpose";
  return {};
}

std::string StepperHead::open(const HeadSetup& setup, Time now) {
  if (std::string wrong = check(); !wrong.empty()) return wrong;
  if (std::string wrong = open_lines(); !wrong.empty()) return wrong;
  std::size_t inputs = 0;
  pan_ = make_axis("pan", options_.pan, 0, inputs);
  tilt_ = make_axis("tilt", options_.tilt, options_.pan.lines.size(), inputs);
  still_pan_.position = setup.pan;
  still_tilt_.position = setup.tilt;
  if (pan_) pan_->start(setup.pan, setup.limits.pan, now);
  if (tilt_) tilt_->start(setup.tilt, setup.limits.tilt, now);
  return {};
}

HeadAbilities StepperHead::abilities() const {
  return {.position = true, .velocity = true, .feedback = true, .rate = kRate};
}

void StepperHead::move(const motion::AxisCommand& pan, const motion::AxisCommand& tilt, Time now) {
  if (gone_) return;
  if (pan_) pan_->command(pan, now);
  if (tilt_) tilt_->command(tilt, now);
}

void StepperHead::limit(const motion::Limits& limits, Time now) {
  if (pan_) pan_->limit(limits.pan, now);
  if (tilt_) tilt_->limit(limits.tilt, now);
}

void StepperHead::stop(Time now) noexcept {
  for_each(pan_, tilt_, [now](StepperAxis& axis) { axis.stop(now); });
}

void StepperHead::leave(Time now) noexcept {
  for_each(pan_, tilt_, [now](StepperAxis& axis) { axis.leave(now); });
}

void StepperHead::release(Time) noexcept {
  for_each(pan_, tilt_, [](StepperAxis& axis) { axis.release(); });
}

bool StepperHead::busy() const {
  return (pan_ && pan_->homing()) || (tilt_ && tilt_->homing());
}

bool StepperHead::stopping() const {
  return !gone_ && ((pan_ && pan_->stopping()) || (tilt_ && tilt_->stopping()));
}

Time StepperHead::run(std::optional<StepperAxis>& axis, Time now) {
  if (!axis) return motion::kNever;
  const StepSchedule& schedule = axis->schedule();
  const auto count = schedule.count();
  const Time planned = schedule.planned();
  const Time next = axis->tick(now);
  if (record_ && schedule.count() != count)
    std::fprintf(record_, "%s %lld %lld %lld\n", &axis == &pan_ ? "pan" : "tilt",
                 static_cast<long long>(schedule.count()), static_cast<long long>(planned.count()),
                 static_cast<long long>(now.count()));
  return next;
}

bool StepperHead::rests() const {
  const auto still = [](const std::optional<StepperAxis>& axis) {
    return !axis || (!axis->moving() && !axis->homing());
  };
  return still(pan_) && still(tilt_);
}

int StepperHead::error_of_axes() const {
  if (pan_ && pan_->error() != 0) return pan_->error();
  return tilt_ ? tilt_->error() : 0;
}

// The chip does not take or report a level any more.
void StepperHead::lose(int error, Time now) {
  release(now);  // the lines that still obey
  port_->close();
  gone_ = true;
  gone_text_ = "GPIO chip " + options_.chip + " does not answer any more (" + std::strerror(error) +
               "): was it unplugged?";
  next_open_ = now + kReopen;
}

Time StepperHead::tick(Time now) {
  if (gone_) {
    if (now < next_open_) return next_open_;
    next_open_ = now + kReopen;
    if (!open_lines().empty()) return next_open_;
    gone_ = false;
    for_each(pan_, tilt_, [](StepperAxis& axis) { axis.recover(); });
  }
  Time next = now + kReportResting;
  next = std::min({next, run(pan_, now), run(tilt_, now)});
  int error = error_of_axes();
  if (error == 0 && now >= next_probe_) {
    next_probe_ = now + kProbe;
    if (rests()) error = port_->probe();  // a moving axis sets lines anyway
  }
  if (error != 0) {
    lose(error, now);
    next = next_open_;
  }
  fault_ = gone_ ? gone_text_ : pan_ ? pan_->fault(now) : "";
  if (fault_.empty() && tilt_) fault_ = tilt_->fault(now);
  if (gone_) return next;
  if (now >= next_report_) {
    const bool moving = (pan_ && pan_->moving()) || (tilt_ && tilt_->moving());
    next_report_ = now + (moving ? Time(kReportMoving) : Time(kReportResting));
    new_pose_ = true;
  }
  return std::min(next, next_report_);
}

std::optional<PoseLine> StepperHead::take_pose(Time now) {
  if (!std::exchange(new_pose_, false)) return std::nullopt;
  return PoseLine{pan_ ? pan_->state(now) : still_pan_, tilt_ ? tilt_->state(now) : still_tilt_, 0};
}

}  // namespace cerberus::drivers
