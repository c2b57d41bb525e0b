// SPDX-License-Identifier: LGPL-2.1-or-later
// Formats numbers: the same text in every locale (gst-launch sets the user's, and printf() then writes 1,5), never
// "-0", without an allocation.
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>
#include <system_error>

namespace cerberus::text {

// Rounds to `decimals` decimals, as far as a double has them.
inline double round_to(double value, int decimals) {
  const double unit = std::pow(10.0, decimals);
  return std::abs(value) < 1e15 ? std::round(value * unit) / unit : value;  // NaN and infinity too
}

// The text of one number.
class Digits {
 public:
  // how: format arguments of std::to_chars.
  template <typename... How>
  explicit Digits(double value, How... how) {
    char* const end = digits_.data() + digits_.size();
    auto written = std::to_chars(digits_.data(), end, value, how...);
    if (written.ec != std::errc())
      written = std::to_chars(digits_.data(), end, value);  // 1e300 with decimals
    length_ = static_cast<std::size_t>(written.ptr - digits_.data());
    if (is_negative_zero()) std::copy(digits_.data() + 1, digits_.data() + length_--, digits_.data());
  }
  operator std::string_view() const { return string_view(); }
  std::string string() const { return std::string(string_view()); }
  std::string_view string_view() const { return {digits_.data(), length_}; }

 private:
  // Checks the written text: a negative number rounded to 0 is one, too.
  bool is_negative_zero() const {
    return digits_[0] == '-' && string_view().find_first_not_of("-0.") == std::string_view::npos;
  }

  std::array<char, 40> digits_;
  std::size_t length_;
};

// The shortest text that reads back as this number.
inline Digits exact(double value) {
  return Digits(value);
}
// Up to `digits` significant digits: 27.05, 80, 1e+06.
inline Digits significant(double value, int digits) {
  return Digits(value, std::chars_format::general, digits);
}
// Up to `decimals` decimals: 12.5, 12.
inline Digits rounded(double value, int decimals) {
  return Digits(round_to(value, decimals));
}
// Exactly `decimals` decimals: 12.5, 12.0.
inline Digits fixed(double value, int decimals) {
  return Digits(value, std::chars_format::fixed, decimals);
}

}  // namespace cerberus::text
