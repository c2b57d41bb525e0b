// SPDX-License-Identifier: LGPL-2.1-or-later
// libgpiod 2.x: one request, and one file descriptor, for all lines of a kind.
#include <gpiod.h>
#include <poll.h>
#include <algorithm>
#include <cerrno>

#include "drivers/gpio/gpio_lines.h"

namespace cerberus::drivers {

namespace {

constexpr char kConsumer[] = "cerberus";
constexpr std::size_t kBatch = 64;  // edges taken at once

gpiod_line_bias bias_of(LineBias bias) {
  switch (bias) {
    case LineBias::as_is:
      break;
    case LineBias::none:
      return GPIOD_LINE_BIAS_DISABLED;
    case LineBias::pull_up:
      return GPIOD_LINE_BIAS_PULL_UP;
    case LineBias::pull_down:
      return GPIOD_LINE_BIAS_PULL_DOWN;
  }
  return GPIOD_LINE_BIAS_AS_IS;
}

int last_error() {
  return errno ? errno : EIO;
}

// libgpiod's objects, each freed by its own function.
template <typename T, void (*Free)(T*)>
struct Freed {
  void operator()(T* object) const { Free(object); }
};
template <typename T, void (*Free)(T*)>
using Owned = std::unique_ptr<T, Freed<T, Free>>;
using Chip = Owned<gpiod_chip, gpiod_chip_close>;
using ChipInfo = Owned<gpiod_chip_info, gpiod_chip_info_free>;
using LineInfo = Owned<gpiod_line_info, gpiod_line_info_free>;
using Settings = Owned<gpiod_line_settings, gpiod_line_settings_free>;
using LineConfig = Owned<gpiod_line_config, gpiod_line_config_free>;
using RequestConfig = Owned<gpiod_request_config, gpiod_request_config_free>;
using Request = Owned<gpiod_line_request, gpiod_line_request_release>;
using EdgeBuffer = Owned<gpiod_edge_event_buffer, gpiod_edge_event_buffer_free>;

// levels: of outputs, one a line; empty: as `settings` says.
int request_lines(gpiod_chip* chip, std::span<const unsigned> offsets, gpiod_line_settings* settings,
                  std::span<const gpiod_line_value> levels, Request& request) {
  const LineConfig lines(gpiod_line_config_new());
  const RequestConfig config(gpiod_request_config_new());
  if (!lines || !config) return ENOMEM;
  gpiod_request_config_set_consumer(config.get(), kConsumer);
  if (gpiod_line_config_add_line_settings(lines.get(), offsets.data(), offsets.size(), settings) != 0)
    return last_error();
  if (!levels.empty() && gpiod_line_config_set_output_values(lines.get(), levels.data(), levels.size()) != 0)
    return last_error();
  request.reset(gpiod_chip_request_lines(chip, config.get(), lines.get()));
  return request ? 0 : last_error();
}

}  // namespace

struct GpioLines::Handles {
  Chip chip;
  ChipInfo info;
  Request inputs, outputs;
  EdgeBuffer buffer;
  std::vector<unsigned> offsets, out;         // of the inputs; of the outputs
  std::vector<gpiod_line_value> values, lit;  // of the inputs; of the outputs
};

GpioLines::GpioLines() : handles_(std::make_unique<Handles>()) {}
GpioLines::~GpioLines() = default;

int GpioLines::open(const std::string& path) {
  close();
  errno = 0;
  handles_->chip.reset(gpiod_chip_open(path.c_str()));
  if (handles_->chip) handles_->info.reset(gpiod_chip_get_info(handles_->chip.get()));
  return handles_->info ? 0 : last_error();
}

void GpioLines::close() noexcept {
  Handles& h = *handles_;
  h.inputs.reset();
  h.outputs.reset();
  h.info.reset();
  h.chip.reset();
}

std::string GpioLines::name() const {
  return handles_->info ? gpiod_chip_info_get_name(handles_->info.get()) : "";
}

std::string GpioLines::label() const {
  return handles_->info ? gpiod_chip_info_get_label(handles_->info.get()) : "";
}

unsigned GpioLines::count() const {
  return handles_->info ? static_cast<unsigned>(gpiod_chip_info_get_num_lines(handles_->info.get())) : 0;
}

int GpioLines::find(const std::string& line) const {
  return gpiod_chip_get_line_offset_from_name(handles_->chip.get(), line.c_str());
}

std::string GpioLines::user(unsigned offset) const {
  const LineInfo info(gpiod_chip_get_line_info(handles_->chip.get(), offset));
  const char* user = info ? gpiod_line_info_get_consumer(info.get()) : nullptr;
  return user ? user : "";
}

int GpioLines::request_inputs(std::span<const unsigned> offsets, LineBias bias) {
  Handles& h = *handles_;
  errno = 0;
  const Settings settings(gpiod_line_settings_new());
  h.buffer.reset(gpiod_edge_event_buffer_new(kBatch));
  if (!settings || !h.buffer) return ENOMEM;
  gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_INPUT);
  gpiod_line_settings_set_edge_detection(settings.get(), GPIOD_LINE_EDGE_BOTH);
  gpiod_line_settings_set_event_clock(settings.get(), GPIOD_LINE_CLOCK_MONOTONIC);
  gpiod_line_settings_set_bias(settings.get(), bias_of(bias));
  h.offsets.assign(offsets.begin(), offsets.end());
  h.values.resize(offsets.size());
  return request_lines(h.chip.get(), offsets, settings.get(), {}, h.inputs);
}

int GpioLines::request_outputs(std::span<const unsigned> offsets, const std::vector<bool>& initial) {
  Handles& h = *handles_;
  errno = 0;
  const Settings settings(gpiod_line_settings_new());
  if (!settings) return ENOMEM;
  gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_OUTPUT);
  gpiod_line_settings_set_output_value(settings.get(), GPIOD_LINE_VALUE_INACTIVE);
  h.out.assign(offsets.begin(), offsets.end());
  h.lit.assign(offsets.size(), GPIOD_LINE_VALUE_INACTIVE);
  for (std::size_t i = 0; i < std::min(initial.size(), h.lit.size()); ++i)
    if (initial[i]) h.lit[i] = GPIOD_LINE_VALUE_ACTIVE;
  return request_lines(h.chip.get(), offsets, settings.get(), h.lit, h.outputs);
}

int GpioLines::fd() const {
  return handles_->inputs ? gpiod_line_request_get_fd(handles_->inputs.get()) : -1;
}

int GpioLines::read(std::vector<GpioEdge>& edges) {
  Handles& h = *handles_;
  pollfd waiting{fd(), POLLIN, 0};
  if (::poll(&waiting, 1, 0) <= 0 || waiting.revents == 0) return 0;
  errno = 0;
  const int got = gpiod_line_request_read_edge_events(h.inputs.get(), h.buffer.get(), kBatch);
  if (got < 0) return last_error();
  for (int k = 0; k < got; ++k) {
    gpiod_edge_event* event =
        gpiod_edge_event_buffer_get_event(h.buffer.get(), static_cast<unsigned long>(k));
    const auto line = std::ranges::find(h.offsets, gpiod_edge_event_get_line_offset(event));
    edges.push_back({Time(gpiod_edge_event_get_timestamp_ns(event)),
                     static_cast<std::size_t>(line - h.offsets.begin()),
                     gpiod_edge_event_get_event_type(event) == GPIOD_EDGE_EVENT_RISING_EDGE});
  }
  return 0;
}

int GpioLines::levels(std::vector<bool>& levels) {
  Handles& h = *handles_;
  errno = 0;
  if (gpiod_line_request_get_values(h.inputs.get(), h.values.data()) != 0) return last_error();
  levels.clear();
  for (const gpiod_line_value value : h.values) levels.push_back(value == GPIOD_LINE_VALUE_ACTIVE);
  return 0;
}

int GpioLines::set(const std::vector<bool>& levels) {
  if (!handles_->outputs) return 0;
  auto& lit = handles_->lit;
  if (levels.size() != lit.size()) return EINVAL;
  for (std::size_t i = 0; i < lit.size(); ++i)
    lit[i] = levels[i] ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
  errno = 0;
  return gpiod_line_request_set_values(handles_->outputs.get(), lit.data()) == 0 ? 0 : last_error();
}

int GpioLines::set(std::size_t output, bool level) noexcept {
  Handles& h = *handles_;
  if (!h.outputs || output >= h.out.size()) return EINVAL;
  h.lit[output] = level ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE;
  errno = 0;
  return gpiod_line_request_set_value(h.outputs.get(), h.out[output], h.lit[output]) == 0 ? 0 : last_error();
}

int GpioLines::level(std::size_t input, bool& level) noexcept {
  Handles& h = *handles_;
  if (!h.inputs || input >= h.offsets.size()) return EINVAL;
  errno = 0;
  const gpiod_line_value value = gpiod_line_request_get_value(h.inputs.get(), h.offsets[input]);
  if (value == GPIOD_LINE_VALUE_ERROR) return last_error();
  level = value == GPIOD_LINE_VALUE_ACTIVE;
  return 0;
}

int GpioLines::probe() noexcept {
  Handles& h = *handles_;
  errno = 0;
  if (h.outputs && !h.out.empty())
    return gpiod_line_request_get_value(h.outputs.get(), h.out.front()) == GPIOD_LINE_VALUE_ERROR
               ? last_error()
               : 0;
  bool level = false;
  return this->level(0, level);
}

}  // namespace cerberus::drivers
