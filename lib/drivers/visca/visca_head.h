// SPDX-License-Identifier: LGPL-2.1-or-later
// A camera that speaks VISCA, over a serial line, UDP (with and without the header of VISCA over IP) or TCP.
//
// At most one move is on its way: the newest waits until the camera acknowledges the last one, refuses it, or has not
// answered for kAnswerTime. A camera that has never acknowledged anything is sent commands at its rate. Stop goes out
// at once, and again until it is acknowledged. Which command an answer belongs to is known from its sequence number,
// where the line has these and the camera counts, else from the order: a camera answers in the order in which it was
// asked. Positions are
// asked for every kInquiryPeriod, where the camera answers; one without them is sent the same speed again while it
// turns.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "drivers/transport/stream_device.h"
#include "drivers/visca/visca.h"

namespace cerberus::drivers {

struct ViscaOptions {
  std::string device;  // byte_stream.h
  int baud = 9600;
  int address = 1;     // 1 to 7, of a serial chain; 1 over IP
  bool header = true;  // over UDP
  // The number in every header, for cameras that do not count: they refuse numbers above 3, answer with always the same
  // one, or without a header. Nothing: the driver counts.
  std::optional<std::uint32_t> sequence{};
  bool feedback = true;  // ask for positions
  double zoom = -1;      // the position of the zoom to keep (visca.h); negative: whatever it is
  visca::SpeedTable speeds = visca::default_speed_table();
  // Called for what is wrong and keeps no head from turning; empty: nothing is.
  std::function<void(const std::string&)> warn{};
};

class ViscaHead final : public StreamDevice {
 public:
  explicit ViscaHead(const ViscaOptions& options)
      : StreamDevice("VISCA camera", options.device, options.baud), options_(options) {
    unanswered_orders_.reserve(kMostOrders);
  }
  std::string check() const override;
  // Blocks to learn whether the camera answers position inquiries: up to kFirstAnswerTime, and once it answers anything
  // until it is silent for kAnswerTime. A camera that answers nothing is warned of, one whose bytes are no
  // VISCA is refused: its baud rate is another one.
  std::string open(const HeadSetup& setup, Time now) override;
  HeadAbilities abilities() const override;
  void move(const motion::AxisCommand& pan, const motion::AxisCommand& tilt, Time now) override;
  void limit(const motion::Limits& limits, Time now) override;
  void stop(Time now) noexcept override;
  bool stopping() const override { return stopping_; }
  void home(Time now) override;
  std::optional<HomedLine> take_homed(Time now) override;
  Time tick(Time now) override;
  std::optional<PoseLine> take_pose(Time now) override;
  std::optional<double> take_zoom() override { return std::exchange(zoom_, std::nullopt); }
  void zoom(double position, Time now) override;

  static constexpr std::chrono::milliseconds kAnswerTime{
      200};  // VISCA: an answer within 16 ms; slow firmwares need more
  // A camera or a network that is busy when the connection is made. chosen: 5 times kAnswerTime.
  static constexpr std::chrono::milliseconds kFirstAnswerTime{1000};
  static constexpr std::size_t kLeastReply = 3;  // bytes of the shortest; fewer may be noise of the line
  static constexpr std::chrono::milliseconds kStopAgain{100};
  static constexpr int kStopsWithoutAnswer = 5;  // to a camera that never acknowledged anything
  static constexpr std::chrono::milliseconds kInquiryPeriod{100};
  static constexpr std::chrono::milliseconds kSameAgain{
      150};  // and the silence after which a camera is lost: below 1 s
  static constexpr std::chrono::milliseconds kZoomPeriod{500};
  static constexpr int kZoomInquiries = 3;  // without an answer, after which the camera is asked seldom
  static constexpr std::chrono::milliseconds kZoomSeldom{10000};
  // Inquiries of the version, from a camera at rest that reports no position: whether it is there.
  static constexpr int kVersionInquiries = 3;  // without an answer, after which the camera is asked no more
  static constexpr std::chrono::milliseconds kForgotten{1000};  // an answer that has not come by then is lost
  // Answers without the number of a command, more than those with one, before it is said that the camera does not count.
  // chosen: not those that a lost connection left on their way. A number that was refused counts for so many: a camera
  // that refuses those above 3 answers four before.
  static constexpr int kMostStrangeNumbers = 10, kRefusedNumber = 6;
  static constexpr double kRate =
      20;  // commands a second: a frame of 16 bytes at 9600 baud takes 17 ms both ways

 private:
  enum class Order : std::uint8_t { move, stop, home, zoom };
  struct Sent {
    Order order = Order::move;
    std::uint32_t sequence = 0;
    Time time{};
  };
  void on_connected(Time now) override;
  bool has_header() const { return stream_.datagrams() && options_.header; }
  bool numbered() const { return has_header() && !options_.sequence; }
  void reset_sequence();
  void send(const visca::Message& message);
  void send_order(Order order, const visca::Message& message, Time now);
  void send_drive(Time now);
  void repeat_stop(Time now);
  void ask_zoom(Time now);
  void ask_version(Time now);
  void send_zoom(Time now);
  void on_zoom(double position, Time now);
  std::string check_answers() const;
  void count_number(int strange);
  void read(Time now);
  // number: of the command that is answered; nothing: the answer carries none.
  void handle(const visca::Reply& reply, std::optional<std::uint32_t> number, Time now);
  std::optional<Sent> answered(std::optional<std::uint32_t> number);
  bool waiting() const { return !unanswered_orders_.empty(); }

  ViscaOptions options_;
  visca::Cutter cutter_;
  std::uint32_t sequence_ = 0;
  int pan_ = 0, tilt_ = 0;                        // steps wanted
  int sent_pan_ = 0, sent_tilt_ = 0;              // steps sent last
  static constexpr std::size_t kMostOrders = 64;  // more than are sent in kForgotten
  std::vector<Sent> unanswered_orders_;           // the oldest first
  bool acknowledges_ = false, stopping_ = false;
  bool repeated_ =
      false;  // the last move was the same as the one before it: a new one does not wait for its answer
  bool has_answered_ = false;  // this camera, whatever
  std::size_t received_ = 0;   // bytes
  bool has_visca_ = false;     // a message has come, which may be an echo
  int strange_numbers_ = 0;    // answers that carry no number of a command, less those that do
  bool warned_of_numbers_ = false;
  int stops_ = 0;  // sent without an answer
  Time sent_{}, asked_{};
  std::optional<Time> unanswered_;  // since when a camera that answers has not answered
  bool moved_ = false;              // a drive was sent, and no stop after it is acknowledged
  std::optional<int> homing_;       // on its way to its home: the socket of the command, 0 before its answer
  bool homed_ = false;
  std::optional<PoseLine> pose_, last_pose_;
  Time pose_time_{};
  std::optional<double> zoom_;  // read, and not taken yet
  Time zoom_asked_{}, zoom_sent_{};
  int zoom_unanswered_ = 0;  // inquiries
  Time version_asked_{};
  int versions_asked_ = 0;
  bool tells_version_ = false;  // it has answered such an inquiry
  std::optional<double>
      zoom_order_;  // not sent yet: a locked zoom waits until the stop at the start was answered
};

}  // namespace cerberus::drivers
