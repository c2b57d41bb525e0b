// SPDX-License-Identifier: LGPL-2.1-or-later
#include "writer.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <stdexcept>

namespace cerberus::plugin {

namespace {

using namespace std::chrono_literals;
constexpr auto kLongestStop = 10s;  // a disk that takes longer is not waited for
constexpr auto kLook = 20ms;        // how often the pipelines' levels are read while bytes wait
constexpr int kMostNamesakes = 1000;

// Makes a file that nothing else has made: `name`, `name~1`, `name~2` ... with the ending. Throws what went wrong.
std::string claim(const FileSpec& spec) {
  const std::filesystem::path base = std::filesystem::path(spec.folder) / spec.name;
  const auto fail = [](const std::string& path, int error) {
    throw std::runtime_error("\"" + path + "\": " + std::strerror(error));
  };
  // Only below the folder: if that itself is gone (a disk that is not mounted), nothing is made in its place.
  struct stat about{};
  if (stat(spec.folder.c_str(), &about) != 0) fail(spec.folder, errno);
  std::error_code error;
  std::filesystem::create_directories(base.parent_path(), error);
  if (error) fail(base.parent_path().string(), error.value());
  for (int k = 0; k < kMostNamesakes; ++k) {
    const std::string path =
        base.string() + (k ? '~' + std::to_string(k) : std::string()) + (spec.mp4 ? ".mp4" : ".mkv");
    const int fd = open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0640);
    if (fd >= 0) {
      ::close(fd);
      return path;
    }
    if (errno != EEXIST) fail(path, errno);
  }
  fail(base.string(), EEXIST);
  return {};
}

std::uint64_t size_of(const std::string& path) {
  struct stat about{};
  return !path.empty() && stat(path.c_str(), &about) == 0 ? static_cast<std::uint64_t>(about.st_size) : 0;
}

}  // namespace

void Writer::start(Report report) {
  stop();
  report_ = std::move(report);
  stopping_ = false;
  thread_ = std::thread([this] { run(); });
}

void Writer::stop() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard guard(lock_);
    stopping_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Writer::enqueue(Command command, std::uint64_t bytes) {
  {
    const std::lock_guard guard(lock_);
    commands_.push_back(std::move(command));
    queued_ += bytes;
  }
  changed_.notify_all();
}

void Writer::open(std::shared_ptr<const FileSpec> spec) {
  enqueue(Open{std::move(spec)});
}
void Writer::write(std::uint32_t file, int track, GstBuffer* buffer) {
  const std::uint64_t bytes = gst_buffer_get_size(buffer);
  enqueue(Write{file, track, {buffer, gst_buffer_unref}}, bytes);
}
void Writer::close(const record::FileEnd& end) {
  enqueue(Close{end});
}
void Writer::abandon(std::uint32_t file, const std::string& reason) {
  enqueue(Abandon{file, reason});
}
void Writer::when_done(std::function<void()> done) {
  enqueue(Done{std::move(done)});
}

std::uint64_t Writer::pending() const {
  const std::lock_guard guard(lock_);
  return queued_ + level_;
}

void Writer::wait_below(std::uint64_t bytes, const std::function<bool()>& go_on) {
  std::unique_lock guard(lock_);
  while (queued_ + level_ >= bytes && !stopping_ && go_on()) lower_.wait_for(guard, kLook);
}

void Writer::run() {
  std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max();
  while (true) {
    std::optional<Command> command;
    {
      std::unique_lock guard(lock_);
      const auto ready = [this] { return !commands_.empty() || stopping_; };
      if (level_ > 0 || stopping_)
        changed_.wait_for(guard, kLook, [this] { return !commands_.empty(); });
      else
        changed_.wait(guard, ready);
      if (!commands_.empty()) {
        command = std::move(commands_.front());
        commands_.pop_front();
        if (const auto* write = std::get_if<Write>(&*command))
          queued_ -= gst_buffer_get_size(write->buffer.get());
      } else if (stopping_) {
        const auto now = std::chrono::steady_clock::now();
        if (deadline == std::chrono::steady_clock::time_point::max()) {
          deadline = now + kLongestStop;
          for (auto& [number, file] : files_)
            if (!file.closing) file.pipeline->finish();
        }
        if (files_.empty() || now >= deadline) break;
      }
    }
    if (command) std::visit([this](auto& each) { execute(each); }, *command);
    std::uint64_t level = 0;
    for (const auto& [number, file] : files_) level += file.pipeline->level();
    {
      const std::lock_guard guard(lock_);
      level_ = level;
    }
    lower_.notify_all();
  }
  files_.clear();
  waiting_.clear();
}

void Writer::execute(Open& command) {
  File file{command.spec, {}, nullptr, {}, false};
  const std::uint32_t number = command.spec->start.file;
  try {
    file.path = claim(*command.spec);
    file.pipeline = std::make_unique<FilePipeline>(
        *command.spec, file.path,
        [this, number](std::shared_ptr<const FileFault> fault) { enqueue(Ended{number, std::move(fault)}); });
  } catch (const std::exception& error) {
    report_end(file, FileReport::State::failed, {error.what(), ""});
    return;
  }
  report_({FileReport::State::started, file.spec, file.path, {}, 0, {}});
  files_.emplace(number, std::move(file));
}

void Writer::execute(Write& command) {
  const auto found = files_.find(command.file);
  if (found == files_.end()) return;
  found->second.pipeline->push(command.track, gst_buffer_ref(command.buffer.get()));
}

void Writer::execute(Close& command) {
  const auto found = files_.find(command.end.file);
  if (found == files_.end()) return;
  found->second.end = command.end;
  found->second.closing = true;
  found->second.pipeline->finish();
}

void Writer::execute(Abandon& command) {
  fail(command.file, {command.reason, ""});
}

void Writer::execute(Ended& command) {
  if (command.fault) return fail(command.file, *command.fault);
  const auto found = files_.find(command.file);
  if (found == files_.end()) return;
  File file = std::move(found->second);
  files_.erase(found);
  file.pipeline.reset();
  report_end(file, FileReport::State::ended, {});
  check_done();
}

void Writer::execute(Done& command) {
  waiting_.push_back(std::move(command.done));
  check_done();
}

void Writer::fail(std::uint32_t number, const FileFault& fault) {
  const auto found = files_.find(number);
  if (found == files_.end()) return;
  File file = std::move(found->second);
  files_.erase(found);
  file.pipeline.reset();
  report_end(file, FileReport::State::failed, fault);
  check_done();
}

void Writer::report_end(File& file, FileReport::State state, const FileFault& fault) {
  const std::uint64_t bytes = size_of(file.path);
  if (state == FileReport::State::failed && bytes == 0 && !file.path.empty()) unlink(file.path.c_str());
  report_({state, file.spec, file.path, file.end, bytes, fault});
}

void Writer::check_done() {
  for (const auto& [number, file] : files_)
    if (file.closing) return;
  for (const auto& done : std::exchange(waiting_, {})) done();
}

}  // namespace cerberus::plugin
