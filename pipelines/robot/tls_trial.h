// SPDX-License-Identifier: LGPL-2.1-or-later
// Whether a certificate and its key serve TLS connections: reading the files does not tell whether they belong together.
#pragma once

#include <gio/gio.h>

#include <string>

namespace cerberus::robot {

// Makes a connection within this process. Returns what is wrong; empty: nothing.
std::string tls_fault(GTlsCertificate* certificate);

}  // namespace cerberus::robot
