// SPDX-License-Identifier: LGPL-2.1-or-later
// Serves the encoded streams of a running pipeline over RTSP.
#pragma once

#include <gst/rtsp-server/rtsp-server.h>

#include <memory>
#include <string>
#include <vector>

#include "publish/streams/users.h"
#include "rtsp_server/encoded_stream.h"

namespace cerberus::rtsp {

struct ServerSettings {
  std::string address = "127.0.0.1";
  int port = 8554;                   // 0: any free one
  std::vector<publish::User> users;  // who may play (HTTP digest); none: whoever reaches the address
  std::string certificate, key;      // PEM files; the key may be in the certificate's. Given: TLS only
};

// Each appsink of the pipeline is a mount of its name: `appsink name=annotated` is rtsp://ADDRESS:PORT/annotated. One
// called `metadata` is no mount but the second stream of all others. A `valve name=annotated-valve` before the encoder
// is closed while the mount has no client. Clients of a mount share one pipeline without an encoder, which
// EncodedStream feeds.
class RtspServer {
 public:
  // `pipeline` is the caller's and shall outlive the server.
  RtspServer(GstElement* pipeline, ServerSettings settings);
  ~RtspServer();
  RtspServer(const RtspServer&) = delete;
  RtspServer& operator=(const RtspServer&) = delete;

  // Takes the appsinks over and reads the certificate; before the pipeline plays. Returns what is wrong, or nothing.
  std::string prepare();
  // Whether every stream has begun, so that clients can be told what it is.
  bool has_begun() const;
  // The streams that have not begun yet.
  std::string missing() const;
  // Opens the port, once all streams have begun; clients are served by the default main context. Returns what is wrong.
  std::string listen();

  int port() const;
  // The address of each mount, with what it is.
  std::vector<std::string> mounts() const;
  // Ends the stream of every client.
  void end();

 private:
  using Streams = std::vector<std::shared_ptr<EncodedStream>>;  // of one mount: pay0, pay1

  std::string add_mount(const std::shared_ptr<EncodedStream>& stream);
  void protect();

  GstElement* pipeline_;
  ServerSettings settings_;
  std::vector<std::shared_ptr<EncodedStream>> streams_;  // without the metadata
  std::shared_ptr<EncodedStream> metadata_;
  std::vector<std::string> mounts_;
  Ref<GstRTSPServer> server_;
  GTlsCertificate* certificate_ = nullptr;
  GSource* listener_ = nullptr;
  guint cleaner_ = 0;
};

}  // namespace cerberus::rtsp
