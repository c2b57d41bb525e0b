// SPDX-License-Identifier: LGPL-2.1-or-later
// Tuned numbers of the way from components to regions (regions.cpp).
//
// Where no origin stands the value was chosen by hand on vtest.avi. Guard of all: tests/unit/regions and the boxes on
// vtest.avi.
#pragma once

#include "vision/detection/blob_parting.h"
#include "vision/detection/height_prior.h"
#include "vision/detection/outline.h"
#include "vision/detection/people.h"
#include "vision/detection/person_box.h"
#include "vision/detection/two_frame_confirmation.h"
#include "vision/detection/walking_bodies.h"

namespace cerberus::vision {

struct RegionParameters {
  double least_share = 4e-4;  // of the picture: smaller blobs are noise (31 pixels of 320x240)

  // One person by itself.
  double narrowest = 4.5;     // height / width of a person: a narrower component is a pole or an edge,
  double widest = 1.6;        // a wider one is a group or a fragment
  double least_filled = 0.4;  // of its box that is foreground
  double tallest = 2.2;       // heights of a person: a taller component is something else
  double usual_least = 0.8,
         usual_most = 1.2;  // heights of a person by the prior: so high is one whole person

  // Samples of the height prior. Lengths in heights of the component.
  double alone = 0.4;  // distance to the next component

  // Pieces of one person. In expected heights.
  double across = 0.1;  // gap from side to side
  double down = 0.4;    // gap from top to bottom
  double joined = 1.6;  // height of both together, at most

  // Blobs before the height of people is known.
  int least_unknown =
      40;  // pixels: bodies are looked for in a blob of this height. derived: a head has 5 pixels
  // Heights that a blob which looks like one person has walked before it is a sample of the height prior, and a body, its
  // head free all the way, before it is published. measured: with .1 recall at IoU .5 is 2.3 points lower, MOTA .1 higher,
  // IDF1 .4 lower (development sequences, three widths). Guard: unit places, steady.
  double walked = 0.15;
  // Share of a body's foreground that differs from the frame before, at least, where it goes somewhere: bodies are found here
  // and there in the place that somebody has left. 25 frames a second. swept: 0 to .1. Guard: unit steady,
  // where that place is a region for a frame with 0.
  double stirs = 0.03;
  // Share of a blob's foreground that its only body leaves unexplained and from which on the blob is a group. measured:
  // MOTA on TUD-Campus and TUD-Stadtmitte is .01 and .02 lower without; with .4 that on davis_tennis is .27 lower.
  double beside = 0.5;

  // What persons explain.
  // Share of a blob's foreground that one person may leave unexplained, where the blob is no higher than a person.
  // Beyond it he does not stand upright (a lunging player), and the blob's box is his.
  double loose = 0.15;
  // Share of the height of a blob that is as high and as slender as one person, below its only body: more, and the blob's
  // own box counts, as feet that far down are beyond what fit_box searches (PersonBoxParameters::foot_fall). swept:
  // .05 to .13.
  double feet = 0.1;
  // Heights around a person's box that it explains as well. swept: .06 to .12.
  double slack = 0.08;
  double explained = 0.4;  // of a component's box that persons cover: it is theirs

  double same_block = 0.5;  // intersection over union of two blocks, a frame apart, that are the same

  // A young scene.
  int young = 60;  // frames in which the first objects may still be part of the background model
  double rim = 2;  // pixels at 320 columns by which a box is larger than its moving pixels in that time

  // Confidence of a box rises with its filled share: from this value to 1 of one whole person, and from 0 to this value
  // of any other component.
  double confidence = 0.45;
};

// All tuned numbers from the mask to regions.
struct DetectionParameters {
  BlobParting::Parameters parting;
  RegionParameters regions;
  PeopleFinder::Parameters people;
  HeightPrior::Parameters height;
  OutlineFinder::Parameters outline;
  PersonBoxParameters box;
  FreeHeadParameters head;
  WalkingBodies::Parameters bodies;
  TwoFrameConfirmation::Parameters confirmation;
};

}  // namespace cerberus::vision
