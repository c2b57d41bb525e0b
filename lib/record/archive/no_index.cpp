// SPDX-License-Identifier: LGPL-2.1-or-later
// The index of a build without SQLite (meson option `sqlite`): there is none.
#include "record/archive/index.h"

namespace cerberus::record {

namespace {
constexpr char kNone[] = "this build has no index of recordings: it was made without SQLite";
}

void Index::Closer::operator()(sqlite3*) const {}
Index::Index() = default;
Index::~Index() = default;
bool Index::available() {
  return false;
}
std::string Index::open(const std::string&, bool& damaged) {
  damaged = false;
  return kNone;
}
std::string Index::open_to_read(const std::string&) {
  return kNone;
}
void Index::close() {}
bool Index::is_at(const std::string&) const {
  return false;
}
std::string Index::try_to_write() {
  return kNone;
}
std::string Index::add(Recording&, bool& taken) {
  taken = false;
  return kNone;
}
std::string Index::update(Recording&) {
  return kNone;
}
std::string Index::remove(const Recording&) {
  return kNone;
}
std::string Index::remove_with(std::int64_t, const std::function<bool()>&, bool& removed) {
  removed = false;
  return kNone;
}
std::string Index::set_keep(std::string_view, bool) {
  return kNone;
}
std::string Index::read(std::vector<Recording>&) {
  return kNone;
}
std::string Index::read_newest(const Wanted&, std::vector<Recording>&) {
  return kNone;
}
std::string Index::read_reasons(std::string_view, std::vector<std::string>&) {
  return kNone;
}
std::string Index::read_one(std::int64_t, std::vector<Recording>&) {
  return kNone;
}

}  // namespace cerberus::record
