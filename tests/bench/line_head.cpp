// SPDX-License-Identifier: LGPL-2.1-or-later
#include "line_head.h"

#include <algorithm>

#include "drivers/helper/head_lines.h"

namespace cerberus::bench {

namespace {

Time time_of(double seconds) {
  return Time(static_cast<Time::rep>(seconds * 1e9));
}

// Of machine and controller, which must both be asked soon: a helper's lines come when they come.
constexpr Time kLongest = std::chrono::milliseconds(5);

}  // namespace

std::string LineHead::open(const drivers::HeadSetup& setup) {
  client_.emplace([this](const std::string& line) { on_line(line.substr(0, line.find('\n'))); });
  if (std::string wrong = client_->open(setup); !wrong.empty()) return wrong;
  client_->begin(Time::zero());
  flush();
  return client_->ready() ? "" : "the simulated head is not ready";
}

void LineHead::stop(Time now) noexcept {
  now_ = std::max(now, now_);
  client_->stop(now);
  flush();
}

std::string LineHead::command(const drivers::HeadCommand& command) {
  now_ = command.time;
  if (std::string wrong = client_->accept(command); !wrong.empty()) return wrong;
  std::string wrong = client_->execute(now_);
  flush();
  return wrong;
}

std::string LineHead::limit(Time now, const motion::Limits& limits) {
  now_ = std::max(now, now_);
  return client_->limit(now, limits);
}

Time LineHead::serve(Time now) {
  now_ = now;
  const Time next = client_->serve(now);
  report_position(now);
  report_zoom();
  flush();
  return std::min(next, now + kLongest);
}

void LineHead::report_position(Time now) {
  if (!kind_.reports || now < next_report_) return;
  next_report_ = now + time_of(1 / sim::HeadKind::kReports);
  past_.push_back({now, machine_.camera()});
  while (past_.size() > 1 && past_[1].time <= now - time_of(sim::HeadKind::kReportAge)) past_.pop_front();
  drivers::PoseLine line;
  line.pan.position = past_.front().pan;
  line.age = motion::seconds(now - past_.front().time);
  answers_.push_back(drivers::pose_line(line));
}

void LineHead::report_zoom() {
  if (!lens_ || lens_->reported() == told_zoom_) return;
  told_zoom_ = lens_->reported();
  answers_.push_back(drivers::zoom_line({table_.position_for(told_zoom_)}));
}

void LineHead::obey(const motion::AxisCommand& command) {
  machine_.command(command, now_);
  if (!machine_.traits().turns_only || kind_.reports) return;
  const bool turns = command.kind == motion::AxisCommand::Kind::velocity;
  answers_.push_back(drivers::speeds_line({{turns ? machine_.nearest_speed(command.value) : 0, 0}, 0}));
}

void LineHead::on_line(const std::string& text) {
  const auto line = drivers::parse_pipeline_line(text);
  if (!line) return;
  if (std::get_if<drivers::HelloLine>(&*line)) {
    drivers::HeadAbilities abilities;
    abilities.velocity = true;
    abilities.position = !machine_.traits().turns_only;
    abilities.feedback = kind_.reports;
    abilities.rate = machine_.traits().rate;
    abilities.zoom = lens_ != nullptr;
    answers_.push_back(drivers::ready_line(abilities));
  } else if (const auto* move = std::get_if<drivers::MoveLine>(&*line)) {
    obey(move->pan);
  } else if (const auto* zoom = std::get_if<drivers::ZoomLine>(&*line); zoom && lens_) {
    lens_->command(table_.field_of_view(zoom->position), now_);
  } else if (std::get_if<drivers::StopLine>(&*line)) {
    obey({});
  }
}

// What a line causes is answered after it was sent, as by a process.
void LineHead::flush() {
  while (!answers_.empty()) {
    const std::string line = answers_.front();
    answers_.pop_front();
    client_->handle(line, now_);
  }
}

}  // namespace cerberus::bench
