// SPDX-License-Identifier: LGPL-2.1-or-later
// A frame of a stream that is not live waits until the motion of the head that turns its camera is known, so that every
// run gives the same.
#pragma once

#include <gst/gst.h>

#include <string>

#include "motion/frame_times.h"
#include "motion/pose_feed.h"

namespace cerberus::plugin {

enum Lockstep { LOCKSTEP_AUTO, LOCKSTEP_ON, LOCKSTEP_OFF };

struct HeadWait {
  GstElement* element;
  GstPad* src;  // GAP events go here
  const GstSegment& segment;
  motion::PoseFeed& feed;
  const motion::FrameTimes& times;  // of the frames before
  const std::string& head;          // its name, for the error
  GstClockTime timeout;             // of real time; 0: none
};

// Until the head's motion is known up to the running time `time` of the frame stamped `pts`. Posts the error if no pose
// comes.
GstFlowReturn wait_for_head(const HeadWait& wait, GstClockTime pts, motion::Time time);

}  // namespace cerberus::plugin
