// SPDX-License-Identifier: LGPL-2.1-or-later
// Lists what may be a head. A serial port is only opened if it is named: bytes may move whatever else is connected to it.
#include <poll.h>

#include <chrono>
#include <cstdio>
#include <filesystem>

#if HAVE_ONVIF
#include "drivers/onvif/discovery.h"
#endif
#include "drivers/head/head_place.h"
#include "drivers/transport/byte_stream.h"
#include "drivers/visca/visca.h"
#include "heads/one_program.h"
#include "heads/tool.h"

namespace cerberus::heads {
namespace {

namespace fs = std::filesystem;
using namespace drivers;

void list_folder(const char* folder, const char* begin, const char* kind, int& found) {
  std::error_code wrong;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, wrong)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(begin)) continue;
    std::printf("%s%s\n", kind, entry.path().c_str());
    ++found;
  }
}

// Cameras that answer a probe on this network. They are sent nothing else.
void list_onvif([[maybe_unused]] int& found) {
#if HAVE_ONVIF
  std::string wrong;
  for (const auto& camera : onvif::discover(std::chrono::milliseconds(1500), wrong)) {
    std::printf("onvif %s%s%s\n", camera.device.c_str(), camera.name.empty() ? "" : "  ",
                camera.name.c_str());
    ++found;
  }
#endif
}

// Asks for a position, which moves nothing. Returns whether a camera answered.
bool answers_visca(ByteStream& stream) {
  const bool header = stream.datagrams();
  if (header) stream.write(visca::reset_sequence());
  const visca::Message question = visca::position_inquiry(1);
  stream.write(header ? visca::with_header(question, 0) : question);
  visca::Cutter cutter;
  std::vector<std::uint8_t> bytes;
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(500);
  while (stream.is_open() && std::chrono::steady_clock::now() < end) {
    pollfd wait{stream.fd(), POLLIN, 0};
    ::poll(&wait, 1, 20);
    while (stream.read(bytes)) {
      cutter.append(visca::parse_datagram(bytes).payload);
      bytes.clear();
    }
    while (const auto message = cutter.take()) {
      const visca::Reply reply = visca::parse_reply(*message);
      if (reply.kind != visca::Reply::Kind::position) continue;
      std::printf("a VISCA camera, pan %.1f tilt %.1f degrees\n", reply.pan, reply.tilt);
      return true;
    }
  }
  return false;
}

}  // namespace

int list_heads(const std::vector<std::string>& named) {
  int status = 0;
  for (const std::string& device : named) {
    std::printf("%s: ", device.c_str());
    ByteStream stream;
    bool found = false;
    // A camera that is driven is not asked: its driver would take the answer for its own, or lose count of its messages.
    std::string wrong = hold_place(head_place("visca", device, {}), {});
    for (const int baud : {9600, 38400}) {
      if (found || !wrong.empty() || !(wrong = stream.open(device, baud)).empty()) break;
      found = answers_visca(stream);
      if (!device.starts_with("serial:")) break;
    }
    if (found) continue;
    std::printf("%s\n", wrong.empty() ? "no answer (a Pelco-D head answers nothing: try it with `move`)"
                                      : wrong.c_str());
    status = 1;
  }
  if (!named.empty()) return status;
  int found = 0;
  list_folder("/dev", "ttyUSB", "serial:", found);
  list_folder("/dev", "ttyACM", "serial:", found);
  list_folder("/dev", "gpiochip", "stepper-gpio ", found);
  list_folder("/dev", "video", "v4l2 (if it has pan and tilt) ", found);
  list_folder("/sys/class/pwm", "pwmchip", "servo-pwm ", found);
  list_onvif(found);
  std::printf(
      found ? "Not asked. A serial port is asked where it is named: cerberus-heads list serial:/dev/ttyUSB0\n"
            : "Nothing found. Network cameras are named: cerberus-heads list udp:HOST:52381\n");
  return 0;
}

}  // namespace cerberus::heads
