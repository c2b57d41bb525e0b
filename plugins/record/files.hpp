// SPDX-License-Identifier: LGPL-2.1-or-later
// Turns what lib/record decides into files of the writer: caps, names, times, and what is too much for the disk.
// Called under the element's lock.
#pragma once

#include <map>
#include <set>

#include "record/frame_journal.h"
#include "shared/stamps.hpp"
#include "writer.hpp"

namespace cerberus::plugin {

class Files final : public record::FileWriter, public record::JournalOutput {
 public:
  struct Settings {
    std::string name, camera;
    bool mp4_allowed = true, matroska_allowed = true;
  };

  explicit Files(Writer& writer) : writer_(writer) {}

  void configure(const Settings& settings) { settings_ = settings; }
  // `wait`: the caller waits for the disk by itself, so that nothing is given up.
  void set_patient(bool patient) { patient_ = patient; }
  Stamps& stamps() { return stamps_; }
  // What was found in the frames, until their files are known.
  record::FrameJournal& journal() { return journal_; }
  // A number for the caps; equal caps have one.
  int format_of(GstCaps* caps);
  void forget();

  void open(const record::FileStart& start) override;
  void write(std::uint32_t file, int track, const record::Unit& unit) override;
  void close(const record::FileEnd& end) override;
  // A file could not be written.
  void drop(std::uint32_t file);

  void write_line(std::uint32_t file, record::Time time, std::string_view line) override;
  void complete(const record::FileEnd& end, record::Findings findings) override;

 private:
  bool fits_mp4(const record::FileStart& start) const;

  Writer& writer_;
  Settings settings_;
  Stamps stamps_;
  record::FrameJournal journal_{*this};
  bool patient_ = false;
  std::vector<std::shared_ptr<GstCaps>> formats_;
  struct OpenFile {
    record::Time origin{};      // time 0 of the file
    std::uint64_t waiting = 0;  // bytes that may wait for the disk
  };
  std::map<std::uint32_t, OpenFile> open_;
  std::set<std::uint32_t> abandoned_;
};

}  // namespace cerberus::plugin
