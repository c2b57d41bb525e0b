// SPDX-License-Identifier: LGPL-2.1-or-later
// The line protocol of heads, both directions, in pieces of any size. What is read is written and read again.
#include "drivers/helper/head_lines.h"

#include <cmath>
#include <cstdint>
#include <cstdlib>

using namespace cerberus::drivers;

namespace {

void check(bool holds) {
  if (!holds) std::abort();
}

void read(std::string_view text) {
  if (const auto line = parse_pipeline_line(text)) {
    if (const auto* move = std::get_if<MoveLine>(&*line)) {
      check(std::isfinite(move->pan.value) && std::isfinite(move->tilt.speed));
      std::string again = move_line(move->pan, move->tilt);
      check(again.size() <= kMostLine && again.back() == '\n');
      again.pop_back();
      check(parse_pipeline_line(again).has_value());
    }
    if (const auto* hello = std::get_if<HelloLine>(&*line))
      check(cerberus::motion::check(hello->setup.limits).empty());
    if (const auto* limits = std::get_if<LimitsLine>(&*line))
      check(limits->limits.pan.from <= limits->limits.pan.to);
  }
  if (const auto line = parse_helper_line(text)) {
    if (const auto* pose = std::get_if<PoseLine>(&*line))
      check(std::isfinite(pose->pan.position) && pose->age >= 0 && parse_helper_line(pose_line(*pose)));
    if (const auto* speeds = std::get_if<SpeedsLine>(&*line))
      check(std::isfinite(speeds->speed.pan) && parse_helper_line(speeds_line(*speeds)));
    if (const auto* zoom = std::get_if<ZoomLine>(&*line))
      check(zoom->position >= 0 && zoom->position <= cerberus::motion::kMostZoom &&
            parse_helper_line(zoom_line(*zoom)));
    if (const auto* ready = std::get_if<ReadyLine>(&*line))
      check(ready->abilities.rate >= 1 && ready->abilities.rate <= 1000);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  LineBuffer lines;
  const std::size_t piece = size > 0 ? 1 + data[0] % 32 : 1;
  for (std::size_t at = 0; at < size; at += piece) {
    lines.append({reinterpret_cast<const char*>(data + at), std::min(piece, size - at)});
    while (const auto line = lines.take()) {
      check(line->size() < kMostLine);
      read(*line);
    }
  }
  return 0;
}
