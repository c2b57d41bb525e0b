// SPDX-License-Identifier: LGPL-2.1-or-later
// What the page's server answers about recordings.
#include <charconv>
#include <optional>

#include "page_request.h"
#include "record/archive/folder.h"

namespace cerberus::robot {

namespace {

std::optional<std::int64_t> read_id(std::string_view text) {
  std::int64_t id = 0;
  const auto done = std::from_chars(text.data(), text.data() + text.size(), id);
  if (done.ec != std::errc() || done.ptr != text.data() + text.size()) return std::nullopt;
  return id;
}

const char* type_of(std::string_view file) {
  if (file.ends_with(".mp4")) return "video/mp4";
  if (file.ends_with(".mkv")) return "video/x-matroska";
  if (file.ends_with(".jpg")) return "image/jpeg";
  return "application/x-json-lines";
}

}  // namespace

Camera* PageServer::camera(std::string_view name) const {
  for (const auto& camera : house_.cameras)
    if (camera->settings().name == name) return camera.get();
  return nullptr;
}

// All cameras, or one.
void PageServer::answer_events(Request& request) {
  if (house_.mode() == Mode::privacy)
    return request.refuse(SOUP_STATUS_FORBIDDEN, "privacy: nothing is shown");
  const Camera* from = camera(request.value("camera"));
  if (from == nullptr || !from->settings().recorder)
    return request.respond(SOUP_STATUS_OK, "application/json", "[]\n");
  const Events events(from->settings().recorder->folder);
  request.respond(SOUP_STATUS_OK, "application/json", events.list(from->settings().name));
}

// /events/CAMERA/ID/video, picture or lines.
void PageServer::answer_recording(Request& request) {
  const auto missing = [&] { request.refuse(SOUP_STATUS_NOT_FOUND, "there is no such recording"); };
  if (house_.mode() == Mode::privacy)
    return request.refuse(SOUP_STATUS_FORBIDDEN, "privacy: nothing is shown");
  std::string_view rest = request.path.substr(8);
  const std::size_t first = rest.find('/'),
                    second = first == rest.npos ? rest.npos : rest.find('/', first + 1);
  if (second == rest.npos) return missing();
  const Camera* from = camera(rest.substr(0, first));
  const std::optional<std::int64_t> id = read_id(rest.substr(first + 1, second - first - 1));
  const std::string_view what = rest.substr(second + 1);
  if (from == nullptr || !from->settings().recorder || !id) return missing();
  const std::optional<record::Recording> row =
      Events(from->settings().recorder->folder).find(from->settings().name, *id);
  if (!row) return missing();
  if (row->open) return request.refuse(SOUP_STATUS_CONFLICT, "this recording is still being written");
  const std::string file = what == "video"     ? row->file
                           : what == "picture" ? row->picture
                           : what == "lines"   ? row->lines
                                               : std::string();
  record::OpenFile open;
  if (file.empty() || record::Folder(from->settings().recorder->folder).open(file, open) != 0)
    return missing();
  g_autoptr(GMappedFile) mapped = g_mapped_file_new_from_fd(open.descriptor(), FALSE, nullptr);
  if (mapped == nullptr) return missing();
  if (what == "video") log_access(request.who(), "plays " + file);
  g_autoptr(GBytes) bytes = g_mapped_file_get_bytes(mapped);
  SoupMessageHeaders* headers = soup_server_message_get_response_headers(request.message);
  soup_message_headers_set_content_type(headers, type_of(file), nullptr);
  soup_message_body_append_bytes(soup_server_message_get_response_body(request.message), bytes);
  soup_server_message_set_status(request.message, SOUP_STATUS_OK, nullptr);
}

// POST /keep (camera, id, keep=1 or 0) and /delete (camera, id).
void PageServer::change_recording(Request& request) {
  const Camera* from = camera(request.value("camera"));
  const std::optional<std::int64_t> id = read_id(request.value("id"));
  if (from == nullptr || !from->settings().recorder || !id)
    return request.refuse(SOUP_STATUS_NOT_FOUND, "there is no such recording");
  const Events events(from->settings().recorder->folder);
  const std::string& name = from->settings().name;
  const bool deletes = request.path == "/delete";
  const std::string fault =
      deletes ? events.remove(name, *id) : events.keep(name, *id, request.value("keep") == "1");
  if (!fault.empty()) return request.refuse(SOUP_STATUS_CONFLICT, fault);
  log_access(request.who(), (deletes ? "deleted " : "marked ") + name + " recording " + std::to_string(*id));
  request.done();
}

}  // namespace cerberus::robot
