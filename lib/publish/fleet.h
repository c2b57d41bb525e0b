// SPDX-License-Identifier: LGPL-2.1-or-later
// The cameras that a broker knows, from the topics that mqttpublish and cerberusd retain there.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace cerberus::publish {

class Fleet {
 public:
  // A list for one page; a payload that is longer than what is published here comes from something else.
  static constexpr std::size_t kMost = 500, kLongestText = 2000, kLongestPicture = 4u << 20;

  explicit Fleet(std::string prefix) : prefix_(std::move(prefix)) {}

  // What is subscribed: "cerberus/+/status" and so on.
  static constexpr std::string_view kTopics[] = {"status", "mode", "state", "event", "picture"};
  // `payload` is UTF-8, but for a picture's. Returns whether the list changed.
  bool take(std::string_view topic, std::string payload);

  // [{"name":"front","status":"online","mode":"armed","state":"{...}","event":"{...}","picture":3}]: state and event are
  // the payloads as texts, picture counts those that arrived.
  std::string json() const;
  // The newest picture of a camera, JPEG; nullptr: none arrived.
  const std::string* picture(std::string_view camera) const;
  bool has(std::string_view camera) const { return cameras_.find(camera) != cameras_.end(); }
  const std::string& prefix() const { return prefix_; }

 private:
  struct Camera {
    std::string status, mode, state, event, picture;
    std::uint64_t pictures = 0;
  };
  std::string prefix_;
  std::map<std::string, Camera, std::less<>> cameras_;
};

}  // namespace cerberus::publish
