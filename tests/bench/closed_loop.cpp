// SPDX-License-Identifier: LGPL-2.1-or-later
#include "closed_loop.h"

#include <chrono>
#include <cmath>
#include <utility>

namespace cerberus::bench {

namespace {

using std::chrono::milliseconds;

Time time_of(double seconds) {
  return Time(static_cast<Time::rep>(std::llround(seconds * 1e9)));
}

// The base's turn since the picture before, as it is reported with the pictures.
class BaseReports {
 public:
  BaseReports(const sim::Scene& scene, FollowingLaw& law) : scene_(scene), law_(law) {}
  double turn(const sim::Picture& picture) {
    const Time before = std::exchange(last_, picture.taken);
    switch (scene_.report) {
      case sim::BaseReport::none:
        return 0;
      case sim::BaseReport::turn:
        return scene_.base(motion::seconds(picture.taken)) - scene_.base(motion::seconds(before));
      case sim::BaseReport::from_picture:
        return picture.turn - (law_.look(picture.taken) - law_.look(before));
    }
    return 0;
  }

 private:
  const sim::Scene& scene_;
  FollowingLaw& law_;
  Time last_{};
};

}  // namespace

sim::Score run(FollowingLaw& law, sim::PanHead& head, const sim::Scene& scene, sim::CameraTraits traits,
               unsigned seed) {
  if (scene.wander > 0) traits.wander = scene.wander;
  sim::Camera camera(traits, seed);
  sim::Score::Parameters judged;
  judged.skip = scene.skip;
  judged.half_view = traits.field_of_view / 2;
  sim::Score score(judged);
  BaseReports base(scene, law);
  const Time delay = time_of(traits.delay);
  std::deque<sim::Picture> coming;
  Seen seen;
  seen.base_reported = scene.report != sim::BaseReport::none;
  for (Time now{}; now < time_of(scene.length); now += milliseconds(1)) {
    const double t = motion::seconds(now), yaw = scene.base(t);
    head.elapse(now);
    seen.bearing = sensing::wrap(scene.person(t) - yaw);
    const double off = sensing::wrap(seen.bearing - head.camera());
    if (now >= camera.next()) coming.push_back(camera.take(now, off, yaw + head.camera(), true));
    while (!coming.empty() && coming.front().taken + delay <= now) {
      seen.picture = coming.front();
      coming.pop_front();
      seen.base_turn = base.turn(seen.picture);
      seen.base_yaw += seen.base_turn;
      seen.sector = scene.sector && !seen.picture.seen;
      law.on_picture(seen, now);
    }
    law.elapse(now);
    score.add(t, off, head.camera(), law.look(now));
  }
  return score;
}

}  // namespace cerberus::bench
