// SPDX-License-Identifier: LGPL-2.1-or-later
// The frames are those of Pelco's manual (camera 1); the sums were added up by hand.
#include "drivers/pelco/pelco_d.h"

#include <random>
#include <string>

#include "support/suite.h"
#include "support/text.h"

using namespace cerberus::drivers::pelco;
using cerberus::tests::assert_text;

namespace {

std::string hex(const Frame& frame) {
  std::string text;
  for (const std::uint8_t byte : frame) {
    char two[4];
    std::snprintf(two, sizeof two, "%02x", byte);
    if (!text.empty()) text += ' ';
    text += two;
  }
  return text;
}

std::vector<std::uint8_t> bytes(std::initializer_list<int> list) {
  std::vector<std::uint8_t> all;
  for (const int byte : list) all.push_back(static_cast<std::uint8_t>(byte));
  return all;
}

}  // namespace

START_TEST(drives_are_those_of_the_manual) {
  assert_text(hex(drive(1, 0x20, 0)), "ff 01 00 02 20 00 23");       // right
  assert_text(hex(drive(1, -0x20, 0)), "ff 01 00 04 20 00 25");      // left
  assert_text(hex(drive(1, 0, 0x3f)), "ff 01 00 08 00 3f 48");       // up
  assert_text(hex(drive(1, 0, -0x3f)), "ff 01 00 10 00 3f 50");      // down
  assert_text(hex(drive(10, -0x3f, 0x10)), "ff 0a 00 0c 3f 10 65");  // up left
  assert_text(hex(drive(1, 500, -500)), "ff 01 00 12 3f 3f 91");     // no faster than the protocol permits
  assert_text(hex(drive(1, 0, 0)), "ff 01 00 00 00 00 01");          // stop
  assert_text(hex(position_query(1, Axis::pan)), "ff 01 00 51 00 00 52");
  assert_text(hex(position_query(2, Axis::tilt)), "ff 02 00 53 00 00 55");
  assert_text(hex(position_query(1, Axis::zoom)), "ff 01 00 55 00 00 56");
  assert_text(hex(zoom(1, 0)), "ff 01 00 4f 00 00 50");
  assert_text(hex(zoom(1, .5)), "ff 01 00 4f 80 00 d0");
  assert_text(hex(zoom(1, 1.5)), "ff 01 00 4f ff ff 4e");
}
END_TEST

START_TEST(positions_are_hundredths_of_a_degree) {
  Answers answers;
  answers.append(bytes({0xff, 1, 0, 0x59, 0x11, 0x94, 0xff}));  // 4500: 45 degrees right
  answers.append(bytes({0xff, 1, 0, 0x59, 0x7b, 0x0c, 0xe1}));  // 31500: 45 degrees left
  answers.append(bytes({0xff, 3, 0, 0x5b, 0x03, 0xe8, 0x49}));  // 1000: 10 degrees down
  auto position = answers.take();
  ck_assert(position && position->axis == Axis::pan && position->address == 1);
  ck_assert_double_eq_tol(position->degrees, 45, 1e-9);
  position = answers.take();
  ck_assert_double_eq_tol(position->degrees, -45, 1e-9);
  position = answers.take();
  ck_assert(position->axis == Axis::tilt && position->address == 3);
  ck_assert_double_eq_tol(position->degrees, -10, 1e-9);
  ck_assert(!answers.take());
}
END_TEST

START_TEST(wrong_sums_and_lost_bytes_are_skipped) {
  Answers answers;
  answers.append(bytes({0xff, 1, 0, 0x59, 0x11, 0x94, 0xfe}));  // wrong sum
  answers.append(bytes({0xff, 1, 0x59, 0x11, 0x94, 0xff}));     // a byte is lost
  answers.append(bytes({0xff, 1, 0, 0x59, 0x8c, 0xa0, 0x86}));  // 36000 is no angle
  answers.append(bytes({0xff, 1, 0, 0x59, 0x11, 0x94, 0xff}));
  const auto position = answers.take();
  ck_assert(position);
  ck_assert_double_eq_tol(position->degrees, 45, 1e-9);
  ck_assert(!answers.take());
}
END_TEST

START_TEST(any_bytes_are_parsed_without_harm) {
  std::mt19937 random(1);
  Answers answers;
  for (int k = 0; k < 5000; ++k) {
    std::vector<std::uint8_t> noise(random() % 20);
    for (std::uint8_t& byte : noise) byte = static_cast<std::uint8_t>(random() % 3 ? random() : 0xff);
    answers.append(noise);
    while (const auto position = answers.take()) ck_assert(std::abs(position->degrees) <= 180);
  }
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "pelco_d", {drives_are_those_of_the_manual, positions_are_hundredths_of_a_degree,
                  wrong_sums_and_lost_bytes_are_skipped, any_bytes_are_parsed_without_harm});
}
