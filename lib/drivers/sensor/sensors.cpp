// SPDX-License-Identifier: LGPL-2.1-or-later
// The table of sensor drivers. Those that need a library are in it also where the build has none.
#include <algorithm>
#include <array>

#include "drivers/evdev/evdev_sensor.h"
#include "drivers/external/external_sensor.h"
#include "drivers/recorded/replay_sensor.h"
#include "drivers/recorded/scripted_sensor.h"
#include "drivers/sensor/sensor.h"
#if HAVE_GPIOD
#include "drivers/gpio/gpio_sensor.h"
#endif
#if HAVE_IIO
#include "drivers/iio/iio_sensor.h"
#endif

namespace cerberus::drivers {

namespace {

class MissingSensor final : public Sensor {
 public:
  explicit MissingSensor(std::string library) : library_(std::move(library)) {}
  SensorError open(const SensorSetup&) override {
    return {SensorFault::missing,
            "This build cannot use such sensors: it was made without " + library_ + ". Install " + library_ +
                "'s development package and build again.",
            ""};
  }
  void close() noexcept override {}
  void stop() noexcept override {}
  SensorError read(Time, std::vector<SensorEdge>&) override { return open({}); }
  std::string place(int) const override { return library_; }

 private:
  std::string library_;
};

template <typename T>
std::unique_ptr<Sensor> make() {
  return std::make_unique<T>();
}

struct Driver {
  std::string_view name;
  bool device;
  std::unique_ptr<Sensor> (*make)();
};

constexpr std::array<Driver, 6> kDrivers{{
    {"evdev", true, make<EvdevSensor>},
    {"external", true, make<ExternalSensor>},
#if HAVE_GPIOD
    {"gpio", true, make<GpioSensor>},
#else
    {"gpio", true, [] { return std::unique_ptr<Sensor>(new MissingSensor("libgpiod")); }},
#endif
#if HAVE_IIO
    {"iio", true, make<IioSensor>},
#else
    {"iio", true, [] { return std::unique_ptr<Sensor>(new MissingSensor("libiio")); }},
#endif
    {"replay", false, make<ReplaySensor>},
    {"scripted", false, make<ScriptedSensor>},
}};

const Driver* find(std::string_view name) {
  const auto found = std::ranges::find(kDrivers, name, &Driver::name);
  return found == kDrivers.end() ? nullptr : &*found;
}

}  // namespace

std::unique_ptr<Sensor> make_sensor(std::string_view driver) {
  const Driver* found = find(driver);
  return found ? found->make() : nullptr;
}

bool is_device(std::string_view driver) {
  const Driver* found = find(driver);
  return found && found->device;
}

std::string sensor_drivers() {
  std::string names;
  for (const Driver& driver : kDrivers) names.append(names.empty() ? "" : ", ").append(driver.name);
  return names;
}

}  // namespace cerberus::drivers
