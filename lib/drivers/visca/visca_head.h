// SPDX-License-Identifier: LGPL-2.1-or-later
// A camera that speaks VISCA, over a serial line, UDP (with and without the header of VISCA over IP) or TCP.
//
// At most one command is on its way: the newest waits until the camera acknowledges the last one, refuses it, or has not
// answered for kAnswerTime. A camera that has never acknowledged anything is sent commands at its rate. Stop goes out at
// once, and again until it is acknowledged. Positions are asked for kInquiries times a second, where the camera answers.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "drivers/helper/head_device.h"
#include "drivers/transport/byte_stream.h"
#include "drivers/visca/visca.h"

namespace cerberus::drivers {

struct ViscaOptions {
  std::string device;  // byte_stream.h
  int baud = 9600;
  int address = 1;       // 1 to 7, of a serial chain; 1 over IP
  bool header = true;    // over UDP
  bool feedback = true;  // ask for positions
  visca::SpeedTable speeds = visca::default_speed_table();
};

class ViscaHead final : public HeadDevice {
 public:
  explicit ViscaHead(ViscaOptions options) : options_(std::move(options)) {}
  // Blocks up to kAnswerTime to learn whether the camera answers position inquiries.
  std::string open(const HeadSetup& setup, Time now) override;
  HeadAbilities abilities() const override;
  void move(const motion::AxisCommand& pan, const motion::AxisCommand& tilt, Time now) override;
  void limit(const motion::Limits& limits, Time now) override;
  void stop(Time now) noexcept override;
  bool stopping() const override { return stopping_; }
  void watch(std::vector<pollfd>& fds) const override;
  Time tick(Time now) override;
  std::optional<PoseLine> take_pose(Time now) override;
  std::string fault() const override { return fault_; }

  static constexpr std::chrono::milliseconds kAnswerTime{
      200};  // VISCA: an answer within 16 ms; slow firmwares need more
  static constexpr std::chrono::milliseconds kStopAgain{100};
  static constexpr int kStopsWithoutAnswer = 5;  // to a camera that never acknowledged anything
  static constexpr std::chrono::milliseconds kInquiryPeriod{100};
  static constexpr std::chrono::milliseconds kReconnect{1000};
  static constexpr double kRate =
      20;  // commands a second: a frame of 16 bytes at 9600 baud takes 17 ms both ways

 private:
  std::string connect(Time now);
  void send(const visca::Message& message);
  void send_drive(Time now);
  void read(Time now);
  void handle(const visca::Reply& reply, Time now);
  bool beyond(double position, int step, const motion::AxisLimits& axis) const;

  ViscaOptions options_;
  motion::Limits limits_;
  ByteStream stream_;
  visca::Cutter cutter_;
  std::uint32_t sequence_ = 0;
  int pan_ = 0, tilt_ = 0;            // steps wanted
  int sent_pan_ = 0, sent_tilt_ = 0;  // steps sent last
  bool waiting_ = false;              // for the answer to the last command
  bool acknowledges_ = false, reports_ = false, stopping_ = false;
  int stops_ = 0;         // sent without an answer
  int answers_owed_ = 0;  // while stopping: to commands before the stop, and to the stop
  Time sent_{}, asked_{}, tried_{};
  std::optional<Time> unanswered_;  // since when a camera that answers has not answered
  bool moved_ = false;              // a drive was sent, and no stop after it is acknowledged
  bool connected_ = false;          // the last time that tick() looked
  std::optional<PoseLine> pose_, last_pose_;
  Time pose_time_{};
  std::string fault_;
};

}  // namespace cerberus::drivers
