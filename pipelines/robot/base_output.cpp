// SPDX-License-Identifier: LGPL-2.1-or-later
#include "base_output.h"

#include <gio/gunixoutputstream.h>
#include <glib-unix.h>
#include <sys/ioctl.h>

#include <algorithm>
#include <utility>

namespace cerberus::robot {

namespace {

constexpr guint kInterval = 50;  // ms, half of the time between two lines
// Bytes of lines that may be unread: those of 1.5 s. The pipe itself would hold them for minutes.
constexpr int kMostUnread = 256;

BaseDrive::Time now() {
  return std::chrono::steady_clock::now();
}

}  // namespace

BaseOutput::~BaseOutput() {
  if (timer_ != 0) g_source_remove(timer_);
  close();
}

// The end of its input stops the base, whatever the program was doing.
void BaseOutput::close() {
  if (program_ == nullptr) return;
  g_output_stream_close(input_, nullptr, nullptr);
  input_ = nullptr;
  g_clear_object(&program_);
}

void BaseOutput::start() {
  gchar** words = nullptr;
  g_autoptr(GError) error = nullptr;
  if (g_shell_parse_argv(settings_.command.c_str(), nullptr, &words, &error))
    program_ = g_subprocess_newv(words, G_SUBPROCESS_FLAGS_STDIN_PIPE, &error);
  g_strfreev(words);
  if (program_ == nullptr) {
    backoff_.failed(now());
    g_printerr("cerberusd: the base's program does not start: %s\n", error->message);
    return;
  }
  input_ = g_subprocess_get_stdin_pipe(program_);
  g_unix_set_fd_nonblocking(g_unix_output_stream_get_fd(G_UNIX_OUTPUT_STREAM(input_)), TRUE, nullptr);
}

void BaseOutput::tick() {
  if (program_ != nullptr && g_subprocess_get_identifier(program_) == nullptr) {  // it ended
    close();
    backoff_.failed(now());
    g_printerr("cerberusd: the base's program ended; it is started again\n");
  }
  if (program_ == nullptr && backoff_.is_due(now())) start();
  // Nothing follows a stop that would show that it is not read.
  const bool waits = program_ != nullptr && !drive_.is_active() && unread() > 0;
  if (waits && lags_) kill("a stop is unread");
  lags_ = waits && program_ != nullptr;
}

int BaseOutput::unread() const {
  int bytes = 0;
  if (ioctl(g_unix_output_stream_get_fd(G_UNIX_OUTPUT_STREAM(input_)), FIONREAD, &bytes) != 0) return 0;
  return bytes;
}

void BaseOutput::kill(const std::string& why) {
  g_printerr("cerberusd: the base's program does not read: %s\n", why.c_str());
  g_subprocess_force_exit(program_);
  close();
  backoff_.failed(now());
}

// A pipe that fills, or is closed, belongs to a program that does not read: it is killed, so that the base stops.
void BaseOutput::send() {
  const std::string line = drive_.line(now());
  if (line.empty() || program_ == nullptr) return;
  g_autoptr(GError) error = nullptr;
  const gssize written = g_pollable_output_stream_write_nonblocking(
      G_POLLABLE_OUTPUT_STREAM(input_), line.data(), line.size(), nullptr, &error);
  lags_ = false;
  if (written != static_cast<gssize>(line.size())) return kill(error ? error->message : "its pipe is full");
  if (unread() > kMostUnread) return kill("it is more than a second late");
  if (on_speed_) on_speed_(drive_.speed());
}

bool BaseOutput::drive(double speed, double yaw_rate) {
  if (program_ == nullptr) return false;
  drive_.drive(speed * settings_.max_speed, yaw_rate * settings_.max_yaw_rate, now());
  repeat();
  return true;
}

void BaseOutput::ask(double yaw_rate) {
  if (program_ == nullptr) return;
  drive_.ask(std::clamp(yaw_rate, -settings_.max_yaw_rate, settings_.max_yaw_rate), now());
  repeat();
}

void BaseOutput::repeat() {
  send();
  if (timer_ == 0 && drive_.is_active())
    timer_ = g_timeout_add(
        kInterval,
        [](gpointer data) {
          auto& self = *static_cast<BaseOutput*>(data);
          self.send();
          if (self.drive_.is_active() && self.program_ != nullptr)
            return static_cast<gboolean>(G_SOURCE_CONTINUE);
          self.timer_ = 0;
          return static_cast<gboolean>(G_SOURCE_REMOVE);
        },
        this);
}

void BaseOutput::stop() {
  if (program_ == nullptr) return;
  drive_.stop(now());
  send();
}

}  // namespace cerberus::robot
