// SPDX-License-Identifier: LGPL-2.1-or-later
// Writes files, what goes beside them and their index in a thread of its own, so that a slow disk stops no stream: files
// are opened, filled and closed in the order of the calls. Every method may be called in any thread; none but stop() and
// wait_below() blocks.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <thread>
#include <variant>

#include "file_pipeline.hpp"
#include "record/archive/archive.h"
#include "record/frame_journal.h"

namespace cerberus::plugin {

// What became of a file.
struct FileReport {
  enum class State { started, ended, failed, deleted };
  State state;
  std::shared_ptr<const FileSpec> spec;  // nullptr: of one that retention deleted
  std::string path;                      // empty: none could be made
  std::string lines, picture;            // paths of what is beside it; empty: there is none
  record::FileEnd end;                   // of one that ended
  std::uint64_t bytes = 0;
  FileFault fault;
};

class Writer {
 public:
  // Both are called in the writer's thread, and by start(). `warn`: text for a user, about what does not stop the recording.
  using Report = std::function<void(const FileReport&)>;
  using Warn = std::function<void(const std::string& text)>;

  ~Writer() { stop(); }
  // Opens the archive, which reconciles it, and begins the thread.
  void start(const record::Archive::Settings& archive, Report report, Warn warn);
  // Carries out every call of before, completes the files that are still open, waits for them (at most ten seconds),
  // and ends the thread.
  void stop();

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
  struct Line {
    std::uint32_t file;
    std::string text;
  };
  struct Close {
    record::FileEnd end;
    record::Findings findings;
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
  struct Limit {
    record::Limits limits;
  };
  struct Keep {
    std::string path;
    bool keep;
  };
  using Command = std::variant<Open, Write, Line, Close, Abandon, Ended, Done, Limit, Keep>;

  struct File {
    std::shared_ptr<const FileSpec> spec;
    std::string path;
    record::Recording row;
    record::OpenFile lock, lines;
    bool without_lines = false;  // they cannot be written
    std::unique_ptr<FilePipeline> pipeline;
    record::FileEnd end;
    GstClockTime last = 0;  // in the file
    bool closing = false;
  };

  void enqueue(Command command, std::uint64_t bytes = 0);
  void run();
  void execute(Open& command);
  void execute(Write& command);
  void execute(Line& command);
  void execute(Close& command);
  void execute(Abandon& command);
  void execute(Ended& command);
  void execute(Done& command);
  void execute(Limit& command);
  void execute(Keep& command);
  void save_picture(File& file, const record::Picture& picture);
  void retain();
  void report_deleted(const std::vector<std::string>& names);
  void pass_complaints();
  record::Surroundings surroundings() const;
  void fail(std::uint32_t file, const FileFault& fault);
  void report_end(File& file, FileReport::State state, const FileFault& fault);
  void check_done();

  Report report_;
  Warn warn_;
  std::thread thread_;
  mutable std::mutex lock_;
  std::condition_variable changed_, lower_;
  std::deque<Command> commands_;
  std::uint64_t queued_ = 0, level_ = 0;  // bytes in commands_, and in the files' pipelines
  bool stopping_ = false;

  // Of the writer's thread:
  std::string folder_;
  record::Archive archive_;
  std::map<std::uint32_t, File> files_;
  std::vector<std::function<void()>> waiting_;
};

}  // namespace cerberus::plugin
