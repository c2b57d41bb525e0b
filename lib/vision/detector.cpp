// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/detector.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "vision/detector_parameters.h"

namespace cerberus::vision {

void Detector::set_options(const DetectorOptions& options) {
  options_ = options;
  if (!options.burnt_in) burnt_in_.reset();
  camera_.set_options(options.camera);
  if (differences_) differences_->set_options(options.differences);
  if (foreground_) foreground_->set_options(options.foreground);
  regions_.set_options(options.regions);
  tracker_.set_options(options.tracks);
}

void Detector::set_parameters(const DetectorParameters& parameters) {
  regions_.set_parameters(parameters.detection);
  tracker_.set_parameters(parameters.tracking);
  edge_ = parameters.edge;
  mechanisms_ = parameters.mechanisms;
}

void Detector::reset() {
  stretch_.reset();
  duplicates_.forget();
  camera_.reset();
  if (differences_) differences_->reset();
  if (foreground_) foreground_->reset();
  burnt_in_.reset();
  regions_.reset();
  tracker_.reset();
}

GrayPicture Detector::gray(Size size) {
  GrayPicture picture = pictures_.take();
  picture->resize(size);
  return picture;
}

Record Detector::blank(Size frame) {
  Record record = records_.take();
  record->frame = frame;
  return record;
}

Record Detector::begin(const LumaSource& picture, bool fresh) {
  if (fresh) stretch_.reset();
  const Size frame{picture.width, picture.height};
  Record record = blank(frame);
  GrayPicture luma = gray(vision::analysis_size(frame, options_.analysis_width));
  scaler_.scale(stretch_.stretched(picture), luma->view());
  record->luma.write() = std::move(luma);
  return record;
}

Record Detector::copy(const Analysis& record, Stage end) {
  Record own = records_.take();
  *own = record;
  // The regions stage may have taken the mask over; a second one begins with what the first has cleaned.
  if (end == Stage::regions && own->foreground && !own->foreground->mask && own->regions)
    own->foreground.stored().mask = own->regions->mask;
  own->clear_from(end);
  return own;
}

void Detector::measure_camera(Analysis& record, DetectorFrame& frame, const std::optional<Transform>& prior) {
  const Size size = (*record.luma)->size();
  if (frame.fresh) camera_.reset();
  CameraMotionResult& result = record.camera.write();
  result = camera_.update((*record.luma)->view(),
                          prior ? std::optional(prior->rescaled(frame.size, size)) : std::nullopt,
                          frame.burnt_in.empty() ? burnt_in_.boxes() : frame.burnt_in);
  result.transform = result.still ? Transform{} : result.transform.rescaled(size, frame.size);
  result.residual *= static_cast<double>(frame.size.width) / size.width;
  frame.motion = {result.transform, result.still};
  if (result.scene_age > 1 && frame.motion.transform.is_sane(frame.size)) return;
  frame.fresh = true;
  frame.seconds = 0;
  frame.motion = {};
}

void Detector::find_differences(Analysis& record, const DetectorFrame& frame) {
  if (!differences_) differences_.emplace().set_options(options_.differences);
  if (differences_sequence_.broken_by(frame)) differences_->reset();
  const GrayView luma = (*record.luma)->view();
  const bool previous = frame.everything || options_.foreground.area != Area::all;
  Differences& out = record.differences.write();
  out.blurred = options_.differences.blur > 1;
  out.current = gray(luma.size());
  if (previous) out.previous = gray(luma.size());
  if (!frame.motion.still) out.tolerant = gray(luma.size());
  const auto wanted = [](const GrayPicture& picture) {
    return picture ? picture->view() : MutableGrayView{};
  };
  out.result = differences_->update(luma, frame.motion.in(luma.size(), frame.size), out.current->view(),
                                    wanted(out.previous), wanted(out.tolerant), out.histogram);
}

void Detector::find_foreground(Analysis& record, const DetectorFrame& frame) {
  const GrayView luma = (*record.luma)->view();
  if (!foreground_) foreground_.emplace().set_options(options_.foreground);
  if (foreground_sequence_.broken_by(frame) || luma.size() != foreground_size_) {
    foreground_->reset();
    burnt_in_.reset();
  }
  foreground_size_ = luma.size();
  const Differences& differences = *record.differences;
  ForegroundMaskInput input;
  input.picture = luma;
  input.motion = frame.motion.in(luma.size(), frame.size);
  input.still = frame.motion.still;
  input.current = differences.current->view();
  if (options_.foreground.area != Area::all && differences.result.previous && differences.previous)
    input.previous = differences.previous->view();
  input.histogram = &differences.histogram;
  input.seconds = frame.seconds;
  input.frames = differences.result.frames;
  input.excluded = burnt_in_.boxes();
  input.mechanisms = mechanisms_;
  Foreground& out = record.foreground.write();
  out.blurred =
      differences.blurred || options_.foreground.background_model;  // which compares blurred pictures
  out.mask = gray(luma.size());
  out.result = foreground_->update(input, out.mask->view());
  out.chosen_with = options_.foreground.threshold;
  if (const GrayView background = foreground_->background(); !background.empty()) {
    out.background = gray(luma.size());
    for (int y = 0; y < luma.height; ++y)
      std::memcpy(out.background->view().row(y), background.row(y), static_cast<std::size_t>(luma.width));
  }
  if (!options_.burnt_in) return;
  const bool changed =
      burnt_in_.update({luma, input.current, out.result.threshold, input.motion, input.still, frame.seconds},
                       out.mask->view());
  // A turning camera has written over the scene that the background model learnt meanwhile.
  if (changed && !input.still) foreground_->reset();
  out.burnt_in = burnt_in_.found();
}

void Detector::find_regions(Analysis& record, const DetectorFrame& frame) {
  GrayPicture& foreground = record.foreground.stored().mask;
  const Size size = foreground->size();
  if (regions_sequence_.broken_by(frame) || size != regions_size_) regions_.reset();
  regions_size_ = size;
  FoundRegions& out = record.regions.write();
  if (foreground.is_sole()) {
    out.mask = std::move(foreground);
  } else {
    out.mask = gray(size);
    std::memcpy(out.mask->view().data, foreground->view().data, foreground->bytes());
  }
  const Lens lens = frame.lens(options_.field_of_view);
  std::optional<Zones::View> view;
  if (zones_.need_orientation() && frame.look && lens.known() && !std::isnan(frame.field_of_view))
    view = {{lens, frame.look->pan, frame.look->tilt}, frame.size};
  zones_placed_ = view.has_value();
  zones_.apply(out.mask->view(), view);
  if (frame.everything) {
    out.labels = labels_.take();
    out.labels->resize(size);
  }
  Change change;
  if (record.differences) change = {record.differences->current->view(), record.foreground->result.threshold};
  const std::span<const Region> found =
      regions_.update(out.mask->view(), out.labels ? out.labels->view() : View<std::uint16_t>{},
                      frame.motion.in(size, frame.size), change);
  out.regions.reserve(static_cast<std::size_t>(size.area() / 256) + 256);  // more than there are
  if (!record.foreground->result.ready) return;
  const double sx = static_cast<double>(frame.size.width) / size.width;
  const double sy = static_cast<double>(frame.size.height) / size.height;
  const double tilt = frame.look ? frame.look->tilt : options_.tilt;
  for (Region region : found) {
    region.box = {region.box.x * sx, region.box.y * sy, region.box.width * sx, region.box.height * sy};
    if (passes(options_.size, region.box, lens.place(region.box, 0, tilt, options_.mounting_height)))
      out.regions.push_back(region);
  }
}

void Detector::track(Analysis& record, const DetectorFrame& frame, std::span<const Region> regions) {
  if (frame.fresh) {
    tracker_.reset();
    calm_.reset();
    own_motion_.reset();
  } else if (record.camera) {
    calm_.add(record.camera->corners, frame.motion.transform, tracked_, frame.size, frame.seconds);
    record.camera.stored().calm = calm_.share();
  }
  GrayView difference;
  if (record.differences)
    difference =
        (record.differences->tolerant ? record.differences->tolerant : record.differences->current)->view();
  own_motion_.begin_frame(difference, calm_.share(), frame.seconds);
  tracked_.clear();
  withholds_ = false;
  const Lens lens = frame.lens(options_.field_of_view);
  std::optional<CameraOrientation> orientation;
  if (frame.look && lens.known()) orientation = {lens, frame.look->pan, frame.look->tilt};
  Sight sight{record.luma ? GrayView((*record.luma)->view()) : GrayView{}, record.mask()};
  if (record.foreground && record.foreground->background)
    sight.background = record.foreground->background->view();
  const double tilt = frame.look ? frame.look->tilt : options_.tilt;
  const auto in_difference = [&](const Box& box) -> Box {
    if (!record.differences) return box;
    const Size size = record.differences->current->size();
    const double sx = static_cast<double>(size.width) / frame.size.width;
    const double sy = static_cast<double>(size.height) / frame.size.height;
    return {box.x * sx, box.y * sy, box.width * sx, box.height * sy};
  };
  std::vector<Track>& out = record.tracks.write();
  for (Track track :
       tracker_.update(regions, frame.motion.transform, frame.seconds, frame.size, orientation, sight)) {
    const Placement place = lens.place(track.box, 0, tilt, options_.mounting_height);
    if (!passes(options_.speed, std::hypot(track.vx, track.vy), track.top_speed, place)) continue;
    if (record.luma && record.foreground && record.foreground->blurred) {
      const double pixel = static_cast<double>(frame.size.width) / (*record.luma)->size().width;
      track.box = without_edge(track.box, pixel, frame.size, edge_);
    }
    track.bearing = place.bearing;
    track.distance = place.distance;
    tracked_.push_back(track.box);
    const bool moves =
        own_motion_.supports(track.id, in_difference(track.box), track.state == TrackState::seen);
    if (moves || frame.persons)
      out.push_back(track);
    else
      withholds_ = true;
  }
}

void Detector::complete(Analysis& record, const DetectorFrame& frame, Stage last) {
  if (last >= Stage::differences && !record.differences && !record.foreground && !record.regions)
    find_differences(record, frame);
  if (last >= Stage::foreground && !record.foreground && !record.regions) find_foreground(record, frame);
  if (last >= Stage::regions && !record.regions) find_regions(record, frame);
}

void Detector::run(Analysis& record, DetectorFrame& frame, const std::optional<Transform>& prior) {
  measure_camera(record, frame, prior);
  complete(record, frame, Stage::regions);
  track(record, frame, record.regions->regions);
}

std::size_t Detector::bytes() const {
  const auto pixels = [](const auto& image) { return image.bytes(); };
  return scaler_.bytes() + camera_.bytes() + (differences_ ? differences_->bytes() : 0) +
         (foreground_ ? foreground_->bytes() : 0) + regions_.bytes() +
         (options_.burnt_in ? burnt_in_.bytes() : 0) + pictures_.bytes(pixels) + labels_.bytes(pixels) +
         records_.bytes(
             [](const Analysis& r) { return r.bytes() - threads::Pool<Analysis>::object_bytes(); });
}

}  // namespace cerberus::vision
