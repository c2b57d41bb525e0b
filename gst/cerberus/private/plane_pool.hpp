// SPDX-License-Identifier: LGPL-2.1-or-later
// Planes: small pictures that a stage writes once, publishes on the frame, and nobody writes again.
#pragma once

#include <cerberus/plane.h>
#include <gst/gst.h>

#include <cstddef>
#include <memory>
#include <utility>

#include "vision/image/image.h"

namespace cerberus {

// A mapped plane. Views know width, height and stride (in samples of T).
class MappedPlane {
 public:
  MappedPlane() = default;
  ~MappedPlane() { unmap(); }
  MappedPlane(MappedPlane&& other) noexcept { swap(other); }
  MappedPlane& operator=(MappedPlane&& other) noexcept {
    MappedPlane(std::move(other)).swap(*this);
    return *this;
  }

  // Reads the plane of `kind` on `frame`; false where there is none. (Its size was checked when it was added.)
  static MappedPlane read(GstBuffer* frame, CerberusPlaneKind kind) {
    MappedPlane plane;
    const CerberusPlaneMeta* meta = cerberus_buffer_get_plane_meta(frame, kind);
    if (meta) plane.map(gst_buffer_ref(meta->buffer), meta->width, meta->height, meta->stride, GST_MAP_READ);
    return plane;
  }

  // Takes the plane of `kind` off `frame` (a writable buffer) in order to write into it, where nobody else
  // holds it; else false, and the plane stays.
  static MappedPlane take(GstBuffer* frame, CerberusPlaneKind kind) {
    MappedPlane plane;
    CerberusPlaneMeta* meta = cerberus_buffer_get_plane_meta(frame, kind);
    if (!meta || !gst_buffer_is_writable(meta->buffer)) return plane;
    const int width = meta->width, height = meta->height, stride = meta->stride;
    GstBuffer* buffer = gst_buffer_ref(meta->buffer);
    gst_buffer_remove_meta(frame, reinterpret_cast<GstMeta*>(meta));
    plane.map(buffer, width, height, stride, GST_MAP_READWRITE);
    return plane;
  }

  explicit operator bool() const { return buffer_ != nullptr; }
  int width() const { return width_; }
  int height() const { return height_; }
  int stride() const { return stride_; }  // bytes
  vision::Size size() const { return {width_, height_}; }

  template <typename T>
  vision::View<const T> view() const {
    return {reinterpret_cast<const T*>(map_.data), width_, height_, stride_ / static_cast<int>(sizeof(T))};
  }
  // Only of a plane that comes from PlanePool::acquire or take().
  template <typename T>
  vision::View<T> writable() {
    return {reinterpret_cast<T*>(map_.data), width_, height_, stride_ / static_cast<int>(sizeof(T))};
  }

  // Hands the finished plane to `frame` (a writable buffer); it is empty afterwards.
  bool publish(GstBuffer* frame, CerberusPlaneKind kind) {
    if (!buffer_) return false;
    gst_buffer_unmap(buffer_, &map_);
    return cerberus_buffer_add_plane_meta(frame, kind, std::exchange(buffer_, nullptr), width_, height_,
                                          stride_);
  }

 private:
  friend class PlanePool;

  void map(GstBuffer* buffer, int width, int height, int stride, GstMapFlags flags) {  // takes `buffer`
    if (!gst_buffer_map(buffer, &map_, flags)) {
      gst_buffer_unref(buffer);
      return;
    }
    buffer_ = buffer;
    width_ = width;
    height_ = height;
    stride_ = stride;
  }
  void unmap() {
    if (!buffer_) return;
    gst_buffer_unmap(buffer_, &map_);
    gst_buffer_unref(std::exchange(buffer_, nullptr));
  }
  void swap(MappedPlane& other) noexcept {
    std::swap(buffer_, other.buffer_);
    std::swap(map_, other.map_);
    std::swap(width_, other.width_);
    std::swap(height_, other.height_);
    std::swap(stride_, other.stride_);
  }

  GstBuffer* buffer_ = nullptr;
  GstMapInfo map_{};
  int width_ = 0, height_ = 0, stride_ = 0;
};

// Buffers of one size, used again as soon as the last frame that carries them is gone: the steady state
// allocates nothing. A new size makes a new pool; so keep one PlanePool for each size that a stage writes.
class PlanePool {
 public:
  PlanePool() = default;
  ~PlanePool() { clear(); }
  PlanePool(const PlanePool&) = delete;
  PlanePool& operator=(const PlanePool&) = delete;

  // A plane to write, its rows padded as those of a vision::Image.
  // What it holds is undefined. False where memory ran out.
  MappedPlane acquire(vision::Size size, int sample_size = 1);
  // Lets go of the memory; planes that still ride on frames stay valid.
  void clear();

 private:
  GstBufferPool* pool_ = nullptr;
  std::size_t bytes_ = 0;
};

inline MappedPlane PlanePool::acquire(vision::Size size, int sample_size) {
  constexpr int kAlign = 64;  // a line of the cache
  MappedPlane plane;
  if (size.width <= 0 || size.height <= 0) return plane;
  const int stride = vision::padded_row(size.width) * sample_size;
  const std::size_t bytes = static_cast<std::size_t>(stride) * size.height;
  if (bytes != bytes_) {
    clear();
    GstBufferPool* pool = gst_buffer_pool_new();
    GstStructure* config = gst_buffer_pool_get_config(pool);
    gst_buffer_pool_config_set_params(config, nullptr, static_cast<guint>(bytes), 0, 0);
    GstAllocationParams params;
    gst_allocation_params_init(&params);
    params.align = kAlign - 1;
    gst_buffer_pool_config_set_allocator(config, nullptr, &params);
    if (!gst_buffer_pool_set_config(pool, config) || !gst_buffer_pool_set_active(pool, TRUE)) {
      gst_object_unref(pool);
      return plane;
    }
    pool_ = pool;
    bytes_ = bytes;
  }
  GstBuffer* buffer = nullptr;
  if (gst_buffer_pool_acquire_buffer(pool_, &buffer, nullptr) != GST_FLOW_OK) return plane;
  plane.map(buffer, size.width, size.height, stride, GST_MAP_WRITE);
  return plane;
}

inline void PlanePool::clear() {
  if (!pool_) return;
  gst_buffer_pool_set_active(pool_, FALSE);
  gst_object_unref(pool_);
  pool_ = nullptr;
  bytes_ = 0;
}

}  // namespace cerberus
