// SPDX-License-Identifier: LGPL-2.1-or-later
// An element of detection: runs vision::Detector's stages from `first` to `last` on the record of each frame. Missing
// fields of the record before `first` are computed with the defaults; the results are attached to the buffer.
#pragma once

#include <cerberus/cerberus.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "analysis_element.hpp"
#include "detect_settings.hpp"
#include "elements.hpp"
#include "head_motion_monitor.hpp"
#include "motion_watch.hpp"
#include "settings_conflict.hpp"
#include "shared/camera_path.hpp"
#include "shared/evidence_regions.hpp"
#include "shared/foreign_boxes.hpp"
#include "shared/record.hpp"
#include "shared/stamps.hpp"
#include "vision/detector.h"
#include "vision/persons/look_times.h"

namespace cerberus::plugin {

class Detection : public Analyser {
 public:
  Detection(vision::Stage first, vision::Stage last) : first_(first), last_(last) {}
  CerberusAnalysis* base = nullptr;

  std::string settings_fault() const override { return vision::Zones().parse(snapshot().zones); }
  bool start() override;
  void stop() override;
  Outcome analyse(Frame& frame) override;
  void repeat(Frame& frame) override;
  void play(bool plays) override { watch_.play(plays); }
  void flush(bool begins) override;
  void new_caps() override;
  void end_of_stream() override;
  void upstream_event(GstEvent* event) override;
  bool measures_camera() const override { return has(vision::Stage::camera); }
  bool answer(GstQuery* query) override;
  bool take_looks() override;

 protected:
  virtual DetectSettings snapshot() const = 0;
  virtual std::optional<DetectSettings> changes() = 0;
  virtual void refresh() = 0;

 private:
  // What is learnt of a stream, from start to stop.
  struct State {
    vision::Detector detector;
    DetectSettings settings;
    vision::DetectorOptions options;
    vision::CameraPath path;
    std::vector<vision::Region> found;              // by another element upstream
    std::vector<CerberusRegion> moving, published;  // of what moves; attached
    EvidenceRegions evidence;                       // of both witnesses
    PersonLooks looks;                              // of a person detector upstream: of the last frame
    std::vector<ForeignBox> boxes;                  // that other elements have found, of the last frame
    bool boxes_taken = false;             // of the last picture, the copies of which have them again
    vision::LookTimes look_times;         // of those of persons
    bool has_looks = false;               // there has been one, and not too long ago
    double since_looks = 0;               // s without looks and boxes
    int strange_boxes = 0;                // frames with boxes of other elements, of which none is a person's
    int frames_unlooked = 0;              // in a row, while looks should come
    bool judges = false, judged = false;  // by it, tracks of what moves; those of the last frame
    vision::LumaStretch stretch;          // of pictures that no stage has reduced
    CerberusCameraMotion motion{};        // of the last picture
    std::optional<double> calm;           // likewise, where this element knows it
    std::optional<ThresholdFacts> facts;  // likewise
    std::optional<std::vector<vision::Box>> sent_burnt_in;  // upstream; none: nothing yet
    double repeated = 0;                                    // seconds for which it has been repeated
    GstClockTime shown = GST_CLOCK_TIME_NONE;               // running time of the last frame, repeated or not
    Stamps stamps;
    std::string zones;                                // as last read
    std::shared_ptr<const vision::Zones> zones_read;  // the same; nullptr: everywhere
    NothingFound no_regions, no_tracks, no_places;
    double withheld = 0;       // seconds for which tracks were left out
    int unplaced = 0;          // frames in a row in which zones of the world have no place
    vision::Size frame, mask;  // for which no_regions was judged last
    bool nowhere = false, judge = true;
  };

  guint wants(const DetectSettings& settings) const;
  bool has(vision::Stage stage) const { return first_ <= stage && stage <= last_; }
  void apply(const DetectSettings& settings);
  std::string read_zones(const std::string& text);
  vision::Record obtain(const Frame& frame, bool regions_known);
  void measure_camera(vision::Analysis& record, Frame& frame);
  void publish_burnt_in(const vision::Analysis& record);
  void publish_threshold(GstBuffer* buffer, const vision::Analysis& record);
  void publish_regions(GstBuffer* buffer, const vision::Analysis& record);
  void publish_tracks(const Frame& frame, const vision::Analysis& record);
  void read_looks(Frame& frame, double step);
  void read_boxes(const Frame& frame, double step);
  void complain_of_labels(bool person);
  void complain_of_lost_looks(bool lost);
  void forget_looks();
  double step_of(const Frame& frame) const;
  void publish(const Frame& frame, const vision::LumaSource& luma, double step);
  void attach_published(GstBuffer* buffer);
  void read_regions(GstBuffer* buffer);
  void judge_regions(vision::Size frame, vision::Size mask);
  std::string why_no_regions(vision::Size frame, vision::Size mask);
  std::string why_no_tracks() const;
  void watch(const Frame& frame, double step);
  void publish_calm(GstBuffer* buffer) const;
  void complain_of_scene(double seconds);

  const vision::Stage first_, last_;
  std::optional<State> state_;
  std::mutex burnt_in_lock_;
  vision::BurntInBoxes burnt_in_;  // from an element downstream, in any thread
  vision::Size burnt_in_size_;     // of the picture in whose pixels they are
  HeadMotionMonitor carrier_;      // receives poses in any thread, so not part of the state
  Answer<guint> answer_;
  MotionWatch watch_;
  std::atomic<bool> looks_promised_ = false;  // by a person detector upstream
};

template <vision::Stage kFirst, vision::Stage kLast = kFirst, typename Settings = Adjustable<DetectSettings>>
struct StageElement final : Detection {
  StageElement() : Detection(kFirst, kLast) {}
  Settings settings;

 protected:
  DetectSettings snapshot() const override { return settings.snapshot(); }
  std::optional<DetectSettings> changes() override { return settings.changes(); }
  void refresh() override { settings.refresh(); }
};

}  // namespace cerberus::plugin
