// SPDX-License-Identifier: LGPL-2.1-or-later
// What pirfusion's pads share: the sensors of its PIR pads (fusion::SensorInputs), and head and base by running time. PIR
// threads and upstream events write; the video's thread reads, and, between two frames of a live one, the PIR threads do.
#pragma once

#include <cerberus/cerberus.h>

#include <functional>
#include <string>
#include <vector>

#include "fusion/sensor_inputs.h"
#include "sensing/base_rates.h"

namespace cerberus::plugin {

using fusion::SensorSnapshot;
using fusion::Time;

// Whether this is the head of that name; an empty name is any.
bool is_named(const CerberusPose& pose, const std::string& head);

// The lock is never held while something is pushed, queried or
// posted, and no GStreamer object's lock is taken under it.
class Inputs : public fusion::SensorInputs {
 public:
  // ---- the thread that decides: the video's, or a PIR thread between two frames
  // Pan of the head of this name (empty: any) and base at `time`, sensors at `sensor_time`. The pose on `frame` has
  // priority over a pose event (by_event: they count), a base event over the base on `frame`: an application knows its
  // robot. Forgets what no later frame can ask for.
  SensorSnapshot at(Time time, Time sensor_time, const std::string& head, bool by_event, GstBuffer* frame);
  // Brings the snapshot of the frame of `frame_time` up to `sensor_time`: the sensors' readings; the pan by the newest
  // pose event, unless the frame carried a pose that is not older; the base's rate, where an event has reported it.
  void listen(Time sensor_time, Time frame_time, const std::string& head, SensorSnapshot& snapshot);

  // ---- upstream events
  void add_pose(const CerberusPose& pose);
  void add_other_head(const CerberusPose& pose);  // of another head than the one that counts
  void add_base(double degrees_a_second, double speed, Time from);  // NaN: not known

  // ---- PIR pads (those of pir_pad.hpp), in the order of their numbers
  // A new one with the number in `name`, or the next free one; nullptr when it is taken, or 16 or more. Floating.
  GstPad* add_pad(const char* name, GstPadTemplate* pad_template);
  void drop_pad(GstPad* pad);
  std::vector<GstPad*> pads();       // with a reference each
  void forget();                     // everything but the pads
  std::function<void()> on_reading;  // after each reading of a live source; set before there are pads

 private:
  sensing::Timeline<CerberusPose> poses_;
  sensing::BaseRates base_rates_, base_speeds_;
  const char* other_head_ = nullptr;
  Time taken_{};  // of the picture on the last frame
};

}  // namespace cerberus::plugin
