// SPDX-License-Identifier: LGPL-2.1-or-later
// An unsigned integer of up to 576 bits, for comparisons of fractions that doubles cannot decide.
#pragma once

#include <algorithm>
#include <array>
#include <compare>
#include <cstdint>

namespace cerberus::vision {

// Addition, multiplication and comparison are exact while the result is below 2^576; larger results are undefined.
// The cost grows with the digits in use, not with the capacity.
class WideInteger {
 public:
  static constexpr int kDigits = 18;

  constexpr WideInteger(std::uint64_t value = 0)
      : digits_{static_cast<std::uint32_t>(value), static_cast<std::uint32_t>(value >> 32)}, used_(2) {
    trim();
  }

  constexpr WideInteger& operator+=(const WideInteger& other) {
    std::uint64_t carry = 0;
    const int count = std::max(used_, other.used_);
    for (int k = 0; k < kDigits && (k < count || carry); ++k) {
      carry += std::uint64_t{digits_[k]} + other.digits_[k];
      digits_[k] = static_cast<std::uint32_t>(carry);
      carry >>= 32;
      used_ = std::max(used_, k + 1);
    }
    trim();
    return *this;
  }

  friend constexpr WideInteger operator*(const WideInteger& a, const WideInteger& b) {
    WideInteger product;
    for (int i = 0; i < a.used_; ++i) {
      std::uint64_t carry = 0;
      for (int j = 0; i + j < kDigits && (j < b.used_ || carry); ++j) {
        carry += std::uint64_t{a.digits_[i]} * b.digits_[j] + product.digits_[i + j];
        product.digits_[i + j] = static_cast<std::uint32_t>(carry);
        carry >>= 32;
      }
    }
    product.used_ = std::min(a.used_ + b.used_, kDigits);
    product.trim();
    return product;
  }

  friend constexpr std::strong_ordering operator<=>(const WideInteger& a, const WideInteger& b) {
    if (a.used_ != b.used_) return a.used_ <=> b.used_;
    for (int k = a.used_ - 1; k >= 0; --k)
      if (a.digits_[k] != b.digits_[k]) return a.digits_[k] <=> b.digits_[k];
    return std::strong_ordering::equal;
  }
  friend constexpr bool operator==(const WideInteger& a, const WideInteger& b) {
    return (a <=> b) == std::strong_ordering::equal;
  }

  // The nearest double but for a relative error of at most 2^-50.
  constexpr double to_double() const {
    double value = 0;
    for (int k = used_ - 1; k >= 0; --k) value = value * 4294967296.0 + digits_[k];
    return value;
  }

 private:
  constexpr void trim() {
    while (used_ > 0 && digits_[used_ - 1] == 0) --used_;
  }

  std::array<std::uint32_t, kDigits> digits_{};  // least significant first; zeros from used_ on
  int used_;
};

}  // namespace cerberus::vision
