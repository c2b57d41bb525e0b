// SPDX-License-Identifier: LGPL-2.1-or-later
// Tuned numbers of the verification of tracks (person_verifier.cpp, look_schedule.cpp).
//
// Where a line names no origin: chosen by hand on TUD-Campus, TUD-Stadtmitte and PETS09-S2L1. docs/quality.md has the table
// of those that were varied. Guard of all: docs/quality.md, the rows "with personverify".
#pragma once

namespace cerberus::vision {

struct VerificationParameters {
  // Following a person from picture to picture. Shares of the person's box and height.
  double core_width = 0.6,
         core_height = 0.8;    // part of the box that is compared: the background is at its edges
  double reach = 0.06;         // farther than this from the prediction is not searched
  double reach_known = 0.015;  // the same of a person whose velocity is known; a pixel at least
  double whole = 0.99;         // share of a person that is in the picture: less, and the edge cuts it
  double inertia = 0.7;        // of the velocity that stays from one picture to the next
  // The first velocity: frames before and after the first look whose pictures are compared, 12 at most; at 5 frames a
  // second somebody who walks goes beyond `reach`, and none is found. Grey levels from which on a pixel counts as hidden,
  // by hand. swept: docs/quality.md, 0 and 4.
  int velocity_frames = 4;
  int hidden_difference = 30;
  // The person walks if the first velocity leaves less than this share of the difference of the pictures at rest. swept:
  // docs/quality.md, 0 to .95.
  double walking = 0.75;

  // Detections and persons. Intersections over unions.
  double same = 0.3;  // a detection is of the person. swept: docs/quality.md, .3 and .4
  // Logarithm of the heights' ratio up to which it may be: part_height, from where on the smaller is a part. swept:
  // docs/quality.md
  double same_height = 0.3;
  // The appearance (tracking/appearance_model.h) of a person, learnt at looks, against that of a detection: what differs
  // more than usual is taken off the intersection over union, what differs less is added. swept: docs/quality.md, weight .5
  // to 2, usual .15 to .3, gain .1 to .4, alone .05 to .3. Guard: IDF1 and switches on PETS09-S2L1 (bench-verified).
  double appearance_weight = 1;
  double usual_difference = 0.25;  // appearance distance
  double appearance_gain = 0.2;    // by which a look moves it
  double alone = 0.15;             // share of a detection that somebody else covers, up to which it is learnt
  double appearance_width =
      0.5;  // share of a box that is compared, with core_height: the background is at its edges
  int appearance_samples = 500;  // pixels that are read. Derived: as of a region (RegionAppearances)
  double bound = 0.5;            // a track is of the person,
  // and stays so down to this, below which it also replaces the box of the person whom it shows. swept: docs/quality.md,
  // .2 to .45.
  double unbound = 0.3;
  double unbound_whole =
      0.1;  // or this where the track is as high and wide as the person: that one was lost in the picture
  double agrees = 0.6;  // a look shows the person where the track is,
  int agreed = 3;       // and so often in a row before the person is drawn towards the track
  // Periods of the looks without one at the person: after more, the person is drawn towards the track as well. swept:
  // docs/quality.md, .6 to never.
  double unlooked = 1.2;
  // Natural logarithms of a track's height and width over a person's: more, and it is not this person alone.
  double alike_height = 0.2, alike_width = 0.4;
  double part =
      0.45;  // share of a smaller detection in a person, or in a person-like track: it is a part of it,
  double part_height = 0.75;  // if it is lower than this share of its height
  // The same share of a detection that is as high as people are there, and of one that would show a person who is known
  // while it lies in another. swept: docs/quality.md, .45 to .8 and .6 to .9.
  double part_fits = 0.65, part_another = 0.9;
  double absorbed = 0.6;  // the same share for a person who is known and whom a look does not show
  // Share of a person that a nearer one hides: then a look that does not show the person says nothing, up to
  // `covered_longest` s after the last one that did. swept: docs/quality.md, with and without.
  double covers = 0.5, covered_longest = 1;
  double on_track = 0.3;  // share of a detection that lies on tracks: else it is background
  // Share of the threshold. A detection below the threshold counts where it shows a person who is known, or one who is as
  // high as people are there. swept: docs/quality.md, .55 to 1.
  double weak = 0.6;
  double sure_at =
      1.3;  // times the threshold: one look is enough where only the picture changed. swept: docs/quality.md

  double place_gain = 0.7, size_gain = 0.4;  // of a detection, against the box that was followed
  double velocity_gain = 0.5;                // of the velocity between the last two detections
  double track_gain = 0.5;                   // of a track, each frame. swept: docs/quality.md, .3 and .5

  // The line of the heights (height_line.cpp). Shares of a person's height, but for the slope.
  double line_noise = 0.07;  // of a detection's height about the line. Measured: .05 of true boxes
  // Before anything is known, and its standard deviation: 1 is that of a camera as high as people are.
  double line_slope = 1, line_slope_spread = 1;
  int line_least = 6;           // samples: with fewer nothing is known
  double line_doubt = 0.1;      // standard deviation of the line: where it is larger nothing is known
  double line_tolerance = 0.2;  // logarithm of a height over the line's that a person may have

  // Evidence for a person, in detections.
  double most_evidence = 2;
  double longest = 3;          // s without a detection, where no track is bound,
  double longest_still = 0.6;  // and of one that never moved by `moved` widths: it may be background
  double moved = 0.4;

  double leaves = 0.4;  // share of a person that is in the picture: less, and it has left

  // Who was hidden and is found again. `hidden`: s after which it is somebody else. Asked.
  double hidden = 3;
  double hidden_reach = 0.3, hidden_speed = 0.3;  // heights, and heights a second, from where it would be
  double hidden_height = 0.25;                    // logarithm of the heights' ratio

  // A track that persons explain: shares of areas.
  double inside = 0.6;   // of a person that lies in the track
  double covered = 0.4;  // of the track that persons cover: it is replaced; less, and it is a group

  // Places that have changed (changed_places.cpp), where the camera stands. On the reduced picture.
  int change_frames = 6;  // back to the picture that is compared. Derived: people walk on by a cell
  // Frames that a scene has before its pictures are compared. Derived: somebody who walks moves by a third of a cell.
  int least_change_frames = 2;
  double least_change = 8;       // grey levels: mean difference of a cell,
  double change_over_noise = 3;  // and in means of the picture's middle cell
  double least_place = 0.12;     // of the picture's height: lower places are not looked at
  double place_doubt = 0.5;      // of a place, against a track that waits as long
  double most_waited = 4;        // s: doubt grows no more
  double stands = 0.5;           // pixels that a corner moves a frame, at most, where the camera stands
  double changed = 0.3;          // of a detection, where no track is: else it is background

  // Where to look. A look's region is scaled so that the lowest person who is looked for in it is `look_height` pixels high.
  double in_look = 0.8;  // share of a box that lies in a look's region: less, and the look says nothing of it
  double look_height = 85;  // Derived: 83 is the least that the Daimler detector sees
  double fine = 0.95;       // share of it, from which on a person is seen. swept: docs/quality.md, .7 to .95
  // Height of a person in a box that holds several, or things: a share of the box's. swept: docs/quality.md, .6 to .7.
  double in_group = 0.65;
  double side_margin =
      0.35;  // of the box's height, left and right: the detector's window is wider than a person
  double top_margin = 0.14;  // of the box's height, above and below
  // Pixels of a scaled look, all its regions together. Guard: a quarter of a core on PETS09-S2L1. swept: docs/quality.md,
  // 255e3 to 300e3.
  double most_area = 270e3;
  double least_height = 24;  // frame pixels: lower boxes are not looked at
  double most_scale = 4;     // by which a look is enlarged
  // Heights of a further box in the same look, in heights of the first. flattest swept: docs/quality.md, .45 to .6. Guard:
  // recall on TUD-Campus (bench-verified).
  double flattest = 0.45, steepest = 1.8;
};

}  // namespace cerberus::vision
