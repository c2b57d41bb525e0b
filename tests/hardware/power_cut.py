#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A recorder's machine loses its power: what was acknowledged is on the disk, whole, and in the index.

    power_cut.py INIT KERNEL-FOLDER RECORDER-TEST [CUTS]

The virtual machine of in_a_machine.py is killed at random moments. Its disk is a folder of the host, which the guest's kernel
writes from its page cache (9p, cache=loose): what was not synchronised when the machine is killed is lost, as on a disk.
Names are not: folders are written at once.
"""
import os
import pathlib
import random
import shlex
import shutil
import subprocess
import sys
import tempfile
import time

from in_a_machine import BOOT_SECONDS, initrd, kernel, script, skip

EVENTS = 2  # that are acknowledged before the power fails


def cut(qemu, image, init, program, disk, folder):
    """The acknowledged recordings: first frame, last frame, file."""
    (folder / 'initrd').write_bytes(initrd(init))
    command = ('mkdir /disk && mount -t 9p -o trans=virtio,version=9p2000.L,cache=loose disk /disk && '
               f'CERBERUS_RECORD_INTO=/disk CK_FORK=no {shlex.quote(str(program))} 9>/dev/console')
    keep = [name for name in os.environ if name.startswith(('GST_', 'G_', 'CK_', 'CERBERUS_', 'LD_LIBRARY', 'PATH'))]
    (folder / 'run').write_text(script([['/bin/sh', '-c', command]], keep), 'utf-8')
    (folder / 'run').chmod(0o755)
    machine = subprocess.Popen(
        [qemu, '-accel', 'tcg,thread=multi', '-cpu', 'max', '-smp', '2', '-m', '768', '-nographic', '-no-reboot',
         '-nic', 'none', '-kernel', image, '-initrd', folder / 'initrd',
         '-append', f'console=ttyS0 panic=-1 quiet loglevel=1 -- {folder}/run',
         '-virtfs', 'local,path=/,mount_tag=root,security_model=none,readonly=on,multidevs=remap',
         '-virtfs', f'local,path={disk},mount_tag=disk,security_model=none,multidevs=remap'],
        stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors='replace')
    acknowledged, output = [], []
    try:
        for line in machine.stdout:
            output.append(line)
            words = line.split()
            if len(words) == 3 and words[2].startswith('/disk/'):
                acknowledged.append(f'{words[0]} {words[1]} {disk}{words[2][len("/disk"):]}')
            if len(acknowledged) == EVENTS:
                time.sleep(random.random())
                break
            if 'guest: ended' in line:
                sys.exit('the recorder ended:\n' + ''.join(output))
    finally:
        machine.kill()
        machine.communicate()
    if len(acknowledged) < EVENTS:
        sys.exit('the machine ended:\n' + ''.join(output))
    return acknowledged


def main():
    init, folder, program = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3]).absolute()
    cuts = int(sys.argv[4]) if len(sys.argv) > 4 else 5
    qemu = shutil.which('qemu-system-x86_64')
    if not qemu:
        skip('qemu-system-x86_64 is not installed (pipelines/setup hardware installs it)')
    image = kernel(folder)
    with tempfile.TemporaryDirectory(prefix='cerberus-power-') as place:
        place = pathlib.Path(place)
        place.chmod(0o755)
        disk = place / 'disk'
        disk.mkdir()
        everything = []
        for number in range(cuts):
            everything += cut(qemu, image, init, program, disk, place)
            (place / 'acknowledged').write_text('\n'.join(everything) + '\n', 'utf-8')
            subprocess.run([program], check=True, timeout=BOOT_SECONDS,
                           env={**os.environ, 'CERBERUS_RECORDED': str(place / 'acknowledged'),
                                'CERBERUS_RECORDED_IN': str(disk)})
            print(f'cut {number + 1}: {len(everything)} recordings were acknowledged, and are whole', flush=True)


if __name__ == '__main__':
    main()
