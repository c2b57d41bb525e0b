// SPDX-License-Identifier: LGPL-2.1-or-later
// One encoded access unit of video, or one packet of audio, as the recorder keeps it.
#pragma once

#include <chrono>
#include <cstddef>
#include <memory>

namespace cerberus::record {

using Time = std::chrono::nanoseconds;  // running time; decode times may be below zero

// The encoded bytes, owned by a type that this library does not know.
using Payload = std::unique_ptr<void, void (*)(void*)>;

struct Unit {
  Payload payload{nullptr, [](void*) {}};
  Time decode{};        // order of arrival; never falls within a track
  Time presentation{};  // when it is shown; falls from unit to unit where the encoder makes B-frames
  std::size_t bytes = 0;
  int format = 0;        // of the stream's caps when it arrived: a file holds one format a track
  bool keyframe = true;  // decoding can start here
};

}  // namespace cerberus::record
