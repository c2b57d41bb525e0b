// SPDX-License-Identifier: LGPL-2.1-or-later
// The sequences whose people are annotated in every frame, with identities, and what elements found on a frame of them.
#pragma once

#include <gst/gst.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "asked.h"
#include "boxes.h"
#include "vision/image/image.h"

namespace cerberus::bench {

struct PeopleSequence {
  std::string name;
  std::string source;           // launch line that ends in decoded video
  std::filesystem::path truth;  // for read_people(), all of the picture
};
// video: source of vtest.avi. A sequence that is not there is listed all the same.
std::vector<PeopleSequence> people_sequences(const std::filesystem::path& data, const std::string& video);

// Prints the header, then measures each sequence whose truth is there. measure: false where it could not. judged: what is
// asked for decides. Returns the program's exit status.
int for_each_people_sequence(const char* header, bool judged,
                             const std::function<bool(const PeopleSequence&, Asked&)>& measure);

// Of the frame, by its caps.
vision::Size size_of(GstSample* sample);

struct Found {
  Person person;
  bool group = false;
};
std::vector<Found> found_on(GstBuffer* frame);
// Without the groups, which count on neither side: they claim no person.
std::vector<Person> people_of(const std::vector<Found>& found);

}  // namespace cerberus::bench
