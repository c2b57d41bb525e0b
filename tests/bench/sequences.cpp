// SPDX-License-Identifier: LGPL-2.1-or-later
#include "sequences.h"

#include <algorithm>
#include <cstdio>
#include <vector>

namespace cerberus::bench {

namespace {

// CDnet: 255 moving, 0 and 50 not, the rest ignored. DAVIS: > 0 moving (tennis: 170 ignored).
constexpr Sequence kSequences[] = {
    {"jitter_traffic",
     "multifilesrc location=%s/cdnet_jitter_traffic/input/in%%06d.jpg start-index=950 stop-index=1050 "
     "caps=image/jpeg,framerate=30/1 ! jpegdec",
     "cdnet_jitter_traffic/groundtruth/gt%06d.png", 950, 1050, 0, 255, 51, 254,
     "MOG2 .509  KNN .485  SGM .574  two .210  AND .157  tolerant .456"},
    {"dogs-jump", "filesrc location=%s/davis_dogs-jump/dogs_jump_orig.mp4 ! decodebin",
     "davis_dogs-jump/gt/%05d.png", 0, 65, 0, 1, 256, 0,
     "MOG2 .453  KNN .536  SGM .589  two .407  AND .180  tolerant .443"},
    {"tennis",
     "multifilesrc location=%s/davis_tennis/frames/%%05d.jpg start-index=0 stop-index=69 "
     "caps=image/jpeg,framerate=24/1 ! jpegdec",
     "davis_tennis/gt/%05d.png", 0, 69, 0, 255, 170, 170,
     "MOG2 .325  KNN .265  SGM .766  two .283  AND .222  tolerant .789"},
    {"highway",
     "multifilesrc location=%s/cdnet_baseline_highway/input/in%%06d.jpg start-index=300 stop-index=700 "
     "caps=image/jpeg,framerate=30/1 ! jpegdec",
     "cdnet_baseline_highway/groundtruth/gt%06d.png", 470, 700, 170, 255, 51, 254,
     "MOG2 .781  KNN .839  SGM .721  two .539  AND .349  tolerant .459"},
};

constexpr Sequence followed(const char* name, const char* source, const char* truth, int last,
                            const char* reference) {
  return {name, source, truth, 0, last, 0, 1, 256, 0, reference};
}
constexpr Sequence kFollowed[] = {
    followed(
        "parkour",
        "multifilesrc location=%s/davis_parkour/frames/%%05d.jpg caps=image/jpeg,framerate=24/1 ! jpegdec",
        "davis_parkour/gt/%05d.png", 99, "MOG2 .148  tolerant .537"),
    followed("dance-twirl",
             "multifilesrc location=%s/davis_dance-twirl/frames/%%05d.jpg caps=image/jpeg,framerate=24/1 ! "
             "jpegdec",
             "davis_dance-twirl/gt/%05d.png", 89, "MOG2 .234  tolerant .709"),
    followed(
        "soapbox",
        "multifilesrc location=%s/davis_soapbox/frames/%%05d.jpg caps=image/jpeg,framerate=24/1 ! jpegdec",
        "davis_soapbox/gt/%05d.png", 98, "MOG2 .300  tolerant .721"),
    followed("motocross-jump",
             "multifilesrc location=%s/davis_motocross-jump/frames/%%05d.jpg caps=image/jpeg,framerate=24/1 "
             "! jpegdec",
             "davis_motocross-jump/gt/%05d.png", 39, "MOG2 .163  tolerant .399"),
    followed(
        "kite-surf",
        "multifilesrc location=%s/davis_kite-surf/frames/%%05d.jpg caps=image/jpeg,framerate=24/1 ! jpegdec",
        "davis_kite-surf/gt/%05d.png", 49, "MOG2 .177  tolerant .429"),
};

}  // namespace

std::span<const Sequence> sequences() {
  return kSequences;
}

std::span<const Sequence> followed_sequences() {
  return kFollowed;
}

const Sequence& sequence(const std::string& name) {
  return *std::ranges::find(kSequences, name, [](const Sequence& s) { return std::string(s.name); });
}

std::string source_of(const Sequence& s, const std::filesystem::path& data) {
  std::vector<char> out(static_cast<std::size_t>(std::snprintf(nullptr, 0, s.source, data.c_str())) + 1);
  std::snprintf(out.data(), out.size(), s.source, data.c_str());
  return out.data();
}

std::optional<Frames> load_truth(const Sequence& s, const std::filesystem::path& data, int width,
                                 int height) {
  std::string line = "multifilesrc location=" + (data / s.truth).string() +
                     " start-index=" + std::to_string(s.first) + " stop-index=" + std::to_string(s.last) +
                     " caps=image/png,framerate=1/1 ! pngdec";
  if (width > 0)
    line += " ! videoscale method=nearest-neighbour add-borders=false ! video/x-raw,width=" +
            std::to_string(width) + ",height=" + std::to_string(height) + ",pixel-aspect-ratio=1/1";
  return load_frames(line, "GRAY8", width, height, s.last - s.first + 1);
}

std::optional<std::size_t> scored_truth(const Sequence& s, const Frames& truth, int n) {
  const int k = n - s.ahead;
  if (n < 3 || k < 0 || k >= static_cast<int>(truth.data.size())) return std::nullopt;
  return static_cast<std::size_t>(k);
}

void score(Counts& counts, vision::GrayView mask, vision::GrayView truth, const Sequence& s) {
  for (int y = 0; y < truth.height; ++y) {
    const std::uint8_t* m = mask.row(y * mask.height / truth.height);
    const std::uint8_t* t = truth.row(y);
    for (int x = 0; x < truth.width; ++x) {
      if (t[x] >= s.ignored_from && t[x] <= s.ignored_to) continue;
      const bool found = m[x * mask.width / truth.width], moves = t[x] >= s.positive_from;
      counts.hit += found && moves;
      counts.extra += found && !moves;
      counts.missed += !found && moves;
    }
  }
}

}  // namespace cerberus::bench
