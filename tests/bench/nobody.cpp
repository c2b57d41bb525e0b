// SPDX-License-Identifier: LGPL-2.1-or-later
// Where nobody is nobody shall be found, and who enters shall be found at once:
// - intel_one-by-one: six visits of one person each to a room that is empty in between;
// - an empty room (the first frames of that clip, again and again) whose curtain sways, whose light changes slowly and
//   at once, with noise and a clock: a minute of it, with CERBERUS_HOURS=N so many hours.
#include <cerberus/cerberus.h>
#include <gst/app/gstappsrc.h>
#include <gst/gst.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "asked.h"
#include "boxes.h"
#include "burnt_in_scenes.h"
#include "frames.h"
#include "support/data.h"

using namespace cerberus;
using namespace cerberus::bench;
namespace fs = std::filesystem;

namespace {

constexpr int kRate = 10;  // frames a second, of the clip

struct Interval {
  int first = 0, last = 0;
  std::string state;
};

// The lines of a file of comma-separated values behind its first one.
std::vector<std::vector<std::string>> rows_of(const fs::path& file) {
  std::vector<std::vector<std::string>> rows;
  std::ifstream in(file);
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::istringstream fields(line);
    auto& row = rows.emplace_back();
    for (std::string field; std::getline(fields, field, ',');) row.push_back(field);
  }
  return rows;
}

std::string clip_of(const fs::path& folder) {
  return "filesrc location=" + (folder / "one-by-one-person-detection.mp4").string() + " ! decodebin";
}

// promised: whether all six must be found; in the empty room nothing may be.
bool visits(const fs::path& folder, const std::string& elements, bool promised, Asked& asked) {
  std::vector<Interval> intervals;
  for (const auto& row : rows_of(folder / "presence.csv"))
    intervals.push_back({std::atoi(row[0].c_str()), std::atoi(row[1].c_str()), row[2]});
  std::map<int, vision::Box> truth;
  for (const auto& row : rows_of(folder / "boxes.csv"))
    truth[std::atoi(row[0].c_str())] = {std::atof(row[1].c_str()), std::atof(row[2].c_str()),
                                        std::atof(row[3].c_str()), std::atof(row[4].c_str())};
  std::map<int, std::vector<vision::Box>> found;
  if (!for_each_sample(clip_of(folder) + " ! " + elements + " ! appsink name=out sync=false",
                       [&](GstSample* s, int n) { found[n] = found_boxes(gst_sample_get_buffer(s)); }))
    return false;
  int in_time = 0, visits = 0;
  std::size_t of_nobody = 0;
  double latest = 0;
  for (const Interval& i : intervals) {
    if (i.state == "empty")
      for (int n = i.first; n <= i.last; ++n) of_nobody += found[n].size();
    if (i.state != "person") continue;
    ++visits;
    int first = i.first;
    const auto is_there = [&](int n) {
      const auto person = truth.find(n);
      return person != truth.end() && std::ranges::any_of(found[n], [&](const vision::Box& box) {
               return vision::intersection_over_union(box, person->second) >= 0.3;
             });
    };
    while (first <= i.last && !is_there(first)) ++first;
    const double after = static_cast<double>(first - i.first) / kRate;
    in_time += after <= 1;
    latest = std::max(latest, after);
  }
  std::printf("%s: of %d visits found within 1 s %d, the last after %.1f s%s\n", elements.c_str(), visits,
              in_time, latest, asked.at_least("visits of " + elements, in_time, 6, promised).c_str());
  std::printf("  regions in the empty room %zu%s\n", of_nobody,
              asked.at_most("regions in the empty room of " + elements, double(of_nobody), 0).c_str());
  return true;
}

// The frames of an empty room in which much changes.
class EmptyRoom {
 public:
  EmptyRoom(Frames frames, int count) : frames_(std::move(frames)), count_(count) {}

  void play_into(GstElement* pipeline) {
    GstElement* in = gst_bin_get_by_name(GST_BIN(pipeline), "in");
    g_signal_connect(in, "need-data", G_CALLBACK(+[](GstAppSrc* source, guint, gpointer self) {
                       static_cast<EmptyRoom*>(self)->push(source);
                     }),
                     this);
    gst_object_unref(in);
  }
  std::string caps() const { return frames_.caps + ",framerate=" + std::to_string(kRate) + "/1"; }

 private:
  void push(GstAppSrc* source) {
    if (number_ == count_) {
      gst_app_src_end_of_stream(source);
      return;
    }
    const std::size_t which = frames_.loop(static_cast<std::size_t>(number_));
    std::vector<std::uint8_t> bytes = frames_.data[which];
    const double seconds = static_cast<double>(number_) / kRate;
    const std::ptrdiff_t stride = static_cast<std::ptrdiff_t>(bytes.size()) / frames_.height;
    // The light goes up and down by a seventh within 20 s, and a lamp is switched every 15 s.
    const double light = (1 + 0.15 * std::sin(2 * std::numbers::pi * seconds / 20)) *
                         (static_cast<int>(seconds / 15) % 2 ? 1.2 : 1);
    const int left = frames_.width * 7 / 10, right = frames_.width * 9 / 10;  // of the curtain
    for (int y = 0; y < frames_.height; ++y) {
      // It hangs from above: its lower end sways most.
      const double sway = 10.0 * y / frames_.height * std::sin(2 * std::numbers::pi * seconds / 2.5);
      for (int x = 0; x < frames_.width; ++x) {
        const int from = x < left || x >= right
                             ? x
                             : std::clamp(x + static_cast<int>(std::lround(sway)), 0, frames_.width - 1);
        const double value = light * frames_.data[which][static_cast<std::size_t>(y * stride + from)];
        bytes[static_cast<std::size_t>(y * stride + x)] =
            static_cast<std::uint8_t>(std::clamp(value + noise_(random_), 0.0, 255.0));
      }
    }
    write_into({bytes.data(), frames_.width, frames_.height, stride}, Writing::sans_clock, Corner::top_left,
               seconds);
    GstBuffer* buffer = gst_buffer_new_memdup(bytes.data(), bytes.size());
    GST_BUFFER_PTS(buffer) = gst_util_uint64_scale(static_cast<guint64>(number_), GST_SECOND, kRate);
    GST_BUFFER_DURATION(buffer) = GST_SECOND / kRate;
    ++number_;
    gst_app_src_push_buffer(source, buffer);
  }

  Frames frames_;
  int count_, number_ = 0;
  std::mt19937 random_{1};
  std::normal_distribution<double> noise_{0, 3};  // grey levels, of a camera in a dim room
};

bool nobody(const fs::path& folder, Asked& asked) {
  constexpr int kEmpty = 54;  // frames at the start of the clip
  auto frames = load_frames(clip_of(folder), "GRAY8", 0, 0, kEmpty);
  if (!frames) return false;
  const char* hours = std::getenv("CERBERUS_HOURS");
  const int minutes = hours ? std::max(1, static_cast<int>(60 * std::atof(hours))) : 1;
  EmptyRoom room(std::move(*frames), minutes * 60 * kRate);
  int all = 0, moving = 0, like = 0, persons = 0, first = -1;
  const bool measured = for_each_sample(
      "appsrc name=in format=time block=true max-buffers=4 max-bytes=0 caps=\"" + room.caps() +
          "\" ! motiondetect ! personverify ! appsink name=out sync=false max-buffers=4",
      [&](GstSample* sample, int) {
        GPtrArray* regions = cerberus_buffer_get_regions(gst_sample_get_buffer(sample));
        bool any_person = false, any_like = false;
        for (guint i = 0; i < regions->len; ++i) {
          const auto* r = static_cast<const CerberusRegion*>(g_ptr_array_index(regions, i));
          any_person = any_person || r->person;
          any_like = any_like || r->kind == CERBERUS_REGION_KIND_PERSON_LIKE;
        }
        if (any_person && first < 0) first = all;
        ++all, moving += regions->len > 0, like += any_like, persons += any_person;
        g_ptr_array_unref(regions);
      },
      [&](GstElement* pipeline) { room.play_into(pipeline); });
  if (!measured) return false;
  std::printf("an empty room, %d min: of %d frames with a region %d, like a person %d, with a person %d%s\n",
              minutes, all, moving, like, persons,
              asked.at_most("frames with a person who is not there", persons, 0).c_str());
  if (first >= 0) std::printf("  the first after %.1f s\n", static_cast<double>(first) / kRate);
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  gst_init(&argc, &argv);
  const auto data = tests::data_folder();
  if (!data || !fs::exists(*data / "intel_one-by-one")) {
    std::printf("skipped: %s\n", tests::kNoData);
    return 77;
  }
  const fs::path folder = *data / "intel_one-by-one";
  Asked asked;
  bool measured = visits(folder, "motiondetect", true, asked);
  measured = visits(folder, "motiondetect ! personverify require=person", false, asked) && measured;
  measured = nobody(folder, asked) && measured;
  const int verdict = asked.verdict();
  return measured ? verdict : 1;
}
