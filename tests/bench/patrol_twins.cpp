// SPDX-License-Identifier: LGPL-2.1-or-later
#include "patrol_twins.h"

#include <cerberus/cerberus.h>

#include <algorithm>
#include <functional>
#include <optional>

#include "development_sequences.h"

namespace cerberus::bench {
namespace {

// Pixels by which the picture moves in a frame, RMS to the sides and up and down, 320 wide: really 10.8 and 3.8 in the
// lobby, 2.1 and 1 in the kitchens; in the twins 9.4 and 6.8, 2 and 1.1.
const Twin kTwins[] = {
    {"a near person before a shaking camera",
     {"otb_BlurBody_a"},
     "patrolsimsrc plan=\"" CERBERUS_PATROL_PLAN "\" num-buffers=167 camera-height=1.5 start-tilt=-6 shake=3 "
     "shake-kind=hand exposure=30000000 yaw-rate=60 "
     "path=\"at 21 10.5; turn 12; turn -24; turn 12\" walks=\"at 24.4 10 180; go 24 11 .8; wait .8; go 24.8 "
     "10 "
     ".8\" ! video/x-raw,width=320,height=240,framerate=25/1"},
    {"a room gone round without anybody",
     {"nogt_kitchen_a", "nogt_kitchen_b"},
     "patrolsimsrc plan=\"" CERBERUS_PATROL_PLAN
     "\" num-buffers=540 people=0 camera-height=1.45 start-tilt=-18 start-pan=50 shake=.5 shake-kind=hand "
     "yaw-rate=20 speed=.35 path=\"at 21.1 5.9 -90; go 21.1 3.4; go 23.4 3.4; go 23.9 5.6\" ! "
     "video/x-raw,width=320,height=240"}};

using SubjectsOf = std::function<std::vector<Subject>(GstBuffer*, vision::Size, int)>;

std::optional<PatrolFigures> run(const std::string& line, const SubjectsOf& subjects_of) {
  std::optional<PatrolScore> score;
  const bool ran = for_each_sample(line + " ! appsink name=out sync=false", [&](GstSample* sample, int n) {
    GstBuffer* frame = gst_sample_get_buffer(sample);
    const vision::Size size = size_of(sample);
    if (!score) score.emplace(size, 90);  // no head follows
    score->add(subjects_of(frame, size, n), found_on(frame), double(GST_BUFFER_PTS(frame)) / GST_SECOND);
  });
  if (!ran) return std::nullopt;
  return score->figures();
}

}  // namespace

std::span<const Twin> twins() {
  return kTwins;
}

std::vector<PatrolFigures> measure_real(const Twin& twin, const std::string& elements,
                                        const std::filesystem::path& data) {
  std::vector<PatrolFigures> all;
  const auto sequences = development_sequences(data);
  for (const std::string& name : twin.real) {
    const auto sequence = std::ranges::find(sequences, name, &DevelopmentSequence::name);
    if (sequence == sequences.end()) return {};
    const People people = read_truth(*sequence);
    for (const bool mirrored : {false, true}) {
      const auto figures =
          run(line_of(*sequence, mirrored) + " ! " + elements, [&](GstBuffer*, vision::Size size, int n) {
            std::vector<Subject> subjects;
            const auto here = people.find(n);
            if (here == people.end()) return subjects;
            for (Person person : here->second) {
              if (mirrored) person.box.x = size.width - person.box.right();
              subjects.push_back({person});
            }
            return subjects;
          });
      if (!figures) return {};
      all.push_back(*figures);
    }
  }
  return all;
}

std::vector<PatrolFigures> measure_simulated(const Twin& twin, const std::string& elements, int seeds) {
  std::vector<PatrolFigures> all;
  for (int seed = 1; seed <= seeds; ++seed) {
    std::string line = twin.scene + " ! " + elements;
    line.insert(line.find("plan="), "seed=" + std::to_string(seed) + " ");
    const auto figures = run(line, [](GstBuffer* frame, vision::Size, int) {
      std::vector<Subject> subjects;
      if (const CerberusTruth* truth = cerberus_buffer_peek_truth(frame))
        for (const CerberusTruthPerson& p : std::span(truth->persons).first(truth->n_persons))
          subjects.push_back({{int(p.id), {p.x, p.y, p.width, p.height}}, p.visible});
      return subjects;
    });
    if (!figures) return {};
    all.push_back(*figures);
  }
  return all;
}

}  // namespace cerberus::bench
