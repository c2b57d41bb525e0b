// SPDX-License-Identifier: LGPL-2.1-or-later
// How long it takes in real time, for each driver of a real head, and on request:
//   head_times          from a command to the first byte, edge or value at the far side: at most 5 ms (median; idle machine)
//   head_times kills N  from SIGKILL of the process that drives, at N random moments while the head turns (100), until the
//                       head stands: at most 500 ms each time
// The far sides are those of far_sides.h. stepper-gpio and v4l2 run in a helper of this program with emulated lines and
// controls; those of a kernel are tested in a virtual machine (tests/hardware).
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <csignal>
#include <functional>
#include <random>
#include <thread>
#include <vector>

#include "asked.h"
#include "drivers/helper/helper_head.h"
#include "drivers/helper/helper_loop.h"
#include "drivers/stepper/stepper_head.h"
#include "drivers/v4l2/v4l2_head.h"
#include "far_sides.h"
#include "sensing/angles.h"

using namespace cerberus;
using namespace cerberus::bench;
using namespace std::chrono_literals;
using drivers::HeadSetup;
using sensing::radians;
using Kind = motion::AxisCommand::Kind;

namespace {

std::string program;  // this one

class SharedLines final : public drivers::LinePort {
 public:
  explicit SharedLines(SharedHardware& hardware) : hardware_(hardware) {}
  std::string open(const std::vector<std::string>& outputs, const std::vector<bool>& initial,
                   const std::vector<std::string>&) override {
    levels_ = initial;
    levels_.resize(outputs.size(), false);
    return {};
  }
  void close() noexcept override {}
  int set(std::size_t output, bool level) noexcept override {
    levels_.at(output) = level;
    hardware_.act(hardware_.value + 1);
    hardware_.on = std::ranges::find(levels_, true) != levels_.end();
    return 0;
  }
  int get(std::size_t, bool& level) noexcept override {
    level = false;
    return 0;
  }
  int probe() noexcept override { return 0; }
  void pause(motion::Time) noexcept override {}

 private:
  SharedHardware& hardware_;
  std::vector<bool> levels_;
};

class SharedControls final : public drivers::CameraControls {
 public:
  explicit SharedControls(SharedHardware& hardware) : hardware_(hardware) {}
  int open(const std::string&) override { return 0; }
  void close() noexcept override {}
  std::optional<drivers::ControlRange> query(std::uint32_t control) override {
    if (control != drivers::camera_control::kPanAbsolute) return std::nullopt;
    return drivers::ControlRange{-648000, 648000, 1};
  }
  int get(std::uint32_t, std::int32_t& value) noexcept override {
    value = static_cast<std::int32_t>(hardware_.value);
    return 0;
  }
  int set(std::uint32_t, std::int32_t value) noexcept override {
    hardware_.act(value);
    return 0;
  }
  int probe() noexcept override { return 0; }

 private:
  SharedHardware& hardware_;
};

int serve(const std::string& kind, const std::string& file) {
  for (const int number : {SIGINT, SIGHUP, SIGTERM, SIGPIPE}) std::signal(number, SIG_IGN);
  SharedHardware& hardware = *SharedHardware::map(file);
  std::unique_ptr<drivers::HeadDevice> head;
  if (kind == "stepper-gpio") {
    drivers::StepperOptions options;
    options.chip = "emulated";
    if (!drivers::parse_stepper_axis("lines=1,2,3,4", options.pan).empty()) return 2;
    head = std::make_unique<drivers::StepperHead>(options, std::make_unique<SharedLines>(hardware));
  } else {
    head = std::make_unique<drivers::V4l2Head>(
        drivers::V4l2Options{.device = "emulated", .mode = drivers::V4l2Options::Mode::absolute},
        std::make_unique<SharedControls>(hardware));
  }
  return drivers::serve_head(0, 1, *head);
}

struct Case {
  const char* name;
  const char* driver;  // of HelperHead
  std::function<std::unique_ptr<FarSide>()> make;
};

std::vector<Case> cases() {
  using Line = tests::ViscaCamera::Line;
  const auto shared = [](const char* kind) {
    return [kind] { return std::make_unique<SharedSide>(program, kind); };
  };
  return {{"visca, serial", "visca", [] { return std::make_unique<ViscaSide>(Line::serial); }},
          {"visca, udp", "visca", [] { return std::make_unique<ViscaSide>(Line::udp); }},
          {"visca, tcp", "visca", [] { return std::make_unique<ViscaSide>(Line::tcp); }},
          {"pelco-d", "pelco-d", [] { return std::make_unique<PelcoSide>(); }},
#if HAVE_ONVIF
          {"onvif", "onvif", [] { return std::make_unique<OnvifSide>(); }},
#endif
          {"servo-pwm", "servo-pwm", [] { return std::make_unique<ServoSide>(); }},
          {"stepper-gpio", "external", shared("stepper-gpio")},
          {"v4l2", "external", shared("v4l2")}};
}

[[noreturn]] void die(const std::string& why) {
  std::fprintf(stderr, "head_times: %s\n", why.c_str());
  std::exit(1);
}

HeadSetup complete(HeadSetup setup) {
  setup.helper = std::getenv("CERBERUS_HEAD") ? std::getenv("CERBERUS_HEAD") : "cerberus-head";
  setup.limits.pan = {radians(-170), radians(170), radians(60), radians(600)};
  return setup;
}

template <typename Condition>
bool wait_for(Condition holds, Clock::duration patience, Clock::duration step = 50us) {
  for (const auto end = Clock::now() + patience; !holds(); std::this_thread::sleep_for(step))
    if (Clock::now() >= end) return false;
  return true;
}

// Milliseconds from a command to the far side, sorted.
std::vector<double> measure(const Case& c, int rounds) {
  const std::unique_ptr<FarSide> side = c.make();
  drivers::HelperHead head(c.driver);
  if (const std::string wrong = head.open(complete(side->setup())); !wrong.empty())
    die(std::string(c.name) + ": " + wrong);
  const auto begin = Clock::now();
  const auto command = [&](double speed) {
    const motion::AxisCommand pan{speed == 0 ? Kind::hold : Kind::velocity, radians(speed), 0};
    if (const std::string wrong = head.command({Clock::now() - begin, pan, {}, speed == 0}); !wrong.empty())
      die(std::string(c.name) + ": " + wrong);
  };
  std::vector<double> times;
  for (int n = 0; n < rounds; ++n) {
    command(0);
    if (!wait_for([&] { return !side->turns(); }, 60s, 1ms)) die(std::string(c.name) + " does not stop");
    std::this_thread::sleep_for(300ms);  // the driver's rate, and inquiries at any phase
    std::this_thread::sleep_for(std::chrono::microseconds(n * 7919 % 100000));
    const int before = side->actions();
    const auto sent = Clock::now();
    command(n % 2 ? -20 : 20);
    if (!wait_for([&] { return side->actions() != before; }, 60s))
      die(std::string(c.name) + " does not move");
    times.push_back(std::chrono::duration<double, std::milli>(Clock::now() - sent).count());
    wait_for([&] { return side->turns(); }, 60s, 1ms);
  }
  command(0);
  std::ranges::sort(times);
  return times;
}

// Turns the head to and fro until the end of its life.
int drive(const std::string& driver, const HeadSetup& setup) {
  drivers::HelperHead head(driver);
  if (const std::string wrong = head.open(setup); !wrong.empty()) die(wrong);
  const auto begin = Clock::now();
  for (int n = 0;; ++n) {
    head.command({Clock::now() - begin, {Kind::velocity, radians(n / 20 % 2 ? -30 : 30), 0}, {}});
    std::this_thread::sleep_for(40ms);
  }
}

pid_t begin_driving(const Case& c, const HeadSetup& setup) {
  std::vector<std::string> words{program,       "--drive",     c.driver,    setup.device,
                                 setup.command, setup.options, setup.helper};
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  pid_t child = -1;
  if (::posix_spawn(&child, program.c_str(), nullptr, nullptr, arguments.data(), environ) != 0)
    die("cannot start " + program);
  return child;
}

// Milliseconds until it stood, sorted.
std::vector<double> kill_often(const Case& c, int rounds, std::mt19937& random) {
  std::vector<double> times;
  for (int n = 0; n < rounds; ++n) {
    const std::unique_ptr<FarSide> side = c.make();
    const pid_t child = begin_driving(c, complete(side->setup()));
    if (!wait_for([&] { return side->turns(); }, 60s, 1ms)) die(std::string(c.name) + " does not turn");
    const auto moment = Clock::now() + std::chrono::microseconds(random() % 400000);
    wait_for([&] { return side->turns(), Clock::now() >= moment; }, 1s, 1ms);
    ::kill(child, SIGKILL);
    const auto killed = Clock::now();
    ::waitpid(child, nullptr, 0);
    if (!wait_for([&] { return !side->turns(); }, 10s, 500us)) die(std::string(c.name) + " goes on turning");
    times.push_back(
        std::max(0.0, std::chrono::duration<double, std::milli>(side->stopped() - killed).count()));
    std::this_thread::sleep_for(300ms);
    if (side->turns()) die(std::string(c.name) + " turns again");
  }
  std::ranges::sort(times);
  return times;
}

}  // namespace

int main(int argc, char** argv) {
  program = std::filesystem::read_symlink("/proc/self/exe").string();
  const std::string what = argc > 1 ? argv[1] : "";
  if (what == "--serve" && argc == 4) return serve(argv[2], argv[3]);
  if (what == "--drive" && argc == 7) {
    HeadSetup setup;
    setup.device = argv[3];
    setup.command = argv[4];
    setup.options = argv[5];
    setup = complete(setup);
    setup.helper = argv[6];
    return drive(argv[2], setup);
  }
  const bool kills = what == "kills";
  const int rounds = kills ? (argc > 2 ? std::atoi(argv[2]) : 100) : 40;
  const std::string only = argc > 3 ? argv[3] : "";
  std::mt19937 random(17);
  Asked asked;
  std::printf(kills ? "driver           kills   within 500 ms   median, most ms until it stands\n"
                    : "driver        commands   median, 95 %% ms to the far side\n");
  for (const Case& c : cases()) {
    if (!only.empty() && only != c.name) continue;
    const std::vector<double> times = kills ? kill_often(c, rounds, random) : measure(c, rounds);
    const auto at = [&](double part) {
      return times[static_cast<std::size_t>(part * static_cast<double>(times.size() - 1))];
    };
    if (kills) {
      const auto good = std::ranges::count_if(times, [](double t) { return t < 500; });
      std::printf("%-15s %6d %15d %8.1f %7.1f%s\n", c.name, rounds, static_cast<int>(good), at(.5), at(1),
                  asked.at_least(c.name, static_cast<double>(good), rounds).c_str());
    } else {
      std::printf("%-15s %6d %9.2f %7.2f%s\n", c.name, rounds, at(.5), at(.95),
                  asked.at_most(c.name, at(.5), 5).c_str());
    }
    std::fflush(stdout);
  }
  return asked.verdict();
}
