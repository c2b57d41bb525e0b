// SPDX-License-Identifier: LGPL-2.1-or-later
// Draws the paper's figures 2 and 3, the choice of the threshold, for one frame.
#pragma once

#include "overlay/plane_view.h"
#include "vision/change/fuzzy_threshold.h"

namespace cerberus::overlay {

struct ThresholdFigure {
  const vision::Histogram* histogram = nullptr;  // of the registered difference
  vision::FuzzyThresholdCurves curves;
  int fuzzy_threshold = 0;  // the threshold chosen from the curves
  int threshold = -1;       // the one used, -1: not known
  double noise = 0;         // sigma, grey levels; 0: not known
};

// Fills a canvas of colours. Upper panel: the histogram (bars, logarithmic), the membership functions of object and
// background (Eq. 4, 5), the seed subsets; lower panel: the indices of fuzziness over the fuzzy region, the
// background's normalised (Eq. 8 to 10). The threshold is drawn in both. In small pictures, text that would not be
// readable is left out. Returns false if cairo fails.
bool draw_threshold_figure(const ThresholdFigure& figure, const Canvas& canvas);

}  // namespace cerberus::overlay
