// SPDX-License-Identifier: LGPL-2.1-or-later
// What a streaming server decides: when a keyframe is asked for, which frames a receiver gets, who its users are.
#include <string>

#include "publish/streams/keyframe_requests.h"
#include "publish/streams/stream_gate.h"
#include "publish/streams/users.h"
#include "support/suite.h"

using namespace cerberus::publish;
using namespace std::chrono_literals;

namespace {

void assert_wrong(const std::string& text, const std::string& expected) {
  std::vector<User> users;
  const std::string wrong = parse_users(text, users);
  ck_assert_msg(wrong == expected, "\"%s\"", wrong.c_str());
  ck_assert(users.empty());
}

}  // namespace

START_TEST(the_encoder_is_asked_at_once_for_the_first_receiver) {
  KeyframeRequests requests;
  ck_assert(requests.request(10s));
}
END_TEST

START_TEST(receivers_that_come_before_the_keyframe_share_it) {
  KeyframeRequests requests;
  ck_assert(requests.request(10s));
  ck_assert(!requests.request(10s + 500ms));
  ck_assert(!requests.frame(10s + 500ms, true));
  ck_assert(!requests.frame(20s, false));  // nothing is left over
}
END_TEST

START_TEST(a_request_that_follows_closely_waits_for_the_interval) {
  KeyframeRequests requests;
  ck_assert(requests.request(10s));
  ck_assert(!requests.frame(10s + 40ms, true));
  ck_assert(!requests.request(10s + 80ms));
  ck_assert(!requests.frame(10s + 199ms, false));
  ck_assert(requests.frame(10s + 200ms, false));
  ck_assert(!requests.frame(10s + 240ms, true));
  ck_assert(requests.request(10s + 400ms));
}
END_TEST

START_TEST(a_keyframe_of_the_encoders_own_serves_a_request_that_waits) {
  KeyframeRequests requests;
  ck_assert(requests.request(10s));
  ck_assert(!requests.frame(10s + 40ms, true));
  ck_assert(!requests.request(10s + 80ms));
  ck_assert(!requests.frame(10s + 120ms, true));
  ck_assert(!requests.frame(11s, false));
}
END_TEST

START_TEST(a_request_that_the_encoder_lost_is_repeated) {
  KeyframeRequests requests;
  ck_assert(requests.request(10s));
  ck_assert(!requests.frame(10s + 999ms, false));
  ck_assert(requests.frame(11s, false));
  ck_assert(!requests.frame(11s + 999ms, false));
  ck_assert(requests.frame(12s, false));
}
END_TEST

START_TEST(a_receiver_is_described_by_one_keyframe_and_begins_with_the_next_after_play) {
  StreamGate gate;
  ck_assert(!gate.pass(false, 0));
  ck_assert(gate.wants_keyframe(0));
  ck_assert(gate.pass(true, 0));
  ck_assert(!gate.wants_keyframe(1));
  ck_assert(!gate.pass(false, 1));
  ck_assert(!gate.pass(true, 1));  // it would be old when a client plays
  gate.play();
  ck_assert(gate.wants_keyframe(1));
  ck_assert(!gate.pass(false, 0));
  ck_assert(gate.pass(true, 0));
  ck_assert(gate.pass(false, 1));
}
END_TEST

START_TEST(a_receiver_whose_client_plays_first_flows_from_its_first_keyframe_on) {
  StreamGate gate;
  gate.play();
  ck_assert(gate.pass(true, 0));
  ck_assert(gate.pass(false, 0));
}
END_TEST

START_TEST(a_second_client_does_not_interrupt_the_first) {
  StreamGate gate;
  gate.pass(true, 0);
  gate.play();
  gate.pass(true, 0);
  gate.play();
  ck_assert(gate.pass(false, 0));
}
END_TEST

START_TEST(a_receiver_that_takes_nothing_is_cut_off_and_begins_again_at_a_keyframe) {
  StreamGate gate;
  gate.play();
  gate.pass(true, 0);
  ck_assert(gate.pass(false, 29));
  ck_assert(!gate.pass(false, 30));
  ck_assert(!gate.pass(true, 30));
  ck_assert(!gate.wants_keyframe(30));  // it has no room: no keyframe is asked for in vain
  ck_assert(!gate.pass(false, 0));
  ck_assert(gate.wants_keyframe(0));
  ck_assert(gate.pass(true, 0));
  ck_assert(gate.pass(false, 0));
}
END_TEST

START_TEST(users_are_lines_of_name_and_password) {
  std::vector<User> users;
  const std::string text = "# who may watch\n\nanna:se:cret word\r\nbo_2:\xc3\xa4\n#x:y\nc.d@e:1";
  ck_assert(parse_users(text, users).empty());
  ck_assert_uint_eq(users.size(), 3);
  ck_assert_str_eq(users[0].name.c_str(), "anna");
  ck_assert_str_eq(users[0].password.c_str(), "se:cret word");
  ck_assert_str_eq(users[1].password.c_str(), "\xc3\xa4");
  ck_assert_str_eq(users[2].name.c_str(), "c.d@e");
  ck_assert_str_eq(users[2].password.c_str(), "1");
}
END_TEST

START_TEST(a_wrong_line_is_named_by_its_number_and_without_the_password) {
  assert_wrong("", "there is no user in it: a user is a line NAME:PASSWORD");
  assert_wrong("# nothing\n", "there is no user in it: a user is a line NAME:PASSWORD");
  assert_wrong("a:b\n\nsecret\n", "line 3 has no colon: a user is NAME:PASSWORD");
  assert_wrong(":secret", "line 1 has no name before the colon");
  assert_wrong("anna:", "line 1 has no password after the colon");
  assert_wrong("an na:secret",
               "line 1 has a name with a blank, a quote, a backslash or a letter beyond ASCII");
  assert_wrong("an\"na:secret",
               "line 1 has a name with a blank, a quote, a backslash or a letter beyond ASCII");
  assert_wrong("\xc3\xa4:secret",
               "line 1 has a name with a blank, a quote, a backslash or a letter beyond ASCII");
  assert_wrong(std::string("anna:se\0cret", 12), "line 1 has a password with a control character");
  assert_wrong("anna:se\tcret", "line 1 has a password with a control character");
  assert_wrong("anna:1\nbo:2\nanna:3\n", "line 3 names a user for the second time");
  assert_wrong(std::string(65, 'a') + ":b", "line 1 has a name of more than 64 characters");
  assert_wrong("a:" + std::string(1025, 'b'), "line 1 has a password of more than 1024 bytes");
}
END_TEST

START_TEST(a_thousand_users_are_the_most) {
  std::string text;
  for (int k = 0; k < 1000; ++k) text += "user" + std::to_string(k) + ":x\n";
  std::vector<User> users;
  ck_assert(parse_users(text, users).empty());
  ck_assert_uint_eq(users.size(), 1000);
  assert_wrong(text + "one:more\n", "line 1001 is the 1001st user: 1000 are the most");
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "streams",
      {the_encoder_is_asked_at_once_for_the_first_receiver, receivers_that_come_before_the_keyframe_share_it,
       a_request_that_follows_closely_waits_for_the_interval,
       a_keyframe_of_the_encoders_own_serves_a_request_that_waits,
       a_request_that_the_encoder_lost_is_repeated,
       a_receiver_is_described_by_one_keyframe_and_begins_with_the_next_after_play,
       a_receiver_whose_client_plays_first_flows_from_its_first_keyframe_on,
       a_second_client_does_not_interrupt_the_first,
       a_receiver_that_takes_nothing_is_cut_off_and_begins_again_at_a_keyframe,
       users_are_lines_of_name_and_password, a_wrong_line_is_named_by_its_number_and_without_the_password,
       a_thousand_users_are_the_most});
}
