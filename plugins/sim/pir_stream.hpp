// SPDX-License-Identifier: LGPL-2.1-or-later
// The readings of a simulated robot's PIR sensors: a source with a thread of its own beside the video's, because
// pirfusion lets each of both wait for the other. It gives what pirsrc gives, and a GAP event behind each step of time,
// after which nothing more comes of the time before.
#pragma once

#include <cerberus/pir.h>
#include <gst/gst.h>

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "drivers/sensor/sensor_array.h"

namespace cerberus::plugin {

class PirStream {
 public:
  using Time = sensing::Time;
  // What happened until a time: edges of the sensors' lines, and how the robot moved.
  struct Step {
    Time until{};
    std::vector<drivers::SensorEdge> edges;
    sensing::BodyMotion motion;
  };

  // element: posts the messages.
  explicit PirStream(GstElement* element) : element_(element) {}
  // Becomes the source's pad `src`; once.
  void add_pad(GstElement* source, GstPadTemplate* pad_template);

  // ---- the video's thread, or while it does not run
  // range: metres, for the caps.
  void begin(const CerberusPirInfo& info, double range, const sensing::PirOptions& options, Time heartbeat,
             const std::string& camera_name);
  void advance(Step step);
  void end();

 private:
  static gboolean activate(GstPad* pad, GstObject* parent, GstPadMode mode, gboolean active);
  static gboolean query(GstPad* pad, GstObject* parent, GstQuery* query);
  void run();
  void announce();
  bool take(const Step& step);
  bool push(const drivers::SensorReading& reading);

  GstElement* element_;
  GstPad* pad_ = nullptr;

  std::mutex lock_;
  std::condition_variable news_;
  std::deque<Step> steps_;  // to come
  bool begun_ = false;      // from begin() until the pad is inactive
  bool ended_ = false, flushing_ = true;

  // The pad's thread, and begin().
  CerberusPirInfo info_{};
  double range_ = 0;
  std::string camera_name_;
  drivers::SensorArray sensors_;
  std::vector<drivers::SensorEdge>* edges_ = nullptr;  // that the sensors read
  GstSegment segment_{};
  Time until_{};
  bool announced_ = false, unwanted_ = false;
};

// The source that has the stream's pad. Floating.
GstElement* pir_source_new(std::shared_ptr<PirStream> stream);

}  // namespace cerberus::plugin
