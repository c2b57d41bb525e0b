// SPDX-License-Identifier: LGPL-2.1-or-later
// A process that drives a head is killed (SIGKILL) at random moments while the head turns: the helper process stops the
// head, measured at the far side. CERBERUS_KILLS in the environment: how often for each driver (2), and within 500 ms.
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <random>
#include <string>
#include <thread>

#include "drivers/helper/helper_head.h"
#include "sensing/angles.h"
#include "support/pelco_camera.h"
#include "support/time_bounds.h"
#include "support/visca_camera.h"

#include "support/suite.h"

using namespace cerberus::drivers;
using namespace std::chrono_literals;
using cerberus::sensing::radians;
using cerberus::tests::in_time;
using cerberus::tests::kPatience;
using cerberus::tests::PelcoCamera;
using cerberus::tests::ViscaCamera;
using Clock = std::chrono::steady_clock;
using Kind = cerberus::motion::AxisCommand::Kind;

namespace {

int kills() {
  const char* asked = std::getenv("CERBERUS_KILLS");
  return asked ? std::atoi(asked) : 2;
}

std::mt19937& random_numbers() {
  static std::mt19937 random(17);
  return random;
}

// Drives the head to and fro until it is killed. Its setup comes through the pipe, because the far side has a thread,
// and a process with threads had better not fork.
[[noreturn]] void drive(const char* driver, int pipe) {
  char text[512] = {};
  if (::read(pipe, text, sizeof text - 1) <= 0) ::_exit(1);
  HeadSetup setup;
  setup.helper = std::getenv("CERBERUS_HEAD");
  setup.device = setup.command = text;
  HelperHead head(driver);
  if (const std::string wrong = head.open(setup); !wrong.empty()) {
    std::fprintf(stderr, "%s\n", wrong.c_str());
    ::_exit(1);
  }
  const auto begin = Clock::now();
  for (int n = 0;; ++n) {
    const Time now = Clock::now() - begin;
    head.command({now, {Kind::velocity, radians(n / 20 % 2 ? -30 : 30), 0}, {}});
    std::this_thread::sleep_for(40ms);
  }
}

pid_t begin(const char* driver, int& to_child) {
  int ends[2];
  if (::pipe(ends) != 0) std::abort();
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(ends[1]);
    drive(driver, ends[0]);
  }
  ::close(ends[0]);
  to_child = ends[1];
  return child;
}

void tell(int to_child, const std::string& text) {
  if (::write(to_child, text.data(), text.size()) < 0) std::abort();
  ::close(to_child);
}

Clock::time_point kill_soon(pid_t child) {
  std::this_thread::sleep_for(std::chrono::microseconds(random_numbers()() % 400000));
  ::kill(child, SIGKILL);
  const auto killed = Clock::now();
  ::waitpid(child, nullptr, 0);
  return killed;
}

template <typename Camera>
void kill_with(const char* driver, auto make) {
  double worst = 0;
  for (int n = 0; n < kills(); ++n) {
    int to_child = -1;
    const pid_t child = begin(driver, to_child);
    auto camera = make();
    tell(to_child, camera->device());
    for (const auto end = Clock::now() + kPatience; camera->speed() == 0 && Clock::now() < end;)
      std::this_thread::sleep_for(1ms);
    ck_assert_msg(camera->speed() != 0, "%s does not turn", driver);
    const auto killed = kill_soon(child);
    while (camera->speed() != 0 && Clock::now() < killed + kPatience) std::this_thread::sleep_for(1ms);
    ck_assert(camera->speed() == 0);
    const double took = std::chrono::duration<double>(camera->stopped() - killed).count();
    ck_assert_msg(in_time(camera->stopped() - killed, 500ms), "%s stopped after %.3f s", driver, took);
    worst = std::max(worst, took);
    std::this_thread::sleep_for(300ms);
    ck_assert_msg(camera->speed() == 0, "%s turns again", driver);
  }
  std::printf("%s: %d kills, stopped after %.1f ms at most\n", driver, kills(), worst * 1e3);
}

}  // namespace

START_TEST(a_visca_camera_stops) {
  kill_with<ViscaCamera>("visca", [] { return std::make_unique<ViscaCamera>(ViscaCamera::Line::udp); });
}
END_TEST

START_TEST(a_pelco_head_stops) {
  kill_with<PelcoCamera>("pelco-d", [] { return std::make_unique<PelcoCamera>(); });
}
END_TEST

START_TEST(a_helper_of_the_users_own_sees_the_end) {
  const std::string file = "/tmp/cerberus-killed-" + std::to_string(::getpid());
  for (int n = 0; n < kills(); ++n) {
    std::remove(file.c_str());
    int to_child = -1;
    const pid_t child = begin("external", to_child);
    tell(to_child, "sh -c 'read a; echo ready 1 velocity; read b; echo moves >" + file +
                       "; while read c; do :; done; echo end >>" + file + "'");
    const auto has = [&](const char* word) {
      std::ifstream in(file);
      for (std::string line; std::getline(in, line);)
        if (line == word) return true;
      return false;
    };
    for (const auto end = Clock::now() + kPatience; !has("moves") && Clock::now() < end;)
      std::this_thread::sleep_for(1ms);
    const auto killed = kill_soon(child);
    while (!has("end") && Clock::now() < killed + kPatience) std::this_thread::sleep_for(1ms);
    ck_assert(has("end"));
    ck_assert(in_time(Clock::now() - killed, 500ms));
  }
  std::remove(file.c_str());
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "killed", {a_visca_camera_stops, a_pelco_head_stops, a_helper_of_the_users_own_sees_the_end}, 200);
}
