// SPDX-License-Identifier: LGPL-2.1-or-later
// Writes files, what goes beside them and their index in a thread of its own, so that a slow disk stops no stream: files
// are opened, filled and closed in the order of the calls. Every method may be called in any thread; none but start(),
// stop() and wait_below() blocks.
#pragma once

#include <thread>

#include "disk_writer.hpp"

namespace cerberus::plugin {

class Writer {
 public:
  // Both are called in the writer's thread, by start(), by look_for_answer() and by stop(). They are called after stop() where the disk did not
  // answer during a call: they own what they need.
  using Report = DiskWriter::Report;
  using Warn = DiskWriter::Warn;

  Writer();
  ~Writer() { stop(std::chrono::nanoseconds::zero()); }
  // Begins the thread, and waits until it has opened the archive, which reconciles it. Returns what is wrong with the
  // folder; an empty string: nothing. Where the disk does not answer within `longest`, a warning says so, and what comes
  // waits for the disk as ever.
  std::string start(const record::Archive::Settings& archive, const Report& report, const Warn& warn,
                    std::chrono::nanoseconds longest);
  // Carries out every call of before, completes the files that are still open, waits for them, and ends the thread. What
  // the disk has not taken after `longest` is reported as failed, and the thread is left alone with it.
  void stop(std::chrono::nanoseconds longest);

  void open(std::shared_ptr<const FileSpec> spec);
  // Takes `buffer`; its times become those of the file.
  void write(std::uint32_t file, int track, GstBuffer* buffer);
  // Appends to the JSON lines beside the file.
  void write_line(std::uint32_t file, std::string line);
  void close(const record::FileEnd& end, record::Findings findings);
  void set_limits(const record::Limits& limits);
  // Sets or clears `keep` of a file, named by its path.
  void keep(const std::string& path, bool keep);
  // Gives a file up: it stays as far as it is written, and is reported as failed for `reason`.
  void abandon(std::uint32_t file, const std::string& reason);
  // Calls done() once all files that are closed by now are complete.
  void when_done(std::function<void()> done);

  // Reports a disk that has not answered for too long; meant for every frame.
  void look_for_answer();

  // Bytes that wait for the disk.
  std::uint64_t pending() const;
  // Waits until fewer wait, while `go_on` is true.
  void wait_below(std::uint64_t bytes, const std::function<bool()>& go_on);

 private:
  std::shared_ptr<DiskWriter> disk() const;

  mutable std::mutex lock_;  // of disk_
  std::shared_ptr<DiskWriter> disk_;
  Report report_;
  std::thread thread_;
};

}  // namespace cerberus::plugin
