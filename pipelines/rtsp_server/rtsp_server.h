// SPDX-License-Identifier: LGPL-2.1-or-later
// Serves the encoded streams of running pipelines over RTSP.
#pragma once

#include <gst/rtsp-server/rtsp-server.h>

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "publish/streams/users.h"
#include "rtsp_server/pipeline_streams.h"

namespace cerberus::rtsp {

struct ServerSettings {
  std::string address = "127.0.0.1";
  int port = 8554;                   // 0: any free one
  std::vector<publish::User> users;  // who may play (HTTP digest); none: whoever reaches the address
  std::string certificate, key;      // PEM files; the key may be in the certificate's. Given: TLS only
  unsigned most_of_address = 48;     // connections: a recorder takes two of each camera
  std::chrono::seconds idle{60};     // after which a connection without a session is closed
};

// Each stream is a mount: `annotated` of the folder `front` is rtsp://ADDRESS:PORT/front/annotated. Clients of a mount
// share one pipeline without an encoder, which EncodedStream feeds. Mounts come and go while the server runs.
class RtspServer {
 public:
  explicit RtspServer(ServerSettings settings);
  // Closes the port and all connections, and waits until their threads have torn them down, .2 s at most.
  ~RtspServer();
  RtspServer(const RtspServer&) = delete;
  RtspServer& operator=(const RtspServer&) = delete;

  // Reads the certificate. Returns what is wrong, or nothing.
  std::string prepare();
  // Opens the port, after prepare(). Clients are accepted by the default main context and served by threads of their
  // own. Returns what is wrong.
  std::string listen();

  // Serves the streams, which have begun, below the folder (empty: none). Returns what is wrong; then none is served.
  std::string add(const std::string& folder, const PipelineStreams& streams);
  // Ends the mounts of the folder and closes the connections of their clients.
  void remove(const std::string& folder);

  int port() const;
  // The address of each mount, with what it is.
  std::vector<std::string> mounts() const;

 private:
  struct Mount {
    std::string folder, path, kinds;
  };

  static std::string make_line(const std::vector<std::shared_ptr<EncodedStream>>& streams, std::string& line,
                               std::string& kinds);
  void protect();
  void accept(GstRTSPClient* client);
  void clean();

  ServerSettings settings_;
  std::vector<Mount> mounts_;
  Ref<GstRTSPServer> server_;
  GTlsCertificate* certificate_ = nullptr;
  GSource* listener_ = nullptr;
  guint cleaner_ = 0;
};

}  // namespace cerberus::rtsp
