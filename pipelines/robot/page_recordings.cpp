// SPDX-License-Identifier: LGPL-2.1-or-later
// What the page's server answers about recordings.
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <optional>

#include "page_request.h"
#include "record/archive/folder.h"
#include "robot/page/byte_range.h"

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

// Bytes that one answer to a range holds at most (players ask on), and that are read at once for a whole file: the main
// loop waits for the disk meanwhile.
constexpr std::uint64_t kMostOfAnswer = 1 << 20;
constexpr goffset kChunk = 256 << 10;

// nullptr: the file is shorter, or cannot be read. Nothing is mapped into memory: a file that shrinks would end the
// process.
GBytes* read_part(int descriptor, off_t from, gsize size) {
  auto* bytes = static_cast<char*>(g_malloc(size));
  for (gsize done = 0; done < size;) {
    const ssize_t got = pread(descriptor, bytes + done, size - done, from + static_cast<off_t>(done));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) {
      g_free(bytes);
      return nullptr;
    }
    done += static_cast<gsize>(got);
  }
  return g_bytes_new_take(bytes, size);
}

// A whole file on its way, a chunk at a time: the next one is read when the one before it was written.
struct Download {
  PageListener* listener;
  record::OpenFile file;
  goffset at = 0, end = 0;

  void send_next(SoupServerMessage* message) {
    if (at >= end) return;
    const goffset size = std::min(kChunk, end - at);
    g_autoptr(GBytes) bytes = read_part(file.descriptor(), at, static_cast<gsize>(size));
    if (bytes == nullptr) {  // what was promised cannot be sent: the connection ends
      at = end;
      if (GSocketAddress* remote = soup_server_message_get_remote_address(message)) listener->abort(remote);
      bytes = g_bytes_new_static("", 1);
    }
    at += size;
    soup_message_body_append_bytes(soup_server_message_get_response_body(message), bytes);
  }
};

void send_whole(PageListener& listener, SoupServerMessage* message, record::OpenFile file, goffset size) {
  auto* download = new Download{&listener, std::move(file), 0, size};
  soup_message_body_set_accumulate(soup_server_message_get_response_body(message), FALSE);
  soup_message_headers_set_content_length(soup_server_message_get_response_headers(message), size);
  g_signal_connect_data(
      message, "wrote-chunk", G_CALLBACK(+[](SoupServerMessage* from, gpointer data) {
        static_cast<Download*>(data)->send_next(from);
      }),
      download, [](gpointer data, GClosure*) { delete static_cast<Download*>(data); },
      static_cast<GConnectFlags>(0));
  download->send_next(message);
  soup_server_message_set_status(message, SOUP_STATUS_OK, nullptr);
}

}  // namespace

Camera* PageServer::camera(std::string_view name) const {
  for (const auto& camera : house_.cameras)
    if (camera->settings().name == name) return camera.get();
  return nullptr;
}

// What is not a number counts as not given.
record::Wanted PageServer::wanted_of(const Request& request, const std::string& camera) {
  record::Wanted wanted;
  wanted.camera = camera;
  const auto time = [&](const char* key) {
    const std::optional<std::int64_t> given = read_id(request.value(key));
    constexpr std::int64_t kLatest = std::int64_t{1} << 43;  // ms, in the year 2248; ns of it fit
    return given
               ? std::optional<record::Time>(std::chrono::milliseconds(std::clamp(*given, -kLatest, kLatest)))
               : std::nullopt;
  };
  wanted.from = time("from");
  wanted.until = time("until");
  wanted.reason = request.value("reason");
  wanted.kept = request.value("kept") == "1";
  wanted.below = read_id(request.value("below"));
  if (const auto most = read_id(request.value("most")); most && *most > 0)
    wanted.most = static_cast<std::size_t>(*most);
  return wanted;
}

// Of a camera with a recorder. Cameras that share a folder share its index.
Events& PageServer::events_of(const Camera& camera) {
  const std::string& folder = camera.settings().recorder->folder;
  return events_.try_emplace(folder, folder).first->second;
}

// GET /events (camera; from and until in ms since 1970, reason, kept=1, below=ID, most) and /reasons (camera).
void PageServer::answer_events(Request& request) {
  if (house_.mode() == Mode::privacy)
    return request.refuse(SOUP_STATUS_FORBIDDEN, "privacy: nothing is shown");
  const Camera* from = camera(request.value("camera"));
  if (from == nullptr || !from->settings().recorder)
    return request.respond(SOUP_STATUS_OK, "application/json", "[]\n");
  const std::string& name = from->settings().name;
  Events& events = events_of(*from);
  std::string fault;
  const std::string list =
      request.path == "/reasons" ? events.reasons(name, fault) : events.list(wanted_of(request, name), fault);
  if (!fault.empty()) return request.refuse(SOUP_STATUS_SERVICE_UNAVAILABLE, fault);
  request.respond(SOUP_STATUS_OK, "application/json", list);
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
  std::string fault;
  const std::optional<record::Recording> row = events_of(*from).find(from->settings().name, *id, fault);
  if (!fault.empty()) return request.refuse(SOUP_STATUS_SERVICE_UNAVAILABLE, fault);
  if (!row) return missing();
  if (row->open) return request.refuse(SOUP_STATUS_CONFLICT, "this recording is still being written");
  const std::string file = what == "video"     ? row->file
                           : what == "picture" ? row->picture
                           : what == "lines"   ? row->lines
                                               : std::string();
  record::OpenFile open;
  if (file.empty() || record::Folder(from->settings().recorder->folder).open_to_read(file, open) != 0)
    return missing();
  struct stat about{};
  if (fstat(open.descriptor(), &about) != 0) return missing();
  SoupMessageHeaders* asked = soup_server_message_get_request_headers(request.message);
  const char* header = soup_message_headers_get_one(asked, "Range");
  const ByteRange range =
      parse_range(header ? header : "", static_cast<std::uint64_t>(about.st_size), kMostOfAnswer);
  // The library would cut the first chunk by it.
  soup_message_headers_remove(asked, "Range");
  // Once, whatever parts a player asks for.
  if (what == "video" && request.session->played.insert(from->settings().name + '/' + file).second)
    log_access(request.who(), "plays " + file);
  SoupMessageHeaders* headers = soup_server_message_get_response_headers(request.message);
  soup_message_headers_replace(headers, "Accept-Ranges", "bytes");
  if (range.kind == ByteRange::Kind::none) {
    soup_message_headers_replace(headers, "Content-Range",
                                 ("bytes */" + std::to_string(about.st_size)).c_str());
    return request.refuse(SOUP_STATUS_REQUESTED_RANGE_NOT_SATISFIABLE, "the recording is shorter");
  }
  soup_message_headers_set_content_type(headers, type_of(file), nullptr);
  g_autoptr(GHashTable) name = g_hash_table_new(g_str_hash, g_str_equal);
  const std::string saved = download_name(*row, file);
  g_hash_table_insert(name, const_cast<char*>("filename"), const_cast<char*>(saved.c_str()));
  soup_message_headers_set_content_disposition(headers, "inline", name);
  if (range.kind == ByteRange::Kind::whole)
    return send_whole(listener_, request.message, std::move(open), about.st_size);
  g_autoptr(GBytes) bytes =
      read_part(open.descriptor(), static_cast<off_t>(range.first), range.last - range.first + 1);
  if (bytes == nullptr)
    return request.refuse(SOUP_STATUS_INTERNAL_SERVER_ERROR, "the recording cannot be read");
  soup_message_headers_set_content_range(headers, static_cast<goffset>(range.first),
                                         static_cast<goffset>(range.last), about.st_size);
  soup_message_body_append_bytes(soup_server_message_get_response_body(request.message), bytes);
  soup_server_message_set_status(request.message, SOUP_STATUS_PARTIAL_CONTENT, nullptr);
}

// POST /keep (camera, id, keep=1 or 0) and /delete (camera, id).
void PageServer::change_recording(Request& request) {
  const Camera* from = camera(request.value("camera"));
  const std::optional<std::int64_t> id = read_id(request.value("id"));
  if (from == nullptr || !from->settings().recorder || !id)
    return request.refuse(SOUP_STATUS_NOT_FOUND, "there is no such recording");
  Events& events = events_of(*from);
  const std::string& name = from->settings().name;
  const bool deletes = request.path == "/delete";
  const std::string fault =
      deletes ? events.remove(name, *id) : events.keep(name, *id, request.value("keep") == "1");
  if (!fault.empty()) return request.refuse(SOUP_STATUS_CONFLICT, fault);
  ++changes_;
  log_access(request.who(), (deletes ? "deleted " : "marked ") + name + " recording " + std::to_string(*id));
  if (deletes) camera(name)->publish_event();
  request.done();
}

}  // namespace cerberus::robot
