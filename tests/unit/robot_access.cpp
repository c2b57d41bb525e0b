// SPDX-License-Identifier: LGPL-2.1-or-later
#include "robot/page/access.h"

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "robot/base_drive.h"
#include "robot/page/byte_range.h"
#include "robot/page/client_address.h"
#include "robot/page/devices.h"
#include "robot/source/late_frames.h"
#if HAVE_ARGON2
#include "robot/page/passwords.h"
#endif
#include "support/suite.h"  // after the streams: check defines fail()

using namespace cerberus::robot;
using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::seconds;
using namespace std::chrono_literals;
using Kind = PageCommand::Kind;

namespace {

const AccessTime kStart{std::chrono::hours(1000)};

bool taken(const std::string& line, Kind kind) {
  const std::optional<PageCommand> command = parse_command(line);
  return command && command->kind == kind;
}

}  // namespace

START_TEST(every_message_is_read_letter_by_letter) {
  ck_assert(taken("stop", Kind::stop) && taken("home", Kind::home) && taken("auto", Kind::automatic));
  ck_assert(taken("ack 18446744073709551615", Kind::ack) && taken("seen 7", Kind::seen));
  ck_assert(taken("camera front", Kind::camera) && taken("follow 4294967295", Kind::follow));
  ck_assert(taken("mode privacy", Kind::mode) && taken("stage mask", Kind::stage));
  ck_assert(taken("stage picture", Kind::stage) && taken("set quality 60", Kind::set));
  ck_assert(taken("drive 1 -0.5", Kind::drive));
  const std::optional<PageCommand> turn = parse_command("turn -0.25 1");
  ck_assert(turn && turn->kind == Kind::turn && turn->pan == -.25 && turn->tilt == 1);
  for (const char* wrong : {"",
                            " ",
                            "stop ",
                            " stop",
                            "STOP",
                            "stop now",
                            "ack",
                            "ack -1",
                            "ack 1x",
                            "ack 18446744073709551616",
                            "turn 1",
                            "turn 1 2",
                            "turn nan 0",
                            "turn inf 0",
                            "turn 1e400 0",
                            "turn 0 0 0",
                            "turn  1 0",
                            "turn 0,5 0",
                            "drive 1",
                            "drive 2 0",
                            "drive nan 0",
                            "stage",
                            "stage x",
                            "set quality",
                            "set quality 9",
                            "set quality 101",
                            "set quality nan",
                            "set x 1",
                            "camera ",
                            "follow 0",
                            "follow 4294967296",
                            "follow -1",
                            "mode",
                            "mode off",
                            "move 1 0",
                            "a b c d e f"})
    ck_assert_msg(!parse_command(wrong), "\"%s\" was taken", wrong);
  ck_assert(!parse_command("camera " + std::string(kLongestCommand, 'a')));
}
END_TEST

START_TEST(a_viewer_may_watch_an_operator_steer_and_the_owner_begin_and_end_privacy) {
  const struct {
    const char* line;
    Role role;
  } cases[] = {
      {"ack 1", Role::viewer},         {"seen 1", Role::viewer},
      {"camera a", Role::viewer},      {"stop", Role::operator_},
      {"home", Role::operator_},       {"auto", Role::operator_},
      {"turn 0 0", Role::operator_},   {"follow 1", Role::operator_},
      {"mode armed", Role::operator_}, {"mode disarmed", Role::operator_},
      {"mode privacy", Role::owner},   {"stage mask", Role::operator_},
      {"drive 0 0", Role::operator_},  {"set quality 60", Role::owner},
  };
  for (const auto& one : cases)
    ck_assert_msg(needed(*parse_command(one.line), Mode::armed) == one.role, "%s", one.line);
  ck_assert(needed(*parse_command("mode armed"), Mode::privacy) == Role::owner);
}
END_TEST

START_TEST(only_the_entrance_is_open_and_what_changes_needs_more) {
  for (const Route& route : routes()) {
    const bool entrance = route.path == "/" || route.path == "/page.css" || route.path == "/page.js" ||
                          route.path == "/session" || route.path == "/login";
    ck_assert_msg(entrance == (route.role == Role::none), "%s", std::string(route.path).c_str());
  }
  ck_assert(find_route("POST", "/delete")->role == Role::owner);
  ck_assert(find_route("POST", "/password")->role == Role::owner);
  ck_assert(find_route("GET", "/log")->role == Role::owner && !find_route("GET", "/log/"));
  ck_assert(find_route("POST", "/keep")->role == Role::operator_);
  ck_assert(find_route("GET", "/events/a/1/video")->role == Role::viewer);
  ck_assert(!find_route("GET", "/delete") && !find_route("GET", "/eventsx") && !find_route("PUT", "/login"));
  ck_assert(!find_route("GET", "") && !find_route("GET", "/page.js/") && !find_route("HEAD", "/login"));
  ck_assert(find_route("HEAD", "/events")->role == Role::viewer &&
            find_route("HEAD", "/")->role == Role::none);
}
END_TEST

START_TEST(late_frames_are_dropped_but_for_one_a_second_and_reported_once_a_minute) {
  LateFrames late;
  const auto at = [](int ms) { return milliseconds(3600000 + ms); };
  ck_assert(!late.drop(milliseconds(500), at(0)) && late.report(at(0)) == 0);
  ck_assert(late.drop(milliseconds(501), at(100)));
  ck_assert(late.drop(seconds(4), at(999)));
  ck_assert(!late.drop(seconds(4), at(1000)));  // one a second
  ck_assert(late.report(at(1099)) == 0 && late.report(at(1100)) == 2 && late.report(at(1100)) == 0);
  ck_assert(late.drop(seconds(4), at(1500)) && late.report(at(61099)) == 0 && late.report(at(61100)) == 1);
}
END_TEST

// A camera of 25 frames a second, a keyframe every 2 s, and a decoder that needs so long for a frame.
struct Decoder {
  explicit Decoder(milliseconds needs) : needs(needs) {}
  const milliseconds needs;
  milliseconds held_up{0};  // nothing comes until then
  LateFrames late;
  std::vector<milliseconds> ages;  // of the pictures, when they are decoded
  milliseconds longest_pause{0};   // between two of them

  void run(seconds length) {
    milliseconds time{0}, last{0};
    bool has_reference = false;
    for (int k = 0; k * 40ms < length; ++k) {
      const bool keyframe = k % 50 == 0;
      time = std::max({time, milliseconds(k * 40), held_up});
      if (late.drop_encoded(time - k * 40ms, keyframe, time + 1h)) {
        has_reference = false;
        continue;
      }
      ck_assert_msg(has_reference || keyframe, "frame %d follows one that was dropped", k);
      has_reference = true;
      time += needs;
      longest_pause = std::max(longest_pause, time - last);
      last = time;
      ages.push_back(time - k * 40ms);
    }
  }
};

START_TEST(a_decoder_that_is_too_slow_skips_to_the_next_keyframe_and_a_fast_one_makes_up_for_a_pause) {
  Decoder slow(100ms);
  slow.run(60s);
  // .5 s late, and 1 s of patience in which the delay grows by .6 s; without dropping it would be 90 s at the end.
  ck_assert_int_le(std::ranges::max(slow.ages).count(), 500 + 600 + 2 * 100);
  ck_assert_int_ge(static_cast<int>(slow.ages.size()), 60 * 10 / 2);
  ck_assert_int_le(slow.longest_pause.count(), 2000 + 100);
  ck_assert_uint_eq(slow.late.report(2h), 60 * 25 - slow.ages.size());
  Decoder fast(5ms);
  fast.held_up = 3s;
  fast.run(60s);
  ck_assert_uint_eq(fast.ages.size(), 60 * 25);
  ck_assert_int_eq(fast.ages.back().count(), 5);
  // A source whose frames are always late is seen all the same, for a second of each four.
  LateFrames late;
  int decoded = 0;
  for (int k = 0; k < 60 * 25; ++k) decoded += !late.drop_encoded(700ms, k % 50 == 0, 1h + k * 40ms);
  ck_assert_int_ge(decoded, 60 * 25 / 4);
}
END_TEST

START_TEST(a_device_is_known_by_its_hash_until_it_is_revoked) {
  const std::string hash(64, 'a'), other(64, 'b');
  Devices devices;
  ck_assert(devices.fault_of("kitchen", Role::viewer).empty());
  devices.add("kitchen", Role::viewer, hash);
  devices.add("gate", Role::operator_, other);
  ck_assert(!devices.fault_of("kitchen", Role::viewer).empty());  // it is there
  for (const char* name : {"", "a b", "a\nb", "a/b"})
    ck_assert(!devices.fault_of(name, Role::viewer).empty());
  ck_assert(!devices.fault_of("x", Role::owner).empty() && !devices.fault_of("x", Role::none).empty());
  Devices later;
  ck_assert(later.restore(devices.state()));
  ck_assert(later.find(hash) && later.find(hash)->name == "kitchen" &&
            later.find(hash)->role == Role::viewer);
  ck_assert(later.find(other)->role == Role::operator_ && !later.find(std::string(64, 'c')) &&
            !later.find(""));
  ck_assert(later.revoke("kitchen") && !later.revoke("kitchen") && !later.find(hash) && later.find(other));
  for (const std::string& wrong :
       {std::string("viewer a\n"), "viewer a " + hash, "owner a " + hash + "\n", "viewer a b " + hash + "\n",
        "viewer a " + hash + "x\n", "viewer a " + hash + "\nviewer a " + other + "\n"})
    ck_assert_msg(!later.restore(wrong) && later.all().empty(), "%s", wrong.c_str());
  ck_assert(later.restore("") && later.all().empty());
}
END_TEST

START_TEST(a_trusted_proxy_tells_whose_request_it_hands_on_and_nobody_else_does) {
  const std::vector<std::string> trusted{"127.0.0.1", "10.0.0.0/8", "fd00::/8"};
  const struct {
    const char *peer, *x_forwarded_for, *forwarded, *client;
  } cases[] = {
      {"192.168.1.7", "", "", "192.168.1.7"},
      {"192.168.1.7", "203.0.113.5", "for=203.0.113.5", "192.168.1.7"},  // of no trusted proxy
      {"127.0.0.1", "203.0.113.5", "", "203.0.113.5"},
      {"::ffff:127.0.0.1", "203.0.113.5", "", "203.0.113.5"},
      {"127.0.0.1", "192.0.2.1, 203.0.113.5", "", "203.0.113.5"},  // left of it is what the stranger wrote
      {"127.0.0.1", "192.0.2.1, 203.0.113.5, 10.1.2.3", "", "203.0.113.5"},  // two proxies
      {"10.1.2.3", "203.0.113.5:4711", "", "203.0.113.5"},
      {"10.1.2.3", "[2001:db8::1]:4711", "", "2001:db8::1"},
      {"fd00::7", "2001:DB8:0:0::1", "", "2001:db8::1"},
      {"127.0.0.1", "", "for=192.0.2.1;proto=https, For=\"[2001:db8::1]:4711\";by=_x", "2001:db8::1"},
      {"127.0.0.1", "", "for=203.0.113.5", "203.0.113.5"},
      {"127.0.0.1", "", "for=unknown", "unknown via 127.0.0.1"},
      {"127.0.0.1", "", "by=\"a,for=1.2.3.4\"", "unknown via 127.0.0.1"},
      {"127.0.0.1", "", "for=127.0.0.1;by=\", for=203.0.113.5", "unknown via 127.0.0.1"},  // not closed
      {"127.0.0.1", "\"127.0.0.1, 203.0.113.5", "", "203.0.113.5"},
      {"127.0.0.1", "203.0.113.5", "for=192.0.2.1", "unknown via 127.0.0.1"},  // one is not the proxy's
      {"127.0.0.1", "203.0.113.5", "for=203.0.113.5", "203.0.113.5"},
      {"127.0.0.1", "203.0.113.5, nonsense", "", "unknown via 127.0.0.1"},
      {"127.0.0.1", "nonsense, 10.1.2.3", "", "unknown via 10.1.2.3"},
      {"127.0.0.1", "10.0.0.1", "", "10.0.0.1"},  // all of them trusted: the first
      {"127.0.0.1", ", ,", "", "unknown via 127.0.0.1"},
  };
  for (const auto& one : cases) {
    const Client client = client_of(one.peer, trusted, one.x_forwarded_for, one.forwarded);
    ck_assert_msg(client.address == one.client, "%s, \"%s\", \"%s\": %s, not %s", one.peer,
                  one.x_forwarded_for, one.forwarded, client.address.c_str(), one.client);
    ck_assert(client.proxied == (*one.x_forwarded_for != 0 || *one.forwarded != 0));
  }
  for (const char* right : {"127.0.0.1", "10.0.0.0/8", "0.0.0.0/0", "::1", "fd00::/8", "::/0"})
    ck_assert_msg(is_network(right), "%s", right);
  for (const char* wrong :
       {"", "proxy", "10.0.0.0/33", "fd00::/129", "10.0.0.0/", "10.0.0.0/8x", "10.0.0.0/-1"})
    ck_assert_msg(!is_network(wrong), "%s", wrong);
}
END_TEST

START_TEST(another_name_for_this_machine_is_refused) {
  const std::vector<std::string> origins{"https://robot.example:8443"};
  for (const char* own : {"127.0.0.1:8080", "127.0.0.1", "[::1]:8080", "localhost:8080", "LOCALHOST",
                          "192.168.1.7:8080", "garden:8080", "Garden.local", "robot.example:8443"})
    ck_assert_msg(is_own_host(own, "garden", origins), "%s", own);
  for (const char* other :
       {"", "evil.example", "127.0.0.1.evil.example:8080", "localhost.evil.example", "robot.example",
        "garden.evil", "gardenXlocal", ":8080", "[::1.evil", "1.2.3.4x", "1.2.3.4:80evil", "[::1]evil:80"})
    ck_assert_msg(!is_own_host(other, "garden", origins), "%s", other);
  ck_assert(!is_own_host("", "", {}) && !is_own_host(".local", "", {}));
}
END_TEST

START_TEST(an_origin_is_the_pages_own_or_configured) {
  const std::vector<std::string> origins{"https://robot.example:8443"};
  ck_assert(is_own_origin("http://127.0.0.1:8080", "127.0.0.1:8080", origins));
  ck_assert(is_own_origin("https://robot.example:8443", "127.0.0.1:8080", origins));
  for (const char* other :
       {"", "null", "http://evil.example", "http://127.0.0.1:8081", "https://127.0.0.1:8080",
        "http://127.0.0.1:8080.evil", "http://", "https://robot.example"})
    ck_assert_msg(!is_own_origin(other, "127.0.0.1:8080", origins), "%s", other);
  ck_assert(!is_own_origin("http://", "", {}));
  // A page with TLS is not reached without it, and the other way round.
  ck_assert(is_own_origin("https://127.0.0.1:8080", "127.0.0.1:8080", origins, true));
  ck_assert(!is_own_origin("http://127.0.0.1:8080", "127.0.0.1:8080", origins, true));
  ck_assert(!is_own_origin("https://", "", {}, true));
}
END_TEST

START_TEST(a_session_ends_after_12_idle_hours_after_a_week_and_when_it_is_ended) {
  Sessions sessions;
  sessions.begin("one", Role::viewer, "a", kStart);
  ck_assert(sessions.find("one", kStart + hours(12)) && !sessions.find("", kStart) &&
            !sessions.find("on", kStart));
  ck_assert(!sessions.find("one", kStart + hours(24) + seconds(1)));
  sessions.begin("two", Role::owner, "a", kStart);
  for (int hour = 10; hour <= 160; hour += 10) ck_assert(sessions.find("two", kStart + hours(hour)));
  ck_assert(!sessions.find("two", kStart + hours(168) + seconds(1)));  // used 8 hours before
  sessions.begin("three", Role::owner, "a", kStart);
  sessions.begin("four", Role::owner, "a", kStart);
  sessions.begin("five", Role::viewer, "a", kStart);
  sessions.end_all(Role::owner, "four");
  ck_assert(!sessions.find("three", kStart) && sessions.find("four", kStart) &&
            sessions.find("five", kStart));
  sessions.end(sessions.find("four", kStart)->token);
  ck_assert(!sessions.find("four", kStart));
}
END_TEST

START_TEST(of_too_many_sessions_the_one_used_longest_ago_ends) {
  Sessions sessions;
  for (int k = 0; k < 64; ++k) sessions.begin(std::to_string(k), Role::viewer, "a", kStart + seconds(k));
  ck_assert(sessions.find("0", kStart + seconds(100)));
  sessions.begin("new", Role::viewer, "a", kStart + seconds(101));
  ck_assert_uint_eq(sessions.count(), 64);
  ck_assert(sessions.find("0", kStart + seconds(101)) && !sessions.find("1", kStart + seconds(101)));
}
END_TEST

START_TEST(after_five_wrong_passwords_an_address_waits_twice_as_long_each_time) {
  RateLimit limit;
  AccessTime now = kStart;
  for (int k = 0; k < 4; ++k) limit.failed("a", "owner", now);
  ck_assert_int_eq(limit.wait("a", "owner", now).count(), 0);
  for (const int expected : {1, 2, 4, 8, 16, 32, 60, 60}) {
    limit.failed("a", "owner", now);
    ck_assert_int_eq(limit.wait("a", "owner", now).count(), expected);
    ck_assert_int_eq(limit.wait("b", "owner", now).count(), 0);
    ck_assert_int_eq(limit.wait("a", "owner", now + milliseconds(500)).count(), expected == 1 ? 1 : expected);
    now += seconds(expected);
    ck_assert_int_eq(limit.wait("a", "owner", now).count(), 0);
  }
  limit.succeeded("a", "owner");
  limit.failed("a", "owner", now);
  ck_assert_int_eq(limit.wait("a", "owner", now).count(), 0);
}
END_TEST

START_TEST(many_addresses_together_are_slowed_down_too) {
  RateLimit limit;
  for (int k = 0; k < 50; ++k) limit.failed("address " + std::to_string(k), "owner", kStart);
  ck_assert_int_eq(limit.wait("another", "owner", kStart).count(), 1);
  for (const char* own : {"127.0.0.1", "::1", "::ffff:127.0.0.1"})
    ck_assert_int_eq(limit.wait(own, "owner", kStart).count(), 0);
  RateLimit after = limit;
  after.succeeded("address 7", "owner");
  ck_assert_int_eq(after.wait("another", "owner", kStart).count(),
                   1);  // one right password does not clear all
  for (int k = 0; k < 9; ++k) after.failed("address " + std::to_string(k), "owner", kStart);
  ck_assert_int_eq(after.wait("another", "owner", kStart).count(), 5);  // never longer
  limit.failed("another", "owner", kStart + hours(2));                  // forgotten
  ck_assert_int_eq(limit.wait("another", "owner", kStart + hours(2)).count(), 0);
}
END_TEST

START_TEST(a_right_password_of_one_account_does_not_make_up_for_wrong_ones_of_another) {
  RateLimit limit;
  for (int round = 0; round < 10; ++round) {
    for (int k = 0; k < 4; ++k) limit.failed("a", "owner", kStart);
    limit.failed("a", "viewer", kStart);  // until it is found right
    limit.withdraw("a", "viewer");
  }
  ck_assert_int_eq(limit.wait("a", "owner", kStart).count(), 60);
  ck_assert_int_eq(limit.wait("a", "viewer", kStart).count(), 0);
  for (int k = 0; k < 300; ++k) limit.failed("a", "invented " + std::to_string(k), kStart);
  ck_assert_int_eq(limit.wait("a", "owner", kStart).count(), 60);  // not forgotten for them
}
END_TEST

START_TEST(log_ins_that_were_right_slow_no_one_down) {
  RateLimit limit;
  for (int k = 0; k < 200; ++k) {
    limit.failed("a", "viewer", kStart);
    limit.withdraw("a", "viewer");
  }
  ck_assert_int_eq(limit.wait("b", "viewer", kStart).count(), 0);
}
END_TEST

START_TEST(all_addresses_of_an_ipv6_network_wait_together) {
  RateLimit limit;
  for (int k = 0; k < 5; ++k) limit.failed("2001:db8:0:1::" + std::to_string(k), "owner", kStart);
  ck_assert_int_eq(limit.wait("2001:db8::1:aaaa:bbbb:cccc:dddd", "owner", kStart).count(), 1);
  ck_assert_int_eq(limit.wait("2001:db8:0:2::1", "owner", kStart).count(), 0);
  for (int k = 0; k < 5; ++k) limit.failed("::ffff:192.0.2." + std::to_string(k), "owner", kStart);
  ck_assert_int_eq(limit.wait("::ffff:192.0.2.1", "owner", kStart).count(), 0);  // of IPv4: each its own
}
END_TEST

START_TEST(a_range_of_bytes_is_answered_in_part_as_a_whole_or_refused) {
  using Range = ByteRange::Kind;
  const struct {
    const char* header;
    Range kind;
    std::uint64_t first, last;
  } cases[] = {
      {"bytes=0-", Range::part, 0, 3},
      {"bytes=4-9", Range::part, 4, 7},
      {"bytes=8-", Range::part, 8, 9},
      {"bytes=9-9", Range::part, 9, 9},
      {"bytes=7-99", Range::part, 7, 9},
      {"bytes=-3", Range::part, 7, 9},
      {"bytes=-99", Range::part, 0, 3},
      {"bytes=10-", Range::none, 0, 0},
      {"bytes=-0", Range::none, 0, 0},
      {"bytes=18446744073709551615-", Range::none, 0, 0},
      {"", Range::whole, 0, 0},
      {"bytes=-", Range::whole, 0, 0},
      {"bytes=5-4", Range::whole, 0, 0},
      {"bytes=0-1,3-4", Range::whole, 0, 0},
      {"bytes=x-4", Range::whole, 0, 0},
      {"lines=0-4", Range::whole, 0, 0},
      {"bytes=99999999999999999999-", Range::whole, 0, 0},
      {"bytes=--1", Range::whole, 0, 0},
  };
  for (const auto& one : cases) {
    const ByteRange found = parse_range(one.header, 10, 4);
    ck_assert_msg(found.kind == one.kind && found.first == one.first && found.last == one.last, "\"%s\"",
                  one.header);
  }
  ck_assert(parse_range("bytes=0-", 0, 4).kind == Range::none);
}
END_TEST

START_TEST(one_session_steers_until_it_was_silent_for_two_seconds) {
  Steering steering;
  ck_assert(steering.take("a", kStart) && !steering.take("b", kStart + milliseconds(1999)));
  ck_assert(steering.take("a", kStart + seconds(1)) && !steering.take("b", kStart + milliseconds(2999)));
  ck_assert(steering.is_held_by("a", kStart + milliseconds(2999)));
  ck_assert(steering.take("b", kStart + seconds(3)) && !steering.take("a", kStart + seconds(4)));
  steering.release();
  ck_assert(steering.take("a", kStart + seconds(4)));
}
END_TEST

START_TEST(after_a_stop_by_another_session_the_one_that_moved_must_let_go_first) {
  Steering steering;
  ck_assert(steering.take("a", kStart));
  steering.stop("a");
  ck_assert(!steering.must_let_go("a"));
  ck_assert(steering.take("a", kStart));
  steering.stop("b");
  ck_assert(steering.must_let_go("a") && !steering.must_let_go("b"));
  ck_assert(steering.take("b", kStart) && steering.must_let_go("a"));
  steering.let_go("a");
  ck_assert(!steering.must_let_go("a"));
  for (int k = 0; k < 100; ++k) {
    ck_assert(steering.take(std::to_string(k), kStart + seconds(3 * k + 3)));
    steering.stop("b");
  }
  ck_assert(!steering.must_let_go("35") && steering.must_let_go("36") && steering.must_let_go("99"));
}
END_TEST

START_TEST(a_drive_of_the_base_is_repeated_and_ends_after_half_a_second) {
  BaseDrive base;
  ck_assert(base.line(kStart).empty());
  base.drive(.25, -10, kStart);
  ck_assert(base.line(kStart) == "drive 0.25 -10\n");
  ck_assert_double_eq(base.speed(), .25);
  ck_assert(base.line(kStart + milliseconds(99)).empty());
  ck_assert(base.line(kStart + milliseconds(100)) == "drive 0.25 -10\n");
  ck_assert(base.line(kStart + milliseconds(500)) == "stop\n");
  ck_assert(!base.is_active() && base.line(kStart + seconds(9)).empty());
  ck_assert_double_eq(base.speed(), 0);
  base.drive(.5, 0, kStart + seconds(10));
  base.stop(kStart + seconds(10));
  ck_assert(base.line(kStart + seconds(10)) == "stop\n");
  ck_assert(base.line(kStart + seconds(11)).empty());
}
END_TEST

START_TEST(a_head_may_ask_the_base_to_turn_and_an_order_by_hand_goes_first) {
  BaseDrive base;
  base.ask(0, kStart);
  ck_assert(base.line(kStart).empty());  // nothing was asked for
  base.ask(20, kStart);
  ck_assert(base.line(kStart) == "drive 0 20\n");
  base.ask(-10, kStart + milliseconds(50));
  ck_assert(base.line(kStart + milliseconds(100)) == "drive 0 -10\n");
  base.ask(0, kStart + milliseconds(110));
  ck_assert(base.line(kStart + milliseconds(110)) == "stop\n");
  base.ask(20, kStart + seconds(1));
  ck_assert(base.line(kStart + seconds(1)) == "drive 0 20\n");
  ck_assert(base.line(kStart + milliseconds(1500)) == "stop\n");  // it asked no more
  base.ask(20, kStart + seconds(2));
  base.stop(kStart + seconds(2));
  ck_assert(base.line(kStart + seconds(2)) == "stop\n");
  base.ask(20, kStart + milliseconds(3999));
  ck_assert(base.line(kStart + milliseconds(3999)).empty());
  base.drive(.5, 0, kStart + seconds(4));
  base.ask(20, kStart + milliseconds(4050));
  base.ask(0, kStart + milliseconds(4060));  // ends no order by hand
  ck_assert(base.line(kStart + milliseconds(4060)) == "drive 0.5 0\n");
  base.ask(20, kStart + seconds(6));
  ck_assert(base.line(kStart + seconds(6)) == "drive 0 20\n");
}
END_TEST

#if HAVE_ARGON2
START_TEST(a_password_counts_for_its_role_alone_and_survives_a_restart) {
  Passwords passwords;
  ck_assert(!passwords.set(Role::owner, "seven77").empty() &&
            !passwords.set(Role::none, "long enough").empty());
  ck_assert(!passwords.set(Role::owner, std::string(257, 'a')).empty());
  ck_assert(passwords.set(Role::owner, "long enough").empty());
  Passwords other;
  ck_assert(other.restore(passwords.state()));
  ck_assert(other.verify(Role::owner, "long enough") && !other.verify(Role::owner, "long enougH"));
  ck_assert(!other.verify(Role::viewer, "long enough") && !other.verify(Role::none, "long enough"));
  ck_assert(passwords.state().find("long enough") == std::string::npos);
  ck_assert(passwords.state().starts_with("owner $argon2id$v=19$m=19456,t=2,p=1$"));
  for (const char* broken :
       {"owner", "owner \n", "owner $argon2id$", "guest $argon2id$x\n", "owner plain\n", "\n"})
    ck_assert_msg(!other.restore(broken), "\"%s\" was taken", broken);
  ck_assert(other.has(Role::owner));
}
END_TEST

START_TEST(the_one_time_password_counts_for_the_owner_until_a_password_is_set) {
  Passwords passwords;
  ck_assert(!passwords.is_one_time(Role::owner, ""));
  const std::string once = passwords.make_one_time();
  ck_assert_uint_eq(once.size(), 16);
  ck_assert(once != Passwords().make_one_time());
  ck_assert(passwords.is_one_time(Role::owner, once) && !passwords.is_one_time(Role::operator_, once));
  ck_assert(!passwords.is_one_time(Role::owner, once.substr(1)) && !passwords.verify(Role::owner, once));
  ck_assert(passwords.set(Role::owner, "long enough").empty() && !passwords.is_one_time(Role::owner, once));
}
END_TEST
#endif

int main() {
  return cerberus::tests::run_suite(
      "robot access",
      {
          every_message_is_read_letter_by_letter,
          a_viewer_may_watch_an_operator_steer_and_the_owner_begin_and_end_privacy,
          only_the_entrance_is_open_and_what_changes_needs_more,
          late_frames_are_dropped_but_for_one_a_second_and_reported_once_a_minute,
          a_decoder_that_is_too_slow_skips_to_the_next_keyframe_and_a_fast_one_makes_up_for_a_pause,
          a_device_is_known_by_its_hash_until_it_is_revoked,
          a_trusted_proxy_tells_whose_request_it_hands_on_and_nobody_else_does,
          another_name_for_this_machine_is_refused,
          an_origin_is_the_pages_own_or_configured,
          a_session_ends_after_12_idle_hours_after_a_week_and_when_it_is_ended,
          of_too_many_sessions_the_one_used_longest_ago_ends,
          after_five_wrong_passwords_an_address_waits_twice_as_long_each_time,
          many_addresses_together_are_slowed_down_too,
          a_right_password_of_one_account_does_not_make_up_for_wrong_ones_of_another,
          log_ins_that_were_right_slow_no_one_down,
          all_addresses_of_an_ipv6_network_wait_together,
          a_range_of_bytes_is_answered_in_part_as_a_whole_or_refused,
          a_head_may_ask_the_base_to_turn_and_an_order_by_hand_goes_first,
          a_drive_of_the_base_is_repeated_and_ends_after_half_a_second,
          after_a_stop_by_another_session_the_one_that_moved_must_let_go_first,
          one_session_steers_until_it_was_silent_for_two_seconds,
#if HAVE_ARGON2
          a_password_counts_for_its_role_alone_and_survives_a_restart,
          the_one_time_password_counts_for_the_owner_until_a_password_is_set,
#endif
      });
}
