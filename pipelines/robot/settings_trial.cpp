// SPDX-License-Identifier: LGPL-2.1-or-later
#include "settings_trial.h"

#include <gio/gio.h>
#include <gst/gst.h>
#include <unistd.h>
#include "shared/settings_query.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "element_properties.h"
#include "robot/pipeline_text.h"
#include "robot/settings_file.h"
#include "rtsp_output.h"
#include "tls_trial.h"
#if HAVE_PAGE
#include <libsoup/soup.h>

#include "page_listener.h"
#include "webhook.h"
#endif

namespace cerberus::robot {

namespace {

constexpr std::string_view kSerial = "serial:";

// The table of the file that sets the properties of an element.
struct Table {
  std::string_view element, key, name;
};
constexpr Table kTables[] = {
    {"detect", "detection", "[camera.detection]"}, {"persons", "persons", "[camera.persons]"},
    {"fusion", "fusion", "[camera.fusion]"},       {"sensors", "sensors", "[camera.sensors]"},
    {"patrol", "patrol", "[camera.patrol]"},       {"head", "head", "[camera.head]"},
    {"recorder", "recorder", "[camera.recorder]"}, {"mqtt", "mqtt", "[mqtt]"},
};

const Table* table_of(std::string_view element) {
  const auto found = std::ranges::find(kTables, element, &Table::element);
  return found == std::end(kTables) ? nullptr : found;
}

std::uint32_t line_of(const Lines& lines, std::string_view key, std::uint32_t otherwise) {
  const auto found = lines.find(key);
  return found == lines.end() ? otherwise : found->second;
}

std::string is(std::string_view key, std::string_view where, std::string_view value) {
  return "\"" + std::string(key) + "\" of " + std::string(where) + " is \"" + std::string(value) + "\"";
}

// As the file has it: the sensors of a simulated robot are properties of the robot.
std::string stated(const Assignment& one, std::string_view where) {
  constexpr std::string_view kSensor = "pir-";
  if (!one.property.starts_with(kSensor)) return is(one.property, where, one.value);
  return is(std::string_view(one.property).substr(kSensor.size()), "[camera.sensors]", one.value);
}

// Whether a text has a word, which ends where a letter, a digit or a hyphen does not go on.
bool has_word(std::string_view text, std::string_view word) {
  const auto goes_on = [&](std::size_t at) {
    return at < text.size() && (g_ascii_isalnum(text[at]) || text[at] == '-');
  };
  for (std::size_t at = text.find(word); at != text.npos; at = text.find(word, at + 1))
    if (!(at > 0 && goes_on(at - 1)) && !goes_on(at + word.size())) return true;
  return false;
}

class Trying {
 public:
  explicit Trying(const Settings& settings) : settings_(settings) {}

  Trial run() {
    for (const CameraSettings& camera : settings_.cameras) {
      try_pipeline(camera);
      try_source(camera);
      try_devices(camera);
      if (camera.recorder)
        try_folder(camera.recorder->folder, line_of(camera.lines, "recorder.folder", camera.line),
                   is("folder", "[camera.recorder]", camera.recorder->folder));
    }
    const std::string state =
        settings_.state_folder.empty() ? default_state_folder() : settings_.state_folder;
    try_folder(state, line_of(settings_.lines, "state-folder", 0), is("state-folder", "the file", state));
    if (settings_.page.enabled) try_address("page", settings_.page.listen);
    if (settings_.rtsp) try_address("rtsp", settings_.rtsp->listen);
    for (const bool tls : {settings_.page.enabled && settings_.page.tls && settings_.page.certificate.empty(),
                           settings_.rtsp && settings_.rtsp->tls && settings_.rtsp->certificate.empty()})
      if (tls) try_openssl(state);
    if (settings_.page.enabled && settings_.page.tls)
      try_certificate("page", settings_.page.certificate, settings_.page.key);
    if (settings_.rtsp && settings_.rtsp->tls)
      try_certificate("rtsp", settings_.rtsp->certificate, settings_.rtsp->key);
    try_webhook();
    try_base();
    return std::move(trial_);
  }

 private:
  // A table that is for all cameras would be complained about for each.
  static void add(Mistakes& to, std::uint32_t line, const std::string& text) {
    const auto same = [&](const text::TomlMistake& one) { return one.line == line && one.text == text; };
    if (std::ranges::none_of(to, same)) to.push_back({line, text});
  }
  void mistake(std::uint32_t line, const std::string& text) { add(trial_.mistakes, line, text); }
  void lack(std::uint32_t line, const std::string& text) { add(trial_.lacks, line, text); }

  void try_pipeline(const CameraSettings& camera) {
    SharedSettings shared{settings_.page, settings_.mqtt, settings_.rtsp};
    if (!RtspOutput::is_built()) shared.rtsp.reset();
#if !HAVE_PAGE
    shared.page.enabled = false;
#endif
    const PipelineText text = pipeline_text(camera, shared, {});
    g_autoptr(GError) error = nullptr;
    g_autoptr(GstParseContext) context = gst_parse_context_new();
    g_autoptr(GstElement) pipeline =
        gst_parse_launch_full(text.line.c_str(), context, GST_PARSE_FLAG_FATAL_ERRORS, &error);
    if (pipeline == nullptr) {
      g_auto(GStrv) missing = gst_parse_context_get_missing_elements(context);
      g_autofree gchar* names = missing ? g_strjoinv(", ", missing) : nullptr;
      std::string what = names ? "GStreamer's " + std::string(names) + " is not installed: "
                               : std::string(error ? error->message : "?");
      if (names && g_str_equal(names, "personverify"))
        what +=
            "it is built where libopencv-objdetect-dev and libopencv-dnn-dev are; enabled = false in "
            "[camera.persons] goes without";
      else if (names)
        what += "gst-inspect-1.0 and the package lists name its package";
      return lack(camera.line, "camera \"" + camera.name + "\" cannot start: " + what);
    }
    gst_object_ref_sink(pipeline);
    for (const Assignment& one : text.assignments) {
      g_autoptr(GstElement) element = gst_bin_get_by_name(GST_BIN(pipeline), one.element.c_str());
      std::string wrong = element ? "" : "this build's pipeline has no " + one.element;
      if (element && set_property(element, one, wrong)) continue;
      const Table* table = table_of(one.element);
      mistake(one.line != 0 ? one.line : camera.line,
              stated(one, table ? table->name : "[[camera]]") + ": " + wrong);
    }
    for (const Table& table : kTables) {
      g_autoptr(GstElement) element =
          gst_bin_get_by_name(GST_BIN(pipeline), std::string(table.element).c_str());
      if (!element) continue;
      if (const std::string fault = ask_for_settings_fault(element); !fault.empty())
        refuse(camera, table, text, fault);
    }
  }

  // The mistake is at the last key of the table that the text names, else at the table.
  void refuse(const CameraSettings& camera, const Table& table, const PipelineText& text,
              const std::string& fault) {
    const Assignment* guilty = nullptr;
    for (const Assignment& one : text.assignments)
      if (one.element == table.element && one.line != 0 && has_word(fault, one.property) &&
          (guilty == nullptr || one.line > guilty->line))
        guilty = &one;
    // A text may cite a value alone.
    for (const Assignment& one : text.assignments)
      if (guilty == nullptr && one.element == table.element && one.line != 0 &&
          (fault.find('"' + one.value + '"') != fault.npos ||
           (one.value.find('/') != one.value.npos && fault.find(one.value) != fault.npos)))
        guilty = &one;
    if (guilty != nullptr) return mistake(guilty->line, stated(*guilty, table.name) + ": " + fault);
    const std::uint32_t line = table.key == "mqtt" ? line_of(settings_.lines, table.key, 0)
                                                   : line_of(camera.lines, table.key, camera.line);
    mistake(line, std::string(table.name) + " cannot be used: " + fault);
  }

  void try_source(const CameraSettings& camera) {
    if (!camera.source.file.empty()) try_file(camera);
    if (camera.source.kind != SourceKind::rtsp) return;
    try_uri(camera, "uri", camera.source.uri);
    if (!camera.source.record_uri.empty()) try_uri(camera, "record-uri", camera.source.record_uri);
  }
  void try_uri(const CameraSettings& camera, const char* key, const std::string& uri) {
    g_autoptr(GError) error = nullptr;
    g_autoptr(GUri) parsed = g_uri_parse(uri.c_str(), G_URI_FLAGS_NONE, &error);
    const char* host = parsed ? g_uri_get_host(parsed) : nullptr;
    if (host != nullptr && *host != '\0' && std::strchr(host, ' ') == nullptr) return;
    mistake(line_of(camera.lines, key, camera.line), is(key, "[[camera]]", uri) + ": " +
                                                         (error ? error->message : "it names no host") +
                                                         "; write rtsp://HOST:PORT/PATH");
  }

  // By its first bytes, as decodebin looks at it first.
  void try_file(const CameraSettings& camera) {
    const std::string& file = camera.source.file;
    g_autoptr(GError) error = nullptr;
    g_autofree gchar* line = g_strdup("filesrc name=source ! typefind name=type ! fakesink");
    g_autoptr(GstElement) pipeline = gst_parse_launch(line, &error);
    if (pipeline == nullptr) return;
    gst_object_ref_sink(pipeline);
    g_autoptr(GstElement) source = gst_bin_get_by_name(GST_BIN(pipeline), "source");
    g_autoptr(GstElement) type = gst_bin_get_by_name(GST_BIN(pipeline), "type");
    g_object_set(source, "location", file.c_str(), nullptr);
    gst_element_set_state(pipeline, GST_STATE_PAUSED);
    gst_element_get_state(pipeline, nullptr, nullptr, 3 * GST_SECOND);
    g_autoptr(GstCaps) caps = nullptr;
    g_object_get(type, "caps", &caps, nullptr);
    gst_element_set_state(pipeline, GST_STATE_NULL);
    const char* is_a = caps ? gst_structure_get_name(gst_caps_get_structure(caps, 0)) : "unknown";
    if (caps != nullptr && !g_str_has_prefix(is_a, "text/") && !g_str_has_prefix(is_a, "audio/")) return;
    lack(line_of(camera.lines, "file", camera.line),
         is("file", "[[camera]]", file) + ": this is no video (its type is " + is_a + "); name another");
  }

  // Devices come and go: without them the robot starts, and waits.
  void try_devices(const CameraSettings& camera) {
    if (camera.source.kind == SourceKind::v4l2)
      try_device(camera.source.device, line_of(camera.lines, "device", camera.line),
                 is("device", "[[camera]]", camera.source.device));
    const struct {
      const std::optional<Properties>& properties;
      const char* where;
    } parts[] = {{camera.sensors, "[camera.sensors]"}, {camera.head, "[camera.head]"}};
    for (const auto& part : parts) {
      if (!part.properties) continue;
      for (const Property& one : *part.properties)
        if (one.name == "device") try_device(one.value, one.line, is("device", part.where, one.value));
    }
    try_chip(camera);
  }
  // A chip may also be named by its label, which only the kernel knows.
  void try_chip(const CameraSettings& camera) {
    if (!camera.sensors) return;
    const auto of = [&](std::string_view name) {
      return std::ranges::find(*camera.sensors, name, &Property::name);
    };
    const auto driver = of("driver"), chip = of("chip");
    if (driver == camera.sensors->end() || driver->value != "gpio") return;
    const bool named = chip != camera.sensors->end();
    const std::string name = named ? chip->value : "gpiochip0";
    const std::string path = name.starts_with('/') ? name : "/dev/" + name;
    g_autoptr(GDir) devices = g_dir_open("/dev", 0, nullptr);
    bool any = false;
    while (const gchar* entry = devices ? g_dir_read_name(devices) : nullptr)
      any = any || g_str_has_prefix(entry, "gpiochip");
    if (any && (!name.starts_with("gpiochip") || ::access(path.c_str(), F_OK) == 0)) return;
    lack(named ? chip->line : driver->line,
         is("chip", "[camera.sensors]", name) + ": this machine has no such GPIO chip now");
  }

  void try_device(const std::string& device, std::uint32_t line, const std::string& what) {
    const bool serial = device.starts_with(kSerial);
    const std::string path = serial ? device.substr(kSerial.size()) : device;
    if (!path.starts_with('/') || ::access(path.c_str(), R_OK) == 0) return;
    lack(line, what + ": " + g_strerror(errno) + "; connect it, name another, or allow it to this user");
  }

  // A folder that is there must be writable, else one above it.
  void try_folder(const std::string& folder, std::uint32_t line, const std::string& what) {
    std::string path = folder;
    for (;;) {
      const int wrong = ::access(path.c_str(), W_OK | X_OK) == 0 ? 0 : errno;
      const bool is_folder = g_file_test(path.c_str(), G_FILE_TEST_IS_DIR);
      if (wrong == 0 && is_folder) return;
      if (wrong != ENOENT) {
        const int why =
            wrong == 0 || (wrong == EACCES && !is_folder && g_file_test(path.c_str(), G_FILE_TEST_EXISTS))
                ? ENOTDIR
                : wrong;
        return lack(line, what + ", and nothing can be written there (" + path + ": " + g_strerror(why) +
                              "); name another folder, or allow it to this user");
      }
      g_autofree gchar* above = g_path_get_dirname(path.c_str());
      if (path == above) return;
      path = above;
    }
  }

  void try_address(const std::string& table, const std::string& listen) {
    g_autoptr(GError) error = nullptr;
    g_autoptr(GSocketAddress) address = g_inet_socket_address_new_from_string(listen.c_str(), 0);
    if (address == nullptr) return;  // the file's reader has said so
    g_autoptr(GSocket) socket = g_socket_new(g_socket_address_get_family(address), G_SOCKET_TYPE_STREAM,
                                             G_SOCKET_PROTOCOL_TCP, &error);
    if (socket && g_socket_bind(socket, address, TRUE, &error)) return;
    lack(line_of(settings_.lines, table + ".listen", 0),
         is("listen", '[' + table + ']', listen) + ": " + error->message +
             "; take an address of this machine, or 0.0.0.0 for all of them");
  }

  void try_certificate(const std::string& table, const std::string& certificate, const std::string& key) {
    if (!g_tls_backend_supports_tls(g_tls_backend_get_default()))
      return lack(line_of(settings_.lines, table + ".tls", 0),
                  "\"tls\" of [" + table + "] needs glib-networking: install it");
    if (certificate.empty()) return;
    g_autoptr(GError) error = nullptr;
    g_autoptr(GTlsCertificate) loaded =
        g_tls_certificate_new_from_files(certificate.c_str(), key.c_str(), &error);
    const std::string fault = loaded == nullptr ? error->message : tls_fault(loaded);
    if (!fault.empty())
      mistake(line_of(settings_.lines, table + ".certificate", 0),
              is("certificate", '[' + table + ']', certificate) + " and \"certificate-key\" \"" + key +
                  "\": " + fault + "; both are PEM files of one certificate");
  }

  // The tool that makes a certificate where none is named.
  void try_openssl(const std::string& state) {
    g_autofree gchar* tool = g_find_program_in_path("openssl");
    if (tool != nullptr || g_file_test((state + "/page-certificate.pem").c_str(), G_FILE_TEST_EXISTS)) return;
    lack(line_of(settings_.lines, "page.tls", line_of(settings_.lines, "rtsp.tls", 0)),
         "\"tls\" without a \"certificate\" needs the tool openssl: install it");
  }

  void try_webhook() {
#if HAVE_PAGE
    if (!settings_.webhook) return;
    const WebhookSettings& hook = *settings_.webhook;
    g_autoptr(GError) error = nullptr;
    g_autoptr(GUri) uri = g_uri_parse(hook.url.c_str(), static_cast<GUriFlags>(SOUP_HTTP_URI_FLAGS), &error);
    const char* host = uri ? g_uri_get_host(uri) : nullptr;
    if (host == nullptr || *host == '\0')
      mistake(line_of(settings_.lines, "webhook.url", 0), is("url", "[webhook]", hook.url) + ": " +
                                                              (error ? error->message : "it names no host") +
                                                              "; write https://HOST:PORT/PATH");
    std::string wrong;
    if (Webhook(hook, settings_.name).open(wrong)) return;
    const bool secret = wrong.find(hook.secret_file) != wrong.npos;
    const char* key = secret ? "secret-file" : "ca-file";
    mistake(line_of(settings_.lines, std::string("webhook.") + key, 0),
            is(key, "[webhook]", secret ? hook.secret_file : hook.ca_file) + ": " + wrong);
#endif
  }

  void try_base() {
    if (!settings_.base) return;
    const std::string& command = settings_.base->command;
    g_auto(GStrv) words = nullptr;
    g_autoptr(GError) error = nullptr;
    std::string wrong;
    if (!g_shell_parse_argv(command.c_str(), nullptr, &words, &error)) {
      wrong = error->message;
    } else {
      g_autofree gchar* program = g_find_program_in_path(words[0]);
      if (program == nullptr)
        wrong = "there is no program \"" + std::string(words[0]) +
                "\" that could be run: install it, or give its path";
    }
    if (!wrong.empty())
      mistake(line_of(settings_.lines, "base.command", 0), is("command", "[base]", command) + ": " + wrong);
  }

  const Settings& settings_;
  Trial trial_;
};

}  // namespace

Trial try_settings(const Settings& settings) {
  return Trying(settings).run();
}

std::string default_state_folder() {
  if (const char* given = g_getenv("STATE_DIRECTORY")) return given;  // of the service
  g_autofree gchar* own = g_build_filename(g_get_user_data_dir(), "cerberus", nullptr);
  return own;
}

}  // namespace cerberus::robot
