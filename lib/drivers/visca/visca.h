// SPDX-License-Identifier: LGPL-2.1-or-later
// Messages of Sony's VISCA protocol (EVI-D100 / BRC command lists; VISCA over IP, 52381), built and parsed. A message is
// 3 to 16 bytes: 0x80 + address (1 to 7), the body, 0xff.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace cerberus::drivers::visca {

inline constexpr double kUnitsPerDegree = 14.4;  // three vendors agree: 170 degrees = 0x0990
inline constexpr std::size_t kMostBytes = 16;

using Message = std::vector<std::uint8_t>;

// Speeds in degrees a second of the speed steps 0, 1, 2 ... of one axis, rising. They are no straight line and differ
// by model.
struct SpeedTable {
  std::vector<double> pan, tilt;
};
const SpeedTable& default_speed_table();
// "0.3 1 1.5 ...; 0.3 1 1.5 ...": pan, then tilt, 2 to 25 numbers each. Returns what is wrong; empty: `table` is set.
std::string parse_speed_table(const std::string& text, SpeedTable& table);

// The step whose speed is nearest to |speed| (degrees a second); 0 means that the axis stands: |speed| is below half of
// the slowest speed that moves (step 1).
int speed_step(std::span<const double> table, double speed);

// pan, tilt: signed steps, positive to the right and up; 0 stops the axis. Beyond 24 and 23 the camera refuses.
Message drive(int address, int pan, int tilt);
Message stop(int address);
// Position in degrees, positive to the right and up, at these steps.
Message absolute(int address, double pan, double tilt, int pan_step, int tilt_step);
Message home(int address);
Message position_inquiry(int address);
Message version_inquiry(int address);  // CAM_VersionInq, which every camera should answer and none turns for
// CAM_Zoom Direct and CAM_ZoomPosInq. position: 0 to 1 of the optical zoom (0000 to 4000 hex), digital zoom up to
// 1.918 (7ac0).
inline constexpr double kMostZoom = 0x7ac0 / double{0x4000};
Message zoom(int address, double position);
Message zoom_inquiry(int address);
Message interface_clear();  // broadcast
Message address_set();      // broadcast: numbers the chain

struct Reply {
  enum class Kind : std::uint8_t { ack, completion, position, zoom, version, error, other };
  Kind kind = Kind::other;
  int address = 0;  // of the camera that answers
  int socket = 0;   // of an ack, completion or error
  int error = 0;    // 0x02 syntax, 0x03 buffer full, 0x04 cancelled, 0x05 no socket, 0x41 not executable
  double pan = 0, tilt = 0;  // degrees, of a position
  double zoom = 0;           // of a zoom: as in zoom()
};
// One message with its 0xff.
Reply parse_reply(std::span<const std::uint8_t> message);

// Cuts a stream of bytes into messages at 0xff. Bytes before a first byte of 0x80 to 0xff, and messages that are longer
// than kMostBytes, are skipped: a serial line loses bytes.
class Cutter {
 public:
  void append(std::span<const std::uint8_t> bytes) {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  std::optional<Message> take();

 private:
  std::vector<std::uint8_t> bytes_;
};

// The header of VISCA over IP: type, length, sequence number, eight bytes, big endian.
Message with_header(const Message& message, std::uint32_t sequence);
Message reset_sequence();
struct Datagram {
  bool header = false;         // it has one; else the payload is all of it
  bool control = false;        // its payload is no VISCA message: a reset or an error of the sequence
  std::uint32_t sequence = 0;  // of the command that it answers
  std::span<const std::uint8_t> payload;
};
Datagram parse_datagram(std::span<const std::uint8_t> datagram);
// A camera that lost count: the sequence must be reset. Control payload 0f 01.
bool is_sequence_error(const Datagram& datagram);

}  // namespace cerberus::drivers::visca
