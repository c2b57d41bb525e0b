// SPDX-License-Identifier: LGPL-2.1-or-later
// with_hardware PROGRAM [ARG ...]: runs a program that finds
// its hardware in CERBERUS_GPIO_CHIP and CERBERUS_IIO_DEVICE.
#include <sys/wait.h>

#include "simulated.h"

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  const simulated::Chip chip;
  const simulated::Converter converter;
  setenv("CERBERUS_GPIO_CHIP", chip.path().c_str(), 1);
  setenv("CERBERUS_IIO_DEVICE", "iio:device0", 1);
  const pid_t child = fork();
  if (child == 0) {
    execv(argv[1], argv + 1);
    std::perror(argv[1]);
    _exit(126);
  }
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}
