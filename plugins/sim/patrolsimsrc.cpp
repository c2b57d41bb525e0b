// SPDX-License-Identifier: LGPL-2.1-or-later
/**
 * SECTION:element-patrolsimsrc
 * @title: patrolsimsrc
 * @short_description: a simulated robot on patrol through a house with people
 * @see_also: virtualptz, pirsrc, pirfusion, pantiltsink
 *
 * A robot with a camera on a pan-tilt head and PIR sensors around it drives through a house in which people walk, stand
 * and gesture: the picture of its camera (pad `video`), the readings of its sensors (pad `pir`, which may stay unlinked),
 * and the truth about both. With `pirfusion` and `pantiltsink driver=simulated` downstream the whole robot runs without
 * hardware.
 *
 * - The house is a floor plan (`plan`): rooms, corridors and doorways with furniture, pillars and lamps, from a text
 *   file. Without one it is an office floor with a corridor and three rooms.
 * - The robot drives along its `path`, or through all rooms. It waits for people in its way.
 * - People, 1.5 to 1.9 m tall, walk along their `walks`, or from room to room at .5 to 1.6 m/s, give way to each other
 *   and to the robot.
 * - The camera has a lens (`horizontal-fov`), noise, exposure blur, and shakes while the robot moves, or as in a hand
 *   (`shake-kind`).
 * - `inset` attaches the floor plan, small, to each frame: the robot with its way, what its camera sees of the floor, and
 *   the people, in red whom it sees.
 *
 * Each frame carries the truth (#CerberusTruth: each person's box and visible share, bearing, distance and speed, and
 * where robot and camera are), the head's pose with which it was taken, and how the base moved (#CerberusBase), as a
 * robot knows it by its wheels. Equal settings give equal bytes on one machine. The stream is not live: it is made as
 * fast as it is taken, and a sink with sync=true plays it in its time.
 *
 * The camera looks where the head does, by the upstream event `cerberus-pose`; another head's (`head`) is ignored. Where
 * a pantiltsink of that name is downstream when the stream begins (`lockstep`), each frame but the first waits until the
 * head's motion is known up to its running time, so that every run gives the same, whatever queues there are. When no
 * pose comes for `lockstep-timeout` the element gives up with an error.
 *
 * PIR readings are those of pirsrc: `application/x-pir` with the sensors' bearings, a buffer at each change and ten a
 * second, and the element message `cerberus-pir` at each change; a GAP event comes with each frame. The sensors see
 * what is warmer or colder than its surroundings cross their zones: people, and, while the robot turns or drives, what
 * stands. They do not see through walls, see people up to `pir-range` away, and what begins higher than 1.5 m within 3 m
 * only. `pir-preset` gives them the range, field of view, warm-up, hold and block times of a module. `pir` has a thread of its own and needs no queue.
 *
 * `video` is raw progressive I420 of any even size and rate, 320x240 and 30 frames a second unless downstream asks for
 * something else; neither changes while it runs.
 *
 * ## Example launch lines
 * |[
 * gst-launch-1.0 patrolsimsrc num-buffers=90 ! motiondetect ! motionoverlay ! videoconvert ! autovideosink
 * gst-launch-1.0 -m patrolsimsrc name=robot num-buffers=90 ! motiondetect ! pirfusion name=fusion ! \
 *     pantiltsink driver=simulated horizontal-fov=60 robot.pir ! fusion.
 * gst-launch-1.0 patrolsimsrc num-buffers=30 people=0 path="at 2 5.3; turn 90; turn -90" ! \
 *     video/x-raw,width=640,height=480 ! fakesink
 * gst-launch-1.0 patrolsimsrc num-buffers=30 path="at 4.5 8.5; wait 1" walks="at 8 7 90; go 8 11 1" ! fakesink
 * ]|
 *
 * Since: 0.3
 */
// A bin of two sources with one world: patrol_camera.hpp and pir_stream.hpp. Each has its own thread.
#include <cerberus/pir.h>

#include <memory>

#include "cerberus/private/element.hpp"
#include "patrol_camera.hpp"
#include "patrol_settings.hpp"
#include "pir_stream.hpp"
#include "shared/settings_query.hpp"

GST_DEBUG_CATEGORY_STATIC(patrolsimsrc_debug);
#define GST_CAT_DEFAULT patrolsimsrc_debug

namespace cerberus::plugin {
namespace {

GstStaticPadTemplate video_template =
    GST_STATIC_PAD_TEMPLATE("video", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(PATROL_VIDEO_CAPS));
GstStaticPadTemplate pir_template =
    GST_STATIC_PAD_TEMPLATE("pir", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(PATROL_PIR_CAPS));

struct Private {
  GstElement* camera = nullptr;  // the bin's
};

CERBERUS_DEFINE_TYPE(CerberusPatrolSimSrc, cerberus_patrol_sim_src, GstBin, GST_TYPE_BIN, Private)

// All properties are the camera's.
void set_property(GObject* object, guint, const GValue* value, GParamSpec* spec) {
  g_object_set_property(G_OBJECT(cerberus_patrol_sim_src_self(object)->priv->camera), spec->name, value);
}

void get_property(GObject* object, guint, GValue* value, GParamSpec* spec) {
  g_object_get_property(G_OBJECT(cerberus_patrol_sim_src_self(object)->priv->camera), spec->name, value);
}

std::string settings_fault(GstElement* element) {
  return ask_for_settings_fault(cerberus_patrol_sim_src_self(element)->priv->camera);
}

void add_source(CerberusPatrolSimSrc* self, GstElement* source, const char* name) {
  gst_bin_add(GST_BIN(self), source);
  g_autoptr(GstPad) pad = gst_element_get_static_pad(source, "src");
  GstPadTemplate* pad_template = gst_element_class_get_pad_template(GST_ELEMENT_GET_CLASS(self), name);
  gst_element_add_pad(GST_ELEMENT(self), gst_ghost_pad_new_from_template(name, pad, pad_template));
}

void cerberus_patrol_sim_src_init(CerberusPatrolSimSrc* self) {
  const auto stream = std::make_shared<PirStream>(GST_ELEMENT(self));
  self->priv->camera = patrol_camera_new(stream);
  add_source(self, self->priv->camera, "video");
  add_source(self, pir_source_new(stream), "pir");
}

void cerberus_patrol_sim_src_class_init(CerberusPatrolSimSrcClass* klass) {
  GObjectClass* object = G_OBJECT_CLASS(klass);
  object->set_property = set_property;
  object->get_property = get_property;
  Adjustable<PatrolSettings>::install(object, patrol_properties(), GParamFlags(GST_PARAM_MUTABLE_READY));
  g_object_class_install_property(
      object, static_cast<guint>(patrol_properties().size()) + 1,
      g_param_spec_int("num-buffers", nullptr, "Number of frames after which the stream ends; -1 = none", -1,
                       G_MAXINT, -1, GParamFlags(G_PARAM_READWRITE | G_PARAM_STATIC_STRINGS)));

  GstElementClass* element = GST_ELEMENT_CLASS(klass);
  element->query = settings_query<cerberus_patrol_sim_src_parent_class, settings_fault>;
  gst_element_class_set_static_metadata(element, "Simulated robot", "Source/Video/Sensor",
                                        "Video and PIR readings of a simulated robot on patrol through a "
                                        "house with people, with the truth about them",
                                        "The Cerberus developers");
  gst_element_class_add_static_pad_template(element, &video_template);
  gst_element_class_add_static_pad_template(element, &pir_template);
}

}  // namespace
}  // namespace cerberus::plugin

CERBERUS_REGISTER_ELEMENT(patrolsimsrc, GST_RANK_NONE, cerberus::plugin::cerberus_patrol_sim_src,
                          patrolsimsrc_debug, "a simulated robot on patrol")
