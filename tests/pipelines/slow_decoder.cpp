// SPDX-License-Identifier: LGPL-2.1-or-later
// Stands in for a decoder that is too slow: loaded before everything else (LD_PRELOAD), it makes libavcodec take 120 ms more
// for each frame.
#include <dlfcn.h>
#include <link.h>
#include <unistd.h>

#include <cstring>

namespace {

using Send = int (*)(void* context, const void* packet);

// libavcodec belongs to a plugin, so that RTLD_NEXT does not find it.
Send find() {
  Send found = nullptr;
  dl_iterate_phdr(
      [](dl_phdr_info* module, std::size_t, void* to) {
        if (std::strstr(module->dlpi_name, "libavcodec.so") == nullptr) return 0;
        void* library = dlopen(module->dlpi_name, RTLD_LAZY | RTLD_NOLOAD);
        *static_cast<Send*>(to) = reinterpret_cast<Send>(dlsym(library, "avcodec_send_packet"));
        return 1;
      },
      &found);
  return found;
}

}  // namespace

extern "C" __attribute__((visibility("default"))) int avcodec_send_packet(void* context, const void* packet) {
  static const Send send = find();
  usleep(120000);
  return send(context, packet);
}
