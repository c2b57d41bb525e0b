// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/archive/mp4_repair.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cerberus::record {

namespace {

constexpr std::uint64_t kHeader = 8, kLargeHeader = 16;
// A moov without samples has about 1 kB a track; the whole first fragment lies in front of it.
constexpr std::uint64_t kLongestMoov = 1 << 20;
constexpr std::uint64_t kLongestSearch = 64 << 20;

struct Box {
  std::uint64_t offset = 0, size = 0;
  std::string type;
  bool large = false;  // a size of 64 bits
  std::uint64_t end() const { return offset + size; }
};

std::uint64_t big_endian(const std::uint8_t* bytes, int count) {
  std::uint64_t number = 0;
  for (int k = 0; k < count; ++k) number = number << 8 | bytes[k];
  return number;
}

std::optional<Box> read_box(int fd, std::uint64_t offset) {
  std::array<std::uint8_t, kLargeHeader> bytes{};
  const ssize_t got = pread(fd, bytes.data(), bytes.size(), static_cast<off_t>(offset));
  if (got < static_cast<ssize_t>(kHeader)) return std::nullopt;
  Box box{offset, big_endian(bytes.data(), 4), std::string(reinterpret_cast<char*>(bytes.data()) + 4, 4),
          false};
  if (box.size == 1 && got == static_cast<ssize_t>(kLargeHeader)) {
    box.large = true;
    box.size = big_endian(bytes.data() + kHeader, 8);
  }
  if (box.size < kHeader || box.size > UINT64_MAX / 2) return std::nullopt;
  return box;
}

bool write_at(int fd, std::uint64_t offset, const void* bytes, std::size_t size) {
  return pwrite(fd, bytes, size, static_cast<off_t>(offset)) == static_cast<ssize_t>(size);
}

// Whether a hidden moov lies there: behind it a fragment goes on, or the file ends.
std::optional<Box> hidden_moov(int fd, std::uint64_t offset, std::uint64_t file) {
  const auto box = read_box(fd, offset);
  if (!box || box->type != "hoov" || box->size > kLongestMoov || box->end() > file) return std::nullopt;
  const auto next = read_box(fd, box->end());
  const bool goes_on = !next ? box->end() == file : next->type == "free" || next->type == "mdat";
  return goes_on ? box : std::nullopt;
}

// Looks for it within an mdat that was extended over it.
std::optional<Box> find_hidden_moov(int fd, const Box& mdat, std::uint64_t file) {
  constexpr std::string_view kType = "hoov";
  std::vector<char> bytes(1 << 16);
  const std::uint64_t until = std::min(file, mdat.offset + kLongestSearch);
  for (std::uint64_t at = mdat.offset; at + kHeader < until;) {
    const ssize_t got = pread(fd, bytes.data(), bytes.size(), static_cast<off_t>(at));
    if (got < static_cast<ssize_t>(kHeader)) return std::nullopt;
    const std::string_view text(bytes.data(), static_cast<std::size_t>(got));
    for (std::size_t found = text.find(kType); found != std::string_view::npos;
         found = text.find(kType, found + 1))
      if (at + found >= mdat.offset + kHeader)
        if (auto box = hidden_moov(fd, at + found - 4, file)) return box;
    at += static_cast<std::uint64_t>(got) - (kType.size() - 1);  // a type may lie across two reads
  }
  return std::nullopt;
}

// Gives the first mdat the size of the first fragment again. A large header took the place of the `free` before it.
bool shorten(int fd, const Box& mdat, std::uint64_t end) {
  std::array<std::uint8_t, kLargeHeader> header = {0, 0, 0, 8, 'f', 'r', 'e', 'e',
                                                   0, 0, 0, 0, 'm', 'd', 'a', 't'};
  const std::uint64_t from = mdat.large ? mdat.offset + kHeader : mdat.offset;
  const std::uint64_t size = end - from;
  for (int k = 0; k < 4; ++k)
    header[8 + static_cast<std::size_t>(k)] = static_cast<std::uint8_t>(size >> (24 - 8 * k));
  return mdat.large ? write_at(fd, mdat.offset, header.data(), header.size())
                    : write_at(fd, from, header.data() + kHeader, kHeader);
}

}  // namespace

Mp4State repair_mp4(int fd) {
  struct stat about{};
  // With O_APPEND pwrite() writes at the end on Linux.
  const int flags = fcntl(fd, F_GETFL);
  if (flags < 0 || fcntl(fd, F_SETFL, flags & ~O_APPEND) != 0) return Mp4State::failed;
  if (fstat(fd, &about) != 0) return Mp4State::failed;
  const auto file = static_cast<std::uint64_t>(about.st_size);
  std::optional<Box> mdat, hidden, torn;
  for (std::uint64_t at = 0; at < file;) {
    const auto box = read_box(fd, at);
    if (!box) break;
    if (box->type == "moov" && box->end() <= file) return Mp4State::sound;
    if (box->type == "moov") torn = box;
    if (box->type == "mdat" && !mdat) mdat = box;
    if (box->type == "hoov" && !hidden) hidden = hidden_moov(fd, at, file);
    at = box->end();
  }
  if (!mdat) return Mp4State::broken;
  const bool extended = !hidden;
  if (extended) hidden = find_hidden_moov(fd, *mdat, file);
  if (!hidden) return Mp4State::broken;
  if (torn && ftruncate(fd, static_cast<off_t>(torn->offset)) != 0) return Mp4State::failed;
  if (extended && !shorten(fd, *mdat, hidden->offset)) return Mp4State::failed;
  return write_at(fd, hidden->offset + 4, "moov", 4) ? Mp4State::repaired : Mp4State::failed;
}

}  // namespace cerberus::record
