// SPDX-License-Identifier: LGPL-2.1-or-later
// Tuned numbers of one track: motion and size filters, validation gate, growth and appearance.
//
// S is the object's own length, max(width, height): a standing person is about 1.7 m, so that a walk of 1.4 m/s is
// 0.8 S a second at any distance and any picture size. Where no origin stands the value was chosen by hand on vtest.avi
// and davis_tennis. Guard of all of them, where no other stands: the boxes on vtest.avi and
// MOTA 70 on PETS09-S2L1.
#pragma once

namespace cerberus::vision {

struct TrackParameters {
  // Motion and size filters.
  double acceleration = 0.5 * 0.5;  // S^2/s^3. derived: people start, stop and turn within a second, 0.8 S/s
  // S^2/s^3, while the camera moves: it moves after what is fast, and registration and parallax add their own errors.
  // swept on otb_Skiing (.54 of the frames with 1, .62 with 2, .65 from 3 on) and davis_tennis (MOTA .80 instead of .83
  // from 5 on). Guard: bench-moving_window.
  double panned_acceleration = 3.0;
  // S/s. What is faster than this may change its velocity by as much more: its first velocity is known worse, and each
  // frame shows more of its way. derived: somebody who jogs, 12 km/h. swept: 1.5 to 4. Guard: unit
  // fast_object.
  double fast = 2.0;
  double birth_speed = 3.0;  // S/s, standard deviation of the unknown first velocity
  // S, standard deviation of a region's centre, and the way up and down in which an object is searched by its appearance:
  // small, as coats and legs are of one colour each.
  double position_noise = 0.05;
  double grain = 1.0 / 320;  // of the frame's width. derived: a pixel of the analysed picture, 320 wide
  double blob_noise = 6;     // times: variance of a position from a blob of another extent
  // Of the logarithm of an extent, standard deviation of a region's and of its change in a second. derived: a person's extent
  // changes by 15 % in a second.
  double size_noise = 0.15;
  double border_wander = 1.5 * 1.5;  // 1/s, of an extent that the picture's edge cuts
  // Times less that a shrinking extent counts for a standing object. swept: 1 to 20.
  double fade = 2.0;
  // s, time constant in which a track without region slows down, and in which the vertical velocity of one does that is found in
  // a group by its appearance, which determines height poorly. swept: .6 to 2.5. Guard: person 1 of
  // bench-in_window, who is lost with 1.
  double brake = 0.8;

  double same_extent = 1.5;  // times by which extents that agree differ at most
  // Heights. A region that only this track has, as high as the track, wider than it and narrower than this, is of the same
  // extent: a walker in mid-stride. Narrower again it is so by same_extent only: half of a person dissolves sooner than a
  // stride ends. derived: a stride is .43 of the height, a foot .15. swept: 0 to .75.
  double stride = 0.65;

  // Validation gate and pair cost.
  double gate_noise = 0.15;  // S that a place may be wrong by, beyond the filter's own variance
  double gate = 4.0;         // standard deviations
  // Of the track's area: a smaller region, or a smaller track, may be a fragment of it. Of the largest height that it had: what
  // the picture's left or right edge cuts to a smaller width is mostly outside, and unpublished. derived: half of the width of
  // a walking person. swept: MOTA on TUD-Campus is .21 without, .26 to .27 from .14 to .22.
  double fragment = 0.2;
  double fragment_gate = 1.5;  // standard deviations: a fragment lies where the track is expected
  double size_cost = 0.5;      // per unit of the logarithm
  double gate_cost = 0.1;      // per standard deviation

  // Picture's edge.
  double border = 0.1;       // S, distance that still counts as at the edge
  double cut_margin = 0.01;  // of the picture's side: a region this close to the edge is cut by it

  // Growth: what shows that an object moves although its centre does not.
  double end_speed = 1.0;  // S/s of an end of the box; a faster one reveals more of a partly seen object
  double upright = 1.3;    // height / width, at least, of an upright person

  // s for which something must last until it counts: a region of another extent until it replaces the track's, tracks in one
  // region until they are merged, standing until the object stops, and being occluded until the track is not published.
  // measured: by one value in place of .2, .25 and .4 s for persons, larger and smaller regions MOTA is .55 +- .35 and IDF1
  // .49 +- .20 higher. Guard: bench-development, bench-steady.
  double lasts = 0.3;
  // s of fitting regions from which on the extent is well known; time constant of the confidence.
  double extent_known = 0.5;
  // s for which a track has shared a group's region, or its own region was a group, and from which on it is of that kind. swept:
  // .3 to 1.4. And s of standing from which on the place is compared.
  double settled = 1.0;
  // s, the first of a track of kind `thing` that was not person-like for `settled`. swept: 0 to 1. Guard:
  // unit track_hypothesis.
  double thing_group = 0.2;

  // Standing.
  // S/s. derived: 0.5 m/s. The largest standard deviation, too, of the velocity of a track that goes off-screen: the filter's
  // is that of what a moving camera follows. swept: .1 to 100. Guard: the IDF1 of bench-moving_window.
  double stand_speed = 0.3;

  // Appearance model.
  double appearance_time = 2.0;  // s, time constant. derived: a person turns round within it
  int appearance_frames = 3;     // frames from which on the model counts

  // Position of a track within a group by its appearance.
  // S, standard deviation of that position; searched is so much beyond two standard deviations of the expected one.
  double found_noise = 0.1;

  double covered = 0.2;  // of a box that another track covers: it is not isolated, and may be behind that one
  // S that an object came, at least, which may stop or go off-screen, and that a fragment of a standing object moves before it
  // replaces the object.
  double travelled = 0.45;

  // Two tracks are two objects.
  double apart = 0.3;  // S that they have come apart at least
  // Appearance distance, and the most that it and the displacement of a place in a group cost together. measured: two persons
  // .36 in the median. swept: .25 to .45. Guard: bench-moving_people, unit coats.
  double different = 0.35;
};

}  // namespace cerberus::vision
