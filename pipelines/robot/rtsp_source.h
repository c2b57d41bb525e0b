// SPDX-License-Identifier: LGPL-2.1-or-later
// What a camera's rtspsrc is offered and takes, and what its errors mean.
#pragma once

#include <gst/gst.h>

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "robot/settings.h"
#include "robot/source/rtsp_fault.h"

namespace cerberus::robot {

class RtspSource {
 public:
  // Takes the video of this codec alone: nothing else is asked of the camera.
  void watch(GstElement* rtspsrc, Codec codec);
  // Says why: `done` is called once, at once or, where a connection must be tried, from the main loop within 5 s. It must
  // be safe to call for as long as the main loop runs.
  void diagnose(const SourceSettings& source, const std::string& uri, const GError* error, const gchar* debug,
                std::function<void(const std::string&)> done) const;

 private:
  // Filled by a streaming thread, which may outlast this object.
  struct Offer {
    std::mutex lock;
    std::string encoding;
    std::vector<RtspStream> streams;
  };
  std::shared_ptr<Offer> offer_ = std::make_shared<Offer>();
};

}  // namespace cerberus::robot
