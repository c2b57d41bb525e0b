// SPDX-License-Identifier: LGPL-2.1-or-later
#include "publish/packing.h"

#include <check.h>

#include <string>
#include <vector>

#include "support/suite.h"

using namespace cerberus::publish;

namespace {

enum Source { kCommanded, kMeasured };
struct Example {
  const char* head;
  std::uint64_t from;
  std::uint64_t until;
  Source source;
  double numbers[3];
  int flag;
};

template <typename Archive>
void exchange(Archive& archive, Example& e) {
  archive(e.head, Moment{e.from}, Moment{e.until}, e.source, e.numbers, e.flag);
}

std::vector<std::string> kept;  // as GLib's interned strings
const char* keep(const char* word) {
  kept.reserve(16);
  return kept.emplace_back(word).c_str();
}

constexpr std::uint64_t kSent = 5'000'000'000, kReceived = 2'000'000'000;

std::vector<std::byte> packed(Example example, std::uint64_t frame_time = kSent) {
  std::array<std::byte, kMostPacked> room;
  Packer packer(room, frame_time);
  exchange(packer, example);
  ck_assert(packer.complete());
  return {packer.bytes().begin(), packer.bytes().end()};
}

bool unpack(const std::vector<std::byte>& bytes, Example& example, std::uint8_t version = kPackedVersion,
            std::uint64_t frame_time = kReceived) {
  kept.clear();
  Unpacker from(bytes, version, frame_time, keep);
  exchange(from, example);
  return from.complete();
}

constexpr Example kExample{"mast", 4'900'000'000, 5'100'000'000, kMeasured, {1.5, -2.25, 1e300}, 1};

}  // namespace

START_TEST(a_structure_arrives_as_it_was_with_times_of_the_reader) {
  Example read{};
  // By hand: a byte of length and four letters, two times, an enumeration, three doubles, an int.
  ck_assert_uint_eq(packed(kExample).size(), 5 + 16 + 4 + 24 + 4);
  ck_assert(unpack(packed(kExample), read));
  ck_assert_str_eq(read.head, "mast");
  ck_assert_uint_eq(read.from, 1'900'000'000);  // 100 ms before the frame, which the reader has at 2 s
  ck_assert_uint_eq(read.until, 2'100'000'000);
  ck_assert_int_eq(read.source, kMeasured);
  ck_assert(read.numbers[0] == 1.5 && read.numbers[1] == -2.25 && read.numbers[2] == 1e300);
  ck_assert_int_eq(read.flag, 1);
}
END_TEST

START_TEST(what_is_unknown_stays_unknown) {
  Example sent = kExample, read = kExample;
  sent.head = nullptr;
  sent.until = kNoTime;
  ck_assert(unpack(packed(sent), read));
  ck_assert_ptr_null(read.head);
  ck_assert(read.until == kNoTime);
  ck_assert(unpack(packed(sent, kNoTime), read));  // the frame had no timestamp: its distances are not known
  ck_assert(read.from == kNoTime);
  ck_assert(unpack(packed(sent), read, kPackedVersion, kNoTime));
  ck_assert(read.from == kNoTime);
  sent.head = "";
  ck_assert(unpack(packed(sent), read));
  ck_assert_str_eq(read.head, "");
}
END_TEST

START_TEST(times_before_the_readers_zero_or_beyond_its_end_are_limited) {
  Example sent = kExample, read{};
  sent.from = 0;             // 5 s before the frame
  sent.until = kNoTime - 1;  // 584 years after it
  ck_assert(unpack(packed(sent), read));
  ck_assert_uint_eq(read.from, 0);
  ck_assert_uint_gt(read.until, kReceived);
  ck_assert(unpack(packed(sent), read, kPackedVersion, kNoTime - 1));
  ck_assert(read.until == kNoTime);
}
END_TEST

START_TEST(another_version_is_refused) {
  Example read = kExample;
  for (int version = 0; version < 256; ++version)
    ck_assert(unpack(packed(kExample), read, static_cast<std::uint8_t>(version)) ==
              (version == kPackedVersion));
  read.flag = 7;
  ck_assert(!unpack(packed(kExample), read, kPackedVersion + 1));
  ck_assert_int_eq(read.flag, 7);  // nothing of it was read
}
END_TEST

START_TEST(too_few_and_too_many_bytes_are_refused_and_none_is_read_beyond_the_end) {
  const std::vector<std::byte> whole = packed(kExample);
  for (std::size_t n = 0; n < whole.size(); ++n) {
    const std::vector<std::byte> part(
        whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(n));  // exact size: ASan sees more
    Example read{};
    ck_assert(!unpack(part, read));
  }
  std::vector<std::byte> longer = whole;
  longer.push_back(std::byte{});
  Example read{};
  ck_assert(!unpack(longer, read));
}
END_TEST

START_TEST(a_word_that_claims_more_than_there_is_is_refused) {
  std::vector<std::byte> bytes = packed(kExample);
  bytes[0] = std::byte{255};
  Example read{};
  ck_assert(!unpack(bytes, read));
  ck_assert_ptr_null(read.head);
}
END_TEST

START_TEST(a_long_word_is_cut_between_characters) {
  const std::string letters(kMostWord - 1, 'a'),
      umlaut = letters + "\xc3\xa4";  // its second byte has no room
  Example sent = kExample, read{};
  sent.head = umlaut.c_str();
  ck_assert(unpack(packed(sent), read));
  ck_assert_str_eq(read.head, letters.c_str());
}
END_TEST

START_TEST(a_room_that_is_too_small_is_reported) {
  const std::size_t needed = packed(kExample).size();
  for (const std::size_t size : {std::size_t{0}, std::size_t{4}, needed - 1}) {
    std::vector<std::byte> room(size);
    Packer packer(room, kSent);
    Example example = kExample;
    exchange(packer, example);
    ck_assert(!packer.complete());
  }
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "packing", {a_structure_arrives_as_it_was_with_times_of_the_reader, what_is_unknown_stays_unknown,
                  times_before_the_readers_zero_or_beyond_its_end_are_limited, another_version_is_refused,
                  too_few_and_too_many_bytes_are_refused_and_none_is_read_beyond_the_end,
                  a_word_that_claims_more_than_there_is_is_refused, a_long_word_is_cut_between_characters,
                  a_room_that_is_too_small_is_reported});
}
