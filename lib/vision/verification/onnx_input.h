// SPDX-License-Identifier: LGPL-2.1-or-later
// The size of the picture that an ONNX model takes, read from its file: OpenCV does not report it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "vision/image/image.h"

namespace cerberus::vision {

// Returns the size of the model's first input that is a picture: a tensor of four dimensions, 1 x 3 x height x width
// (a first dimension without a number counts as 1). nullopt: the bytes are no ONNX model (a protocol buffer as
// onnx.proto of the ONNX project defines it, IR version 3 to 10), or its input has no fixed size, or is no picture of
// three planes. Never reads beyond the bytes.
std::optional<Size> onnx_input_size(std::span<const std::uint8_t> model);

}  // namespace cerberus::vision
