// SPDX-License-Identifier: LGPL-2.1-or-later
#include "window_settings.hpp"

namespace cerberus::plugin {
namespace {

constexpr int kMostPixels = 16384;

GType lockstep_type() {
  static const GEnumValue values[] = {{LOCKSTEP_AUTO, "In pipelines that are not live", "auto"},
                                      {LOCKSTEP_ON, "Every frame waits for its pose", "on"},
                                      {LOCKSTEP_OFF, "No frame waits", "off"},
                                      {0, nullptr, nullptr}};
  static const GType type = g_enum_register_static("CerberusVirtualPtzLockstep", values);
  return type;
}

const Property<WindowSettings> kProperties[] = {
    property("width", &WindowSettings::width, 0, kMostPixels,
             "Width of the window in pixels; 0 = what downstream takes, nearest to half the picture's"),
    property("height", &WindowSettings::height, 0, kMostPixels,
             "Height of the window in pixels; 0 = what downstream takes, nearest to half the picture's"),
    property("wide-fov", &WindowSettings::wide_fov, 1, 170,
             "Angle in degrees that the wide picture shows over its width"),
    property(
        "horizontal-fov", &WindowSettings::horizontal_fov, 0, 170,
        "Angle in degrees that the window shows over its width, at most the picture's; 0 = a pixel of the "
        "picture is a pixel of the window"),
    property(
        "start-pan", &WindowSettings::start_pan, -90, 90,
        "Pan of the window until the first pose comes, degrees, positive to the right (read when the element "
        "starts)"),
    property(
        "start-tilt", &WindowSettings::start_tilt, -90, 90,
        "Tilt of the window until the first pose comes, degrees, positive up (read when the element starts)"),
    property("inset", &WindowSettings::inset,
             "Attach to each frame a small picture of the whole scene with the window's place in it, for "
             "motionoverlay and sinks that draw overlays"),
    property("head", &WindowSettings::head, "Name of the head that moves the window; empty = any"),
    property("lockstep", &WindowSettings::lockstep, lockstep_type,
             "Whether a frame waits until the head's pose at its running time is known"),
    property(
        "lockstep-timeout", &WindowSettings::lockstep_timeout,
        "Nanoseconds of real time without any pose after which a waiting frame ends in an error; 0 = wait "
        "for ever"),
};

}  // namespace

std::span<const Property<WindowSettings>> window_properties() {
  return kProperties;
}

}  // namespace cerberus::plugin
