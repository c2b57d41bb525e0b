// SPDX-License-Identifier: LGPL-2.1-or-later
// The ONVIF driver, an emulated camera and the loop of the helper process between them.
#pragma once

#include <memory>

#include "drivers/onvif/onvif_head.h"
#include "heads/soup_client.h"
#include "support/onvif_camera.h"
#include "support/served_head.h"

namespace cerberus::tests {

inline drivers::OnvifOptions onvif_options(const OnvifCamera& camera) {
  drivers::OnvifOptions options;
  if (!drivers::onvif::parse_device(camera.device(), options.login.device).empty()) std::abort();
  options.mechanics.full_speed = {OnvifCamera::kPanSpeed, OnvifCamera::kTiltSpeed};
  options.absolute = false;
  return options;
}

// With the position range of the emulated camera, so that it has positions.
inline drivers::OnvifOptions onvif_options_with_range(const OnvifCamera& camera) {
  drivers::OnvifOptions options = onvif_options(camera);
  options.mechanics.least = drivers::onvif::Angles{-OnvifCamera::kPanEnd, -OnvifCamera::kTiltEnd};
  options.mechanics.most = drivers::onvif::Angles{OnvifCamera::kPanEnd, OnvifCamera::kTiltEnd};
  return options;
}

struct OnvifRig {
  drivers::OnvifHead head;
  ServedHead served;

  OnvifRig(drivers::OnvifOptions options, heads::SoupClientOptions soup = {}, const char* timeout = "5")
      : head(std::make_unique<heads::SoupClient>(std::move(soup)), std::move(options)),
        served(head, timeout) {}
  explicit OnvifRig(const OnvifCamera& camera) : OnvifRig(onvif_options(camera)) {}
};

}  // namespace cerberus::tests
