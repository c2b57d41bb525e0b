#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The Debian package: its maintainer scripts are shell, and what it contains is complete and installed where Debian looks. With
CERBERUS_PACKAGE=1 the build under test is packed (10 s of CPU); else only the scripts are looked at."""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

BUILD, FOLDER = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])


def run(*command, libraries=''):
    done = subprocess.run(command, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          env=os.environ | {'LC_ALL': 'C', 'LD_LIBRARY_PATH': str(libraries)})
    assert done.returncode == 0, f'{command}: {done.returncode}\n{done.stdout}'
    return done.stdout


def check_contents(package):
    rows = [line.split(None, 5) for line in run('dpkg-deb', '-c', package).splitlines()]
    modes = {row[5].split(' -> ')[0].removeprefix('.'): (row[0], row[1]) for row in rows}
    # The prefix is that of the build: /usr in a package that `pipelines/setup deb` made.
    unit = next(name for name in modes if name.endswith('/cerberusd.service'))
    prefix = unit.removesuffix('/lib/systemd/system/cerberusd.service')
    assert prefix in ('/usr', '/usr/local'), prefix
    for name in ('bin/cerberusd', 'bin/cerberus-heads', 'libexec/cerberus/cerberus-head', 'lib/sysusers.d/cerberus.conf',
                 'lib/udev/rules.d/70-cerberus.rules', 'share/doc/cerberus/copyright', 'share/doc/cerberus/robot.md',
                 'share/doc/cerberus/changelog.Debian.gz'):
        assert f'{prefix}/{name}' in modes, f'{name} is missing'
    for name, (mode, owner) in modes.items():
        assert owner == 'root/root', f'{name} belongs to {owner}'
        if not mode.startswith('l'):
            assert mode[8] == '-' and mode[5] == '-', f'others may write {name}: {mode}'
        assert name.startswith((f'{prefix}/', '/etc/cerberus/')) or mode.startswith('d'), f'{name} is out of place'
        assert 'build' not in name and '/test' not in name, f'{name} is no part of the package'
    plugins = [name for name in modes if '/gstreamer-1.0/libgstcerberus' in name]
    built = list((BUILD / 'plugins').glob('*/libgstcerberus*.so'))
    assert len(plugins) == len(built), (plugins, built)
    with tempfile.TemporaryDirectory() as name:
        run('dpkg-deb', '-e', package, name)
        run('dpkg-deb', '-x', package, name + '/root')
        control = pathlib.Path(name)
        assert (control / 'conffiles').read_text() == '/etc/cerberus/cerberusd.toml\n'
        fields = (control / 'control').read_text()
        for word in ('libgstreamer1.0-0', 'libc6', 'gstreamer1.0-plugins-good'):
            assert word in fields, f'does not depend on {word}'
        assert '@' not in fields.replace('cerberus@localhost', ''), fields
        sums = subprocess.run(['md5sum', '--quiet', '-c', control / 'md5sums'], cwd=control / 'root')
        assert sums.returncode == 0
        # The unit starts the program that is installed.
        text = (control / 'root' / unit.lstrip('/')).read_text()
        assert f'ExecStart={prefix}/bin/cerberusd /etc/cerberus/cerberusd.toml\n' in text, text
        run(control / 'root' / prefix.lstrip('/') / 'bin' / 'cerberusd', '--check',
            control / 'root' / 'etc/cerberus/cerberusd.toml',
            libraries=next((control / 'root').glob('**/libcerberus-1.0.so.0')).parent)


for script in ('postinst', 'prerm', 'postrm'):
    run('sh', '-n', FOLDER / script)
    assert 'set -e' in (FOLDER / script).read_text()
run('bash', '-n', FOLDER / 'package')
# What the robot keeps beside its recordings is gone after a purge.
kept = {name for source in FOLDER.parent.glob('*.[ch]*')
        for name in re.findall(r'state_folder \+ "/([^"]+)"', source.read_text(encoding='utf-8'))}
assert {'mode', 'passwords', 'devices'} <= kept, kept
removed = set(re.findall(r'/var/lib/cerberus/(\S+)', (FOLDER / 'postrm').read_text()))
assert kept <= removed, kept - removed
if not os.environ.get('CERBERUS_PACKAGE'):
    print('skipped: packing the build; CERBERUS_PACKAGE=1 does')
    sys.exit(77)
if not shutil.which('dpkg-shlibdeps'):
    print('skipped: dpkg-shlibdeps is not there (package dpkg-dev)')
    sys.exit(77)
with tempfile.TemporaryDirectory() as target:
    check_contents(run(FOLDER / 'package', BUILD, target).splitlines()[-1])
