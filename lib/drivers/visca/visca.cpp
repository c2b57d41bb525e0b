// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/visca/visca.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>

#include "text/numbers.h"

namespace cerberus::drivers::visca {
namespace {

constexpr std::uint8_t kEnd = 0xff;
constexpr double kOpticalZoom = 0x4000;  // end of the optical zoom
static_assert(kMostZoom == 0x7ac0 / kOpticalZoom);
constexpr int kMostPanStep = 0x18, kMostTiltStep = 0x17;

std::uint8_t head(int address) {
  return static_cast<std::uint8_t>(0x80 | std::clamp(address, 1, 7));
}

std::uint8_t step_byte(int step, int most) {
  return static_cast<std::uint8_t>(std::clamp(std::abs(step), 1, most));
}

// 01: left or up, 02: right or down, 03: stop.
std::uint8_t direction(int step, bool positive_is_one) {
  if (step == 0) return 3;
  return (step > 0) == positive_is_one ? 1 : 2;
}

// Four nibbles, the highest first, two's complement.
void append_position(Message& message, double degrees) {
  const long units = std::lround(std::clamp(degrees, -2000.0, 2000.0) * kUnitsPerDegree);
  for (int shift = 12; shift >= 0; shift -= 4)
    message.push_back(static_cast<std::uint8_t>(units >> shift & 15));
}

double read_position(std::span<const std::uint8_t> nibbles) {
  unsigned units = 0;
  for (const std::uint8_t nibble : nibbles) units = units << 4 | (nibble & 15u);
  return static_cast<std::int16_t>(units) / kUnitsPerDegree;
}

}  // namespace

// The table that cameras of this family share (EVI-D70 and its kin), to be overridden by a calibration.
const SpeedTable& default_speed_table() {
  static const SpeedTable table{
      {.3, 1,  1.5, 2.2, 2.4, 2.6, 2.8, 3.0, 3.2, 3.4, 3.8, 4.5, 6,
       9,  15, 19,  25,  32,  38,  45,  58,  75,  88,  105, 120},
      {.3, 1, 1.5, 2.2, 3.6, 4.7, 6, 8, 10, 12, 15, 18, 23, 30, 39, 48, 59, 69, 80}};
  return table;
}

std::string parse_speed_table(const std::string& text, SpeedTable& table) {
  SpeedTable read;
  std::vector<double>* axis = &read.pan;
  const char *at = text.data(), *end = at + text.size();
  while (at < end) {
    if (*at == ' ') {
      ++at;
      continue;
    }
    if (*at == ';') {
      if (axis == &read.tilt) return "a speed table has two parts, pan; tilt";
      axis = &read.tilt;
      ++at;
      continue;
    }
    double speed = 0;
    const auto number = std::from_chars(at, end, speed);
    if (number.ec != std::errc() || !(speed > 0) || speed > 1000)
      return std::string("no speed begins at \"").append(at, end) +=
             "\": write those of the steps in degrees a second, above 0 and up to 1000, '0.3 1 2; 0.3 1 2' "
             "for pan; tilt";
    if (!axis->empty() && speed <= axis->back())
      return text::significant(speed, 4).string() + " is not above the speed before it: each step is faster";
    axis->push_back(speed);
    at = number.ptr;
  }
  for (const auto& part : {read.pan, read.tilt})
    if (part.size() < 2 || part.size() > 25)
      return "a speed table has 2 to 25 speeds for pan and 2 to 25 for tilt: '0.3 1 2; 0.3 1 2'";
  table = read;
  return {};
}

int speed_step(std::span<const double> table, double speed) {
  const double wanted = std::abs(speed);
  if (table.size() < 2 || !(wanted >= table[1] / 2)) return 0;
  const auto next = std::lower_bound(table.begin() + 1, table.end(), wanted);
  auto step = std::min(next - table.begin(), static_cast<std::ptrdiff_t>(table.size()) - 1);
  if (step > 1 && wanted - table[step - 1] < table[step] - wanted) --step;
  return static_cast<int>(std::signbit(speed) ? -step : step);
}

Message drive(int address, int pan, int tilt) {
  return {head(address),
          0x01,
          0x06,
          0x01,
          step_byte(pan, kMostPanStep),
          step_byte(tilt, kMostTiltStep),
          direction(pan, false),
          direction(tilt, true),
          kEnd};
}

Message stop(int address) {
  return drive(address, 0, 0);
}

Message absolute(int address, double pan, double tilt, int pan_step, int tilt_step) {
  Message message{head(address),
                  0x01,
                  0x06,
                  0x02,
                  step_byte(pan_step, kMostPanStep),
                  step_byte(tilt_step, kMostTiltStep)};
  append_position(message, pan);
  append_position(message, tilt);
  message.push_back(kEnd);
  return message;
}

Message home(int address) {
  return {head(address), 0x01, 0x06, 0x04, kEnd};
}

Message position_inquiry(int address) {
  return {head(address), 0x09, 0x06, 0x12, kEnd};
}

Message version_inquiry(int address) {
  return {head(address), 0x09, 0x00, 0x02, kEnd};
}

Message zoom(int address, double position) {
  Message message{head(address), 0x01, 0x04, 0x47};
  const long units = std::lround(std::clamp(position, 0.0, kMostZoom) * kOpticalZoom);
  for (int shift = 12; shift >= 0; shift -= 4)
    message.push_back(static_cast<std::uint8_t>(units >> shift & 15));
  message.push_back(kEnd);
  return message;
}

Message zoom_inquiry(int address) {
  return {head(address), 0x09, 0x04, 0x47, kEnd};
}

Message interface_clear() {
  return {0x88, 0x01, 0x00, 0x01, kEnd};
}

Message address_set() {
  return {0x88, 0x30, 0x01, kEnd};
}

Reply parse_reply(std::span<const std::uint8_t> m) {
  Reply reply;
  if (m.size() < 3 || m.front() < 0x80 || m.back() != kEnd) return reply;
  reply.address = (m[0] >> 4 & 7);
  reply.socket = m[1] & 15;
  const int kind = m[1] >> 4;
  if (kind == 4 && m.size() == 3) reply.kind = Reply::Kind::ack;
  if (kind == 5 && m.size() == 3) reply.kind = Reply::Kind::completion;
  if (kind == 6 && m.size() == 4) {
    reply.kind = Reply::Kind::error;
    reply.error = m[2];
  }
  if (m[1] == 0x50 && m.size() == 11) {
    reply.kind = Reply::Kind::position;
    reply.pan = read_position(m.subspan(2, 4));
    reply.tilt = read_position(m.subspan(6, 4));
  }
  if (m[1] == 0x50 && m.size() == 10) reply.kind = Reply::Kind::version;
  if (m[1] == 0x50 && m.size() == 7) {
    reply.kind = Reply::Kind::zoom;
    unsigned units = 0;
    for (const std::uint8_t nibble : m.subspan(2, 4)) units = units << 4 | (nibble & 15u);
    reply.zoom = std::min(units / kOpticalZoom, kMostZoom);
  }
  return reply;
}

std::optional<Message> Cutter::take() {
  for (;;) {
    const auto begin =
        std::find_if(bytes_.begin(), bytes_.end(), [](std::uint8_t b) { return b >= 0x80 && b != kEnd; });
    bytes_.erase(bytes_.begin(), begin);
    const auto end = std::find(bytes_.begin(), bytes_.end(), kEnd);
    if (end == bytes_.end()) {
      if (bytes_.size() > kMostBytes) bytes_.erase(bytes_.begin());
      if (bytes_.size() > kMostBytes) continue;
      return std::nullopt;
    }
    Message message(bytes_.begin(), end + 1);
    bytes_.erase(bytes_.begin(), end + 1);
    if (message.size() <= kMostBytes) return message;
  }
}

Message with_header(const Message& message, std::uint32_t sequence) {
  const bool inquiry = message.size() > 1 && message[1] == 0x09;
  Message datagram{0x01, static_cast<std::uint8_t>(inquiry ? 0x10 : 0x00), 0x00,
                   static_cast<std::uint8_t>(message.size())};
  for (int shift = 24; shift >= 0; shift -= 8)
    datagram.push_back(static_cast<std::uint8_t>(sequence >> shift));
  datagram.insert(datagram.end(), message.begin(), message.end());
  return datagram;
}

Message reset_sequence() {
  return {0x02, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x00, 0x01};
}

Datagram parse_datagram(std::span<const std::uint8_t> d) {
  const bool header = d.size() > 8 && (d[0] == 0x01 || d[0] == 0x02) &&
                      static_cast<std::size_t>(d[2] << 8 | d[3]) == d.size() - 8;
  if (!header) return {.payload = d};
  std::uint32_t sequence = 0;
  for (int i = 4; i < 8; ++i) sequence = sequence << 8 | d[i];
  return {.header = true, .control = d[0] == 0x02, .sequence = sequence, .payload = d.subspan(8)};
}

bool is_sequence_error(const Datagram& datagram) {
  return datagram.control && datagram.payload.size() == 2 && datagram.payload[0] == 0x0f &&
         datagram.payload[1] == 0x01;
}

}  // namespace cerberus::drivers::visca
