// SPDX-License-Identifier: LGPL-2.1-or-later
// A pan-tilt camera that speaks ONVIF.
//
// No call waits for the camera, but open(). At most one move and one position inquiry are on their way; the newest move
// waits for the answer to the last one. A move carries a Timeout, after which the camera shall stop by itself, and is
// sent again before it is over; nothing relies on that. A camera that refuses such a move is sent it once without.
//
// Stop goes out at once, whatever is on its way, and again until the camera has acknowledged one that was sent when no
// move was on its way: cameras obey requests of two connections in any order. A camera that reports that it still moves
// after that is sent Stop again.
//
// A camera without positions is reckoned to turn as it was sent last, until the Stop that it has acknowledged was sent or
// its Timeout is over. So is one whose reports do not follow its turns (position_proof.h); before one has, no angle is
// sent as such.
//
// A camera that does not answer, or refuses connections, is a fault. It is sent Stop and a new login until it answers;
// then it stands until the next move.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "drivers/helper/head_device.h"
#include "drivers/helper/speed_reckoning.h"
#include "drivers/onvif/approach.h"
#include "drivers/onvif/homing.h"
#include "drivers/onvif/login.h"
#include "drivers/onvif/position_proof.h"
#include "drivers/onvif/spaces.h"
#include "drivers/onvif/zoom_lock.h"

namespace cerberus::drivers {

struct OnvifOptions {
  onvif::LoginOptions login;
  onvif::Mechanics mechanics;
  bool feedback = true;  // use the positions that the camera reports
  bool absolute = true;  // go to angles by AbsoluteMove, where the camera has it
  // A camera without positions finds a lost reference by its home position, or by the preset of the login, which looks
  // straight ahead.
  bool home = false;
  std::chrono::milliseconds home_time{10000};         // until it is there, where MoveStatus does not say so
  Time login_time = std::chrono::milliseconds(4500);  // derived: the pipeline waits 5 s for a helper
  // A camera that has not answered for so long is gone. Derived: reported within 1 s of its last sign.
  std::chrono::milliseconds answer_time{750};
  // Called for what is wrong and keeps no head from turning; empty: nothing is.
  std::function<void(const std::string&)> warn;
};

struct OnvifParameters {
  Time request_time =
      std::chrono::milliseconds(2000);  // derived: then the next move is worth more than an answer
  Time stop_again = std::chrono::milliseconds(150);  // derived: three tries within helper-timeout
  unsigned most_stops = 4;     // on their way at once; derived: connections that small cameras accept
  int stops_while_moving = 5;  // to a camera that acknowledges Stop and reports that it moves
  int most_unreadable = 5;     // answers in a row; derived: a second of position inquiries
  Time inquiry_period =
      std::chrono::milliseconds(200);  // of the position, which also shows that the camera is there
  Time camera_timeout = std::chrono::milliseconds(1000);  // in a move; AutoPTZ 2.2 uses 1 s, too
  Time reconnect = std::chrono::milliseconds(500);
  Time after_refusal = std::chrono::seconds(30);  // cameras lock a user out after some wrong logins
  Time after_fault = std::chrono::seconds(5);     // then a refused move is tried again
  Time fresh = std::chrono::milliseconds(1000);   // an older position is none; derived: five inquiries
  Time zoom_fresh =
      std::chrono::milliseconds(500);  // an older order of the zoom is dropped. derived: two are due since
  double rate = 10;                    // commands a second; derived: 0.1 s a request on a slow camera
  double least_change = 0.1;           // degrees a second: a smaller change is not sent
};
inline constexpr OnvifParameters kOnvifParameters{};

class OnvifHead final : public HeadDevice {
 public:
  OnvifHead(std::unique_ptr<onvif::HttpClient> http, OnvifOptions options);
  // Blocks up to OnvifOptions::login_time.
  std::string open(const HeadSetup& setup, Time now) override;
  HeadAbilities abilities() const override;
  void move(const motion::AxisCommand& pan, const motion::AxisCommand& tilt, Time now) override;
  void limit(const motion::Limits& limits, Time now) override;
  void stop(Time now) noexcept override;
  void home(Time now) override;
  std::optional<HomedLine> take_homed(Time now) override;
  std::optional<SpeedsLine> take_speeds(Time now) override;
  bool busy() const override { return homing_.busy(); }
  bool stopping() const override { return stopping_ || verifying_; }
  void watch(std::vector<pollfd>& fds) const override;
  Time tick(Time now) override;
  std::optional<PoseLine> take_pose(Time now) override;
  std::optional<double> take_zoom() override { return std::exchange(zoom_, std::nullopt); }
  void zoom(double position, Time now) override;
  std::string fault() const override { return fault_; }

 private:
  struct SentStop {
    unsigned id;
    Time time;
    bool last;  // no move was on its way when it was sent
  };

  std::string camera_name() const { return "the ONVIF camera at " + options_.login.device.name(); }
  void read(Time now);
  void on_login(Time now);
  void on_stop(const SentStop& sent, const onvif::SoapAnswer& answer, Time now);
  void on_move(const onvif::SoapAnswer& answer, Time now);
  // A move of this kind was refused by this fault: it is sent again in another form, or given up.
  void on_refused_move(bool angle, const onvif::Fault& fault, Time now);
  void on_status(const onvif::SoapAnswer& answer, Time now);
  void on_position(const onvif::Angles& at, Time now);
  void warn_of_unused_range();
  std::string beyond_range() const;
  void warn_once(bool& warned, const std::string& text);
  void on_zoom(double position, Time now);
  void send_zoom(Time now);
  void count_failures(const onvif::SoapAnswer& answer, Time now);
  void refuse(const onvif::Fault& fault, Time now);
  void lose(const std::string& why, Time now);
  void log_in_again(Time now);
  void begin_stop(Time now);
  void send_stop(Time now);
  void send_stops(Time now);
  void send_move(Time now);
  void send_absolute(Time now);
  void send_home(Time now);
  void send_inquiry(Time now);
  bool goes_to_an_angle() const;
  bool has_position(Time now) const;
  // The velocities that the commands ask for now, as the camera can execute them.
  onvif::PanTilt wanted_velocity(Time now) const;
  void on_sent(const onvif::Angles& velocity, Time now);
  Time camera_timeout() const;
  unsigned send(const onvif::Request& request, Time now);

  OnvifOptions options_;
  onvif::SoapClient soap_;
  onvif::Login login_;
  onvif::Camera camera_;
  std::vector<onvif::Space> spaces_;  // for velocities, best first
  std::optional<onvif::Space> position_space_;
  motion::Limits limits_;
  motion::AxisCommand pan_, tilt_;
  onvif::Angles sent_velocity_;      // of the last move; 0: it is to be sent again, or the camera is to stand
  bool sent_angle_ = false;          // the AbsoluteMove of pan_ and tilt_ was sent
  Time sent_{};                      // of the last move
  unsigned move_ = 0, inquiry_ = 0;  // requests on their way
  std::vector<SentStop> stops_;      // likewise
  Time stop_sent_{}, inquiry_sent_{}, login_tried_{}, move_refused_until_{};
  Time retry_ = kOnvifParameters.reconnect;
  bool online_ = false;
  bool stopping_ = false;       // no stop is acknowledged that counts
  bool verifying_ = false;      // one is, and the camera has not reported rest
  bool moved_ = false;          // a move was sent, and no stop after it is acknowledged
  bool stops_by_zero_ = false;  // Stop is refused: a move at speed 0 takes its place
  // Whether moves carry a Timeout; tried_without: one that was refused is sent without, to see whether that was the reason.
  enum class Timeouts : std::uint8_t { given, tried_without, refused } timeouts_ = Timeouts::given;
  bool tries_ = false;  // the move on its way is that trial
  bool warned_of_timeout_ = false, warned_of_range_ = false, warned_of_reports_ = false;
  bool positions_ = false;     // they are reported, and not known to be false
  bool told_speeds_ = false;   // to the pipeline, which reckons by them from then on
  bool absolute_ = false;      // AbsoluteMove is there, and was never refused
  bool keeps_limits_ = false;  // it was there at the start, so that the pipeline sends angles and bare speeds
  PositionProof reports_;
  std::optional<double> zoom_;                    // read, and not taken yet
  bool seen_moving_ = false, seen_idle_ = false;  // MoveStatus had both values: it is alive
  int failures_ = 0, unreadable_ = 0;             // answers in a row that did not arrive, or are no SOAP
  int stops_while_moving_ = 0;
  SpeedReckoning reckoned_;  // for a camera without positions
  onvif::ZoomLock zoom_lock_;
  std::optional<double> zoom_order_;  // not sent yet
  Time zoom_ordered_{};
  onvif::Homing homing_;
  std::optional<PoseLine> pose_;
  std::optional<onvif::Angles> position_;  // last measured
  Time position_time_{};
  std::string fault_;
};

}  // namespace cerberus::drivers
