// SPDX-License-Identifier: LGPL-2.1-or-later
// What benches can leave out: every mechanism has a name, takes lines or numbers, and can be left out.
#include "bench/mechanisms.h"

#include <check.h>

#include <cstdlib>
#include <cstring>
#include <set>
#include <string>

#include "bench/parameters.h"
#include "support/suite.h"

using namespace cerberus::bench;

namespace {

// All that leave_out() may change, as text.
std::string values_of(DetectorSettings settings) {
  std::string all;
  for (const NamedNumber& n : named_numbers(settings.numbers))
    all += std::visit([](const auto* number) { return std::to_string(*number) + ' '; }, n.number);
  const cerberus::vision::ForegroundMechanisms& m = settings.numbers.mechanisms;
  const auto* c = &m.components;
  for (const bool on :
       {m.light, m.alignment, m.mosaic, m.motion_blur, c->flashes, c->was_empty, c->sides_go_on, c->origins,
        c->resting_ghosts, c->merge_neighbours, settings.camera_motion, settings.options.burnt_in,
        settings.options.regions.people, settings.options.foreground.background_model,
        settings.options.foreground.noise_floor})
    all += on ? '1' : '0';
  return all;
}

}  // namespace

START_TEST(every_mechanism_can_be_left_out_by_a_name_of_its_own) {
  const std::string usual = values_of({});
  std::set<std::string> names, without;
  for (const Mechanism& m : mechanisms()) {
    DetectorSettings settings;
    const std::string wrong = leave_out(settings, m.name);
    ck_assert_msg(wrong.empty(), "%s: %s", m.name, wrong.c_str());
    const std::string values = values_of(settings);
    ck_assert_msg(values != usual && without.insert(values).second, "%s", m.name);
    ck_assert_msg(names.insert(m.name).second, "%s", m.name);
  }
}
END_TEST

START_TEST(several_mechanisms_are_left_out_at_once) {
  DetectorSettings settings;
  ck_assert(leave_out(settings, "follow_leap,mosaic,burnt_in").empty());
  ck_assert(settings.numbers.tracking.association.leap == 0);
  ck_assert(!settings.numbers.mechanisms.mosaic && settings.numbers.mechanisms.alignment);
  ck_assert(!settings.options.burnt_in && DetectorSettings().options.burnt_in);
  const std::string wrong = leave_out(settings, "mosaic,mosaics");
  ck_assert_msg(wrong.starts_with("no mechanism is named \"mosaics\"; the names are: ego_motion"), "%s",
                wrong.c_str());
}
END_TEST

START_TEST(the_lines_and_numbers_of_a_mechanism_are_counted_in_the_source_tree) {
  const char* tree = std::getenv("CERBERUS_SOURCE");
  ck_assert_ptr_nonnull(tree);
  for (const Mechanism& m : mechanisms()) {
    const Extent all = extent_of(m, tree);
    ck_assert_msg(all.lines + all.numbers > 0, "%s", m.name);
    for (const char* source : m.sources) {  // a file or function that is gone counts nothing
      Mechanism one = m;
      one.sources = {source};
      one.other_numbers = 0;
      ck_assert_msg(extent_of(one, tree).lines > 0, "%s: %s", m.name, source);
    }
  }
  const Mechanism edge{"edge", {"geometry/box_edge.h"}, 2, {}};
  ck_assert_int_eq(extent_of(edge, tree).numbers, 4);
  ck_assert_int_eq(extent_of(edge, "/nowhere").lines, 0);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "mechanisms",
      {every_mechanism_can_be_left_out_by_a_name_of_its_own, several_mechanisms_are_left_out_at_once,
       the_lines_and_numbers_of_a_mechanism_are_counted_in_the_source_tree});
}
