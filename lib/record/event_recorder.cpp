// SPDX-License-Identifier: LGPL-2.1-or-later
#include "record/event_recorder.h"

#include <algorithm>
#include <utility>

namespace cerberus::record {

namespace {
constexpr Time kNothing = Time::min() / 2;  // an analysis that has not begun
}

void EventRecorder::AudioTrack::pop() {
  bytes -= units.front().bytes;
  units.pop();
}

EventRecorder::AudioTrack& EventRecorder::audio_track(int track) {
  const auto index = static_cast<std::size_t>(track - 1);
  if (audio_.size() <= index) audio_.resize(index + 1);
  return audio_[index];
}

void EventRecorder::configure(const Settings& settings) {
  settings_ = settings;
  cycle_.configure(settings.cycle);
}

void EventRecorder::push_video(Unit unit) {
  const Time decode = unit.decode;
  if (!video_.push(std::move(unit), file_ != 0)) return;
  newest_ = decode;
  if (std::exchange(begins_anew_, false)) cycle_.restart(decode);
  advance(false);
}

void EventRecorder::set_audio_format(int track, int format) {
  audio_track(track).format = format;
}

void EventRecorder::push_audio(int track, Unit unit) {
  AudioTrack& to = audio_track(track);
  to.format = unit.format;
  to.bytes += unit.bytes;
  to.units.push(std::move(unit));
  if (file_) write_audio(cycle_.end());
  evict();
}

void EventRecorder::expect_analysis() {
  analysed_ = kNothing;
}

void EventRecorder::analysed(Time time) {
  const bool falls =
      analysed_.value_or(kNothing) != kNothing && time < *analysed_ - parameters_.most_reordering;
  while (falls && !ahead_.empty() && ahead_.front().first > time) ahead_.pop();  // they are of before
  analysed_ = falls ? time : std::max(analysed_.value_or(time), time);
  advance(false);
}

void EventRecorder::end_analysis() {
  analysed_.reset();
  advance(false);
}

void EventRecorder::triggered(bool begins, std::string_view reason) {
  if (!begins) return;
  ++event_;
  part_ = 0;
  reason_ = reason;
  retry_at_.reset();
}

void EventRecorder::trigger(Time time, std::string_view reason) {
  Number at = ahead_.end();
  while (at != ahead_.begin() && ahead_[at - 1].first > time) --at;
  if (at != ahead_.begin() && time <= ahead_[at - 1].last + settings_.cycle.post_roll) {
    ahead_[at - 1].last = std::max(ahead_[at - 1].last, time);
  } else {
    ahead_.push({time, time, std::string(reason)});
    for (Number k = ahead_.end() - 1; k != at; --k) std::swap(ahead_[k], ahead_[k - 1]);
  }
  advance(false);
}

// A trigger may lie in the video's future: the analysis has the frame, an encoder still holds it.
void EventRecorder::apply_triggers(Time until) {
  while (!ahead_.empty() && ahead_.front().first <= until) {
    Triggers& next = ahead_.front();
    triggered(cycle_.trigger(next.first), next.reason);
    if (next.last > until) {  // the rest of them counts later
      next.first = until + Time(1);
      cycle_.trigger(until);
      return;
    }
    cycle_.trigger(next.last);
    ahead_.pop();
  }
}

void EventRecorder::start(Time time, std::string_view reason, Holder holder) {
  triggered(cycle_.hold(time, holder), reason);
  advance(false);
}

void EventRecorder::stop(Time time, Holder holder) {
  cycle_.release(time, holder);
  advance(false);
}

void EventRecorder::file_failed(std::uint32_t file, bool empty) {
  if (file == previous_) previous_ = 0;
  if (!file_ || file != file_) return;
  if (empty && first_ >= video_.begin()) next_ = first_;
  file_ = 0;
  close_previous();
  retry_at_ = newest_ + parameters_.retry;
}

void EventRecorder::finish() {
  if (!video_.empty()) advance(true);
  if (cycle_.active()) end_event();
  ahead_.clear();
}

void EventRecorder::reset() {
  if (!video_.empty()) advance(true);
  const bool goes_on = cycle_.held();
  if (cycle_.active()) close_file(!goes_on);
  cycle_.restart(Time{});
  begins_anew_ = goes_on;
  ahead_.clear();
  newest_ = Time{};
  retry_at_.reset();
  video_.clear();
  for (AudioTrack& track : audio_)
    while (!track.units.empty()) track.pop();
  if (analysed_) expect_analysis();
  next_ = video_.end();
}

Time EventRecorder::lag() const {
  return analysed_.value_or(kNothing) != kNothing ? newest_ - *analysed_ : Time::zero();
}

std::size_t EventRecorder::bytes() const {
  std::size_t sum = video_.bytes();
  for (const AudioTrack& track : audio_) sum += track.bytes;
  return sum;
}

// The time up to which no trigger is to come any more.
Time EventRecorder::decided() const {
  const Time others = newest_ - parameters_.trigger_delay;
  if (!analysed_) return others;
  return std::max(std::min(others, *analysed_), newest_ - parameters_.most_lag);
}

void EventRecorder::advance(bool ending) {
  apply_triggers(ending ? newest_ + settings_.pre_roll : newest_);
  if (cycle_.active()) {
    if (!file_) try_begin(ending);
    if (file_) write_until(cycle_.end());
    if (is_over()) end_event();
  }
  if (previous_ && newest_ > start_.begin + parameters_.audio_lateness) close_previous();
  evict();
}

// An event is over where no trigger to come can continue it: neither by time, nor because its pre-roll would reach into
// what is written already.
bool EventRecorder::is_over() const {
  if (!cycle_.over(decided())) return false;
  if (!file_) return true;
  const auto keyframe = video_.keyframe_at(decided() - settings_.pre_roll);
  return !keyframe || *keyframe >= next_;
}

void EventRecorder::close_file(bool last) {
  if (file_) {
    close_previous();
    files_.close({file_, last_shown_, last});
  }
  file_ = 0;
}

void EventRecorder::end_event() {
  close_file(true);
  cycle_.close();
}

void EventRecorder::try_begin(bool ending) {
  const Time from = cycle_.begin() - settings_.pre_roll;
  if (video_.empty() || (newest_ < from && !ending)) return;
  if (retry_at_ && newest_ < *retry_at_) return;
  std::optional<Number> keyframe = video_.keyframe_at(from);
  if (keyframe && *keyframe < next_) keyframe = video_.keyframe_from(next_);
  if (!keyframe || video_[*keyframe].decode > cycle_.end()) return;
  retry_at_.reset();
  begin_file(*keyframe);
}

void EventRecorder::begin_file(Number keyframe) {
  const Unit& unit = video_[keyframe];
  first_ = next_ = keyframe;
  file_ = start_.file = ++last_file_;
  start_.event = event_;
  start_.part = ++part_;
  start_.origin = std::min(unit.decode, unit.presentation);
  start_.begin = last_shown_ = unit.presentation;
  start_.trigger = cycle_.begin();
  start_.reason = reason_;
  start_.formats.assign(1, unit.format);
  start_.ring = bytes();
  last_keyframe_ = unit.decode;
  for (AudioTrack& track : audio_) {
    start_.formats.push_back(track.format);
    if (previous_) continue;  // its audio is still written, from where it is
    track.next = std::max(track.next, track.units.begin());
    while (track.next != track.units.end() && track.units[track.next].presentation < start_.begin)
      ++track.next;
  }
  files_.open(start_);
}

bool EventRecorder::must_split(const Unit& unit) const {
  if (unit.format != start_.formats.front()) return true;
  if (!unit.keyframe || settings_.longest_file <= Time::zero()) return false;
  // The GOP that begins here will be as long as the one before it.
  return unit.presentation - start_.begin + (unit.decode - last_keyframe_) > settings_.longest_file;
}

// The next unit begins another file of the same event.
void EventRecorder::split() {
  write_audio(video_[next_].presentation - Time(1));
  close_previous();
  previous_ = file_;
  previous_shown_ = last_shown_;
  begin_file(next_);
  if (start_.formats.size() == 1) close_previous();
}

void EventRecorder::write_until(Time end) {
  for (; next_ != video_.end() && video_[next_].decode <= end; ++next_) {
    const Unit& unit = video_[next_];
    if (next_ != first_ && must_split(unit)) {
      if (!unit.keyframe) continue;  // of another format, and not decodable by itself
      split();
    }
    write_audio(std::min(unit.presentation, end) - Time(1));  // in the order of time, as muxers read
    files_.write(file_, 0, unit);
    if (unit.keyframe) last_keyframe_ = unit.decode;
    last_shown_ = std::max(last_shown_, unit.presentation);
  }
  write_audio(end);
}

void EventRecorder::write_audio(Time end) {
  for (std::size_t k = 0; k < audio_.size(); ++k) {
    AudioTrack& track = audio_[k];
    track.next = std::max(track.next, track.units.begin());
    for (; track.next != track.units.end() && track.units[track.next].presentation <= end; ++track.next) {
      const Unit& unit = track.units[track.next];
      const bool known = k + 1 < start_.formats.size() && start_.formats[k + 1] == unit.format;
      if (unit.presentation >= start_.begin) {
        if (known) files_.write(file_, static_cast<int>(k + 1), unit);
      } else if (previous_) {
        files_.write(previous_, static_cast<int>(k + 1), unit);
      }
    }
  }
}

void EventRecorder::close_previous() {
  if (previous_) files_.close({previous_, previous_shown_, false});
  previous_ = 0;
}

void EventRecorder::evict() {
  const Time pre_roll = settings_.pre_roll;
  Time from = decided() - pre_roll;
  if (cycle_.active() && !file_) from = std::min(from, cycle_.begin() - pre_roll);
  video_.keep_from(from, file_ ? next_ : video_.end());
  while (bytes() > settings_.most_bytes && !video_.empty()) {
    if (file_ && next_ != video_.end()) end_event();  // what waits there for a late trigger is too much
    video_.drop_gop();
  }
  for (AudioTrack& track : audio_) {
    if (track.units.empty()) continue;
    const Time keep = video_.empty() ? track.units.back().presentation - pre_roll - parameters_.most_lag
                                     : video_[video_.begin()].presentation;
    while (!track.units.empty() && track.units.front().presentation < keep &&
           (!file_ || track.units.begin() < track.next))
      track.pop();
  }
}

}  // namespace cerberus::record
