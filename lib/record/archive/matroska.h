// SPDX-License-Identifier: LGPL-2.1-or-later
// Whether a Matroska file has anything to play: of a writer that was killed there may be no more than a header.
#pragma once

namespace cerberus::record {

// A whole SimpleBlock or BlockGroup in a Cluster (RFC 9559). `fd`: open for reading.
bool has_block(int fd);

}  // namespace cerberus::record
