// SPDX-License-Identifier: LGPL-2.1-or-later
// The fuser and the threads that ask it: the video's thread with each frame and, in a live stream, the sensors' threads
// between two frames. Thread-safe; of two decisions the later one never uses older readings. Steady state allocates
// nothing.
#pragma once

#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "fusion/sensor_inputs.h"
#include "fusion/target_override.h"
#include "threads/in_order.h"

namespace cerberus::fusion {

class Decisions {
 public:
  struct Outcome {
    Decision decision;  // its rule_name ends with a 0 and is valid as long as the Decisions
    SensorSnapshot snapshot;
    Time decided{};  // readings until then were used
  };

  explicit Decisions(SensorInputs& inputs) : inputs_(inputs) {}

  void configure(const FuserOptions& options, const RuleTable& table);
  // The track that the application chose goes before every rule while it is on the frame (target_override.h), from the
  // next frame on; the rule is then number 0, "chosen". 0: the rules alone.
  void choose(std::uint32_t track);
  Interval limits() const;  // those that are in force
  void begin_anew();        // another scene, or another stream
  void end();               // of the stream, or a flush: there is no last frame any more
  void forget();            // everything

  // For the frame of `time`, with the readings until `sensor_time`. live: between() may follow before the next frame.
  // observe(Time sensor_time, std::vector<Track>&) -> SensorSnapshot replaces the tracks by those of the frame.
  template <typename Observe>
  Outcome frame(Time time, Time sensor_time, bool live, Observe&& observe) {
    const std::lock_guard guard(lock_);
    sensor_time_ = not_before_last(sensor_time, live);
    const Frame frame{time, sensor_time_, observe(sensor_time_, tracks_)};
    return decide_frame(frame, live);
  }
  // Until the next frame: the last one once more, with the readings until `sensor_time`. Nothing: no sensor has
  // changed since the last decision, or there is no live frame of the last second.
  // listen(Time sensor_time, Time frame_time, SensorSnapshot&) brings the snapshot of the last frame up to it.
  template <typename Listen>
  std::optional<Outcome> between(Time sensor_time, Listen&& listen) {
    const std::lock_guard guard(lock_);
    if (!may_follow(sensor_time)) return std::nullopt;
    sensor_time = std::max(sensor_time, sensor_time_);
    Frame frame = *last_;
    listen(sensor_time, frame.time, frame.snapshot);
    return decide_between(frame, sensor_time);
  }

  // Calls publish(Time, const Outcome&) for each change that was decided and not published yet, in their order.
  template <typename Publish>
  void publish_changes(Publish&& publish) {
    changes_.deliver([&](const Change& change) { publish(change.time, change.outcome); });
  }

 private:
  struct Frame {
    Time time, sensor_time;
    SensorSnapshot snapshot;
  };
  struct Change {
    Time time;
    Outcome outcome;

    // While nothing can be published, the newest change to each action of each rule is kept.
    static bool replaces(const Change& newer, const Change& older);
  };
  // All with the lock held. `at`: the time with which a change is published.
  Time not_before_last(Time sensor_time, bool live) const;
  bool may_follow(Time sensor_time) const;
  Outcome decide_frame(const Frame& frame, bool live);
  std::optional<Outcome> decide_between(const Frame& frame, Time sensor_time);
  Outcome decide(const Frame& frame, Time at);
  void apply_choice(Decision& decision) const;
  void restart();

  SensorInputs& inputs_;
  mutable std::mutex lock_;  // held while the inputs are read, and never the other way round
  Fuser fuser_;
  TargetOverride choice_;
  TargetOverride::Answer chosen_ = TargetOverride::Answer::none;  // of the last frame
  Decision said_;                                                 // the last one, with the choice
  std::vector<Track> tracks_;                                     // of the last frame
  std::set<std::string, std::less<>> names_;                      // of all rules that have decided
  Time sensor_time_{};                                            // by the last decision
  std::optional<Frame> last_;                                     // of a live stream
  threads::InOrder<Change> changes_{Change::replaces};
};

}  // namespace cerberus::fusion
