// SPDX-License-Identifier: LGPL-2.1-or-later
// Hardware that the kernel simulates, made and unmade through configfs and sysfs. Inside the virtual machine only.
#pragma once

#include <sys/mount.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace simulated {

inline void must(bool good, const std::string& what) {
  if (good) return;
  std::perror(what.c_str());
  std::abort();
}

inline void write_text(const std::string& path, const std::string& text) {
  std::ofstream file(path);
  file << text << std::flush;
  must(file.good(), "write " + path);
}

inline std::string read_text(const std::string& path) {
  std::ifstream file(path);
  std::string text;
  must(static_cast<bool>(std::getline(file, text)), "read " + path);
  return text;
}

inline void make_folder(const std::string& path) {
  must(mkdir(path.c_str(), 0755) == 0, "mkdir " + path);
}

// A gpio-sim chip. Lines 0 .. lines - 1; line 1 is named "door".
class Chip {
 public:
  // Tests run in processes of their own: one that died leaves its chip to itself.
  explicit Chip(int lines = 12)
      : label_("chip-" + std::to_string(getpid())), config_("/sys/kernel/config/gpio-sim/" + label_) {
    make_folder(config_);
    make_folder(config_ + "/bank0");
    write_text(config_ + "/bank0/num_lines", std::to_string(lines));
    write_text(config_ + "/bank0/label", label_);
    make_folder(config_ + "/bank0/line1");
    write_text(config_ + "/bank0/line1/name", "door");
    plug();
  }
  ~Chip() {
    unplug();
    rmdir((config_ + "/bank0/line1").c_str());
    rmdir((config_ + "/bank0").c_str());
    must(rmdir(config_.c_str()) == 0, "rmdir " + config_);
  }
  Chip(const Chip&) = delete;

  const std::string& name() const { return name_; }  // gpiochip0
  const std::string& label() const { return label_; }
  std::string path() const { return "/dev/" + name_; }
  void pull(int line, bool up) { write_text(attribute(line, "pull"), up ? "pull-up" : "pull-down"); }
  int value(int line) const { return std::stoi(read_text(attribute(line, "value"))); }
  void unplug() {
    if (plugged_) write_text(config_ + "/live", "0");
    plugged_ = false;
  }
  void plug() {
    write_text(config_ + "/live", "1");
    device_ = read_text(config_ + "/dev_name");
    name_ = read_text(config_ + "/bank0/chip_name");
    plugged_ = true;
  }

 private:
  std::string attribute(int line, const char* which) const {
    return "/sys/devices/platform/" + device_ + "/" + name_ + "/sim_gpio" + std::to_string(line) + "/" +
           which;
  }

  std::string label_, config_, device_, name_;
  bool plugged_ = false;
};

// Of the motor on the lines 2 to 5, which are read one after the other.
inline bool coils_off(const Chip& chip) {
  for (int line = 2; line <= 5; ++line)
    if (chip.value(line) != 0) return false;
  return true;
}

// Waits until the coils are on or off, for at most `most`. Returns how long it took; nothing: they are not. Ten reads must
// agree: while the motor steps, four lines that are read one after the other may all be off.
inline std::optional<std::chrono::steady_clock::duration> wait_coils(
    const Chip& chip, bool off, std::chrono::steady_clock::duration most) {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  auto since = begin;  // the first of the reads that agree
  for (int agreeing = 0; Clock::now() - begin < most;
       std::this_thread::sleep_for(std::chrono::milliseconds(1))) {
    const auto now = Clock::now();
    agreeing = coils_off(chip) == off ? agreeing + 1 : 0;
    if (agreeing == 1) since = now;
    if (agreeing == 10) return since - begin;
  }
  return std::nullopt;
}

// The IIO dummy: in_voltage0 measures (73 + 7) x 0.001333 mV, for ever (drivers/iio/dummy/iio_simple_dummy.c).
class Converter {
 public:
  Converter() : config_("/sys/kernel/config/iio/devices/dummy/pirs") {
    rmdir(config_.c_str());  // left by a test that died
    make_folder(config_);
  }
  ~Converter() { unplug(); }
  Converter(const Converter&) = delete;

  void unplug() {
    if (plugged_) must(rmdir(config_.c_str()) == 0, "rmdir " + config_);
    plugged_ = false;
  }

 private:
  std::string config_;
  bool plugged_ = true;
};

// What the kernel records of one of its events while this lives.
class Trace {
 public:
  explicit Trace(const std::string& event) : enable_(kFolder + ("/events/" + event + "/enable")) {
    mount("tracefs", kFolder, "tracefs", 0, nullptr);  // it may be there already
    write_text(std::string(kFolder) + "/trace", "");
    write_text(enable_, "1");
  }
  ~Trace() { write_text(enable_, "0"); }
  Trace(const Trace&) = delete;

  int count(const std::string& what) const {
    int found = 0;
    for (const std::string& line : lines()) found += line.find(what) != line.npos;
    return found;
  }
  std::vector<std::string> lines() const {
    std::ifstream file(std::string(kFolder) + "/trace");
    std::vector<std::string> all;
    for (std::string line; std::getline(file, line);) all.push_back(line);
    return all;
  }

 private:
  static constexpr const char* kFolder = "/sys/kernel/tracing";
  std::string enable_;
};

}  // namespace simulated
