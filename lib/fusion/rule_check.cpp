// SPDX-License-Identifier: LGPL-2.1-or-later
#include "fusion/rule_check.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "sensing/angles.h"
#include "text/numbers.h"

namespace cerberus::fusion {

namespace {

using Kind = RuleProblem::Kind;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A piece of the pan axis on which no band begins or ends: one edge, or the interval between two edges.
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

// A band, the number of its answer (the same for all bands with the same action), and whether it decides any case.
struct Entry {
  const Band* band;
  int answer;
  bool used = false;
};

class Checker {
 public:
  Checker(const RuleTable& table, int most) : table_(table), most_(most), pieces_(pieces(table)) {}

  std::vector<RuleProblem> run() {
    check_form();
    if (problems_.empty()) check_size();
    if (!problems_.empty()) return problems_;
    look_up();
    if (table_.precedence == Precedence::exact)
      for (const Rule& rule : table_.rules) check_bands(rule);
    SensorBits fired = 0;
    do {
      for (const bool camera_found : {false, true}) check_case(camera_found, fired);
      fired = static_cast<SensorBits>((fired - named_) & named_);  // the next subset
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

  // Refuses tables whose enumeration would take too long.
  void check_size() {
    constexpr double kMostSteps = 2e9, kMostPlaces = 4e6;  // some seconds, some megabytes
    for (const Rule& rule : table_.rules) named_ |= rule.all | rule.any | rule.none;
    const auto pieces = static_cast<double>(pieces_.size());
    const double places = pieces * static_cast<double>(table_.rules.size());
    double steps = places * 2 * std::exp2(std::popcount(named_));
    for (const Rule& rule : table_.rules) {
      const auto bands = static_cast<double>(rule.bands.size());
      steps += pieces * bands * (table_.precedence == Precedence::exact ? bands : 1);
    }
    if (places <= kMostPlaces && steps <= kMostSteps) return;
    report(Kind::malformed, "the table is too large to be checked: " + std::to_string(table_.rules.size()) +
                                " rules that name " + std::to_string(std::popcount(named_)) +
                                " sensors, with " + std::to_string(pieces_.size() / 2) + " edges of bands");
  }

  // Finds the band of each rule in each piece, and numbers the different answers.
  void look_up() {
    for (const Rule& rule : table_.rules)
      for (const Band& band : rule.bands) {
        const auto same = [&](const Entry& entry) { return same_answer(*entry.band, band); };
        const auto known = std::ranges::find_if(entries_, same);
        const int answer = known != entries_.end() ? known->answer : static_cast<int>(entries_.size());
        entries_.push_back({&band, answer});
      }
    for (std::size_t first = 0; const Rule& rule : table_.rules) {
      for (const Piece& piece : pieces_) {
        const Band* band = rule.band(piece.sample);
        places_.push_back(band ? static_cast<int>(first + static_cast<std::size_t>(band - rule.bands.data()))
                               : -1);
      }
      first += rule.bands.size();
    }
  }

  // Returns the entry of a rule, given by its number in the table, in a piece; nullptr if no band of it holds there.
  Entry* entry(int rule, std::size_t piece) {
    const int place = places_[static_cast<std::size_t>(rule) * pieces_.size() + piece];
    return place < 0 ? nullptr : &entries_[static_cast<std::size_t>(place)];
  }

  // Limited bands of one rule must agree where they overlap; a band without limits covers the rest.
  void check_bands(const Rule& rule) {
    for (std::size_t i = 0; i < rule.bands.size(); ++i)
      for (std::size_t j = i + 1; j < rule.bands.size(); ++j) {
        const Band &a = rule.bands[i], &b = rule.bands[j];
        if ((a.unlimited() != b.unlimited()) || same_answer(a, b)) continue;
        for_each_run(
            [&](std::size_t piece) {
              return a.holds(pieces_[piece].sample) && b.holds(pieces_[piece].sample) ? 1 : 0;
            },
            [&](const Piece& run, int) {
              report(Kind::contradiction, rule.name + ", " + pan_text(run) + ": one band says " + answer(a) +
                                              ", another says " + answer(b));
            });
      }
  }

  // Finds unused rules and bands; called after all cases were checked.
  void check_use() {
    for (auto of_rule = entries_.begin(); const Rule& rule : table_.rules) {
      const std::span bands(std::exchange(of_rule, of_rule + static_cast<std::ptrdiff_t>(rule.bands.size())),
                            rule.bands.size());
      if (std::ranges::none_of(bands, &Entry::used)) {
        report(Kind::idle, rule.name + " never applies: the rules before it decide in every case");
        continue;
      }
      for (const Entry& each : bands)
        if (!each.used)
          report(Kind::idle, rule.name + ": the band that says " + answer(*each.band) + " " +
                                 span_text(*each.band) +
                                 " never applies: what stands before it decides in every case");
    }
  }

  void check_case(bool camera_found, SensorBits fired) {
    matching_.clear();
    const auto count = static_cast<int>(table_.rules.size());
    for (int i = 0; i < count; ++i)
      if (table_.rules[static_cast<unsigned>(i)].matches(camera_found, fired)) matching_.push_back(i);

    // Returns the problem of a piece: 0 none, 1 no rule, else 2 + (a * rules + b): rules a and b disagree.
    const auto verdict = [&](std::size_t piece) {
      int first = -1, said = -1;
      for (const int i : matching_) {
        Entry* band = entry(i, piece);
        if (band == nullptr) continue;
        band->used = true;
        if (first >= 0 && band->answer != said) return 2 + first * count + i;
        if (first >= 0) continue;
        if (table_.precedence == Precedence::order) return 0;
        first = i;
        said = band->answer;
      }
      return first < 0 ? 1 : 0;
    };
    for_each_run(verdict, [&](const Piece& run, int what) {
      std::string text = camera_found ? "camera found, " : "camera not found, ";
      text += sensor_text(fired) + ", " + pan_text(run) + ": ";
      if (what == 1) return report(Kind::open, text + "no rule applies");
      const Rule& a = table_.rules[static_cast<unsigned>((what - 2) / count)];
      const Rule& b = table_.rules[static_cast<unsigned>((what - 2) % count)];
      report(Kind::contradiction, text + a.name + " says " + answer(*a.band(run.sample)) + ", " + b.name +
                                      " says " + answer(*b.band(run.sample)));
    });
  }

  // Joins neighbouring pieces with the same verdict and calls take(joined piece, verdict) for each verdict except 0.
  template <typename Verdict, typename Take>
  void for_each_run(const Verdict& verdict, const Take& take) {
    Piece run = pieces_.front();
    int what = verdict(0);
    for (std::size_t i = 1; i < pieces_.size(); ++i) {
      const int next = verdict(i);
      if (next == what) {
        run.to = pieces_[i].to;
        run.to_included = pieces_[i].to_included;
        continue;
      }
      if (what != 0) take(run, what);
      run = pieces_[i];
      what = next;
    }
    if (what != 0) take(run, what);
  }

  const RuleTable& table_;
  int most_;
  std::vector<Piece> pieces_;
  std::vector<RuleProblem> problems_;
  SensorBits named_ = 0;        // sensors that some rule names; the others make no difference
  std::vector<Entry> entries_;  // of all rules, in order
  std::vector<int> places_;     // in entries_, by rule and piece; -1: none
  std::vector<int> matching_;
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
