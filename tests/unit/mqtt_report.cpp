// SPDX-License-Identifier: LGPL-2.1-or-later
#include "publish/mqtt_report.h"

#include <array>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <tuple>
#include <vector>

#include "publish/burst_limit.h"
#include "publish/fleet.h"
#include "publish/webhook_queue.h"
#include "support/suite.h"  // after the streams: check defines fail()

using namespace cerberus::publish;
using nlohmann::json;
using std::chrono::milliseconds;
using std::chrono::seconds;

namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

MqttObject walker(std::uint32_t id) {
  return {.id = id,
          .type = "motion",
          .kind = "person-like",
          .state = "seen",
          .x = 10,
          .y = 20.25,
          .width = 30,
          .height = 60,
          .confidence = .5,
          .bearing = kUnknown,
          .distance = kUnknown};
}

MqttFrame frame(milliseconds time, std::span<const MqttObject> objects) {
  MqttFrame made;
  made.time = time;
  made.analysed = true;
  made.objects = objects;
  return made;
}

const MqttMessage* find(const std::vector<MqttMessage>& all, const std::string& topic) {
  for (const MqttMessage& one : all)
    if (one.topic == topic) return &one;
  return nullptr;
}

// "appeared 4" of the messages of topic track, in order.
std::vector<std::string> tracks(const std::vector<MqttMessage>& all) {
  std::vector<std::string> found;
  for (const MqttMessage& one : all) {
    if (one.topic != "cerberus/front/track") continue;
    ck_assert(!one.retain);
    const json read = json::parse(one.payload);
    found.push_back(
        read["event"].get<std::string>().append(" ").append(std::to_string(read["id"].get<int>())));
  }
  return found;
}

using Words = std::vector<std::string>;

}  // namespace

START_TEST(a_track_appears_is_updated_each_second_and_leaves_two_seconds_after_its_last_sight) {
  MqttReport report("cerberus", "front");
  const std::vector<MqttObject> one{walker(4)}, two{walker(4), walker(5)}, none;
  ck_assert(tracks(report.update(frame(seconds(1), one))) == Words{"appeared 4"});
  ck_assert(tracks(report.update(frame(milliseconds(1999), two))) == Words{"appeared 5"});
  ck_assert(tracks(report.update(frame(seconds(2), two))) == Words{"updated 4"});
  ck_assert(tracks(report.update(frame(milliseconds(3999), none))).empty());
  ck_assert((tracks(report.update(frame(seconds(4), none))) == Words{"left 4", "left 5"}));
  ck_assert(tracks(report.update(frame(seconds(5), one))) == Words{"appeared 4"});
  ck_assert(tracks(report.end()) == Words{"left 4"} && report.end().empty());
}
END_TEST

START_TEST(a_track_names_its_witnesses) {
  const json both({"motion", "person"}), shape({"person"}), motion({"motion"});
  for (const auto& [moves, person, witnesses] :
       {std::tuple(true, false, motion), std::tuple(true, true, both), std::tuple(false, true, shape)}) {
    MqttReport report("cerberus", "front");
    std::vector<MqttObject> one{walker(4)};
    one[0].motion = moves, one[0].person = person;
    const auto all = report.update(frame(seconds(1), one));
    const MqttMessage* track = find(all, "cerberus/front/track");
    ck_assert(track && json::parse(track->payload)["witnesses"] == witnesses);
  }
}
END_TEST

START_TEST(a_stream_that_begins_anew_has_no_track_of_the_one_before) {
  MqttReport report("cerberus", "front");
  const std::vector<MqttObject> one{walker(4)}, none;
  report.update(frame(seconds(100), one));
  ck_assert(tracks(report.update(frame(seconds(1), none))) == Words{"left 4"});
}
END_TEST

START_TEST(states_are_retained_and_published_when_they_change) {
  MqttReport report("cerberus", "front");
  const std::vector<MqttObject> one{walker(4)}, none;
  std::vector<MqttMessage> out = report.update(frame(seconds(1), none));
  const MqttMessage* state = find(out, "cerberus/front/state");
  ck_assert(state && state->retain &&
            json::parse(state->payload) == json({{"motion", false}, {"objects", 0}}));
  ck_assert(report.update(frame(seconds(2), none)).empty());
  out = report.update(frame(seconds(3), one));
  state = find(out, "cerberus/front/state");
  ck_assert(state && json::parse(state->payload) == json({{"motion", true}, {"objects", 1}}));

  MqttFrame fused = frame(seconds(4), one);
  const std::vector<std::uint8_t> readings{0, 1, 2};
  fused.sensors = readings;
  fused.decision = {6, "right \"sensor\"", "turn-right", 0};
  out = report.update(fused);
  ck_assert(json::parse(find(out, "cerberus/front/pir")->payload) == json({{"sensors", {0, 1, 2}}}));
  ck_assert(json::parse(find(out, "cerberus/front/rule")->payload) ==
            json({{"rule", 6}, {"name", "right \"sensor\""}, {"action", "turn-right"}, {"target", nullptr}}));
  fused.time = seconds(4) + milliseconds(40);
  ck_assert(report.update(fused).empty());
}
END_TEST

START_TEST(a_frame_that_no_detector_saw_says_nothing_about_motion) {
  MqttReport report("cerberus", "front");
  MqttFrame blind;
  blind.time = seconds(1);
  ck_assert(report.update(blind).empty());
}
END_TEST

START_TEST(nothing_moves_any_more_when_the_stream_ends_or_no_frame_comes) {
  const std::vector<MqttObject> one{walker(4)};
  const std::vector<std::uint8_t> readings{0, 1};
  for (const bool ends : {true, false}) {
    MqttReport report("cerberus", "front");
    ck_assert(json::parse(find(report.begin(), "cerberus/front/state")->payload)["motion"] == false);
    MqttFrame moving = frame(seconds(1), one);
    moving.arrival = seconds(500);
    moving.sensors = readings;
    moving.head = {10, 0, true};
    moving.decision = {1, "camera", "track", 4};
    report.update(moving);
    moving.time += milliseconds(400);
    moving.arrival += milliseconds(400);
    ck_assert(report.update(moving).empty());
    ck_assert(report.check(seconds(503)).empty());  // 2 s, and twice the .4 s between two frames
    const auto out = ends ? report.end() : report.check(seconds(503) + milliseconds(200));
    ck_assert(json::parse(find(out, "cerberus/front/state")->payload) ==
              json({{"motion", false}, {"objects", 0}}));
    ck_assert(json::parse(find(out, "cerberus/front/pantilt")->payload)["moving"] == false);
    ck_assert(json::parse(find(out, "cerberus/front/pir")->payload) == json({{"sensors", {2, 2}}}));
    ck_assert(json::parse(find(out, "cerberus/front/rule")->payload)["target"] == nullptr);
    ck_assert(tracks(out) == Words{"left 4"});
    ck_assert(report.check(seconds(600)).empty() && report.end().empty());
    moving.arrival = seconds(700);
    ck_assert(json::parse(find(report.update(moving), "cerberus/front/state")->payload)["motion"] == true);
  }
}
END_TEST

START_TEST(motion_lasts_from_frame_to_frame_of_a_slow_camera) {
  const std::vector<MqttObject> one{walker(4)};
  MqttReport report("cerberus", "front");
  int states = 0;
  for (int second = 0; second <= 30; ++second) {
    MqttFrame slow = frame(seconds(second), one);
    slow.arrival = seconds(second);
    const auto out = second % 3 == 0 ? report.update(slow) : report.check(seconds(second));
    // The distance is known from the second frame on.
    if (second > 3) states += find(out, "cerberus/front/state") != nullptr;
  }
  ck_assert_int_eq(states, 0);
  ck_assert(report.check(seconds(37)).empty());
  ck_assert(tracks(report.check(seconds(38))) == Words{"left 4"});
  // A long silence is no distance of frames.
  const auto back = [&](int second) {
    MqttFrame again = frame(seconds(second), one);
    again.arrival = seconds(second);
    report.update(again);
  };
  back(4000);
  ck_assert(report.check(seconds(4021)).empty());
  ck_assert(tracks(report.check(seconds(4022))) == Words{"left 4"});
  back(4100);
  back(4101);
  ck_assert(report.check(seconds(4104)).empty());
  ck_assert(tracks(report.check(seconds(4105))) == Words{"left 4"});
  // Nor does a stream that has ended say anything of the next one.
  report.end();
  back(4110);
  ck_assert(report.check(seconds(4111)).empty());
  ck_assert(tracks(report.check(seconds(4112))) == Words{"left 4"});
}
END_TEST

START_TEST(a_stream_without_a_detector_ends_without_a_word_about_motion) {
  MqttReport report("cerberus", "front");
  report.update({});
  ck_assert(report.end().empty());
}
END_TEST

START_TEST(every_retained_topic_of_a_camera_is_known) {
  const MqttReport report("cerberus", "front");
  const auto has = [](const Words& all, const char* topic) { return std::ranges::count(all, topic) == 1; };
  const Words little = report.retained_topics("", {}),
              all = report.retained_topics("homeassistant", {3, true, true});
  ck_assert_uint_eq(little.size(), 4);
  for (const char* topic :
       {"cerberus/front/status", "cerberus/front/mode", "cerberus/front/state", "cerberus/front/rule"})
    ck_assert(has(little, topic) && has(all, topic));
  for (const char* topic :
       {"cerberus/front/pir", "cerberus/front/pantilt", "cerberus/front/event", "cerberus/front/recording",
        "homeassistant/binary_sensor/cerberus_front/pir_2/config",
        "homeassistant/sensor/cerberus_front/tilt/config"})
    ck_assert_msg(has(all, topic), "%s", topic);
}
END_TEST

START_TEST(a_moving_head_is_reported_twice_a_second_and_when_it_rests) {
  MqttReport report("cerberus", "front");
  MqttFrame now;
  int reports = 0;
  std::string last;
  for (int k = 0; k <= 50; ++k) {  // 2 s at 25 frames a second
    now.time = milliseconds(40 * k);
    now.head = {.5 * k, -2, k < 50};
    const std::vector<MqttMessage> out = report.update(now);
    reports += static_cast<int>(out.size());
    if (!out.empty()) last = out.back().payload;
  }
  // At 0, 520, 1040, 1560 ms (the first frame 500 ms after the one before), and at rest at 2000.
  ck_assert_int_eq(reports, 5);
  ck_assert(json::parse(last) == json({{"pan", 25}, {"tilt", -2}, {"moving", false}}));
}
END_TEST

START_TEST(home_assistant_finds_each_sensor_once_and_where_it_is_published) {
  const MqttReport report("cerberus", "front");
  const std::vector<MqttMessage> all = report.discovery("homeassistant", {2, true, true});
  // motion, objects, mode, rule, pir 0 and 1, recording and its fault, pan, tilt
  ck_assert_uint_eq(all.size(), 10);
  std::vector<std::string> identities;
  for (const MqttMessage& one : all) {
    const json read = json::parse(one.payload);
    ck_assert(one.retain && read["availability_topic"] == "cerberus/front/status");
    identities.push_back(read["unique_id"]);
  }
  std::ranges::sort(identities);
  ck_assert(std::ranges::adjacent_find(identities) == identities.end());
  const MqttMessage* pir = find(all, "homeassistant/binary_sensor/cerberus_front/pir_1/config");
  ck_assert(pir && json::parse(pir->payload)["state_topic"] == "cerberus/front/pir");
  ck_assert_uint_eq(report.discovery("homeassistant", {}).size(), 3);
}
END_TEST

START_TEST(discovery_is_repeated_only_when_sensors_or_head_are_others) {
  MqttReport report("cerberus", "front");
  const std::array<std::uint8_t, 2> sensors{};
  MqttFrame frame;
  ck_assert_uint_eq(report.discovery_of(frame, "homeassistant", false).size(), 3);
  ck_assert(report.discovery_of(frame, "homeassistant", false).empty());
  frame.sensors = sensors;
  ck_assert_uint_eq(report.discovery_of(frame, "homeassistant", false).size(), 6);  // and rule, pir 0 and 1
  frame.head.emplace();
  ck_assert_uint_eq(report.discovery_of(frame, "homeassistant", false).size(), 8);  // and pan, tilt
  ck_assert(report.discovery_of(frame, "homeassistant", false).empty());
}
END_TEST

START_TEST(an_order_is_taken_only_where_it_is_allowed_and_whole) {
  std::string error;
  const auto move = parse_mqtt_command("move-to", "10 -5.5", "stop,move-to", error);
  ck_assert(move && move->first == 10 && move->second == -5.5);
  ck_assert(parse_mqtt_command("stop", "PRESS", "stop move-to", error).has_value());
  ck_assert(parse_mqtt_command("follow", "7", "follow", error)->first == 7);
  for (const auto& [name, payload, allowed] : std::vector<std::array<const char*, 3>>{
           {"move-to", "10 -5", ""},           {"move-to", "10 -5", "move-by"},
           {"move", "1 1", "move-to"},         {"move-to", "10", "move-to"},
           {"move-to", "10 x", "move-to"},     {"move-to", "10 5 6", "move-to"},
           {"move-to", "nan 0", "move-to"},    {"move-by", "1e999 0", "move-by"},
           {"move-to", "1e9 0", "move-to"},    {"move-to", "0 -360.5", "move-to"},
           {"move-by", "-1e9 0", "move-by"},   {"move-to", "inf 0", "move-to"},
           {"follow", "-1", "follow"},         {"follow", "0", "follow"},
           {"follow", "nan", "follow"},        {"follow", "1.5", "follow"},
           {"follow", "4294967296", "follow"}, {"", "", ""},
           {"format", "", "format"},           {"stop", "", "st op"}})
    ck_assert_msg(!parse_mqtt_command(name, payload, allowed, error), "%s %s %s", name, payload, allowed);
  ck_assert(!parse_mqtt_command("stop", std::string(65, 'x'), "stop", error));
}
END_TEST

START_TEST(of_a_flood_ten_are_reported_at_once_and_then_one_a_second) {
  BurstLimit limit;
  int reported = 0;
  for (int k = 0; k < 10000; ++k) reported += limit.take(seconds(100)) ? 1 : 0;
  ck_assert_int_eq(reported, 10);
  ck_assert(!limit.take(seconds(100) + milliseconds(999)));
  ck_assert(limit.take(milliseconds(101500)) && !limit.take(milliseconds(101900)));
  for (int k = 0; k < 20; ++k) reported += limit.take(seconds(200)) ? 1 : 0;
  ck_assert_int_eq(reported, 20);
}
END_TEST

START_TEST(events_for_a_webhook_are_sent_in_order_one_at_a_time_and_again_after_failures) {
  WebhookQueue queue;
  const WebhookQueue::Time start{std::chrono::hours(1)};
  ck_assert(queue.next(start) == nullptr);
  for (const char* id : {"a", "b", "c"}) queue.add({id, "{}"});
  ck_assert_str_eq(queue.next(start)->id.c_str(), "a");
  ck_assert(queue.next(start) == nullptr);  // on its way
  // Failures: after 1, 2, 4, ... 60 s.
  WebhookQueue::Time now = start;
  for (const int wait : {1, 2, 4, 8, 16, 32, 60, 60}) {
    queue.finished(WebhookQueue::Outcome::failed, now);
    ck_assert(queue.next(now + seconds(wait) - milliseconds(1)) == nullptr);
    now += seconds(wait);
    ck_assert_str_eq(queue.next(now)->id.c_str(), "a");
  }
  queue.finished(WebhookQueue::Outcome::delivered, now);
  ck_assert_str_eq(queue.next(now)->id.c_str(), "b");
  queue.finished(WebhookQueue::Outcome::refused, now);
  ck_assert_uint_eq(queue.dropped(), 1);
  ck_assert_str_eq(queue.next(now)->id.c_str(), "c");
}
END_TEST

START_TEST(a_webhook_that_does_not_answer_costs_256_events_and_no_more) {
  WebhookQueue queue;
  const WebhookQueue::Time now{std::chrono::hours(1)};
  queue.add({"0", ""});
  ck_assert_str_eq(queue.next(now)->id.c_str(), "0");  // on its way: it is not dropped
  for (int k = 1; k < 300; ++k) queue.add({std::to_string(k), ""});
  ck_assert_uint_eq(queue.waiting(), 256);
  ck_assert_uint_eq(queue.dropped(), 44);
  queue.finished(WebhookQueue::Outcome::delivered, now);
  ck_assert_str_eq(queue.next(now)->id.c_str(), "45");
  using Outcome = WebhookQueue::Outcome;
  for (const auto& [status, outcome] :
       {std::pair(200u, Outcome::delivered), std::pair(204u, Outcome::delivered),
        std::pair(0u, Outcome::failed), std::pair(500u, Outcome::failed), std::pair(503u, Outcome::failed),
        std::pair(408u, Outcome::failed), std::pair(429u, Outcome::failed), std::pair(301u, Outcome::refused),
        std::pair(400u, Outcome::refused), std::pair(410u, Outcome::refused)})
    ck_assert_msg(WebhookQueue::outcome_of(status) == outcome, "%u", status);
}
END_TEST

START_TEST(the_body_of_a_webhook_is_json_with_an_object_or_a_text) {
  const auto body = [](std::string_view data) {
    return json::parse(webhook_body("id-1", "the \"robot\"", "front", "track", seconds(1), data));
  };
  const json object = body("{\"event\":\"left\"}");
  ck_assert(object["data"]["event"] == "left" && object["robot"] == "the \"robot\"" &&
            object["id"] == "id-1");
  ck_assert(object["utc"] == "1970-01-01T00:00:01.000000Z" && object["topic"] == "track");
  ck_assert(body("armed")["data"] == "armed" && body("a\"}b")["data"] == "a\"}b");
}
END_TEST

START_TEST(the_fleet_is_what_the_broker_retains) {
  Fleet fleet("cerberus");
  const Fleet::Time now{seconds(1000)};
  const auto take = [&](const std::string& topic, const std::string& payload) {
    return fleet.take(topic, payload, now);
  };
  ck_assert(take("cerberus/front/status", "online") && take("cerberus/front/event", "{\"id\":7}"));
  ck_assert(take("cerberus/back/mode", "armed"));
  // Nothing of other programs, of levels below, of what is too long; a picture makes no camera.
  ck_assert(!take("other/front/status", "online") && !take("cerberus/front/command/stop", ""));
  ck_assert(!take("cerberus/x/picture", "jpeg") && !take("cerberus//status", "online"));
  ck_assert(!take("cerberus/front/mode", std::string(2001, 'a')) && !take("cerberus/gone/status", ""));
  const json all = json::parse(fleet.json());
  ck_assert_uint_eq(all.size(), 2);
  ck_assert(all[0]["name"] == "back" && all[0]["mode"] == "armed" && all[0]["picture"] == 0);
  ck_assert(all[1]["status"] == "online" && all[1]["event"] == "{\"id\":7}" && all[1]["picture"] == 0);
  // A camera whose status is cleared is gone.
  ck_assert(take("cerberus/back/status", "offline") && take("cerberus/back/status", ""));
  ck_assert_uint_eq(json::parse(fleet.json()).size(), 1);
  for (int k = 0; k < 1000; ++k) take("cerberus/" + std::to_string(k) + "/status", "online");
  ck_assert_uint_eq(json::parse(fleet.json()).size(), Fleet::kMost);
}
END_TEST

START_TEST(a_picture_of_the_fleet_was_asked_for_in_the_last_30_seconds_and_ends_with_privacy) {
  Fleet fleet("cerberus");
  const Fleet::Time now{seconds(1000)};
  const auto add = [&](const std::string& name) {
    fleet.take("cerberus/" + name + "/status", "online", now);
  };
  const auto send = [&](const std::string& name, Fleet::Time at) {
    return fleet.take("cerberus/" + name + "/picture", "jpeg of " + name, at);
  };
  add("front");
  ck_assert(!send("front", now) && !fleet.ask("back", now) && fleet.ask("front", now));
  ck_assert(!send("front", now + seconds(31)) && fleet.picture("front") == nullptr);
  ck_assert(send("front", now + seconds(30)));
  ck_assert_str_eq(fleet.picture("front")->c_str(), "jpeg of front");
  ck_assert(json::parse(fleet.json())[0]["picture"] == 1);
  fleet.take("cerberus/front/mode", "privacy", now);
  ck_assert(fleet.picture("front") == nullptr && json::parse(fleet.json())[0]["picture"] == 0);
  fleet.ask("front", now);
  ck_assert(!send("front", now));
  fleet.take("cerberus/front/mode", "armed", now);
  fleet.ask("front", now);
  ck_assert(send("front", now) && json::parse(fleet.json())[0]["picture"] == 2);
  // The newest 16 are kept.
  for (int k = 0; k < 16; ++k) {
    add(std::to_string(k));
    fleet.ask(std::to_string(k), now);
    ck_assert(send(std::to_string(k), now));
  }
  ck_assert(fleet.picture("front") == nullptr && fleet.picture("0") != nullptr &&
            fleet.picture("15") != nullptr);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "MQTT report",
      {a_track_appears_is_updated_each_second_and_leaves_two_seconds_after_its_last_sight,
       a_stream_that_begins_anew_has_no_track_of_the_one_before,
       states_are_retained_and_published_when_they_change,
       a_frame_that_no_detector_saw_says_nothing_about_motion,
       nothing_moves_any_more_when_the_stream_ends_or_no_frame_comes,
       motion_lasts_from_frame_to_frame_of_a_slow_camera,
       a_stream_without_a_detector_ends_without_a_word_about_motion,
       every_retained_topic_of_a_camera_is_known, a_moving_head_is_reported_twice_a_second_and_when_it_rests,
       home_assistant_finds_each_sensor_once_and_where_it_is_published,
       discovery_is_repeated_only_when_sensors_or_head_are_others,
       an_order_is_taken_only_where_it_is_allowed_and_whole,
       of_a_flood_ten_are_reported_at_once_and_then_one_a_second,
       events_for_a_webhook_are_sent_in_order_one_at_a_time_and_again_after_failures,
       a_webhook_that_does_not_answer_costs_256_events_and_no_more, the_fleet_is_what_the_broker_retains,
       a_picture_of_the_fleet_was_asked_for_in_the_last_30_seconds_and_ends_with_privacy,
       a_track_names_its_witnesses, the_body_of_a_webhook_is_json_with_an_object_or_a_text});
}
