// SPDX-License-Identifier: LGPL-2.1-or-later
#include "fusion/rule_file.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "sensing/angles.h"
#include "support/suite.h"  // after the streams: check defines fail()
#include "support/temporary_file.h"
#include "text/toml.h"

using namespace cerberus::fusion;
using cerberus::sensing::radians;
using cerberus::tests::temporary_file;

namespace {

constexpr const char* kSound = R"(
sensors = 2
[[rule]]
action = "hold"
)";

// The TOML examples of the manual.
std::vector<std::string> manual_examples() {
  const char* source = std::getenv("CERBERUS_SOURCE");
  std::ifstream file(std::string(source ? source : ".") + "/docs/manual/rules.md");
  ck_assert_msg(file.good(), "docs/manual/rules.md is not there (CERBERUS_SOURCE names the checkout)");
  const std::string page{std::istreambuf_iterator<char>(file), {}};
  std::vector<std::string> examples;
  const std::string open = "```toml\n", close = "```";
  for (std::size_t at = page.find(open); at != std::string::npos; at = page.find(open, at)) {
    at += open.size();
    examples.push_back(page.substr(at, page.find(close, at) - at));
  }
  return examples;
}

void assert_refused(const std::string& text, const std::string& expected) {
  const RuleFile file = parse_rules(text, "f.toml");
  ck_assert(!file.table.has_value());
  ck_assert_msg(file.error.find(expected) != std::string::npos, "\"%s\" is not in \"%s\"", expected.c_str(),
                file.error.c_str());
}

}  // namespace

START_TEST(the_manuals_first_example_is_the_papers_table) {
  const std::vector<std::string> examples = manual_examples();
  ck_assert_int_eq(static_cast<int>(examples.size()), 2);
  const RuleFile file = parse_rules(examples[0], "rules.md");
  ck_assert_msg(file.table.has_value(), "%s", file.error.c_str());
  const RuleTable &ours = *file.table, &paper = paper_rules();
  ck_assert_int_eq(ours.sensors, paper.sensors);
  ck_assert(ours.precedence == paper.precedence && ours.name == paper.name);
  ck_assert_int_eq(static_cast<int>(ours.rules.size()), static_cast<int>(paper.rules.size()));
  for (const bool camera : {false, true})
    for (SensorBits fired = 0; fired < 8; ++fired)
      for (int tenth = -1800; tenth <= 1800; ++tenth) {
        const RuleTable::Match a = ours.evaluate(camera, fired, radians(tenth / 10.0));
        const RuleTable::Match b = paper.evaluate(camera, fired, radians(tenth / 10.0));
        if (a.rule->number != b.rule->number || a.rule->name != b.rule->name ||
            a.band->action != b.band->action)
          ck_abort_msg("camera %d, sensors %u, pan %g: rule %d instead of %d", camera, unsigned{fired},
                       tenth / 10.0, a.rule->number, b.rule->number);
      }
}
END_TEST

START_TEST(the_manuals_second_example_works_as_described) {
  const RuleFile file = parse_rules(manual_examples().at(1), "rules.md");
  ck_assert_msg(file.table.has_value(), "%s", file.error.c_str());
  const RuleTable::Match gate = file.table->evaluate(false, 0b11, 0);
  ck_assert_str_eq(gate.rule->name.c_str(), "gate");
  ck_assert(gate.band->action == Action::search);
  ck_assert_double_eq(gate.band->search.from, radians(-90));
  ck_assert_double_eq(gate.band->search.to, radians(-45));
  ck_assert_str_eq(file.table->evaluate(false, 0b10, 0).rule->name.c_str(), "yard");
}
END_TEST

START_TEST(what_is_left_out_has_a_default) {
  const RuleFile file = parse_rules(kSound, "f.toml");
  ck_assert_msg(file.table.has_value(), "%s", file.error.c_str());
  ck_assert_str_eq(file.table->name.c_str(), "f.toml");
  ck_assert(file.table->precedence == Precedence::exact);
  ck_assert_int_eq(file.table->rules[0].number, 1);
  ck_assert_str_eq(file.table->rules[0].name.c_str(), "rule 1");
  ck_assert(file.table->rules[0].camera == Camera::any && file.error.empty());
}
END_TEST

START_TEST(a_gap_and_a_contradiction_are_named) {
  assert_refused("sensors = 2\n[[rule]]\nall = [1]\naction = \"hold\"\n",
                 "f.toml: camera not found, no sensor fired, any pan angle: no rule applies");
  assert_refused(
      std::string(kSound) + "[[rule]]\nall = [1, 2]\naction = \"zero\"\n",
      "f.toml: camera not found, infer1 and infer2 fired, any pan angle: rule 1 says hold, rule 2 says zero");
  std::string paper = manual_examples().at(0);
  paper.replace(paper.find("\"order\""), 7, "\"exact\"");
  assert_refused(paper, "rule 1 says track, rule 2 says turn-right");
}
END_TEST

START_TEST(a_mistake_is_named_with_its_line) {
  const std::string head = "sensors = 2\n[[rule]]\n";
  assert_refused("sensors = = 2", "f.toml:1: ");
  assert_refused("[&", "f.toml");
  assert_refused("[[[rule]]]", "f.toml");
  assert_refused("sensors = ]", "f.toml");
  assert_refused("sensors = ,", "f.toml");
  assert_refused(head + "bands = [{ from = , action = \"hold\" }]", "f.toml");
  assert_refused(head + "bands = [{ from = ]", "f.toml");
  assert_refused("", "f.toml:1: \"sensors\" (how many there are) is missing");
  assert_refused("sensors = 2", "no [[rule]] found");
  assert_refused("sensors = 2\nrule = 3", "f.toml:2: no [[rule]] found");
  assert_refused("sensors = 0\n[[rule]]\naction = \"hold\"",
                 "f.toml:1: sensors is a whole number from 1 to 16");
  assert_refused("sensors = 2.5\n[[rule]]\naction = \"hold\"",
                 "f.toml:1: sensors is a whole number from 1 to 16");
  assert_refused("precedence = \"first\"\n" + head + "action = \"hold\"",
                 "f.toml:1: unknown precedence \"first\"");
  assert_refused("speed = 3\n" + head + "action = \"hold\"", "f.toml:1: unknown key \"speed\" in the file");
  assert_refused(head + "action = \"left\"", "f.toml:3: unknown action \"left\" (track, turn-left");
  assert_refused(head + "action = 7", "f.toml:3: \"action\" is a text in quotes");
  assert_refused(head + "all = [1]", "rule 1 needs either \"action\" or \"bands\"");
  assert_refused(head + "action = \"hold\"\nbands = []", "rule 1 needs either \"action\" or \"bands\"");
  assert_refused(head + "bands = []", "rule 1: has no action");
  assert_refused(head + "bands = 3", "f.toml:3: \"bands\" is a list");
  assert_refused(head + "bands = [3]", "f.toml:3: a band is a table");
  assert_refused(head + "bands = [{ from = 3 }]", "f.toml:3: rule 1: \"action\" is missing");
  assert_refused(head + "bands = [{ from = \"3\", action = \"hold\" }]",
                 "f.toml:3: from is a pan angle in degrees");
  assert_refused(head + "bands = [{ from = nan, action = \"hold\" }]",
                 "f.toml:3: from is a pan angle in degrees");
  assert_refused(head + "bands = [{ from = inf, action = \"hold\" }]",
                 "f.toml:3: from is a pan angle in degrees");
  assert_refused(head + "bands = [{ from = 1, above = 1, action = \"hold\" }]", "exclude each other");
  assert_refused(head + "bands = [{ up-to = 1, below = 1, action = \"hold\" }]", "exclude each other");
  assert_refused(head + "bands = [{ at = 1, action = \"hold\" }]", "unknown key \"at\" in a band");
  assert_refused(head + "bands = [{ from = 9, up-to = 3, action = \"hold\" }]", "a band holds no pan angle");
  assert_refused(head + "camera = \"on\"\naction = \"hold\"", "f.toml:3: unknown camera \"on\"");
  assert_refused(head + "all = 1\naction = \"hold\"", "f.toml:3: \"all\" is a list of sensor numbers");
  assert_refused(head + "all = [3]\naction = \"hold\"", "f.toml:3: a sensor is a whole number from 1 to 2");
  assert_refused(head + "action = \"search\"", "a search needs the two pan angles");
  assert_refused(head + "action = \"search\"\nsweep = [1]", "f.toml:4: a search needs the two pan angles");
  assert_refused(head + "action = \"search\"\nsweep = [20, 10]",
                 "a search needs two pan angles to sweep between");
  assert_refused(head + "action = \"hold\"\nsweep = [1, 2]", "f.toml:4: only a search has a sweep");
  assert_refused(head + "number = 0\naction = \"hold\"", "f.toml:3: number is a whole number");
}
END_TEST

START_TEST(all_mistakes_are_reported_at_once) {
  const RuleFile file = parse_rules("sensors = 99\nsped = 1\n[[rule]]\naction = \"go\"\n", "f.toml");
  int lines = 1;
  for (const char c : file.error) lines += c == '\n';
  ck_assert_int_eq(lines, 3);
}
END_TEST

START_TEST(a_file_that_cannot_be_read_is_named) {
  const RuleFile missing = load_rules("/nowhere/rules.toml");
  ck_assert(!missing.table.has_value());
  ck_assert_str_eq(missing.error.c_str(), "/nowhere/rules.toml: No such file or directory");
  for (const std::string where : {"/", "/dev/zero"}) {
    const RuleFile none = load_rules(where);
    ck_assert(!none.table.has_value());
    ck_assert(none.error == where + ": a rule file is a regular file");
  }
}
END_TEST

// It has no writer: a blocking open() would wait for ever.
START_TEST(a_pipe_is_refused_at_once) {
  char folder[] = "/tmp/cerberus-rules-XXXXXX";
  ck_assert(mkdtemp(folder) != nullptr);
  const std::string path = std::string(folder) + "/pipe";
  ck_assert_int_eq(mkfifo(path.c_str(), 0600), 0);
  const RuleFile file = load_rules(path);
  unlink(path.c_str());
  rmdir(folder);
  ck_assert(file.error == path + ": a rule file is a regular file");
}
END_TEST

START_TEST(a_file_that_may_not_be_read_is_named) {
  const std::string path = temporary_file("");
  chmod(path.c_str(), 0);
  const bool root = geteuid() == 0;
  ck_assert(!root || seteuid(65534) == 0);
  const RuleFile forbidden = load_rules(path);
  ck_assert(!root || seteuid(0) == 0);
  unlink(path.c_str());
  ck_assert(!forbidden.table.has_value());
  ck_assert(forbidden.error == path + ": Permission denied");
}
END_TEST

START_TEST(a_file_is_read_as_its_text_is) {
  const std::string path = temporary_file(manual_examples().at(0));
  const RuleFile file = load_rules(path);
  unlink(path.c_str());
  ck_assert_msg(file.table.has_value(), "%s", file.error.c_str());
}
END_TEST

// Whatever bytes: an answer, never a throw. Mutations of a good file come deeper than noise.
START_TEST(damaged_files_are_refused_or_read_but_never_harm) {
  const std::string good = manual_examples().at(0);
  std::mt19937 random(9);
  int refused = 0;
  for (int round = 0; round < 1500; ++round) {
    std::string text = good;
    for (unsigned n = 1 + random() % 6; n > 0 && !text.empty(); --n) {
      const std::size_t at = random() % text.size();
      switch (random() % 4) {
        case 0:
          text[at] = static_cast<char>(random() % 256);
          break;
        case 1:
          text.erase(at, 1 + random() % 30);
          break;
        case 2:
          text.insert(at, text.substr(random() % text.size(), random() % 40));
          break;
        default:
          text.resize(at + 1);
      }
    }
    const RuleFile file = parse_rules(text, "f.toml");
    if (file.table.has_value() != file.error.empty())
      ck_abort_msg("round %d: neither table nor error", round);
    refused += !file.table.has_value();
  }
  ck_assert_int_gt(refused, 1000);
}
END_TEST

// toml++ 3.3 has undefined behaviour for these; found by tests/fuzz.
START_TEST(letters_beyond_ascii_stand_in_quotes_and_comments_only) {
  assert_refused("a = 6\"\xc3\xa4\"\n", "f.toml:1: ");  // no string begins there
  assert_refused("a = \"\xc3\xa4\n", "f.toml:1: ");     // none ends there
  assert_refused("a.c=0y1:c-D0X=\": t\xd3\xbb=\":\n", "f.toml:1: ");
  assert_refused("sensors = 2\nS\xd0\xbb = 1\n",
                 "f.toml:2: letters beyond ASCII stand in quotes or comments only");
  assert_refused("\xef\xbb\xbf\xc3\xa4 = 1\n", "letters beyond ASCII");
  assert_refused("'a' = \"\"\"\n\"\"\"\n\xc3\xa4 = 1\n", "f.toml:3: letters beyond ASCII");
  assert_refused("a = \"\"\"b \\\n c\"\"\"\n\xc3\xa4 = 1\n",
                 "f.toml:3: letters beyond ASCII");  // b and c: one line
  const RuleFile file =
      parse_rules("\xef\xbb\xbf# gr\xc3\xbc\xc3\x9f\nsensors = 2\n[[rule]]\naction = \"hold\"\n", "f.toml");
  ck_assert_msg(file.table.has_value(), "%s", file.error.c_str());
}
END_TEST

START_TEST(letters_beyond_ascii_and_tildes_arrive_as_they_were_written) {
  const cerberus::text::TomlFile file = cerberus::text::parse_toml(
      "\"gr\xc3\xb6\xc3\x9f\x65\" = '~ ~41 \xe2\x82\xac'\nb = \"\\\\u007e41\xf0\x9f\x98\x80~\"\n");
  ck_assert(file.root.has_value());
  const auto* const size = file.root->find("gr\xc3\xb6\xc3\x9f\x65");
  ck_assert_ptr_nonnull(size);
  ck_assert_str_eq(size->text.c_str(), "~ ~41 \xe2\x82\xac");
  ck_assert_str_eq(file.root->find("b")->text.c_str(), "\\u007e41\xf0\x9f\x98\x80~");
}
END_TEST

START_TEST(an_escaped_tilde_is_refused_with_its_line) {
  for (const char* escape : {"\\u007e", "\\u007E", "\\U0000007e", "\\U0000007E", "\\\\\\u007e"})
    assert_refused(std::string("a = 1\nb = \"") + escape + "e4\"\n",
                   "f.toml:2: write ~ itself instead of \\u007e");
}
END_TEST

// A byte of Latin-1; a slash in two bytes; half of a surrogate pair; beyond U+10FFFF; a letter that is cut off.
START_TEST(a_file_that_is_not_utf_8_is_refused_with_its_line) {
  for (const char* wrong : {"\xe4", "\xc0\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xe2\x82"})
    assert_refused(std::string("a = 1\nb = \"") + wrong + "\"\n", "f.toml:2: this is not UTF-8");
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "rule_file",
      {the_manuals_first_example_is_the_papers_table, the_manuals_second_example_works_as_described,
       what_is_left_out_has_a_default, a_gap_and_a_contradiction_are_named, a_mistake_is_named_with_its_line,
       all_mistakes_are_reported_at_once, a_file_that_cannot_be_read_is_named, a_pipe_is_refused_at_once,
       a_file_that_may_not_be_read_is_named, a_file_is_read_as_its_text_is,
       damaged_files_are_refused_or_read_but_never_harm,
       letters_beyond_ascii_stand_in_quotes_and_comments_only,
       letters_beyond_ascii_and_tildes_arrive_as_they_were_written, an_escaped_tilde_is_refused_with_its_line,
       a_file_that_is_not_utf_8_is_refused_with_its_line});
}
