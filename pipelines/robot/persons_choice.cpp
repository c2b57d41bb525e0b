// SPDX-License-Identifier: LGPL-2.1-or-later
#include "persons_choice.h"

#include <gst/gst.h>

#include <algorithm>

namespace cerberus::robot {

namespace {

// Settings of the detection that a people detector would pass over, or that ask for other things than people; empty: none.
std::string contradiction(const Properties& detection) {
  for (const Property& one : detection)
    if ((one.name == "preset" && one.value != "default") || (one.name == "people" && one.value == "false"))
      return one.name;
  return {};
}

}  // namespace

void choose_persons(Settings& settings) {
  g_autoptr(GstElementFactory) factory = gst_element_factory_find("personverify");
  bool lacks = false;
  for (CameraSettings& camera : settings.cameras) {
    PersonsUse& use = camera.persons.use;
    if (use != PersonsUse::automatic) continue;
    use = PersonsUse::never;
    if (camera.source.kind == SourceKind::test) continue;  // nobody is in a drawn picture
    if (const std::string why = contradiction(camera.detection); !why.empty()) {
      g_printerr(
          "cerberusd: %s: \"%s\" of [camera.detection] is for what moves: people are found by motion alone; "
          "with a table "
          "[camera.persons] also by their shape\n",
          camera.name.c_str(), why.c_str());
    } else if (factory == nullptr) {
      lacks = true;
    } else {
      use = PersonsUse::always;
    }
  }
  if (lacks)
    g_printerr(
        "cerberusd: GStreamer's personverify is not installed: people are found by motion alone (it is built "
        "where "
        "libopencv-objdetect-dev and libopencv-dnn-dev are)\n");
}

}  // namespace cerberus::robot
