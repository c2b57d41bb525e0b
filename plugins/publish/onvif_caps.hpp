// SPDX-License-Identifier: LGPL-2.1-or-later
// The caps of ONVIF metadata: UTF-8 text, a document a buffer.
#pragma once

namespace cerberus::plugin {

inline constexpr char kOnvifCaps[] = "application/x-onvif-metadata";

}  // namespace cerberus::plugin
