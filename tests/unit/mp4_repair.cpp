// SPDX-License-Identifier: LGPL-2.1-or-later
// The files are made by hand from boxes, in the states through which mp4mux's completion goes.
#include "record/archive/mp4_repair.h"

#include <check.h>
#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <random>
#include <string>

#include "support/suite.h"

using namespace cerberus::record;

namespace {

std::string number(std::uint64_t value, int bytes) {
  std::string text;
  for (int k = bytes; k-- > 0;) text += static_cast<char>(value >> (8 * k));
  return text;
}
std::string box(const std::string& type, const std::string& content) {
  return number(content.size() + 8, 4) + type + content;
}

const std::string kFtyp = box("ftyp", "mp42");
const std::string kFree = box("free", "");
const std::string kFirst = "first fragment hoov";  // frames may hold any bytes
const std::string kMoov = std::string(100, 'm');
const std::string kRest = kFree + box("mdat", "second") + box("moof", "2") + kFree + box("mdat", "third");

// What is in the file while it is written, and so what a repair makes of it.
const std::string kFragments = kFtyp + kFree + box("mdat", kFirst) + box("moov", kMoov) + kRest;
const std::string kHidden = kFtyp + kFree + box("mdat", kFirst) + box("hoov", kMoov) + kRest;
const std::string kExtended = kFtyp + kFree + box("mdat", kFirst + box("hoov", kMoov) + kRest);
const std::string kFinal = box("moov", std::string(300, 'f'));

// The file after a repair.
std::string repaired(std::string bytes, Mp4State expected) {
  FILE* file = tmpfile();
  fwrite(bytes.data(), 1, bytes.size(), file);
  fflush(file);
  ck_assert_int_eq(static_cast<int>(repair_mp4(fileno(file))), static_cast<int>(expected));
  std::string read(static_cast<std::size_t>(lseek(fileno(file), 0, SEEK_END)), ' ');
  ck_assert_int_eq(pread(fileno(file), read.data(), read.size(), 0), static_cast<ssize_t>(read.size()));
  fclose(file);
  return read;
}

}  // namespace

START_TEST(a_file_with_a_whole_moov_stays_as_it_is) {
  for (const std::string& sound : {kFragments, kExtended + kFinal, kHidden + kFinal})
    ck_assert(repaired(sound, Mp4State::sound) == sound);
}
END_TEST

START_TEST(a_file_that_ends_before_its_first_moov_does_is_broken) {
  const std::string whole = kFtyp + kFree + box("mdat", kFirst) + box("moov", kMoov);
  for (std::size_t length = 0; length < whole.size(); ++length)
    ck_assert(repaired(whole.substr(0, length), Mp4State::broken) == whole.substr(0, length));
  ck_assert(repaired(whole, Mp4State::sound) == whole);
  ck_assert(repaired(std::string(4096, '\0') + kRest, Mp4State::broken).size() == 4096 + kRest.size());
}
END_TEST

// As a recorder opens its files: with O_APPEND a write to a place would go to the end.
START_TEST(a_file_that_is_open_to_append_is_repaired_in_its_place) {
  char path[] = "/tmp/cerberus-mp4-XXXXXX";
  const int made = mkstemp(path), fd = open(path, O_RDWR | O_APPEND);
  ck_assert(write(fd, kHidden.data(), kHidden.size()) == static_cast<ssize_t>(kHidden.size()));
  ck_assert(repair_mp4(fd) == Mp4State::repaired);
  ck_assert_int_eq(lseek(fd, 0, SEEK_END), static_cast<off_t>(kHidden.size()));
  ck_assert(repair_mp4(fd) == Mp4State::sound);
  close(fd);
  close(made);
  unlink(path);
}
END_TEST

START_TEST(a_hidden_moov_counts_again) {
  ck_assert(repaired(kHidden, Mp4State::repaired) == kFragments);
}
END_TEST

START_TEST(an_extended_mdat_is_shortened_again) {
  ck_assert(repaired(kExtended, Mp4State::repaired) == kFragments);
}
END_TEST

START_TEST(an_mdat_with_a_size_of_64_bits_is_shortened_again) {
  const std::string content = kFirst + box("hoov", kMoov) + kRest;
  const std::string large = kFtyp + number(1, 4) + "mdat" + number(content.size() + 16, 8) + content;
  ck_assert_uint_eq(large.size(), kFragments.size());
  ck_assert(repaired(large, Mp4State::repaired) == kFragments);
}
END_TEST

START_TEST(a_torn_moov_at_the_end_is_cut_off) {
  for (const std::size_t length : {8UL, 9UL, kFinal.size() - 1}) {
    ck_assert(repaired(kExtended + kFinal.substr(0, length), Mp4State::repaired) == kFragments);
    ck_assert(repaired(kHidden + kFinal.substr(0, length), Mp4State::repaired) == kFragments);
  }
}
END_TEST

START_TEST(a_hidden_moov_across_two_reads_is_found) {
  for (const std::size_t shift : {0, 1, 2, 3, 4, 5, 6, 7}) {
    const std::string first((1 << 16) - 16 + shift, 'x');
    const std::string content = first + box("hoov", kMoov) + kRest;
    ck_assert(repaired(kFtyp + kFree + box("mdat", content), Mp4State::repaired) ==
              kFtyp + kFree + box("mdat", first) + box("moov", kMoov) + kRest);
  }
}
END_TEST

START_TEST(any_bytes_end_in_an_answer) {
  std::mt19937 random(3);
  for (int round = 0; round < 500; ++round) {
    std::string bytes = round % 2 ? kHidden : kExtended + kFinal;
    for (int k = 0; k < 4; ++k) bytes[random() % bytes.size()] = static_cast<char>(random());
    bytes.resize(random() % bytes.size());
    FILE* file = tmpfile();
    fwrite(bytes.data(), 1, bytes.size(), file);
    fflush(file);
    ck_assert(repair_mp4(fileno(file)) != Mp4State::failed);
    fclose(file);
  }
  ck_assert(repair_mp4(-1) == Mp4State::failed);
}
END_TEST

int main() {
  Suite* suite = suite_create("mp4 repair");
  TCase* cases = tcase_create("mp4 repair");
  for (const TTest* test :
       {a_file_with_a_whole_moov_stays_as_it_is, a_file_that_ends_before_its_first_moov_does_is_broken,
        a_file_that_is_open_to_append_is_repaired_in_its_place, a_hidden_moov_counts_again,
        an_extended_mdat_is_shortened_again, an_mdat_with_a_size_of_64_bits_is_shortened_again,
        a_torn_moov_at_the_end_is_cut_off, a_hidden_moov_across_two_reads_is_found,
        any_bytes_end_in_an_answer})
    tcase_add_test(cases, test);
  suite_add_tcase(suite, cases);
  SRunner* runner = srunner_create(suite);
  srunner_run_all(runner, CK_ENV);
  const int failed = srunner_ntests_failed(runner);
  srunner_free(runner);
  return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
