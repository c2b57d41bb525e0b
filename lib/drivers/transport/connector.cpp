// SPDX-License-Identifier: LGPL-2.1-or-later
#include "drivers/transport/connector.h"

#include <sys/eventfd.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <system_error>
#include <thread>

namespace cerberus::drivers {

// Shared with the thread, which alone uses it until `over`.
struct Connector::Attempt {
  ByteStream stream;
  std::string wrong;
  std::atomic<bool> over = false;
  int event = ::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);

  ~Attempt() { ::close(event); }
  void finish() {
    over = true;
    const std::uint64_t one = 1;
    [[maybe_unused]] const ssize_t written = ::write(event, &one, sizeof one);
  }
};

void Connector::start(const std::string& address, int baud) {
  attempt_ = std::make_shared<Attempt>();
  try {
    std::thread([attempt = attempt_, address, baud] {
      attempt->wrong = attempt->stream.open(address, baud);
      attempt->finish();
    }).detach();
  } catch (const std::system_error&) {
    attempt_->wrong = "there is no thread to open " + address;
    attempt_->finish();
  }
}

int Connector::fd() const {
  return attempt_ ? attempt_->event : -1;
}

std::optional<std::string> Connector::take(ByteStream& stream) {
  if (!attempt_ || !attempt_->over) return std::nullopt;
  const auto attempt = std::move(attempt_);
  if (attempt->wrong.empty()) stream.take(attempt->stream);
  return attempt->wrong;
}

}  // namespace cerberus::drivers
