// SPDX-License-Identifier: LGPL-2.1-or-later
// The passwords of the page's roles, as argon2id hashes in a file of their own, and the one-time password with which the
// owner's is set first.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "robot/page/access.h"

namespace cerberus::robot {

// Random text of `bytes` bytes in hexadecimal digits; empty: the system gives none.
std::string random_token(std::size_t bytes = 32);

class Passwords {
 public:
  // argon2id, RFC 9106 and OWASP's second recommendation: a tenth of a second on a small computer.
  struct Parameters {
    std::uint32_t passes = 2, kibibytes = 19 * 1024, lanes = 1;
  };
  static constexpr std::size_t kShortest = 8, kLongest = 256;  // letters of a password

  // Reads "ROLE HASH" lines. False: the file has another content, and is not used.
  bool restore(std::string_view text);
  std::string state() const;

  bool has(Role role) const { return !hash(role).empty(); }
  // What is wrong with a new password; empty: nothing.
  static std::string fault_of(Role role, std::string_view password);
  // Its hash, for keep(); empty: the system has no memory or no random numbers for it. Needs a tenth of a second, and may
  // be called in another thread, of a copy.
  std::string hash_of(std::string_view password) const;
  void keep(Role role, std::string hash);
  // The three of these. Returns what is wrong with the new password; empty: it is set.
  std::string set(Role role, std::string_view password);
  // Takes as long for a role without password as for one with.
  bool verify(Role role, std::string_view password) const;

  // Makes the one-time password, which counts for the owner as long as that role has none.
  std::string make_one_time();
  bool is_one_time(Role role, std::string_view password) const;

 private:
  const std::string& hash(Role role) const { return hashes_[static_cast<std::size_t>(role)]; }

  Parameters parameters_;
  std::array<std::string, 4> hashes_;
  std::string one_time_;
};

}  // namespace cerberus::robot
