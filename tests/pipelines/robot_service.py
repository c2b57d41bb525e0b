#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""What makes cerberusd a service: its unit is sound and hardened, its user and groups are described, and the configuration
file that comes with it has no mistake. What systemd itself would have to judge is skipped where its tools are missing."""
import configparser
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

CERBERUSD, UNIT, FILES = (pathlib.Path(argument).resolve() for argument in sys.argv[1:4])
MOST_EXPOSED = 2.5  # of systemd-analyze security: 0 is safe, 10 is not
BACK_AGAIN = 5  # seconds after the end of the process


def run(*command, code=0):
    done = subprocess.run(command, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          env=os.environ | {'SYSTEMD_LOG_LEVEL': 'warning', 'LC_ALL': 'C'})
    assert done.returncode == code, f'{command}: {done.returncode}\n{done.stdout}'
    return done.stdout


def check_unit():
    """The rules of the unit that a tool does not judge."""
    unit = configparser.ConfigParser(strict=False, interpolation=None)
    unit.optionxform = str
    unit.read_string(UNIT.read_text())
    service = unit['Service']
    assert service['Restart'] == 'always' and int(service['RestartSec']) < BACK_AGAIN
    assert unit['Unit']['StartLimitIntervalSec'] == '0', 'a robot that fails often would stay away'
    # A camera without frames for 15 s is started again by cerberusd itself; the watchdog waits longer.
    assert int(service['WatchdogSec']) > 20
    assert service['User'] == 'cerberus' and service['Type'] == 'notify' and service['ExecReload']
    # Helpers that drive heads end by themselves when cerberusd ends: no signal may come before that.
    assert service['KillSignal'] == 'SIGCONT' and int(service['TimeoutStopSec']) > 12
    # A file with mistakes ends with the code that the unit does not start again after.
    with tempfile.TemporaryDirectory() as folder:
        wrong = pathlib.Path(folder) / 'wrong.toml'
        wrong.write_text('nam = "x"\n')
        said = run(CERBERUSD, wrong, code=int(service['RestartPreventExitStatus']))
        assert f'{wrong}:1: unknown key "nam"' in said, said


def check_files():
    said = run(CERBERUSD, '--check', FILES / 'cerberusd.toml')
    assert 'no mistake' in said, said
    users = (FILES / 'cerberus.sysusers').read_text()
    for group in ('video', 'dialout', 'gpio', 'i2c'):
        assert f'm cerberus {group}\n' in users, f'the user is no member of {group}'
    # Groups that udev gives devices to exist: they are made here, or Debian has them.
    rules = (FILES / '70-cerberus.rules').read_text()
    for group in re.findall(r'GROUP="(\w+)"', rules) + re.findall(r'chgrp -R -P (\w+)', rules):
        assert f'g {group} ' in users or group == 'video', f'nothing makes the group {group}'


def judge_by_systemd():
    """By the tools of systemd; returns those that are missing."""
    missing = [tool for tool in ('systemd-analyze', 'systemd-sysusers') if not shutil.which(tool)]
    with tempfile.TemporaryDirectory() as folder:
        unit = pathlib.Path(folder) / UNIT.name
        # The program is not installed where the unit will find it.
        unit.write_text(re.sub(r'(?m)^ExecStart=\S+', f'ExecStart={CERBERUSD}', UNIT.read_text()))
        if 'systemd-analyze' not in missing:
            said = run('systemd-analyze', 'verify', '--man=no', unit)
            assert UNIT.name not in said, said
            said = run('systemd-analyze', 'security', '--offline=true', '--no-pager', unit)
            level = float(re.search(r'Overall exposure level for \S+: ([0-9.]+)', said)[1])
            assert level <= MOST_EXPOSED, f'{level} > {MOST_EXPOSED}:\n{said}'
            print(f'exposure {level}')
        if 'systemd-sysusers' not in missing and os.geteuid() == 0:  # it makes files of root
            root = pathlib.Path(folder) / 'root'
            (root / 'etc').mkdir(parents=True)
            run('systemd-sysusers', f'--root={root}', FILES / 'cerberus.sysusers')
            assert '\ncerberus:x:' in '\n' + (root / 'etc' / 'passwd').read_text()
            groups = (root / 'etc' / 'group').read_text()
            assert re.search('^gpio:.*:cerberus$', groups, re.M), groups
    return missing


check_unit()
check_files()
if absent := judge_by_systemd():
    print('skipped: ' + ', '.join(absent) + ' not there')
    sys.exit(77)
