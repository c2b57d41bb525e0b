// SPDX-License-Identifier: LGPL-2.1-or-later
#include "peer_laws.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace cerberus::bench {

namespace {

using sensing::radians;
using Kind = motion::AxisCommand::Kind;

void turn(sim::PanHead& head, double speed, Time now) {
  const double most = head.traits().speed;
  head.command({Kind::velocity, std::clamp(speed, -most, most), 0}, now);
}

class Proportional final : public FollowingLaw {
 public:
  Proportional(sim::PanHead& head, double gain) : head_(head), gain_(gain) {}
  void on_picture(const Seen& seen, Time) override { off_ = seen.picture.seen ? seen.picture.off : 0; }
  void elapse(Time now) override {
    constexpr double kDeadBand = radians(1.5), kMostRate = 25;  // commands a second
    if (motion::seconds(now) < next_) return;
    next_ = motion::seconds(now) + 1 / std::min(head_.traits().rate, kMostRate);
    turn(head_, std::abs(off_) > kDeadBand ? gain_ * off_ : 0, now);
  }

 private:
  sim::PanHead& head_;
  double gain_, off_ = 0, next_ = 0;
};

class Jump final : public FollowingLaw {
 public:
  Jump(sim::PanHead& head, double pictures, bool predicts)
      : head_(head), pictures_(pictures), predicts_(predicts) {}
  void on_picture(const Seen& seen, Time now) override {
    constexpr double kLeast = radians(2), kSmoothing = .4, kSettles = .1;  // s
    const double taken = motion::seconds(seen.picture.taken);
    constexpr double kRounding = 1e-6;  // s
    if (taken < next_ - kRounding) return;
    next_ = taken + 1 / pictures_;
    if (!seen.picture.seen) return last_.reset();
    // Where the head really was: the best case of a camera that tells of its move's end.
    const double bearing = head_at(seen.picture.taken) + seen.picture.off;
    if (last_ && taken > last_taken_)
      rate_ += kSmoothing * ((bearing - *last_) / (taken - last_taken_) - rate_);
    last_ = bearing;
    last_taken_ = taken;
    if (head_.busy() || seen.picture.taken < rested_) return;
    double aim = seen.picture.off;
    if (predicts_)
      aim += rate_ * (motion::seconds(now) - taken + head_.traits().dead_time +
                      std::abs(seen.picture.off) / head_.traits().speed + kSettles);
    if (std::abs(aim) >= kLeast)
      head_.command({Kind::position, head_.motor() + aim, head_.traits().speed}, now);
  }
  void elapse(Time now) override {
    if (head_.busy()) rested_ = now;
    past_.push_back({now, head_.camera()});
    while (past_.size() > 1 && past_.front().time < now - std::chrono::seconds(1)) past_.pop_front();
  }

 private:
  double head_at(Time time) const {
    for (const auto& past : past_)
      if (past.time >= time) return past.pan;
    return head_.camera();
  }
  struct Past {
    Time time{};
    double pan = 0;
  };
  sim::PanHead& head_;
  double pictures_;
  bool predicts_;
  std::deque<Past> past_;
  Time rested_{};
  double next_ = 0, rate_ = 0, last_taken_ = 0;
  std::optional<double> last_;
};

// Casiez, Roussel, Vogel, "1 euro filter", CHI 2012.
class OneEuro {
 public:
  double operator()(double value, double now) {
    constexpr double kCutOff = 1.1, kBeta = .03, kRateCutOff = 1;  // Hz
    if (!x_) return *(x_ = value), time_ = now, value;
    const double rate = 1 / std::max(1e-3, now - time_);
    time_ = now;
    const double a = alpha(rate, kRateCutOff);
    dx_ = a * (value - *x_) * rate + (1 - a) * dx_;
    const double b = alpha(rate, kCutOff + kBeta * std::abs(dx_));
    return *(x_ = b * value + (1 - b) * *x_);
  }

 private:
  static double alpha(double rate, double cut_off) { return 1 / (1 + rate / (2 * M_PI * cut_off)); }
  std::optional<double> x_;
  double dx_ = 0, time_ = 0;
};

class AutoPtz final : public FollowingLaw {
 public:
  AutoPtz(sim::PanHead& head, const sim::CameraTraits& camera) : head_(head), camera_(camera) {}
  void on_picture(const Seen& seen, Time) override {
    constexpr double kSmoothing = .2;
    seen_ = seen.picture.seen;
    if (!seen_) {
      rate_ = 0;
      return last_.reset();
    }
    const double taken = motion::seconds(seen.picture.taken);
    const double error = std::tan(seen.picture.off) / std::tan(camera_.field_of_view / 2);
    if (last_) rate_ += kSmoothing * ((error - *last_) / (taken - last_taken_) - rate_);
    last_ = error;
    last_taken_ = taken;
  }
  void elapse(Time now) override {
    constexpr double kPeriod = .05, kSlew = 3, kPower = 1.2;
    const double t = motion::seconds(now);
    if (t < next_) return;
    next_ = t + std::max(kPeriod, 1 / head_.traits().rate);
    double wanted = 0;
    if (seen_ && last_) wanted = output(t);
    out_ += std::clamp(std::copysign(std::pow(std::abs(wanted), kPower), wanted) - out_, -kSlew * kPeriod,
                       kSlew * kPeriod);
    turn(head_, out_ * head_.traits().speed, now);
  }

 private:
  double output(double t) {
    constexpr double kLead = .15, kMostLead = .8, kDeadZone = .05, kP = .6, kD = .05, kV = .1, kMost = .7;
    const double lead = std::min(kMostLead, kLead + camera_.delay + head_.traits().dead_time);
    double aim = *last_ + rate_ * lead;
    if (std::abs(aim) < kDeadZone) aim = 0;
    const double smooth = filter_(aim, t);
    const double slope = before_ ? (smooth - before_->aim) / (t - before_->time) : 0;
    before_ = {t, smooth};
    return std::clamp(kP * smooth + kD * slope + kV * rate_, -kMost, kMost);
  }
  struct Before {
    double time = 0, aim = 0;
  };
  sim::PanHead& head_;
  sim::CameraTraits camera_;
  OneEuro filter_;
  std::optional<double> last_;
  std::optional<Before> before_;
  bool seen_ = false;
  double rate_ = 0, last_taken_ = 0, next_ = 0, out_ = 0;
};

}  // namespace

std::unique_ptr<FollowingLaw> peer_law(const std::string& name, sim::PanHead& head,
                                       const sim::CameraTraits& camera, double gain) {
  constexpr double kFewPictures = 5;  // a second
  if (name == "proportional") return std::make_unique<Proportional>(head, gain);
  if (name == "jump") return std::make_unique<Jump>(head, camera.frames, false);
  if (name == "jump5") return std::make_unique<Jump>(head, kFewPictures, true);
  if (name == "autoptz") return std::make_unique<AutoPtz>(head, camera);
  return nullptr;
}

bool can_drive(const std::string& peer, const sim::HeadTraits& traits) {
  return !(traits.turns_only && peer.starts_with("jump"));
}

}  // namespace cerberus::bench
