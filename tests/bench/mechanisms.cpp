// SPDX-License-Identifier: LGPL-2.1-or-later
#include "mechanisms.h"

#include <algorithm>
#include <fstream>
#include <regex>

#include "parameters.h"

namespace cerberus::bench {
namespace fs = std::filesystem;
namespace {

using Settings = DetectorSettings;

const std::vector<Mechanism> kMechanisms{
    // From the camera's motion to the foreground mask.
    {"ego_motion", {"ego_motion/*"}, 0, {}, [](Settings& s) { s.camera_motion = false; }},
    {"light",
     {"change/light.*", "change/light_kernels.*", "change/light_samples.*", "background/background_light.*"},
     0,
     {},
     [](Settings& s) { s.numbers.mechanisms.light = s.options.differences.compensate_light = false; }},
    {"noise_floor",
     {"change/fuzzy_threshold.cpp clamp_to_noise"},
     0,
     {},
     [](Settings& s) { s.options.foreground.noise_floor = false; }},
    {"background_model",
     {"background/*", "components/*"},
     0,
     {},
     [](Settings& s) { s.options.foreground.background_model = false; }},
    {"alignment",
     {"background/alignment.*"},
     0,
     {},
     [](Settings& s) { s.numbers.mechanisms.alignment = false; }},
    {"mosaic", {"background/mosaic.*"}, 0, {}, [](Settings& s) { s.numbers.mechanisms.mosaic = false; }},
    {"motion_blur",
     {"background/motion_blur.*", "background/foreground_classification.cpp suppress_blur"},
     1,
     {},
     [](Settings& s) { s.numbers.mechanisms.motion_blur = false; }},
    {"flashes",
     {"components/flashes.*"},
     0,
     {},
     [](Settings& s) { s.numbers.mechanisms.components.flashes = false; }},
    {"was_empty", {}, 3, {}, [](Settings& s) { s.numbers.mechanisms.components.was_empty = false; }},
    {"sides_go_on",
     {"components/components.cpp doubt_edges", "components/component_sides.cpp sides_go_on"},
     1,
     {},
     [](Settings& s) { s.numbers.mechanisms.components.sides_go_on = false; }},
    {"component_origins",
     {"components/component_origins.*", "components/components.cpp find_ghosts"},
     3,
     {},
     [](Settings& s) { s.numbers.mechanisms.components.origins = false; }},
    {"resting_ghosts",
     {"components/resting_ghosts.*"},
     0,
     {},
     [](Settings& s) { s.numbers.mechanisms.components.resting_ghosts = false; }},
    {"merge_neighbours",
     {"components/components.cpp merge_neighbours", "components/component_sides.cpp is_even",
      "components/component_sides.cpp is_side_of_object"},
     6,
     {},
     [](Settings& s) { s.numbers.mechanisms.components.merge_neighbours = false; }},
    {"burnt_in", {"burnt_in/*"}, 0, {}, [](Settings& s) { s.options.burnt_in = false; }},

    // From the mask to regions.
    {"people", {"detection/*"}, 0, {}, [](Settings& s) { s.options.regions.people = false; }},
    {"height_prior",
     {"detection/height_prior.*", "detection/regions.cpp learn"},
     8,
     {"height.least=1000000"}},
    {"blob_parting", {"detection/blob_parting.*"}, 0, {"parting.least_height=1000000"}},
    {"outline", {"detection/outline.*"}, 0, {"outline.skirt=0", "outline.reach=0"}},
    {"free_head", {"detection/person_box.cpp has_free_head"}, 6, {"head.least_core=0", "head.most_beside=1"}},
    {"walking_bodies", {"detection/walking_bodies.h"}, 0, {"bodies.least_frames=1000000"}},
    {"stirs", {"detection/regions.cpp changed"}, 1, {"regions.stirs=0"}},
    {"blocks",
     {"detection/people.cpp is_block", "detection/people.cpp gaps", "detection/people.cpp filled"},
     6,
     {"people.solid=2", "people.gaps=-1", "people.gaps_after=-1", "people.gaps_unknown=-1"}},
    {"unexplained",
     {"detection/regions.cpp unexplained"},
     4,
     {"regions.loose=2", "regions.beside=2", "regions.feet=2"}},
    {"person_box", {"detection/person_box.*"}, 0, {"box.measured=0"}},
    {"resting_columns", {"detection/person_box.cpp columns_of"}, 3, {"box.rests=0"}},
    {"rim", {}, 2, {"regions.young=0"}},
    {"two_frame_confirmation", {"detection/two_frame_confirmation.*"}, 0, {"confirmation.frames=0"}},
    {"box_edge", {"geometry/box_edge.h"}, 0, {"edge.blur=0"}},

    // Tracks.
    {"appearance",
     {"tracking/appearance_model.*", "tracking/region_appearances.*"},
     11,
     {"track.appearance_frames=1000000", "association.appearance_cost=0", "association.known_cost=0"}},
    {"appearance_in_groups",
     {"tracking/region_appearances.cpp find"},
     8,
     {"search.reach=0", "search.inside=2"}},
    {"appearance_cost",
     {"tracking/data_association.cpp appearance_cost"},
     6,
     {"association.appearance_cost=0", "association.known_cost=0", "association.sudden_change=2",
      "association.usual_change=2"}},
    {"follow_leap", {"tracking/data_association.cpp follow_leap"}, 1, {"association.leap=0"}},
    {"fragments_and_groups",
     {"tracking/data_association.cpp gather_fragments", "tracking/data_association.cpp side_by_side",
      "tracking/data_association.cpp one_above_another", "tracking/data_association.cpp share_regions",
      "tracking/data_association.cpp occludes", "tracking/data_association.cpp merge_fragments",
      "tracking/data_association.cpp is_part"},
     3,
     {"association.inside=2"}},
    {"occlusion", {"tracking/data_association.cpp occludes"}, 2, {"association.occluded_overlap=2"}},
    {"stopped",
     {"tracking/life_cycle.cpp has_stopped", "tracking/life_cycle.cpp advance_stopped"},
     7,
     {"life.seen=1000000"}},
    {"off_screen",
     {"tracking/life_cycle.cpp leave", "tracking/life_cycle.cpp walk_out",
      "tracking/life_cycle.cpp come_back", "tracking/life_cycle.cpp resume_stop",
      "tracking/life_cycle.cpp advance_off_screen", "tracking/life_cycle.cpp depart",
      "tracking/track_hypothesis.cpp predict_off_screen", "tracking/track_hypothesis.cpp expected",
      "tracking/track_hypothesis.cpp restore_whole", "tracking/track_hypothesis.cpp note_whole"},
     9,
     {"track.travelled=1000000"}},
    {"thing_group", {}, 1, {"track.thing_group=1"}},
    {"kind_of_group",
     {"tracking/track_correction.cpp take_kind"},
     1,
     {"track.thing_group=1000000", "track.settled=1000000"}},
    {"stride", {}, 1, {"track.stride=0"}},
    {"growth",
     {"tracking/track_correction.cpp follow_ends", "tracking/track_hypothesis.cpp approach",
      "tracking/track_hypothesis.cpp stretch"},
     3,
     {"track.upright=1000000"}},
    {"panned", {}, 1, {"track.panned_acceleration=0.25"}},
    {"fast", {}, 1, {"track.fast=1000000"}},
};

std::vector<std::string> lines_of(const fs::path& file) {
  std::vector<std::string> lines;
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

// A struct's members with a default that is a number, but zeros: those are states.
int numbers_in(const std::vector<std::string>& lines) {
  static const std::regex tuned(R"(^ *(double|float|int|std::[a-z0-9_:<>]+) [a-z_0-9]+ =($| [-0-9.]).*)"),
      zero(R"(.*= 0(\.0*)?[;,].*)");
  return static_cast<int>(std::ranges::count_if(lines, [](const std::string& line) {
    return std::regex_match(line, tuned) && !std::regex_match(line, zero);
  }));
}

// Lines of a function's definition and of the comment before it.
int lines_of_function(const std::vector<std::string>& lines, const std::string& function) {
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::size_t at = lines[i].find(function + '(');
    if (at == std::string::npos || at == 0 || lines[i][0] == ' ' || lines[i][0] == '/' ||
        (lines[i][at - 1] != ' ' && lines[i][at - 1] != ':'))
      continue;
    std::size_t end = i, first = i;
    while (end < lines.size() && lines[end] != "}") ++end;
    while (first > 0 && lines[first - 1].starts_with("//")) --first;
    return static_cast<int>(end + 1 - first);
  }
  return 0;
}

// "folder/name.*" and "folder/*" are several files.
bool is_meant(const std::string& pattern, const fs::path& file) {
  if (pattern == "*") return true;
  return pattern.ends_with(".*") ? file.stem() == pattern.substr(0, pattern.size() - 2)
                                 : file.filename() == pattern;
}

Extent extent_of_source(const std::string& source, const fs::path& vision) {
  Extent extent;
  const std::size_t space = source.find(' ');
  const fs::path pattern = source.substr(0, space);
  std::error_code ignored;
  for (const fs::directory_entry& file : fs::directory_iterator(vision / pattern.parent_path(), ignored)) {
    if (!is_meant(pattern.filename().string(), file.path())) continue;
    const auto lines = lines_of(file.path());
    if (space != std::string::npos) {
      extent.lines += lines_of_function(lines, source.substr(space + 1));
    } else {
      extent.lines += static_cast<int>(lines.size());
      extent.numbers += numbers_in(lines);
    }
  }
  return extent;
}

}  // namespace

const std::vector<Mechanism>& mechanisms() {
  return kMechanisms;
}

std::string leave_out(DetectorSettings& settings, std::string_view names) {
  while (!names.empty()) {
    const std::string_view name = names.substr(0, names.find(','));
    names.remove_prefix(std::min(names.size(), name.size() + 1));
    const auto found = std::ranges::find(kMechanisms, name, &Mechanism::name);
    if (found == kMechanisms.end()) {
      std::string all = "no mechanism is named \"" + std::string(name) + "\"; the names are:";
      for (const Mechanism& m : kMechanisms) all += std::string(" ") + m.name;
      return all;
    }
    for (const char* assignment : found->without)
      if (std::string wrong = set_number(settings.numbers, assignment); !wrong.empty()) return wrong;
    if (found->leave_out) found->leave_out(settings);
  }
  return {};
}

Extent extent_of(const Mechanism& mechanism, const fs::path& source_tree) {
  Extent all{0, mechanism.other_numbers};
  for (const char* source : mechanism.sources) {
    const Extent extent = extent_of_source(source, source_tree / "lib" / "vision");
    all.lines += extent.lines, all.numbers += extent.numbers;
  }
  return all;
}

}  // namespace cerberus::bench
