// SPDX-License-Identifier: LGPL-2.1-or-later
// What one configuration file says about a robot: cameras with their sensors, heads and recorders, the mode, the page.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "robot/mode.h"

namespace cerberus::robot {

// A property of a GStreamer element, its value in the form of gst-launch-1.0.
struct Property {
  std::string name, value;
  std::uint32_t line = 0;  // where the file sets it; 0: it does not

  bool operator==(const Property& other) const { return name == other.name && value == other.value; }
};
using Properties = std::vector<Property>;

// Where the file has a key, or the table that sets an element's properties: "uri", "head".
using Lines = std::map<std::string, std::uint32_t, std::less<>>;

enum class SourceKind : std::uint8_t {
  test,       // a drawn picture with a ball that moves
  world,      // a video as the world of a simulated head: a window that turns over it
  file,       // a video file in real time
  v4l2,       // a camera of the kernel
  rtsp,       // a network camera
  libcamera,  // a camera that libcamera drives, as those of a Raspberry Pi
  patrol,     // a simulated robot in a house with people
};

// Whether a source makes its frames when they are asked for: they are played in real time, and none is late.
constexpr bool waits_for_reader(SourceKind kind) {
  return kind == SourceKind::world || kind == SourceKind::file || kind == SourceKind::patrol;
}

enum class Codec : std::uint8_t { h264, h265, jpeg };

struct SourceSettings {
  SourceKind kind = SourceKind::test;
  std::string device;                    // v4l2; libcamera: its name there, empty: the first
  std::string uri;                       // rtsp: the stream that is analysed
  std::string record_uri;                // rtsp: the stream that is recorded; empty: the same
  std::string user, password_file;       // rtsp
  Codec codec = Codec::h264;             // rtsp
  std::string file;                      // file, world
  bool loop = true;                      // file, world: begins anew at its end
  bool motion_jpeg = false;              // v4l2: the camera gives JPEG
  int width = 0, height = 0;             // pixels; 0: as the source gives them (world: of the window)
  int framerate = 0;                     // frames a second; 0: as the source gives them
  double wide_fov = 60;                  // world: degrees over the width of the video
  double start_pan = 0, start_tilt = 0;  // world: where the head looks at first, degrees
  Properties patrol;                     // of patrolsimsrc
};

// In place of an element: the first of H.264 that works on the machine. The program puts an element there.
inline constexpr std::string_view kAnyH264 = "h264";

// How pictures are encoded that do not come encoded.
struct EncoderSettings {
  std::string element = "x264enc";  // of publish::encoders(), or kAnyH264
  int bitrate = 2000;               // kilobits a second

  bool operator==(const EncoderSettings&) const = default;
};

struct RecorderSettings {
  std::string folder;
  EncoderSettings encoder;
  Properties properties;  // of eventrecorder
};

// Whether people are also known by their shape.
enum class PersonsUse : std::uint8_t {
  automatic,  // where this machine can: the program decides
  always,
  never,
};

struct PersonsSettings {
  PersonsUse use = PersonsUse::automatic;
  Properties properties;  // of personverify
};

// The robot's own drive: docs/manual/base.md.
struct BaseSettings {
  std::string command;       // a program that is given a line for each order
  double max_speed = .5;     // metres a second
  double max_yaw_rate = 45;  // degrees a second

  bool operator==(const BaseSettings&) const = default;
};

struct CameraSettings {
  std::string name;
  std::uint32_t line = 0;
  SourceSettings source;
  double horizontal_fov = 60;  // degrees over the width of the picture
  Properties detection;        // of motiondetect
  PersonsSettings persons;
  Properties fusion;                  // of pirfusion
  std::optional<Properties> sensors;  // of pirsrc; of patrolsimsrc without its "pir-"
  std::optional<Properties> head;     // of pantiltsink
  std::optional<RecorderSettings> recorder;
  Lines lines;
};

struct PageSettings {
  bool enabled = true;
  std::string listen = "127.0.0.1";
  int port = 8080;
  std::vector<std::string> origins;          // that may open the page's WebSocket beside the page's own
  std::vector<std::string> trusted_proxies;  // addresses and networks: client_address.h
  // Pixels at most. measured: a viewer of a 1280x720 camera at 25 frames a second takes 4 % of a core with 640, 7.5 with 800,
  // 9 with 1280; halves are scaled fast. Guard: benchmark page.
  int picture_width = 640;
  int quality = 75;              // of the JPEG pictures, percent
  bool tls = false;              // with a self-made certificate where none is named
  std::string certificate, key;  // PEM files

  bool operator==(const PageSettings&) const = default;
};

struct RtspSettings {
  std::string listen = "127.0.0.1";
  int port = 8554;
  std::string users_file;               // lines NAME:PASSWORD; empty: no log-in
  bool tls = false;                     // with a self-made certificate where none is named
  std::string certificate, key;         // PEM files
  bool plain = true, annotated = true;  // what is served of each camera, with the metadata
  EncoderSettings encoder;  // of annotated pictures, and of plain ones that no recorder has encoded

  bool operator==(const RtspSettings&) const = default;
};

struct WebhookSettings {
  std::string url, secret_file, ca_file;
  std::string topics = "track mode event";  // of mqttpublish, parted by blanks

  bool operator==(const WebhookSettings&) const = default;
};

struct ModeSettings {
  Mode start = Mode::armed;  // at the very first start
  Schedule schedule;
};

// What a camera takes from the robot.
struct SharedSettings {
  PageSettings page;
  std::optional<Properties> mqtt;  // of mqttpublish; nullopt: nothing is published
  std::optional<RtspSettings> rtsp;
  std::string stamp{};  // another text once a file was written anew that the camera's table or [mqtt] names
};

struct Settings {
  std::string name = "cerberus";
  std::string state_folder;  // empty: the program chooses
  ModeSettings mode;
  PageSettings page;
  std::optional<BaseSettings> base;
  std::optional<Properties> mqtt;  // of mqttpublish, for all cameras
  bool list_cameras = false;       // the page lists what else publishes to the broker
  std::optional<WebhookSettings> webhook;
  std::optional<RtspSettings> rtsp;
  std::vector<CameraSettings> cameras;
  // Of the files that "page", "rtsp", "mqtt", "webhook" or "camera NAME" names: another text once one was written anew.
  std::map<std::string, std::string> stamps;
  // "page.port", "mqtt": keys of the tables that are not a camera's, and these tables.
  Lines lines;
};

}  // namespace cerberus::robot
