// SPDX-License-Identifier: LGPL-2.1-or-later
#include "robot/pipeline_text.h"

#include <array>
#include <map>
#include <utility>

#include "publish/streams/encoders.h"
#include "text/numbers.h"

namespace cerberus::robot {

namespace {

constexpr const char* kUnlimited = "queue max-size-buffers=0 max-size-bytes=0 max-size-time=0";
// Bridges 5 s of a slow disk; a head or a page never waits for it.
constexpr const char* kPatient = "max-size-buffers=0 max-size-bytes=0 max-size-time=5000000000";
// The newest frame counts.
constexpr const char* kNewest = "leaky=downstream max-size-buffers=2 max-size-bytes=0 max-size-time=0";

// Closed while no client watches: then nothing is drawn or encoded.
constexpr const char* kValve = " ! valve drop-mode=forward-sticky-events name=";
// Frames: 2 s of 25 a second, so that a player that seeks in a recording finds a keyframe near.
constexpr int kKeyframeDistance = 50;

struct Coding {
  const char *depayloader, *parser, *decoder;
};

Coding coding(Codec codec) {
  switch (codec) {
    case Codec::h264:
      return {"rtph264depay request-keyframe=true", "h264parse", "avdec_h264"};
    case Codec::h265:
      return {"rtph265depay", "h265parse", "avdec_h265"};
    case Codec::jpeg:
      break;
  }
  return {"rtpjpegdepay", "jpegparse", "jpegdec"};
}

class Writer {
 public:
  Writer(const CameraSettings& camera, const SharedSettings& shared, Parts parts)
      : camera_(camera),
        source_(camera.source),
        page_(shared.page),
        mqtt_(shared.mqtt ? &*shared.mqtt : nullptr),
        rtsp_(shared.rtsp ? &*shared.rtsp : nullptr) {
    head_ = camera.head && parts.head;
    recorder_ = camera.recorder && parts.recorder;
    plain_ = rtsp_ != nullptr && rtsp_->plain;
  }

  PipelineText write() {
    const bool waits = waits_for_reader(source_.kind), patrols = source_.kind == SourceKind::patrol;
    if (recorder_) recorder();
    source();
    add(" ! videoconvert");
    // A telephone's video says how it was held.
    if (waits && !patrols) add(" ! videoflip video-direction=auto");
    if (waits) add(" ! identity sync=true");
    if (source_.kind == SourceKind::world) window();
    add(" ! motiondetect name=detect");
    if (camera_.persons.use != PersonsUse::never) {
      add(" ! personverify name=persons");
      set_all("persons", camera_.persons.properties);
    }
    add(" ! pirfusion name=fusion");
    if (mqtt_ != nullptr) publish();
    add(" ! tee name=found");
    detection();
    if (camera_.sensors && patrols) add("  patrol.pir ! fusion.pir_0");
    if (camera_.sensors && !patrols) {
      add("  pirsrc name=sensors ! queue ! fusion.pir_0");
      set("sensors", "camera-name", camera_.name);
      if (!waits) set("sensors", "is-live", "true");
      set_all("sensors", *camera_.sensors);
    }
    if (head_) head();
    if (recorder_) add(std::string("  found. ! ") + kUnlimited + " name=analysis-queue ! recorder.analysis");
    if ((recorder_ || plain_) && source_.kind != SourceKind::rtsp) encode_plain();
    if (rtsp_ != nullptr) serve();
    if (page_.enabled) pictures();
    // A pipeline needs a branch that takes every frame.
    add("  found. ! fakesink sync=false async=false");
    return std::move(text_);
  }

 private:
  void add(std::string_view words) { text_.line += words; }
  void set(std::string element, std::string property, std::string value) {
    text_.assignments.push_back({std::move(element), std::move(property), std::move(value)});
  }
  void set_all(const char* element, const Properties& properties) {
    for (const Property& property : properties)
      text_.assignments.push_back({element, property.name, property.value, property.line});
  }

  std::string size_and_rate() const {
    std::string caps;
    if (source_.width > 0)
      caps += ",width=" + std::to_string(source_.width) + ",height=" + std::to_string(source_.height);
    if (source_.framerate > 0) caps += ",framerate=" + std::to_string(source_.framerate) + "/1";
    return caps;
  }

  void source() {
    switch (source_.kind) {
      case SourceKind::test:
        add("  videotestsrc name=source is-live=true pattern=ball ! video/x-raw");
        add(size_and_rate());
        break;
      case SourceKind::world:
      case SourceKind::file:
        add("  filesrc name=source ! decodebin");
        set("source", "location", source_.file);
        break;
      case SourceKind::v4l2:
        add("  v4l2src name=source ! ");
        add(source_.motion_jpeg ? "image/jpeg" : "video/x-raw");
        add(size_and_rate());
        if (source_.motion_jpeg) add(" ! jpegdec name=decoder");
        set("source", "device", source_.device);
        break;
      case SourceKind::rtsp:
        network_camera();
        break;
      case SourceKind::patrol:
        patrol();
        break;
      case SourceKind::libcamera:
        add("  libcamerasrc name=source ! video/x-raw");
        add(size_and_rate());
        if (!source_.device.empty()) set("source", "camera-name", source_.device);
        break;
    }
  }

  void patrol() {
    add("  patrolsimsrc name=patrol  patrol.video ! video/x-raw");
    add(size_and_rate());
    set("patrol", "head", camera_.name);
    set("patrol", "camera-name", camera_.name);
    set("patrol", "horizontal-fov", number(camera_.horizontal_fov));
    set("patrol", "inset", "true");
    set_all("patrol", source_.patrol);
    if (!camera_.sensors) return;
    for (const Property& one : *camera_.sensors)
      text_.assignments.push_back({"patrol", "pir-" + one.name, one.value, one.line});
  }

  void network_camera() {
    const Coding with = coding(source_.codec);
    const std::string latency = " latency=" + std::to_string(kNetworkLatency.count());
    const std::string parsed = std::string(" ! ") + with.depayloader + " ! " + with.parser;
    const bool two = !source_.record_uri.empty(), needed = recorder_ || plain_;
    if (needed && two) {
      add("  rtspsrc name=recorded" + latency);
      add(parsed);
      encoded();
      set("recorded", "location", source_.record_uri);
    }
    add("  rtspsrc name=source" + latency);
    set("source", "location", source_.uri);
    add(parsed);
    if (needed && !two) {
      encoded(true);
      add("  encoded. ! queue");
    }
    add(std::string(" ! ") + with.decoder + " name=decoder");
  }

  // The plain picture, encoded once for the recorder, the clients of the server, and what else is `decoded`.
  void encoded(bool decoded = false) {
    const std::string record = std::string(" ! ") + kUnlimited + " name=record-queue ! recorder.video";
    if (!plain_ && !decoded) {
      add(record);
      return;
    }
    add(" ! tee name=encoded");
    if (recorder_) add("  encoded." + record);
    if (plain_) add(std::string("  encoded. ! ") + kUnlimited + " ! appsink name=rtsp-plain");
  }

  // The window that a simulated head turns over the video.
  void window() {
    add(" ! virtualptz name=window inset=true");
    set("window", "head", camera_.name);
    set("window", "wide-fov", number(source_.wide_fov));
    set("window", "horizontal-fov", number(camera_.horizontal_fov));
    set("window", "width", std::to_string(source_.width));
    set("window", "height", std::to_string(source_.height));
    for (const char* element : {"window", "head"}) {
      if (!head_) continue;
      set(element, "start-pan", number(source_.start_pan));
      set(element, "start-tilt", number(source_.start_tilt));
    }
  }

  void detection() {
    set("detect", "camera-name", camera_.name);
    set("detect", "head", camera_.name);
    // Sizes in metres need the camera's height; without it they would be wrong.
    for (const Property& property : camera_.detection)
      if (property.name == "mounting-height") set("detect", "horizontal-fov", number(camera_.horizontal_fov));
    set_all("detect", camera_.detection);
    set("fusion", "head", camera_.name);
    set("fusion", "horizontal-fov", number(camera_.horizontal_fov));
    if (camera_.head) {
      for (const Property& property : *camera_.head)
        if (property.name == "pan-min" || property.name == "pan-max")
          set("fusion", property.name, property.value);
    }
    set_all("fusion", camera_.fusion);
  }

  void publish() {
    add(" ! mqttpublish name=mqtt");
    set("mqtt", "camera-name", camera_.name);
    set("mqtt", "head", camera_.name);
    if (camera_.recorder) set("mqtt", "recorder", "true");
    set_all("mqtt", *mqtt_);
  }

  void head() {
    // The window of a world and a simulated robot wait for the pose that answers each frame: none is dropped.
    const bool in_step = source_.kind == SourceKind::world || source_.kind == SourceKind::patrol;
    add(in_step ? "  found. ! queue" : "  found. ! queue leaky=downstream max-size-buffers=1");
    add(" ! pantiltsink name=head");
    set("head", "head", camera_.name);
    set("head", "horizontal-fov", number(camera_.horizontal_fov));
    set_all("head", *camera_.head);
  }

  void recorder() {
    add("eventrecorder name=recorder");
    set("recorder", "location", camera_.recorder->folder);
    set("recorder", "camera-name", camera_.name);
    set_all("recorder", camera_.recorder->properties);
  }

  // What is recorded goes on for ever: its encoder is behind no valve, and `encode-queue` bridges a slow one. What is
  // only watched is late behind a long queue, and frames are dropped instead.
  void encode_plain() {
    add("  found. ! queue name=encode-queue ");
    if (recorder_)
      add(std::string("leaky=downstream ") + kPatient);
    else
      add(std::string(kNewest) + kValve + "rtsp-plain-valve");
    encoder(camera_.recorder ? camera_.recorder->encoder : rtsp_->encoder);
    encoded();
  }

  void encoder(const EncoderSettings& settings) {
    const publish::Encoder* found = publish::encoder_of(settings.element);
    if (found == nullptr) return;  // the settings name no other
    add(" ! ");
    add(publish::kBeforeEncoder);
    add(" ! ");
    add(publish::encoder_line(*found, kKeyframeDistance, settings.bitrate));
    if (found->codec == "h264") add(" ! h264parse");
  }

  void serve() {
    if (rtsp_->annotated) {
      add(std::string("  found. ! queue ") + kNewest + kValve + "rtsp-annotated-valve" +
          " ! motionoverlay crosshair=true");
      encoder(rtsp_->encoder);
      add(" ! appsink name=rtsp-annotated");
    }
    add(std::string("  found. ! queue ") + kNewest + kValve +
        "rtsp-metadata-valve ! onvifmeta name=onvif ! appsink name=rtsp-metadata");
    set("onvif", "horizontal-fov", number(camera_.horizontal_fov));
  }

  // JPEGs of the page's size. In RGB from here on, which the JPEG encoder's line begins with.
  void jpeg(const std::string& elements, const std::string& properties) {
    add(" ! videoconvert ! videoscale ! video/x-raw,format=BGRx,width=[1," +
        std::to_string(page_.picture_width) + "],pixel-aspect-ratio=1/1 ! " + elements);
    add(publish::encoder_line(*publish::encoder_of("jpegenc"), 1, 1));
    add(properties);
  }

  void pictures() {
    add(std::string("  found. ! queue name=picture-queue ") + kNewest);
    jpeg("motionoverlay crosshair=true ! ", " name=jpeg quality=" + std::to_string(page_.quality));
    add(" ! appsink name=picture sync=false async=false max-buffers=2 drop=true");
    // One stage's result, while the page shows it: only then the frames keep the record (keep-planes).
    add(std::string("  found. ! queue name=stage-queue ") + kNewest + " ! motionview name=stage");
    jpeg("", "");
    add(" ! appsink name=stage-picture sync=false async=false max-buffers=2 drop=true");
    set("detect", "keep-planes", "never");
    add(std::string("  found. ! queue ") + kNewest +
        " ! motionjson ! appsink name=facts sync=false async=false max-buffers=2 drop=true");
  }

  static std::string number(double value) { return text::exact(value).string(); }

  const CameraSettings& camera_;
  const SourceSettings& source_;
  const PageSettings& page_;
  const Properties* mqtt_;
  const RtspSettings* rtsp_;
  bool head_ = false, recorder_ = false, plain_ = false;
  PipelineText text_;
};

}  // namespace

PipelineText pipeline_text(const CameraSettings& camera, const SharedSettings& shared, Parts parts) {
  return Writer(camera, shared, parts).write();
}

std::optional<std::vector<PropertyChange>> changes(const PipelineText& before, const PipelineText& after) {
  if (before.line != after.line) return std::nullopt;
  using Key = std::pair<std::string, std::string>;
  const auto values = [](const PipelineText& text) {
    std::map<Key, std::string> last;  // a later assignment wins
    for (const Assignment& one : text.assignments) last[{one.element, one.property}] = one.value;
    return last;
  };
  const std::map<Key, std::string> old_values = values(before), new_values = values(after);
  std::vector<PropertyChange> all;
  for (const auto& [key, value] : new_values) {
    const auto old = old_values.find(key);
    if (old == old_values.end() || old->second != value) all.push_back({key.first, key.second, value});
  }
  for (const auto& [key, value] : old_values)
    if (!new_values.contains(key)) all.push_back({key.first, key.second, std::nullopt});
  return all;
}

Properties triggers(const RecorderSettings& recorder) {
  Properties all{{"trigger-track", "true"}, {"trigger-fusion", "false"}, {"trigger-pir", "false"}};
  for (Property& trigger : all)
    for (const Property& property : recorder.properties)
      if (property.name == trigger.name) trigger.value = property.value;
  return all;
}

}  // namespace cerberus::robot
