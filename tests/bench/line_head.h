// SPDX-License-Identifier: LGPL-2.1-or-later
// A simulated machine (sim::PanHead) behind the line protocol of real heads, as a helper of the driver `external` would
// be: what pantiltsink sends to real heads, without a process and in the bench's own time.
#pragma once

#include <deque>
#include <optional>
#include <string>

#include "drivers/head/head.h"
#include "drivers/helper/helper_client.h"
#include "sim/head_kinds.h"
#include "sim/zoom_lens.h"

namespace cerberus::bench {

using motion::Time;

class LineHead final : public drivers::Head {
 public:
  // lens: of a camera with a zoom, whose field of view the protocol has as a position of `table`.
  LineHead(const sim::HeadKind& kind, sim::PanHead& machine, sim::ZoomLens* lens = nullptr,
           const motion::ZoomTable& table = {})
      : kind_(kind), machine_(machine), lens_(lens), table_(table) {}

  std::string open(const drivers::HeadSetup& setup) override;
  void close() noexcept override {}
  void stop(Time now) noexcept override;
  std::string command(const drivers::HeadCommand& command) override;
  std::string limit(Time now, const motion::Limits& limits) override;
  void learn(const motion::SpeedMap& pan, const motion::SpeedMap& tilt) override {
    client_->learn(pan, tilt);
  }
  std::string state(Time time, motion::Pose& pose) override { return client_->state(time, pose); }
  bool blocks() const override { return false; }

  // Sends what is due, in both directions. Returns when it must be called again.
  Time serve(Time now);

 private:
  void on_line(const std::string& text);
  void obey(const motion::AxisCommand& command);
  void report_position(Time now);
  void report_zoom();
  void flush();

  const sim::HeadKind& kind_;
  sim::PanHead& machine_;
  sim::ZoomLens* lens_;
  motion::ZoomTable table_;
  double told_zoom_ = -1;
  std::optional<drivers::HelperClient> client_;
  std::deque<std::string> answers_;
  Time now_{}, next_report_{};
  struct Position {
    Time time{};
    double pan = 0;
  };
  std::deque<Position> past_;  // measured, not yet reported
};

}  // namespace cerberus::bench
