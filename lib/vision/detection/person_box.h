// SPDX-License-Identifier: LGPL-2.1-or-later
// From a person as the finder explains it to the box around its pixels.
#pragma once

#include <cstddef>
#include <span>

#include "vision/detection/change.h"
#include "vision/detection/person.h"
#include "vision/image/mask.h"

namespace cerberus::vision {

// Lengths in heights of the person. Where no origin stands the value was chosen by hand on vtest.avi and TUD-Campus.
// Guard: tests/unit/person_box, MOTA on PETS09-S2L1 (bench-quality), the width on four sequences (bench-development).
struct PersonBoxParameters {
  // Width. measured: median .36 on PETS09-S2L1, .37 on TUD-Campus, .31 on TUD-Stadtmitte.
  double aspect = 0.345;
  // Weight of the foreground's edges against the expected ones. swept: .6 to .75.
  double measured = 0.72;
  // Sides. A column belongs to the person where at least `column` of a height is foreground between `below_head` and
  // `above_feet`: an outstretched hand and the shadow around the feet do not. swept: .18 to .22.
  double reach = 0.32;  // from the axis
  double column = 0.21, below_head = 0.05, above_feet = 0.85;
  // Shares of the foreground that differ from the frame before. Outermost columns are left out where less than `rests` of
  // theirs does and at least `changes` of all columns' does: they are the place that a walker has left. swept:
  // 0 to .4 and 0 to .2.
  double rests = 0.27, changes = 0.1;
  double trunk = 0.1;  // from the axis: these columns are his. swept: .06 to .12
  // Head: the first row of at least head_row foreground within head_reach of the axis.
  double head_reach = 0.1, head_row = 0.05;
  // Searched above and below the expected row. swept: .15 and .25.
  double head_rise = 0.12, head_fall = 0.25;
  // Feet: the last row of at least foot_row foreground within leg_reach of the axis.
  double leg_reach = 0.2, foot_row = 0.04;
  double foot_fall = 0.1;  // searched below the expected row
  // Shadow: rows from shadow_from on with more foreground within shadow_reach of the axis than shadow_wide times the
  // legs' median, which is that of the rows legs_from to legs_to. Its lowest rows, shadow_tip, may be narrow again.
  double shadow_reach = 0.25;
  double legs_from = 0.5, legs_to = 0.8;
  double shadow_wide = 1.35;  // times
  double shadow_from = 0.7, shadow_tip = 0.12;
};

// How a head that nothing hides shows: foreground in the core, background beside it.
struct FreeHeadParameters {
  // Rows and columns, in heights of the person: derived, as the body's parts of PeopleFinder.
  double rows = 0.13, core = 0.065;
  double beside_from = 0.085,
         beside_to = 0.19;  // from the axis, on both sides: where a neighbour's trunk would be
  // Shares of foreground. measured: of the bodies that explain blobs of unknown height on TUD-Campus, TUD-Stadtmitte and
  // highway (cars) .81, .39 and 0 are people; these limits keep .59, .24 and .01 of them, of which .91, .75 and 0 are.
  double least_core = 0.5;
  double most_beside = 0.25;
};

// Returns whether the head of a body of this height and axis stands out of the foreground: a wall of people without heads
// cannot be distinguished from a car. moving: foreground, analysis pixels.
bool has_free_head(BitView moving, Size picture, const Box& body, const FreeHeadParameters& parameters = {});

// The box of person `self` of `all`. Sides, head and feet are those of the foreground that is nearer to this axis than to
// any other person's, blended with those expected from its height by the weight `measured`. A shadow on the floor lies
// around the feet: the feet are placed in its middle. moving: foreground, analysis pixels, read in the window only. change:
// between this frame and the one before; where it is not known no column rests.
Box fit_box(BitView moving, const Change& change, const Bounds& window, std::size_t self,
            std::span<const Person> all, const PersonBoxParameters& parameters = {});

}  // namespace cerberus::vision
