// SPDX-License-Identifier: LGPL-2.1-or-later
#include "publish/streams/keyframe_requests.h"

namespace cerberus::publish {

bool KeyframeRequests::ask(Time now) {
  waiting_ = false;
  asked_ = true;
  last_request_ = now;
  return true;
}

bool KeyframeRequests::request(Time now) {
  if (asked_) return false;  // the keyframe that comes serves this receiver, too
  if (!last_request_ || now - *last_request_ >= parameters_.interval) return ask(now);
  waiting_ = true;
  return false;
}

bool KeyframeRequests::frame(Time now, bool keyframe) {
  if (keyframe) asked_ = waiting_ = false;
  if (waiting_ && now - *last_request_ >= parameters_.interval) return ask(now);
  if (asked_ && now - *last_request_ >= parameters_.patience) return ask(now);
  return false;
}

}  // namespace cerberus::publish
