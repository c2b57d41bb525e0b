// SPDX-License-Identifier: LGPL-2.1-or-later
// Tuned numbers of EvidenceTracker. Where no origin stands a number is the trial's: chosen by the mean of eight sequences.
// Guard of all of them: the means that bench-development judges with a people detector.
//
// h is the height of the track's box; scores are those of EvidenceLook.
#pragma once

#include "vision/persons/body_boxes.h"

namespace cerberus::vision {

struct EvidenceParameters {
  double sure = 0.5;  // score of a body that begins a track, see EvidenceLook
  // Evidence of a look: score - neutral, at least `least`; before the track has moved, score - unmoved.
  // measured: quartiles of the score are .3 to 3.1 of people and -.1 to .6 of what is none. swept on all development
  // sequences: unmoved .4, .7, 1 give a MOTA of .51, .53, .53, and 19, 16, 16 identities a minute with nobody.
  double neutral = 0.4, unmoved = 0.7;
  double least = -0.3;  // a box with less is not even that of a known track
  // That a look takes from a track which it does not show, and from one that it finds at rest in a calm scene. swept: with .4 a
  // recall of one labelled object of .381 (HOG) and .473 (a network), with .5 of .376 and .464.
  double against = 0.4;
  // That a look which does not show a track takes from the evidence that it is a person, to which a sure one adds its score.
  // chosen: a person is found in half of the looks, and what one look at the threshold shows is none after five. measured: .5
  // costs 8 points of MOTA with require=person. Guard: unit evidence_tracker.
  double missed_person = 0.1;
  double moving = 1.2;  // evidence a second, of own motion inside the box
  // A motion track at the same place leaves no doubt: the ceiling.
  double publish = 1.5, ceiling = 3;

  // Intersection over union of a track and its observation, at least; share of the smaller of a motion track and another track
  // from which on it begins none.
  double gate = 0.25;
  // The same, from which on a track takes over the box of a motion track; `leave` where windows are looked at before a camera that
  // stands, as they have one shape for all: the means are the same without, and TUD-Campus' boxes 17 % too narrow instead of 7.
  // swept with HOG: .4 / .6 / .7 / .8 give -.6 / -.3 / 0 / -.3 of MOTA, -1.9 / -.9 / 0 / .6 of the recall of one labelled object;
  // of a network .4 / .7 / .8 .653 / .662 / .662 of MOTA.
  double adopt = 0.7;
  // Before a camera that moves it gives that up below this overlap with a body that a look encloses (0 / .4 / .5 / .6: .66 / .69 /
  // .69 / .63 of MOTA), or where it has less than this share of the area of a window's body which it lies in (without that
  // .383 instead of .406 of the recall of one labelled object).
  double leave = 0.5;
  // The same where the camera stands, and so many looks in a row have shown that. swept: with 3 PETS loses .4 points of MOTA, as
  // windows are larger than small people, with 4 and 5 nothing; who approaches has a recall of .84 instead of .78 in bench-patrol.
  int piece_looks = 4;
  BodyBoxParameters body;

  // Standard deviations: of a look's place, h, and of the logarithm of its height; and by how much both drift in the square root
  // of a second. swept: place .04 to .08 are within 3 points of each other, drifts of their own for a track that the picture
  // does not show and for its height within .4.
  double place = 0.05, height = 0.10, drift = 0.08;
  double velocity_time = 0.2;  // s, of the mean of the velocity

  // Share of calm from which on motion regions are believed. measured: where they are right the share is .84 to 1, in
  // shaken rooms .3 to .7.
  double calm = 0.8;
  // Share of a box's pixels that have changed from which on its inside moves; where the scene is not calm, more than around
  // it, too.
  double inside = 0.05;
  int changed = 12;  // grey levels
  // h that a track goes within a second before it counts as moved; what no look has shown is published from then on.
  // Without that 1.9 identities a minute with nobody instead of .9.
  double travel = 0.25;
  // s within which a track that motion does not show goes less than `travel`: then it is stopped. derived: a person at .2 m/s
  // is not. Guard: unit evidence_tracker.
  double stopped = 2;
  // s: a motion track whose inside has moved more than what is around it for as long is published before a camera that moves,
  // seen by a look or not. swept: .15, .3, .6 give -.6, 0, -.3 of MOTA, .6, 0, -2.1 of the recall of one labelled object. That
  // it must also be fast, .3 h/s, changed the means by .2 at most.
  // The camera counts as still once it has stood as long. swept for that: .05 to 3 give the same means; a single frame costs .8
  // of MOTA and 4.5 identities a minute.
  double moving_time = 0.3;
  // Share of a group's box that the persons in it fill from which on they stand for it: less, and it is a vehicle with
  // somebody before it. swept: .1, .2, .3 give .003, .013, .016 more recall of one labelled object than any share.
  double filled = 0.3;

  // s without an observation, and times from look to look, for which a track is published: the longer. derived: one look may
  // miss it.
  double shown = 1, looks_shown = 1.5;
  double least_visible = 0.4;  // of the box inside the picture
  double least_height = 8;     // pixels of the reduced picture

  // Of two tracks of one body the better one stays: mean, with this gain a look, of the scores of looks; where a look does not
  // show it, of 1 while motion does, else of 0.
  double quality_gain = 0.3;
};

}  // namespace cerberus::vision
