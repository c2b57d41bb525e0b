// SPDX-License-Identifier: LGPL-2.1-or-later
#include "robot/page/passwords.h"

#include <argon2.h>
#include <sys/random.h>

#include <vector>

namespace cerberus::robot {

namespace {

constexpr std::size_t kSalt = 16, kHash = 32;  // bytes, RFC 9106

bool random_bytes(std::uint8_t* bytes, std::size_t count) {
  return ::getrandom(bytes, count, 0) == static_cast<ssize_t>(count);
}

std::string hashed(std::string_view password, const Passwords::Parameters& how) {
  std::array<std::uint8_t, kSalt> salt;
  if (!random_bytes(salt.data(), salt.size())) return {};
  std::string text(argon2_encodedlen(how.passes, how.kibibytes, how.lanes, kSalt, kHash, Argon2_id), '\0');
  if (argon2id_hash_encoded(how.passes, how.kibibytes, how.lanes, password.data(), password.size(),
                            salt.data(), salt.size(), kHash, text.data(), text.size()) != ARGON2_OK)
    return {};
  text.resize(text.find('\0'));
  return text;
}

}  // namespace

std::string random_token(std::size_t bytes) {
  std::vector<std::uint8_t> random(bytes);
  if (!random_bytes(random.data(), bytes)) return {};
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : random) (text += kDigits[byte >> 4]) += kDigits[byte & 15];
  return text;
}

bool Passwords::restore(std::string_view text) {
  std::array<std::string, 4> hashes;
  while (!text.empty()) {
    const std::size_t end = text.find('\n'), blank = text.find(' ');
    const std::optional<Role> role = role_of(text.substr(0, blank));
    if (end == text.npos || blank == text.npos || blank > end || !role) return false;
    const std::string_view hash = text.substr(blank + 1, end - blank - 1);
    if (!hash.starts_with("$argon2id$")) return false;
    hashes[static_cast<std::size_t>(*role)] = hash;
    text.remove_prefix(end + 1);
  }
  hashes_ = hashes;
  return true;
}

std::string Passwords::state() const {
  std::string text;
  for (const Role role : {Role::viewer, Role::operator_, Role::owner})
    if (has(role)) (text.append(name(role)) += ' ') += hash(role) + '\n';
  return text;
}

std::string Passwords::fault_of(Role role, std::string_view password) {
  if (role == Role::none) return "there is no such role";
  if (password.size() < kShortest || password.size() > kLongest)
    return "a password has " + std::to_string(kShortest) + " to " + std::to_string(kLongest) + " characters";
  return {};
}

std::string Passwords::hash_of(std::string_view password) const {
  return hashed(password, parameters_);
}

void Passwords::keep(Role role, std::string hash) {
  hashes_[static_cast<std::size_t>(role)] = std::move(hash);
  if (role == Role::owner) one_time_.clear();
}

std::string Passwords::set(Role role, std::string_view password) {
  if (std::string fault = fault_of(role, password); !fault.empty()) return fault;
  std::string hash = hash_of(password);
  if (hash.empty()) return "the system has no memory or no random numbers for a password";
  keep(role, std::move(hash));
  return {};
}

bool Passwords::verify(Role role, std::string_view password) const {
  if (password.size() > kLongest) return false;
  if (role == Role::none || !has(role)) {
    hashed(password, parameters_);
    return false;
  }
  return argon2id_verify(hash(role).c_str(), password.data(), password.size()) == ARGON2_OK;
}

std::string Passwords::make_one_time() {
  one_time_ = random_token(8);
  return one_time_;
}

bool Passwords::is_one_time(Role role, std::string_view password) const {
  if (role != Role::owner || has(Role::owner) || one_time_.empty() || password.size() != one_time_.size())
    return false;
  unsigned different = 0;
  for (std::size_t k = 0; k < password.size(); ++k)
    different |= static_cast<unsigned char>(password[k] ^ one_time_[k]);
  return different == 0;
}

}  // namespace cerberus::robot
