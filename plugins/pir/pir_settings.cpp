// SPDX-License-Identifier: LGPL-2.1-or-later
#include "pir_settings.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/helper/option_words.h"
#include "shared/pir_caps.hpp"
#include "shared/pir_presets.hpp"
#include "text/numbers.h"

namespace cerberus::plugin {

using drivers::comma_list;

namespace {

GType preset_type() {
  static const GType type = register_pir_presets("CerberusPirPreset");
  return type;
}

GType bias_type() {
  using drivers::LineBias;
  static const GEnumValue values[] = {
      {static_cast<int>(LineBias::as_is), "As the kernel or the firmware left it", "as-is"},
      {static_cast<int>(LineBias::none), "No resistor", "none"},
      {static_cast<int>(LineBias::pull_up), "A resistor to the supply: for open collector modules",
       "pull-up"},
      {static_cast<int>(LineBias::pull_down), "A resistor to ground", "pull-down"},
      {0, nullptr, nullptr}};
  static const GType type = g_enum_register_static("CerberusPirBias", values);
  return type;
}

using S = PirSettings;
constexpr double kVolts = 1000;

const Property<PirSettings> kProperties[] = {
    property(
        "driver", &S::driver,
        "Where the readings come from: gpio (lines of a GPIO chip), iio (an A/D converter), evdev (an input "
        "device), external (a program or a microcontroller), replay (a file), scripted (the script property, "
        "for tests)"),
    property(
        "bearings", &S::bearings,
        "Where each sensor looks: degrees, separated by commas, 0 ahead, positive to the right. As many as "
        "there are sensors, 1 to 16"),
    property("field-of-view", &S::field_of_view, 0.1, 360, "Angle in degrees that each sensor sees"),
    property(
        "range", &S::range, 0, 100,
        "How far each sensor sees a person, metres: the caps say it, and a page's radar shows it; 0 = not "
        "known"),
    property("heartbeat", &S::heartbeat,
             "Nanoseconds between buffers when nothing changes, at least 1 ms; a change is sent at once in "
             "any case"),
    property(
        "is-live", &S::is_live,
        "Play replay and scripted readings in real time, as a live source; the other drivers are live in "
        "any case"),
    property("preset", &S::preset, preset_type,
             "The sensor module: sets active-low, warm-up, field-of-view and range. A property that was set "
             "itself "
             "wins"),
    property("active-low", &S::active_low, "A line is low while its sensor detects (open collector)"),
    property("retrigger", &S::retrigger, "A new pulse during hold extends it"),
    property("min-pulse", &S::min_pulse,
             "Nanoseconds that a line must be active before a detection begins: shorter pulses are "
             "interference and ignored; 0 = every pulse counts, at once"),
    property("debounce", &S::debounce,
             "Nanoseconds that a line must be quiet before a detection ends, up to 50 ms; 0 = at once"),
    property("hold", &S::hold,
             "Least duration of a detection in nanoseconds; 0 = as long as the line is active"),
    property("block-time", &S::block_time,
             "Nanoseconds after a detection in which nothing triggers; 0 = none"),
    property("warm-up", &S::warm_up, "Nanoseconds after the start in which readings are invalid; 0 = none"),
    property("stuck-after", &S::stuck_after,
             "Nanoseconds of a line that never rests after which its sensor counts as stuck: a warning, and "
             "invalid "
             "readings until it rests; 0 = never"),
    property(
        "chatter-edges", &S::chatter_edges, 0, 256,
        "So many pulses within chatter-window mean that a sensor chatters: a warning, and invalid readings "
        "until it calms down; 0 = never"),
    property("chatter-window", &S::chatter_window, "Nanoseconds in which chatter-edges are counted"),
    property("chip", &S::chip, "gpio: the chip's path, name, number or label"),
    property("lines", &S::lines, "gpio: a line for each sensor, by name or offset, separated by commas"),
    property("leds-red", &S::leds_red,
             "gpio: an output line for each sensor, high while it detects; empty = no such LEDs"),
    property("leds-blue", &S::leds_blue,
             "gpio: an output line for each sensor, high while it does not detect; empty = no such LEDs"),
    property("bias", &S::bias, bias_type, "gpio: the resistor inside the chip on the sensors' lines"),
    property(
        "device", &S::device,
        "evdev: path (/dev/input/event3) or name of the input device; external: serial:/dev/ttyUSB0, or the "
        "path of a FIFO"),
    property("codes", &S::codes,
             "evdev: a key or switch for each sensor, as key:30, switch:11 or BTN_0, separated by commas"),
    property("command", &S::command,
             "external: a program, run by /bin/sh, that writes a line at each change"),
    property(
        "device-options", &S::device_options,
        "external: 'baud=115200 silence=3 volts': of the serial port; seconds without a line after which "
        "readings are invalid, 0 = never; the lines contain volts"),
    property("iio-device", &S::iio_device, "iio: the converter's name or id"),
    property("channels", &S::channels,
             "iio: the number of a voltage channel for each sensor, separated by commas"),
    property("threshold", &S::threshold, -kVolts, kVolts,
             "Volts between low and high, where volts are measured: iio, external, recordings in volts"),
    property("hysteresis", &S::hysteresis, 0, kVolts,
             "Volts between switching to high and switching to low, threshold in the middle; 0 = none"),
    property("sample-interval", &S::sample_interval, "iio: nanoseconds between samples, at least 1 ms"),
    property("location", &S::location,
             "replay: the file, lines of seconds,level,level,... or JSON lines with time (or pts) and pir; a "
             "level "
             "may be volts (1.7V; volts in JSON)"),
    property("script", &S::script, "scripted: lines as in a replayed file, separated by semicolons"),
    property("camera-name", &S::camera_name,
             "Name of the camera that the sensors belong to, for messages; empty = none"),
};

guint id_of(std::string_view name) {
  const auto found = std::ranges::find(kProperties, name, &Property<PirSettings>::name);
  return static_cast<guint>(found - std::begin(kProperties)) + 1;
}

}  // namespace

std::span<const Property<PirSettings>> pir_properties() {
  return kProperties;
}

bool is_preset_property(guint id) {
  return id == id_of("preset");
}

void apply_preset(PirSettings& settings, const PirChosen& chosen) {
  const PirSettings defaults;
  const sensing::PirPreset* preset = pir_preset(settings.preset);
  if (!chosen[id_of("active-low")])
    settings.active_low = preset ? preset->options.active_low : defaults.active_low;
  if (!chosen[id_of("warm-up")])
    settings.warm_up = preset ? clock_time(preset->options.warm_up) : defaults.warm_up;
  if (!chosen[id_of("range")]) settings.range = preset ? preset->range : defaults.range;
  if (!chosen[id_of("field-of-view")])  // rounded: not 119.99999999999999
    settings.field_of_view =
        preset ? text::round_to(sensing::degrees(preset->field_of_view), 6) : defaults.field_of_view;
}

std::string pir_info(const PirSettings& settings, CerberusPirInfo& info) {
  return pir_info(settings.bearings, settings.field_of_view, info);
}

drivers::SensorSetup sensor_setup(const PirSettings& settings, guint sensors) {
  drivers::SensorSetup setup;
  setup.sensors = static_cast<int>(sensors);
  setup.chip = settings.chip;
  setup.lines = comma_list(settings.lines);
  setup.red = comma_list(settings.leds_red);
  setup.blue = comma_list(settings.leds_blue);
  setup.bias = static_cast<drivers::LineBias>(settings.bias);
  setup.device = settings.driver == "iio" ? settings.iio_device : settings.device;
  setup.codes = comma_list(settings.codes);
  setup.command = settings.command;
  setup.options = settings.device_options;
  setup.channels = comma_list(settings.channels);
  setup.level = {settings.threshold, settings.hysteresis};
  setup.interval = std::max(time_of(settings.sample_interval), sensing::Time(std::chrono::milliseconds(1)));
  setup.location = settings.location;
  setup.script = settings.script;
  return setup;
}

sensing::PirOptions pir_options(const PirSettings& settings) {
  sensing::PirOptions options;
  options.active_low = settings.active_low;
  options.retrigger = settings.retrigger;
  options.min_pulse = time_of(settings.min_pulse);
  options.debounce = time_of(settings.debounce);
  options.hold = time_of(settings.hold);
  options.block = time_of(settings.block_time);
  options.warm_up = time_of(settings.warm_up);
  options.stuck_after = time_of(settings.stuck_after);
  options.chatter_edges = static_cast<unsigned>(settings.chatter_edges);
  options.chatter_window = time_of(settings.chatter_window);
  return options;
}

}  // namespace cerberus::plugin
