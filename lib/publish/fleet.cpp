// SPDX-License-Identifier: LGPL-2.1-or-later
#include "publish/fleet.h"

#include <utility>

#include "text/json_line.h"

namespace cerberus::publish {

bool Fleet::take(std::string_view topic, std::string payload, Time now) {
  if (!topic.starts_with(prefix_ + '/')) return false;
  topic.remove_prefix(prefix_.size() + 1);
  const std::size_t slash = topic.find('/');
  if (slash == topic.npos || slash == 0 || slash > 64) return false;
  const std::string_view name = topic.substr(0, slash), what = topic.substr(slash + 1);
  std::string Camera::* member = nullptr;
  if (what == "status") member = &Camera::status;
  if (what == "mode") member = &Camera::mode;
  if (what == "state") member = &Camera::state;
  if (what == "event") member = &Camera::event;
  if (what == "picture") member = &Camera::picture;
  if (member == nullptr || payload.size() > (what == "picture" ? kLongestPicture : kLongestText))
    return false;
  auto found = cameras_.find(name);
  if (found == cameras_.end()) {
    // A picture alone makes no camera, nor does a retained topic that is cleared.
    if (cameras_.size() >= kMost || what == "picture" || payload.empty()) return false;
    found = cameras_.emplace(name, Camera{}).first;
  }
  Camera& camera = found->second;
  if (what == "status" && payload.empty()) {
    cameras_.erase(found);
    return true;
  }
  if (what == "picture") {
    if (!camera.asked || now - *camera.asked > kPatience || camera.mode == "privacy" || payload.empty())
      return false;
    camera.number = ++pictures_;
  }
  camera.*member = std::move(payload);
  if (camera.mode == "privacy") {
    camera.picture = {};
    camera.number = 0;
    camera.asked.reset();
  }
  if (what == "picture") forget_oldest_picture();
  return true;
}

bool Fleet::ask(std::string_view camera, Time now) {
  const auto found = cameras_.find(camera);
  if (found == cameras_.end()) return false;
  found->second.asked = now;
  return true;
}

void Fleet::forget_oldest_picture() {
  Camera* oldest = nullptr;
  std::size_t count = 0;
  for (auto& [name, camera] : cameras_) {
    if (camera.number == 0) continue;
    ++count;
    if (oldest == nullptr || camera.number < oldest->number) oldest = &camera;
  }
  if (count <= kMostPictures) return;
  oldest->picture = {};
  oldest->number = 0;
}

std::string Fleet::json() const {
  text::JsonLine line;
  line.open('[');
  for (const auto& [name, camera] : cameras_) {
    line.open('{').key("name").text(name).key("status").text(camera.status).key("mode").text(camera.mode);
    line.key("state").text(camera.state).key("event").text(camera.event);
    line.key("picture").integer(camera.number).close('}');
  }
  std::string text(line.close(']').finish());
  text.pop_back();  // the newline
  return text;
}

const std::string* Fleet::picture(std::string_view camera) const {
  const auto found = cameras_.find(camera);
  return found == cameras_.end() || found->second.picture.empty() ? nullptr : &found->second.picture;
}

}  // namespace cerberus::publish
