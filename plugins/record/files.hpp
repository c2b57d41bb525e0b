// SPDX-License-Identifier: LGPL-2.1-or-later
// Turns what lib/record decides into files of the writer: caps, names, times, and what is too much for the disk.
// Called under the element's lock.
#pragma once

#include <map>
#include <set>

#include "shared/stamps.hpp"
#include "writer.hpp"

namespace cerberus::plugin {

class Files final : public record::FileWriter {
 public:
  struct Settings {
    std::string folder, name, camera;
    bool mp4_allowed = true, matroska_allowed = true;
  };

  explicit Files(Writer& writer) : writer_(writer) {}

  void configure(const Settings& settings) { settings_ = settings; }
  // `wait`: the caller waits for the disk by itself, so that nothing is given up.
  void set_patient(bool patient) { patient_ = patient; }
  Stamps& stamps() { return stamps_; }
  // A number for the caps; equal caps have one.
  int format_of(GstCaps* caps);
  void forget();

  void open(const record::FileStart& start) override;
  void write(std::uint32_t file, int track, const record::Unit& unit) override;
  void close(const record::FileEnd& end) override;

 private:
  bool fits_mp4(const record::FileStart& start) const;

  Writer& writer_;
  Settings settings_;
  Stamps stamps_;
  bool patient_ = false;
  std::vector<std::shared_ptr<GstCaps>> formats_;
  std::map<std::uint32_t, record::Time> origins_;  // of the open files
  std::set<std::uint32_t> abandoned_;
};

}  // namespace cerberus::plugin
