// SPDX-License-Identifier: LGPL-2.1-or-later
// libgpiod 1.6: each line with events has a file descriptor of its own; an epoll holds them all.
#include <gpiod.h>
#include <poll.h>
#include <sys/epoll.h>
#include <unistd.h>
#include <cerrno>

#include "drivers/gpio/gpio_lines.h"

namespace cerberus::drivers {

namespace {

constexpr char kConsumer[] = "cerberus";
constexpr unsigned kBatch = 16;  // as many events as the kernel keeps for a line

int flags_of(LineBias bias) {
  switch (bias) {
    case LineBias::as_is:
      break;
    case LineBias::none:
      return GPIOD_LINE_REQUEST_FLAG_BIAS_DISABLE;
    case LineBias::pull_up:
      return GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP;
    case LineBias::pull_down:
      return GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN;
  }
  return 0;
}

int last_error() {
  return errno ? errno : EIO;
}

bool readable(int fd) {
  pollfd waiting{fd, POLLIN, 0};
  return ::poll(&waiting, 1, 0) > 0 &&
         waiting.revents != 0;  // a removed chip also wakes poll; reading then returns the error
}

}  // namespace

struct GpioLines::Handles {
  gpiod_chip* chip = nullptr;
  std::vector<gpiod_line*> inputs, outputs;
  int epoll = -1;

  int take(std::vector<gpiod_line*>& lines, std::span<const unsigned> offsets,
           const gpiod_line_request_config& config, const std::vector<bool>& initial = {}) {
    for (std::size_t i = 0; i < offsets.size(); ++i) {
      gpiod_line* line = gpiod_chip_get_line(chip, offsets[i]);
      const int level = i < initial.size() && initial[i];
      if (!line || gpiod_line_request(line, &config, level) != 0) return last_error();
      lines.push_back(line);
    }
    return 0;
  }
};

GpioLines::GpioLines() : handles_(std::make_unique<Handles>()) {}
GpioLines::~GpioLines() {
  close();
}

int GpioLines::open(const std::string& path) {
  close();
  errno = 0;
  handles_->chip = gpiod_chip_open(path.c_str());
  return handles_->chip ? 0 : last_error();
}

void GpioLines::close() noexcept {
  for (auto* lines : {&handles_->inputs, &handles_->outputs}) {
    for (gpiod_line* line : *lines) gpiod_line_release(line);
    lines->clear();
  }
  if (handles_->epoll >= 0) ::close(handles_->epoll);
  handles_->epoll = -1;
  if (handles_->chip) gpiod_chip_close(handles_->chip);
  handles_->chip = nullptr;
}

std::string GpioLines::name() const {
  return handles_->chip ? gpiod_chip_name(handles_->chip) : "";
}

std::string GpioLines::label() const {
  return handles_->chip ? gpiod_chip_label(handles_->chip) : "";
}

unsigned GpioLines::count() const {
  return handles_->chip ? gpiod_chip_num_lines(handles_->chip) : 0;
}

int GpioLines::find(const std::string& line) const {
  gpiod_line* found = gpiod_chip_find_line(handles_->chip, line.c_str());
  return found ? static_cast<int>(gpiod_line_offset(found)) : -1;
}

std::string GpioLines::user(unsigned offset) const {
  gpiod_line* line = gpiod_chip_get_line(handles_->chip, offset);
  const char* user = line ? gpiod_line_consumer(line) : nullptr;
  return user ? user : "";
}

int GpioLines::request_inputs(std::span<const unsigned> offsets, LineBias bias) {
  Handles& h = *handles_;
  const gpiod_line_request_config config{kConsumer, GPIOD_LINE_REQUEST_EVENT_BOTH_EDGES, flags_of(bias)};
  errno = 0;
  h.epoll = ::epoll_create1(EPOLL_CLOEXEC);
  if (h.epoll < 0) return last_error();
  if (const int error = h.take(h.inputs, offsets, config)) return error;
  for (gpiod_line* line : h.inputs) {
    epoll_event wanted{};
    wanted.events = EPOLLIN | EPOLLPRI;
    if (::epoll_ctl(h.epoll, EPOLL_CTL_ADD, gpiod_line_event_get_fd(line), &wanted) != 0) return last_error();
  }
  return 0;
}

int GpioLines::request_outputs(std::span<const unsigned> offsets, const std::vector<bool>& initial) {
  const gpiod_line_request_config config{kConsumer, GPIOD_LINE_REQUEST_DIRECTION_OUTPUT, 0};
  errno = 0;
  return handles_->take(handles_->outputs, offsets, config, initial);
}

int GpioLines::fd() const {
  return handles_->epoll;
}

int GpioLines::read(std::vector<GpioEdge>& edges) {
  gpiod_line_event events[kBatch];
  for (std::size_t i = 0; i < handles_->inputs.size(); ++i) {
    const int fd = gpiod_line_event_get_fd(handles_->inputs[i]);
    if (!readable(fd)) continue;
    errno = 0;
    const int got = gpiod_line_event_read_fd_multiple(fd, events, kBatch);
    if (got < 0) return last_error();
    for (int k = 0; k < got; ++k)
      edges.push_back({std::chrono::seconds(events[k].ts.tv_sec) + Time(events[k].ts.tv_nsec), i,
                       events[k].event_type == GPIOD_LINE_EVENT_RISING_EDGE});
  }
  return 0;
}

int GpioLines::levels(std::vector<bool>& levels) {
  levels.clear();
  errno = 0;
  for (gpiod_line* line : handles_->inputs) {
    const int value = gpiod_line_get_value(line);
    if (value < 0) return last_error();
    levels.push_back(value != 0);
  }
  return 0;
}

int GpioLines::set(const std::vector<bool>& levels) {
  errno = 0;
  for (std::size_t i = 0; i < handles_->outputs.size() && i < levels.size(); ++i)
    if (gpiod_line_set_value(handles_->outputs[i], levels[i]) != 0) return last_error();
  return 0;
}

int GpioLines::set(std::size_t output, bool level) noexcept {
  errno = 0;
  if (output >= handles_->outputs.size()) return EINVAL;
  return gpiod_line_set_value(handles_->outputs[output], level) == 0 ? 0 : last_error();
}

int GpioLines::level(std::size_t input, bool& level) noexcept {
  errno = 0;
  if (input >= handles_->inputs.size()) return EINVAL;
  const int value = gpiod_line_get_value(handles_->inputs[input]);
  if (value < 0) return last_error();
  level = value != 0;
  return 0;
}

int GpioLines::probe() noexcept {
  const Handles& h = *handles_;
  errno = 0;
  if (h.outputs.empty() && h.inputs.empty()) return EINVAL;
  gpiod_line* line = h.outputs.empty() ? h.inputs.front() : h.outputs.front();
  return gpiod_line_get_value(line) < 0 ? last_error() : 0;
}

}  // namespace cerberus::drivers
