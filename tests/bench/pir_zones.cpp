// SPDX-License-Identifier: LGPL-2.1-or-later
// The simulated PIR sensor beside the paper's SK-11: its Table 1 as a table, its Figure 1 as a picture. A person of .48 m
// walks on a circle around the sensor; the sensor is asked whether it detects.
//
//   bench-pir_zones            the table, judged
//   bench-pir_zones FILE       and the picture, SVG
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "sim/pir_sensor.h"

using namespace cerberus;
using std::chrono::milliseconds;

namespace {

constexpr double kField = 120, kRange = 12;  // degrees, metres: of Table 1
constexpr auto kStep = milliseconds(10);

const sim::PirTraits& traits() {
  static const sim::PirTraits all = [] {
    const auto presets = sensing::pir_presets();
    const auto module = std::ranges::find(presets, std::string_view("sk-11"), &sensing::PirPreset::name);
    return sim::pir_traits(&*module, sensing::radians(kField), kRange);
  }();
  return all;
}

struct Walk {
  double from, to;  // degrees
  double metres, speed;
  double low = 0;  // metres above the floor: its lower end
};

// The bearing at which the sensor first detects, degrees.
std::optional<double> first_detection(const Walk& walk) {
  sim::PirSensor sensor(traits(), 0);
  const double rate = sensing::degrees(walk.speed / walk.metres) * (walk.to > walk.from ? 1 : -1);
  const double lasts = (walk.to - walk.from) / rate;
  for (sim::Time now{}; motion::seconds(now) < lasts + traits().response; now += kStep) {
    const double bearing = walk.from + rate * std::min(motion::seconds(now), lasts);
    const sim::Warmth person{sensing::radians(bearing), 2 * std::atan(sim::kPersonWidth / 2 / walk.metres),
                             sim::kPersonContrast, walk.metres, walk.low};
    sensor.elapse(now, std::span(&person, 1));
    if (sensor.output()) return walk.from + rate * std::max(0., motion::seconds(now) - traits().response);
  }
  return std::nullopt;
}

// The distances, metres, at which somebody who passes a bearing is detected.
struct Reach {
  double least = 0, most = 0;
};
Reach reach(double bearing, double speed, double low = 0) {
  const double half = kField / traits().zones / 2 + .5;  // degrees: a border of two segments is passed
  Reach found;
  for (int step = 1; step <= 280; ++step) {  // .05 m, to 14 m
    const double metres = .05 * step;
    if (!first_detection({bearing - half, bearing + half, metres, speed, low})) continue;
    if (found.most == 0) found.least = metres;
    found.most = metres;
  }
  return found;
}

constexpr std::array kSpeeds{.1, .5, 1., 4.};
constexpr std::array kColors{"#0072b2", "#009e73", "#d55e00", "#cc79a7"};

class Svg {
 public:
  explicit Svg(const std::string& path) : file_(path) {
    file_ << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 860 420\" font-family=\"sans-serif\" "
             "font-size=\"14\">\n<rect width=\"860\" height=\"420\" fill=\"white\"/>\n";
  }
  ~Svg() { file_ << "</svg>\n"; }
  void text(double x, double y, const std::string& words, const char* color = "black") {
    file_ << "<text x=\"" << x << "\" y=\"" << y << "\" fill=\"" << color << "\">" << words << "</text>\n";
  }
  void line(const std::vector<std::array<double, 2>>& points, const std::string& style) {
    file_ << "<polyline fill=\"none\" " << style << " points=\"";
    for (const auto& [x, y] : points)
      file_ << std::lround(10 * x) / 10. << ',' << std::lround(10 * y) / 10. << ' ';
    file_ << "\"/>\n";
  }

 private:
  std::ofstream file_;
};

const std::string kPaper = "stroke=\"black\" stroke-width=\"1.5\" stroke-dasharray=\"6 4\"";

std::string words(double value) {
  std::array<char, 16> text{};
  std::snprintf(text.data(), text.size(), "%g", value);
  return text.data();
}

std::string stroke(std::size_t speed) {
  // Of two lines in one place both are seen.
  return "stroke-width=\"" + words(2 * static_cast<double>(speed) + 2) + "\" stroke=\"" + kColors[speed] +
         '"';
}

// From above: the sensor looks up. Sectors of the distances at which people of each speed are detected.
void draw_from_above(Svg& svg) {
  constexpr double kX = 250, kY = 350, kMetre = 22;
  const auto at = [](double bearing, double metres) {
    return std::array{kX + kMetre * metres * std::sin(sensing::radians(bearing)),
                      kY - kMetre * metres * std::cos(sensing::radians(bearing))};
  };
  const auto arc = [&](double metres) {
    std::vector<std::array<double, 2>> points;
    for (double bearing = -kField / 2; bearing <= kField / 2; bearing += 2)
      points.push_back(at(bearing, metres));
    return points;
  };
  svg.text(20, 24, "from above");
  for (std::size_t i = kSpeeds.size(); i-- > 0;) {
    std::vector<std::array<double, 2>> points;
    for (double bearing = -56; bearing <= 56; bearing += 2)
      points.push_back(at(bearing, reach(bearing, kSpeeds[i]).most));
    svg.line(points, stroke(i));
    svg.text(20, 330 + 18 * static_cast<double>(i), words(kSpeeds[i]) + " m/s", kColors[i]);
  }
  std::vector<std::array<double, 2>> sector = arc(kRange);
  sector.insert(sector.begin(), at(0, 0));
  sector.push_back(at(0, 0));
  svg.line(sector, kPaper);
  for (const double metres : {3., 6., 9., 12.})
    svg.text(kX + 4, kY - kMetre * metres + 16, words(metres) + " m", "#777");
}

// From the side: what begins at a height is detected up to a distance, at 1 m/s.
void draw_from_the_side(Svg& svg) {
  constexpr double kX = 520, kY = 350, kMetre = 24, kUp = 60;
  const auto at = [](double metres, double height) {
    return std::array{kX + kMetre * metres, kY - kUp * height};
  };
  svg.text(520, 24, "from the side, 1 m/s");
  std::vector<std::array<double, 2>> points{at(0, 0)};
  for (int step = 0; step <= 27; ++step) {
    const double low = .1 * step;
    const double most = reach(0, 1, low).most;
    if (most == 0) break;
    points.push_back(at(most, low));
    points.push_back(at(most, low + .1));
  }
  points.push_back(at(0, (kY - points.back()[1]) / kUp));
  svg.line(points, stroke(2));
  svg.line({at(0, 2.5), at(3, 2.5), at(3, 1.5), at(12, 1.5), at(12, 0), at(0, 0)}, kPaper);
  svg.text(kX + 10, kY - 2.6 * kUp, "C: 3 m, below 2.5 m");
  svg.text(kX + 110, kY - 1.6 * kUp, "A: 12 m, below 1.5 m");
  svg.text(kX, kY + 20, "0");
  svg.text(kX + kMetre * kRange - 10, kY + 20, "12 m");
  svg.text(520, 400, "dashed: the paper; lines: simulated");
}

bool row(const char* what, const char* paper, const std::string& simulated, bool good) {
  std::printf("%-44s %-16s %s%s\n", what, paper, simulated.c_str(), good ? "" : "   missed");
  return good;
}

}  // namespace

int main(int argc, char** argv) {
  const double left = first_detection({-100, 100, 6, 1}).value_or(0),
               right = first_detection({100, -100, 6, 1}).value_or(0);
  const Reach usual = reach(0, 1), high = reach(0, 1, 2.4), above = reach(0, 1, 2.6), slow = reach(0, .1),
              fast = reach(0, 4);
  bool good = true;
  std::printf("%-44s %-16s %s\n", "", "paper, SK-11", "simulated, sk-11");
  good &= row("angle", "120 degrees", words(std::round(right - left)) + " degrees",
              std::abs(right - left - 120) <= 4);
  good &= row("how far, 1 m/s, lower than 1.5 m", "12 m", words(usual.most) + " m",
              std::abs(usual.most - 12) <= .1);
  good &= row("how far, between 1.5 and 2.5 m high", "3 m", words(high.most) + " m",
              std::abs(high.most - 3) <= .1);
  good &= row("above 2.5 m", "not", above.most > 0 ? "yes" : "not", above.most == 0);
  good &= row("slowest person, .1 m/s", "is detected", "up to " + words(slow.most) + " m", slow.most > 3);
  good &= row("fastest person, 4 m/s", "is detected",
              "from " + words(fast.least) + " to " + words(fast.most) + " m", fast.most > 11);
  if (argc > 1) {
    Svg svg(argv[1]);
    draw_from_above(svg);
    draw_from_the_side(svg);
  }
  return good ? 0 : 1;
}
