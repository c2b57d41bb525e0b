// SPDX-License-Identifier: LGPL-2.1-or-later
#include "support/data.h"

#include <cstdio>
#include <cstdlib>
#include <vector>

namespace cerberus::tests {
namespace fs = std::filesystem;

namespace {

// What the environment names, found or not, goes before every other place.
std::vector<fs::path> places(const char* variable, std::vector<fs::path> usual) {
  const char* named = std::getenv(variable);
  if (!named || !*named) return usual;
  std::error_code ignored;
  if (!fs::exists(named, ignored)) std::fprintf(stderr, "%s=%s is not there\n", variable, named);
  return {named};
}

std::optional<fs::path> first_there(const std::vector<fs::path>& places) {
  std::error_code ignored;
  for (const fs::path& place : places)
    if (fs::exists(place, ignored)) return fs::canonical(place, ignored);
  return std::nullopt;
}

}  // namespace

std::optional<fs::path> data_folder() {
  return first_there(places("CERBERUS_DATA", {fs::path(CERBERUS_SOURCE_ROOT) / ".." / "shared" / "data"}));
}

std::optional<fs::path> models_folder() {
  return first_there(
      places("CERBERUS_MODELS", {fs::path(CERBERUS_SOURCE_ROOT) / ".." / "shared" / "models"}));
}

std::optional<fs::path> vtest() {
  std::vector<fs::path> usual{fs::path(CERBERUS_BUILD_ROOT) / "media" / "vtest.avi"};
  if (const auto data = data_folder()) usual.push_back(*data / "pets09_s2l1_view1" / "vtest.avi");
  usual.emplace_back("/usr/share/doc/opencv-doc/examples/data/vtest.avi");
  return first_there(places("CERBERUS_VIDEO", usual));
}

std::optional<std::string> vtest_source() {
  const auto video = vtest();
  if (!video) return std::nullopt;
  return "filesrc location=\"" + video->string() + "\" ! decodebin";
}

std::optional<RealVideo> real_video() {
  const auto data = data_folder();
  const auto video = vtest_source();
  if (data && video) return RealVideo{*data, *video};
  std::printf("skipped: %s\n", data ? kNoVtest : kNoData);
  return {};
}

}  // namespace cerberus::tests
