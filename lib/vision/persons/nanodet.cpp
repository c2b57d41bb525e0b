// SPDX-License-Identifier: LGPL-2.1-or-later
#include "vision/persons/nanodet.h"

#include <algorithm>
#include <cmath>

namespace cerberus::vision {

namespace {

constexpr int kBoxSides = 4;
// Distances of 0 to 7 cells: reg_max of every published NanoDet-Plus. The pairs of NanoDet show theirs by their width.
constexpr int kPlusBins = 8;
constexpr std::array<std::array<int, 4>, 2> kStrides{{{8, 16, 32, 64}, {8, 16, 32, 0}}};

bool are_scores(const NetworkTable& table, int first, int end) {
  for (int i = 0; i < table.boxes; ++i)
    for (int n = first; n < end; ++n)
      if (!is_score(table.at(i, n))) return false;
  return true;
}

// Refuses in `wrong`.
bool choose_person(NanodetLayout& layout, int classes, const PersonClass& person, std::string& wrong) {
  layout.person = std::max(person.number, 0);
  if (person.classes <= classes && layout.person < classes) return true;
  wrong =
      "it has " + std::to_string(classes) + " classes, and the labels name " + std::to_string(person.classes);
  return false;
}

std::optional<NanodetLayout> find_plus(const NetworkOutput& output, Size input, const PersonClass& person,
                                       std::string& wrong) {
  for (const auto& sides : kStrides)
    for (const bool by_box : {true, false}) {
      const auto table = table_of_boxes(output, count_cells(input, sides), by_box);
      const int classes = table ? table->numbers - kBoxSides * kPlusBins : 0;
      // Logarithms of the distributions are beyond 0 to 1, which scores of further classes are not.
      if (classes < 1 || !are_scores(*table, 0, classes) || are_scores(*table, classes, table->numbers))
        continue;
      NanodetLayout layout;
      layout.parts.push_back({.numbers = table->numbers,
                              .distance_numbers = table->numbers,
                              .by_box = by_box,
                              .first_distance = classes,
                              .bins = kPlusBins,
                              .sides = sides,
                              .from_middle = false});
      return choose_person(layout, classes, person, wrong) ? std::optional(layout) : std::nullopt;
    }
  return std::nullopt;
}

// The outputs with so many cells.
std::vector<int> outputs_of(std::span<const NetworkOutput> outputs, int cells) {
  std::vector<int> found;
  for (std::size_t i = 0; i < outputs.size(); ++i)
    if (table_of_boxes(outputs[i], cells, true)) found.push_back(static_cast<int>(i));
  return found;
}

std::optional<NanodetLayout> find_pairs(std::span<const NetworkOutput> outputs, Size input,
                                        const PersonClass& person, std::string& wrong) {
  const auto levels = static_cast<std::size_t>(outputs.size() / 2);
  if (outputs.size() % 2 != 0 || (levels != 3 && levels != 4)) return std::nullopt;
  NanodetLayout layout;
  for (std::size_t level = 0; level < levels; ++level) {
    const std::array<int, 4> sides{kStrides[0][level], 0, 0, 0};
    const int cells = count_cells(input, sides);
    const std::vector<int> pair = outputs_of(outputs, cells);
    if (pair.size() != 2) return std::nullopt;
    const auto table = [&](int n) {
      return *table_of_boxes(outputs[static_cast<std::size_t>(n)], cells, true);
    };
    const bool first = are_scores(table(pair[0]), 0, table(pair[0]).numbers);
    if (first == are_scores(table(pair[1]), 0, table(pair[1]).numbers)) {
      wrong = "scores are no probabilities: export it with the sigmoid of its scores";
      return std::nullopt;
    }
    const int scores = first ? pair[0] : pair[1], distances = first ? pair[1] : pair[0];
    const int numbers = table(distances).numbers;
    if (numbers % kBoxSides != 0 || numbers < 2 * kBoxSides) return std::nullopt;
    layout.parts.push_back({.scores_output = scores,
                            .distances_output = distances,
                            .numbers = table(scores).numbers,
                            .distance_numbers = numbers,
                            .bins = numbers / kBoxSides,
                            .sides = sides});
  }
  return choose_person(layout, layout.parts[0].numbers, person, wrong) ? std::optional(layout) : std::nullopt;
}

// The mean of a side's distribution: sum of n exp(x_n) over sum of exp(x_n), in cells.
double mean_distance(const NetworkTable& table, int i, int first, int bins) {
  double largest = table.at(i, first), sum = 0, weighted = 0;
  for (int n = 1; n < bins; ++n) largest = std::max(largest, table.at(i, first + n));
  for (int n = 0; n < bins; ++n) {
    const double share = std::exp(table.at(i, first + n) - largest);
    sum += share, weighted += n * share;
  }
  return weighted / sum;
}

}  // namespace

std::optional<NanodetLayout> find_nanodet(std::span<const NetworkOutput> outputs, Size input,
                                          const PersonClass& person, std::string& wrong) {
  return outputs.size() == 1 ? find_plus(outputs[0], input, person, wrong)
                             : find_pairs(outputs, input, person, wrong);
}

std::string read_nanodet(const NanodetLayout& layout, std::span<const NetworkOutput> outputs, Size input,
                         double threshold, std::vector<PersonDetection>& hits) {
  const auto count = static_cast<int>(outputs.size());
  for (const NanodetLayout::Part& part : layout.parts) {
    if (part.scores_output >= count || part.distances_output >= count) return "there are fewer than before";
    const auto scores =
        table_of(outputs[static_cast<std::size_t>(part.scores_output)], part.numbers, part.by_box);
    const auto distances = table_of(outputs[static_cast<std::size_t>(part.distances_output)],
                                    part.distance_numbers, part.by_box);
    const int cells = count_cells(input, part.sides);
    if (!scores || !distances || scores->boxes != cells || distances->boxes != cells)
      return "the shape was another one before";
    for (int i = 0; i < cells; ++i) {
      const double score = scores->at(i, layout.person);
      if (!is_score(score)) return "scores are no probabilities: export it with the sigmoid of its scores";
      if (!(score >= threshold)) continue;
      const NetworkCell cell = cell_at(input, part.sides, i);
      std::array<double, kBoxSides> away{};  // left, top, right, bottom
      for (int n = 0; n < kBoxSides; ++n)
        away[static_cast<std::size_t>(n)] =
            cell.side * mean_distance(*distances, i, part.first_distance + n * part.bins, part.bins);
      const double within = part.from_middle ? cell.side / 2.0 : 0;
      const Box box{cell.column * cell.side + within - away[0], cell.row * cell.side + within - away[1],
                    away[0] + away[2], away[1] + away[3]};
      if (!(box.width > 0) || !(box.height > 0)) continue;
      hits.push_back({box, std::min(score, 1.0)});
    }
  }
  return {};
}

}  // namespace cerberus::vision
