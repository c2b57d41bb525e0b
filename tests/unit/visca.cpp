// SPDX-License-Identifier: LGPL-2.1-or-later
// The byte sequences are those of the command lists in Sony's EVI-D70 and BRC-H900 manuals and of VISCA over IP.
#include "drivers/visca/visca.h"

#include <random>
#include <string>

#include "support/suite.h"
#include "support/text.h"

using namespace cerberus::drivers::visca;
using cerberus::tests::assert_text;

namespace {

std::string hex(std::span<const std::uint8_t> bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) {
    char two[4];
    std::snprintf(two, sizeof two, "%02x", byte);
    if (!text.empty()) text += ' ';
    text += two;
  }
  return text;
}

Message bytes(std::initializer_list<int> list) {
  Message message;
  for (const int byte : list) message.push_back(static_cast<std::uint8_t>(byte));
  return message;
}

}  // namespace

START_TEST(drives_are_those_of_the_manual) {
  assert_text(hex(drive(1, 0, 5)), "81 01 06 01 01 05 03 01 ff");     // up
  assert_text(hex(drive(1, 0, -5)), "81 01 06 01 01 05 03 02 ff");    // down
  assert_text(hex(drive(1, -7, 0)), "81 01 06 01 07 01 01 03 ff");    // left
  assert_text(hex(drive(1, 7, 0)), "81 01 06 01 07 01 02 03 ff");     // right
  assert_text(hex(drive(2, -24, 20)), "82 01 06 01 18 14 01 01 ff");  // up left
  assert_text(hex(drive(7, 99, -99)), "87 01 06 01 18 17 02 02 ff");  // no faster than the protocol permits
  assert_text(hex(stop(1)), "81 01 06 01 01 01 03 03 ff");
}
END_TEST

START_TEST(positions_are_four_nibbles_of_14_4_to_a_degree) {
  // 170 degrees = 0x0990, -170 = 0xf670; 90 = 0x0510, -20 = 0xfee0
  assert_text(hex(absolute(1, 170, 90, 24, 20)), "81 01 06 02 18 14 00 09 09 00 00 05 01 00 ff");
  assert_text(hex(absolute(1, -170, -20, 1, 1)), "81 01 06 02 01 01 0f 06 07 00 0f 0e 0e 00 ff");
}
END_TEST

START_TEST(other_messages_are_those_of_the_manual) {
  assert_text(hex(home(1)), "81 01 06 04 ff");
  assert_text(hex(position_inquiry(3)), "83 09 06 12 ff");
  assert_text(hex(zoom(1, 0)), "81 01 04 47 00 00 00 00 ff");
  assert_text(hex(zoom(2, 0.5)), "82 01 04 47 02 00 00 00 ff");
  assert_text(hex(zoom(1, 1)), "81 01 04 47 04 00 00 00 ff");
  assert_text(hex(zoom(1, 7)), "81 01 04 47 07 0a 0c 00 ff");  // the end of the digital zoom
  assert_text(hex(zoom_inquiry(1)), "81 09 04 47 ff");
  assert_text(hex(interface_clear()), "88 01 00 01 ff");
  assert_text(hex(address_set()), "88 30 01 ff");
}
END_TEST

START_TEST(replies_are_distinguished) {
  using Kind = Reply::Kind;
  const Reply ack = parse_reply(bytes({0x90, 0x42, 0xff}));
  ck_assert(ack.kind == Kind::ack && ack.address == 1 && ack.socket == 2);
  const Reply done = parse_reply(bytes({0xb0, 0x51, 0xff}));
  ck_assert(done.kind == Kind::completion && done.address == 3 && done.socket == 1);
  const Reply full = parse_reply(bytes({0x90, 0x60, 0x03, 0xff}));
  ck_assert(full.kind == Kind::error && full.error == 3);
  const Reply refused = parse_reply(bytes({0x90, 0x61, 0x41, 0xff}));
  ck_assert(refused.kind == Kind::error && refused.error == 0x41 && refused.socket == 1);
  const Reply position =
      parse_reply(bytes({0x90, 0x50, 0x0f, 0x06, 0x07, 0x00, 0x00, 0x05, 0x01, 0x00, 0xff}));
  ck_assert(position.kind == Kind::position);
  ck_assert_double_eq_tol(position.pan, -170, 1e-9);
  ck_assert_double_eq_tol(position.tilt, 90, 1e-9);
  for (const Message& other :
       {bytes({0x90, 0xff}), bytes({}), bytes({0x90, 0x50, 1, 2, 0xff}), bytes({0x10, 0x41, 0xff})})
    ck_assert(parse_reply(other).kind == Kind::other);
}
END_TEST

START_TEST(a_zoom_is_four_nibbles_of_which_4000_are_the_optical_one) {
  for (const auto& [units, position] :
       {std::pair{0x0000, 0.0}, std::pair{0x1000, .25}, std::pair{0x4000, 1.0}}) {
    const Reply reply = parse_reply(bytes({0x90, 0x50, units >> 12, 0, 0, 0, 0xff}));
    ck_assert(reply.kind == Reply::Kind::zoom);
    ck_assert_double_eq(reply.zoom, position);
  }
  ck_assert_double_eq(parse_reply(bytes({0x90, 0x50, 15, 15, 15, 15, 0xff})).zoom, 0x7ac0 / 16384.0);
}
END_TEST

START_TEST(speeds_become_the_nearest_step_and_slow_ones_none) {
  const std::vector<double>& pan = default_speed_table().pan;
  ck_assert_int_eq(speed_step(pan, 120), 24);
  ck_assert_int_eq(speed_step(pan, 500), 24);
  ck_assert_int_eq(speed_step(pan, -45), -19);
  ck_assert_int_eq(speed_step(pan, 26), 16);  // 25
  ck_assert_int_eq(speed_step(pan, 1.2), 1);  // 1
  ck_assert_int_eq(speed_step(pan, -0.5), -1);
  ck_assert_int_eq(speed_step(pan, 0.49), 0);
  ck_assert_int_eq(speed_step(pan, 0), 0);
  ck_assert_int_eq(speed_step(pan, std::nan("")), 0);
}
END_TEST

START_TEST(a_speed_table_of_ones_own_is_read_or_refused) {
  SpeedTable table;
  assert_text(parse_speed_table("1 2 3.5; 2 4", table), "");
  ck_assert_uint_eq(table.pan.size(), 3);
  ck_assert_double_eq(table.tilt[1], 4);
  for (const char* wrong : {"", "1 2", "1; 2", "2 1; 1 2", "1 2; 1 x", "1 2; 1 2; 1 2", "0 1; 1 2"})
    ck_assert_msg(!parse_speed_table(wrong, table).empty(), "%s", wrong);
  assert_text(parse_speed_table("2 1; 1 2", table),
              "1 is not above the speed before it: each step is faster");
  ck_assert_double_eq(table.pan[2], 3.5);  // what was there stays
}
END_TEST

START_TEST(the_header_of_visca_over_ip_is_built_and_taken_off) {
  assert_text(hex(with_header(stop(1), 0x01020304)), "01 00 00 09 01 02 03 04 81 01 06 01 01 01 03 03 ff");
  assert_text(hex(with_header(position_inquiry(1), 5)), "01 10 00 05 00 00 00 05 81 09 06 12 ff");
  assert_text(hex(reset_sequence()), "02 00 00 01 00 00 00 00 01");
  const Message answer = bytes({0x01, 0x11, 0, 3, 0, 0, 0, 9, 0x90, 0x41, 0xff});
  assert_text(hex(parse_datagram(answer).payload), "90 41 ff");
  ck_assert_uint_eq(parse_datagram(answer).sequence, 9);
  ck_assert(!is_sequence_error(parse_datagram(answer)));
  const Message bare = bytes({0x90, 0x41, 0xff});
  assert_text(hex(parse_datagram(bare).payload), "90 41 ff");
  ck_assert(!parse_datagram(bare).header);
  // Control reply, "abnormality in the sequence number".
  const Message error = bytes({0x02, 0x01, 0, 2, 0, 0, 0, 7, 0x0f, 0x01});
  ck_assert(is_sequence_error(parse_datagram(error)));
}
END_TEST

START_TEST(a_stream_that_loses_bytes_is_cut_right_again) {
  Cutter cutter;
  cutter.append(bytes({0x42, 0x00, 0xff, 0x90, 0x41}));
  ck_assert(!cutter.take());
  cutter.append(bytes({0xff, 0xff, 0x90, 0x51, 0xff}));
  assert_text(hex(cutter.take().value()), "90 41 ff");
  assert_text(hex(cutter.take().value()), "90 51 ff");
  ck_assert(!cutter.take());
  cutter.append(Message(1000, 0x90));
  ck_assert(!cutter.take());
  cutter.append(bytes({0xff, 0x90, 0x43, 0xff}));
  Message last;
  while (const auto message = cutter.take()) last = *message;
  assert_text(hex(last), "90 43 ff");
}
END_TEST

START_TEST(any_bytes_are_parsed_without_harm) {
  std::mt19937 random(11);
  Cutter cutter;
  for (int k = 0; k < 2000; ++k) {
    Message noise(random() % 40);
    for (std::uint8_t& byte : noise) byte = static_cast<std::uint8_t>(random() % 4 ? random() : 0xff);
    cutter.append(parse_datagram(noise).payload);
    while (const auto message = cutter.take()) {
      ck_assert_uint_le(message->size(), kMostBytes);
      parse_reply(*message);
    }
  }
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "visca",
      {drives_are_those_of_the_manual, positions_are_four_nibbles_of_14_4_to_a_degree,
       other_messages_are_those_of_the_manual, replies_are_distinguished,
       a_zoom_is_four_nibbles_of_which_4000_are_the_optical_one,
       speeds_become_the_nearest_step_and_slow_ones_none, a_speed_table_of_ones_own_is_read_or_refused,
       the_header_of_visca_over_ip_is_built_and_taken_off, a_stream_that_loses_bytes_is_cut_right_again,
       any_bytes_are_parsed_without_harm});
}
