// SPDX-License-Identifier: LGPL-2.1-or-later
// A point of time as ISO 8601 in UTC, without an allocation.
#pragma once

#include <array>
#include <chrono>
#include <string_view>

namespace cerberus::text {

// "2026-11-22T16:09:29.123456Z": whole microseconds, rounded down; years 0 to 9999.
class Utc {
 public:
  explicit Utc(std::chrono::nanoseconds since_1970) {
    using namespace std::chrono;
    const sys_time<nanoseconds> when(since_1970);
    const auto day = floor<days>(when);
    const year_month_day date(day);
    const hh_mm_ss time(floor<microseconds>(when) - day);
    put(0, 4, static_cast<int>(date.year()));
    put(5, 2, static_cast<int>(static_cast<unsigned>(date.month())));
    put(8, 2, static_cast<int>(static_cast<unsigned>(date.day())));
    put(11, 2, static_cast<int>(time.hours().count()));
    put(14, 2, static_cast<int>(time.minutes().count()));
    put(17, 2, static_cast<int>(time.seconds().count()));
    put(20, 6, static_cast<int>(time.subseconds().count()));
  }
  operator std::string_view() const { return {text_.data(), text_.size()}; }

 private:
  void put(std::size_t place, std::size_t digits, int number) {
    for (std::size_t k = digits; k-- > 0; number /= 10)
      text_[place + k] = static_cast<char>('0' + number % 10);
  }

  std::array<char, 27> text_{'0', '0', '0', '0', '-', '0', '0', '-', '0', '0', 'T', '0', '0', ':',
                             '0', '0', ':', '0', '0', '.', '0', '0', '0', '0', '0', '0', 'Z'};
};

}  // namespace cerberus::text
