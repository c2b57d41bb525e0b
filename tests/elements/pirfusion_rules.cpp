// SPDX-License-Identifier: LGPL-2.1-or-later
// pirfusion's rules: the paper's, and those that a user wrote.
#include <span>

#include "fusion_rig.h"

namespace {

using namespace rig;

struct Expected {
  int rule;
  CerberusFusionAction action;
};

// The paper's rules (II.D), written down anew: order 1, 5, 6, 2, 3, 4, 7; rules 2-4 turn AT their edge, 5-6 track at
// it. "Camera Tracking" without a target is standing still.
Expected paper(bool camera, bool i1, bool i2, bool i3, double a) {
  const auto turn = [](int rule, bool right, bool left) {
    return Expected{rule, right  ? CERBERUS_FUSION_TURN_RIGHT
                          : left ? CERBERUS_FUSION_TURN_LEFT
                                 : CERBERUS_FUSION_HOLD};
  };
  if (camera) return {1, CERBERUS_FUSION_TRACK};
  if (i1 && i2) return turn(5, a < -90, a > 0);
  if (i1 && i3) return turn(6, a < 0, a > 120);
  if (i1) return turn(2, a <= -45, a >= 45);
  if (i2) return turn(3, a <= -120, a >= -60);
  if (i3) return turn(4, a <= 60, a >= 120);
  return {7, CERBERUS_FUSION_ZERO};
}

// The element's answer when its state is raised; its error message.
std::string refusal(const std::string& properties) {
  const std::string line = "pirfusion " + properties;
  GstElement* element = gst_parse_launch(line.c_str(), nullptr);
  gst_object_ref_sink(element);
  g_autoptr(GstBus) bus = gst_bus_new();
  gst_element_set_bus(element, bus);
  std::string text;
  if (gst_element_set_state(element, GST_STATE_READY) == GST_STATE_CHANGE_FAILURE) {
    g_autoptr(GstMessage) message = gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR);
    fail_unless(message, "refused without a word");
    g_autoptr(GError) error = nullptr;
    gst_message_parse_error(message, &error, nullptr);
    text = error->message;
    fail_if(gst_bus_have_pending(bus) && gst_bus_pop_filtered(bus, GST_MESSAGE_ERROR),
            "one message a failure");
  }
  gst_element_set_state(element, GST_STATE_NULL);
  gst_element_set_bus(element, nullptr);
  gst_object_unref(element);
  return text;
}

const char kTwoSensors[] = R"(
name = "mine"
sensors = 2
[[rule]]
number = 40
name = "person"
camera = "found"
action = "track"
[[rule]]
number = 41
name = "gate"
camera = "missing"
any = [1, 2]
action = "search"
sweep = [-90, -45]
[[rule]]
number = 42
name = "quiet"
camera = "missing"
none = [1, 2]
action = "hold"
)";

}  // namespace

// The pan angles of the issue, for all 16 states of camera and sensors: 416 cells.
GST_START_TEST(the_papers_table_holds_through_the_element) {
  Rig rig(true, "rules=paper");
  rig.add_pir();
  std::vector<double> angles = {-170, 170};
  for (const double edge : {-120, -90, -60, -45, 0, 45, 60, 120})
    for (const double off : {-0.1, 0.0, 0.1}) angles.push_back(edge + off);
  GstClockTime time = 0;
  int cells = 0;
  for (const double angle : angles)
    for (int state = 0; state < 16; ++state) {
      const bool camera = state & 8, i1 = state & 1, i2 = state & 2, i3 = state & 4;
      time += 40 * kMs;
      rig.read(time, {guint8(i1), guint8(i2), guint8(i3)});
      GstBuffer* buffer = camera ? frame_with(time, 3) : frame(time);
      const CerberusPose where = pose(angle, time);
      cerberus_buffer_set_pose(buffer, &where);
      const CerberusFusion fusion = rig.show(buffer);
      const Expected expected = paper(camera, i1, i2, i3, angle);
      fail_unless(fusion.rule == expected.rule && fusion.action == expected.action,
                  "camera %d, sensors %d%d%d, pan %g: rule %d, %s", camera, i1, i2, i3, angle, fusion.rule,
                  cerberus_fusion_action_get_nick(fusion.action));
      fail_unless(fusion.pan == angle && fusion.camera_found == camera);
      fail_unless(sensors(fusion) == Bytes({guint8(i1), guint8(i2), guint8(i3)}));
      ++cells;
    }
  fail_unless_equals_int(cells, 416);
}
GST_END_TEST

GST_START_TEST(a_users_own_rules_are_followed) {
  const RuleFile file(kTwoSensors);
  Rig rig(true, file.property());
  rig.add_pir();
  rig.read(0, {0, 0, 1});  // a third sensor, which the table does not mention
  CerberusFusion fusion = rig.at(0);
  fail_unless_equals_int(fusion.rule, 42);
  fail_unless_equals_string(fusion.rule_name, "quiet");
  rig.read(40 * kMs, {0, 1, 0});
  fusion = rig.at(40 * kMs);
  fail_unless_equals_string(fusion.rule_name, "gate");
  fail_unless_equals_int(fusion.action, CERBERUS_FUSION_SEARCH);
  fail_unless(std::abs(fusion.sector_from + 90) < 1e-9 && std::abs(fusion.sector_to + 45) < 1e-9);
  fail_unless_equals_string(rig.show(frame_with(80 * kMs, 2)).rule_name, "person");
}
GST_END_TEST

GST_START_TEST(rules_that_cannot_be_used_are_refused_and_the_case_is_named) {
  const std::string whole = kTwoSensors;
  const std::string found = whole.substr(0, whole.find("[[rule]]\nnumber = 41"));
  const RuleFile gap(found +
                     "[[rule]]\nnumber = 42\ncamera = \"missing\"\nnone = [1, 2]\naction = \"hold\"\n");
  const RuleFile contradiction(whole + "[[rule]]\nnumber = 43\nall = [1, 2]\naction = \"zero\"\n");
  const RuleFile unknown(whole + "[[rule]]\naction = \"left\"\n");
  const RuleFile broken("sensors = = 2\n");
  const struct {
    const RuleFile& file;
    std::vector<const char*> words;
  } cases[] = {
      {gap, {"camera not found", "infer1", "no rule applies"}},
      {contradiction, {"camera found", "infer1 and infer2 fired", "person says track", "rule 43 says zero"}},
      {unknown, {"unknown action \"left\""}},
      {broken, {":1"}}};
  for (const auto& c : cases) {
    const std::string text = refusal(c.file.property());
    fail_unless(text.find(c.file.path()) != std::string::npos, "%s", text.c_str());
    for (const char* word : c.words)
      fail_unless(text.find(word) != std::string::npos, "\"%s\" is not in: %s", word, text.c_str());
  }
  fail_unless(refusal("rules-file=/nowhere/rules.toml").find("/nowhere/rules.toml") != std::string::npos);
  fail_unless(refusal("pan-min=20 pan-max=10").find("pan-min 20 and pan-max 10") != std::string::npos);
  fail_unless(refusal("pan-min=20").find("pan-min 20 and pan-max 170 exclude 0") != std::string::npos);
  fail_unless(refusal("pan-max=-1").find("pan-min -170 and pan-max -1 exclude 0") != std::string::npos);
  std::string gone;
  {
    const RuleFile temporary(whole);
    gone = temporary.property();
    fail_unless(refusal(gone).empty());
  }
  fail_if(refusal(gone).empty());
  fail_unless(refusal("rules=paper").empty() && refusal("").empty());
}
GST_END_TEST

GST_START_TEST(rules_may_change_while_playing_and_bad_ones_leave_the_old) {
  RuleFile file(kTwoSensors);
  Rig rig(true, "return-delay=0");
  fail_unless_equals_int(rig.at(0).rule, 7);
  g_object_set(rig.element, "rules-file", file.path().c_str(), nullptr);
  fail_unless_equals_int(rig.at(40 * kMs).rule, 42);
  file.write("sensors = 1\n");
  g_object_set(rig.element, "rules-file", file.path().c_str(), nullptr);
  const std::string warning = rig.warning();
  fail_unless(warning.find(file.path()) != std::string::npos, "%s", warning.c_str());
  fail_unless_equals_int(rig.at(80 * kMs).rule, 42);
  const auto path_is = [&](const std::string& expected) {
    g_autofree gchar* path = nullptr;
    g_object_get(rig.element, "rules-file", &path, nullptr);
    assert_says(path ? path : "", expected.c_str());
  };
  g_object_set(rig.element, "rules-file", "/nowhere/rules.toml", nullptr);
  fail_unless(rig.warning().find("/nowhere/rules.toml") != std::string::npos);
  path_is(file.path());  // its rules still run
  g_object_set(rig.element, "rules-file", "", nullptr);
  path_is("");
  fail_unless_equals_int(rig.at(120 * kMs).rule, 7);
  fail_unless(rig.warning().empty() && rig.error().empty());
}
GST_END_TEST

GST_START_TEST(rules_beyond_the_limits_are_warned_of) {
  std::string whole = kTwoSensors;
  whole.replace(whole.find("[-90, -45]"), 10, "[175, 185]");
  const RuleFile file(whole);
  {
    Rig rig(true, file.property());
    const std::string warning = rig.warning();
    fail_unless(warning.find("gate: the sweep from 175 to 185 degrees") != std::string::npos, "%s",
                warning.c_str());
    fail_unless(warning.find(file.path()) != std::string::npos && rig.warning().empty());
  }
  Rig rig(true, file.property() + " pan-max=180");
  fail_unless(rig.warning().empty());
}
GST_END_TEST

GST_START_TEST(rules_for_another_number_of_sensors_are_warned_of_once) {
  const RuleFile two(kTwoSensors);
  const auto said = [](const std::string& rules, int sensors, int frames = 3) {
    Rig rig(true, rules);
    rig.add_pir(nullptr);
    rig.at(0);  // the number of sensors is not known yet
    fail_unless(rig.warning().empty());
    gst_harness_set_src_caps_str(rig.pir[0], with_sensors(sensors, 0, 30).c_str());
    for (int i = 1; i <= frames; ++i) {
      rig.read(static_cast<GstClockTime>(i) * 40 * kMs, Bytes(static_cast<std::size_t>(sensors), 0));
      rig.at(static_cast<GstClockTime>(i) * 40 * kMs);
    }
    const std::string text = rig.warning();
    fail_unless(rig.warning().empty());
    return text;
  };
  for (const int sensors : {1, 2, 5}) {
    const std::string text = said("rules=paper", sensors);
    fail_unless(
        text.starts_with("rules=paper is for 3 PIR sensors, and there are " + std::to_string(sensors)), "%s",
        text.c_str());
  }
  fail_unless(said("rules=paper", 3).empty());
  fail_unless(said("rules=complete", 5).empty());
  fail_unless(said(two.property(), 2).empty());
  fail_unless(said(two.property(), 3).starts_with(two.path() + " is for 2 PIR sensors, and there are 3"));
}
GST_END_TEST

GST_START_TEST(a_head_of_another_name_is_warned_of_once) {
  for (const bool own : {false, true}) {
    Rig rig(true, "head=eye");
    for (GstClockTime time = 0; time <= 5 * GST_SECOND; time += 500 * kMs) {
      say(rig, pose(0, time, 0, "tail"));
      if (own) say(rig, pose(0, time, 0, "eye"));
      rig.at(time);
      const std::string text = rig.warning();
      fail_unless(text.empty() == (own || time != 2 * GST_SECOND), "%s", text.c_str());
      if (!text.empty())
        fail_unless(text.find("\"tail\"") != std::string::npos && text.find("\"eye\"") != std::string::npos,
                    "%s", text.c_str());
    }
  }
  Rig silent(true, "head=eye");  // without any head there is nothing to report
  for (GstClockTime time = 0; time <= 5 * GST_SECOND; time += 500 * kMs) silent.at(time);
  fail_unless(silent.warning().empty());
}
GST_END_TEST

GST_START_TEST(a_rule_that_never_applies_is_refused) {
  const std::string whole = kTwoSensors;
  const RuleFile file("sensors = 2\nprecedence = \"order\"\n[[rule]]\nname = \"first\"\naction = \"hold\"\n" +
                      whole.substr(whole.find("[[rule]]")));
  const std::string text = refusal(file.property());
  fail_unless(text.find("gate never applies") != std::string::npos, "%s", text.c_str());
}
GST_END_TEST

// Each property is set to its present value: in the middle of a search nothing changes, and nothing is published.
GST_START_TEST(a_property_that_is_set_ends_no_search) {
  const RuleFile file(kTwoSensors);
  const std::string all[] = {"rules=complete", "rules=paper", file.property()};
  for (const std::string& rules : all) {
    Rig rig(true, rules);
    rig.add_pir();
    rig.read(0, {0, 0, 0});
    rig.show(frame_at(0, -100));
    rig.read(40 * kMs, {0, 1, 0});
    rig.show(frame_at(40 * kMs, -100));
    rig.read(80 * kMs, {0, 0, 0});
    CerberusFusion before = rig.show(frame_at(80 * kMs, -100));
    rig.posted();
    GstClockTime time = 80 * kMs;
    guint count = 0;
    g_autofree GParamSpec** specs = g_object_class_list_properties(G_OBJECT_GET_CLASS(rig.element), &count);
    for (GParamSpec* spec : std::span(specs, count)) {
      if (spec->owner_type != G_OBJECT_TYPE(rig.element)) continue;
      GValue value = G_VALUE_INIT;
      g_object_get_property(G_OBJECT(rig.element), spec->name, &value);
      g_object_set_property(G_OBJECT(rig.element), spec->name, &value);
      g_value_unset(&value);
      time += 40 * kMs;
      const CerberusFusion after = rig.show(frame_at(time, -100));
      fail_unless(after.action == before.action && after.rule == before.rule &&
                      g_str_equal(after.rule_name, before.rule_name),
                  "%s was set, and it is %s (%s)", spec->name, cerberus_fusion_action_get_nick(after.action),
                  after.rule_name);
      fail_unless(rig.posted().empty(), "%s was set, and reported", spec->name);
    }
    fail_unless(time > 400 * kMs);
  }
}
GST_END_TEST

static Suite* pirfusion_rules_suite() {
  watch_library_log();
  Suite* s = suite_create("pirfusion_rules");
  TCase* tc = tcase_create("all");
  suite_add_tcase(s, tc);
  tcase_add_test(tc, the_papers_table_holds_through_the_element);
  tcase_add_test(tc, a_users_own_rules_are_followed);
  tcase_add_test(tc, rules_that_cannot_be_used_are_refused_and_the_case_is_named);
  tcase_add_test(tc, rules_may_change_while_playing_and_bad_ones_leave_the_old);
  tcase_add_test(tc, rules_beyond_the_limits_are_warned_of);
  tcase_add_test(tc, rules_for_another_number_of_sensors_are_warned_of_once);
  tcase_add_test(tc, a_head_of_another_name_is_warned_of_once);
  tcase_add_test(tc, a_rule_that_never_applies_is_refused);
  tcase_add_test(tc, a_property_that_is_set_ends_no_search);
  return s;
}

GST_CHECK_MAIN(pirfusion_rules)
