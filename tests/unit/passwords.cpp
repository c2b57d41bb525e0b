// SPDX-License-Identifier: LGPL-2.1-or-later
// Passwords in settings: what is shown of them, and which settings are refused; and where a secret is found.
#include "drivers/helper/passwords.h"

#include <cstdlib>

#include "secret_source.h"
#include "support/suite.h"
#include "support/text.h"

using namespace cerberus::drivers;
using cerberus::tests::assert_text;

START_TEST(a_password_is_shown_as_stars) {
  const struct {
    const char *setting, *shown;
  } cases[] = {
      {"http://me:secret@192.0.2.9/onvif", "http://me:***@192.0.2.9/onvif"},
      {"http://me:se:c@ret@192.0.2.9", "http://me:***@192.0.2.9"},
      {"admin:secret@192.0.2.9", "admin:***@192.0.2.9"},
      {"head.py admin:secret@192.0.2.9:80/onvif", "head.py admin:***@192.0.2.9:80/onvif"},
      {"user=a,password=secret", "user=a,password=***"},
      {"user=a password=secret rate=9", "user=a password=*** rate=9"},
      {"/opt/head.py --password=secret", "/opt/head.py --password=***"},
      {"http://192.0.2.9/?user=a&pass=secret", "http://192.0.2.9/?user=a&pass=***"},
      {"head 'password=two words'", "head 'password=***"},
  };
  for (const auto& c : cases) {
    assert_text(without_password(c.setting), c.shown);
    ck_assert_msg(!refuse_password(c.setting).empty(), "%s", c.setting);
  }
}
END_TEST

START_TEST(what_holds_no_password_is_shown_whole) {
  for (const char* setting : {"", "udp:192.0.2.7:52381", "serial:/dev/ttyUSB0", "http://me@192.0.2.9/onvif",
                              "me@192.0.2.9", "http://192.0.2.9:80/a@b:c", "/dev/serial/by-id/usb-a:1@b",
                              "user=a password-file=/etc/secret", "user=a rate=9"}) {
    assert_text(without_password(setting), setting);
    assert_text(refuse_password(setting), "");
  }
}
END_TEST

START_TEST(a_secret_comes_from_one_source) {
  const cerberus::SecretOptions options{"--users", "--users-env", "--users-credential"};
  std::string path = "x", text = "x";
  const auto choose = [&](const cerberus::SecretSource& source) {
    return choose_secret(source, options, path, text);
  };
  assert_text(choose({}), "");
  ck_assert(path.empty() && text.empty());
  assert_text(choose({"/etc/users", "", ""}), "");
  assert_text(path, "/etc/users");
  ::setenv("CERBERUS_TEST_SECRET", "me:hush", 1);
  assert_text(choose({"", "CERBERUS_TEST_SECRET", ""}), "");
  assert_text(text, "me:hush");
  ck_assert(path.empty());
  ::setenv("CERBERUS_TEST_SECRET", "", 1);
  assert_text(choose({"", "CERBERUS_TEST_SECRET", ""}),
              "the environment has no variable CERBERUS_TEST_SECRET, or it is empty (--users-env)");
  assert_text(choose({"a", "b", ""}), "give one of --users, --users-env and --users-credential");
  ::unsetenv("CREDENTIALS_DIRECTORY");
  assert_text(choose({"", "", "camera"}),
              "--users-credential needs a service of systemd with LoadCredential=");
  ::setenv("CREDENTIALS_DIRECTORY", "/run/credentials/robot", 1);
  assert_text(choose({"", "", "camera"}), "");
  assert_text(path, "/run/credentials/robot/camera");
  assert_text(choose({"", "", "../shadow"}), "a credential's name has no slash");
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "passwords",
      {a_password_is_shown_as_stars, what_holds_no_password_is_shown_whole, a_secret_comes_from_one_source});
}
