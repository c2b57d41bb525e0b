// SPDX-License-Identifier: LGPL-2.1-or-later
// The example head for GRBL boards, pipelines/heads/grbl.py, against a board on a pseudo-terminal that is written from
// GRBL 1.1's documentation: jogs are planned one after the other, 0x85 drops them, ? reports.
#include <poll.h>
#include <pty.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <mutex>
#include <string>
#include <thread>

#include "drivers/helper/helper_head.h"
#include "sensing/angles.h"
#include "support/suite.h"
#include "support/text.h"

using namespace cerberus::drivers;
using namespace std::chrono_literals;
using cerberus::sensing::degrees;
using cerberus::sensing::radians;
using cerberus::tests::assert_text;
using Clock = std::chrono::steady_clock;
using Kind = cerberus::motion::AxisCommand::Kind;

namespace {

class GrblBoard {
 public:
  // deaf: it overlooks the jog cancel, and the feed hold holds it until a reset.
  explicit GrblBoard(bool alarm = false, bool deaf = false)
      : alarm_(alarm), deaf_(deaf), last_(Clock::now()) {
    char name[128];
    if (::openpty(&fd_, &slave_, name, nullptr, nullptr) != 0) std::abort();
    path_ = name;
    thread_ = std::thread([this] { run(); });
  }
  ~GrblBoard() {
    end_ = true;
    thread_.join();
    ::close(fd_);
    ::close(slave_);
  }
  const std::string& path() const { return path_; }
  double pan() {
    const std::lock_guard guard(lock_);
    advance();
    return x_;
  }
  double tilt() {
    const std::lock_guard guard(lock_);
    advance();
    return y_;
  }
  bool moves() {
    const std::lock_guard guard(lock_);
    advance();
    return !jogs_.empty();
  }
  int cancels() const { return cancels_; }
  bool held() const { return held_; }

 private:
  struct Jog {
    double x, y, seconds;
  };
  void advance() {
    const auto now = Clock::now();
    double dt = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    while (!jogs_.empty() && dt > 0) {
      Jog& jog = jogs_.front();
      const double part = std::min(1.0, dt / jog.seconds);
      x_ += jog.x * part;
      y_ += jog.y * part;
      dt -= jog.seconds * part;
      jog = {jog.x * (1 - part), jog.y * (1 - part), jog.seconds * (1 - part)};
      if (part == 1) jogs_.pop_front();
    }
  }
  void answer(const std::string& text) {
    if (::write(fd_, text.data(), text.size()) < 0) end_ = true;
  }
  void obey(const std::string& line) {
    double x = 0, y = 0, f = 0;
    if (std::sscanf(line.c_str(), "$J=G91 X%lf Y%lf F%lf", &x, &y, &f) != 3 || !(f > 0) || alarm_)
      return answer("error:9\r\n");
    const std::lock_guard guard(lock_);
    advance();
    if (held_) return answer("error:9\r\n");  // locked out
    jogs_.push_back({x, y, std::hypot(x, y) / f * 60});
    answer("ok\r\n");
  }
  void run() {
    std::string line;
    while (!end_) {
      pollfd wait{fd_, POLLIN, 0};
      if (::poll(&wait, 1, 5) != 1) continue;
      char bytes[256];
      const ssize_t got = ::read(fd_, bytes, sizeof bytes);
      for (ssize_t i = 0; i < got; ++i) {
        if (bytes[i] == '?') {
          const std::lock_guard guard(lock_);
          advance();
          char text[100];
          std::snprintf(text, sizeof text, "<%s|MPos:%.3f,%.3f,0.000|FS:0,0>\r\n",
                        alarm_           ? "Alarm"
                        : held_          ? "Hold:0"
                        : !jogs_.empty() ? "Jog"
                                         : "Idle",
                        x_, y_);
          answer(text);
        } else if (bytes[i] == '\x18') {
          held_ = false;
          answer("\r\nGrbl 1.1h ['$' for help]\r\n");
        } else if (bytes[i] == '\x85' || bytes[i] == '!') {
          if (deaf_ && bytes[i] == '\x85') continue;
          const std::lock_guard guard(lock_);
          advance();
          held_ = deaf_;
          jogs_.clear();
          ++cancels_;
        } else if (bytes[i] == '\n') {
          obey(line);
          line.clear();
        } else {
          line += bytes[i];
        }
      }
    }
  }

  bool alarm_, deaf_;
  std::atomic<bool> held_{false};
  std::string path_;
  int fd_ = -1, slave_ = -1;
  std::mutex lock_;
  double x_ = 0, y_ = 0;
  std::deque<Jog> jogs_;
  Clock::time_point last_;
  std::atomic<int> cancels_{0};
  std::atomic<bool> end_{false};
  std::thread thread_;
};

HeadSetup setup_for(const GrblBoard& board) {
  HeadSetup setup;
  setup.command =
      "python3 " + std::string(std::getenv("CERBERUS_SOURCE")) + "/pipelines/heads/grbl.py " + board.path();
  return setup;
}

Time running_time() {
  static const Clock::time_point begin = Clock::now();
  return Clock::now() - begin;
}

template <typename Holds>
bool soon(Holds holds) {
  for (const auto end = Clock::now() + 60s; Clock::now() < end; std::this_thread::sleep_for(5ms))
    if (holds()) return true;
  return false;
}

// Gives the order again and again until `holds`: on a loaded machine the helper's watchdog may have stopped the head.
template <typename Holds>
bool drives(HelperHead& head, const cerberus::motion::AxisCommand& pan, Holds holds) {
  return soon([&] {
    head.command({running_time(), pan, {}});  // one that fails is repeated
    return holds();
  });
}

}  // namespace

START_TEST(a_board_goes_where_it_is_sent_and_rests) {
  GrblBoard board;
  HelperHead head("external");
  assert_text(head.open(setup_for(board)), "");
  ck_assert(drives(head, {Kind::position, radians(12), radians(30)},
                   [&] { return std::abs(board.pan() - 12) < 0.7 && !board.moves(); }));
  cerberus::motion::Pose pose;
  ck_assert(soon([&] { return head.state(running_time(), pose).empty() && pose.measured; }));
}
END_TEST

START_TEST(the_end_of_the_pipeline_cancels_the_jogs) {
  GrblBoard board;
  {
    HelperHead head("external");
    assert_text(head.open(setup_for(board)), "");
    ck_assert(drives(head, {Kind::velocity, radians(20), 0}, [&] { return board.pan() > 2; }));
    const int before = board.cancels();
    head.close();
    ck_assert(soon([&] { return board.cancels() > before && !board.moves(); }));
  }
}
END_TEST

START_TEST(a_board_is_not_driven_beyond_its_limits) {
  GrblBoard board;
  HelperHead head("external");
  HeadSetup setup = setup_for(board);
  setup.limits.pan.to = radians(5);
  assert_text(head.open(setup), "");
  ck_assert(drives(head, {Kind::velocity, radians(20), 0}, [&] { return board.pan() > 4; }));
  // It stands for a second: more than the jogs that wait.
  double pan = board.pan();
  auto since = Clock::now();
  ck_assert(soon([&] {
    if (const double at = board.pan(); at != pan) {
      pan = at;
      since = Clock::now();
    }
    return Clock::now() - since >= 1s;
  }));
  ck_assert_double_le(pan, 5.5);
}
END_TEST

START_TEST(an_axis_that_stops_while_the_other_goes_on_cancels_the_jogs) {
  GrblBoard board;
  HelperHead head("external");
  assert_text(head.open(setup_for(board)), "");
  // Pan is far from its limit, where it would be stopped, for more than a minute.
  const cerberus::motion::AxisCommand slowly{Kind::velocity, radians(2), 0},
      turn{Kind::velocity, radians(5), 0};
  const auto order = [&](const cerberus::motion::AxisCommand& tilt, auto holds) {
    return soon([&] {
      head.command({running_time(), slowly, tilt});
      return holds();
    });
  };
  ck_assert(order(turn, [&] { return board.pan() > 1 && board.tilt() > 1; }));
  const int before = board.cancels();
  ck_assert(order({}, [&] { return board.cancels() > before || board.pan() > 150; }));
  ck_assert_double_le(board.pan(), 150);
  const double there = board.pan();
  ck_assert(order({}, [&] { return board.pan() > there + 0.5; }));
}
END_TEST

START_TEST(a_board_that_only_a_feed_hold_stops_moves_again_after_it) {
  GrblBoard board(false, true);
  HelperHead head("external");
  assert_text(head.open(setup_for(board)), "");
  const int before = board.cancels();
  // A head that its watchdog has stopped rests already and needs no hold.
  ck_assert(soon([&] {
    const double there = board.pan();
    return drives(head, {Kind::velocity, radians(20), 0}, [&] { return board.pan() > there + 1; }) &&
           (head.stop(running_time()), soon([&] { return !board.moves() && !board.held(); })) &&
           board.cancels() > before;
  }));
  const double there = board.pan();
  ck_assert(drives(head, {Kind::velocity, radians(20), 0}, [&] { return board.pan() > there + 1; }));
}
END_TEST

START_TEST(a_board_in_alarm_is_refused_with_what_to_do) {
  GrblBoard board(true);
  HelperHead head("external");
  assert_text(head.open(setup_for(board)), "the GRBL board is in alarm: home it ($H) or unlock it ($X)");
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "grbl",
      {a_board_goes_where_it_is_sent_and_rests, the_end_of_the_pipeline_cancels_the_jogs,
       a_board_is_not_driven_beyond_its_limits, an_axis_that_stops_while_the_other_goes_on_cancels_the_jogs,
       a_board_that_only_a_feed_hold_stops_moves_again_after_it, a_board_in_alarm_is_refused_with_what_to_do},
      200);
}
