// SPDX-License-Identifier: LGPL-2.1-or-later
#include "robot/events.h"

#include <cerrno>
#include <cstring>
#include <vector>

#include "record/archive/folder.h"
#include "text/json_line.h"

namespace cerberus::robot {

using record::Recording;

std::string Events::read(std::vector<Recording>& rows, record::Index& index) const {
  const record::Folder folder(folder_);
  if (!folder.exists(index_)) return {};  // nothing was recorded yet
  bool damaged = false;
  std::string fault = index.open(folder.path_of(index_), damaged);
  return fault.empty() ? index.read(rows) : fault;
}

bool Events::open_to_read(record::Index& index, std::string& fault) const {
  const record::Folder folder(folder_);
  if (!folder.exists(index_)) return false;  // nothing was recorded yet
  fault = index.open_to_read(folder.path_of(index_));
  return fault.empty();
}

std::string Events::list(const std::string& camera, std::string& fault) const {
  std::vector<Recording> rows;
  record::Index index;
  if (open_to_read(index, fault)) fault = index.read_newest(camera, kMost, rows);
  text::JsonLine line;
  line.open('[');
  for (const Recording& row : rows) {
    line.open('{').key("camera").text(row.camera).key("id").integer(row.id);
    line.key("begin").integer(row.begin.count() / 1000000).key("end").integer(row.end.count() / 1000000);
    line.key("reason").text(row.reason).key("tracks").text(row.tracks).key("kinds").text(row.kinds);
    line.key("bytes").integer(row.bytes).key("open").boolean(row.open).key("keep").boolean(row.keep);
    line.key("picture").boolean(!row.picture.empty()).close('}');
  }
  std::string text(line.close(']').finish());
  return text;
}

std::optional<Recording> Events::find(const std::string& camera, std::int64_t id, std::string& fault) const {
  std::vector<Recording> rows;
  record::Index index;
  if (open_to_read(index, fault)) fault = index.read_one(id, rows);
  if (rows.empty() || rows.front().camera != camera) return std::nullopt;
  return std::move(rows.front());
}

std::string Events::remove(const std::string& camera, std::int64_t id) const {
  std::vector<Recording> rows;
  record::Index index;
  if (std::string fault = read(rows, index); !fault.empty()) return fault;
  const record::Folder folder(folder_);
  for (const Recording& row : rows) {
    if (row.id != id || row.camera != camera) continue;
    if (row.open || folder.in_use(row.file)) return "this recording is still being written";
    for (const std::string& name : {row.file, row.lines, row.picture}) {
      const int error = name.empty() ? 0 : folder.remove(name);
      if (error != 0) return name + " cannot be deleted: " + std::strerror(error);
    }
    return index.remove(id);
  }
  return "there is no such recording";
}

std::string Events::keep(const std::string& camera, std::int64_t id, bool keep) const {
  std::vector<Recording> rows;
  record::Index index;
  if (std::string fault = read(rows, index); !fault.empty()) return fault;
  for (const Recording& row : rows)
    if (row.id == id && row.camera == camera) return index.set_keep(row.file, keep);
  return "there is no such recording";
}

}  // namespace cerberus::robot
