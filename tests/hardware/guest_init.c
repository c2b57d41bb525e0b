/* SPDX-License-Identifier: LGPL-2.1-or-later */
/* The first and only process of the virtual machine: puts a writable layer over the host's files, enters it, runs the
 * command of the kernel's command line after "--", says how it
 * ended, and switches the machine off. Linked statically. */
#include <errno.h>
#include <fcntl.h>
#include <linux/reboot.h>
#include <stdio.h>
#include <string.h>
#include <sys/mount.h>
#include <sys/reboot.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

static void end(const char* what, int status) {
  if (what) printf("guest: %s: %s\n", what, strerror(errno));
  printf("\nguest: ended with %d\n", status);
  fflush(stdout);
  sync();
  reboot(LINUX_REBOOT_CMD_RESTART); /* qemu -no-reboot */
  for (;;) pause();
}

static void mount_or_end(const char* source, const char* target, const char* type, unsigned long flags,
                         const char* options) {
  mkdir(target, 0755);
  if (mount(source, target, type, flags, options) != 0) end(target, 125);
}

int main(int argc, char** argv) {
  (void)argc;
  mount_or_end("tmpfs", "/writable", "tmpfs", 0, "mode=755");
  mount_or_end("root", "/host", "9p", MS_RDONLY, "trans=virtio,version=9p2000.L,msize=524288,cache=loose");
  mkdir("/writable/upper", 0755);
  mkdir("/writable/work", 0755);
  mount_or_end("overlay", "/root", "overlay", 0,
               "lowerdir=/host,upperdir=/writable/upper,workdir=/writable/work");
  if (chdir("/root") != 0) end("/root", 125);
  mount_or_end("proc", "proc", "proc", 0, NULL);
  mount_or_end("sysfs", "sys", "sysfs", 0, NULL);
  mount_or_end("devtmpfs", "dev", "devtmpfs", 0, NULL);
  mount_or_end("configfs", "sys/kernel/config", "configfs", 0, NULL);
  mount_or_end("tmpfs", "run", "tmpfs", 0, NULL);
  if (chroot(".") != 0) end("chroot", 125);
  int console = open("/dev/console", O_RDWR);
  for (int fd = 0; fd < 3 && console >= 0; ++fd) dup2(console, fd);

  const pid_t child = fork();
  if (child == 0) {
    execv(argv[1], argv + 1);
    printf("guest: %s: %s\n", argv[1], strerror(errno));
    fflush(stdout);
    _exit(126);
  }
  int status = 0;
  while (waitpid(child, &status, 0) != child && errno == EINTR) {
  }
  end(NULL, WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status));
  return 0;
}
