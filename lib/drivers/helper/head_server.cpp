// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/helper/head_server.h"

#include <algorithm>

namespace cerberus::drivers {

void HeadServer::obey(const std::string& text, Time now) {
  const auto line = parse_pipeline_line(text);
  if (!line) return;
  last_line_ = now;
  if (const auto* hello = std::get_if<HelloLine>(&*line)) {
    if (greeted_) return;
    timeout_ = hello->setup.helper_timeout;
    limits_ = hello->setup.limits;
    greeted_ = true;
    const std::string wrong = device_.open(hello->setup, now);
    if (!wrong.empty()) {
      send_("fault " + wrong);
      ended_ = failed_ = true;
      return;
    }
    HeadAbilities abilities = device_.abilities();
    abilities.alive = true;
    send_(ready_line(abilities));
    return;
  }
  if (!greeted_) return;
  silent_ = false;
  if (std::exchange(stopped_, false)) send_("stopped silence");
  if (const auto* move = std::get_if<MoveLine>(&*line)) {
    device_.move(move->pan, move->tilt, now);
    obeyed_ = true;
  } else if (std::get_if<HomeLine>(&*line)) {
    device_.home(now);
    obeyed_ = true;
  } else if (const auto* limits = std::get_if<LimitsLine>(&*line)) {
    const auto move = [](motion::AxisLimits& axis, const motion::AxisLimits& to) {
      axis.from = to.from;
      axis.to = to.to;  // the line has no speeds: those of the first line stay
    };
    move(limits_.pan, limits->limits.pan);
    move(limits_.tilt, limits->limits.tilt);
    device_.limit(limits_, now);
    obeyed_ = true;  // a head beyond them returns
  } else if (const auto* zoom = std::get_if<ZoomLine>(&*line)) {
    device_.zoom(zoom->position, now);
  } else if (std::get_if<AliveLine>(&*line)) {
    send_(std::string(kAlive));
  } else if (std::get_if<StopLine>(&*line)) {
    device_.stop(now);
    obeyed_ = false;
  } else if (std::get_if<QuitLine>(&*line)) {
    ended_ = true;
  }
}

Time HeadServer::serve(Time now) {
  if (!greeted_ || ended_) return motion::kNever;
  Time next = device_.tick(now);
  if (!silent_ && now - last_line_ >= timeout_) {
    stopped_ = at_work();
    device_.leave(now);
    obeyed_ = false;
    silent_ = true;
    next = now;  // what tick() returned is of the plan before
  }
  report(now);
  return std::min(next, silent_ ? motion::kNever : last_line_ + timeout_);
}

Time HeadServer::finish(Time now) {
  constexpr std::chrono::milliseconds kLook{20};
  if (!finish_by_) {
    finish_by_ = now + kStopPatience;
    device_.leave(now);
  }
  const Time next = device_.tick(now);
  if (!device_.stopping() || now >= *finish_by_) return motion::kNever;
  return std::min({next, *finish_by_, now + Time(kLook)});
}

void HeadServer::report(Time now) {
  if (const std::string fault = device_.fault(); fault != fault_) {
    fault_ = fault;
    send_(fault.empty() ? "recovered" : "fault " + fault);
  }
  // After `recovered`, so that a command that answers it is obeyed.
  if (const bool pressed = device_.emergency(); pressed != emergency_) {
    emergency_ = pressed;
    send_(pressed ? "emergency pressed" : "emergency released");
  }
  if (const auto pose = device_.take_pose(now)) send_(pose_line(*pose));
  while (const auto speeds = device_.take_speeds(now)) send_(speeds_line(*speeds));
  if (const auto zoom = device_.take_zoom(); zoom && zoom != zoom_) {
    zoom_ = zoom;
    send_(zoom_line({*zoom}));
  }
  if (const auto homed = device_.take_homed(now)) send_(homed_line(*homed));
}

}  // namespace cerberus::drivers
