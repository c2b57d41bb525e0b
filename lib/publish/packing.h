// SPDX-License-Identifier: LGPL-2.1-or-later
// The fields of a structure as bytes, for another process of the same machine (GStreamer's unixfdsink sends metadata so):
// numbers in the machine's byte order, words with their length, points in time as distances from the frame's time,
// because every pipeline counts its running time from another zero.
//
// A structure names its fields once, for both directions, in an order that never changes within a version:
//   template <typename Archive>
//   static void exchange(Archive& archive, Pose& pose) { archive(pose.head, Moment{pose.from}, pose.pan, pose.tilt); }
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <type_traits>

namespace cerberus::publish {

// Version of all packed structures: raised whenever the fields of one change. An Unpacker accepts no other.
constexpr std::uint8_t kPackedVersion = 2;
// Longest word, bytes: its length plus one is a byte. The rest of a longer one is cut off.
constexpr std::size_t kMostWord = 254;
// Room that is enough for every structure, bytes.
constexpr std::size_t kMostPacked = 2048;
constexpr std::uint64_t kNoTime = std::numeric_limits<std::uint64_t>::max();

// A field that is a point in time, nanoseconds; kNoTime: none.
struct Moment {
  std::uint64_t& at;
};

// What is packed as it lies in memory: numbers, enumerations, and arrays of them.
template <typename Field>
concept Plain = std::is_arithmetic_v<std::remove_all_extents_t<Field>> ||
                std::is_enum_v<std::remove_all_extents_t<Field>>;

class Packer {
 public:
  // `frame_time`: nanoseconds on the clock of the fields that are Moments; kNoTime: they are packed as kNoTime.
  Packer(std::span<std::byte> room, std::uint64_t frame_time) : room_(room), frame_time_(frame_time) {}

  template <typename... Fields>
  void operator()(Fields&&... fields) {
    (put(fields), ...);
  }
  bool complete() const { return !failed_; }  // false: the room was too small
  std::span<const std::byte> bytes() const { return room_.first(used_); }

 private:
  template <Plain Field>
  void put(const Field& field) {
    put_bytes(&field, sizeof field);
  }
  void put(const char* word) {
    // A character of UTF-8 that does not fit is left out as a whole.
    std::size_t length = word ? std::strlen(word) : 0;
    if (length > kMostWord)
      for (length = kMostWord; length > 0 && (static_cast<unsigned char>(word[length]) & 0xC0) == 0x80;)
        --length;
    put(static_cast<std::uint8_t>(word ? length + 1 : 0));
    put_bytes(word, length);
  }
  void put(const Moment& moment) {
    constexpr std::uint64_t kFar = std::numeric_limits<std::int64_t>::max();
    std::int64_t distance = std::numeric_limits<std::int64_t>::min();
    if (moment.at != kNoTime && frame_time_ != kNoTime)
      distance = moment.at >= frame_time_
                     ? static_cast<std::int64_t>(std::min(moment.at - frame_time_, kFar))
                     : -static_cast<std::int64_t>(std::min(frame_time_ - moment.at, kFar));
    put(distance);
  }
  void put_bytes(const void* from, std::size_t size) {
    failed_ = failed_ || size > room_.size() - used_;
    if (failed_ || size == 0) return;
    std::memcpy(room_.data() + used_, from, size);
    used_ += size;
  }

  std::span<std::byte> room_;
  std::uint64_t frame_time_;
  std::size_t used_ = 0;
  bool failed_ = false;
};

// Never reads beyond `bytes`. Fields after the first that is incomplete keep their values.
class Unpacker {
 public:
  using Keep = const char* (*)(const char* word);  // returns a copy that lives as long as the process

  // `frame_time`: of the same frame on the reader's clock. Times before the zero of that clock become 0.
  Unpacker(std::span<const std::byte> bytes, std::uint8_t version, std::uint64_t frame_time, Keep keep)
      : bytes_(bytes), frame_time_(frame_time), keep_(keep), failed_(version != kPackedVersion) {}

  template <typename... Fields>
  void operator()(Fields&&... fields) {
    (take(fields), ...);
  }
  // False where the bytes are of another version, too few, or more than the fields.
  bool complete() const { return !failed_ && bytes_.empty(); }

 private:
  template <Plain Field>
  void take(Field& field) {
    take_bytes(&field, sizeof field);
  }
  void take(const char*& word) {
    std::uint8_t size = 0;
    std::array<char, kMostWord + 1> text{};
    take(size);
    if (size > 0) take_bytes(text.data(), size - std::size_t{1});
    if (!failed_) word = size > 0 ? keep_(text.data()) : nullptr;
  }
  void take(const Moment& moment) {
    std::int64_t distance = 0;
    take(distance);
    if (failed_) return;
    const auto back = -static_cast<std::uint64_t>(distance);
    if (frame_time_ == kNoTime || distance == std::numeric_limits<std::int64_t>::min())
      moment.at = kNoTime;
    else if (distance < 0)
      moment.at = frame_time_ - std::min(frame_time_, back);
    else
      moment.at = frame_time_ + std::min(static_cast<std::uint64_t>(distance), kNoTime - frame_time_);
  }
  void take_bytes(void* to, std::size_t size) {
    failed_ = failed_ || size > bytes_.size();
    if (failed_ || size == 0) return;
    std::memcpy(to, bytes_.data(), size);
    bytes_ = bytes_.subspan(size);
  }

  std::span<const std::byte> bytes_;
  std::uint64_t frame_time_;
  Keep keep_;
  bool failed_;
};

}  // namespace cerberus::publish
