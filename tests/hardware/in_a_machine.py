#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Runs commands in a virtual machine with simulated hardware: gpio-sim, the IIO dummy. QEMU without KVM will do.

    in_a_machine.py INIT KERNEL-FOLDER COMMAND [ARG ...] [-- COMMAND [ARG ...]] ...

INIT is guest_init, built. The machine sees the host's files, read-only, with a layer over them that is thrown away.
The kernel: $CERBERUS_KERNEL, else ../shared/vm/bzImage beside the checkout, else the one that tests/hardware/kernel
built in KERNEL-FOLDER; it is asked to build one if need be. Ends with 77, and says why, where something is missing: also
where no command failed and one ended with 77.
"""
import os
import pathlib
import shlex
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
TOP = HERE.parents[1]
# Kills of a pipeline, on request: of each of four heads. derived: a round takes up to 6 s in an emulated machine.
BOOT_SECONDS = 280 + 4 * 6 * int(os.environ.get('CERBERUS_KILLS', 0))


def skip(why):
    print('skipped:', why)
    sys.exit(77)


def kernel(folder):
    named = os.environ.get('CERBERUS_KERNEL')
    if named and not pathlib.Path(named).is_file():
        sys.exit(f'CERBERUS_KERNEL names {named}, and there is no such file')
    for path in (named, TOP.parent / 'shared' / 'vm' / 'bzImage', folder / 'bzImage'):
        if path and pathlib.Path(path).is_file():
            return pathlib.Path(path)
    done = subprocess.run([HERE / 'kernel', folder])
    if done.returncode != 0:
        skip('no kernel for the virtual machine, and none could be built (see above); name one in CERBERUS_KERNEL')
    return folder / 'bzImage'


def cpio(entries):
    """An archive in the kernel's form (newc): name, mode, device numbers, bytes."""
    archive = bytearray()
    for inode, (name, mode, major, minor, data) in enumerate([*entries, ('TRAILER!!!', 0, 0, 0, b'')], 1):
        encoded = name.encode() + b'\0'
        fields = (inode, mode, 0, 0, 1, 0, len(data), 0, 0, major, minor, len(encoded), 0)
        archive += b'070701' + b''.join(b'%08X' % field for field in fields) + encoded
        archive += bytes(-len(archive) % 4)
        archive += data + bytes(-len(data) % 4)
    return bytes(archive)


def initrd(init):
    return cpio([('init', 0o100755, 0, 0, pathlib.Path(init).read_bytes()),
                 ('dev', 0o40755, 0, 0, b''),
                 ('dev/console', 0o20600, 5, 1, b'')])


def script(commands, keep):
    """What the guest runs: every command, also after one failed. Folder and environment are those of here."""
    lines = ['#!/bin/sh', 'status=0', f'cd {shlex.quote(os.getcwd())}']
    lines += [f'export {name}={shlex.quote(os.environ[name])}' for name in keep if name in os.environ]
    for command in commands:
        lines += [f'echo {shlex.quote("guest: " + pathlib.Path(command[0]).name)}',
                  shlex.join(command) + '; code=$?',
                  'if [ $code = 77 ]; then skipped=77; elif [ $code != 0 ]; then status=1; fi']
    return '\n'.join([*lines, '[ $status != 0 ] || status=${skipped:-0}', 'exit $status', ''])


def boot(qemu, image, init, commands):
    module = image.parent / 'i2c-stub.ko'
    if module.is_file():
        os.environ['CERBERUS_I2C_STUB'] = str(module.resolve())
    keep = [name for name in os.environ if name.startswith(('GST_', 'G_', 'CK_', 'CERBERUS_', 'LD_LIBRARY', 'PATH'))]
    with tempfile.TemporaryDirectory(prefix='cerberus-machine-') as folder:
        folder = pathlib.Path(folder)
        folder.chmod(0o755)
        (folder / 'initrd').write_bytes(initrd(init))
        (folder / 'run').write_text(script(commands, keep), 'utf-8')
        (folder / 'run').chmod(0o755)
        line = [qemu, '-accel', 'tcg,thread=multi', '-cpu', 'max', '-smp', '2', '-m', '768', '-nographic', '-no-reboot',
                '-nic', 'none', '-kernel', image, '-initrd', folder / 'initrd',
                '-append', f'console=ttyS0 panic=-1 quiet loglevel=1 -- {folder}/run',
                '-virtfs', 'local,path=/,mount_tag=root,security_model=none,readonly=on,multidevs=remap']
        machine = subprocess.Popen(line, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        try:
            output, _ = machine.communicate(timeout=BOOT_SECONDS)
        except subprocess.TimeoutExpired:
            machine.kill()
            output, _ = machine.communicate()
            output += b'\nthe machine did not end in time\n'
    return output.decode('utf-8', 'replace').replace('\r', '')


def main():
    init, folder, rest = sys.argv[1], pathlib.Path(sys.argv[2]), sys.argv[3:]
    commands, command = [], []
    for word in [*rest, '--']:
        if word == '--':
            commands.append(command)
            command = []
        else:
            command.append(word)
    qemu = shutil.which('qemu-system-x86_64')
    if not qemu:
        skip('qemu-system-x86_64 is not installed (pipelines/setup hardware installs it)')
    output = boot(qemu, kernel(folder), init, commands)
    begin = output.find('guest:')
    print(output[max(begin, 0):])
    skipped = '\nguest: ended with 77\n' in output
    sys.exit(0 if '\nguest: ended with 0\n' in output else 77 if skipped else 1)


if __name__ == '__main__':
    main()
