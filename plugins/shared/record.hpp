// SPDX-License-Identifier: LGPL-2.1-or-later
// The record of a frame (vision::Analysis) on its buffer: one private meta that rides through tee and queue and is lost
// at the first element that makes a new picture; the few facts of it that survive one; and the query that asks for it.
#pragma once

#include <gst/gst.h>

#include "vision/analysis.h"

namespace cerberus::plugin {

// The record on `buffer`, if any.
vision::Record record_of(GstBuffer* buffer);
// The same; none where there is none, or where it is that of a frame of another size.
vision::Record record_of(GstBuffer* buffer, vision::Size frame);
// Attaches `record` in place of the one that is there; an empty one removes that. `buffer` is writable.
void set_record(GstBuffer* buffer, vision::Record record);

// How the moving area of a frame was found. True of the moment: it survives scaling, cropping and encoding.
struct ThresholdFacts {
  vision::ForegroundMaskResult result;
  vision::FuzzyThresholdOptions chosen_with;
  double gain = 1,
         offset = 0;  // the change of light that was taken out: F(k-1) counts as gain * F(k-1) + offset
};
// nullptr: no stage upstream chose a threshold. Lives as long as the buffer's meta.
const ThresholdFacts* threshold_facts_of(GstBuffer* buffer);
void set_threshold_facts(GstBuffer* buffer, const ThresholdFacts& facts);

// Queries what elements downstream need. Every such element adds its flag, in each branch of a tee; the query is therefore
// passed on, and its result is the flags, not the return value.
enum : guint {
  kRecordForTracks = 1,   // as it is, as far as the motiontrack that takes it off
  kRecordForReaders = 2,  // with D(k-1) and the labels
  kAllTracks = 4,         // no record, but the tracks that only motion supports: it judges them
};
guint ask_for_record(GstPad* srcpad);
bool is_record_query(GstQuery* query);
void add_wanted(GstQuery* query, guint wanted);

}  // namespace cerberus::plugin
