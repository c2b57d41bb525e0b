// SPDX-License-Identifier: LGPL-2.1-or-later
#include "robot/retained_topics.h"
#include "robot/settings_file.h"

#include <sys/stat.h>
#include <time.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "robot/backoff.h"
#include "robot/mode.h"
#include "robot/pipeline_text.h"
#include "support/says.h"
#include "support/suite.h"  // after the streams: check defines fail()
#include "support/temporary_folder.h"

using namespace cerberus::robot;

namespace {

#define SMALLEST "[[camera]]\nname = \"front\"\nkind = \"test\"\n"
#define BACK "[[camera]]\nname = \"b\"\nkind = \"test\"\n"
#define PARTS(driver, device, options) HEAD(driver, device) "device-options = \"" options "\"\n"
#define LINES(lines, more) "[camera.sensors]\ndriver = \"gpio\"\nlines = \"" lines "\"\n" more
#define HEAD(driver, device) "[camera.head]\ndriver = \"" driver "\"\ndevice = \"" device "\"\n"
const std::string kSmallest = SMALLEST;

std::string read(const std::string& name) {
  const char* source = std::getenv("CERBERUS_SOURCE");
  std::ifstream file(std::string(source ? source : ".") + '/' + name);
  ck_assert_msg(file.good(), "%s is not there (CERBERUS_SOURCE names the checkout)", name.c_str());
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string errors(const std::string& text) {
  return parse_settings(text, "r.toml", "").errors;
}

Settings settings(const std::string& text) {
  SettingsFile file = parse_settings(text, "r.toml", "/etc/robot");
  ck_assert_msg(file.settings.has_value(), "%s", file.errors.c_str());
  return *std::move(file.settings);
}

std::string value(const Properties& properties, const std::string& name) {
  for (const Property& property : properties)
    if (property.name == name) return property.value;
  return "(none)";
}

void write(const std::string& path, const std::string& text, int mode = 0600) {
  std::ofstream(path) << text;
  ::chmod(path.c_str(), static_cast<mode_t>(mode));
}

}  // namespace

START_TEST(the_smallest_file_has_one_camera_and_a_page_on_loopback) {
  const Settings all = settings(kSmallest);
  ck_assert_uint_eq(all.cameras.size(), 1);
  ck_assert_str_eq(all.cameras[0].name.c_str(), "front");
  ck_assert(!all.cameras[0].head && !all.cameras[0].sensors && !all.cameras[0].recorder);
  ck_assert(all.page.enabled && all.page.listen == "127.0.0.1" && all.page.port == 8080);
  ck_assert(all.mode.start == Mode::armed);
}
END_TEST

START_TEST(two_heads_share_a_chip_but_no_line_and_no_channel) {
  settings(SMALLEST PARTS("stepper-gpio", "gpiochip0", "pan='lines=1,2,3,4' emergency-stop=gpiochip1:1")
               LINES("5,6,7", "")
                   BACK PARTS("stepper-gpio", "0", "pan='lines=8,9,10,11' emergency-stop=gpiochip1:2")
                       LINES("1,2,3", "chip = \"pinctrl-bcm2711\"\n"));
  settings(SMALLEST PARTS("servo-pwm", "0", "pan='channel=0' tilt='channel=1'")
               BACK PARTS("servo-pwm", "0", "pan='channel=2' tilt='channel=10'"));
}
END_TEST

START_TEST(a_whole_file_becomes_typed_settings) {
  const Settings all = settings(R"(name = "garden"
[mode]
start = "disarmed"
schedule = [ { at = "22:30", days = ["sat", "sun"], mode = "armed" } ]
[[camera]]
name = "gate"
kind = "rtsp"
uri = "rtsp://192.168.1.64:554/sub"
record-uri = "rtsp://192.168.1.64:554/main"
user = "viewer"
password-file = "gate.password"
codec = "h265"
horizontal-fov = 90
[camera.detection]
confirm-time = 0.3
[camera.sensors]
driver = "gpio"
lines = "17,27,22"
[camera.head]
driver = "visca"
device = "serial:/dev/ttyUSB0"
pan-min = -100
[camera.recorder]
folder = "recordings"
pre-roll = 2.5
retention-days = 2
)");
  const CameraSettings& gate = all.cameras.at(0);
  ck_assert(gate.source.kind == SourceKind::rtsp && gate.source.codec == Codec::h265);
  ck_assert_str_eq(gate.source.password_file.c_str(), "/etc/robot/gate.password");
  ck_assert_double_eq(gate.horizontal_fov, 90);
  ck_assert(value(gate.detection, "confirm-time") == "300000000");
  ck_assert(value(*gate.sensors, "lines") == "17,27,22");
  ck_assert(value(*gate.head, "pan-min") == "-100");
  ck_assert_str_eq(gate.recorder->folder.c_str(), "/etc/robot/recordings");
  ck_assert(value(gate.recorder->properties, "pre-roll") == "2500000000");
  ck_assert(value(gate.recorder->properties, "retention-age") == "172800000000000");
  ck_assert(all.mode.start == Mode::disarmed);
  ck_assert_int_eq(all.mode.schedule.at(0).minute, 22 * 60 + 30);
  ck_assert_int_eq(all.mode.schedule.at(0).days, 0b1100000);
}
END_TEST

START_TEST(every_mistake_is_reported_with_its_line) {
  const struct {
    const char *text, *error;
  } cases[] = {
      {"", "r.toml: there is no camera"},
      {"nam = \"x\"\n", "r.toml:1: unknown key \"nam\" in the file: is \"name\" meant?"},
      {"name = 7\n", "r.toml:1: \"name\" of the file is a text in quotes, and not 7"},
      {"[page]\nport = 80a\n", "; the line is: port = 80a"},
      {"[page]\nport = \"80\"\n", "a whole number from 1 to 65535, and not \"80\""},
      {"[page]\nport = [80]\n", "a whole number from 1 to 65535, and not a list"},
      {"[page]\nport = 8.5\n", "and not 8.5"},
      {"name = \"a\"\n[page\nport = 80\n", "r.toml:2: "},
      {"name = \"a\"\n[&\n",
       "r.toml:2: this is not TOML: a value, a key or a bracket is missing or misplaced; the line is: [&"},
      {"name = \"a\"\nport = ]\n", "r.toml:2: "},
      {"[mqtt]\npassword = \"hunter2\n", "; the line begins with: password"},
      {"[[camera]]\nuri = \"rtsp://anna:hunter2@b/1\n", "; the line is: uri = \"rtsp://...@b/1"},
      {"[page]\nport = \"http://anna:hunter2@b/1\"\n", "and not \"http://...@b/1\""},
      {"[mode]\nstart = \"on\"\n", "and not \"on\""},
      {"name = \"a\\nb\"\n", "r.toml:1: \"name\" of the file is one line"},
      {"page = 3\n", "r.toml:1: \"page\" of the file is a table of its own"},
      {"camera = 3\n", "r.toml:1: \"camera\" of the file is a list of tables: [[camera]]"},
      {"[page]\nport = 70000\n", "r.toml:2: \"port\" of [page] is a whole number from 1 to 65535"},
      {"[page]\nenabled = 1\n", "r.toml:2: \"enabled\" of [page] is true or false"},
      {"[page]\norigins = [\"robot\"]\n", "r.toml:2: \"robot\" is no origin"},
      {"[page]\ntrusted-proxy = \"proxy\"\n", "r.toml:2: \"proxy\" is no numeric address of a proxy"},
      {"[page]\ntrusted-proxy = [\"10.0.0.0/8\", \"::1/200\"]\n", "r.toml:2: \"::1/200\" is no numeric"},
      {"[page]\ntrusted-proxy = 3\n", "r.toml:2: \"trusted-proxy\" of [page] is a list of texts"},
      {"[page]\norigins = \"robot\"\n", "r.toml:2: \"origins\" of [page] is a list of texts"},
      {"[mode]\nstart = \"on\"\n",
       "r.toml:2: \"start\" of [mode] is one of \"armed\", \"disarmed\", \"privacy\""},
      {"[mode]\nschedule = [ { at = \"24:00\", mode = \"armed\" } ]\n",
       "r.toml:2: \"at\" is a time of the day"},
      {"[mode]\nschedule = [ { at = \"2x:00\", mode = \"armed\" } ]\n",
       "r.toml:2: \"at\" is a time of the day"},
      {"[mode]\nschedule = [ { mode = \"armed\" } ]\n", "r.toml:2: an entry of \"schedule\" needs \"at\""},
      {"[mode]\nschedule = [ { at = \"10:00\" } ]\n", "r.toml:2: an entry of \"schedule\" needs \"mode\""},
      {"[mode]\nschedule = [ { at = \"10:00\", mode = \"armed\", days = [\"may\"] } ]\n",
       "r.toml:2: \"may\" is no day"},
      {"[[camera]]\nkind = \"test\"\n", "r.toml:1: a [[camera]] needs a \"name\""},
      {"[[camera]]\nname = \"a b\"\nkind = \"test\"\n",
       "r.toml:2: \"name\" of [[camera]] is 1 to 64 letters"},
      {"[[camera]]\nname = \"a\"\n", "r.toml:1: a [[camera]] needs a \"kind\""},
      {"[[camera]]\nname = \"a\"\nkind = \"usb\"\n",
       "r.toml:3: \"kind\" of [[camera]] is one of \"test\", \"world\""},
      {"[[camera]]\nname = \"a\"\nkind = \"v4l2\"\n", "r.toml:3: kind = \"v4l2\" needs \"device\""},
      {"[[camera]]\nname = \"a\"\nkind = \"test\"\ndevice = \"/dev/video0\"\n",
       "r.toml:4: \"device\" is not for kind = \"test\""},
      {"[[camera]]\nname = \"a\"\nkind = \"test\"\nwidth = 640\n",
       "r.toml:4: \"width\" and \"height\" belong together"},
      {"[[camera]]\nname = \"a\"\nkind = \"rtsp\"\nuri = \"http://b\"\n",
       "r.toml:4: \"uri\" begins with rtsp://"},
      {"[[camera]]\nname = \"a\"\nkind = \"rtsp\"\nuri = \"rtsp://u:hunter2@b/c\"\n",
       "r.toml:4: \"uri\" holds a user or a password: use \"user\" and \"password-file\""},
      {"[[camera]]\nname = \"a\"\nkind = \"rtsp\"\nuri = \"rtsp://b\"\nuser = \"u\"\n",
       "r.toml:5: \"user\" and \"password-file\" belong together"},
      {"[[camera]]\nname = \"a\"\nkind = \"test\"\nhorizontal-fov = nan\n",
       "r.toml:4: \"horizontal-fov\" of [[camera]] is a number from 1 to 179"},
      {"[[camera]]\nname = \"a\"\nkind = \"world\"\nfile = \"w.avi\"\n",
       "r.toml:3: kind = \"world\" is a simulated head's world"},
      {"[[camera]]\nname = \"a\"\nkind = \"world\"\nfile = \"w.avi\"\nhorizontal-fov = 70\n[camera.head]\n",
       "r.toml:5: \"horizontal-fov\", what the window shows, is less than"},
      {"[[camera]]\nname = \"a\"\nkind = \"test\"\n[camera.patrol]\nspeed = 1\n",
       "r.toml:4: [camera.patrol] is for kind = \"patrol\" only"},
      {"[[camera]]\nname = \"a\"\nkind = \"patrol\"\n[camera.patrol]\nspeed = 3\n",
       "r.toml:5: \"speed\" of [camera.patrol] is a number from 0.05 to 1.5"},
      {"[[camera]]\nname = \"a\"\nkind = \"patrol\"\n[camera.sensors]\ndriver = \"gpio\"\n",
       "r.toml:5: unknown key \"driver\" in [camera.sensors]"},
      {"[[camera]]\nname = \"a\"\nkind = \"patrol\"\n[camera.head]\ndriver = \"visca\"\ndevice = "
       "\"serial:/dev/tty9\"\n",
       "r.toml:5: kind = \"patrol\" has a simulated head"},
      {"[[camera]]\nname = \"a\"\nkind = \"test\"\n[camera.head]\npan-max = -5\n",
       "r.toml:5: \"pan-max\" of [camera.head] is a number from 0 to 3600"},
      {"[[camera]]\nname = \"a\"\nkind = \"test\"\n[camera.head]\ndriver = \"visca\"\n",
       "r.toml:5: driver = \"visca\" needs \"device\""},
      {"[[camera]]\nname = \"a\"\nkind = \"test\"\n[camera.head]\ndriver = \"external\"\n",
       "r.toml:5: driver = \"external\" needs \"command\""},
      {"[[camera]]\nname = \"a\"\nkind = \"test\"\n[camera.head]\ndevice-options = \"user=u "
       "password=hunter2\"\n",
       "r.toml:5: \"device-options\" holds a password"},
      {"[[camera]]\nname = \"a\"\nkind = \"test\"\n[camera.recorder]\n",
       "r.toml:4: a [camera.recorder] needs a \"folder\""},
      {"[[camera]]\nname = \"a\"\nkind = \"test\"\n[camera.recorder]\nfolder = \".\"\npre-role = 3\n",
       "r.toml:6: unknown key \"pre-role\" in [camera.recorder]: is \"pre-roll\" meant?"},
      {"[[camera]]\nname = \"a\"\nkind = \"test\"\n[[camera]]\nname = \"a\"\nkind = \"test\"\n",
       "r.toml:4: there are two cameras called \"a\""},
      {"[page]\nport = 8554\n[rtsp]\n" SMALLEST, "r.toml:2: \"port\" is 8554 of both [page] and [rtsp]"},
      {"[page]\n[rtsp]\nport = 8080\n" SMALLEST, "r.toml:3: \"port\" is 8080 of both"},
      {"[[camera]]\nname = \"a\"\nkind = \"rtsp\"\nuri = \"rtsp://b\"\nrecord-uri = \"rtsp://c\"\n",
       "r.toml:5: nothing takes the stream of \"record-uri\""},
      {SMALLEST HEAD("visca", "serial:/dev/tty9") "[[camera]]\nname = \"b\"\nkind = \"test\"\n" HEAD(
           "visca", "serial:/dev//tty9"),
       "r.toml:12: \"device\" of camera \"b\" is \"serial:/dev//tty9\", which is in use by camera \"front\" "
       "already"},
      {SMALLEST HEAD("pelco-d", "serial:/dev/tty9") "[camera.sensors]\ndriver = \"external\"\ndevice = "
                                                    "\"serial:/dev/tty9\"\n",
       "r.toml:9: \"device\" is \"serial:/dev/tty9\" of the head of camera \"front\" and of the sensors"},
      // One chip has many names, and a line one user.
      {SMALLEST LINES("1,2,3", "") BACK LINES("4,5,03", "chip = \"0\"\n"),
       "r.toml:12: \"lines\" of camera \"b\" is \"03\", which is in use by the sensors of camera \"front\" "
       "already"},
      {SMALLEST LINES("1,2,3", "") BACK LINES("4,5,6", "leds-red = \"7,8,3\"\nchip = \"gpiochip0\"\n"),
       "r.toml:13: \"leds-red\" of camera \"b\" is \"3\", which is in use by the sensors of camera \"front\" "
       "already"},
      {SMALLEST LINES("1,2,3", "") PARTS("stepper-gpio", "/dev/gpiochip0", "tilt='lines=9,3 steps=400'"),
       "r.toml:6: \"lines\" of camera \"front\" is \"3\", which is in use by the head of camera \"front\" "
       "already"},
      {SMALLEST PARTS("stepper-gpio", "gpiochip1", "pan='lines=1,2,3,4'")
           BACK PARTS("stepper-gpio", "1", "pan='lines=5,6 steps=400 end-stop=4@-90'"),
       "r.toml:14: \"device-options\" of camera \"b\" is \"4\", which is in use by the head of camera "
       "\"front\" already"},
      {SMALLEST PARTS("visca", "serial:/dev/tty9", "emergency-stop=gpiochip0:2") BACK LINES("1,2,3", ""),
       "r.toml:13: \"lines\" of camera \"b\" is \"2\", which is in use by the emergency stop of camera "
       "\"front\""},
      {SMALLEST PARTS("stepper-gpio", "0", "pan='lines=1,2,3,4' emergency-stop=gpiochip0:2"),
       "r.toml:7: \"device-options\" of camera \"front\" is \"2\", which is in use by the head of camera "
       "\"front\""},
      {SMALLEST PARTS("servo-pwm", "pwmchip0", "pan='channel=0' tilt='channel=1'")
           BACK PARTS("servo-pwm", "/sys/class/pwm/pwmchip0", "tilt='channel=1'"),
       "r.toml:14: \"device-options\" of camera \"b\" is \"channel=1\", which is in use by the head of "
       "camera \"front\""},
      {"[[camera]]\nname = \"a\"\nkind = \"test\"\n[camera.head]\nbase-turn = 30\n",
       "r.toml:5: \"base-turn\" of camera \"a\" asks a base to turn, and there is none: add a [base]"},
      {"[base]\ncommand = \"cat\"\n" SMALLEST
       "[camera.head]\nbase-turn = 30\n[[camera]]\nname = \"b\"\nkind = "
       "\"test\"\n[camera.head]\nbase-turn = 20\n",
       "\"base-turn\" of camera \"b\" is \"20\", which is in use by the head of camera \"front\" already: "
       "one head"},
      {"[page]\nport = \n", "r.toml:2: "},
      {"[page]\nlisten = \"localhost\"\n", "r.toml:2: \"listen\" is a numeric address"},
      {"[page]\nlisten = \"127.0.0.1:80\"\n", "r.toml:2: \"listen\" is a numeric address"},
      {"[mqtt]\nhost = \"b\"\ntopic-prefix = \"a/b\"\n",
       "r.toml:3: \"topic-prefix\" is one level of a topic"},
      {"[mqtt]\nhost = \"b\"\ntopic-prefix = \"\"\n", "r.toml:3: \"topic-prefix\" is one level of a topic"},
      {"[rtsp]\nport = 0\n", "r.toml:2: \"port\" of [rtsp] is a whole number from 1 to 65535"},
      {"[rtsp]\nlisten = \"0.0.0.0\"\n", "r.toml:2: at 0.0.0.0 the whole network could watch"},
      {"[rtsp]\nlisten = \"robot\"\n", "r.toml:2: \"listen\" is a numeric address"},
      {"[rtsp]\nusers-file = \"a\"\nusers-credential = \"b\"\n", "r.toml:3: \"users-file\" and"},
      {"[rtsp]\nusers-file = \"a\"\nanyone = true\n", "r.toml:3: \"anyone\" is for a server without users"},
      {"[rtsp]\nmounts = [\"plain\", \"mask\"]\n", "r.toml:2: \"mask\" is no mount: plain, annotated"},
      {"[rtsp]\nmounts = []\n", "r.toml:2: \"mounts\" names none"},
      {"[rtsp]\ncertificate = \"c\"\n", "r.toml:2: \"certificate\" and \"certificate-key\" belong together"},
      {"[rtsp]\nencoder = \"theoraenc\"\n", "r.toml:2: \"encoder\" of [rtsp] is one of \"v4l2h264enc\""},
      {"[rtsp]\nencoder = \"jpeg\"\nbitrate = 500\n", "r.toml:3: \"bitrate\" is not for"},
      {"[rtsp]\nencoder = \"jpegenc\"\nbitrate = 500\n",
       "r.toml:3: \"bitrate\" is not for encoder = \"jpegenc\""},
      {"[rtsp]\npasswort = \"x\"\n", "r.toml:2: unknown key \"passwort\" in [rtsp]"},
      {"[mqtt]\n", "r.toml:1: [mqtt] needs the \"host\" of the broker"},
      {"[mqtt]\nhost = \"b\"\ncommands = [\"stop\", \"jump\"]\n", "r.toml:3: \"jump\" is no command"},
      {"[webhook]\nsecret-file = \"s\"\n", "r.toml:1: [webhook] needs \"url\""},
      {"[webhook]\nurl = \"https://a/\"\n", "r.toml:1: [webhook] needs \"secret-file\""},
      {"[webhook]\nurl = \"ftp://a\"\n", "r.toml:2: \"url\" begins with https:// or http://"},
      {"[webhook]\nurl = \"h\"\n", "r.toml:2: \"url\" begins with https:// or http://"},
      {"[webhook]\nurl = \"https://\"\n", "r.toml:2: \"url\" has a host"},
      {"[webhook]\nurl = \"https://u:p@a/\"\n", "r.toml:2: \"url\" has a host, and no user"},
      {"[webhook]\ntopics = [\"tracks\"]\n", "r.toml:2: \"tracks\" is no topic"},
      {"[webhook]\ntopics = []\n", "r.toml:2: \"topics\" names none"},
      {"[page]\ntls = true\ncertificate = \"c\"\n",
       "r.toml:3: \"certificate\" and \"certificate-key\" belong"},
      {"[page]\ncertificate = \"c\"\ncertificate-key = \"k\"\n",
       "r.toml:2: \"certificate\" needs tls = true"},
      {"[mqtt]\nhost = \"b\"\npassword = \"hunter2\"\n", "r.toml:3: unknown key \"password\" in [mqtt]"},
      {"[mqtt]\nhost = \"b\"\nusername = \"u\"\n",
       "r.toml:3: \"username\" and \"password-file\" belong together"},
  };
  for (const auto& one : cases) {
    const std::string found = errors(one.text);
    ck_assert_msg(found.find(one.error) != found.npos, "\"%s\" is not in \"%s\"", one.error, found.c_str());
    ck_assert_msg(found.find("hunter2") == found.npos, "a secret is in \"%s\"", found.c_str());
  }
}
END_TEST

START_TEST(a_move_by_mqtt_ends_after_a_minute_or_as_configured) {
  const auto timeout = [](const std::string& commands, const std::string& head) {
    const Settings all = settings("[mqtt]\nhost = \"b\"\ncommands = [" + commands + "]\n" + kSmallest +
                                  "[camera.head]\n" + head);
    return value(*all.cameras.at(0).head, "manual-timeout");
  };
  ck_assert(timeout("\"move-to\"", "") == "60000000000");
  ck_assert(timeout("\"stop\", \"move-by\"", "") == "60000000000");
  ck_assert(timeout("\"move-to\"", "manual-timeout = 5\n") == "5000000000");
  ck_assert(timeout("\"move-to\"", "manual-timeout = 0\n") == "0");
  ck_assert(timeout("\"stop\", \"home\"", "") == "(none)");
  ck_assert(value(*settings(kSmallest + "[camera.head]\n").cameras.at(0).head, "manual-timeout") == "(none)");
}
END_TEST

START_TEST(all_mistakes_come_at_once_in_the_order_of_their_lines) {
  const std::string found = errors("[page]\nprot = 1\n[[camera]]\nname = \"a\"\nkind = \"tset\"\n");
  ck_assert_str_eq(found.c_str(),
                   "r.toml:2: unknown key \"prot\" in [page]: is \"port\" meant?\n"
                   "r.toml:5: \"kind\" of [[camera]] is one of \"test\", \"world\", \"file\", \"v4l2\", "
                   "\"rtsp\", \"libcamera\", \"patrol\", and not \"tset\"");
}
END_TEST

START_TEST(files_that_are_named_must_be_there_and_secrets_be_secret) {
  const TemporaryFolder folder;
  const std::string path = folder.path + "/r.toml";
  const std::string camera =
      "[[camera]]\nname = \"a\"\nkind = \"rtsp\"\nuri = \"rtsp://b\"\nuser = \"u\"\npassword-file = \"p\"\n";
  write(path, camera);
  ck_assert(says(load_settings(path).errors,
                 path + ":6: \"password-file\" names " + folder.path + "/p: No such file"));
  write(folder.path + "/p", "hush\n", 0644);
  ck_assert(says(load_settings(path).errors, ":6: " + folder.path + "/p holds a secret that every user"));
  ck_assert(load_settings(path).errors.find("hush") == std::string::npos);
  write(folder.path + "/p", "hush\n", 0640);
  ck_assert(load_settings(path).errors == "");
  ck_assert(says(load_settings(folder.path + "/none.toml").errors, "No such file"));
  ck_assert(says(load_settings(folder.path).errors, "a configuration file is a regular file"));
}
END_TEST

START_TEST(a_secret_may_be_a_credential_of_systemd) {
  const TemporaryFolder folder;
  const std::string path = folder.path + "/r.toml";
  const std::string camera = "[[camera]]\nname = \"a\"\nkind = \"rtsp\"\nuri = \"rtsp://b\"\nuser = \"u\"\n";
  const std::string credential = camera + "password-credential = \"gate\"\n";
  write(path, credential + "[mqtt]\nhost = \"b\"\nusername = \"u\"\npassword-credential = \"broker\"\n");
  // Outside of the service nothing is looked for.
  SettingsFile file = load_settings(path);
  ck_assert_msg(file.settings.has_value(), "%s", file.errors.c_str());
  ck_assert_str_eq(file.settings->cameras[0].source.password_file.c_str(),
                   "/run/credentials/cerberusd.service/gate");
  ck_assert(value(*file.settings->mqtt, "password-file") == "/run/credentials/cerberusd.service/broker");
  // Within it the credentials must be there.
  write(folder.path + "/gate", "hush\n", 0400);
  file = load_settings(path, folder.path);
  ck_assert(file.errors == path + ":10: \"password-credential\" names " + folder.path +
                               "/broker: No such file or directory");
  write(folder.path + "/broker", "hush\n", 0400);
  file = load_settings(path, folder.path);
  ck_assert(file.settings && file.settings->cameras[0].source.password_file == folder.path + "/gate");

  ck_assert(says(errors(credential + "password-file = \"p\"\n"), "give one of them"));
  ck_assert(
      says(errors(camera + "password-credential = \"../gate\"\n"), "r.toml:6: \"password-credential\" is"));
  ck_assert(says(errors("[[camera]]\nname = \"a\"\nkind = \"test\"\npassword-credential = \"gate\"\n"),
                 "r.toml:4: \"password-credential\" is not for kind = \"test\""));
}
END_TEST

START_TEST(a_list_of_users_is_read_and_a_file_that_was_written_anew_is_noticed) {
  const TemporaryFolder folder;
  const std::string path = folder.path + "/robot.toml", viewers = folder.path + "/viewers";
  write(path, "[rtsp]\nusers-file = \"viewers\"\n" + kSmallest);
  write(viewers, "anna\n");
  ck_assert_msg(says(load_settings(path).errors, path + ":2: " + viewers + ": "), "%s",
                load_settings(path).errors.c_str());
  write(viewers, "anna:long enough\n");
  const SettingsFile before = load_settings(path), same = load_settings(path);
  ck_assert_msg(before.settings && same.settings, "%s", before.errors.c_str());
  ck_assert(before.settings->stamps == same.settings->stamps);
  write(viewers, "anna:another, longer one\n");
  ck_assert(load_settings(path).settings->stamps.at("rtsp") != before.settings->stamps.at("rtsp"));
}
END_TEST

START_TEST(a_secret_is_the_first_line_of_its_file) {
  const TemporaryFolder folder;
  std::string error;
  write(folder.path + "/p", "hush hush\r\nmore\n");
  ck_assert(read_secret(folder.path + "/p", error).value_or("") == "hush hush");
  write(folder.path + "/empty", "\n");
  ck_assert(!read_secret(folder.path + "/empty", error) && says(error, "is empty"));
}
END_TEST

START_TEST(the_examples_of_the_manual_and_the_demo_are_sound) {
  const std::string page = read("docs/manual/robot.md");
  const std::string open = "```toml\n", close = "```";
  int examples = 0;
  for (std::size_t at = page.find(open); at != page.npos; at = page.find(open, at)) {
    at += open.size();
    settings(page.substr(at, page.find(close, at) - at));
    ++examples;
  }
  ck_assert_int_ge(examples, 2);
  const Settings demo = settings(read("pipelines/robot/demo.toml"));
  ck_assert(demo.cameras.at(0).source.kind == SourceKind::world);
  const Settings patrol = settings(read("pipelines/robot/patrol.toml"));
  ck_assert(patrol.cameras.at(0).source.kind == SourceKind::patrol);
}
END_TEST

// Monday 22:00 armed, every day 7:00 disarmed.
static const Schedule kNights{{0x01, 22 * 60, Mode::armed}, {0x7f, 7 * 60, Mode::disarmed}};

constexpr std::int64_t kMonday = 1763942400;  // 2025-11-24 00:00 UTC
constexpr std::int64_t kMinute = 60, kHour = 3600;

static std::int64_t utc_itself(std::int64_t) {
  return 0;
}

START_TEST(the_entry_of_a_schedule_that_took_effect_last_counts) {
  const struct {
    std::int64_t now;
    Mode mode;
    std::int64_t since;
  } cases[] = {
      {22 * kHour, Mode::armed, 22 * kHour},               // Monday 22:00
      {31 * kHour - 1, Mode::armed, 22 * kHour},           // Tuesday 6:59:59
      {31 * kHour, Mode::disarmed, 31 * kHour},            // Tuesday 7:00
      {22 * kHour - kMinute, Mode::disarmed, 7 * kHour},   // Monday 21:59
      {0, Mode::disarmed, -17 * kHour},                    // Monday 0:00: since Sunday 7:00
      {-1 * 24 * kHour + 1, Mode::disarmed, -41 * kHour},  // Sunday 0:00:01: since Saturday 7:00
  };
  for (const auto& one : cases) {
    const std::optional<Due> found = due(kNights, kMonday + one.now, utc_itself);
    ck_assert(found && found->mode == one.mode);
    ck_assert_int_eq(found->utc - kMonday, one.since);
  }
  const Schedule mondays{{0x01, 22 * 60, Mode::armed}};  // Monday 21:59: since 22:00 of the Monday before
  ck_assert_int_eq(due(mondays, kMonday + 22 * kHour - kMinute, utc_itself)->utc - kMonday, -146 * kHour);
  ck_assert(!due({}, kMonday, utc_itself));
}
END_TEST

START_TEST(a_mode_set_by_hand_holds_until_the_next_entry) {
  constexpr std::int64_t kNoon = kMonday + 12 * kHour;
  ModeKeeper keeper(Mode::privacy, kNights);
  ck_assert(keeper.tick(kNoon, utc_itself) && keeper.mode() == Mode::disarmed);
  keeper.set(Mode::privacy, kNoon + 30);
  ck_assert(!keeper.tick(kNoon + kMinute, utc_itself) && keeper.mode() == Mode::privacy);
  ck_assert(!keeper.tick(kNoon + 10 * kHour - 1, utc_itself) && keeper.mode() == Mode::privacy);
  ck_assert(keeper.tick(kNoon + 10 * kHour, utc_itself) && keeper.mode() == Mode::armed);
}
END_TEST

// The machine's time zone, here that of Berlin: summer time begins at 2:00 on the last Sunday of March and ends at 3:00
// on the last Sunday of October.
static std::int64_t berlin(std::int64_t utc) {
  ::setenv("TZ", "CET-1CEST,M3.5.0,M10.5.0/3", 1);  // as Europe/Berlin, without the files of tzdata
  ::tzset();
  const auto seconds = static_cast<time_t>(utc);
  tm parts{};
  ::localtime_r(&seconds, &parts);
  return parts.tm_gmtoff;
}

constexpr std::int64_t kMarch = 1774742400;    // Sunday 2026-03-29 00:00 UTC; 01:00 UTC is 3:00 after 1:59:59
constexpr std::int64_t kOctober = 1792886400;  // Sunday 2026-10-25 00:00 UTC; 01:00 UTC is 2:00 after 2:59:59

START_TEST(a_local_time_that_clocks_skip_is_the_moment_of_the_change) {
  // Wall times are counted as if they were UTC.
  ck_assert_int_eq(moment_of(kMarch + 2 * kHour - 1, berlin), kMarch + kHour - 1);     // 1:59:59
  ck_assert_int_eq(moment_of(kMarch + 2 * kHour, berlin), kMarch + kHour);             // 2:00, skipped
  ck_assert_int_eq(moment_of(kMarch + 150 * kMinute, berlin), kMarch + kHour);         // 2:30, skipped
  ck_assert_int_eq(moment_of(kMarch + 3 * kHour, berlin), kMarch + kHour);             // 3:00
  ck_assert_int_eq(moment_of(kMarch + 210 * kMinute, berlin), kMarch + 90 * kMinute);  // 3:30
  // Of several entries within the hour that is skipped the last one holds, whatever their order.
  const Schedule skipped{{0x7f, 170, Mode::disarmed}, {0x7f, 130, Mode::armed}};
  const std::optional<Due> found = due(skipped, kMarch + kHour, berlin);
  ck_assert(found && found->mode == Mode::disarmed && found->utc == kMarch + kHour);
}
END_TEST

START_TEST(a_local_time_that_clocks_show_twice_counts_the_first_time) {
  ck_assert_int_eq(moment_of(kOctober + 119 * kMinute, berlin), kOctober - kMinute);       // 1:59
  ck_assert_int_eq(moment_of(kOctober + 150 * kMinute, berlin), kOctober + 30 * kMinute);  // 2:30
  ck_assert_int_eq(moment_of(kOctober + 3 * kHour, berlin), kOctober + 2 * kHour);         // 3:00
}
END_TEST

START_TEST(an_entry_of_the_schedule_counts_once_in_each_night_of_the_change) {
  const Schedule at_half_past_two{{0x7f, 150, Mode::armed}};
  for (const std::int64_t night : {kMarch, kOctober}) {
    ModeKeeper keeper(Mode::disarmed, at_half_past_two);
    keeper.set(Mode::disarmed, night - 2 * kHour);
    int changes = 0;
    // From 22:00 UTC to 6:00 UTC, a minute at a time; the owner disarms it a minute after each change.
    for (std::int64_t now = night - 2 * kHour + kMinute; now < night + 6 * kHour; now += kMinute) {
      if (!keeper.tick(now, berlin)) continue;
      ck_assert(keeper.mode() == Mode::armed);
      ck_assert_int_eq(now - night, night == kMarch ? kHour : 30 * kMinute);
      keeper.set(Mode::disarmed, now + 1);
      ++changes;
    }
    ck_assert_int_eq(changes, 1);
  }
}
END_TEST

START_TEST(the_mode_survives_a_restart_and_a_broken_state_is_privacy) {
  ModeKeeper keeper(Mode::armed, {});
  keeper.set(Mode::disarmed, 1763863200);
  ck_assert(keeper.state() == "disarmed 1763863200\n");
  ModeKeeper other(Mode::armed, {});
  ck_assert(other.restore(keeper.state(), 1763863300) && other.mode() == Mode::disarmed);
  for (const char* broken :
       {"", "armed", "armed x\n", "armed 12", "alarmed 12\n", "armed -1\n", "armed 12 \n"}) {
    ModeKeeper wrong(Mode::armed, {});
    ck_assert_msg(!wrong.restore(broken, 1763863200) && wrong.mode() == Mode::privacy, "\"%s\" was taken",
                  broken);
  }
}
END_TEST

START_TEST(a_broken_state_is_privacy_until_the_next_entry_of_the_schedule) {
  constexpr std::int64_t kNoon = kMonday + 12 * kHour;
  ModeKeeper keeper(Mode::armed, kNights);
  ck_assert(!keeper.restore("damaged", kNoon + 5));
  ck_assert(!keeper.tick(kNoon + 5, utc_itself) && keeper.mode() == Mode::privacy);
  ck_assert(keeper.state() == "privacy " + std::to_string(kNoon + 5) + "\n");
  ck_assert(keeper.tick(kNoon + 36000, utc_itself) && keeper.mode() == Mode::armed);
}
END_TEST

std::string assigned(const PipelineText& text, const std::string& element, const std::string& property) {
  std::string found = "(none)";
  for (const Assignment& one : text.assignments)
    if (one.element == element && one.property == property) found = one.value;
  return found;
}

START_TEST(texts_of_the_user_are_assigned_and_never_parsed) {
  const std::string name = "a! fakesink \\\" b.avi";
  const Settings all = settings("[[camera]]\nname = \"c\"\nkind = \"file\"\nfile = '/" + name +
                                "'\n[camera.detection]\nzones = 'x ! y'\n");
  const PipelineText text = pipeline_text(all.cameras[0], {all.page, {}, {}}, {});
  ck_assert(text.line.find("fakesink \\") == std::string::npos &&
            text.line.find("x ! y") == std::string::npos);
  ck_assert(assigned(text, "source", "location") == "/" + name);
  ck_assert(assigned(text, "detect", "zones") == "x ! y");
}
END_TEST

START_TEST(a_part_that_failed_or_is_not_configured_is_left_out) {
  const Settings all =
      settings(kSmallest + "[camera.head]\npan-min = -40\n[camera.recorder]\nfolder = \"rec\"\n");
  const std::string whole = pipeline_text(all.cameras[0], {all.page, {}, {}}, {}).line;
  ck_assert(says(whole, "pantiltsink") && says(whole, "eventrecorder") && says(whole, "jpegenc"));
  PageSettings hidden = all.page;
  hidden.enabled = false;
  const PipelineText less = pipeline_text(all.cameras[0], {hidden, {}, {}}, {false, false});
  for (const char* part : {"pantiltsink", "eventrecorder", "jpegenc"})
    ck_assert_msg(less.line.find(part) == std::string::npos, "%s is in %s", part, less.line.c_str());
  ck_assert(assigned(less, "fusion", "pan-min") == "-40");  // fusion knows the limits all the same
  ck_assert(assigned(less, "head", "pan-min") == "(none)");
}
END_TEST

START_TEST(people_are_found_by_motion_and_shape_unless_the_file_says_otherwise) {
  const auto camera = [](const std::string& more) { return settings(kSmallest + more).cameras.at(0); };
  const auto line = [](const CameraSettings& camera) { return pipeline_text(camera, {}, {}).line; };
  const std::string both = " ! motiondetect name=detect ! personverify name=persons ! pirfusion ";
  const CameraSettings open = camera("");
  ck_assert(open.persons.use == PersonsUse::automatic && open.persons.properties.empty());
  ck_assert(says(line(open), both));
  const CameraSettings set = camera(
      "[camera.persons]\ndetector = \"daimler\"\nrate = 2\ncpu = 0.5\nthreshold = 2\nrequire = \"person\"\n");
  ck_assert(set.persons.use == PersonsUse::always && says(line(set), both));
  const PipelineText text = pipeline_text(set, {}, {});
  ck_assert(assigned(text, "persons", "detector") == "daimler" && assigned(text, "persons", "rate") == "2");
  ck_assert(assigned(text, "persons", "require") == "person" && assigned(text, "persons", "cpu") == "0.5");
  const CameraSettings none = camera("[camera.persons]\nenabled = false\ncpu = 0.5\n");
  ck_assert(none.persons.use == PersonsUse::never);
  ck_assert(says(line(none), " ! motiondetect name=detect ! pirfusion "));
  ck_assert(assigned(pipeline_text(none, {}, {}), "persons", "cpu") == "(none)");
}
END_TEST

START_TEST(a_model_of_people_is_beside_the_configuration_or_among_the_installed_ones) {
  const auto model = [](const std::string& path) {
    const Settings all =
        settings(kSmallest + "[camera.persons]\nmodel = \"" + path + "\"\nlabels = \"names\"\n");
    ck_assert(value(all.cameras[0].persons.properties, "labels") == "/etc/robot/names");
    return value(all.cameras[0].persons.properties, "model");
  };
  ck_assert(model("yolo.weights") == "yolo.weights");
  ck_assert(model("./yolo.weights") == "/etc/robot/./yolo.weights");
  ck_assert(model("/srv/yolo.weights") == "/srv/yolo.weights");
}
END_TEST

START_TEST(what_cannot_be_meant_of_people_is_a_mistake_at_its_line) {
  const auto wrong = [](const std::string& keys) { return errors(kSmallest + "[camera.persons]\n" + keys); };
  ck_assert(says(wrong("detector = \"yolo\"\n"), "r.toml:5: \"detector\""));
  ck_assert(says(wrong("cpu = 2\n"), "r.toml:5: \"cpu\""));
  ck_assert(says(wrong("require = \"car\"\n"), "r.toml:5: \"require\""));
  ck_assert(says(wrong("zones = \"\"\n"), "r.toml:5: "));
  ck_assert(says(wrong("model = \"/m.onnx\"\ndetector = \"hog\"\n"), "r.toml:6: \"detector\" and \"model\""));
  ck_assert(says(wrong("mean = \"3\"\n"), "r.toml:5: \"mean\" is of a \"model\""));
}
END_TEST

START_TEST(each_kind_of_camera_has_its_source_at_the_size_and_rate_that_are_asked_for) {
  const auto text = [](const std::string& keys) {
    const Settings all = settings("[[camera]]\nname = \"c\"\n" + keys);
    return pipeline_text(all.cameras[0], {all.page, {}, {}}, {});
  };
  const std::string size = "width = 640\nheight = 480\nframerate = 30\n";
  const std::string caps = ",width=640,height=480,framerate=30/1 ";
  ck_assert(says(text("kind = \"test\"\n" + size).line,
                 "videotestsrc name=source is-live=true pattern=ball ! video/x-raw" + caps));
  ck_assert(says(text("kind = \"file\"\nfile = \"v.avi\"\n").line, "filesrc name=source ! decodebin"));
  const PipelineText v4l2 = text("kind = \"v4l2\"\ndevice = \"/dev/video2\"\n" + size);
  ck_assert(says(v4l2.line, "v4l2src name=source ! video/x-raw" + caps));
  ck_assert(assigned(v4l2, "source", "device") == "/dev/video2");
  ck_assert(says(text("kind = \"v4l2\"\ndevice = \"/dev/video2\"\nmotion-jpeg = true\n" + size).line,
                 "v4l2src name=source ! image/jpeg" + caps + "! jpegdec name=decoder"));
  const PipelineText board =
      text("kind = \"libcamera\"\ndevice = \"/base/soc/i2c0mux/i2c@1/imx708@1a\"\n" + size);
  ck_assert(says(board.line, "libcamerasrc name=source ! video/x-raw" + caps));
  ck_assert(assigned(board, "source", "camera-name") == "/base/soc/i2c0mux/i2c@1/imx708@1a");
  ck_assert(assigned(text("kind = \"libcamera\"\n"), "source", "camera-name") == "(none)");
  ck_assert(says(errors("[[camera]]\nname = \"c\"\nkind = \"libcamera\"\nuri = \"rtsp://b\"\n"),
                 "r.toml:4: \"uri\" is not for kind = \"libcamera\""));
}
END_TEST

START_TEST(what_a_network_camera_records_is_never_encoded_again) {
  const std::string camera =
      "[[camera]]\nname = \"a\"\nkind = \"rtsp\"\nuri = \"rtsp://b/sub\"\n[camera.recorder]\nfolder = "
      "\"rec\"\n";
  const Settings one = settings(camera);
  const std::string line = pipeline_text(one.cameras[0], {one.page, {}, {}}, {}).line;
  ck_assert(line.find("x264enc") == std::string::npos && says(line, "tee name=encoded"));
  const Settings two = settings(
      "[[camera]]\nname = \"a\"\nkind = \"rtsp\"\nuri = \"rtsp://b/sub\"\nrecord-uri = "
      "\"rtsp://b/main\"\n[camera.recorder]\nfolder = \"rec\"\n");
  const PipelineText text = pipeline_text(two.cameras[0], {two.page, {}, {}}, {});
  ck_assert(assigned(text, "recorded", "location") == "rtsp://b/main");
  ck_assert(assigned(text, "source", "location") == "rtsp://b/sub");
  ck_assert(text.line.find("tee name=encoded") == std::string::npos);
}
END_TEST

// The number of times that a word stands in a text.
std::size_t count(const std::string& text, const std::string& word) {
  std::size_t found = 0;
  for (std::size_t at = 0; (at = text.find(word, at)) != text.npos; at += word.size()) ++found;
  return found;
}

START_TEST(the_rtsp_server_listens_on_loopback_and_serves_both_pictures_unless_asked_otherwise) {
  const Settings all = settings("[rtsp]\n" + kSmallest);
  ck_assert(all.rtsp && all.rtsp->listen == "127.0.0.1" && all.rtsp->port == 8554 && !all.rtsp->tls);
  ck_assert(all.rtsp->plain && all.rtsp->annotated && all.rtsp->users_file.empty());
  ck_assert(!settings(kSmallest).rtsp);
  const Settings other = settings(
      "[rtsp]\nlisten = \"0.0.0.0\"\nusers-file = \"viewers\"\nmounts = [\"annotated\"]\n" + kSmallest);
  ck_assert(other.rtsp->users_file == "/etc/robot/viewers" && !other.rtsp->plain && other.rtsp->annotated);
}
END_TEST

START_TEST(an_encoder_is_named_by_its_element_or_as_in_the_list) {
  for (const auto& [word, element] : {std::pair{"openh264enc", "openh264enc"},
                                      {"openh264", "openh264enc"},
                                      {"vp8", "vp8enc"},
                                      {"jpeg", "jpegenc"},
                                      {"h264", "h264"}}) {
    const Settings all = settings("[rtsp]\nencoder = \"" + std::string(word) + "\"\n" + kSmallest);
    ck_assert_str_eq(all.rtsp->encoder.element.c_str(), element);
  }
}
END_TEST

START_TEST(one_encoder_makes_the_plain_picture_of_the_recorder_and_of_all_clients) {
  const Settings all = settings("[rtsp]\nencoder = \"openh264enc\"\nbitrate = 800\n" + kSmallest +
                                "[camera.recorder]\nfolder = \"rec\"\nbitrate = 3000\n");
  const std::string line = pipeline_text(all.cameras[0], {all.page, {}, all.rtsp, {}}, {}).line;
  ck_assert_uint_eq(count(line, "x264enc"), 1);  // the recorder's
  ck_assert_uint_eq(count(line, "openh264enc"), 1);
  ck_assert(says(line, "bitrate=3000") && says(line, "bitrate=800000"));
  for (const char* sink : {"rtsp-plain ", "rtsp-annotated", "rtsp-metadata", "rtsp-annotated-valve"})
    ck_assert_msg(says(line + ' ', std::string("name=") + sink), "%s: %s", sink, line.c_str());
  // What is recorded goes on without clients.
  ck_assert(line.find("rtsp-plain-valve") == std::string::npos);
  const std::string alone = pipeline_text(all.cameras[0], {all.page, {}, all.rtsp, {}}, {true, false}).line;
  ck_assert(says(alone, "rtsp-plain-valve"));
  // The recorder's frames wait for a slow encoder; those that are only watched do not.
  ck_assert(says(line, "name=encode-queue leaky=downstream max-size-buffers=0 "));
  ck_assert(says(alone, "name=encode-queue leaky=downstream max-size-buffers=2 "));
  ck_assert(pipeline_text(all.cameras[0], {all.page, {}, {}, {}}, {}).line.find("rtsp-") ==
            std::string::npos);
}
END_TEST

START_TEST(another_configuration_is_the_properties_that_differ_or_another_pipeline) {
  const auto text = [](const std::string& more) {
    const Settings all = settings(kSmallest + more);
    return pipeline_text(all.cameras[0], {all.page, {}, {}}, {});
  };
  const std::string zones = "[camera.detection]\nzones = 'x'\nminimum-area = 20\n";
  ck_assert(changes(text(zones), text(zones)).value().empty());

  const auto other = changes(text(zones), text("[camera.detection]\nzones = 'y'\nminimum-area = 20\n"));
  ck_assert(other && other->size() == 1);
  ck_assert(other->at(0).element == "detect" && other->at(0).property == "zones" &&
            other->at(0).value == "y");

  const auto fewer = changes(text(zones), text("[camera.detection]\nminimum-area = 20\n"));
  ck_assert(fewer && fewer->size() == 1 && fewer->at(0).property == "zones" && !fewer->at(0).value);

  ck_assert(!changes(text(zones), text(zones + "[camera.head]\n")));  // an element more
}
END_TEST

START_TEST(what_a_camera_or_a_part_leaves_at_the_broker_is_known_when_it_leaves) {
  Settings settings;
  settings.mqtt = Properties{{"host", "broker"}, {"discovery-prefix", "homeassistant"}};
  CameraSettings front, back;
  front.name = "front";
  front.head = Properties{};
  front.sensors = Properties{{"bearings", "0,90"}};
  back.name = "back";
  settings.cameras = {front, back};
  const Topics all = retained_topics(settings);
  ck_assert(all.contains("cerberus/back/state") && all.contains("cerberus/front/pantilt"));
  ck_assert(all.contains("homeassistant/binary_sensor/cerberus_front/pir_1/config"));
  ck_assert(!all.contains("homeassistant/binary_sensor/cerberus_front/pir_2/config"));
  settings.cameras = {front};
  settings.cameras[0].head.reset();
  const Topics left = retained_topics(settings);
  for (const std::string& topic : all) {
    const bool leaves = topic.find("back") != topic.npos || topic.find("pan") != topic.npos ||
                        topic.find("tilt") != topic.npos;
    ck_assert_msg(left.contains(topic) != leaves, "%s", topic.c_str());
  }
  settings.mqtt.reset();
  ck_assert(retained_topics(settings).empty());
}
END_TEST

START_TEST(another_broker_leaves_all_topics_at_the_one_before_and_none_that_is_the_same) {
  Settings settings;
  settings.mqtt = Properties{{"host", "old"}, {"username", "x y"}, {"discovery-prefix", "homeassistant"}};
  settings.cameras.resize(1);
  settings.cameras[0].name = "front";
  const Topics topics = retained_topics(settings);
  // As an older version wrote it: of the broker in the file.
  std::vector<LeftTopics> all = with_present(left_topics_of("a\n\nb\n"), settings);
  ck_assert_uint_eq(all.size(), 1);
  ck_assert(all[0].broker == (Properties{{"host", "old"}, {"username", "x y"}}));
  std::vector<LeftTopics> retired = retired_topics(all, settings);
  ck_assert(retired.size() == 1 && retired[0].topics == (Topics{"a", "b"}));
  // What is written is read again.
  const std::string text = text_of(all);
  ck_assert(text_of(left_topics_of(text)) == text && left_topics_of("").empty());
  ck_assert(left_topics_of("\tbroker\thost\t\n\tbrokerage\nx").size() == 2);
  // The same broker by the port that it has anyway, and by another name of the user.
  settings.mqtt = Properties{{"host", "old"}, {"port", "1883"}, {"discovery-prefix", "homeassistant"}};
  ck_assert_uint_eq(with_present(all, settings).size(), 1);
  settings.mqtt = Properties{{"host", "new"}, {"discovery-prefix", "homeassistant"}};
  all = with_present(all, settings);
  ck_assert_uint_eq(all.size(), 2);
  retired = retired_topics(all, settings);
  ck_assert_uint_eq(retired.size(), 1);
  ck_assert(retired[0].broker == (Properties{{"host", "old"}, {"username", "x y"}}));
  Topics everything = topics;
  everything.insert({"a", "b"});
  ck_assert(retired[0].topics == everything);
  settings.mqtt.reset();
  ck_assert_uint_eq(retired_topics(with_present(all, settings), settings).size(), 2);
}
END_TEST

START_TEST(a_part_is_tried_again_after_1_2_4_to_60_seconds_and_after_a_sound_minute_after_1) {
  using std::chrono::seconds;
  Backoff backoff;
  Backoff::Time now{};
  for (const int expected : {1, 2, 4, 8, 16, 32, 60, 60}) {
    const Backoff::Duration wait = backoff.failed(now);
    ck_assert_int_eq(std::chrono::duration_cast<seconds>(wait).count(), expected);
    ck_assert(!backoff.is_due(now + wait - seconds(1)) && backoff.is_due(now + wait));
    now += wait;
  }
  ck_assert_int_eq(std::chrono::duration_cast<seconds>(backoff.failed(now + seconds(59))).count(), 60);
  ck_assert_int_eq(std::chrono::duration_cast<seconds>(backoff.failed(now + seconds(200))).count(), 1);
}
END_TEST

int main() {
  return cerberus::tests::run_suite(
      "robot settings", {the_smallest_file_has_one_camera_and_a_page_on_loopback,
                         two_heads_share_a_chip_but_no_line_and_no_channel,
                         a_whole_file_becomes_typed_settings,
                         every_mistake_is_reported_with_its_line,
                         a_move_by_mqtt_ends_after_a_minute_or_as_configured,
                         all_mistakes_come_at_once_in_the_order_of_their_lines,
                         files_that_are_named_must_be_there_and_secrets_be_secret,
                         a_secret_may_be_a_credential_of_systemd,
                         a_list_of_users_is_read_and_a_file_that_was_written_anew_is_noticed,
                         a_secret_is_the_first_line_of_its_file,
                         the_examples_of_the_manual_and_the_demo_are_sound,
                         the_entry_of_a_schedule_that_took_effect_last_counts,
                         a_mode_set_by_hand_holds_until_the_next_entry,
                         a_local_time_that_clocks_skip_is_the_moment_of_the_change,
                         a_local_time_that_clocks_show_twice_counts_the_first_time,
                         an_entry_of_the_schedule_counts_once_in_each_night_of_the_change,
                         the_mode_survives_a_restart_and_a_broken_state_is_privacy,
                         a_broken_state_is_privacy_until_the_next_entry_of_the_schedule,
                         texts_of_the_user_are_assigned_and_never_parsed,
                         a_part_that_failed_or_is_not_configured_is_left_out,
                         people_are_found_by_motion_and_shape_unless_the_file_says_otherwise,
                         a_model_of_people_is_beside_the_configuration_or_among_the_installed_ones,
                         what_cannot_be_meant_of_people_is_a_mistake_at_its_line,
                         each_kind_of_camera_has_its_source_at_the_size_and_rate_that_are_asked_for,
                         what_a_network_camera_records_is_never_encoded_again,
                         the_rtsp_server_listens_on_loopback_and_serves_both_pictures_unless_asked_otherwise,
                         an_encoder_is_named_by_its_element_or_as_in_the_list,
                         one_encoder_makes_the_plain_picture_of_the_recorder_and_of_all_clients,
                         another_configuration_is_the_properties_that_differ_or_another_pipeline,
                         what_a_camera_or_a_part_leaves_at_the_broker_is_known_when_it_leaves,
                         another_broker_leaves_all_topics_at_the_one_before_and_none_that_is_the_same,
                         a_part_is_tried_again_after_1_2_4_to_60_seconds_and_after_a_sound_minute_after_1});
}
