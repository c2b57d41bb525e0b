// SPDX-License-Identifier: LGPL-2.1-or-later
// Numbered pictures, and whether those that a program read are the ones that were encoded. Raw I420, one file.
//
//   pictures make WIDTH HEIGHT COUNT FILE              a scene in which somebody walks; the number is burnt in
//   pictures compare WIDTH HEIGHT BEFORE AFTER LEAST   each picture of AFTER against that of BEFORE with its number
//
// `compare` fails where a plane of a picture is below kLeast, a number cannot be read, comes twice, or fewer than LEAST
// pictures are there. COUNT is at most 2048.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr double kLeast = 28;  // dB of PSNR: below it a picture is damaged and not only compressed
constexpr int kBits = 11, kBlock = 16, kRow = 6;  // the number and its parity: two rows of blocks
constexpr int kLeft = 112, kTop = 180;            // in the middle of 320x240, below where people walk
constexpr int kNone = -1;

struct Size {
  int width, height;
  int chroma_width() const { return (width + 1) / 2; }
  int chroma_height() const { return (height + 1) / 2; }
  std::size_t luma() const { return static_cast<std::size_t>(width) * height; }
  std::size_t chroma() const { return static_cast<std::size_t>(chroma_width()) * chroma_height(); }
  std::size_t all() const { return luma() + 2 * chroma(); }
};

int with_parity(int number) {
  return number | (__builtin_popcount(static_cast<unsigned>(number)) & 1) << kBits;
}

// The top left corner of a bit's block: the same in every size, so that a picture can be cropped.
std::pair<int, int> place(int bit) {
  return {kLeft + bit % kRow * kBlock, kTop + bit / kRow * kBlock};
}

// Textures of some pixels, as grass and walls have them, in all planes; a person of another texture walks.
Bytes scene(Size size, int number) {
  Bytes picture(size.all());
  const int left = number * 2 % (size.width + 40) - 40, top = size.height / 3;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const bool person = x >= left && x < left + 32 && y >= top && y < top + 64;
      const double texture = person ? 30 * std::sin((x - left) * .5) * std::cos(y * .3) + 60
                                    : 25 * std::sin(x * .21 + y * .05) + 25 * std::cos(y * .17 - x * .03);
      picture[static_cast<std::size_t>(y) * size.width + x] = static_cast<std::uint8_t>(110 + texture);
    }
  for (int plane = 0; plane < 2; ++plane)
    for (int y = 0; y < size.chroma_height(); ++y)
      for (int x = 0; x < size.chroma_width(); ++x)
        picture[size.luma() + plane * size.chroma() + static_cast<std::size_t>(y) * size.chroma_width() + x] =
            static_cast<std::uint8_t>(128 + 20 * std::sin((plane ? x : y) * .05));
  for (int bit = 0; bit <= kBits; ++bit) {
    const auto [x, y] = place(bit);
    const std::uint8_t level = with_parity(number) >> bit & 1 ? 235 : 16;
    for (int row = 0; row < kBlock; ++row)
      std::memset(&picture[static_cast<std::size_t>(y + row) * size.width + x], level, kBlock);
  }
  return picture;
}

// The mean of each block's middle decides, so that a thin line across it does no harm.
int number_of(Size size, std::span<const std::uint8_t> picture) {
  int found = 0;
  for (int bit = 0; bit <= kBits; ++bit) {
    const auto [left, top] = place(bit);
    int sum = 0;
    for (int y = top + 4; y < top + 12; ++y)
      for (int x = left + 4; x < left + 12; ++x) sum += picture[static_cast<std::size_t>(y) * size.width + x];
    found |= (sum > 64 * 126) << bit;
  }
  const int number = found & ((1 << kBits) - 1);
  return with_parity(number) == found ? number : kNone;
}

// 10 log10(255^2 / mean squared error), of one plane.
double psnr(std::span<const std::uint8_t> a, std::span<const std::uint8_t> b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += (a[k] - b[k]) * (a[k] - b[k]);
  return 10 * std::log10(255 * 255 / std::max(sum / static_cast<double>(a.size()), 1e-9));
}

double worst_plane(Size size, std::span<const std::uint8_t> a, std::span<const std::uint8_t> b) {
  double least = psnr(a.first(size.luma()), b.first(size.luma()));
  for (int plane = 0; plane < 2; ++plane) {
    const std::size_t from = size.luma() + plane * size.chroma();
    least = std::min(least, psnr(a.subspan(from, size.chroma()), b.subspan(from, size.chroma())));
  }
  return least;
}

Bytes read(const char* name) {
  Bytes bytes;
  if (std::FILE* file = std::fopen(name, "rb")) {
    std::fseek(file, 0, SEEK_END);
    bytes.resize(static_cast<std::size_t>(std::ftell(file)));
    std::rewind(file);
    bytes.resize(std::fread(bytes.data(), 1, bytes.size(), file));
    std::fclose(file);
  }
  return bytes;
}

int make(Size size, int count, const char* name) {
  std::FILE* file = std::fopen(name, "wb");
  bool written = file != nullptr;
  for (int k = 0; written && k < count; ++k) {
    const Bytes picture = scene(size, k);
    written = std::fwrite(picture.data(), 1, picture.size(), file) == picture.size();
  }
  return written && std::fclose(file) == 0 ? 0 : 1;
}

int compare(Size size, const char* before_name, const char* after_name, int least) {
  const Bytes before = read(before_name), after = read(after_name);
  std::map<int, std::size_t> of_number;
  for (std::size_t at = 0; at + size.all() <= before.size(); at += size.all())
    of_number[number_of(size, std::span(before).subspan(at, size.all()))] = at;
  of_number.erase(kNone);
  int count = 0, bad = 0;
  double lowest = 999;
  for (std::size_t at = 0; at + size.all() <= after.size(); at += size.all(), ++count) {
    const auto picture = std::span(after).subspan(at, size.all());
    const auto found = of_number.find(number_of(size, picture));
    if (found == of_number.end()) {
      std::printf("picture %d: no number, or one that was not encoded or came before\n", count);
      ++bad;
      continue;
    }
    const double db = worst_plane(size, std::span(before).subspan(found->second, size.all()), picture);
    lowest = std::min(lowest, db);
    if (db < kLeast) std::printf("picture %d (number %d): %.1f dB\n", count, found->first, db);
    bad += db < kLeast;
    of_number.erase(found);
  }
  std::printf("%d pictures, %d of them bad, lowest %.1f dB\n", count, bad, lowest);
  return bad == 0 && count >= least && after.size() % size.all() == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string task = argc > 1 ? argv[1] : "";
  if (task == "make" && argc == 6)
    return make({std::atoi(argv[2]), std::atoi(argv[3])}, std::atoi(argv[4]), argv[5]);
  if (task == "compare" && argc == 7)
    return compare({std::atoi(argv[2]), std::atoi(argv[3])}, argv[4], argv[5], std::atoi(argv[6]));
  return 2;
}
