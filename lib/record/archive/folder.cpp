// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/archive/folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <string_view>

namespace cerberus::record {

namespace {

constexpr mode_t kFileMode = 0640, kFolderMode = 0750;

// Opens the folder in which the last component of `name` lies, one component after the other and through no symbolic
// link. `make`: missing ones are made. Returns an errno.
int open_parent(const std::string& path, const std::string& name, bool make, OpenFile& parent, int& fd,
                std::string& last) {
  if (!Folder::is_name(name)) return EINVAL;
  fd = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (fd < 0) return errno;
  parent = OpenFile(fd);
  std::size_t from = 0;
  for (std::size_t slash = name.find('/'); slash != std::string::npos; slash = name.find('/', from)) {
    const std::string component = name.substr(from, slash - from);
    from = slash + 1;
    if (make && mkdirat(fd, component.c_str(), kFolderMode) != 0 && errno != EEXIST) return errno;
    const int below = openat(fd, component.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (below < 0) return errno;
    OpenFile next(below);
    parent = std::move(next);
    fd = below;
  }
  last = name.substr(from);
  return 0;
}

// What there is of that name, not following a link.
bool look_at(const std::string& path, const std::string& name, struct stat& about) {
  OpenFile parent;
  int fd = -1;
  std::string last;
  return open_parent(path, name, false, parent, fd, last) == 0 &&
         fstatat(fd, last.c_str(), &about, AT_SYMLINK_NOFOLLOW) == 0;
}

int open_regular(const std::string& path, const std::string& name, int access, OpenFile& file) {
  OpenFile parent;
  int fd = -1;
  std::string last;
  if (const int error = open_parent(path, name, false, parent, fd, last); error) return error;
  const int opened = openat(fd, last.c_str(), access | O_NOFOLLOW | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
  if (opened < 0) return errno;
  file = OpenFile(opened);
  struct stat about{};
  return fstat(opened, &about) == 0 && S_ISREG(about.st_mode) ? 0 : EINVAL;
}

}  // namespace

int OpenFile::write(const void* bytes, std::size_t size) const {
  const auto* from = static_cast<const char*>(bytes);
  while (size > 0) {
    const ssize_t done = ::write(fd_, from, size);
    if (done < 0 && errno == EINTR) continue;
    if (done < 0) return errno;
    from += done;
    size -= static_cast<std::size_t>(done);
  }
  return 0;
}

int OpenFile::sync() const {
  return fd_ < 0 || fsync(fd_) == 0 ? 0 : errno;
}

void OpenFile::close() {
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
}

bool Folder::is_name(const std::string& name) {
  if (name.empty() || name.front() == '/' || name.back() == '/') return false;
  if (std::ranges::any_of(name, [](char letter) { return static_cast<unsigned char>(letter) < ' '; }))
    return false;
  std::string_view rest = name;
  while (true) {
    const std::size_t slash = rest.find('/');
    const std::string_view part = rest.substr(0, slash);
    if (part.empty() || part == "." || part == "..") return false;
    if (slash == std::string_view::npos) return true;
    rest.remove_prefix(slash + 1);
  }
}

int Folder::usable() const {
  struct stat about{};
  if (stat(path_.c_str(), &about) != 0) return errno;
  if (!S_ISDIR(about.st_mode)) return ENOTDIR;
  return access(path_.c_str(), W_OK | X_OK) != 0 ? errno : 0;
}

// The file has no name while it is written: nothing is left behind. Room is taken as posix_fallocate(3) does it, which
// wears no flash memory.
int Folder::try_out(std::uint64_t bytes) const {
  rlimit limit{};
  if (getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur < bytes) return EFBIG;  // else a signal says so
  const std::string name = ".trial-" + std::to_string(getpid()) + '-' + std::to_string(gettid());
  OpenFile file;
  if (const int error = create(name, file); error) return error;
  if (const int error = remove(name); error) return error;
  static constexpr char kBytes[4096] = {};
  if (const int error = file.write(kBytes, sizeof kBytes); error) return error;
  if (const int error = posix_fallocate(file.descriptor(), 0, static_cast<off_t>(bytes)); error) return error;
  return file.sync();
}

int Folder::create(const std::string& name, OpenFile& file) const {
  // Another recorder may remove a folder between its making and its use, and take a file that is not locked yet for what
  // a killed process left.
  int error = 0;
  for (int attempt = 0; attempt < 3; ++attempt) {
    OpenFile parent;
    int fd = -1;
    std::string last;
    error = open_parent(path_, name, true, parent, fd, last);
    if (!error) {
      const int made =
          openat(fd, last.c_str(), O_RDWR | O_CREAT | O_EXCL | O_APPEND | O_NOFOLLOW | O_CLOEXEC, kFileMode);
      if (made >= 0) {
        OpenFile own(made);
        struct stat about{};
        flock(made, LOCK_EX);
        if (fstat(made, &about) == 0 && about.st_nlink > 0) {
          file = std::move(own);
          return 0;
        }
        errno = ENOENT;
      }
      error = errno;
    }
    if (error != ENOENT) return error;
  }
  return error;
}

int Folder::lock(const std::string& name, OpenFile& file) const {
  OpenFile opened;
  if (const int error = open_regular(path_, name, O_RDWR, opened); error) return error;
  // A file system without locks has none that another recorder could hold.
  if (flock(opened.descriptor(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) return EWOULDBLOCK;
  struct stat about{};
  if (fstat(opened.descriptor(), &about) != 0 || about.st_nlink == 0)
    return ENOENT;  // it was deleted meanwhile
  file = std::move(opened);
  return 0;
}

int Folder::open_to_read(const std::string& name, OpenFile& file) const {
  return open_regular(path_, name, O_RDONLY, file);
}

bool Folder::exists(const std::string& name) const {
  struct stat about{};
  return look_at(path_, name, about);
}

std::optional<std::uint64_t> Folder::size(const std::string& name) const {
  struct stat about{};
  if (!look_at(path_, name, about) || !S_ISREG(about.st_mode)) return std::nullopt;
  return static_cast<std::uint64_t>(about.st_size);
}

std::int64_t Folder::changed(const std::string& name) const {
  struct stat about{};
  if (!look_at(path_, name, about)) return 0;
  return std::int64_t{about.st_mtim.tv_sec} * 1'000'000'000 + about.st_mtim.tv_nsec;
}

bool Folder::is_there(const std::string& name, const OpenFile& file) const {
  struct stat named{}, opened{};
  return look_at(path_, name, named) && fstat(file.descriptor(), &opened) == 0 &&
         named.st_ino == opened.st_ino && named.st_dev == opened.st_dev;
}

bool Folder::in_use(const std::string& name) const {
  OpenFile file;
  return open_to_read(name, file) == 0 && flock(file.descriptor(), LOCK_SH | LOCK_NB) != 0 &&
         errno == EWOULDBLOCK;
}

int Folder::remove(const std::string& name) const {
  OpenFile parent;
  int fd = -1;
  std::string last;
  int error = open_parent(path_, name, false, parent, fd, last);
  if (error == ENOENT) return 0;
  if (error) return error;
  struct stat about{};
  if (fstatat(fd, last.c_str(), &about, AT_SYMLINK_NOFOLLOW) != 0) return errno == ENOENT ? 0 : errno;
  if (!S_ISREG(about.st_mode)) return EINVAL;
  if (unlinkat(fd, last.c_str(), 0) != 0 && errno != ENOENT) return errno;
  for (std::size_t slash = name.rfind('/'); slash != std::string::npos && slash > 0;
       slash = name.rfind('/', slash - 1)) {
    const std::string above = name.substr(0, slash);
    if (open_parent(path_, above, false, parent, fd, last) != 0) break;
    if (unlinkat(fd, last.c_str(), AT_REMOVEDIR) != 0) break;
  }
  return 0;
}

std::optional<std::uint64_t> Folder::free_bytes() const {
  struct statvfs about{};
  if (statvfs(path_.c_str(), &about) != 0) return std::nullopt;
  return static_cast<std::uint64_t>(about.f_bavail) * about.f_frsize;
}

}  // namespace cerberus::record
