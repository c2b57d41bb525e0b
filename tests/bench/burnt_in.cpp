// SPDX-License-Identifier: LGPL-2.1-or-later
// What a camera writes into its own pictures is no object: a clock or a logo over panoramas that the camera sweeps, or
// looks at standing; and people who pass behind a clock are found as without it.
#include <gst/gst.h>
#include <gst/video/video.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>
#include <numeric>
#include <optional>
#include <random>
#include <sstream>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "asked.h"
#include "boxes.h"
#include "burnt_in_scenes.h"
#include "frames.h"
#include "support/chain.h"
#include "support/data.h"
#include "vision/geometry/window.h"

using namespace cerberus;
using namespace cerberus::bench;

namespace {

constexpr vision::Size kFrame{640, 480};
constexpr double kRate = 30, kSeconds = 20, kLearnt = 5;
constexpr double kTurn = 160;  // frame pixels a second: 20 degrees where 640 see 80

constexpr char kOutdoor[] = "outdoor", kOutdoorFile[] = "pano_outdoor_4k/examplepano.jpg ! jpegdec";
constexpr double kOutdoorScale = 1.4;

struct Panorama {
  const char* name;
  Frames picture;
  double scale;  // picture pixels a frame pixel
};

struct Tally {
  int frames = 0, with_object = 0;
  double share() const { return frames ? 1.0 * with_object / frames : 0; }
};

struct Run {
  Tally regions, tracks;
  int learnt = 0;  // frames with a box
  void take(const Run& other) {
    if (other.regions.share() >= regions.share()) regions = other.regions;
    if (other.tracks.share() >= tracks.share()) tracks = other.tracks;
    learnt = std::max(learnt, other.learnt);
  }
};

// What the camera shows of a panorama: it stands, or turns to and fro; with something written into its picture, or not.
// The noise is the same in every run.
class Camera {
 public:
  Camera(const Panorama& panorama, bool sweeps, std::optional<std::pair<Writing, Corner>> what)
      : panorama_(panorama), sweeps_(sweeps), what_(what), noise_(65536) {
    std::normal_distribution<double> normal(0, 2);
    for (auto& n : noise_) n = static_cast<std::int8_t>(std::lround(normal(random_)));
  }
  // The frame `n` of kRate a second; frames are drawn in order.
  vision::GrayView draw(int n) {
    const double t = n / kRate, scale = panorama_.scale;
    const auto grey = panorama_.picture.grey(0);
    const double reach = grey.width / 4.0, turn = std::fmod(sweeps_ ? kTurn * scale * t : 0, 4 * reach);
    const double offset = turn < reach ? turn : turn < 3 * reach ? 2 * reach - turn : turn - 4 * reach;
    const vision::MutableGrayView out = frame_.view();
    resampler_.draw({grey.data, grey.width, grey.height, grey.stride, 1, 1},
                    {out.data, kFrame.width, kFrame.height, out.stride, 1, 1},
                    {grey.width / 2.0 - kFrame.width * scale / 2 + offset,
                     grey.height / 2.0 - kFrame.height * scale / 2, scale, scale});
    std::size_t at = random_() % 65536;
    for (int y = 0; y < kFrame.height; ++y)
      for (int x = 0; x < kFrame.width; ++x)
        out.at(x, y) = static_cast<std::uint8_t>(std::clamp(out.at(x, y) + noise_[at++ & 65535], 0, 255));
    if (what_) write_into(out, what_->first, what_->second, t);
    return out;
  }

 private:
  const Panorama& panorama_;
  const bool sweeps_;
  const std::optional<std::pair<Writing, Corner>> what_;
  std::mt19937 random_{7};
  std::vector<std::int8_t> noise_;
  vision::Image<std::uint8_t> frame_{kFrame};
  vision::WindowResampler resampler_;
};

void step(tests::Chain& chain, vision::GrayView frame, double rate) {
  chain.step({frame.data, frame.width, frame.height, frame.stride, 1, false, 0, 0, 0}, 1 / rate);
}

Run watch(const Panorama& p, bool sweep, std::optional<std::pair<Writing, Corner>> what, bool learn) {
  Camera camera(p, sweep, what);
  tests::Chain chain;
  chain.set_burnt_in(learn);
  Run run;
  for (int n = 0; n < kSeconds * kRate; ++n) {
    step(chain, camera.draw(n), kRate);
    run.learnt += !chain.burnt_in().empty();
    if (n / kRate < kLearnt) continue;
    ++run.regions.frames, ++run.tracks.frames;
    run.regions.with_object += !chain.regions().empty();
    run.tracks.with_object += !chain.tracks().empty();
  }
  return run;
}

// CPU time that learning adds, as a share of the time without it. Both run on the same frames in turn, five times; a
// frame's time is the shortest of five, because other programs disturb single ones.
double added_cost(const Panorama& p, bool sweep, std::optional<std::pair<Writing, Corner>> what) {
  constexpr int kFrames = 240, kRounds = 5;
  std::vector<vision::Image<std::uint8_t>> frames(kFrames);
  Camera camera(p, sweep, what);
  for (int n = 0; n < kFrames; ++n) {
    const vision::GrayView view = camera.draw(n);
    frames[n].resize(kFrame);
    for (int y = 0; y < kFrame.height; ++y) std::copy_n(view.row(y), kFrame.width, frames[n].view().row(y));
  }
  std::vector<double> shortest[2];
  for (auto& times : shortest) times.assign(kFrames, 1e9);
  for (int round = 0; round < kRounds; ++round) {
    tests::Chain chains[2];
    chains[1].set_burnt_in(true);
    for (int n = 0; n < kFrames; ++n)
      for (const int which : {(n + round) % 2, (n + round + 1) % 2}) {
        const double begin = thread_seconds();
        step(chains[which], frames[n].view(), kRate);
        double& least = shortest[which][n];
        least = std::min(least, thread_seconds() - begin);
      }
  }
  const auto sum = [](const std::vector<double>& times) {
    return std::accumulate(times.begin(), times.end(), 0.0);
  };
  return sum(shortest[1]) / sum(shortest[0]) - 1;
}

// Grey frames of a video, one after the other: a long one does not fit into memory.
bool for_each_grey(const std::string& source, const std::function<void(vision::MutableGrayView, int)>& each) {
  vision::Image<std::uint8_t> frame;
  return for_each_sample(
      source + " ! videoconvert ! video/x-raw,format=GRAY8 ! appsink name=out sync=false max-buffers=4",
      [&](GstSample* sample, int n) {
        GstVideoInfo info;
        GstVideoFrame mapped;
        if (!gst_video_info_from_caps(&info, gst_sample_get_caps(sample)) ||
            !gst_video_frame_map(&mapped, &info, gst_sample_get_buffer(sample), GST_MAP_READ))
          return;
        frame.resize({info.width, info.height});
        for (int y = 0; y < info.height; ++y)
          std::memcpy(frame.view().row(y),
                      static_cast<const std::uint8_t*>(GST_VIDEO_FRAME_PLANE_DATA(&mapped, 0)) +
                          static_cast<std::ptrdiff_t>(y) * GST_VIDEO_FRAME_PLANE_STRIDE(&mapped, 0),
                      static_cast<std::size_t>(info.width));
        gst_video_frame_unmap(&mapped);
        each(frame.view(), n);
      });
}

struct WithPeople {
  Counts counts;
  int learnt_frames = 0;  // with a box
  int on_people = 0;      // annotated people whose box a learnt one covers by more than a tenth
};

constexpr double kVideoRate = 10;  // of vtest.avi and of Intel's clip

WithPeople people(const std::string& source, const People& truth, double ends,
                  std::optional<std::pair<Writing, Corner>> what, bool learn) {
  tests::Chain chain;
  chain.set_burnt_in(learn);
  WithPeople result;
  for_each_grey(source, [&](vision::MutableGrayView frame, int n) {
    if (what) write_into(frame, what->first, what->second, n / kVideoRate);
    step(chain, frame, kVideoRate);
    std::vector<vision::Box> learnt, found, there;
    const double scale = 1.0 * frame.width / chain.analysis_size().width;
    for (const auto& b : chain.burnt_in())
      learnt.push_back({b.x * scale, b.y * scale, b.width * scale, b.height * scale});
    result.learnt_frames += !learnt.empty();
    for (const auto& t : chain.tracks())
      if (t.box.right() <= ends) found.push_back(t.box);
    if (const auto at = truth.find(n); at != truth.end()) {
      for (const Person& p : at->second) {
        there.push_back(p.box);
        for (const auto& b : learnt) result.on_people += vision::overlap_area(b, p.box) > .1 * p.box.area();
      }
      match(result.counts, found, there);
    }
  });
  return result;
}

// frame, x, y, width, height a line, after a heading.
People read_intel(const std::filesystem::path& file) {
  People people;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream fields(line);
    int frame;
    double x, y, w, h;
    if (fields >> frame >> x >> y >> w >> h) people[frame].push_back({1, {x, y, w, h}});
  }
  return people;
}

constexpr Writing kWritings[] = {Writing::sans_clock, Writing::monospace_clock, Writing::blinking_logo};
constexpr Corner kCorners[] = {Corner::top_left, Corner::top_right, Corner::bottom_left,
                               Corner::bottom_right};

std::optional<Panorama> load(const std::filesystem::path& data, const char* name, const char* source,
                             double scale) {
  auto picture = load_frames("filesrc location=" + (data / source).string(), "GRAY8", 0, 0, 1);
  if (!picture) return std::nullopt;
  return Panorama{name, std::move(*picture), scale};
}

bool cost(const std::filesystem::path& data, Asked& asked) {
  const auto p = load(data, kOutdoor, kOutdoorFile, kOutdoorScale);
  if (!p) return false;
  std::puts(
      "\nCPU time that learning adds, as a share of that of detection, 320 x 240 at 30 frames a second");
  for (const bool sweep : {false, true})
    for (const bool clock : {false, true}) {
      const auto what =
          clock ? std::optional(std::pair{Writing::sans_clock, Corner::top_left}) : std::nullopt;
      const std::string name =
          std::string("camera ") + (sweep ? "sweeps" : "stands") + (clock ? ", sans clock" : ", nothing");
      const double added = added_cost(*p, sweep, what);
      std::printf("  %-50s %.4f%s\n", name.c_str(), added, asked.at_most(name, added, .02, false).c_str());
      std::fflush(stdout);
    }
  return true;
}

// On a panorama nothing is an object. `before`: without learning, too.
bool nobody(const std::filesystem::path& data, bool before, Asked& asked) {
  double worst_regions = 0, worst_tracks = 0, worst_learnt = 0, worst_logo = 0;
  std::printf("Share of the frames after 5 s with a region and with a track, worst of four corners%s\n",
              before ? "; in brackets without learning" : "");
  for (const auto& [name, source, scale] :
       {std::tuple{kOutdoor, kOutdoorFile, kOutdoorScale},
        {"gallery", "pano_indoor/st_fagans_interior_1k_tonemapped.png ! pngdec", .4},
        {"studio", "pano_indoor/studio_small_03_1k_tonemapped.png ! pngdec", .4}}) {
    const auto loaded = load(data, name, source, scale);
    if (!loaded) return false;
    const Panorama& p = *loaded;
    for (const bool sweep : {false, true}) {
      const char* camera = sweep ? "sweeps" : "stands";
      const Run plain = watch(p, sweep, {}, true);
      worst_learnt = std::max(worst_learnt, 1.0 * plain.learnt);
      std::printf("  %-8s %-7s %-16s %.3f %.3f, learnt in %d frames\n", name, camera, "nothing",
                  plain.regions.share(), plain.tracks.share(), plain.learnt);
      for (const Writing w : kWritings) {
        Run worst, worst_before;
        for (const Corner c : kCorners) {
          worst.take(watch(p, sweep, std::pair{w, c}, true));
          if (before) worst_before.take(watch(p, sweep, std::pair{w, c}, false));
        }
        std::printf("  %-8s %-7s %-16s %.3f %.3f", name, camera, name_of(w), worst.regions.share(),
                    worst.tracks.share());
        if (before) std::printf(" (%.3f %.3f)", worst_before.regions.share(), worst_before.tracks.share());
        std::puts("");
        std::fflush(stdout);
        if (w == Writing::blinking_logo) {
          worst_logo = std::max({worst_logo, worst.regions.share(), worst.tracks.share()});
          continue;
        }
        worst_regions = std::max(worst_regions, worst.regions.share());
        worst_tracks = std::max(worst_tracks, worst.tracks.share());
      }
    }
  }
  std::printf("  %-50s %.3f%s\n", "frames with a blinking logo", worst_logo,
              asked.at_most("frames with a blinking logo", worst_logo, .01).c_str());
  for (const auto& [name, figure, most] : {std::tuple{"frames with a region", worst_regions, .01},
                                           {"frames with a track", worst_tracks, .01},
                                           {"frames with a box where nothing is written", worst_learnt, 0.}})
    std::printf("  %-50s %.3f%s\n", name, figure, asked.at_most(name, figure, most).c_str());
  return true;
}

void print(const std::string& name, const WithPeople& r, const std::string& verdict = {}) {
  std::printf("  %-40s %.3f %.3f   %d %d%s\n", name.c_str(), r.counts.precision(), r.counts.recall(),
              r.learnt_frames, r.on_people, verdict.c_str());
  std::fflush(stdout);
}

// Of the recall that a writing over the picture may cost. One corner of twelve is at .012.
constexpr double kCost = .015;

void with_people(const std::filesystem::path& data, const std::string& vtest, Asked& asked) {
  std::printf("\nPeople: precision, recall; frames with a box, annotated people that one covers\n");
  const People campus = read_people(data / "pets09_s2l1_view1" / "gt.txt"),
               room = read_intel(data / "intel_one-by-one" / "boxes.csv");
  const WithPeople plain = people(vtest, campus, kTruthEnds, {}, true);
  print("vtest.avi", plain, asked.at_most("people of vtest.avi learnt", plain.on_people, 0));
  const WithPeople indoor =
      people("filesrc location=\"" +
                 (data / "intel_one-by-one" / "one-by-one-person-detection.mp4").string() + "\" ! decodebin",
             room, 1e9, {}, true);
  print("intel_one-by-one", indoor, asked.at_most("people of intel_one-by-one learnt", indoor.on_people, 0));
  for (const Writing w : kWritings)
    for (const Corner c : kCorners) {
      const std::string name = std::string("vtest.avi, ") + name_of(w) + " " + name_of(c);
      const WithPeople r = people(vtest, campus, kTruthEnds, std::pair{w, c}, true);
      print(name, r, asked.at_least("recall, " + name, r.counts.recall() - plain.counts.recall(), -kCost));
    }
}

}  // namespace

int main(int argc, char** argv) {
  gst_init(&argc, &argv);
  const auto real = tests::real_video();
  if (!real) return tests::kSkipped;
  Asked asked;
  const std::string option = argc > 1 ? argv[1] : "";
  if (!cost(real->data, asked)) return 1;
  if (option == "--cost") return 0;
  if (!nobody(real->data, option == "--before", asked)) return 1;
  with_people(real->data, real->vtest, asked);
  return asked.verdict();
}
