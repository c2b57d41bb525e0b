// SPDX-License-Identifier: LGPL-2.1-or-later
// Looks of a person detector on their way from `personverify` to a tracker downstream: a private meta on the frames at
// which a look begins and at which its result is there, and the query that asks for such a tracker.
#pragma once

#include <gst/gst.h>

#include <span>
#include <vector>

#include "vision/persons/person_detector.h"

namespace cerberus::plugin {

// What one frame says about looks. Both may be true of it: the result is that of an earlier look.
struct PersonLooks {
  guint begins = 0;  // number of the look that begins at this frame; 0: none
  // Number of the look whose result this is; 0: none. It is on later frames as well, until the next result is there:
  // frames may be dropped on their way.
  guint ends = 0;
  bool of_this_frame = false;  // the result is of a look that began and ended here; it has no number
  std::vector<vision::PersonDetection> bodies;  // of the result, as of vision::EvidenceLook: frame pixels
  bool encloses = false;                        // vision::EvidenceLook::encloses, of the result
  bool persons_only = false;                    // tracks that no look has shown are not published
};

// The looks on a frame; nullptr: no detector upstream leaves tracking to this frame's tracker. They live as long as the
// buffer's meta. They follow the picture through copying, converting and scaling, and are lost where it is cropped, as
// regions are; they do not leave the process.
const PersonLooks* person_looks_of(GstBuffer* buffer);
// Attaches them in place of those that are there. `buffer` is writable.
void set_person_looks(GstBuffer* buffer, const PersonLooks& looks);

// Whether a tracker downstream takes looks, in any branch of a tee.
bool tracker_takes_looks(GstPad* srcpad);
bool is_looks_query(GstQuery* query);
// Of such a tracker.
void accept_looks_query(GstQuery* query);

}  // namespace cerberus::plugin
