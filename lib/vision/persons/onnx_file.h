// SPDX-License-Identifier: LGPL-2.1-or-later
// What OpenCV does not tell about the file of an ONNX model, or cannot run in it. Never reads beyond the bytes.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "vision/image/image.h"

namespace cerberus::vision {

// Returns the size of the model's first input that is a picture: a tensor of four dimensions, 1 x 3 x height x width
// (a first dimension without a number counts as 1). nullopt: the bytes are no ONNX model (a protocol buffer as
// onnx.proto of the ONNX project defines it, IR version 3 or later), or its input has no fixed size, or is no picture of
// three planes.
std::optional<Size> onnx_input_size(std::span<const std::uint8_t> model);

// OpenCV 4.6 cannot multiply 1 x 4 x N boxes by 1 x N factors, which is the end of YOLO 8 (cells to pixels). Returns the
// model with such factors as 1 x 4 x N: constants of floats that a Mul takes, where an output has N as its last length.
// nullopt: there are none, or the bytes are no model.
std::optional<std::vector<std::uint8_t>> onnx_with_full_factors(std::span<const std::uint8_t> model);

}  // namespace cerberus::vision
