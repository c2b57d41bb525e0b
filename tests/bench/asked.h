// SPDX-License-Identifier: LGPL-2.1-or-later
// The value that a figure must reach is given beside it, and judged at the end.
#pragma once

#include <cstdio>
#include <string>
#include <vector>

namespace cerberus::bench {

// No property set.
inline constexpr char kJudged[] = "motiondetect";

class Asked {
 public:
  // The text after the figure. `promised` false: the value is a goal that is known to be missed; printed so, and no
  // failure.
  std::string at_least(const std::string& what, double figure, double least, bool promised = true) {
    return judge(what, figure, figure >= least, "at least " + text(least), promised);
  }
  std::string at_most(const std::string& what, double figure, double most, bool promised = true) {
    return judge(what, figure, figure <= most, "at most " + text(most), promised);
  }
  // Names what is missed. The program's exit status.
  int verdict() const {
    for (const std::string& m : missed_) std::printf("missed: %s\n", m.c_str());
    if (!asked_) std::printf("missed: everything, as nothing was measured\n");
    return asked_ && missed_.empty() ? 0 : 1;
  }

 private:
  static std::string text(double value) {
    char out[40];
    std::snprintf(out, sizeof out, "%.3g", value);
    return out;
  }
  // What is no number reaches nothing.
  std::string judge(const std::string& what, double figure, bool reached, const std::string& asked,
                    bool promised) {
    asked_ = asked_ || promised;
    if (!reached && promised) missed_.push_back(what + " is " + text(figure) + ", asked: " + asked);
    const char* verdict = promised  ? (reached ? "" : ", MISSED")
                          : reached ? ", reached now"
                                    : ", not reached yet";
    return "   asked: " + asked + verdict;
  }
  bool asked_ = false;
  std::vector<std::string> missed_;
};

}  // namespace cerberus::bench
