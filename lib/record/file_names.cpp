// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/file_names.h"

#include <algorithm>
#include <array>
#include <ctime>

namespace cerberus::record {

namespace {

constexpr std::size_t kLongestComponent =
    200;  // bytes; file systems take 255, and an ending and a number follow

// Calls each(component) for the parts between slashes.
template <typename Each>
void for_each_component(std::string_view path, Each each) {
  while (true) {
    const std::size_t slash = path.find('/');
    each(path.substr(0, slash));
    if (slash == std::string_view::npos) return;
    path.remove_prefix(slash + 1);
  }
}

std::string plain(std::string_view camera) {
  std::string name(camera.empty() ? "camera" : camera);
  for (char& letter : name) {
    const bool kept = (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
                      (letter >= '0' && letter <= '9') || letter == '-' || letter == '_' ||
                      static_cast<unsigned char>(letter) >= 128;
    if (!kept) letter = '_';
  }
  return name;
}

// Replaces every {word}. Returns false at one that is not known.
bool replace_words(std::string_view pattern, const NameFacts& facts, std::string& result) {
  for (std::size_t k = 0; k < pattern.size(); ++k) {
    if (pattern[k] != '{') {
      result += pattern[k];
      continue;
    }
    const std::size_t end = pattern.find('}', k);
    if (end == std::string_view::npos) return false;
    const std::string_view word = pattern.substr(k + 1, end - k - 1);
    if (word == "camera")
      result += plain(facts.camera);
    else if (word == "event")
      result += std::to_string(facts.event);
    else if (word == "part")
      result += std::to_string(facts.part);
    else
      return false;
    k = end;
  }
  return true;
}

}  // namespace

std::string name_pattern_fault(std::string_view pattern) {
  if (pattern.empty()) return "it is empty";
  if (pattern.front() == '/')
    return "it is an absolute path, but names lie below the folder of the recordings";
  if (std::ranges::any_of(
          pattern, [](char letter) { return static_cast<unsigned char>(letter) < ' ' || letter == 127; }))
    return "it has a control character";
  std::string fault;
  for_each_component(pattern, [&](std::string_view part) {
    if (part == "..") fault = "it leaves the folder of the recordings by `..`";
    if (part.empty()) fault = "it has an empty part between two slashes or at its end";
  });
  if (!fault.empty()) return fault;
  std::string expanded;
  if (!replace_words(pattern, {}, expanded))
    return "of words in braces it knows {camera}, {event} and {part}";
  return {};
}

std::string expand_name(std::string_view pattern, const NameFacts& facts) {
  using namespace std::chrono;
  const std::time_t seconds = floor<std::chrono::seconds>(facts.utc).count();
  std::tm local{};
  localtime_r(&seconds, &local);

  // strftime first: what a camera is called may hold a %.
  std::string result;
  for_each_component(pattern, [&](std::string_view part) {
    std::array<char, 1024> text{};
    const std::string conversions(part);
    const std::size_t length = std::strftime(text.data(), text.size(), conversions.c_str(), &local);
    std::string component;
    replace_words(length ? std::string_view(text.data(), length) : part, facts, component);
    // %D and a user's locale may hold slashes; %n and %t are control characters.
    std::ranges::replace(component, '/', '-');
    std::ranges::replace_if(
        component, [](char letter) { return static_cast<unsigned char>(letter) < ' ' || letter == 127; },
        '_');
    if (component == "." || component == ".." || component.empty()) component.assign(1, '_');
    if (!result.empty()) result += '/';
    result += component.substr(0, kLongestComponent);
  });
  if (facts.part > 1 && pattern.find("{part}") == std::string_view::npos)
    result += '-' + std::to_string(facts.part);
  return result;
}

}  // namespace cerberus::record
