// SPDX-License-Identifier: LGPL-2.1-or-later
// The stages of detection in a row over one record: from a mapped frame to tracked regions.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "vision/analysis.h"
#include "vision/burnt_in/burnt_in.h"
#include "vision/change/own_motion_evidence.h"
#include "vision/detection/limits.h"
#include "vision/detection/regions.h"
#include "vision/duplicate_frames.h"
#include "vision/geometry/box_edge.h"
#include "vision/geometry/lens.h"
#include "vision/image/luma/luma.h"
#include "vision/image/luma/luma_stretch.h"
#include "vision/zones/zones.h"

namespace cerberus::vision {

struct DetectorParameters;  // detector_parameters.h

struct DetectorOptions {
  int analysis_width = 320;  // pixels; 0: the frame's own width
  CameraMotionOptions camera;
  DifferenceOptions differences;
  ForegroundMaskOptions foreground;
  bool burnt_in =
      false;  // learn what the camera writes into its pictures, and leave it out of the foreground
  RegionOptions regions;
  SizeLimits size;
  TrackOptions tracks;
  SpeedLimits speed;
  double field_of_view =
      0;  // horizontal, radians, of frames without their own; 0: unknown, and no limit in metres is judged
  double mounting_height = 0;  // of the lens above the floor, metres
  double tilt = 0;             // radians, for frames without a look
};

// Where the camera went since the previous frame, in frame pixels. The default is a camera that stands still.
struct CameraStep {
  Transform transform;
  bool still = true;
  // The same in analysis pixels. Standing still stays exactly the identity, whatever the rounding.
  Transform in(Size analysis, Size frame) const {
    return still ? Transform{} : transform.rescaled(frame, analysis);
  }
};

// What the stages need to know of a frame beside its record.
struct DetectorFrame {
  Size size;                 // pixels
  double seconds = 0;        // since the previous frame; 0: none, or not known
  bool fresh = true;         // the first frame of a scene: every stage forgets the past
  std::uint64_t number = 0;  // counts frames without holes: a stage that was idle for one begins anew
  CameraStep motion;
  struct Look {
    double pan = 0, tilt = 0;  // radians
  };
  std::optional<Look> look;  // of the camera when the frame was taken, if a head's pose gives it
  double field_of_view =
      0;  // horizontal, radians, as the head's zoom says; 0: as the options say; NaN: unknown zoom
  std::span<const Box> burnt_in;  // analysis pixels, as learnt by a later stage elsewhere: no scene
  bool everything = false;        // D(k-1) and the labels are made too: an element reads them
  bool persons =
      false;  // a person detector judges the tracks: those that only motion supports are published as well
  // otherwise: horizontal field of view of a frame of which no zoom is known, radians; 0: unknown.
  Lens lens(double otherwise) const { return {field_of_view > 0 ? field_of_view : otherwise, size}; }
};

// Each stage function writes its own field and needs those before it, except the camera: `frame.motion` holds its
// motion, whether it was measured here or elsewhere. Memory of a stage is allocated when it runs first; the steady
// state allocates nothing.
class Detector {
 public:
  void set_options(const DetectorOptions& options);
  // For sweeps; before the first frame. The options stay.
  void set_parameters(const DetectorParameters& parameters);
  Zones& zones() { return zones_; }
  // What the camera writes into its pictures, as far as it is learnt, analysis pixels.
  std::span<const Box> burnt_in() const { return burnt_in_.boxes(); }
  // Forgets all that was learnt of the scene.
  void reset();

  // A record of a frame of this size, without any field; with the luma of `picture`; with the fields of `record` before
  // `end`, sharing its pictures.
  Record blank(Size frame);
  Record begin(const LumaSource& picture, bool fresh = false);
  Record copy(const Analysis& record, Stage end);

  // Whether `record`, made by begin(), shows the picture of the last one again, so that no stage is to see it; asked
  // once for each picture. short_enough: as of DuplicateFrames.
  bool repeats(const Analysis& record, const DetectorFrame& frame, bool short_enough) {
    return duplicates_.repeats(*record.luma, !frame.fresh, short_enough);
  }

  // Writes `camera` and sets frame.motion to it; where a cut begins a new scene, frame.fresh too. prior: the motion
  // of the picture since the previous frame that follows from the head's poses, frame pixels.
  void measure_camera(Analysis& record, DetectorFrame& frame, const std::optional<Transform>& prior = {});
  void find_differences(Analysis& record, const DetectorFrame& frame);
  void find_foreground(Analysis& record, const DetectorFrame& frame);
  void find_regions(Analysis& record, const DetectorFrame& frame);
  // Whether a polygon of the world had no place in the last picture: no look or no field of view.
  bool zones_unplaced() const { return zones_.need_orientation() && !zones_placed_; }
  // regions: of the record, or found elsewhere; boxes in frame pixels. Tracks outside the limits of speed are left out.
  void track(Analysis& record, const DetectorFrame& frame, std::span<const Region> regions);
  // Whether tracks of the last frame were left out because their motion may be the scene's (OwnMotionEvidence).
  bool withholds_tracks() const { return withholds_; }

  // The stages after the camera, up to `last` and at most the regions, whose fields are absent.
  void complete(Analysis& record, const DetectorFrame& frame, Stage last);
  // All stages.
  void run(Analysis& record, DetectorFrame& frame, const std::optional<Transform>& prior = {});

  // Bytes held, records in use left out.
  std::size_t bytes() const;

 private:
  // Whether a stage sees every frame: true when `frame` does not follow the last one that it saw.
  class Sequence {
   public:
    bool broken_by(const DetectorFrame& frame) {
      const bool broken = frame.fresh || frame.number != next_;
      next_ = frame.number + 1;
      return broken;
    }

   private:
    std::uint64_t next_ = 0;
  };
  GrayPicture gray(Size size);

  DetectorOptions options_;
  LumaStretch stretch_;
  LumaScaler scaler_;
  DuplicateFrames duplicates_;
  CameraMotion camera_;
  std::optional<ThreeFrameDifference> differences_;
  std::optional<ForegroundMask> foreground_;
  BurntIn burnt_in_;
  RegionFinder regions_;
  Zones zones_;
  bool zones_placed_ = false;
  Tracker tracker_;
  SceneCalm calm_;
  OwnMotionEvidence own_motion_;
  std::vector<Box> tracked_;  // the tracks' boxes of the last frame
  bool withholds_ = false;
  BoxEdgeParameters edge_;
  ForegroundMechanisms mechanisms_;
  Size foreground_size_, regions_size_;
  Sequence differences_sequence_, foreground_sequence_, regions_sequence_;
  threads::Pool<Analysis> records_;
  threads::Pool<Image<std::uint8_t>> pictures_;
  threads::Pool<Image<std::uint16_t>> labels_;
};

}  // namespace cerberus::vision
