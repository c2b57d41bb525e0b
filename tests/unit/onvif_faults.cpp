// SPDX-License-Identifier: LGPL-2.1-or-later
// What ONVIF cameras do wrong, and users: logins, addresses, spaces, answers that are none, cameras that go away.
#include "support/onvif_rig.h"

#include "support/suite.h"
#include "support/text.h"

using namespace cerberus::drivers;
using namespace cerberus::tests;
using namespace std::chrono_literals;
using cerberus::heads::SoupClientOptions;
using Clock = std::chrono::steady_clock;

namespace {

constexpr char kPassword[] = "hunter2<&>";

SoupClientOptions admin(const std::string& password = kPassword) {
  return {.user = "admin", .password = password, .fingerprint = {}};
}

OnvifFaults with_login() {
  OnvifFaults faults;
  faults.user = "admin";
  faults.password = kPassword;
  return faults;
}

bool holds(const std::string& text, const std::string& part) {
  return text.find(part) != text.npos;
}

// The driver logs in, turns the camera and stops it.
void assert_driven(OnvifCamera& camera, OnvifRig& rig) {
  ck_assert(!rig.served.line("ready").empty());
  ck_assert(rig.served.until([&] { return camera.speed() > 44; }, "move at 45 hold"));
  ck_assert(rig.served.until([&] { return camera.speed() == 0; }, "move hold hold"));
}

std::string refusal(OnvifCamera& camera, SoupClientOptions soup = {}) {
  OnvifRig rig(onvif_options(camera), std::move(soup));
  const std::string fault = rig.served.line("fault");
  ck_assert(!holds(fault, kPassword) && !holds(fault, "hunter2"));
  ck_assert_int_eq(rig.served.status(), 2);
  ck_assert_int_eq(camera.count("ContinuousMove"), 0);
  return fault;
}

void assert_holds(const std::string& text, const char* part) {
  ck_assert_msg(holds(text, part), "\"%s\" does not say \"%s\"", text.c_str(), part);
}

}  // namespace

// The emulated camera refuses a token that is more than 5 s old by its own clock.
START_TEST(a_login_is_made_at_the_cameras_own_time) {
  for (const auto off : {-3h, 0h, 10000h}) {
    OnvifFaults faults = with_login();
    faults.clock = off;
    OnvifCamera camera(faults);
    OnvifRig rig(onvif_options(camera), admin());
    assert_driven(camera, rig);
    ck_assert_int_eq(camera.count("refused"), 0);
    for (const std::string& request : camera.requests()) ck_assert(!holds(request, "hunter2"));
  }
}
END_TEST

START_TEST(a_clock_that_jumps_is_followed) {
  OnvifCamera camera(with_login());
  OnvifRig rig(onvif_options(camera), admin());
  rig.served.line("ready");
  camera.set_clock(1h);
  ck_assert(rig.served.until([&] { return camera.speed() > 44; }, "move at 45 hold"));
}
END_TEST

START_TEST(a_wrong_password_is_tried_once_and_said) {
  OnvifCamera camera(with_login());
  const std::string fault = refusal(camera, admin("wrong"));
  assert_holds(fault, "refuses the login of the user \"admin\" (NotAuthorized: Sender not Authorized)");
  assert_holds(fault, "password-file=");
  ck_assert_int_eq(camera.count("refused"), 1);
}
END_TEST

START_TEST(a_camera_that_demands_a_login_is_a_fault_where_no_user_is_given) {
  OnvifCamera camera(with_login());
  assert_holds(refusal(camera), "demands a login: give user= and password-file=");
}
END_TEST

START_TEST(digest_logins_of_http_are_answered) {
  OnvifFaults faults = with_login();
  faults.http_digest = true;
  OnvifCamera camera(faults);
  OnvifRig rig(onvif_options(camera), admin());
  assert_driven(camera, rig);
}
END_TEST

START_TEST(a_password_goes_in_clear_only_when_asked_for) {
  OnvifFaults faults = with_login();
  faults.clear_only = true;
  {
    OnvifCamera camera(faults);
    refusal(camera, admin());
    for (const std::string& request : camera.requests()) ck_assert(!holds(request, "hunter2"));
  }
  OnvifCamera camera(faults);
  OnvifOptions options = onvif_options(camera);
  options.login.password_text = true;
  OnvifRig rig(options, admin());
  assert_driven(camera, rig);
}
END_TEST

START_TEST(a_camera_that_repeats_the_password_is_not_quoted) {
  OnvifFaults faults = with_login();
  faults.repeats_password = true;
  OnvifCamera camera(faults);
  OnvifOptions options = onvif_options(camera);
  options.login.password_text = true;
  OnvifRig rig(options, admin("another-secret"));
  const std::string fault = rig.served.line("fault");
  assert_holds(fault, "(NotAuthorized)");
  ck_assert(!holds(fault, "another-secret"));
}
END_TEST

START_TEST(a_camera_that_claims_another_host_is_reached_where_it_was_named) {
  OnvifCamera other;
  OnvifFaults faults;
  faults.claims_host = "127.0.0.1.example:" + std::to_string(other.port());
  OnvifCamera camera(faults);
  OnvifRig rig(camera);
  assert_driven(camera, rig);
  ck_assert(other.requests().empty());
}
END_TEST

START_TEST(a_redirection_is_not_followed) {
  OnvifCamera other;
  OnvifFaults faults = with_login();
  faults.redirects = other.device() + "/onvif/ptz";
  OnvifCamera camera(faults);
  OnvifRig rig(onvif_options(camera), admin());
  assert_holds(rig.served.line("fault"),
               "has a PTZ service that does not work: it answers what is no SOAP (HTTP 303)");
  ck_assert(other.requests().empty());
}
END_TEST

START_TEST(cameras_of_several_generations_are_driven) {
  for (int k = 0; k < 5; ++k) {
    OnvifFaults faults;
    faults.bare_ampersand = k == 0;
    faults.no_get_services = k == 1;
    faults.media2_only = k == 2;
    faults.claims_degree_velocity = k == 3;  // and refuses it
    if (k == 4) faults.refuses_timeout = "TimeoutNotSupported";
    OnvifCamera camera(faults);
    OnvifRig rig(camera);
    assert_driven(camera, rig);
    assert_text(camera.timeout(), k == 4 ? "" : "PT1S");
  }
}
END_TEST

START_TEST(a_camera_that_cannot_pan_and_tilt_is_refused) {
  OnvifFaults faults;
  faults.no_ptz_profile = true;
  OnvifCamera camera(faults);
  assert_holds(refusal(camera), "has no profile with a PTZ configuration: it cannot pan and tilt");
  OnvifCamera good;
  OnvifOptions options = onvif_options(good);
  options.login.profile = "main2";
  OnvifRig rig(options);
  assert_holds(rig.served.line("fault"), "has no profile \"main2\" that can pan and tilt; it has moving");
}
END_TEST

START_TEST(a_refused_move_is_reported_in_the_cameras_words) {
  OnvifFaults faults;
  faults.refuses_moves = true;
  OnvifCamera camera(faults);
  OnvifRig rig(camera);
  rig.served.line("ready");
  rig.served.say("move at 45 hold");
  assert_holds(rig.served.line("fault"), "refuses to move: PTZNotSupported: the motors are locked");
}
END_TEST

START_TEST(a_camera_without_stop_is_stopped_by_a_move_at_speed_0) {
  OnvifFaults faults;
  faults.refuses_stop = faults.ignores_timeout = true;
  OnvifCamera camera(faults);
  OnvifRig rig(camera);
  assert_driven(camera, rig);
}
END_TEST

START_TEST(errors_and_garbage_between_good_answers_are_survived) {
  for (const bool garbage : {false, true}) {
    OnvifFaults faults;
    (garbage ? faults.garbage : faults.errors) = 3;
    OnvifCamera camera(faults);
    OnvifRig rig(camera);
    assert_driven(camera, rig);
  }
}
END_TEST

START_TEST(a_camera_that_answers_nothing_but_garbage_is_a_fault_until_it_works_again) {
  OnvifCamera camera;
  OnvifRig rig(camera);
  rig.served.line("ready");
  camera.set_garbage(1000000);
  assert_holds(rig.served.line("fault"), "it answers what is no SOAP (HTTP 200)");
  camera.set_garbage(0);
  assert_text(rig.served.line("recovered"), "recovered");
  ck_assert(rig.served.until([&] { return camera.speed() > 44; }, "move at 45 hold"));
}
END_TEST

START_TEST(a_move_status_that_says_nothing_does_not_hold_up_the_end) {
  using MoveStatus = OnvifFaults::MoveStatus;
  for (const MoveStatus status : {MoveStatus::always_idle, MoveStatus::always_moving, MoveStatus::absent}) {
    OnvifFaults faults;
    faults.move_status = status;
    OnvifCamera camera(faults);
    OnvifRig rig(camera);
    rig.served.line("ready");
    ck_assert(rig.served.until([&] { return camera.pan() > 5; }, "move at 45 hold"));
    const auto end = Clock::now();
    rig.served.hang_up();
    ck_assert_int_eq(rig.served.status(), 0);
    ck_assert(Clock::now() - end < 500ms);
    ck_assert_double_eq(camera.speed(), 0);
  }
}
END_TEST

// The camera turns on while it is away: it ignores its Timeout.
START_TEST(a_camera_that_goes_away_is_reported_within_a_second_and_stands_when_it_is_back) {
  for (const bool silent : {false, true}) {
    OnvifFaults faults;
    faults.ignores_timeout = true;
    OnvifCamera camera(faults);
    OnvifRig rig(camera);
    rig.served.line("ready");
    ck_assert(rig.served.until([&] { return camera.speed() > 44; }, "move at 45 hold"));
    const auto gone = Clock::now();
    silent ? camera.set_silent(true) : camera.set_gone(true);
    const std::string fault = rig.served.line("fault");
    ck_assert(Clock::now() - gone < 1s);
    assert_holds(fault, silent ? "does not answer" : "cannot be reached");
    ck_assert_double_gt(camera.speed(), 44);
    silent ? camera.set_silent(false) : camera.set_gone(false);
    assert_text(rig.served.line("recovered"), "recovered");
    ck_assert_double_eq(camera.speed(), 0);
    ck_assert(rig.served.until([&] { return camera.speed() > 44; }, "move at 45 hold"));
  }
}
END_TEST

START_TEST(a_slow_camera_is_no_fault) {
  OnvifFaults faults;
  faults.delay = 250ms;
  OnvifCamera camera(faults);
  OnvifRig rig(camera);
  assert_driven(camera, rig);
}
END_TEST

START_TEST(an_address_where_nothing_is_is_named) {
  int port = 0;
  {
    const OnvifCamera camera;
    port = camera.port();
  }
  OnvifOptions options;
  ck_assert(onvif::parse_device("127.0.0.1:" + std::to_string(port), options.login.device).empty());
  OnvifRig rig(options);
  const std::string fault = rig.served.line("fault");
  assert_holds(fault,
               ("the ONVIF camera at 127.0.0.1:" + std::to_string(port) + " cannot be reached: ").c_str());
}
END_TEST

int main() {
  return run_suite(
      "onvif_faults",
      {a_login_is_made_at_the_cameras_own_time, a_clock_that_jumps_is_followed,
       a_wrong_password_is_tried_once_and_said,
       a_camera_that_demands_a_login_is_a_fault_where_no_user_is_given, digest_logins_of_http_are_answered,
       a_password_goes_in_clear_only_when_asked_for, a_camera_that_repeats_the_password_is_not_quoted,
       a_camera_that_claims_another_host_is_reached_where_it_was_named, a_redirection_is_not_followed,
       cameras_of_several_generations_are_driven, a_camera_that_cannot_pan_and_tilt_is_refused,
       a_refused_move_is_reported_in_the_cameras_words, a_camera_without_stop_is_stopped_by_a_move_at_speed_0,
       errors_and_garbage_between_good_answers_are_survived,
       a_camera_that_answers_nothing_but_garbage_is_a_fault_until_it_works_again,
       a_move_status_that_says_nothing_does_not_hold_up_the_end,
       a_camera_that_goes_away_is_reported_within_a_second_and_stands_when_it_is_back,
       a_slow_camera_is_no_fault, an_address_where_nothing_is_is_named});
}
