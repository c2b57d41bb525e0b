// SPDX-License-Identifier: LGPL-2.1-or-later
#include "disk_writer.hpp"

#include <sys/stat.h>
#include <sys/timex.h>
#include <unistd.h>

#include <chrono>
#include <cstring>
#include <stdexcept>

#include "frame_notes.hpp"
#include "shared/clock_times.hpp"

namespace cerberus::plugin {

namespace {

using namespace std::chrono_literals;
constexpr auto kLook = 20ms;      // how often the pipelines' levels are read while bytes wait
constexpr auto kRetention = 10s;  // how often retention is applied
constexpr auto kWatch = 2s;       // how often the folder is looked at while nothing is asked for

std::string comma_separated(const auto& values, auto text_of) {
  std::string text;
  for (const auto& value : values) {
    if (!text.empty()) text += ',';
    text += text_of(value);
  }
  return text;
}

std::uint64_t size_of(const std::string& path) {
  struct stat about{};
  return !path.empty() && stat(path.c_str(), &about) == 0 ? static_cast<std::uint64_t>(about.st_size) : 0;
}

record::Time steady() {
  return std::chrono::microseconds(g_get_monotonic_time());
}

const FileFault kRemoved{"it was removed or moved while it was written", "", true};

// By the kernel; a hardened service (ProtectClock of systemd) may not ask it, and reads what systemd-timesyncd notes.
bool clock_is_synchronised() {
  timex clock{};  // no modes: it is read
  if (adjtimex(&clock) >= 0) return !(clock.status & STA_UNSYNC);
  return access("/run/systemd/timesync/synchronized", F_OK) == 0;
}

}  // namespace

void DiskWriter::open(const record::Archive::Settings& archive) {
  const int error = record::Folder(folder_).usable();
  std::string fault;
  if (error) fault = takes_none(error) + ". Make it, or set \"location\".";
  const bool late = [&] {
    const std::lock_guard guard(lock_);
    if (!fault.empty()) folder_fault_ = fault;
    return late_;
  }();
  if (late && !fault.empty()) warn(fault);
  if ((fault.empty() || late) && !is_given_up()) report_deleted(archive_.open(archive, surroundings()));
  const std::lock_guard guard(lock_);
  if (!folder_fault_) folder_fault_ = "";
  opened_.notify_all();
}

std::optional<std::string> DiskWriter::opened_within(std::chrono::nanoseconds longest) {
  std::unique_lock guard(lock_);
  opened_.wait_for(guard, longest, [this] { return folder_fault_.has_value(); });
  late_ = !folder_fault_;
  return folder_fault_;
}

void DiskWriter::enqueue(Command command, std::uint64_t bytes) {
  {
    const std::lock_guard guard(lock_);
    commands_.push_back({std::move(command), bytes});
    queued_ += bytes;
  }
  changed_.notify_all();
}

void DiskWriter::stop() {
  {
    const std::lock_guard guard(lock_);
    stopping_ = true;
  }
  changed_.notify_all();
}

bool DiskWriter::ended_within(std::chrono::nanoseconds longest) {
  std::unique_lock guard(lock_);
  return over_.wait_for(guard, longest, [this] { return ended_; });
}

std::vector<FileReport> DiskWriter::give_up() {
  std::vector<FileReport> lost;
  const std::lock_guard guard(lock_);
  given_up_ = true;
  for (const Queued& queued : commands_)
    if (const auto* open = std::get_if<Open>(&queued.command))
      unfinished_[open->spec->start.file] = {open->spec, ""};
  for (const auto& [number, file] : unfinished_)
    lost.push_back({FileReport::State::failed,
                    file.spec,
                    file.path,
                    {},
                    {},
                    {},
                    0,
                    {"the disk had not taken it when the recorder stopped; what it took stays",
                     std::to_string(queued_ + level_) + " bytes of all files waited"}});
  unfinished_.clear();
  commands_.clear();
  queued_ = 0;
  changed_.notify_all();
  return lost;
}

bool DiskWriter::is_given_up() const {
  const std::lock_guard guard(lock_);
  return given_up_;
}

void DiskWriter::report(const FileReport& what) {
  if (!is_given_up()) report_(what);
}

void DiskWriter::warn(const std::string& text) {
  if (!is_given_up()) warn_(text);
}

std::uint64_t DiskWriter::pending() const {
  const std::lock_guard guard(lock_);
  return queued_ + level_;
}

void DiskWriter::wait_below(std::uint64_t bytes, const std::function<bool()>& go_on) {
  std::unique_lock guard(lock_);
  while (queued_ + level_ >= bytes && !stopping_ && go_on()) lower_.wait_for(guard, kLook);
}

void DiskWriter::run(const record::Archive::Settings& archive) {
  {
    const std::lock_guard guard(lock_);
    folder_ = archive.folder;
    busy_since_ = steady();
  }
  open(archive);
  bool finishing = false;
  auto next_retention = std::chrono::steady_clock::now() + kRetention;
  auto next_watch = std::chrono::steady_clock::now();
  while (true) {
    std::optional<Command> command;
    {
      std::unique_lock guard(lock_);
      busy_since_.reset();
      const auto ready = [this] { return !commands_.empty() || stopping_; };
      if (level_ > 0 || stopping_)
        changed_.wait_for(guard, kLook, [this] { return !commands_.empty() || given_up_; });
      else
        changed_.wait_until(guard, std::min(next_watch, next_retention), ready);
      if (given_up_) break;
      busy_since_ = steady();
      if (!commands_.empty()) {
        command = std::move(commands_.front().command);
        queued_ -= commands_.front().bytes;
        commands_.pop_front();
        if (const auto* open = std::get_if<Open>(&*command))
          unfinished_[open->spec->start.file] = {open->spec, ""};
      } else if (stopping_) {
        for (auto& [number, file] : files_)
          if (!finishing && !file.closing) file.pipeline->finish();
        finishing = true;
        if (files_.empty()) break;
      }
    }
    if (command) std::visit([this](auto& each) { execute(each); }, *command);
    if (std::chrono::steady_clock::now() >= next_watch) {
      watch();
      next_watch = std::chrono::steady_clock::now() + kWatch;
    }
    look_at_index();
    if (std::chrono::steady_clock::now() >= next_retention) {
      retain();
      next_retention = std::chrono::steady_clock::now() + kRetention;
    }
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
  archive_.close();
  const std::lock_guard guard(lock_);
  level_ = 0;  // what the disk did not take is given up
  ended_ = true;
  over_.notify_all();
}

void DiskWriter::execute(Open& command) {
  const FileSpec& spec = *command.spec;
  File file;
  file.spec = command.spec;
  const std::uint32_t number = spec.start.file;
  file.row.camera = spec.camera;
  file.row.event = spec.start.event;
  file.row.part = spec.start.part;
  file.row.begin = file.row.end = time_of(spec.when);
  file.row.reason = spec.start.reason;
  std::string fault = archive_.begin(file.row, spec.name, spec.mp4 ? ".mp4" : ".mkv", file.lock);
  if (fault.empty()) {
    file.path = folder_ + '/' + file.row.file;
    {
      const std::lock_guard guard(lock_);
      unfinished_[number].path = file.path;
    }
    try {
      file.pipeline = std::make_unique<FilePipeline>(spec, file.path,
                                                     [this, number](std::shared_ptr<const FileFault> error) {
                                                       enqueue(Ended{number, std::move(error)});
                                                     });
    } catch (const std::exception& error) {
      fault = error.what();
      archive_.discard(file.row);
    }
  }
  pass_complaints();
  if (!fault.empty()) return report_end(file, FileReport::State::failed, {fault, "", file.path.empty()});
  file.since = file.moved = steady();
  report({FileReport::State::started, file.spec, file.path, {}, {}, {}, 0, {}});
  files_.emplace(number, std::move(file));
}

void DiskWriter::execute(Write& command) {
  const auto found = files_.find(command.file);
  if (found == files_.end()) return;
  File& file = found->second;
  if (command.track == 0) file.last = std::max(file.last, GST_BUFFER_PTS(command.buffer.get()));
  file.pipeline->push(command.track, gst_buffer_ref(command.buffer.get()));
}

void DiskWriter::execute(Line& command) {
  const auto found = files_.find(command.file);
  if (found == files_.end() || found->second.without_lines) return;
  File& file = found->second;
  int error = file.lines ? 0 : archive_.add_lines(file.row, file.lines);
  if (!error) error = file.lines.write(command.text.data(), command.text.size());
  if (!error) return;
  file.without_lines = true;
  warn("the JSON lines beside " + record::in_quotes(file.path) + ": " + std::strerror(error));
}

void DiskWriter::save_picture(File& file, const record::Picture& picture) {
  std::string fault;
  record::OpenFile to;
  if (GstSample* jpeg = encode_jpeg(picture, fault)) {
    GstMapInfo map;
    if (gst_buffer_map(gst_sample_get_buffer(jpeg), &map, GST_MAP_READ)) {
      int error = archive_.add_picture(file.row, to);
      if (!error) error = to.write(map.data, map.size);
      if (!error) error = to.sync();
      if (error) fault = std::strerror(error);
      gst_buffer_unmap(gst_sample_get_buffer(jpeg), &map);
    }
    gst_sample_unref(jpeg);
  }
  if (!fault.empty()) warn("the picture beside " + record::in_quotes(file.path) + ": " + fault);
}

void DiskWriter::execute(Close& command) {
  const auto found = files_.find(command.end.file);
  if (found == files_.end()) return;
  File& file = found->second;
  file.end = command.end;
  file.closing = true;
  file.pipeline->finish();
  const record::Findings& findings = command.findings;
  file.row.tracks =
      comma_separated(findings.tracks, [](std::uint32_t track) { return std::to_string(track); });
  file.row.kinds = comma_separated(findings.kinds, [](std::string_view kind) { return std::string(kind); });
  file.row.rule = findings.rule;
  file.row.people = findings.people;
  if (findings.picture) save_picture(file, findings.picture);
}

void DiskWriter::execute(Limit& command) {
  archive_.set_limits(command.limits);
}

void DiskWriter::execute(Keep& command) {
  if (const std::string fault = archive_.keep(command.path, command.keep); !fault.empty()) warn(fault);
  pass_complaints();
}

record::Surroundings DiskWriter::surroundings() const {
  return {std::chrono::microseconds(g_get_real_time()), steady(), record::Folder(folder_).free_bytes(),
          clock_is_synchronised()};
}

void DiskWriter::retain() {
  if (is_given_up()) return;  // deletions could not be reported
  report_deleted(archive_.retain(surroundings()));
}

void DiskWriter::report_deleted(const std::vector<std::string>& names) {
  for (const std::string& name : names)
    report({FileReport::State::deleted, nullptr, folder_ + '/' + name, {}, {}, {}, 0, {}});
  pass_complaints();
}

// Complaints come after the fault that they explain: the log's first line says that recording fails.
void DiskWriter::pass_complaints() {
  look_at_index();
  for (const std::string& text : archive_.take_complaints()) warn(text);
}

std::string DiskWriter::no_answer() const {
  return "The disk of the folder " + record::in_quotes(folder_) + " does not answer";
}

std::string DiskWriter::takes_none(int error) const {
  return "The folder " + record::in_quotes(folder_) + " takes no recordings: " + std::strerror(error);
}

// What is wrong with the disk is noticed before a recording needs it, and that it is right again without one.
void DiskWriter::watch() {
  std::vector<std::uint32_t> removed;
  bool writes = false;
  for (const auto& [number, file] : files_) {
    if (!archive_.is_there(file.row, file.lock)) {
      removed.push_back(number);
    } else if (size_of(file.path) > 0) {
      writes = true;
      const std::lock_guard guard(lock_);
      faults_.file_written_for(steady() - file.since);
    }
  }
  for (const std::uint32_t number : removed) fail(number, kRemoved);
  const record::Folder folder(folder_);
  const bool usable = folder.usable() == 0;
  const auto free = folder.free_bytes();
  const bool must_try = [&] {
    const std::lock_guard guard(lock_);
    return faults_.must_try(usable, free, writes, steady());
  }();
  if (must_try) {
    const int error = folder.try_out(record::RecordingFaults::Parameters{}.least_free);
    const bool was_sound = [&] {
      const std::lock_guard guard(lock_);
      const bool sound = faults_.text().empty();
      faults_.tried(error ? takes_none(error) : "");
      return sound;
    }();
    if (error && was_sound) {
      report_fault();
      warn(takes_none(error));
    }
  }
  archive_.watch(steady());
  // What was waited for has come.
  const bool silent = !all_move();
  {
    const std::lock_guard guard(lock_);
    faults_.set_silent(silent ? no_answer() : "");
  }
  pass_complaints();
}

void DiskWriter::look_at_index() {
  {
    const std::lock_guard guard(lock_);
    faults_.set_index(archive_.index_fault());
  }
  report_fault();
}

// Whether every file is written as far as there is something to write. Writing has a thread of its own for each file.
bool DiskWriter::all_move() {
  const record::Time now = steady();
  bool all = true;
  for (auto& [number, file] : files_) {
    const std::uint64_t taken = file.pipeline->video_taken();
    const bool waits = file.closing || file.pipeline->video_level() > 0;
    if (std::exchange(file.taken, taken) != taken || !waits) file.moved = now;
    all = all && !faults_.waits_too_long(file.moved, now);
  }
  return all;
}

void DiskWriter::look_for_answer() {
  {
    const std::lock_guard guard(lock_);
    if (!busy_since_ || !faults_.waits_too_long(*busy_since_, steady())) return;
    faults_.set_silent(no_answer());
  }
  report_fault();
}

// In any thread; what changes last is reported last.
void DiskWriter::report_fault() {
  {
    const std::lock_guard guard(lock_);
    const auto text = faults_.take_change();
    if (!text) return;
    const auto state = text->empty() ? FileReport::State::sound : FileReport::State::fault;
    faults_to_report_.put({state, nullptr, {}, {}, {}, {}, 0, {*text, ""}});
  }
  faults_to_report_.deliver([this](const FileReport& fault) { report(fault); });
}

void DiskWriter::execute(Abandon& command) {
  fail(command.file, {command.reason, "", true});
}

void DiskWriter::execute(Ended& command) {
  if (command.fault) return fail(command.file, *command.fault);
  const auto found = files_.find(command.file);
  if (found == files_.end()) return;
  if (!archive_.is_there(found->second.row, found->second.lock)) return fail(command.file, kRemoved);
  File file = std::move(found->second);
  files_.erase(found);
  file.pipeline.reset();
  {
    const std::lock_guard guard(lock_);
    faults_.file_complete();
  }
  report_end(file, FileReport::State::ended, {});
  check_done();
}

void DiskWriter::execute(Done& command) {
  waiting_.push_back(std::move(command.done));
  check_done();
}

void DiskWriter::fail(std::uint32_t number, const FileFault& fault) {
  const auto found = files_.find(number);
  if (found == files_.end()) return;
  File file = std::move(found->second);
  files_.erase(found);
  file.pipeline.reset();
  report_end(file, FileReport::State::failed, fault);
  check_done();
}

// What is acknowledged is on the disk, and in the index.
void DiskWriter::report_end(File& file, FileReport::State state, const FileFault& fault) {
  {
    const std::lock_guard guard(lock_);
    unfinished_.erase(file.spec->start.file);
  }
  if (state == FileReport::State::failed) {
    const int error = record::Folder(folder_).try_out(record::RecordingFaults::Parameters{}.least_free);
    const std::string which = file.path.empty() ? "" : record::in_quotes(file.path) + ": ";
    {
      const std::lock_guard guard(lock_);
      if (error || fault.of_disk)
        faults_.disk_failed(error ? takes_none(error) : which + fault.text, steady());
      else
        faults_.stream_failed(which + fault.text);
    }
    report_fault();
  }
  const std::uint64_t bytes = size_of(file.path);
  if (!file.path.empty()) {
    file.row.end = file.row.begin + time_of(file.last);
    if (const int error = file.lines.sync(); error)
      warn("the JSON lines beside " + record::in_quotes(file.path) + ": " + std::strerror(error));
    if (state == FileReport::State::failed && bytes > 0) archive_.examine(file.row, file.lock);
    if (bytes == 0)
      archive_.discard(file.row);
    else
      archive_.finish(file.row, file.lock);
  }
  const auto path_of = [&](const std::string& name) { return name.empty() ? name : folder_ + '/' + name; };
  report({state, file.spec, file.path, path_of(file.row.lines), path_of(file.row.picture), file.end,
          file.row.broken ? 0 : bytes, fault});
  retain();
}

void DiskWriter::check_done() {
  if (is_given_up()) return;  // the element may have begun anew: run() drops what waits
  for (const auto& [number, file] : files_)
    if (file.closing) return;
  for (const auto& done : std::exchange(waiting_, {})) done();
}

}  // namespace cerberus::plugin
