// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/frame_journal.h"

#include <algorithm>
#include <utility>

namespace cerberus::record {

// The span that a frame of this time would belong to as far as is known.
const FrameJournal::Span* FrameJournal::span_at(Time time) const {
  const auto found = std::ranges::find_if(spans_, [time](const Span& span) { return span.has(time); });
  return found == spans_.end() ? nullptr : &*found;
}

bool FrameJournal::wants_picture(Time time, double score) const {
  const Span* span = span_at(time);
  if (span && span->findings.picture && score <= parameters_.least_gain * span->findings.score) return false;
  bool known = span && span->findings.picture;
  for (const Entry& entry : notes_) {
    const Note& note = entry.note;
    if (!note.picture) continue;
    const bool same = span ? span->has(note.time)
                           : note.time / parameters_.picture_spacing == time / parameters_.picture_spacing;
    if (same && score <= parameters_.least_gain * note.score) return false;
    known |= same;
  }
  // A picture without an object is kept only where a file without any picture is sure to want it.
  return score > 0 || (span && !known);
}

std::size_t FrameJournal::pictures() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(notes_, [](const Entry& entry) { return entry.note.picture != nullptr; }));
}

void FrameJournal::add(Note note) {
  bytes_ += note.line.size();
  const Time time = note.time;
  const bool pictured = note.picture != nullptr;
  auto place = notes_.end();
  while (place != notes_.begin() && std::prev(place)->note.time > time) --place;
  const auto added = notes_.insert(place, Entry{std::move(note), 0});
  if (pictured) {  // in place of the others that it was better than
    const Span* span = span_at(time);
    for (auto entry = notes_.begin(); entry != notes_.end(); ++entry) {
      const Time other = entry->note.time;
      const bool same =
          span ? span->has(other) : other / parameters_.picture_spacing == time / parameters_.picture_spacing;
      if (same && entry != added) entry->note.picture.reset();
    }
    drop_pictures();
  }
  while (bytes_ > parameters_.most_bytes) {
    bytes_ -= notes_.front().note.line.size();
    notes_.pop_front();
  }
}

void FrameJournal::drop_pictures() {
  while (pictures() > parameters_.most_pictures) {
    Entry* worst = nullptr;
    for (Entry& entry : notes_)
      if (entry.note.picture && (!worst || entry.note.score < worst->note.score)) worst = &entry;
    worst->note.picture.reset();
  }
}

void FrameJournal::open(const FileStart& start) {
  for (Span& span : spans_)
    if (span.event == start.event && span.until == Time::max() && span.begin < start.begin)
      span.until = start.begin;
  Span span;
  span.file = start.file;
  span.event = start.event;
  span.begin = span.written = start.begin;
  spans_.push_back(std::move(span));
}

void FrameJournal::written(std::uint32_t file, Time time) {
  for (Span& span : spans_)
    if (span.file == file) span.written = std::max(span.written, time);
}

void FrameJournal::close(const FileEnd& end) {
  for (Span& span : spans_) {
    if (span.file != end.file) continue;
    span.closed = true;
    span.end = end;
  }
}

void FrameJournal::drop(std::uint32_t file) {
  std::erase_if(spans_, [file](const Span& span) { return span.file == file; });
  for (Entry& entry : notes_)
    if (entry.file == file) entry.file = 0;
}

void FrameJournal::assign(Entry& entry, Span& span) {
  entry.file = span.file;
  Note& note = entry.note;
  if (!note.line.empty()) output_.write_line(span.file, note.time - span.begin, note.line);
  Findings& to = span.findings;
  to.tracks.insert(note.tracks.begin(), note.tracks.end());
  to.kinds.insert(note.kinds.begin(), note.kinds.end());
  to.people = std::max(to.people, note.people);
  if (to.rule.empty()) to.rule = note.rule;
  if (note.picture && (!to.picture || note.score > to.score)) {
    to.picture = std::exchange(note.picture, nullptr);
    to.score = note.score;
    to.shown = note.time;
  }
  note.picture.reset();
}

// In the order of time: each note up to what the files are known to have, and no earlier one is to come.
void FrameJournal::assign_notes(Time reached) {
  for (Entry& entry : notes_) {
    if (entry.file) continue;
    const Time time = entry.note.time;
    if (time > reached) return;
    const auto found = std::ranges::find_if(spans_, [time](const Span& span) { return span.has(time); });
    if (found == spans_.end()) continue;
    if (!found->closed && found->until == Time::max() && time > found->written) return;
    assign(entry, *found);
  }
}

void FrameJournal::complete_spans(Time reached) {
  while (!spans_.empty() && spans_.front().closed && spans_.front().limit() <= reached) {
    Span span = std::move(spans_.front());
    spans_.pop_front();
    output_.complete(span.end, std::move(span.findings));
  }
}

void FrameJournal::advance(Time reached, Time kept) {
  assign_notes(reached);
  complete_spans(reached);
  while (!notes_.empty() && notes_.front().note.time < kept) {
    if (!notes_.front().file && span_at(notes_.front().note.time)) break;
    bytes_ -= notes_.front().note.line.size();
    notes_.pop_front();
  }
}

void FrameJournal::reset() {
  assign_notes(Time::max());
  complete_spans(Time::max());
  notes_.clear();
  bytes_ = 0;
}

}  // namespace cerberus::record
