// SPDX-License-Identifier: LGPL-2.1-or-later
#include "closed_loop.h"

#include <chrono>
#include <cmath>
#include <utility>

#include "sim/asked_base.h"

namespace cerberus::bench {

namespace {

using std::chrono::milliseconds;

Time time_of(double seconds) {
  return Time(static_cast<Time::rep>(std::llround(seconds * 1e9)));
}

// A picture on its way to the law, and the base when it was taken.
struct Coming {
  sim::Picture picture;
  double yaw = 0, height = 0;
};

// The base's turn since the picture before, as it is reported with the pictures.
class BaseReports {
 public:
  BaseReports(const sim::Scene& scene, FollowingLaw& law) : scene_(scene), law_(law) {}
  double turn(const Coming& now) {
    const sim::Picture& picture = now.picture;
    const Time before = std::exchange(last_, picture.taken);
    const double turned = now.yaw - std::exchange(yaw_, now.yaw);
    switch (scene_.report) {
      case sim::BaseReport::none:
        return 0;
      case sim::BaseReport::turn:
        return turned;
      case sim::BaseReport::from_picture:
        return picture.turn - (law_.look(picture.taken) - law_.look(before));
    }
    return 0;
  }

 private:
  const sim::Scene& scene_;
  FollowingLaw& law_;
  Time last_{};
  double yaw_ = 0;
};

// The share of the picture's height that a person of 1.7 m has, in a picture of 16:9.
double height_of_person(double distance, double field_of_view) {
  constexpr double kPerson = 1.7, kPicture = 9. / 16;
  return kPerson / distance / (2 * std::tan(field_of_view / 2) * kPicture);
}

}  // namespace

sim::Score run(FollowingLaw& law, sim::PanHead& head, const sim::Scene& scene, sim::CameraTraits traits,
               unsigned seed, sim::ZoomLens* lens) {
  if (scene.wander > 0) traits.wander = scene.wander;
  sim::Camera camera(traits, seed);
  sim::Score::Parameters judged;
  judged.skip = scene.skip;
  judged.half_view = traits.field_of_view / 2;
  sim::Score score(judged);
  BaseReports base(scene, law);
  const Time delay = time_of(traits.delay);
  std::deque<Coming> coming;
  sim::AskedBase asked;
  double asks = 0;
  Seen seen;
  seen.base_reported = scene.report != sim::BaseReport::none;
  for (Time now{}; now < time_of(scene.length); now += milliseconds(1)) {
    const double t = motion::seconds(now), yaw = scene.base(t) + asked.yaw();
    head.elapse(now);
    if (scene.asks) asked.step(now);
    if (lens) lens->elapse(now);
    seen.bearing = sensing::wrap(scene.person(t) - yaw);
    const double off = sensing::wrap(seen.bearing - head.camera());
    if (now >= camera.next()) {
      if (lens) camera.look_through(lens->field_of_view());
      const sim::Picture picture = camera.take(now, off, yaw + head.camera(), !scene.hidden(t));
      coming.push_back(
          {picture, yaw, scene.distance ? height_of_person(scene.distance(t), picture.field_of_view) : 0});
    }
    while (!coming.empty() && coming.front().picture.taken + delay <= now) {
      seen.picture = coming.front().picture;
      seen.height = coming.front().height;
      seen.base_turn = base.turn(coming.front());
      coming.pop_front();
      seen.base_yaw += seen.base_turn;
      seen.sector = scene.sector && !seen.picture.seen;
      law.on_picture(seen, now);
    }
    law.elapse(now);
    // Repeated, as requests are: ten times a second.
    if (const double wants = law.asks_base(); wants != asks || now % milliseconds(100) == Time{}) {
      asks = wants;
      asked.ask(asks, now);
    }
    score.add(t, off, head.camera(), law.look(now));
  }
  return score;
}

}  // namespace cerberus::bench
