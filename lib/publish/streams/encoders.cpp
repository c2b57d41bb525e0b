// SPDX-License-Identifier: LGPL-2.1-or-later
#include "publish/streams/encoders.h"

#include <algorithm>
#include <vector>

namespace cerberus::publish {

namespace {

constexpr std::string_view kList =
#include "publish/streams/encoders.list"
    ;

// The next word of a line, which is cut off.
std::string_view take_word(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
  const std::string_view word = line.substr(0, line.find(' '));
  line.remove_prefix(word.size());
  return word;
}

std::vector<Encoder> read_list() {
  std::vector<Encoder> all;
  for (std::string_view rest = kList; !rest.empty();) {
    std::string_view line = rest.substr(0, rest.find('\n'));
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
    if (line.empty() || line.front() == '#') continue;
    Encoder encoder;
    encoder.name = take_word(line);
    encoder.codec = take_word(line);
    encoder.hardware = take_word(line) == "h";
    encoder.element = take_word(line);
    encoder.package = take_word(line);
    line.remove_prefix(std::min(line.find_first_not_of(' '), line.size()));
    encoder.line = line;
    all.push_back(encoder);
  }
  return all;
}

void replace(std::string& text, std::string_view word, int number) {
  for (std::size_t at = 0; (at = text.find(word, at)) != text.npos;)
    text.replace(at, word.size(), std::to_string(number));
}

}  // namespace

std::span<const Encoder> encoders() {
  static const std::vector<Encoder> all = read_list();
  return all;
}

const Encoder* encoder_of(std::string_view element) {
  const auto found = std::ranges::find(encoders(), element, &Encoder::element);
  return found == encoders().end() ? nullptr : &*found;
}

std::string encoder_line(const Encoder& encoder, int gop, int kbit) {
  std::string line(encoder.line);
  replace(line, "KBIT", kbit);
  replace(line, "BIT", 1000 * kbit);
  replace(line, "GOP", gop);
  return line;
}

}  // namespace cerberus::publish
