// SPDX-License-Identifier: LGPL-2.1-or-later
#include "heads_zoom.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "project_law.h"

namespace cerberus::bench {

namespace {

struct ZoomFigures {
  double right =
      0;           // percent of the time in which the person is not hidden: a third of the height, within 1.5
  double out = 0;  // percent of the same: out of the picture
  double blind = 0;      // percent: by how much the zoom went while the person was hidden, at most
  double reversals = 0;  // of the zoom, a minute
  double off = 0;        // RMS of the person from the middle, percent of the picture's width
};

// Looks at the lens each millisecond, in place of the law.
class Watched final : public FollowingLaw {
 public:
  static constexpr double kBegin = 15;  // seconds: what comes before is not judged
  static constexpr double kAfter =
      .5;  // seconds after the person was hidden: the law still has pictures of it
  static constexpr double kAgain = 1.5;  // seconds until it was found again
  Watched(FollowingLaw& law, const sim::Scene& scene, const sim::PanHead& head, sim::ZoomLens& lens)
      : law_(law), scene_(scene), head_(head), lens_(lens) {}

  void on_picture(const Seen& seen, Time now) override { law_.on_picture(seen, now); }
  double look(Time time) override { return law_.look(time); }
  void elapse(Time now) override {
    law_.elapse(now);
    const double t = motion::seconds(now), view = lens_.field_of_view(), size = std::log(std::tan(view / 2));
    const bool hidden = scene_.hidden(t);
    if (hidden) {
      hidden_since_ = hidden_since_ < 0 ? t : hidden_since_;
      if (t - hidden_since_ < kAfter) blind_from_ = size;
      blind_ = std::max(blind_, std::abs(size - blind_from_));
      seen_since_ = -1;
      return;
    }
    hidden_since_ = -1;
    seen_since_ = seen_since_ < 0 ? t : seen_since_;
    if (t < kBegin || t - seen_since_ < kAgain) return;
    count_reversals(size);
    ++count_;
    const double off = scene_.person(t) - head_.camera();
    constexpr double kPerson = 1.7, kPicture = 9. / 16, kThird = 1. / 3, kWithin = 1.5;
    const double height = kPerson / scene_.distance(t) / (2 * std::tan(view / 2) * kPicture);
    right_ += height > kThird / kWithin && height < kThird * kWithin;
    out_ += std::abs(off) > view / 2;
    const double place = std::tan(off) / (2 * std::tan(view / 2));
    squares_ += place * place;
  }
  ZoomFigures figures() const {
    constexpr double kPercent = 100;
    const double all = static_cast<double>(count_);
    return {kPercent * static_cast<double>(right_) / all, kPercent * static_cast<double>(out_) / all,
            kPercent * blind_, static_cast<double>(reversals_) * 60 / (scene_.length - kBegin),
            kPercent * std::sqrt(squares_ / all)};
  }

 private:
  void count_reversals(double size) {
    constexpr double kLeast = .02;  // a step is .023
    if (extreme_ == 0 || (size - extreme_) * direction_ > 0) {
      extreme_ = size;
      return;
    }
    if (std::abs(size - extreme_) < kLeast) return;
    reversals_ += direction_ != 0;
    direction_ = size > extreme_ ? 1 : -1;
    extreme_ = size;
  }

  FollowingLaw& law_;
  const sim::Scene& scene_;
  const sim::PanHead& head_;
  sim::ZoomLens& lens_;
  long count_ = 0, right_ = 0, out_ = 0, reversals_ = 0;
  double squares_ = 0, blind_ = 0, blind_from_ = 0, extreme_ = 0;
  double hidden_since_ = -1, seen_since_ = -1;
  int direction_ = 0;
};

ZoomFigures follow(char letter, bool keeps, unsigned seed) {
  const auto draw = [seed](unsigned n) { return 104729 * (4 * seed + n); };
  const sim::HeadKind kind = sim::head_kind(letter, draw(0));
  const sim::Scene scene = sim::scene("zoom", draw(1));
  sim::PanHead head(kind.traits, draw(2));
  sim::ZoomLens lens({});
  ProjectLaw law(kind, head, {}, keeps ? &lens : nullptr);
  Watched watched(law, scene, head, lens);
  run(watched, head, scene, {}, draw(3), &lens);
  return watched.figures();
}

ZoomFigures medians(char letter, bool keeps, int seeds) {
  std::vector<ZoomFigures> all;
  for (int seed = 1; seed <= seeds; ++seed) all.push_back(follow(letter, keeps, static_cast<unsigned>(seed)));
  const auto middle = [&](double ZoomFigures::* figure) {
    std::ranges::sort(all, {}, figure);
    return all[all.size() / 2].*figure;
  };
  return {middle(&ZoomFigures::right), middle(&ZoomFigures::out), middle(&ZoomFigures::blind),
          middle(&ZoomFigures::reversals), middle(&ZoomFigures::off)};
}

}  // namespace

void print_zoom(Asked& asked, int seeds) {
  std::printf(
      "\nkeep-size: a person who comes from 25 m to 7 m and goes back, hidden for 3 s of each 15; %d seeds\n"
      "head keep-size  a third within 1.5, %%  out, %%  zoom while hidden, %%  reversals  off the middle, "
      "%%\n",
      seeds);
  for (const char letter : std::string("ABC"))
    for (const bool keeps : {false, true}) {
      const ZoomFigures f = medians(letter, keeps, seeds);
      const std::string head(1, letter);
      std::string words;
      if (keeps)
        words = asked.at_least(head + ", zoom, a third within 1.5", f.right, 85) +
                asked.at_most(head + ", zoom, out of the picture", f.out, 1) +
                asked.at_most(head + ", zoom while hidden", f.blind, 3) +
                asked.at_most(head + ", reversals of the zoom", f.reversals, 6);
      std::printf("%4c %-9s %21.1f %7.1f %20.1f %10.1f %18.1f%s\n", letter, keeps ? "yes" : "no", f.right,
                  f.out, f.blind, f.reversals, f.off, words.c_str());
      std::fflush(stdout);
    }
}

}  // namespace cerberus::bench
