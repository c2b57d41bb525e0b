// SPDX-License-Identifier: LGPL-2.1-or-later
// External sensors as a command, at a pseudo-terminal and at a FIFO. Time is a parameter: only bytes are waited for.
#include "drivers/external/external_sensor.h"

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <string>

#include "support/says.h"
#include "support/suite.h"

namespace {

using namespace cerberus::drivers;
using namespace std::chrono_literals;

// A microcontroller at a serial port.
class Board {
 public:
  Board() { plug(); }
  ~Board() { unplug(); }
  std::string device() const { return std::string("serial:") + name_; }
  void send(const std::string& text) {
    if (::write(master_, text.data(), text.size()) != static_cast<ssize_t>(text.size()))
      ck_abort_msg("write");
  }
  void unplug() {
    if (slave_ >= 0) ::close(slave_);
    if (master_ >= 0) ::close(master_);
    master_ = slave_ = -1;
  }
  void plug() {
    if (::openpty(&master_, &slave_, name_, nullptr, nullptr) != 0) ck_abort_msg("openpty");
  }

 private:
  int master_ = -1, slave_ = -1;
  char name_[128]{};
};

SensorSetup at(const std::string& device, const std::string& options = "") {
  SensorSetup setup;
  setup.device = device;
  setup.options = options;
  return setup;
}

SensorSetup running(const std::string& command, const std::string& options = "") {
  SensorSetup setup;
  setup.command = command;
  setup.options = options;
  return setup;
}

void open(ExternalSensor& sensor, const SensorSetup& setup) {
  const SensorError error = sensor.open(setup);
  if (error) ck_abort_msg("%s", error.text.c_str());
}

// Waits for bytes and reads them: "sensor:level ...", "-" where nothing is known, "!" where it restarts; an error's
// text instead.
std::string read(ExternalSensor& sensor, Time now, bool wait = true) {
  pollfd waiting{sensor.fd(), POLLIN, 0};
  if (wait && ::poll(&waiting, 1, 20000) != 1) return "nothing came";
  std::vector<SensorEdge> edges;
  if (const SensorError error = sensor.read(now, edges)) return error.text;
  std::string text;
  for (const SensorEdge& edge : edges) {
    ck_assert(edge.time == now);
    const char* level = edge.known ? edge.level ? "1" : "0" : edge.restarts ? "!" : "-";
    text.append(text.empty() ? "" : " ").append(std::to_string(edge.sensor)).append(":").append(level);
  }
  return text;
}

void must_read(ExternalSensor& sensor, Time now, const std::string& expected, bool wait = true) {
  const std::string found = read(sensor, now, wait);
  ck_assert_msg(found == expected, "\"%s\", not \"%s\"", found.c_str(), expected.c_str());
}

void must_refuse(const SensorSetup& setup, SensorFault fault, const std::string& words) {
  ExternalSensor sensor;
  const SensorError error = sensor.open(setup);
  ck_assert_msg(error.fault == fault, "%s", error.text.c_str());
  ck_assert(says(error.text, words));
  ck_assert_int_eq(sensor.fd(), -1);
}

START_TEST(a_board_at_a_serial_port_sends_its_levels) {
  Board board;
  ExternalSensor sensor;
  open(sensor, at(board.device()));
  must_read(sensor, 0s, "", false);  // nothing has come: nothing is known
  board.send("cerberus-pir 1 3\r\nlevels 0 1 0\r\n");
  must_read(sensor, 1s, "0:0 1:1 2:0");
  board.send("lev");
  must_read(sensor, 1100ms, "");
  board.send("els 0 1 -\n");
  must_read(sensor, 1200ms, "0:0 1:1 2:-");
  ck_assert(sensor.outage().empty());
  ck_assert(says(sensor.place(1), "sensor 2 of " + board.device()));
}
END_TEST

START_TEST(a_board_that_vanishes_is_an_outage_until_it_returns) {
  Board board;
  ExternalSensor sensor;
  const std::string link = "/tmp/cerberus-board-" + std::to_string(getpid());
  std::filesystem::create_symlink(board.device().substr(7), link);
  open(sensor, at("serial:" + link));
  board.send("levels 1 1 1\n");
  must_read(sensor, 1s, "0:1 1:1 2:1");
  board.unplug();
  must_read(sensor, 2s, "0:! 1:! 2:!");
  ck_assert_int_eq(sensor.fd(), -1);
  ck_assert(says(sensor.outage(), link + ": the device is gone"));
  must_read(sensor, 2900ms, "", false);  // not tried yet
  ck_assert_int_eq(sensor.fd(), -1);
  must_read(sensor, 3s, "", false);  // tried in vain
  ck_assert_int_eq(sensor.fd(), -1);
  board.plug();
  std::filesystem::remove(link);
  std::filesystem::create_symlink(board.device().substr(7), link);
  must_read(sensor, 4s, "", false);
  ck_assert_int_ge(sensor.fd(), 0);
  ck_assert(!sensor.outage().empty());  // until it has sent levels
  board.send("levels 0 0 1\n");
  must_read(sensor, 4100ms, "0:0 1:0 2:1");
  ck_assert(sensor.outage().empty());
  std::filesystem::remove(link);
}
END_TEST

START_TEST(a_silent_sender_is_an_outage_and_its_readings_are_unknown) {
  Board board;
  ExternalSensor sensor;
  open(sensor, at(board.device(), "silence=2"));
  board.send("levels 0 0 1\n");
  must_read(sensor, 10s, "0:0 1:0 2:1");
  must_read(sensor, 11900ms, "", false);
  must_read(sensor, 12s, "0:- 1:- 2:-", false);
  ck_assert(says(sensor.outage(), "no line of the protocol has come for 2 s"));
  must_read(sensor, 15s, "", false);
  board.send("levels 0 0 1\n");
  must_read(sensor, 16s, "0:0 1:0 2:1");
  ck_assert(sensor.outage().empty());
}
END_TEST

START_TEST(silence_may_be_allowed) {
  Board board;
  ExternalSensor sensor;
  open(sensor, at(board.device(), "silence=0"));
  board.send("levels 0 0 1\n");
  must_read(sensor, 10s, "0:0 1:0 2:1");
  must_read(sensor, 9999s, "", false);
  ck_assert(sensor.outage().empty());
}
END_TEST

START_TEST(a_wrong_baud_rate_is_named_as_the_likely_cause) {
  Board board;
  ExternalSensor sensor;
  open(sensor, at(board.device()));
  board.send("\x80\xf8\x1c\x03\xe0\n\xff\xfe");
  must_read(sensor, 1s, "");
  must_read(sensor, 4s, "", false);
  ck_assert(says(sensor.outage(), "check the baud rate"));
}
END_TEST

START_TEST(a_fault_of_the_sender_is_an_outage_in_its_words) {
  Board board;
  ExternalSensor sensor;
  open(sensor, at(board.device()));
  board.send("levels 0 0 1\nfault the converter is cold\n");
  must_read(sensor, 1s, "0:0 1:0 2:1 0:- 1:- 2:-");
  ck_assert(says(sensor.outage(), "the converter is cold"));
}
END_TEST

START_TEST(a_command_that_ends_is_started_again) {
  ExternalSensor sensor;
  open(sensor, running("echo levels 1 0 0"));
  ck_assert(says(sensor.place(0), "echo"));
  must_read(sensor, 1s, "0:1 1:0 2:0");
  must_read(sensor, 1s, "0:! 1:! 2:!");
  ck_assert(says(sensor.outage(), "has ended"));
  // The first child may still be ending: it is tried once a second. The next one may be as quick as the call.
  std::string found;
  const auto end = std::chrono::steady_clock::now() + 20s;
  for (Time now = 2s; found.empty() && std::chrono::steady_clock::now() < end; now += 1s) {
    found = read(sensor, now, sensor.fd() >= 0);
    ::poll(nullptr, 0, 1);  // for the end of the first child
  }
  ck_assert_str_eq(found.c_str(), "0:1 1:0 2:0");
  ck_assert(sensor.outage().empty());
}
END_TEST

START_TEST(closing_ends_the_command_and_what_it_runs) {
  ExternalSensor sensor;
  open(sensor, running("echo levels 1 0 0; sleep 1000; true"));
  must_read(sensor, 1s, "0:1 1:0 2:0");
  sensor.close();  // waits for its end
  ck_assert_int_eq(sensor.fd(), -1);
}
END_TEST

START_TEST(volts_are_compared_with_the_threshold_and_reported_where_asked) {
  for (const char* options : {"", "volts"}) {
    Board board;
    ExternalSensor sensor;
    SensorSetup setup = at(board.device(), options);
    setup.level = {1.0, 0.4};  // high from 1.2, low below 0.8
    open(sensor, setup);
    ck_assert(sensor.measures() == (options[0] != '\0'));
    board.send("volts 1.19 1.2 -\n");
    pollfd waiting{sensor.fd(), POLLIN, 0};
    ck_assert_int_eq(::poll(&waiting, 1, 20000), 1);
    std::vector<SensorEdge> edges;
    ck_assert(!sensor.read(1s, edges));
    ck_assert_int_eq(static_cast<int>(edges.size()), 3);
    ck_assert(!edges[0].level && edges[1].level && !edges[2].known);
    ck_assert(std::isnan(edges[1].volts) != sensor.measures());
    if (sensor.measures()) ck_assert_float_eq(edges[1].volts, 1.2f);
    board.send("volts 0.8 0.79 3\n");
    must_read(sensor, 2s, "0:0 1:0 2:1");
  }
}
END_TEST

START_TEST(what_does_not_fit_together_is_refused) {
  Board board;
  const std::string file = "/tmp/cerberus-no-fifo-" + std::to_string(getpid());
  must_refuse({}, SensorFault::settings, "either a command or a device");
  SensorSetup both = at(board.device());
  both.command = "true";
  must_refuse(both, SensorFault::settings, "either a command or a device");
  must_refuse(at(board.device(), "speed=7"), SensorFault::settings, "\"speed=7\" is no option");
  must_refuse(at(board.device(), "silence=-1"), SensorFault::settings, "silence=-1");
  must_refuse(at(board.device(), "baud=12345"), SensorFault::settings, "no baud rate 12345");
  must_refuse(at("serial:/dev/nothing"), SensorFault::not_found, "/dev/nothing");
  must_refuse(at("/nowhere/fifo"), SensorFault::not_found, "/nowhere/fifo");
  ::close(::open(file.c_str(), O_CREAT | O_WRONLY | O_CLOEXEC, 0600));
  must_refuse(at(file), SensorFault::settings, "is no FIFO");
  std::filesystem::remove(file);
}
END_TEST

START_TEST(another_version_or_number_is_an_error_at_the_begin) {
  for (const auto& [line, words] : {std::pair{"cerberus-pir 2 9\n", "they speak version 2"},
                                    std::pair{"cerberus-pir 1 2\n", "there are 2, and 3 bearings are set"},
                                    std::pair{"levels 0 1\n", "there are 2, and 3 bearings are set"}}) {
    Board board;
    ExternalSensor sensor;
    open(sensor, at(board.device()));
    board.send(line);
    ck_assert(says(read(sensor, 1s), words));
  }
}
END_TEST

START_TEST(a_damaged_line_later_changes_nothing) {
  Board board;
  ExternalSensor sensor;
  open(sensor, at(board.device()));
  board.send("levels 0 1 1\nlevels 0 1\nlev\xff\ncerberus-pir 3 3\nlevels 0 1 0\n");
  must_read(sensor, 1s, "0:0 1:1 2:1 0:0 1:1 2:0");
}
END_TEST

START_TEST(a_fifo_outlives_its_writers) {
  const std::string path = "/tmp/cerberus-fifo-" + std::to_string(getpid());
  ck_assert_int_eq(::mkfifo(path.c_str(), 0600), 0);
  ExternalSensor sensor;
  open(sensor, at(path));
  for (const char* line : {"levels 0 1 0\n", "levels 0 1 0\n"}) {
    const int writer = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
    ck_assert_int_eq(::write(writer, line, 13), 13);
    ::close(writer);
    must_read(sensor, 1s, "0:0 1:1 2:0");
  }
  ck_assert(sensor.outage().empty());
  std::filesystem::remove(path);
}
END_TEST

START_TEST(an_input_has_one_reader_and_the_second_one_is_told_which) {
  Board board;
  const std::string fifo = "/tmp/cerberus-fifo-" + std::to_string(::getpid()) + "-one";
  ck_assert_int_eq(::mkfifo(fifo.c_str(), 0600), 0);
  for (const std::string& device : {board.device(), fifo}) {
    ExternalSensor first, second;
    ck_assert(!first.open(at(device)));
    const SensorError wrong = second.open(at(device));
    ck_assert(wrong.fault == SensorFault::busy);
    ck_assert_msg(
        wrong.text.find("another program (process " + std::to_string(::getpid())) != std::string::npos, "%s",
        wrong.text.c_str());
    first.close();
    ck_assert(!second.open(at(device)));
  }
  ::unlink(fifo.c_str());
}
END_TEST

START_TEST(a_flood_is_read_piece_by_piece) {
  ExternalSensor sensor;
  open(sensor, running("exec yes levels 0 1 0"));
  for (int i = 0; i < 100; ++i) {
    pollfd waiting{sensor.fd(), POLLIN, 0};
    ck_assert_int_eq(::poll(&waiting, 1, 20000), 1);
    std::vector<SensorEdge> edges;
    ck_assert(!sensor.read(1s, edges));
    ck_assert_uint_le(edges.size(), 3 * (4096 + kMostLine) / 13);
  }
}
END_TEST

}  // namespace

int main() {
  return cerberus::tests::run_suite(
      "external_sensor",
      {a_board_at_a_serial_port_sends_its_levels, a_board_that_vanishes_is_an_outage_until_it_returns,
       a_silent_sender_is_an_outage_and_its_readings_are_unknown, silence_may_be_allowed,
       a_wrong_baud_rate_is_named_as_the_likely_cause, a_fault_of_the_sender_is_an_outage_in_its_words,
       a_command_that_ends_is_started_again, closing_ends_the_command_and_what_it_runs,
       volts_are_compared_with_the_threshold_and_reported_where_asked, what_does_not_fit_together_is_refused,
       another_version_or_number_is_an_error_at_the_begin, a_damaged_line_later_changes_nothing,
       a_fifo_outlives_its_writers, an_input_has_one_reader_and_the_second_one_is_told_which,
       a_flood_is_read_piece_by_piece});
}
