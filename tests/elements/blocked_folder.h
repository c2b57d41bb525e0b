// SPDX-License-Identifier: LGPL-2.1-or-later
// A folder whose disk does not answer: calls of the C library that name it wait, in every module of this process. Included
// once a program, which is linked with `export_dynamic`.
#pragma once

#include <fcntl.h>
#include <glib.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <cstring>
#include <string>

// Before main() it is all zero, which is valid.
struct BlockedFolder {
  enum class What { looks, writes };

  void block(const std::string& folder, What which = What::looks) {
    g_mutex_lock(&lock_);
    g_strlcpy(path_, folder.c_str(), sizeof path_);
    what_ = which;
    g_mutex_unlock(&lock_);
  }
  void release() {
    block("");
    g_cond_broadcast(&changed_);
  }
  void await_look(const char* folder) {
    g_mutex_lock(&lock_);
    while (*path_ && what_ == What::looks && strcmp(folder, path_) == 0) g_cond_wait(&changed_, &lock_);
    g_mutex_unlock(&lock_);
  }
  void await_write(int file) {
    char link[32], name[4096] = {};
    g_snprintf(link, sizeof link, "/proc/self/fd/%d", file);
    const bool known = readlink(link, name, sizeof name - 1) > 0;
    g_mutex_lock(&lock_);
    while (known && *path_ && what_ == What::writes && strncmp(name, path_, strlen(path_)) == 0)
      g_cond_wait(&changed_, &lock_);
    g_mutex_unlock(&lock_);
  }

 private:
  GMutex lock_;
  GCond changed_;
  char path_[64];
  What what_;
};
inline BlockedFolder blocked_folder;

extern "C" int access(const char* path, int mode) noexcept {
  blocked_folder.await_look(path);
  return faccessat(AT_FDCWD, path, mode, 0);
}
extern "C" ssize_t writev(int file, const iovec* parts, int count) {
  blocked_folder.await_write(file);
  return syscall(SYS_writev, file, parts, count);
}
