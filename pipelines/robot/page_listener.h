// SPDX-License-Identifier: LGPL-2.1-or-later
// Accepts the connections of the page: so many, and none that is silent for long; with TLS where there is a certificate.
// Main loop's thread.
#pragma once

#include <gio/gio.h>
#include <libsoup/soup.h>

#include <map>
#include <string>

#include "robot/settings.h"

namespace cerberus::robot {

class PageListener {
 public:
  struct Parameters {
    // 16 open pages, each with the six connections that browsers make; a single address leaves room for others.
    std::size_t most = 128, most_of_address = 48;
    // Longer than browsers keep a connection for the next request makes no difference; pages that are open are pinged
    // every 10 s.
    guint idle = 60;  // seconds
  };

  PageListener() = default;
  ~PageListener();
  PageListener(const PageListener&) = delete;
  PageListener& operator=(const PageListener&) = delete;

  // `certificate` nullptr: without TLS. `server` outlives the listener. False, and what is wrong.
  bool open(SoupServer* server, GSocketAddress* address, GTlsCertificate* certificate, std::string& error);
  // Ends a connection at once, whatever was promised on it.
  void abort(GSocketAddress* remote);

 private:
  struct Open {
    PageListener* listener;
    std::string name;  // "127.0.0.1:4711"
  };
  void accept(GSocketConnection* connection);
  static void forget(gpointer listener, GObject* connection);  // which is gone

  Parameters parameters_;
  SoupServer* server_ = nullptr;
  GSocketService* service_ = nullptr;
  GTlsCertificate* certificate_ = nullptr;
  std::map<GObject*, std::string> open_;  // the connections by their remote address and port
};

// The certificate of the files, or the self-made one in the state folder, which the openssl tool makes at the first start,
// for the addresses of the page and of [rtsp]. The caller unrefs; nullptr, and what is wrong.
GTlsCertificate* load_certificate(const std::string& certificate, const std::string& key, std::string& error);
GTlsCertificate* self_made_certificate(const Settings& settings, std::string& error);
// SHA-256 of a certificate as browsers show it: "AB:CD:...".
std::string fingerprint(GTlsCertificate* certificate);

}  // namespace cerberus::robot
