// SPDX-License-Identifier: LGPL-2.1-or-later
// What packs an encoded stream into RTP. Launch files and examples have the same (tests/generic/house.py).
#pragma once

#include <string_view>

namespace cerberus::publish {

// The text of the payloader for streams of this media type ("video/x-h264"), as in a launch line; empty: none is known.
std::string_view payloader_of(std::string_view media);

}  // namespace cerberus::publish
