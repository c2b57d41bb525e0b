// SPDX-License-Identifier: LGPL-2.1-or-later
#include "fusion/rule_check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "sensing/angles.h"
#include "text/numbers.h"

namespace cerberus::fusion {

namespace {

using Kind = RuleProblem::Kind;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A piece of the pan axis on which no band begins or ends: one edge, or what lies between two of them.
struct Piece {
  double from, to;
  bool from_included, to_included;
  double sample;  // any pan angle of it
};

std::vector<Piece> pieces(const RuleTable& table) {
  std::vector<double> edges;
  for (const Rule& rule : table.rules)
    for (const Band& band : rule.bands)
      for (const double edge : {band.lower, band.upper})
        if (std::isfinite(edge)) edges.push_back(edge);
  std::ranges::sort(edges);
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  if (edges.empty()) return {{-kInfinity, kInfinity, false, false, 0}};
  std::vector<Piece> result{{-kInfinity, edges.front(), false, false, edges.front() - 1}};
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const double edge = edges[i];
    result.push_back({edge, edge, true, true, edge});
    const bool last = i + 1 == edges.size();
    const double next = last ? kInfinity : edges[i + 1];
    result.push_back({edge, next, false, false, last ? edge + 1 : edge + (next - edge) / 2});
  }
  return result;
}

std::string angle(double radians) {
  return text::rounded(sensing::degrees(radians), 6).string();
}

std::string pan_text(const Piece& piece) {
  const bool below = std::isinf(piece.from), above = std::isinf(piece.to);
  if (below && above) return "any pan angle";
  if (piece.from == piece.to) return "pan at " + angle(piece.from) + " degrees";
  std::string text = "pan";
  if (!below) text += (piece.from_included ? " from " : " above ") + angle(piece.from);
  if (!above) text += (piece.to_included ? " up to " : " below ") + angle(piece.to);
  return text + " degrees";
}

std::string span_text(const Band& band) {
  return pan_text({band.lower, band.upper, band.lower_included, band.upper_included, 0});
}

std::string sensor_text(SensorBits fired) {
  std::string text;
  for (int i = 0; i < kMaxSensors; ++i) {
    if (!(fired >> i & 1)) continue;
    fired = static_cast<SensorBits>(fired & ~(1U << i));
    if (!text.empty()) text += fired != 0 ? ", " : " and ";
    text += "infer" + std::to_string(i + 1);
  }
  return text.empty() ? "no sensor fired" : text + " fired";
}

std::string answer(const Band& band) {
  std::string text{name(band.action)};
  if (band.action == Action::search)
    text += " (" + angle(band.search.from) + " to " + angle(band.search.to) + " degrees)";
  return text;
}

bool same_answer(const Band& a, const Band& b) {
  if (a.action != b.action) return false;
  return a.action != Action::search || (a.search.from == b.search.from && a.search.to == b.search.to);
}

class Checker {
 public:
  Checker(const RuleTable& table, int most) : table_(table), most_(most), pieces_(pieces(table)) {}

  std::vector<RuleProblem> run() {
    check_form();
    if (!problems_.empty()) return problems_;
    if (table_.precedence == Precedence::exact)
      for (const Rule& rule : table_.rules) check_bands(rule);
    SensorBits named = 0;  // the others make no difference
    for (const Rule& rule : table_.rules) named |= rule.all | rule.any | rule.none;
    SensorBits fired = 0;
    do {
      for (const bool camera_found : {false, true}) check_case(camera_found, fired);
      fired = static_cast<SensorBits>((fired - named) & named);  // the next subset of `named`
    } while (fired != 0 && !full());
    if (problems_.empty()) check_use();
    return problems_;
  }

 private:
  bool full() const { return most_ > 0 && static_cast<int>(problems_.size()) >= most_; }
  void report(Kind kind, std::string text) {
    if (!full()) problems_.push_back({kind, std::move(text)});
  }

  void check_form() {
    if (table_.sensors < 1 || table_.sensors > kMaxSensors)
      return report(Kind::malformed, "the number of sensors is not 1 to " + std::to_string(kMaxSensors));
    const auto known = static_cast<SensorBits>((1U << table_.sensors) - 1);
    for (const Rule& rule : table_.rules) {
      const auto bad = [&](const std::string& text) { report(Kind::malformed, rule.name + ": " + text); };
      const auto named = static_cast<SensorBits>(rule.all | rule.any | rule.none);
      if ((named & ~known) != 0)
        bad("names a sensor beyond the " + std::to_string(table_.sensors) + " there are");
      if ((rule.all & rule.none) != 0 || (rule.any != 0 && (rule.any & ~rule.none) == 0))
        bad("asks a sensor to detect and not to detect");
      if (rule.bands.empty()) bad("has no action");
      for (const Band& band : rule.bands) check_band_form(band, bad);
    }
  }

  template <typename Bad>
  void check_band_form(const Band& band, const Bad& bad) {
    const bool point = band.lower == band.upper && band.lower_included && band.upper_included;
    if (!(band.lower < band.upper || point) || band.lower == kInfinity || band.upper == -kInfinity)
      bad("a band holds no pan angle (" + angle(band.lower) + " to " + angle(band.upper) + " degrees)");
    if (band.action != Action::search) return;
    const sensing::Interval& sweep = band.search;
    if (!std::isfinite(sweep.from) || !std::isfinite(sweep.to) || sweep.from > sweep.to)
      bad("a search needs two pan angles to sweep between, the lower one first");
  }

  // Limited bands of one rule must agree where they overlap; a band without limits is the rest.
  void check_bands(const Rule& rule) {
    for (std::size_t i = 0; i < rule.bands.size(); ++i)
      for (std::size_t j = i + 1; j < rule.bands.size(); ++j) {
        const Band &a = rule.bands[i], &b = rule.bands[j];
        if ((a.unlimited() != b.unlimited()) || same_answer(a, b)) continue;
        for_each_run(
            [&](const Piece& piece) { return a.holds(piece.sample) && b.holds(piece.sample) ? 1 : 0; },
            [&](const Piece& run, int) {
              report(Kind::contradiction, rule.name + ", " + pan_text(run) + ": one band says " + answer(a) +
                                              ", another says " + answer(b));
            });
      }
  }

  // After every case was looked at.
  void check_use() {
    const auto decides = [this](const Band& band) { return used_.contains(&band); };
    for (const Rule& rule : table_.rules) {
      if (std::ranges::none_of(rule.bands, decides)) {
        report(Kind::idle, rule.name + " never applies: the rules before it decide in every case");
        continue;
      }
      for (const Band& band : rule.bands)
        if (!decides(band))
          report(Kind::idle, rule.name + ": the band that says " + answer(band) + " " + span_text(band) +
                                 " never applies: what stands before it decides in every case");
    }
  }

  void check_case(bool camera_found, SensorBits fired) {
    std::vector<const Rule*> matching;
    for (const Rule& rule : table_.rules)
      if (rule.matches(camera_found, fired)) matching.push_back(&rule);

    // What is wrong with a piece: 0 nothing, 1 no rule, else 2 + (a * rules + b): these two rules disagree.
    const auto count = static_cast<int>(matching.size());
    const auto verdict = [&](const Piece& piece) {
      int first = -1;
      for (int i = 0; i < count; ++i) {
        const Band* band = matching[static_cast<unsigned>(i)]->band(piece.sample);
        if (band == nullptr) continue;
        used_.insert(band);
        if (first < 0) {
          first = i;
          if (table_.precedence == Precedence::order) return 0;
        } else if (!same_answer(*matching[static_cast<unsigned>(first)]->band(piece.sample), *band)) {
          return 2 + first * count + i;
        }
      }
      return first < 0 ? 1 : 0;
    };
    for_each_run(verdict, [&](const Piece& run, int what) {
      std::string text = camera_found ? "camera found, " : "camera not found, ";
      text += sensor_text(fired) + ", " + pan_text(run) + ": ";
      if (what == 1) return report(Kind::open, text + "no rule applies");
      const Rule& a = *matching[static_cast<unsigned>((what - 2) / count)];
      const Rule& b = *matching[static_cast<unsigned>((what - 2) % count)];
      report(Kind::contradiction, text + a.name + " says " + answer(*a.band(run.sample)) + ", " + b.name +
                                      " says " + answer(*b.band(run.sample)));
    });
  }

  // Joins neighbouring pieces of the same verdict and tells those that are not 0.
  template <typename Verdict, typename Tell>
  void for_each_run(const Verdict& verdict, const Tell& tell) {
    Piece run = pieces_.front();
    int what = verdict(run);
    for (std::size_t i = 1; i < pieces_.size(); ++i) {
      const int next = verdict(pieces_[i]);
      if (next == what) {
        run.to = pieces_[i].to;
        run.to_included = pieces_[i].to_included;
        continue;
      }
      if (what != 0) tell(run, what);
      run = pieces_[i];
      what = next;
    }
    if (what != 0) tell(run, what);
  }

  const RuleTable& table_;
  int most_;
  std::vector<Piece> pieces_;
  std::vector<RuleProblem> problems_;
  std::set<const Band*> used_;  // those that decide something
};

}  // namespace

std::vector<RuleProblem> check(const RuleTable& table, int most) {
  return Checker(table, most).run();
}

std::vector<std::string> out_of_reach(const RuleTable& table, const sensing::Interval& limits) {
  const std::string ends = angle(limits.from) + " to " + angle(limits.to) + " degrees";
  std::vector<std::string> found;
  for (const Rule& rule : table.rules)
    for (const Band& band : rule.bands) {
      const sensing::Interval& sweep = band.search;
      if (!band.holds(limits.from) && !band.holds(limits.to) &&
          (band.lower >= limits.to || band.upper <= limits.from))
        found.push_back(rule.name + ", " + span_text(band) + ": the head turns from " + ends +
                        " only, so that never applies");
      else if (band.action == Action::search && (sweep.from > limits.to || sweep.to < limits.from))
        found.push_back(rule.name + ": the sweep from " + angle(sweep.from) + " to " + angle(sweep.to) +
                        " degrees lies beyond the head's limits, " + ends);
    }
  return found;
}

}  // namespace cerberus::fusion
