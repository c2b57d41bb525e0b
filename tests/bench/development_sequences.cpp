// SPDX-License-Identifier: LGPL-2.1-or-later
#include "development_sequences.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <limits>
#include <optional>
#include <regex>

#include "hidden_people.h"

namespace cerberus::bench {
namespace fs = std::filesystem;
namespace {

constexpr int kUsualRate = 25;  // frames a second, where SOURCE.txt names none
constexpr double kOverlaps = .3, kRight = .5;
// Of the picture's height: the person in a window of OpenCV's people detector, .76 of it, in a picture of 480 lines.
constexpr double kLeastPlain = .2, kMostPlain = .75;

// The first file of a folder by its name, of those whose names end in `ending`.
std::optional<fs::path> first_file(const fs::path& folder, const char* ending) {
  std::optional<fs::path> first;
  if (!fs::is_directory(folder)) return first;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ending && (!first || entry.path() < *first)) first = entry.path();
  return first;
}

int rate_of(const fs::path& folder) {
  std::ifstream in(folder / "SOURCE.txt");
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  std::smatch found;
  return std::regex_search(text, found, std::regex(R"(fed as (\d+)/1)")) ? std::stoi(found[1]) : kUsualRate;
}

std::optional<std::string> source_in(const fs::path& folder) {
  for (const char* ending : {".mp4", ".avi"})
    if (const auto video = first_file(folder, ending))
      return "filesrc location=" + video->string() + " ! decodebin";
  for (const char* pictures : {"frames", "input", "img"}) {
    const auto first = first_file(folder / pictures, ".jpg");
    if (!first) continue;
    const std::string name = first->stem().string();
    const std::size_t digits = name.find_first_of("0123456789");
    if (digits == std::string::npos) continue;
    const std::string number = name.substr(digits);
    return "multifilesrc location=" + (folder / pictures / name.substr(0, digits)).string() + "%0" +
           std::to_string(number.size()) + "d.jpg start-index=" + std::to_string(std::stoi(number)) +
           " caps=image/jpeg,framerate=" + std::to_string(rate_of(folder)) + "/1 ! jpegdec";
  }
  return std::nullopt;
}

// See FirstBox. Annotation ends where the picture does, so that a box at its edge may be of a part.
bool is_plain(const Person& person, const std::vector<Person>& people, vision::Size size) {
  const vision::Box& box = person.box;
  const bool inside =
      box.x >= 1 && box.y >= 1 && box.right() <= size.width - 1 && box.bottom() <= size.height - 1;
  return inside && !is_covered(person, people) && box.height >= kLeastPlain * size.height &&
         box.height <= kMostPlain * size.height;
}

}  // namespace

std::vector<DevelopmentSequence> development_sequences(const fs::path& data) {
  std::vector<DevelopmentSequence> sequences;
  for (const fs::directory_entry& entry : fs::directory_iterator(data)) {
    const fs::path folder = entry.path();
    const std::string name = folder.filename().string();
    const auto source = entry.is_directory() ? source_in(folder) : std::nullopt;
    if (!source) continue;
    const fs::path one = folder / "groundtruth_rect.txt";
    fs::path all = folder / "boxes.txt";
    if (!fs::exists(all)) all = folder / "gt.txt";
    if (name.starts_with("nogt_")) {
      if (!name.ends_with("_woman")) sequences.push_back({name, Labels::nobody, *source, {}});
    } else if (fs::exists(folder / "all-labelled") && fs::exists(all)) {
      sequences.push_back({name, Labels::all, *source, all});
    } else if (fs::exists(one)) {
      sequences.push_back({name, Labels::one, *source, one});
    }
  }
  std::ranges::sort(sequences, {}, &DevelopmentSequence::name);
  return sequences;
}

const std::array<const char*, 4>& figure_names(Labels labels) {
  static constexpr std::array<const char*, 4> all{"MOTA", "IDF1", "precision", "recall"},
      one{"recall .3", "recall .5", "identities", "others a frame"},
      nobody{"identities a minute", "frames with a box", "", ""};
  return labels == Labels::all ? all : labels == Labels::one ? one : nobody;
}

People read_truth(const DevelopmentSequence& sequence) {
  if (sequence.labels == Labels::nobody) return {};
  if (sequence.labels == Labels::all) return read_people(sequence.truth, 1e9);
  People people;
  int frame = 0;
  for (const vision::Box& box : read_boxes(sequence.truth)) {
    if (box.width > 1 && box.height > 1) people[frame] = {{1, box}};  // else absent
    ++frame;
  }
  return people;
}

std::string line_of(const DevelopmentSequence& sequence, bool mirrored) {
  return sequence.source + " ! videoconvert" +
         (mirrored ? " ! videoflip video-direction=horiz ! videoconvert" : "") + " ! video/x-raw,format=I420";
}

DevelopmentRun::DevelopmentRun(const DevelopmentSequence& sequence, bool mirrored)
    : labels_(sequence.labels), mirrored_(mirrored), people_(read_truth(sequence)) {}

void DevelopmentRun::add(const std::vector<Found>& found, vision::Size size, double time) {
  if (frames_ == 0) first_ = time;
  last_ = time;
  const int n = frames_++;
  with_box_ += !found.empty();
  if (labels_ == Labels::nobody)
    for (const Found& f : found) identities_.insert(f.person.id);
  const auto truth = people_.find(n);
  if (truth == people_.end()) return;
  std::vector<Person> people = truth->second;
  if (mirrored_)
    for (Person& p : people) p.box.x = size.width - p.box.right();
  const std::vector<Person> persons = people_of(found);
  if (labels_ == Labels::all) score_.add(people, persons);
  for (const Person& p : people) {
    if (labels_ == Labels::one) add_labelled(found, p.box);
    add_person(p, people, persons, size, time);
  }
}

void DevelopmentRun::add_person(const Person& person, const std::vector<Person>& people,
                                const std::vector<Person>& found, vision::Size size, double time) {
  const vision::Box& box = person.box;
  const auto [at, is_new] = appearances_.try_emplace(person.id);
  Appearance& life = at->second;
  if (is_new)
    life = {time, {person.id, std::numeric_limits<double>::infinity(), is_plain(person, people, size)}};
  const bool whole = box.x >= 0 && box.y >= 0 && box.right() <= size.width && box.bottom() <= size.height;
  const auto overlap = [&](const Person& f) { return vision::intersection_over_union(f.box, box); };
  const auto best = std::ranges::max_element(found, {}, overlap);
  if (best == found.end() || overlap(*best) < kOverlaps) return;
  if (whole) {
    widths_.push_back(best->box.width / box.width);
    heights_.push_back(best->box.height / box.height);
  }
  if (overlap(*best) >= kRight) life.first.seconds = std::min(life.first.seconds, time - life.since);
}

void DevelopmentRun::add_labelled(const std::vector<Found>& found, vision::Box box) {
  double best = 0;
  int identity = 0;
  for (const Found& f : found)
    if (const double o = vision::intersection_over_union(f.person.box, box); o > best)
      best = o, identity = f.person.id;
  ++labelled_;
  overlapped_ += best >= kOverlaps;
  right_ += best >= kRight;
  others_ += static_cast<int>(found.size()) - (best >= kOverlaps);
  if (best >= kOverlaps) identities_.insert(identity);
}

Outcome DevelopmentRun::outcome() const {
  Outcome outcome{figures(), {}, widths_, heights_};
  for (const auto& [person, life] : appearances_) outcome.first_boxes.push_back(life.first);
  return outcome;
}

Figures DevelopmentRun::figures() const {
  if (labels_ == Labels::all)
    return {std::max(-1., score_.mota()), score_.idf1(), score_.precision(), score_.recall()};
  const auto identities = static_cast<double>(identities_.size());
  if (labels_ == Labels::one) {
    const double n = std::max(1, labelled_);
    return {overlapped_ / n, right_ / n, identities, others_ / n};
  }
  // The last frame lasts as long as the others.
  const double n = std::max(1, frames_), seconds = (last_ - first_) * n / std::max(1., n - 1);
  return {seconds > 0 ? identities * 60 / seconds : 0, with_box_ / n, 0, 0};
}

}  // namespace cerberus::bench
