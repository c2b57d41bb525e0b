// SPDX-License-Identifier: LGPL-2.1-or-later
#include "patrol_camera.hpp"

#include <cerberus/cerberus.h>
#include <gst/base/gstpushsrc.h>
#include <gst/video/video.h>

#include <cmath>
#include <cstring>
#include <optional>
#include <span>
#include <vector>

#include "cerberus/private/element.hpp"
#include "cerberus/private/head_query.hpp"
#include "head_wait.hpp"
#include "inset.hpp"
#include "motion/pose_feed.h"
#include "overlay/floor_map.h"
#include "patrol_settings.hpp"
#include "pir_stream.hpp"
#include "shared/poses.hpp"
#include "shared/settings_query.hpp"
#include "shared/times.hpp"
#include "shared/video.hpp"

namespace cerberus::plugin {
namespace {

using motion::Time;
using sensing::degrees;
using sensing::radians;

constexpr int kWidth = 320, kHeight = 240, kRate = 30;

GstStaticPadTemplate src_template =
    GST_STATIC_PAD_TEMPLATE("src", GST_PAD_SRC, GST_PAD_ALWAYS, GST_STATIC_CAPS(PATROL_VIDEO_CAPS));

struct State {  // streaming thread, and state changes while it does not run
  PatrolSettings settings;
  CerberusPirInfo sensors{};
  std::unique_ptr<sim::House> house;
  std::optional<overlay::FloorMap> map;  // with `inset`
  GstVideoInfo info;
  guint64 frame = 0;  // number of the next one
  motion::FrameTimes times;
  std::optional<bool> lockstep;  // nothing: not asked yet
  std::vector<std::uint8_t> i420;
};

struct Private {
  Adjustable<PatrolSettings> settings;
  State state;
  motion::PoseFeed feed;
  std::shared_ptr<PirStream> pir;
};

CERBERUS_DEFINE_TYPE(CerberusPatrolCamera, cerberus_patrol_camera, GstPushSrc, GST_TYPE_PUSH_SRC, Private)

// ---- caps

GstCaps* get_caps(GstBaseSrc* base, GstCaps* filter) {
  GstPad* pad = GST_BASE_SRC_PAD(base);
  GstCaps* caps = gst_pad_get_current_caps(pad);
  if (!caps) caps = gst_pad_get_pad_template_caps(pad);
  if (!filter) return caps;
  GstCaps* both = gst_caps_intersect_full(filter, caps, GST_CAPS_INTERSECT_FIRST);
  gst_caps_unref(caps);
  return both;
}

GstCaps* fixate(GstBaseSrc* base, GstCaps* caps) {
  caps = gst_caps_make_writable(gst_caps_truncate(caps));
  GstStructure* wanted = gst_caps_get_structure(caps, 0);
  gst_structure_fixate_field_nearest_int(wanted, "width", kWidth);
  gst_structure_fixate_field_nearest_int(wanted, "height", kHeight);
  gst_structure_fixate_field_nearest_fraction(wanted, "framerate", kRate, 1);
  return GST_BASE_SRC_CLASS(cerberus_patrol_camera_parent_class())->fixate(base, caps);
}

overlay::FloorPlan drawn(const sim::FloorPlan& plan, double camera_height) {
  const auto area = [](const sim::Rectangle& r) {
    return overlay::FloorPlan::Area{r.left, r.top, r.right, r.bottom};
  };
  overlay::FloorPlan drawing;
  for (const sim::Space& space : plan.spaces) drawing.rooms.push_back(area(space.area));
  for (const sim::Furniture& box : plan.boxes) {
    drawing.furniture.push_back(area(box.area));
    if (box.from < camera_height && box.height > camera_height) drawing.high.push_back(area(box.area));
  }
  for (const sim::Pillar& pillar : plan.pillars)
    drawing.pillars.push_back({pillar.x, pillar.y, pillar.radius});
  return drawing;
}

// What keeps the house from being built; empty: nothing.
std::string build(State& state, int width, int height) {
  if (std::string wrong = pir_info(state.settings, state.sensors); !wrong.empty())
    return "pir-" + wrong + ".";
  auto built = build_house(state.settings, state.sensors, width, height);
  if (auto* wrong = std::get_if<std::string>(&built)) return std::move(*wrong);
  state.house = std::get<std::unique_ptr<sim::House>>(std::move(built));
  return {};
}

gboolean set_caps(GstBaseSrc* base, GstCaps* caps) {
  return guarded(base, FALSE, [&]() -> gboolean {
    State& state = cerberus_patrol_camera_self(base)->priv->state;
    if (!gst_video_info_from_caps(&state.info, caps)) return FALSE;
    const int width = GST_VIDEO_INFO_WIDTH(&state.info), height = GST_VIDEO_INFO_HEIGHT(&state.info);
    if ((width != kWidth || height != kHeight) && !build(state, width, height).empty()) return FALSE;
    if (state.settings.inset)
      state.map.emplace(drawn(state.house->plan(), state.settings.camera_height),
                        vision::Size{width, height});
    return TRUE;
  });
}

// ---- a frame

void attach_facts(const State& state, const motion::Pose& pose, GstBuffer* buffer) {
  CerberusPose meta = to_c(pose);
  meta.field_of_view = 0;  // it does not zoom
  if (!state.settings.head.empty()) meta.head = g_intern_string(state.settings.head.c_str());
  cerberus_buffer_set_pose(buffer, &meta);

  const sim::DrivenBase& body = state.house->base();
  CerberusBase base;
  cerberus_base_init(&base);
  base.source = CERBERUS_BASE_REPORTED;
  base.yaw_rate = degrees(body.yaw_rate());
  base.speed = body.speed();
  cerberus_buffer_set_base(buffer, &base);

  CerberusTruth truth;
  cerberus_truth_init(&truth);
  truth.base_x = body.x(), truth.base_y = body.y();
  truth.base_heading = degrees(sensing::wrap(body.yaw()));
  truth.base_speed = body.speed(), truth.base_yaw_rate = base.yaw_rate;
  truth.pan = degrees(pose.pan.position), truth.tilt = degrees(pose.tilt.position);
  for (const sim::PersonTruth& person : state.house->people()) {
    CerberusTruthPerson& out = truth.persons[truth.n_persons++];
    out = {truth.n_persons,         person.left,     person.top,  person.width, person.height, person.visible,
           degrees(person.bearing), person.distance, person.speed};
  }
  cerberus_buffer_set_truth(buffer, &truth);
}

// False: there is no memory for it.
bool copy_picture(const State& state, GstBuffer* buffer) {
  VideoFrame frame(state.info, buffer, GST_MAP_WRITE);
  if (!frame) return false;
  const std::uint8_t* from = state.i420.data();
  for (guint plane = 0; plane < 3; ++plane) {
    const int width = GST_VIDEO_FRAME_COMP_WIDTH(frame.get(), plane),
              height = GST_VIDEO_FRAME_COMP_HEIGHT(frame.get(), plane),
              stride = GST_VIDEO_FRAME_PLANE_STRIDE(frame.get(), plane);
    auto* to = static_cast<std::uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(frame.get(), plane));
    for (int row = 0; row < height; ++row, from += width, to += stride) std::memcpy(to, from, width);
  }
  return true;
}

void attach_map(State& state, GstBuffer* buffer) {
  const vision::Size size = state.map->size();
  if (size.area() == 0) return;
  const CerberusTruth* truth = cerberus_buffer_peek_truth(buffer);
  overlay::FloorScene scene;
  scene.x = truth->base_x, scene.y = truth->base_y;
  scene.heading = radians(truth->base_heading);
  scene.view = scene.heading + radians(truth->pan);
  scene.field_of_view = radians(state.settings.horizontal_fov);
  std::vector<overlay::FloorScene::Person> people;
  for (const CerberusTruthPerson& one : std::span(truth->persons, truth->n_persons)) {
    const double direction = scene.view + radians(one.bearing);
    people.push_back({scene.x + one.distance * std::cos(direction),
                      scene.y + one.distance * std::sin(direction), one.visible > 0});
  }
  scene.people = people;
  GstBuffer* words = gst_buffer_new_allocate(nullptr, gsize(4 * size.area()), nullptr);
  GstMapInfo map;
  if (words && gst_buffer_map(words, &map, GST_MAP_WRITE)) {
    state.map->draw(scene, {reinterpret_cast<std::uint32_t*>(map.data), size.width, size.height, size.width});
    gst_buffer_unmap(words, &map);
    attach_inset(words, size, GST_VIDEO_INFO_WIDTH(&state.info), buffer);
  }
  gst_clear_buffer(&words);
}

bool wants_lockstep(CerberusPatrolCamera* self, State& state) {
  if (state.settings.lockstep != LOCKSTEP_AUTO) return state.settings.lockstep == LOCKSTEP_ON;
  if (!state.lockstep)
    state.lockstep = has_head_downstream(GST_BASE_SRC_PAD(self), state.settings.head.c_str());
  return *state.lockstep;
}

void publish_edges(Private& self, Time time) {
  PirStream::Step step;
  const bool active_low = pir_options(self.state.settings).active_low;
  step.until = time;
  for (const sim::PirEdge& edge : self.state.house->pir_edges())
    step.edges.push_back({edge.time, edge.sensor, edge.high != active_low});
  step.motion = {self.state.house->base().yaw_rate(), self.state.house->base().speed()};
  self.pir->advance(std::move(step));
}

GstFlowReturn make_frame(CerberusPatrolCamera* self, GstBuffer** buffer) {
  Private& priv = *self->priv;
  State& state = priv.state;
  const int rate = GST_VIDEO_INFO_FPS_N(&state.info), per = GST_VIDEO_INFO_FPS_D(&state.info);
  const auto begin = [&](guint64 frame) {
    return gst_util_uint64_scale(frame, guint64(per) * GST_SECOND, guint64(rate));
  };
  const GstClockTime pts = begin(state.frame);
  const Time time = time_of(pts);
  if (wants_lockstep(self, state)) {
    const GstFlowReturn flow =
        wait_for_head({GST_ELEMENT(self), GST_BASE_SRC_PAD(self), GST_BASE_SRC(self)->segment, priv.feed,
                       state.times, state.settings.head, state.settings.lockstep_timeout},
                      pts, time);
    // The error was posted: for GST_FLOW_ERROR the base class would post another one.
    if (flow != GST_FLOW_OK) return flow == GST_FLOW_ERROR ? GST_FLOW_EOS : flow;
  }
  const auto gaze = [&](Time at) {
    const motion::Pose pose = priv.feed.at(at);
    return sim::Gaze{pose.pan.position, pose.tilt.position};
  };
  state.house->take(time, gaze, state.i420);
  GstBuffer* made = gst_buffer_new_allocate(nullptr, GST_VIDEO_INFO_SIZE(&state.info), nullptr);
  if (!made || !copy_picture(state, made)) {
    gst_clear_buffer(&made);
    throw std::bad_alloc();
  }
  GST_BUFFER_PTS(made) = pts;
  GST_BUFFER_DURATION(made) = begin(state.frame + 1) - pts;
  GST_BUFFER_OFFSET(made) = state.frame;
  GST_BUFFER_OFFSET_END(made) = ++state.frame;
  state.times.add(time, time_of(GST_BUFFER_DURATION(made)));
  attach_facts(state, priv.feed.at(time), made);
  if (state.map) attach_map(state, made);
  publish_edges(priv, time);
  *buffer = made;
  return GST_FLOW_OK;
}

GstFlowReturn create(GstPushSrc* push, GstBuffer** buffer) {
  auto* self = cerberus_patrol_camera_self(push);
  return guarded(self, GST_FLOW_ERROR, [&] { return make_frame(self, buffer); });
}

// ---- events and states

gboolean event(GstBaseSrc* base, GstEvent* event) {
  Private& self = *cerberus_patrol_camera_self(base)->priv;
  if (g_autoptr(CerberusPose) pose = cerberus_event_parse_pose(event)) {
    const std::string head = self.settings.snapshot().head;
    if (head.empty() || head == pose->head) self.feed.add(from_c(*pose));
    return TRUE;
  }
  if (cerberus_event_is_base(event)) return TRUE;  // it knows better
  return GST_BASE_SRC_CLASS(cerberus_patrol_camera_parent_class())->event(base, event);
}

gboolean unlock(GstBaseSrc* base) {
  cerberus_patrol_camera_self(base)->priv->feed.interrupt(true);
  return TRUE;
}

gboolean unlock_stop(GstBaseSrc* base) {
  cerberus_patrol_camera_self(base)->priv->feed.interrupt(false);
  return TRUE;
}

std::string settings_fault(GstElement* element) {
  State state;
  state.settings = cerberus_patrol_camera_self(element)->priv->settings.snapshot();
  return build(state, kWidth, kHeight);
}

bool begin(CerberusPatrolCamera* self) {
  Private& priv = *self->priv;
  priv.state = {};
  priv.state.settings = priv.settings.snapshot();
  if (const std::string wrong = build(priv.state, kWidth, kHeight); !wrong.empty()) {
    CERBERUS_ELEMENT_ERROR(self, RESOURCE, SETTINGS, (wrong), (nullptr));
    return false;
  }
  motion::Pose start;
  start.pan.position = radians(priv.state.settings.start_pan);
  start.tilt.position = radians(priv.state.settings.start_tilt);
  priv.feed.begin(start);
  constexpr Time kHeartbeat = std::chrono::milliseconds(100);  // as pirsrc's
  const PatrolSettings& settings = priv.state.settings;
  priv.pir->begin(priv.state.sensors, pir_range(settings), pir_options(settings), kHeartbeat,
                  settings.camera_name);
  return true;
}

// Not in start(): the base class would say a second time that it failed.
GstStateChangeReturn change_state(GstElement* element, GstStateChange change) {
  auto* self = cerberus_patrol_camera_self(element);
  if (change == GST_STATE_CHANGE_READY_TO_PAUSED && !guarded(self, false, [&] { return begin(self); }))
    return GST_STATE_CHANGE_FAILURE;
  if (change == GST_STATE_CHANGE_PAUSED_TO_PLAYING || change == GST_STATE_CHANGE_PLAYING_TO_PAUSED)
    self->priv->feed.play(change == GST_STATE_CHANGE_PAUSED_TO_PLAYING);
  return GST_ELEMENT_CLASS(cerberus_patrol_camera_parent_class())->change_state(element, change);
}

// The video ends in the base class, by its number of buffers or by an error downstream.
GstPadProbeReturn see_end(GstPad*, GstPadProbeInfo* info, gpointer self) {
  if (GST_EVENT_TYPE(GST_PAD_PROBE_INFO_EVENT(info)) == GST_EVENT_EOS)
    cerberus_patrol_camera_self(self)->priv->pir->end();
  return GST_PAD_PROBE_OK;
}

void cerberus_patrol_camera_init(CerberusPatrolCamera* self) {
  gst_base_src_set_format(GST_BASE_SRC(self), GST_FORMAT_TIME);
  gst_pad_add_probe(GST_BASE_SRC_PAD(self), GST_PAD_PROBE_TYPE_EVENT_DOWNSTREAM, see_end, self, nullptr);
}

constexpr auto kTable = [] { return patrol_properties(); };

void cerberus_patrol_camera_class_init(CerberusPatrolCameraClass* klass) {
  GObjectClass* object = G_OBJECT_CLASS(klass);
  object->set_property = [](GObject* self, guint id, const GValue* value, GParamSpec*) {
    cerberus_patrol_camera_self(self)->priv->settings.set(kTable(), id, value);
  };
  object->get_property = [](GObject* self, guint id, GValue* value, GParamSpec*) {
    cerberus_patrol_camera_self(self)->priv->settings.get(kTable(), id, value);
  };
  Adjustable<PatrolSettings>::install(object, kTable(), GParamFlags(GST_PARAM_MUTABLE_READY));

  GstElementClass* element = GST_ELEMENT_CLASS(klass);
  element->change_state = change_state;
  element->query = settings_query<cerberus_patrol_camera_parent_class, settings_fault>;
  gst_element_class_set_static_metadata(element, "Camera of a simulated robot", "Source/Video",
                                        "Video of patrolsimsrc", "The Cerberus developers");
  gst_element_class_add_static_pad_template(element, &src_template);

  GstBaseSrcClass* src = GST_BASE_SRC_CLASS(klass);
  src->get_caps = get_caps;
  src->fixate = fixate;
  src->set_caps = set_caps;
  src->event = event;
  src->unlock = unlock;
  src->unlock_stop = unlock_stop;
  GST_PUSH_SRC_CLASS(klass)->create = create;
}

}  // namespace

GstElement* patrol_camera_new(std::shared_ptr<PirStream> pir) {
  auto* camera =
      cerberus_patrol_camera_self(g_object_new(cerberus_patrol_camera_get_type(), "name", "camera", nullptr));
  camera->priv->pir = std::move(pir);
  return GST_ELEMENT(camera);
}

}  // namespace cerberus::plugin
