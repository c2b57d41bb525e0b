// SPDX-License-Identifier: LGPL-2.1-or-later
// The cameras that a broker knows, from the topics that mqttpublish and cerberusd retain there.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace cerberus::publish {

class Fleet {
 public:
  using Time = std::chrono::steady_clock::time_point;
  // A list for one page; a payload that is longer than what is published here comes from something else.
  static constexpr std::size_t kMost = 500, kLongestText = 2000, kLongestPicture = 4u << 20;
  static constexpr std::size_t kMostPictures = 16;      // the newest ones are kept
  static constexpr std::chrono::seconds kPatience{30};  // for a picture that was asked for

  explicit Fleet(std::string prefix) : prefix_(std::move(prefix)) {}

  // What is subscribed: "cerberus/+/status" and so on.
  static constexpr std::string_view kTopics[] = {"status", "mode", "state", "event", "picture"};
  // `payload` is UTF-8, but for a picture's. Pictures that were not asked for are ignored, a camera whose status is
  // cleared is forgotten, and so is the picture of one whose mode is privacy. Returns whether the list changed.
  bool take(std::string_view topic, std::string payload, Time now);
  // A picture of this camera is accepted for kPatience. False: there is no such camera.
  bool ask(std::string_view camera, Time now);

  // [{"name":"front","status":"online","mode":"armed","state":"{...}","event":"{...}","picture":3}]: state and event
  // are the payloads as texts, picture is 0 where there is none and another number for each one.
  std::string json() const;
  // The newest picture of a camera, JPEG; nullptr: there is none.
  const std::string* picture(std::string_view camera) const;
  const std::string& prefix() const { return prefix_; }

 private:
  struct Camera {
    std::string status, mode, state, event, picture;
    std::uint64_t number = 0;  // of its picture
    std::optional<Time> asked;
  };
  void forget_oldest_picture();

  std::string prefix_;
  std::uint64_t pictures_ = 0;
  std::map<std::string, Camera, std::less<>> cameras_;
};

}  // namespace cerberus::publish
