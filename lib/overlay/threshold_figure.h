// SPDX-License-Identifier: LGPL-2.1-or-later
// The paper's figures 2 and 3, drawn for one frame: how the threshold was chosen.
#pragma once

#include "overlay/plane_view.h"
#include "vision/change/fuzzy_threshold.h"

namespace cerberus::overlay {

struct ThresholdFigure {
  const vision::Histogram* histogram = nullptr;  // of the registered difference
  vision::FuzzyThresholdCurves curves;
  int fuzzy_threshold = 0;  // what the curves chose
  int threshold = -1;       // the one used, -1: not known
  double noise = 0;         // sigma, grey levels; 0: not known
};

// Fills a canvas of colours. Upper panel: the histogram (bars, logarithmic), the membership functions of object and
// background (Eq. 4, 5), the seed subsets; lower panel: the indices of fuzziness as the fuzzy region is walked through,
// the background's normalised (Eq. 8 to 10). The threshold stands in both. Small pictures keep what is readable. Returns
// false where cairo fails.
bool draw_threshold_figure(const ThresholdFigure& figure, const Canvas& canvas);

}  // namespace cerberus::overlay
