// SPDX-License-Identifier: LGPL-2.1-or-later
// The folder of the recordings. Every name is relative to it; names that lead out of it, by `..`, by an absolute path or
// by a symbolic link inside of it, are refused. Functions that can fail return an errno; 0: done.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace cerberus::record {

// `words` between quotation marks, for texts of faults.
inline std::string in_quotes(std::string_view words) {
  std::string text(1, '"');
  text += words;
  return text += '"';
}

// A file that is open, and locked against retention and reconciliation of every recorder until it is closed. The lock
// ends with the process, however that ends.
class OpenFile {
 public:
  OpenFile() = default;
  explicit OpenFile(int fd) : fd_(fd) {}
  ~OpenFile() { close(); }
  OpenFile(OpenFile&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  OpenFile& operator=(OpenFile&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  explicit operator bool() const { return fd_ >= 0; }
  int descriptor() const { return fd_; }
  // Appends all of it, or returns an errno.
  int write(const void* bytes, std::size_t size) const;
  // Waits until what is written is on the disk.
  int sync() const;
  void close();

 private:
  int fd_ = -1;
};

class Folder {
 public:
  explicit Folder(std::string path) : path_(std::move(path)) {}
  const std::string& path() const { return path_; }
  std::string path_of(const std::string& name) const { return path_ + '/' + name; }

  // 0: it is there, and this process may make files in it.
  int usable() const;
  // Writes a file of this size there and deletes it. 0: the disk takes recordings.
  int try_out(std::uint64_t bytes) const;
  // Whether `name` can be a file's name below the folder.
  static bool is_name(const std::string& name);

  // Makes a file (mode 0640) that is not there yet, and the folders in its name (mode 0750); never the folder itself,
  // which may be a disk that is not mounted. EEXIST: there is something of that name.
  int create(const std::string& name, OpenFile& file) const;
  // Opens a regular file for reading and writing, and locks it. EWOULDBLOCK: a recorder has it open.
  int lock(const std::string& name, OpenFile& file) const;
  // The same for reading alone, as of a read-only disk, and without a lock.
  int open_to_read(const std::string& name, OpenFile& file) const;
  // Whether there is anything of that name.
  bool exists(const std::string& name) const;
  // The size of a regular file; nullopt: there is none.
  std::optional<std::uint64_t> size(const std::string& name) const;
  // Time of its last change, ns since 1970; 0: there is none.
  std::int64_t changed(const std::string& name) const;
  // Whether `file` is still the one of that name: it may have been removed or moved since it was opened.
  bool is_there(const std::string& name, const OpenFile& file) const;
  // Whether a recorder has it open.
  bool in_use(const std::string& name) const;
  // Deletes a regular file, and the folders in its name that are empty then. A file that is not there is no failure.
  int remove(const std::string& name) const;
  // Bytes that are free on its disk for this process; nullopt: the folder cannot be reached.
  std::optional<std::uint64_t> free_bytes() const;

 private:
  std::string path_;
};

}  // namespace cerberus::record
