// SPDX-License-Identifier: LGPL-2.1-or-later
// What other threads may know of a client's connection. The client's own thread may close and free the connection itself
// at any time.
#pragma once

#include <gst/rtsp-server/rtsp-server.h>

namespace cerberus::rtsp {

// Notes the connection of a client that was accepted and has no thread yet.
void note_connection(GstRTSPClient* client);
// In the client's own thread, when a session begins: a tunnel through HTTP, which has two sockets, is complete by then.
void note_session(GstRTSPClient* client);

// The client's address as a text, which lives as long as the client; nullptr: it was not noted.
const char* address_of(GstRTSPClient* client);
// Closes the connection: the client's own thread reads its end and tears the client down. Any number of times.
void shut_down(GstRTSPClient* client);

}  // namespace cerberus::rtsp
