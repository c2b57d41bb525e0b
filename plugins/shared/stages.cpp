// SPDX-License-Identifier: LGPL-2.1-or-later
#include "stages.hpp"

#include <cerberus/cerberus.h>

#include <algorithm>
#include <cstring>
#include <new>
#include <utility>

#include "cerberus/private/video.hpp"

namespace cerberus::plugin {
namespace {

MappedPlane acquire(PlanePool& pool, vision::Size size, int sample_size = 1) {
  MappedPlane plane = pool.acquire(size, sample_size);
  if (!plane) throw std::bad_alloc();
  return plane;
}

// Kernels may work on whole vectors. A plane whose rows are not padded
// as a PlanePool pads them comes from a stranger and counts as missing.
MappedPlane read(GstBuffer* buffer, CerberusPlaneKind kind) {
  MappedPlane plane = MappedPlane::read(buffer, kind);
  if (plane && plane.stride() != vision::padded_row(plane.width()) * cerberus_plane_kind_sample_size(kind))
    plane = MappedPlane();
  return plane;
}

void drop(GstBuffer* buffer, CerberusPlaneKind kind) {
  if (CerberusPlaneMeta* meta = cerberus_buffer_get_plane_meta(buffer, kind))
    gst_buffer_remove_meta(buffer, reinterpret_cast<GstMeta*>(meta));
}

void copy(vision::GrayView from, vision::MutableGrayView to) {
  for (int y = 0; y < from.height; ++y)
    std::memcpy(to.row(y), from.row(y), static_cast<std::size_t>(from.width));
}

}  // namespace

MappedPlane LumaStage::obtain(Frame& frame) {
  MappedPlane upstream = read(frame.buffer, CERBERUS_PLANE_LUMA);
  // A plane larger than the frame is not ours, whoever attached it.
  const vision::Size size = frame.size();
  if (upstream && upstream.width() <= size.width && upstream.height() <= size.height) return upstream;
  return make(frame);
}

MappedPlane LumaStage::make(Frame& frame) {
  const VideoFrame mapped(*frame.info, frame.buffer, GST_MAP_READ);
  if (!mapped) return {};
  MappedPlane plane = acquire(pool_, vision::analysis_size(frame.size(), analysis_width_));
  scaler_.scale(luma_source(*mapped.get()), plane.writable<std::uint8_t>());
  plane.publish(frame.buffer, CERBERUS_PLANE_LUMA);
  return read(frame.buffer, CERBERUS_PLANE_LUMA);
}

bool DifferenceStage::ensure(Frame& frame, vision::Size size, bool previous_wanted) {
  const MappedPlane histogram = read(frame.buffer, CERBERUS_PLANE_HISTOGRAM);
  const MappedPlane current = read(frame.buffer, CERBERUS_PLANE_DIFFERENCE);
  if (histogram.width() * sizeof(std::uint32_t) >= sizeof(HistogramRecord) && current.size() == size)
    return true;
  return run(frame, previous_wanted);
}

bool DifferenceStage::run(Frame& frame, bool previous_wanted) {
  const MappedPlane picture = luma_.obtain(frame);
  if (!picture) return false;
  if (!difference_) difference_.emplace().set_options(options_);
  if (sequence_.broken_by(frame)) difference_->reset();
  const vision::Size size = picture.size();
  MappedPlane current = acquire(current_pool_, size), previous;
  if (previous_wanted)
    previous = acquire(previous_pool_, size);
  else
    previous_pool_.clear();
  MappedPlane histogram = acquire(histogram_pool_, {sizeof(HistogramRecord) / 4, 1}, 4);

  vision::Histogram counts;
  const vision::DifferenceResult result =
      difference_->update(picture.view<std::uint8_t>(), frame.motion.in(size, frame.size()),
                          current.writable<std::uint8_t>(), previous.writable<std::uint8_t>(), counts);
  HistogramRecord record{};
  std::memcpy(record.count, counts.data(), sizeof record.count);
  record.frames = result.frames;
  record.previous = result.previous;
  std::memcpy(histogram.writable<std::uint32_t>().data, &record, sizeof record);

  current.publish(frame.buffer, CERBERUS_PLANE_DIFFERENCE);
  drop(frame.buffer, CERBERUS_PLANE_PREVIOUS_DIFFERENCE);  // a stranger's
  previous.publish(frame.buffer, CERBERUS_PLANE_PREVIOUS_DIFFERENCE);
  histogram.publish(frame.buffer, CERBERUS_PLANE_HISTOGRAM);
  return true;
}

bool MaskStage::ensure(Frame& frame) {
  return read(frame.buffer, CERBERUS_PLANE_MASK) || run(frame);
}

bool MaskStage::run(Frame& frame) {
  const MappedPlane picture = before_.luma().obtain(frame);
  const bool previous_needed = options_.area != vision::Area::all;
  if (!picture || !before_.ensure(frame, picture.size(), previous_needed || frame.planes_wanted))
    return false;
  const MappedPlane current = read(frame.buffer, CERBERUS_PLANE_DIFFERENCE);
  MappedPlane histogram = read(frame.buffer, CERBERUS_PLANE_HISTOGRAM);
  const vision::Size size = picture.size();
  if (!area_) area_.emplace().set_options(options_);
  if (sequence_.broken_by(frame) || size != size_) {
    area_->reset();
    burnt_in_.reset();
  }
  size_ = size;

  HistogramRecord record;
  std::memcpy(&record, histogram.view<std::uint32_t>().data, sizeof record);
  histogram = {};
  vision::Histogram counts;
  std::memcpy(counts.data(), record.count, sizeof record.count);
  vision::ForegroundMaskInput input;
  input.picture = picture.view<std::uint8_t>();
  input.motion = frame.motion.in(size, frame.size());
  input.still = frame.motion.still;
  input.current = current.view<std::uint8_t>();
  MappedPlane previous;
  if (previous_needed && record.previous) previous = read(frame.buffer, CERBERUS_PLANE_PREVIOUS_DIFFERENCE);
  if (previous.size() == size) input.previous = previous.view<std::uint8_t>();
  input.histogram = &counts;
  input.seconds = frame.seconds;
  input.frames = std::clamp(record.frames, 0, 3);

  MappedPlane mask = acquire(pool_, size);
  input.excluded = burnt_in_.boxes();
  const vision::ForegroundMaskResult result = area_->update(input, mask.writable<std::uint8_t>());
  news_.clear();
  if (learns_burnt_in_ && burnt_in_.update({input.picture, input.current, result.threshold, input.motion,
                                            input.still, input.seconds},
                                           mask.writable<std::uint8_t>())) {
    // A turning camera has written over the scene that the model learnt meanwhile.
    if (!input.still) area_->reset();
    const double sx = 1.0 * frame.size().width / size.width, sy = 1.0 * frame.size().height / size.height;
    for (const vision::Box& b : burnt_in_.boxes())
      news_.push_back({b.x * sx, b.y * sy, b.width * sx, b.height * sy});
  }
  mask.publish(frame.buffer, CERBERUS_PLANE_MASK);

  CerberusThreshold threshold{};
  threshold.threshold = static_cast<guint>(result.threshold);
  threshold.fuzzy_threshold = static_cast<guint>(result.fuzzy_threshold);
  threshold.noise = result.sigma;
  threshold.ready = result.ready;
  cerberus_buffer_add_threshold_meta(frame.buffer, &threshold);
  tell_how(frame.buffer, record);
  return true;
}

// In place, unless somebody else holds the histogram (a tee between the stages).
void MaskStage::tell_how(GstBuffer* buffer, HistogramRecord& record) {
  record.chosen = 1;
  record.weighting = static_cast<std::int32_t>(options_.threshold.weighting);
  record.extremes = static_cast<std::int32_t>(options_.threshold.extremes);
  record.order = options_.threshold.order;
  record.clip = options_.threshold.clip;
  MappedPlane plane = MappedPlane::take(buffer, CERBERUS_PLANE_HISTOGRAM);
  if (!plane) plane = acquire(histogram_pool_, {sizeof record / 4, 1}, 4);
  std::memcpy(plane.writable<std::uint32_t>().data, &record, sizeof record);
  plane.publish(buffer, CERBERUS_PLANE_HISTOGRAM);
}

bool RegionStage::run(Frame& frame) {
  if (!before_.ensure(frame)) return false;
  // Cleaned in place, unless somebody else looks at the uncleaned one (a tee between the stages).
  MappedPlane mask = MappedPlane::take(frame.buffer, CERBERUS_PLANE_MASK);
  if (!mask) {
    const MappedPlane found = read(frame.buffer, CERBERUS_PLANE_MASK);
    mask = acquire(mask_pool_, found.size());
    copy(found.view<std::uint8_t>(), mask.writable<std::uint8_t>());
  }
  const vision::Size size = mask.size();
  if (sequence_.broken_by(frame) || size != size_) finder_.reset();
  size_ = size;
  zones_.apply(mask.writable<std::uint8_t>());

  MappedPlane labels;
  if (frame.planes_wanted) labels = acquire(label_pool_, size, sizeof(std::uint16_t));
  const std::span<const vision::Region> regions = finder_.update(
      mask.writable<std::uint8_t>(), labels.writable<std::uint16_t>(), frame.motion.in(size, frame.size()));
  mask.publish(frame.buffer, CERBERUS_PLANE_MASK);
  labels.publish(frame.buffer, CERBERUS_PLANE_LABELS);

  const CerberusThresholdMeta* threshold = cerberus_buffer_get_threshold_meta(frame.buffer);
  const bool ready = !threshold || threshold->threshold.ready;
  cerberus_buffer_remove_regions(frame.buffer);
  if (ready) publish(frame, regions, size);
  mark_regions_known(frame.buffer);
  return true;
}

void leave_sight(const Frame& frame) {
  const auto left = [&](CerberusPlaneKind kind) {
    return frame.sight_wanted && (kind == CERBERUS_PLANE_LUMA || kind == CERBERUS_PLANE_MASK);
  };
  for (int kind = CERBERUS_PLANE_LUMA; kind <= CERBERUS_PLANE_LABELS; ++kind) {
    const auto k = static_cast<CerberusPlaneKind>(kind);
    if (!left(k)) drop(frame.buffer, k);
  }
}

void drop_sight(GstBuffer* buffer) {
  if (!cerberus_buffer_get_plane_meta(buffer, CERBERUS_PLANE_LABELS))
    cerberus_buffer_remove_plane_metas(buffer);
}

namespace {

constexpr char kRegionsKnown[] = "CerberusRegionsKnown";

bool register_mark() {
  // No tags: a fact that survives conversion, scaling and encoding with the regions.
  static const gchar* tags[] = {nullptr};
  return gst_meta_get_info(kRegionsKnown) != nullptr ||
         gst_meta_register_custom(kRegionsKnown, tags, nullptr, nullptr, nullptr) != nullptr;
}

}  // namespace

bool regions_known(GstBuffer* buffer) {
  static const bool registered = register_mark();
  return registered && gst_buffer_get_custom_meta(buffer, kRegionsKnown) != nullptr;
}

void mark_regions_known(GstBuffer* buffer) {
  if (!regions_known(buffer)) gst_buffer_add_custom_meta(buffer, kRegionsKnown);
}

void RegionStage::publish(Frame& frame, std::span<const vision::Region> regions, vision::Size analysis) {
  const double sx = static_cast<double>(frame.size().width) / analysis.width;
  const double sy = static_cast<double>(frame.size().height) / analysis.height;
  const vision::Lens lens(field_of_view_, frame.size());
  guint number = 0;
  for (const vision::Region& region : regions) {
    const vision::Box box{region.box.x * sx, region.box.y * sy, region.box.width * sx,
                          region.box.height * sy};
    if (!vision::passes(gate_, box,
                        lens.place(box, 0, frame.look ? frame.look->tilt : tilt_, mounting_height_)))
      continue;
    CerberusRegion out;
    cerberus_region_init(&out);
    out.id = number++;
    out.x = box.x;
    out.y = box.y;
    out.width = box.width;
    out.height = box.height;
    out.confidence = region.confidence;
    cerberus_buffer_add_region(frame.buffer, &out);
  }
}

}  // namespace cerberus::plugin
