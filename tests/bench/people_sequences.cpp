// SPDX-License-Identifier: LGPL-2.1-or-later
#include "people_sequences.h"

#include <cerberus/cerberus.h>

#include <cstdio>

#include "sequences.h"
#include "support/data.h"

namespace cerberus::bench {

std::vector<PeopleSequence> people_sequences(const std::filesystem::path& data, const std::string& video) {
  const auto file = [&](const char* path) {
    return "filesrc location=" + (data / path).string() + " ! decodebin";
  };
  return {{"PETS09-S2L1", video, data / "pets09_s2l1_view1" / "gt.txt"},
          {"TUD-Campus", file("mot15_tud_campus/TUD-Campus.mp4"), data / "mot15_tud_campus" / "gt.txt"},
          {"TUD-Stadtmitte", file("mot15_tud_stadtmitte/TUD-Stadtmitte.mp4"),
           data / "mot15_tud_stadtmitte" / "gt.txt"},
          {"davis_tennis", source_of(sequence("tennis"), data), data / "davis_tennis" / "boxes.txt"}};
}

int for_each_people_sequence(const char* header, bool judged,
                             const std::function<bool(const PeopleSequence&, Asked&)>& measure) {
  const auto real = tests::real_video();
  if (!real) return tests::kSkipped;
  Asked asked;
  bool measured = true;
  std::puts(header);
  for (const PeopleSequence& s : people_sequences(real->data, real->vtest))
    if (std::filesystem::exists(s.truth)) measured = measure(s, asked) && measured;
  if (!judged) return measured ? 0 : 1;
  const int verdict = asked.verdict();
  return measured ? verdict : 1;
}

vision::Size size_of(GstSample* sample) {
  const GstStructure* s = gst_caps_get_structure(gst_sample_get_caps(sample), 0);
  vision::Size size{};
  gst_structure_get_int(s, "width", &size.width);
  gst_structure_get_int(s, "height", &size.height);
  return size;
}

std::vector<Found> found_on(GstBuffer* frame) {
  std::vector<Found> found;
  GPtrArray* regions = cerberus_buffer_get_regions(frame);
  for (guint i = 0; i < regions->len; ++i) {
    const auto* r = static_cast<const CerberusRegion*>(g_ptr_array_index(regions, i));
    found.push_back({{static_cast<int>(r->id), {r->x, r->y, r->width, r->height}},
                     r->kind == CERBERUS_REGION_KIND_GROUP});
  }
  g_ptr_array_unref(regions);
  return found;
}

std::vector<Person> people_of(const std::vector<Found>& found) {
  std::vector<Person> people;
  for (const Found& f : found)
    if (!f.group) people.push_back(f.person);
  return people;
}

}  // namespace cerberus::bench
