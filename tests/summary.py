#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""Adds up what meson's test logs say. A program of libcheck counts with each of its checks, any other test as one.

The last line is `N passed, N failed, N skipped`; the exit status is 1 if one failed or none ran.
"""
import json
import re
import sys

CHECKS = re.compile(r'^\d+%: Checks: (\d+), Failures: (\d+), Errors: (\d+)', re.MULTILINE)
GOOD, SKIPPED = {'OK', 'EXPECTEDFAIL'}, {'SKIP'}


def count(test):
    """(passed, failed, skipped) of one entry of a log."""
    checks = [tuple(map(int, found)) for found in CHECKS.findall(test.get('stdout') or '')]
    failed = sum(failures + errors for _, failures, errors in checks)
    passed = sum(total for total, _, _ in checks) - failed
    if test['result'] in SKIPPED:
        return 0, 0, 1
    if test['result'] in GOOD:
        return max(passed, 1), 0, 0
    return passed, max(failed, 1), 0


def main():
    passed = failed = skipped = 0
    for path in sys.argv[1:]:
        try:
            with open(path, encoding='utf-8') as log:
                tests = [json.loads(line) for line in log if line.strip()]
        except OSError as error:
            print(f'{path}: {error.strerror}')
            failed += 1
            continue
        for test in tests:
            good, bad, left_out = count(test)
            passed, failed, skipped = passed + good, failed + bad, skipped + left_out
            if bad:
                print(f'failed: {test["name"]} ({test["result"].lower()}, {test["duration"]:.1f} s)')
            elif left_out:
                reason = ' '.join((test.get('stdout') or test.get('stderr') or '').split())[-160:]
                print(f'skipped: {test["name"]} {reason}')
    print(f'{passed} passed, {failed} failed, {skipped} skipped')
    sys.exit(0 if passed and not failed else 1)


main()
