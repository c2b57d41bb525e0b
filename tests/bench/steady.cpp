// SPDX-License-Identifier: LGPL-2.1-or-later
// Does it report only what moves? After cuts, seeks and in shaking pictures: the reported regions that overlap nothing
// that moves, by the ground truth, and those reported before three frames of the new scene were seen. An error is due
// to the cut unless there is one in the same frame of the same sequence without any cut, too. And before still
// pictures of real places under flickering light and with changing exposure: every region is wrong.
//
//   bench-steady [--list]    with a line for every error
#include <gst/gst.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "asked.h"
#include "sequences.h"
#include "support/chain.h"
#include "support/data.h"
#include "support/sensor.h"

using namespace cerberus;
using namespace cerberus::bench;
using vision::Box;
using vision::GrayView;

namespace {

constexpr double kFrame = 1.0 / 25;
constexpr int kOutside = 85;  // CDnet's, of what was not annotated
bool list = false;

// Frames and their truth at the same size; frame k of the one is frame k of the other.
struct Pictures {
  const char* name;
  Frames frames, truth;
  int moves_from;  // truth values from here on move, or may do so
  std::vector<std::vector<Box>>
      settled{};  // what is wrong in each frame without any cut (regions and tracks)
};

// Something that moves, or may do so, is under it; or none of it was annotated.
bool right(const Box& b, GrayView truth, int moves_from) {
  const int x0 = std::max(static_cast<int>(b.x), 0), y0 = std::max(static_cast<int>(b.y), 0);
  const int x1 = std::min(static_cast<int>(std::ceil(b.right())), truth.width);
  const int y1 = std::min(static_cast<int>(std::ceil(b.bottom())), truth.height);
  bool outside = true;
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      if (truth.at(x, y) >= moves_from) return true;
      outside = outside && truth.at(x, y) == kOutside;
    }
  return outside;
}

tests::Chain& step(tests::Chain& chain, GrayView frame) {
  chain.step({frame.data, frame.width, frame.height, frame.stride}, kFrame);
  return chain;
}

// A sequence that has been seen for long without any cut: once backwards, from the last frame to the first, before it
// is judged. What is wrong in a frame then, is so whether or not there was a cut.
void settle(Pictures& pictures) {
  tests::Chain chain;
  const std::size_t count = pictures.frames.data.size();
  for (std::size_t k = count - 1; k > 0; --k) step(chain, pictures.frames.grey(k));
  pictures.settled.resize(count);
  for (std::size_t k = 0; k < count; ++k) {
    step(chain, pictures.frames.grey(k));
    const auto note = [&](const auto& found) {
      for (const auto& f : found)
        if (!right(f.box, pictures.truth.grey(k), pictures.moves_from)) pictures.settled[k].push_back(f.box);
    };
    note(chain.regions());
    note(chain.tracks());
  }
}

std::optional<Pictures> load(const char* name, const std::filesystem::path& data, int height) {
  const Sequence& s = sequence(name);
  auto frames =
      load_frames(source_of(s, data) + " ! videoscale add-borders=false ! video/x-raw,width=320,height=" +
                      std::to_string(height) + ",pixel-aspect-ratio=1/1",
                  "GRAY8", 320, height, s.ahead + s.last - s.first + 1);
  auto truth = load_truth(s, data, 320, height);
  if (!frames || !truth || frames->data.size() != truth->data.size() + static_cast<std::size_t>(s.ahead)) {
    std::fprintf(stderr, "bench: %s is not complete\n", name);
    return std::nullopt;
  }
  frames->data.erase(frames->data.begin(), frames->data.begin() + s.ahead);
  const bool cdnet = s.ignored_from < kOutside && kOutside < s.ignored_to;
  Pictures pictures{name, std::move(*frames), std::move(*truth), cdnet ? kOutside + 1 : 1};
  settle(pictures);
  return pictures;
}

// Of one kind: regions, or tracks.
struct Found {
  int all = 0;
  int wrong = 0;       // overlap nothing that moves ...
  int by_the_cut = 0;  // ... and nothing wrong is there in that frame without the cut, either
  Found operator+(const Found& o) const { return {all + o.all, wrong + o.wrong, by_the_cut + o.by_the_cut}; }
};
struct Tally {
  int frames = 0;
  Found regions, tracks;
  int early = 0;  // frames with something, of the first two of a scene
};

// A chain, and how many frames it is since a cut or its start.
struct Watch {
  tests::Chain chain;
  int age = 0;

  void see(const Pictures& pictures, std::size_t k, Tally& tally) {
    step(chain, pictures.frames.grey(k));
    ++age;
    ++tally.frames;
    const auto judge = [&](const auto& found, const char* what, Found& count) {
      for (const auto& f : found) {
        ++count.all;
        if (right(f.box, pictures.truth.grey(k), pictures.moves_from)) continue;
        ++count.wrong;
        const bool anyway = std::ranges::any_of(
            pictures.settled[k], [&](const Box& b) { return vision::overlap_area(b, f.box) > 0; });
        count.by_the_cut += !anyway;
        if (list)
          std::printf("    %s frame %zu, %d since the cut: %s %.0f,%.0f %.0fx%.0f%s\n", pictures.name, k, age,
                      what, f.box.x, f.box.y, f.box.width, f.box.height, anyway ? ", without it, too" : "");
      }
    };
    judge(chain.regions(), "region", tally.regions);
    judge(chain.tracks(), "track", tally.tracks);
    tally.early += age < 3 && !(chain.regions().empty() && chain.tracks().empty());
  }
};

Tally operator+(const Tally& a, const Tally& b) {
  return {a.frames + b.frames, a.regions + b.regions, a.tracks + b.tracks, a.early + b.early};
}

Tally print(const std::string& name, const Tally& t) {
  std::printf("  %-40s %6d", name.c_str(), t.frames);
  for (const Found& f : {t.regions, t.tracks}) std::printf(" %5d %4d / %-5d", f.by_the_cut, f.wrong, f.all);
  std::printf(" %8d\n", t.early);
  return t;
}

// Pieces of the two by turns, of 8 to 40 frames each from anywhere; nothing marks where one ends.
Tally cuts(const Pictures& one, const Pictures& other, int runs, int pieces) {
  Tally all;
  for (int run = 0; run < runs; ++run) {
    std::mt19937 random(static_cast<unsigned>(run));
    Watch watch;
    Tally before;  // the first piece comes after no cut
    for (int piece = 0; piece < pieces; ++piece) {
      const Pictures& now = piece % 2 ? one : other;
      const std::size_t length = 8 + random() % 33, first = random() % (now.frames.data.size() - length + 1);
      watch.age = 0;
      for (std::size_t k = first; k < first + length; ++k) watch.see(now, k, piece ? all : before);
    }
  }
  return all;
}

// From the start to the end, forgetting all `each` frames, as a seek does: `shifts` ways, so that all ages meet all
// pictures.
Tally restarts(const Pictures& pictures, int each, int shifts) {
  Tally all;
  for (int shift = 0; shift < shifts; ++shift) {
    Watch watch;
    for (int k = shift * each / shifts; k < static_cast<int>(pictures.frames.data.size()); ++k) {
      if (k % each == shift * each / shifts) watch.chain.reset(), watch.age = 0;
      watch.see(pictures, static_cast<std::size_t>(k), all);
    }
  }
  return all;
}

// What comes after the first 30 frames of one that is never restarted.
Tally standing(const Pictures& pictures) {
  Tally young, all;
  Watch watch;
  for (std::size_t k = 0; k < pictures.frames.data.size(); ++k)
    watch.see(pictures, k, watch.age < 30 ? young : all);
  return all;
}

// ---- light

struct Lamp {
  const char* name;
  double flicker, bands;  // share of the light
  bool steps;             // of exposure, 0.7 to 1.4, each of which may cost three frames
  bool returns = false;   // with every third frame, as 100 Hz before 30 frames a second
  double settles = 1;     // frames in which most of a step is made
};
constexpr Lamp kLamps[] = {{"noise alone", 0, 0, false},
                           {"5 % flicker", 0.05, 0, false},
                           {"5 % bands", 0, 0.05, false},
                           {"steps of exposure", 0, 0, true},
                           {"3 % flicker, 3 % bands, steps", 0.03, 0.03, true},
                           {"5 % bands that return, steps", 0, 0.05, true, true},
                           {"3 % bands that return, steps", 0, 0.03, true, true},
                           {"steps that settle", 0, 0, true, false, 5},
                           {"8 % flicker, 8 % bands", 0.08, 0.08, false}};

// The first frame of each, 320 x 240 from its middle; none where one is missing.
struct Place {
  std::string name;
  Frames frame;
};
std::vector<Place> places(const std::filesystem::path& data) {
  std::vector<std::pair<std::string, std::string>> sources;
  for (const Sequence& s : sequences()) sources.emplace_back(s.name, source_of(s, data));
  for (const char* name : {"lebombo", "st_fagans_interior"})
    sources.emplace_back(
        name, "filesrc location=" + (data / "pano_indoor" / name).string() + "_1k_tonemapped.png ! pngdec");
  std::vector<Place> all;
  for (const auto& [name, source] : sources)
    if (auto frame = load_frames(source + " ! aspectratiocrop aspect-ratio=4/3", "GRAY8", 320, 240, 1))
      all.push_back({name, std::move(*frame)});
    else
      return {};
  return all;
}

struct Dark {
  int frames = 0, regions = 0, tracks = 0;  // with any
};

void watch(const Place& place, const Lamp& lamp, Dark& dark) {
  const GrayView picture = place.frame.grey(0);
  std::vector<float> scene;
  for (int y = 0; y < picture.height; ++y)
    scene.insert(scene.end(), picture.row(y), picture.row(y) + picture.width);
  tests::Noise noise;
  tests::Chain chain;
  vision::Image<std::uint8_t> frame(picture.size());
  tests::Light light{.global = lamp.flicker, .bands = lamp.bands, .period = lamp.returns ? 100.0 : 140.0};
  double exposure = 1;
  for (int k = 0, since = 100; k < 1000; ++k, ++since) {
    static constexpr double kSteps[] = {1, 0.7, 1.25, 0.8, 1.4, 1, 1.25};
    if (lamp.steps && k % 100 == 50) exposure = kSteps[(k / 100 + 1) % 7], since = 0;
    light.exposure += (exposure - light.exposure) / lamp.settles;
    light.phase = (lamp.returns ? 2 * std::numbers::pi / 3 / 1.7 : 0.17) * k;
    tests::expose(scene.data(), picture.width, light, noise, frame.view());
    const GrayView seen = frame.view();
    chain.step({seen.data, seen.width, seen.height, seen.stride}, kFrame);
    if (since < 3) continue;
    if (list)
      for (const vision::Region& r : chain.regions())
        std::printf("    %s, frame %d, %d since a step: %.0f,%.0f %.0fx%.0f\n", place.name.c_str(), k, since,
                    r.box.x, r.box.y, r.box.width, r.box.height);
    ++dark.frames;
    dark.regions += !chain.regions().empty();
    dark.tracks += !chain.tracks().empty();
  }
}

}  // namespace

int main(int argc, char** argv) {
  gst_init(&argc, &argv);
  list = argc > 1 && std::strcmp(argv[1], "--list") == 0;
  const auto data = tests::data_folder();
  if (!data) {
    std::printf("skipped: %s\n", tests::kNoData);
    return 77;
  }
  const auto tennis = load("tennis", *data, 180), dogs = load("dogs-jump", *data, 180);
  const auto highway = load("highway", *data, 240), jitter = load("jitter_traffic", *data, 240);
  if (!tennis || !dogs || !highway || !jitter) return 1;
  Asked asked;
  std::printf("Overlaps nothing that moves: because of the cut, wrong / all\n");
  std::printf("%48s%18s%18s too early\n", "frames", "regions ", "tracks ");
  Tally all = print("tennis and dogs-jump, 236 cuts", cuts(*tennis, *dogs, 4, 60));
  for (const Pictures* p : {&*highway, &*jitter})
    all = all + print(std::string(p->name) + ", a restart each 60 frames", restarts(*p, 60, 6));
  for (const auto& [name, figure] : {std::pair{"too early", all.early},
                                     {"wrong regions, by the cut", all.regions.by_the_cut},
                                     {"wrong tracks, by the cut", all.tracks.by_the_cut},
                                     {"wrong regions", all.regions.wrong},
                                     {"wrong tracks", all.tracks.wrong}})
    std::printf("  %-40s %8d%s\n", name, figure, asked.at_most(name, figure, 0).c_str());
  std::printf("for comparison, what is wrong without any cut\n");
  for (const Pictures* p : {&*tennis, &*dogs, &*highway, &*jitter})
    print(std::string(p->name) + ", from frame 30 on", standing(*p));

  const std::vector<Place> still = places(*data);
  if (still.empty()) return 1;
  std::printf("\n%zu places where nothing moves, frames with any     of  regions   tracks\n", still.size());
  for (const Lamp& lamp : kLamps) {
    Dark dark;
    for (const Place& place : still) watch(place, lamp, dark);
    std::printf("  %-40s %12d %8d %8d%s\n", lamp.name, dark.frames, dark.regions, dark.tracks,
                asked.at_most(lamp.name, dark.regions + dark.tracks, 0).c_str());
  }
  return asked.verdict();
}
