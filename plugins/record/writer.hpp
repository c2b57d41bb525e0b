// SPDX-License-Identifier: LGPL-2.1-or-later
// Writes files in a thread of its own, so that a slow disk stops no stream: files are opened, filled and closed in the
// order of the calls. Every method may be called in any thread; none but stop() and wait_below() blocks.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <thread>
#include <variant>

#include "file_pipeline.hpp"

namespace cerberus::plugin {

// What became of a file.
struct FileReport {
  enum class State { started, ended, failed };
  State state;
  std::shared_ptr<const FileSpec> spec;
  std::string path;     // empty: none could be made
  record::FileEnd end;  // of one that ended
  std::uint64_t bytes = 0;
  FileFault fault;
};

class Writer {
 public:
  using Report = std::function<void(const FileReport&)>;  // in the writer's thread

  ~Writer() { stop(); }
  void start(Report report);
  // Carries out every call of before, completes the files that are still open, waits for them (at most ten seconds),
  // and ends the thread.
  void stop();

  void open(std::shared_ptr<const FileSpec> spec);
  // Takes `buffer`; its times become those of the file.
  void write(std::uint32_t file, int track, GstBuffer* buffer);
  void close(const record::FileEnd& end);
  // Gives a file up: it stays as far as it is written, and is reported as failed for `reason`.
  void abandon(std::uint32_t file, const std::string& reason);
  // Calls done() once all files that are closed by now are complete.
  void when_done(std::function<void()> done);

  // Bytes that wait for the disk.
  std::uint64_t pending() const;
  // Waits until fewer wait, while `go_on` is true.
  void wait_below(std::uint64_t bytes, const std::function<bool()>& go_on);

 private:
  struct Open {
    std::shared_ptr<const FileSpec> spec;
  };
  struct Write {
    std::uint32_t file;
    int track;
    std::shared_ptr<GstBuffer> buffer;
  };
  struct Close {
    record::FileEnd end;
  };
  struct Abandon {
    std::uint32_t file;
    std::string reason;
  };
  struct Ended {
    std::uint32_t file;
    std::shared_ptr<const FileFault> fault;
  };
  struct Done {
    std::function<void()> done;
  };
  using Command = std::variant<Open, Write, Close, Abandon, Ended, Done>;

  struct File {
    std::shared_ptr<const FileSpec> spec;
    std::string path;
    std::unique_ptr<FilePipeline> pipeline;
    record::FileEnd end;
    bool closing = false;
  };

  void enqueue(Command command, std::uint64_t bytes = 0);
  void run();
  void execute(Open& command);
  void execute(Write& command);
  void execute(Close& command);
  void execute(Abandon& command);
  void execute(Ended& command);
  void execute(Done& command);
  void fail(std::uint32_t file, const FileFault& fault);
  void report_end(File& file, FileReport::State state, const FileFault& fault);
  void check_done();

  Report report_;
  std::thread thread_;
  mutable std::mutex lock_;
  std::condition_variable changed_, lower_;
  std::deque<Command> commands_;
  std::uint64_t queued_ = 0, level_ = 0;  // bytes in commands_, and in the files' pipelines
  bool stopping_ = false;

  // Of the writer's thread:
  std::map<std::uint32_t, File> files_;
  std::vector<std::function<void()>> waiting_;
};

}  // namespace cerberus::plugin
