// SPDX-License-Identifier: LGPL-2.1-or-later
// Tuned numbers of the estimate of the camera's motion (camera_motion.cpp).
//
// Where no origin stands it is unknown: kept from the first version. Guard of all: bench-camera_motion, bench-steady and
// tests/unit (camera_motion, camera_stands).
#pragma once

namespace cerberus::vision {

struct CameraMotionParameters {
  int least_side = 16;        // pixels: smaller pictures are not estimated
  int reference_age = 16;     // frames after which the reference of a still camera is renewed
  double noise_share = 0.1;   // of a frame's measured noise in the running mean
  double majority = 0.6;      // share of the patches that no other motion can outvote
  int hypotheses = 96;        // random ones on the coarsest level,
  int finer_hypotheses = 24;  // on the others, which start from its result, and random turns on the coarsest
  int goes_on = 50;           // frames: duration of a turn past a wall without texture

  // A cut. measured: 1440 pairs of unrelated real pictures, share.well at most .20, difference at least .77; 2309 pairs
  // of successive ones, share.well at least .32; half the picture replaced: share.well at least .26 in 95 of 100.
  double cut_share = 0.22;      // of the patches: fewer are well matched
  double cut_difference = 0.6;  // of the relief: the pictures as a whole differ by more
  double cut_contrast = 4;      // times less contrast than before, or more than a reference without texture

  // A camera that stands. Motions are pixels, RMS over the picture.
  double still_motion = 0.2;  // a still camera remains still below it,
  double least_motion = 0.1;  // and any camera stands below it
  double large_motion = 1;  // beyond it the support of no motion decides alone, and a turn bends the picture
  double certain_motion = 0.5;  // beyond it a motion that `nearly_all` patches follow is the camera's
  double nearly_all = 0.9;      // of the motion's support: no motion explains the samples as well,
                                // or a moving camera stops
  double worth = 12;            // unless its cost is so much higher, in unexplained costs

  // Parts of the picture (of MotionSamples::kRegions) that must follow.
  int few_parts = 5, many_parts = 8;
  int wide_columns = 3;  // of the four: a motion seen in as many adjacent columns is the camera's
  float wide = 0.25f;    // of the picture: a moving object as wide is seen in many parts
};

}  // namespace cerberus::vision
