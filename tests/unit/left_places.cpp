// SPDX-License-Identifier: LGPL-2.1-or-later
// The complete chain: a track is stopped only while its place differs from what was there before the person came. He goes
// through a door, or he went on while the camera's picture stood.
#include <cstdio>
#include <string>
#include <vector>

#include "support/yard.h"
#include "vision/detector.h"
#include "vision/frame_history.h"
//
#include "support/suite.h"

using namespace cerberus::vision;
using namespace cerberus::tests;

namespace {

// The detector as motiondetect has it: pictures that repeat the last one are not analysed.
class Watch {
 public:
  explicit Watch(double rate) : rate_(rate) {
    options_.burnt_in = true;
    detector_.set_options(options_);
  }
  const std::vector<Track>& step(const LumaSource& source) {
    const FrameHistory::Time time(static_cast<FrameHistory::Time::rep>(1e9 * frames_++ / rate_));
    const Record record = detector_.begin(source);
    FrameHistory history = history_;
    const FrameHistory::Step step = history.next(time, 1 / rate_);
    DetectorFrame frame;
    frame.size = {source.width, source.height};
    frame.fresh = step.fresh, frame.seconds = step.seconds, frame.number = number_ + 1;
    if (detector_.repeats(*record, frame, step.repeatable)) {
      const auto repeated = history_.repeat(time, 1 / rate_);
      std::erase_if(tracks_, [&](const Track& t) {
        return !repeated || !outlasts(t.state, repeated->seconds, options_.tracks);
      });
      return tracks_;
    }
    history_ = history;
    number_ = frame.number;
    detector_.run(*record, frame);
    return tracks_ = *record->tracks;
  }

 private:
  double rate_;
  int frames_ = 0;
  DetectorOptions options_;
  Detector detector_;
  FrameHistory history_;
  std::uint64_t number_ = 0;
  std::vector<Track> tracks_;
};

bool is_at(const std::vector<Track>& tracks, const Box& box) {
  return std::ranges::any_of(tracks,
                             [&](const Track& t) { return overlap_area(t.box, box) > box.area() / 2; });
}

constexpr double kComes = 1;     // s until he comes into the picture
constexpr double kLeaves = 6;    // s for which the empty place is watched
constexpr double kBelieved = 1;  // s for which a box may stay where he was

// What went wrong, for the message of a test.
class Wrong {
 public:
  template <typename... Values>
  void add(const Yard& yard, const char* format, Values... values) {
    char text[200];
    const int head =
        std::snprintf(text, sizeof text, "%dx%d at %g/s, contrast %g, level %g: ", yard.size.width,
                      yard.size.height, yard.rate, yard.contrast, yard.level);
    std::snprintf(text + head, sizeof text - static_cast<std::size_t>(head), format, values...);
    all_ += std::string("\n  ") + text;
  }
  void check() const { ck_assert_msg(all_.empty(), "%s", all_.c_str()); }

 private:
  std::string all_;
};

// He walks to the door, stands there and goes through it, hidden by the leaf from the right.
void goes_through_the_door(Wrong& wrong, Yard yard, double speed, double stands) {  // S a second; s
  const double step = speed * 34 * yard.scale() / yard.rate, to = yard.door().x + yard.door().width / 2;
  const double start = -8 * yard.scale(), way = to - start, closes = .5;  // s until all of him is hidden
  const double arrives = kComes + way / step / yard.rate, gone = arrives + stands + closes;
  Watch watch(yard.rate);
  bool stood = false;
  double last = 0;  // s at which a box was there
  for (int k = 0; k < (gone + kLeaves) * yard.rate; ++k) {
    const double time = k / yard.rate;
    Yard::Person person;
    person.way = std::clamp((time - kComes) * yard.rate * step, 0.0, way);
    person.x = start + person.way;
    const double half = 8 * yard.scale();
    if (time > arrives + stands) person.hidden = to + half - 2 * half * (time - arrives - stands) / closes;
    yard.draw(person);
    const auto& tracks = watch.step(yard.shoot());
    if (time > arrives && time < arrives + stands) stood = is_at(tracks, yard.box(person));
    if (!tracks.empty()) last = time;
  }
  if (last > gone + kBelieved)
    wrong.add(yard, "speed %g, stood %g s: a box up to %.1f s after he has gone", speed, stands, last - gone);
  if (!stood) wrong.add(yard, "speed %g, stood %g s: not seen standing", speed, stands);
}

// The picture stands while he walks, then goes on with him (live) or where he was.
void picture_stands(Wrong& wrong, Yard yard, double speed, double seconds, bool live) {
  const double step = speed * 34 * yard.scale() / yard.rate, start = -8 * yard.scale();
  const int stands = static_cast<int>(3.5 * yard.rate),
            goes_on = stands + static_cast<int>(seconds * yard.rate);
  Watch watch(yard.rate);
  LumaSource shot;
  int seen = 0, frames = 0, nobody = 0;
  for (int k = 0; k < 14 * yard.rate; ++k) {
    Yard::Person person;
    person.way =
        step * std::max(0.0, (k < goes_on || live ? k : k - (goes_on - stands)) - kComes * yard.rate);
    person.x = start + person.way;
    if (k < stands || k >= goes_on) {
      yard.draw(person);
      shot = yard.shoot();
    }
    const auto& tracks = watch.step(shot);
    if (k < goes_on + kBelieved * yard.rate) continue;
    const Box box = yard.box(person);
    const bool in = box.x > 0 && box.right() < yard.size.width;
    frames += in, seen += in && is_at(tracks, box);
    nobody += std::ranges::any_of(tracks, [&](const Track& t) { return overlap_area(t.box, box) <= 0; });
  }
  if (nobody > 0)
    wrong.add(yard, "speed %g, picture stood %g s, %d: %d frames with a box where nobody is", speed, seconds,
              live, nobody);
  if (10 * seen < 8 * frames)
    wrong.add(yard, "speed %g, picture stood %g s, %d: seen in %d of %d frames", speed, seconds, live, seen,
              frames);
}

}  // namespace

START_TEST(somebody_who_went_through_a_door_leaves_no_box) {
  Wrong wrong;
  for (const double speed : {.3, .5, .9})
    for (const double stands : {1.0, 3.0, 8.0, 15.0}) goes_through_the_door(wrong, {}, speed, stands);
  for (const double rate : {5.0, 15.0, 25.0}) goes_through_the_door(wrong, {.rate = rate}, .5, 4);
  for (const double contrast : {.4, .6}) goes_through_the_door(wrong, {.contrast = contrast}, .5, 4);
  for (const double level : {14.0, 24.0, 44.0}) goes_through_the_door(wrong, {.level = level}, .5, 4);
  goes_through_the_door(wrong, {.size = {320, 240}}, .5, 4);
  goes_through_the_door(wrong, {.size = {640, 360}, .rate = 12}, .6, 6);
  wrong.check();
}
END_TEST

START_TEST(a_picture_that_stood_for_a_moment_leaves_no_box) {
  Wrong wrong;
  for (const bool live : {true, false})
    for (const double seconds : {.4, .8, 1.2, 3.0, 8.0}) {
      for (const double speed : {.3, .65, 1.2}) picture_stands(wrong, {}, speed, seconds, live);
      for (const double rate : {5.0, 15.0, 25.0}) picture_stands(wrong, {.rate = rate}, .5, seconds, live);
      picture_stands(wrong, {.contrast = .4}, .5, seconds, live);
      picture_stands(wrong, {.size = {320, 240}}, .5, seconds, live);
    }
  wrong.check();
}
END_TEST

int main() {
  return run_suite(
      "left_places",
      {somebody_who_went_through_a_door_leaves_no_box, a_picture_that_stood_for_a_moment_leaves_no_box}, 200);
}
