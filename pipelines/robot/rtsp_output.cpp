// SPDX-License-Identifier: LGPL-2.1-or-later
#include "rtsp_output.h"

#if HAVE_RTSP
#include <map>
#include <utility>

#include "robot/backoff.h"
#include "robot/pipeline_text.h"
#include "rtsp_server/rtsp_server.h"
#include "rtsp_server/user_sources.h"
#if HAVE_PAGE
#include "page_listener.h"
#endif

namespace cerberus::robot {

namespace {

using Clock = std::chrono::steady_clock;

}  // namespace

struct RtspOutput::State {
  struct Entry {
    GstElement* pipeline = nullptr;  // the same one is shown again after privacy; `streams` keeps it
    rtsp::PipelineStreams streams;
    bool shown = false, mounted = false;
  };

  Settings settings;  // as of configure()
  std::map<std::string, Entry> entries;
  std::unique_ptr<rtsp::RtspServer> server;
  Backoff backoff;
};

RtspOutput::RtspOutput() : state_(std::make_unique<State>()) {}
RtspOutput::~RtspOutput() = default;

bool RtspOutput::is_built() {
  return true;
}

void RtspOutput::configure(const Settings& settings) {
  for (auto& [camera, entry] : state_->entries) entry.streams.close();
  state_->server.reset();
  for (auto& [camera, entry] : state_->entries) {
    entry.mounted = false;
    if (entry.shown) entry.streams.reopen();
  }
  state_->settings = settings;
  state_->backoff = {};
  fault_.clear();
  if (settings.rtsp) open();
}

void RtspOutput::open() {
  const RtspSettings& settings = *state_->settings.rtsp;
  rtsp::ServerSettings wanted;
  wanted.address = settings.listen;
  wanted.port = settings.port;
  wanted.certificate = settings.certificate;
  wanted.key = settings.key;
  fault_.clear();
  if (!settings.users_file.empty()) fault_ = rtsp::read_users({settings.users_file, "", ""}, wanted.users);
  if (settings.tls && settings.certificate.empty()) {
#if HAVE_PAGE
    // The page's, so that a client accepts one certificate of the robot.
    g_autoptr(GTlsCertificate) made = self_made_certificate(state_->settings, fault_);
    wanted.certificate = state_->settings.state_folder + "/page-certificate.pem";
    wanted.key = state_->settings.state_folder + "/page-key.pem";
#else
    fault_ = "this build makes no certificates: name a \"certificate\" in [rtsp]";
#endif
  }
  auto server = std::make_unique<rtsp::RtspServer>(std::move(wanted));
  if (fault_.empty()) fault_ = server->prepare();
  if (fault_.empty()) fault_ = server->listen();
  if (fault_.empty()) {
    state_->server = std::move(server);
    g_printerr("cerberusd: RTSP: %s port %d\n", settings.listen.c_str(), settings.port);
    return;
  }
  const auto wait = state_->backoff.failed(Clock::now());
  g_printerr("cerberusd: RTSP: %s; it is tried again in %d s\n", fault_.c_str(),
             static_cast<int>(std::chrono::duration_cast<std::chrono::seconds>(wait).count()));
}

void RtspOutput::tick() {
  if (!state_->server && state_->settings.rtsp && state_->backoff.is_due(Clock::now())) open();
  if (!state_->server) return;
  for (auto& [camera, entry] : state_->entries) {
    if (!entry.shown || entry.mounted || !entry.streams.has_begun()) continue;
    entry.mounted = true;  // what is refused now would be refused again
    if (const std::string wrong = state_->server->add(camera, entry.streams); !wrong.empty())
      g_printerr("cerberusd: %s: RTSP: %s\n", camera.c_str(), wrong.c_str());
  }
}

void RtspOutput::show(const std::string& camera, GstElement* pipeline) {
  if (!state_->settings.rtsp) return;
  State::Entry& entry = state_->entries[camera];
  if (entry.pipeline == pipeline) {
    entry.streams.reopen();
  } else {
    hide(camera, entry.pipeline);  // of a camera of this name that is still leaving
    entry = {};
    entry.pipeline = pipeline;
    if (const std::string wrong = entry.streams.collect(pipeline, std::string(kRtspPrefix)); !wrong.empty()) {
      g_printerr("cerberusd: %s: RTSP: %s\n", camera.c_str(), wrong.c_str());
      state_->entries.erase(camera);
      return;
    }
  }
  entry.shown = true;
}

void RtspOutput::hide(const std::string& camera, GstElement* pipeline) {
  const auto found = state_->entries.find(camera);
  if (found == state_->entries.end() || found->second.pipeline != pipeline || !found->second.shown) return;
  found->second.shown = false;
  found->second.streams.close();
  if (std::exchange(found->second.mounted, false) && state_->server) state_->server->remove(camera);
}

void RtspOutput::forget(const std::string& camera, GstElement* pipeline) {
  hide(camera, pipeline);
  const auto found = state_->entries.find(camera);
  if (found != state_->entries.end() && found->second.pipeline == pipeline) state_->entries.erase(found);
}

}  // namespace cerberus::robot

#else

namespace cerberus::robot {

struct RtspOutput::State {};
RtspOutput::RtspOutput() = default;
RtspOutput::~RtspOutput() = default;
bool RtspOutput::is_built() {
  return false;
}
void RtspOutput::configure(const Settings& settings) {
  if (settings.rtsp) g_printerr("cerberusd: this build has no RTSP server (it needs gst-rtsp-server)\n");
}
void RtspOutput::open() {}
void RtspOutput::tick() {}
void RtspOutput::show(const std::string&, GstElement*) {}
void RtspOutput::hide(const std::string&, GstElement*) {}
void RtspOutput::forget(const std::string&, GstElement*) {}

}  // namespace cerberus::robot
#endif
