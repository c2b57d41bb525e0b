// SPDX-License-Identifier: LGPL-2.1-or-later
// The two kinds of picture that the stages use: a view (borrowed, with stride) and an image (owned, sized once).
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <type_traits>
#include <utility>

namespace cerberus::vision {

struct Size {
  int width = 0;
  int height = 0;
  bool operator==(const Size&) const = default;
  long area() const { return static_cast<long>(width) * height; }
};

// A borrowed picture of `width` x `height` samples; `stride` is the distance between rows in samples
// and may be larger than the width. A view does not own the samples and checks no bounds: the caller passes mapped
// memory.
template <typename T>
struct View {
  T* data = nullptr;
  int width = 0;
  int height = 0;
  std::ptrdiff_t stride = 0;

  T* row(int y) const { return data + y * stride; }
  T& at(int x, int y) const { return row(y)[x]; }
  Size size() const { return {width, height}; }
  bool empty() const { return width <= 0 || height <= 0; }
  operator View<const T>() const
    requires(!std::is_const_v<T>)
  {
    return {data, width, height, stride};
  }
};

using GrayView = View<const std::uint8_t>;
using MutableGrayView = View<std::uint8_t>;

// Rows are padded to a multiple of kRowSamples, so that kernels read whole vectors up to a row's end.
inline constexpr int kRowSamples = 16;

constexpr int padded_row(int width, int step = kRowSamples) {
  return (width + step - 1) / step * step;
}

// An owned picture, its rows padded to kStep samples. `resize` to the present size does nothing: the steady state
// allocates nothing.
template <typename T, int kStep = kRowSamples>
class Image {
 public:
  Image() = default;
  explicit Image(Size size) { resize(size); }

  // Returns true when the memory is new (and zeroed). Throws std::bad_alloc when memory runs out; the image is then
  // unchanged.
  bool resize(Size size) {
    if (size == size_) return false;
    const int stride = padded_row(size.width, kStep);
    const std::size_t bytes = static_cast<std::size_t>(stride) * size.height * sizeof(T);
    data_.reset(bytes ? static_cast<T*>(::operator new(bytes, std::align_val_t{kAlign})) : nullptr);
    stride_ = stride;
    size_ = size;
    fill_bytes(0);
    return true;
  }

  void fill_bytes(int value) {
    if (data_) std::memset(static_cast<void*>(data_.get()), value, bytes());
  }

  std::size_t bytes() const { return static_cast<std::size_t>(stride_) * size_.height * sizeof(T); }
  Size size() const { return size_; }
  bool empty() const { return !data_; }
  View<T> view() { return {data_.get(), size_.width, size_.height, stride_}; }
  View<const T> view() const { return {data_.get(), size_.width, size_.height, stride_}; }
  void swap(Image& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(stride_, other.stride_);
  }

 private:
  static_assert(std::is_trivially_copyable_v<T>);
  static constexpr std::size_t kAlign = 64;  // alignment of the first row in bytes: a cache line
  struct Free {
    void operator()(T* p) const { ::operator delete(p, std::align_val_t{kAlign}); }
  };
  std::unique_ptr<T, Free> data_;
  Size size_;
  std::ptrdiff_t stride_ = 0;
};

}  // namespace cerberus::vision
