// SPDX-License-Identifier: LGPL-2.1-or-later
// Runs a fuzz target over the files of its corpus, for compilers without libFuzzer: also over each file's beginnings and
// over copies with single bytes changed, so that a small corpus reaches far.
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

void run(const std::string& bytes) {
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

}  // namespace

int main(int, char** argv) {
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(argv[1])) {
    std::ifstream in(entry.path(), std::ios::binary);
    const std::string whole{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
    run(whole);
    for (std::size_t n = 0; n < whole.size(); ++n) {
      run(whole.substr(0, n));
      for (const int change : {0x01, 0x20, 0x80, 0xff}) {
        std::string other = whole;
        other[n] = static_cast<char>(other[n] ^ change);
        run(other);
      }
    }
    ++files;
  }
  std::printf("%d files\n", files);
  return files > 0 ? 0 : 1;
}
