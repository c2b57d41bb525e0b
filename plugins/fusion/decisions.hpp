// SPDX-License-Identifier: LGPL-2.1-or-later
// The fuser, and those who ask it: the video's thread with each frame and, live, the sensors' threads between two
// frames. Thread-safe; of two decisions the later one never knows less of the sensors.
#pragma once

#include <cerberus/cerberus.h>

#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "fusion/fuser.h"
#include "inputs.hpp"
#include "threads/in_order.h"
#include "translation.hpp"

namespace cerberus::plugin {

class Decisions {
 public:
  struct Told {
    CerberusFusion fusion;
    SensorSnapshot moment;
  };

  explicit Decisions(Inputs& inputs) : inputs_(inputs) {}

  void configure(const fusion::FuserOptions& options, const fusion::RuleTable& table);
  fusion::Interval limits() const;  // those that are in force
  void begin_anew();                // another scene, or another stream
  void end();                       // of the stream, or a flush: there is no last frame any more
  void forget();                    // everything

  // For the frame of `time`, by what was heard until `heard`. live: others may ask before the next one.
  // by_event: poses of the head that came as events count for a frame without its own.
  Told frame(GstBuffer* frame, Time time, Time heard, const std::string& head, bool live, bool by_event);
  // Until the next frame: the last one once more, with what sensors, head and base have said until `heard`. Nothing: no
  // sensor says anything else than for the last decision, or there is no live frame to speak of.
  std::optional<Told> between(Time heard, const std::string& head);

  // Tells every change that was decided and not told yet, in their order.
  void tell(const std::function<void(Time, const CerberusFusion&)>& tell);

 private:
  struct Frame {
    Time time, heard;
    SensorSnapshot moment;
  };
  struct Change {
    Time time;
    CerberusFusion fusion;

    // While nobody can be told, the newest change to each action of each rule stays.
    static bool replaces(const Change& newer, const Change& older);
  };
  // `at`: what a change is told with. Both with the lock held.
  CerberusFusion decide(const Frame& frame, Time at);
  void restart();

  Inputs& inputs_;
  mutable std::mutex lock_;  // held while the inputs are asked, and never the other way round
  fusion::Fuser fuser_;
  std::vector<fusion::Track> tracks_;  // of the last frame
  RuleName rule_name_;
  Time heard_{};               // by the last decision
  std::optional<Frame> last_;  // of a live stream
  threads::InOrder<Change> news_{Change::replaces};
};

}  // namespace cerberus::plugin
