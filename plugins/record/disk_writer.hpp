// SPDX-License-Identifier: LGPL-2.1-or-later
// What runs in the writer's thread: carries out its commands in their order and owns the archive and the open files. Its
// own object, because the thread may outlast the recorder where a disk does not answer. enqueue(), look_for_answer(),
// pending(), wait_below() and what belongs to stopping may be called in any thread, all else in the writer's.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <variant>

#include "file_pipeline.hpp"
#include "record/archive/archive.h"
#include "record/frame_journal.h"
#include "record/recording_faults.h"
#include "threads/in_order.h"

namespace cerberus::plugin {

// What became of a file, or of all recording.
struct FileReport {
  enum class State { started, ended, failed, deleted, fault, sound };
  State state;
  std::shared_ptr<const FileSpec> spec;  // nullptr for a file that retention deleted, and for all recording
  std::string path;                      // empty: none could be made
  std::string lines, picture;            // paths of what is beside it; empty: there is none
  record::FileEnd end;                   // of one that ended
  std::uint64_t bytes = 0;               // 0: nothing in it plays
  FileFault fault;                       // of one that failed, and why all recording fails
};

class DiskWriter {
 public:
  // `warn`: text for a user, about what does not stop the recording.
  using Report = std::function<void(const FileReport&)>;
  using Warn = std::function<void(const std::string& text)>;

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

  DiskWriter(Report report, Warn warn) : report_(std::move(report)), warn_(std::move(warn)) {}

  // The thread: opens the archive, which reconciles it, and carries out commands until every one is done and every file
  // complete after stop(), or until give_up().
  void run(const record::Archive::Settings& archive);
  // Waits for the archive to open, at most `longest`. Returns the fault of its folder (empty: none), or nullopt where the
  // disk has not answered; a fault that shows later is a warning.
  std::optional<std::string> opened_within(std::chrono::nanoseconds longest);
  // `bytes` of it wait for the disk.
  void enqueue(Command command, std::uint64_t bytes = 0);
  void stop();
  // Returns whether run() has ended, for which it waits so long.
  bool ended_within(std::chrono::nanoseconds longest);
  // From now on nothing is reported, and the thread ends as soon as the disk answers. Returns reports of the files that
  // are not complete.
  std::vector<FileReport> give_up();

  // Reports a disk on which the thread has waited too long; it cannot do so itself.
  void look_for_answer();

  // Bytes that wait for the disk.
  std::uint64_t pending() const;
  // Waits until fewer wait, while `go_on` is true.
  void wait_below(std::uint64_t bytes, const std::function<bool()>& go_on);

 private:
  struct File {
    std::shared_ptr<const FileSpec> spec;
    std::string path;
    record::Recording row;
    record::OpenFile lock, lines;
    bool without_lines = false;  // they cannot be written
    std::unique_ptr<FilePipeline> pipeline;
    record::FileEnd end;
    GstClockTime last = 0;  // in the file
    record::Time since{};   // steady
    bool closing = false;
    std::uint64_t taken = 0;  // of the video, at the last look
    record::Time moved{};     // steady: when that was more than before, or nothing waited
  };

  // A file that was asked for and is neither complete nor reported as failed.
  struct Unfinished {
    std::shared_ptr<const FileSpec> spec;
    std::string path;  // empty: it was not made yet
  };

  void open(const record::Archive::Settings& archive);
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
  void watch();
  bool all_move();
  void look_at_index();
  void report_fault();
  std::string takes_none(int error) const;
  std::string no_answer() const;
  record::Surroundings surroundings() const;
  void fail(std::uint32_t file, const FileFault& fault);
  void report_end(File& file, FileReport::State state, const FileFault& fault);
  void check_done();
  bool is_given_up() const;
  void report(const FileReport& what);
  void warn(const std::string& text);

  Report report_;
  Warn warn_;
  mutable std::mutex lock_;
  std::condition_variable changed_, lower_, opened_, over_;
  struct Queued {
    Command command;
    std::uint64_t bytes;
  };
  std::deque<Queued> commands_;
  std::uint64_t queued_ = 0, level_ = 0;  // bytes in commands_, and in the files' pipelines
  bool stopping_ = false, given_up_ = false, ended_ = false;
  std::optional<std::string> folder_fault_;  // see opened_within()
  bool late_ = false;  // opened_within() gave up; a fault of the folder is then a warning
  std::map<std::uint32_t, Unfinished> unfinished_;
  record::RecordingFaults faults_;
  std::optional<record::Time> busy_since_;  // steady: when the thread last waited for nothing but commands
  threads::InOrder<FileReport, 16> faults_to_report_;

  std::string folder_;  // set before anything waits
  // Of the writer's thread:
  record::Archive archive_;
  std::map<std::uint32_t, File> files_;
  std::vector<std::function<void()>> waiting_;
};

}  // namespace cerberus::plugin
