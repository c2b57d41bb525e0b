// SPDX-License-Identifier: LGPL-2.1-or-later
#include "writer.hpp"

#include "frame_notes.hpp"

namespace cerberus::plugin {

namespace {
// How long a thread may take to end that was given up: one that only waited for a slow disk ends at once.
constexpr std::chrono::milliseconds kLongestEnd{500};
}  // namespace

Writer::Writer() : disk_(std::make_shared<DiskWriter>(nullptr, nullptr)) {}

std::shared_ptr<DiskWriter> Writer::disk() const {
  const std::lock_guard guard(lock_);
  return disk_;
}

std::string Writer::start(const record::Archive::Settings& archive, const Report& report, const Warn& warn,
                          std::chrono::nanoseconds longest) {
  stop(std::chrono::nanoseconds::zero());
  auto disk = std::make_shared<DiskWriter>(report, warn);
  Report for_stop = report;
  // Before anything is kept: it may throw, and callbacks may own the element that owns this.
  thread_ = std::thread([disk, archive] { disk->run(archive); });
  report_ = std::move(for_stop);
  {
    const std::lock_guard guard(lock_);
    disk_ = disk;
  }
  const std::optional<std::string> fault = disk->opened_within(longest);
  if (!fault)
    warn("The folder " + record::in_quotes(archive.folder) +
         " does not answer. What is recorded until it does waits in memory, as far as that goes.");
  return fault.value_or("");
}

void Writer::stop(std::chrono::nanoseconds longest) {
  if (!thread_.joinable()) return;
  const std::shared_ptr<DiskWriter> disk = this->disk();
  disk->stop();
  bool ended = disk->ended_within(longest);
  if (!ended) {
    for (const FileReport& lost : disk->give_up()) report_(lost);
    ended = disk->ended_within(kLongestEnd);
  }
  if (ended)
    thread_.join();
  else
    thread_.detach();
  report_ = nullptr;
  const std::lock_guard guard(lock_);
  disk_ = std::make_shared<DiskWriter>(nullptr, nullptr);
}

void Writer::open(std::shared_ptr<const FileSpec> spec) {
  disk()->enqueue(DiskWriter::Open{std::move(spec)});
}
void Writer::write(std::uint32_t file, int track, GstBuffer* buffer) {
  const std::uint64_t bytes = gst_buffer_get_size(buffer);
  disk()->enqueue(DiskWriter::Write{file, track, {buffer, gst_buffer_unref}}, bytes);
}
void Writer::write_line(std::uint32_t file, std::string line) {
  const std::uint64_t bytes = line.size();
  disk()->enqueue(DiskWriter::Line{file, std::move(line)}, bytes);
}
void Writer::close(const record::FileEnd& end, record::Findings findings) {
  const std::uint64_t bytes = size_of(findings.picture);
  disk()->enqueue(DiskWriter::Close{end, std::move(findings)}, bytes);
}
void Writer::set_limits(const record::Limits& limits) {
  disk()->enqueue(DiskWriter::Limit{limits});
}
void Writer::keep(const std::string& path, bool keep) {
  disk()->enqueue(DiskWriter::Keep{path, keep});
}
void Writer::abandon(std::uint32_t file, const std::string& reason) {
  disk()->enqueue(DiskWriter::Abandon{file, reason});
}
void Writer::when_done(std::function<void()> done) {
  disk()->enqueue(DiskWriter::Done{std::move(done)});
}

void Writer::look_for_answer() {
  disk()->look_for_answer();
}

std::uint64_t Writer::pending() const {
  return disk()->pending();
}

void Writer::wait_below(std::uint64_t bytes, const std::function<bool()>& go_on) {
  disk()->wait_below(bytes, go_on);
}

}  // namespace cerberus::plugin
