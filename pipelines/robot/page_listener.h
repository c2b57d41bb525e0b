// SPDX-License-Identifier: LGPL-2.1-or-later
// Accepts the connections of the page: so many, and none that is silent for long; with TLS where there is a certificate.
// Main loop's thread.
#pragma once

#include <gio/gio.h>
#include <libsoup/soup.h>

#include <map>
#include <string>
#include <vector>

#include "robot/settings.h"

namespace cerberus::robot {

class PageListener {
 public:
  struct Parameters {
    // 16 open pages, each with the six connections that browsers make; a single address leaves room for others, and so do
    // all proxies together.
    std::size_t most = 128, most_of_address = 48, most_of_proxies = 96;
    // Longer than browsers keep a connection for the next request makes no difference; pages that are open are pinged
    // every 10 s.
    guint idle = 60;  // seconds
    // Seconds until the head of the first request is complete, with the handshake of TLS, and until a body is after it:
    // a slow mobile network needs three. A connection that sends letter by letter is never idle.
    guint head = 10;
  };

  PageListener() = default;
  ~PageListener();
  PageListener(const PageListener&) = delete;
  PageListener& operator=(const PageListener&) = delete;

  // `certificate` nullptr: without TLS. `server` outlives the listener. False, and what is wrong.
  bool open(SoupServer* server, GSocketAddress* address, GTlsCertificate* certificate, std::string& error);
  // Ends a connection at once, whatever was promised on it.
  void abort(GSocketAddress* remote);
  // How far a request on the connection is. A WebSocket has no limit of time from then on.
  enum class Step { head_read, body_read, answered, became_socket };
  void note(GSocketAddress* remote, Step step);
  // A request on the connection is that of `client`, until it is answered or as long as it is a WebSocket. False: the
  // connection is a proxy's, and this client has as many requests on others as an address may have connections.
  bool assign(GSocketAddress* remote, const std::string& client);
  // Addresses of proxies, which have the connections of many clients.
  void trust(std::vector<std::string> networks) { trusted_ = std::move(networks); }

 private:
  struct Open {
    std::string name;    // the remote address and port: "127.0.0.1:4711"
    std::string client;  // whose it is; of a proxy: whose request is on it, empty while there is none
    gint64 until = 0;    // monotonic time, microseconds; 0: no limit
    bool of_proxy = false, socket = false;
  };
  void sweep();
  std::size_t count_of(const std::string& client) const;
  void accept(GSocketConnection* connection);
  static void forget(gpointer listener, GObject* connection);  // which is gone

  Parameters parameters_;
  SoupServer* server_ = nullptr;
  GSocketService* service_ = nullptr;
  GTlsCertificate* certificate_ = nullptr;
  guint timer_ = 0;
  std::vector<std::string> trusted_;
  std::map<GObject*, Open> open_;  // by connection
};

// The certificate of the files, or the self-made one in the state folder, which the openssl tool makes at the first start,
// for the addresses of the page and of [rtsp]. The caller unrefs; nullptr, and what is wrong.
GTlsCertificate* load_certificate(const std::string& certificate, const std::string& key, std::string& error);
GTlsCertificate* self_made_certificate(const Settings& settings, std::string& error);
// SHA-256 of a certificate as browsers show it: "AB:CD:...".
std::string fingerprint(GTlsCertificate* certificate);

}  // namespace cerberus::robot
