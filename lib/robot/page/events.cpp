// SPDX-License-Identifier: LGPL-2.1-or-later
#include "robot/page/events.h"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <vector>

#include "record/archive/folder.h"
#include "record/file_names.h"
#include "text/json_line.h"

namespace cerberus::robot {

using record::Recording;

namespace {

void write(text::JsonLine& line, const Recording& row) {
  line.open('{').key("camera").text(row.camera).key("id").integer(row.id);
  line.key("begin").integer(row.begin.count() / 1000000).key("end").integer(row.end.count() / 1000000);
  line.key("event").integer(row.event).key("part").integer(row.part);
  line.key("reason").text(row.reason).key("tracks").text(row.tracks).key("kinds").text(row.kinds);
  line.key("people").integer(row.people).key("name").text(download_name(row, row.file));
  line.key("bytes").integer(row.bytes).key("open").boolean(row.open).key("keep").boolean(row.keep);
  line.key("picture").boolean(!row.picture.empty()).close('}');
}

}  // namespace

std::string download_name(const Recording& row, std::string_view file) {
  const std::size_t dot = file.rfind('.');
  return record::expand_name("{camera}_%Y-%m-%d_%H-%M-%S", {row.begin, row.camera, row.event, row.part}) +
         std::string(file.substr(std::min(dot, file.size())));
}

// The index stays open between two changes: to open it checks the whole database. A recorder that finds it damaged puts
// another file in its place.
std::string Events::open_to_change() {
  struct stat about{};
  if (::stat(record::Folder(folder_).path_of(index_).c_str(), &about) != 0) {
    changes_.close();
    return "there is no such recording";
  }
  const std::pair<std::uint64_t, std::uint64_t> file{about.st_dev, about.st_ino};
  if (changes_.is_open() && file == file_) return {};
  changes_.close();
  bool damaged = false;
  std::string fault = changes_.open(record::Folder(folder_).path_of(index_), damaged);
  file_ = file;
  return fault;
}

// The row of a recording, by the index that is open for changes.
std::string Events::find_to_change(const std::string& camera, std::int64_t id, Recording& row) {
  if (std::string fault = open_to_change(); !fault.empty()) return fault;
  std::vector<Recording> rows;
  if (std::string fault = changes_.read_one(id, rows); !fault.empty()) {
    changes_.close();  // the next attempt opens it anew
    return fault;
  }
  if (rows.empty() || rows.front().camera != camera) return "there is no such recording";
  row = std::move(rows.front());
  return {};
}

bool Events::open_to_read(record::Index& index, std::string& fault) const {
  const record::Folder folder(folder_);
  if (!folder.exists(index_)) return false;  // nothing was recorded yet
  fault = index.open_to_read(folder.path_of(index_));
  return fault.empty();
}

std::string Events::list(record::Wanted wanted, std::string& fault) const {
  std::vector<Recording> rows;
  record::Index index;
  wanted.most = std::min(wanted.most, kMost);
  if (open_to_read(index, fault)) fault = index.read_newest(wanted, rows);
  text::JsonLine line;
  line.open('[');
  for (const Recording& row : rows) write(line, row);
  std::string text(line.close(']').finish());
  return text;
}

std::string Events::reasons(const std::string& camera, std::string& fault) const {
  std::vector<std::string> reasons;
  record::Index index;
  if (open_to_read(index, fault)) fault = index.read_reasons(camera, reasons);
  text::JsonLine line;
  line.open('[');
  for (const std::string& reason : reasons) line.text(reason);
  return std::string(line.close(']').finish());
}

std::string Events::newest(const std::string& camera, std::string& fault) const {
  std::vector<Recording> rows;
  record::Index index;
  if (open_to_read(index, fault)) {
    record::Wanted wanted;
    wanted.camera = camera;
    wanted.most = 1;
    fault = index.read_newest(wanted, rows);
  }
  if (rows.empty()) return {};
  text::JsonLine line;
  write(line, rows.front());
  std::string_view text = line.finish();
  text.remove_suffix(1);  // the newline
  return std::string(text);
}

std::optional<Recording> Events::find(const std::string& camera, std::int64_t id, std::string& fault) const {
  std::vector<Recording> rows;
  record::Index index;
  if (open_to_read(index, fault)) fault = index.read_one(id, rows);
  if (rows.empty() || rows.front().camera != camera || rows.front().broken) return std::nullopt;
  return std::move(rows.front());
}

std::string Events::remove(const std::string& camera, std::int64_t id) {
  Recording row;
  if (std::string fault = find_to_change(camera, id, row); !fault.empty()) return fault;
  const record::Folder folder(folder_);
  if (row.open || folder.in_use(row.file)) return "this recording is still being written";
  for (const std::string& name : {row.file, row.lines, row.picture}) {
    const int error = name.empty() ? 0 : folder.remove(name);
    if (error != 0) return name + " cannot be deleted: " + std::strerror(error);
  }
  return changes_.remove(row);
}

std::string Events::keep(const std::string& camera, std::int64_t id, bool keep) {
  Recording row;
  if (std::string fault = find_to_change(camera, id, row); !fault.empty()) return fault;
  return changes_.set_keep(row.file, keep);
}

}  // namespace cerberus::robot
