// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/archive/archive.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "record/archive/matroska.h"
#include "record/archive/mp4_repair.h"

namespace cerberus::record {

namespace {

constexpr int kMostNamesakes = 1000;
constexpr std::string_view kLines = ".jsonl", kPicture = ".jpg";
constexpr const char* kVideos[] = {".mp4", ".mkv"};

std::string without_ending(const std::string& file) {
  return file.substr(0, file.rfind('.'));
}

bool ends_with_any(const std::string& name, std::initializer_list<std::string_view> endings) {
  return std::ranges::any_of(endings, [&](std::string_view ending) { return name.ends_with(ending); });
}

// Whether all names of a row are those of a recording: other programs may write rows, and rows are deleted with files.
bool is_recording(const Recording& row) {
  return Folder::is_name(row.file) && ends_with_any(row.file, {kVideos[0], kVideos[1]}) &&
         (row.lines.empty() || row.lines == without_ending(row.file) + std::string(kLines)) &&
         (row.picture.empty() || row.picture == without_ending(row.file) + std::string(kPicture));
}

}  // namespace

void Archive::complain(std::string text) {
  if (text.empty() || text == last_complaint_) return;
  last_complaint_ = text;
  complaints_.push_back(std::move(text));
}

std::vector<std::string> Archive::take_complaints() {
  return std::exchange(complaints_, {});
}

// Notes what came of writing to the index. Returns whether that is no fault.
bool Archive::note(const std::string& fault) {
  index_fault_ = fault;
  complain(fault);
  return fault.empty();
}

std::string Archive::index_path() const {
  return (std::filesystem::path(settings_.folder) / settings_.index).string();
}

std::vector<std::string> Archive::open(const Settings& settings, const Surroundings& now) {
  settings_ = settings;
  folder_ = Folder(settings.folder);
  last_complaint_.clear();
  index_fault_.clear();
  retention_ = Retention();
  overflow_reported_ = false;
  close();
  if (settings.index.empty()) return {};
  open_index(now.steady);
  return apply_retention(now);
}

void Archive::open_index(Time steady) {
  bool damaged = false;
  std::string fault = index_.open(index_path(), damaged);
  if (damaged) {
    std::error_code unknown;
    std::string aside = index_path() + ".damaged";
    for (int k = 1; k < kMostNamesakes && std::filesystem::exists(aside, unknown); ++k)
      aside = index_path() + ".damaged~" + std::to_string(k);
    if (std::rename(index_path().c_str(), aside.c_str()) == 0) {
      complain(fault + "; it is now " + in_quotes(aside) + ", and another one is begun");
      std::rename((index_path() + "-wal").c_str(), (aside + "-wal").c_str());
      std::remove((index_path() + "-shm").c_str());
      fault = index_.open(index_path(), damaged);
    }
  }
  if (!fault.empty()) complain(fault + (Index::available() ? "; it is tried again, recordings go on" : ""));
  if (Index::available()) index_fault_ = fault;
  if (index_.is_open()) {
    list();
    return reconcile();
  }
  open_again_ = steady + kPause;
}

// A folder that was removed and made anew has another index, or none: what is written to the one of before is lost.
void Archive::check_place(Time steady) {
  if (!index_.is_open() || !folder_.free_bytes() || index_.is_at(index_path())) return;
  index_.close();
  complain("the index of recordings " + in_quotes(index_path()) + " is gone, and another one is begun");
  open_index(steady);
}

void Archive::watch(Time steady) {
  if (settings_.index.empty() || !Index::available()) return;
  check_place(steady);
  if (!index_.is_open() && steady >= open_again_) open_index(steady);
  if (!index_.is_open() || index_fault_.empty()) return;
  if (note(index_.try_to_write())) list();
}

// Adds the rows of recordings that were completed without one.
void Archive::list() {
  if (!folder_.free_bytes()) return;
  std::erase_if(unlisted_, [this](Recording& row) {
    if (!folder_.size(row.file)) return false;  // its disk may be mounted again
    bool taken = false;
    if (!index_fault_.empty()) return false;  // of the one before: a lock is waited for once
    index_fault_ = row.id ? index_.update(row) : index_.add(row, taken);
    if (taken) index_fault_.clear();
    return index_fault_.empty();
  });
}

void Archive::close() {
  // What could be listed since the last look.
  if (index_.is_open() && !unlisted_.empty() && (index_fault_.empty() || note(index_.try_to_write()))) list();
  index_.close();
  unlisted_.clear();
}

void Archive::measure(Recording& recording) const {
  recording.bytes = 0;
  for (const std::string* name : {&recording.file, &recording.lines, &recording.picture})
    if (!name->empty()) recording.bytes += folder_.size(*name).value_or(0);
}

// Returns false where the row is not to be: its files are deleted then. `file`: of an open row, locked.
bool Archive::restore(Recording& row, const OpenFile& file) {
  const auto size = folder_.size(row.file);
  if (!size || (row.open && *size == 0)) return false;
  if (!row.open) return true;
  // Of a process that ended: what it had written.
  for (auto [name, ending] : {std::pair(&row.lines, kLines), std::pair(&row.picture, kPicture)})
    if (const std::string there = without_ending(row.file) + std::string(ending); folder_.size(there))
      *name = there;
  row.end = std::max(row.begin, Time(folder_.changed(row.file)));
  row.open = false;
  if (file) examine(row, file);
  return true;
}

void Archive::examine(Recording& recording, const OpenFile& file) {
  recording.broken = recording.file.ends_with(kVideos[0]) ? repair_mp4(file.descriptor()) == Mp4State::broken
                                                          : !has_block(file.descriptor());
  if (recording.broken)
    complain(in_quotes(folder_.path_of(recording.file)) +
             " was cut off before there was anything in it to play: it is marked as broken and not offered");
}

void Archive::reconcile() {
  std::vector<Recording> rows;
  complain(index_.read(rows));
  // Open rows alone are those of a process that was killed before it made the file.
  const auto closed = [](const Recording& row) { return !row.open; };
  const auto missing = [this](const Recording& row) { return !folder_.size(row.file); };
  if (std::ranges::any_of(rows, closed) && std::ranges::all_of(rows, missing)) {
    complain("none of the files of the index is in " + in_quotes(settings_.folder) +
             ": is its disk mounted? The rows stay until one of them is");
    return;
  }
  for (Recording& row : rows) reconcile(row);
}

void Archive::reconcile(Recording& row) {
  if (!is_recording(row)) {
    complain("the index names " + in_quotes(row.file) +
             ", which is no recording of this folder: the row is removed");
    return complain(index_.remove(row));
  }
  OpenFile file;
  if (row.open) {
    const int error = folder_.lock(row.file, file);
    if (error == EWOULDBLOCK) return;  // of another recorder
    // Another recorder may have completed it since the rows were read.
    std::vector<Recording> again;
    complain(index_.read_one(row.id, again));
    if (again.empty()) return;
    row = again.front();
    // Another recorder may be about to make the file: it is left alone, and finish() adds the row again.
    if (row.open && error == ENOENT) return complain(index_.remove(row));
  }
  const Recording before = row;
  if (!restore(row, file)) return row.open && !file ? complain(index_.remove(row)) : discard(row);
  measure(row);
  if (row.open != before.open || row.bytes != before.bytes) complain(index_.update(row));
}

std::string Archive::begin(Recording& recording, const std::string& name, std::string_view ending,
                           OpenFile& file) {
  const auto failed = [&](int error) {
    return in_quotes(folder_.path_of(recording.file)) + ": " + std::strerror(error);
  };
  recording.file = name + std::string(ending);
  if (!folder_.free_bytes()) return failed(errno);  // the folder is gone: the file's fault, not the index's
  for (int k = 0; k < kMostNamesakes; ++k) {
    const std::string base = name + (k ? '~' + std::to_string(k) : std::string());
    recording.file = base + std::string(ending);
    recording.id = 0;
    const auto taken_by = [&](std::string_view other) { return folder_.exists(base + std::string(other)); };
    if (std::ranges::any_of(kVideos, taken_by) || taken_by(kLines) || taken_by(kPicture)) continue;
    bool taken = false;
    if (index_.is_open()) {
      const std::string fault = index_.add(recording, taken);
      if (taken) continue;
      note(fault);
    }
    const int error = folder_.create(recording.file, file);
    if (!error) return {};
    if (recording.id) complain(index_.remove(recording));
    recording.id = 0;
    if (error != EEXIST) return failed(error);
  }
  return failed(EEXIST);
}

int Archive::add_lines(Recording& recording, OpenFile& file) const {
  const std::string name = without_ending(recording.file) + std::string(kLines);
  const int error = folder_.create(name, file);
  if (!error) recording.lines = name;
  return error;
}

int Archive::add_picture(Recording& recording, OpenFile& file) const {
  const std::string name = without_ending(recording.file) + std::string(kPicture);
  const int error = folder_.create(name, file);
  if (!error) recording.picture = name;
  return error;
}

void Archive::finish(Recording& recording, const OpenFile& file) {
  if (const int error = file.sync(); error)
    complain(in_quotes(folder_.path_of(recording.file)) + ": " + std::strerror(error));
  measure(recording);
  recording.open = false;
  if (settings_.index.empty()) return;
  if (index_.is_open() && note(index_.update(recording))) return;
  if (unlisted_.size() < kMostUnlisted) return unlisted_.push_back(recording);
  if (!std::exchange(overflow_reported_, true))
    complain(std::to_string(kMostUnlisted) + " recordings wait for their rows: " + in_quotes(recording.file) +
             " and those after it stay without one until the index can be written");
}

// The video last: as long as it is there, the row is, too.
bool Archive::remove_files(const Recording& recording) {
  const std::string base = without_ending(recording.file);
  for (const std::string& name : {base + std::string(kLines), base + std::string(kPicture), recording.file}) {
    const int error = folder_.remove(name);
    if (!error) continue;
    complain(in_quotes(folder_.path_of(name)) + " cannot be deleted: " + std::strerror(error));
    return false;
  }
  return true;
}

void Archive::discard(const Recording& recording) {
  if (remove_files(recording) && index_.is_open() && recording.id) complain(index_.remove(recording));
}

std::vector<std::string> Archive::retain(const Surroundings& now) {
  watch(now.steady);
  return apply_retention(now);
}

std::vector<std::string> Archive::apply_retention(Surroundings now) {
  std::vector<std::string> deleted;
  std::vector<Recording> rows;
  if (!index_.is_open() || !now.free_bytes) return deleted;
  if (!unlisted_.empty() && index_fault_.empty()) list();
  complain(index_.read(rows));
  // Another recorder may have deleted what is not among the rows since the room was measured.
  now.free_bytes = std::max(*now.free_bytes, folder_.free_bytes().value_or(0));
  // A file that is not there may be on a disk that is not mounted: its row waits for the next reconciliation.
  std::erase_if(rows, [this](const Recording& row) { return !is_recording(row) || !folder_.size(row.file); });
  std::vector<Candidate> candidates;
  for (Recording& row : rows) {
    if (row.open) measure(row);
    // The camera's clock may be wrong: the system's was there when the file was written.
    const Time end = std::max(row.end, Time(folder_.changed(row.file)));
    candidates.push_back({row.id, end, row.bytes, row.keep, row.open});
  }
  for (const std::int64_t id : retention_.expired(candidates, settings_.limits, now)) {
    const auto row = std::ranges::find(rows, id, &Recording::id);
    bool removed = false;
    complain(index_.remove_with(id, [&] { return remove_files(*row); }, removed));
    if (removed) deleted.push_back(row->file);
  }
  complain(retention_.take_fault());
  return deleted;
}

std::string Archive::keep(const std::string& file, bool keep) {
  if (!index_.is_open()) return "there is no index of recordings";
  std::string name = file;
  if (name.starts_with(settings_.folder + '/')) name.erase(0, settings_.folder.size() + 1);
  return index_.set_keep(name, keep);
}

}  // namespace cerberus::record
