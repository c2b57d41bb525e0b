#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A line of gst-launch, parsed and not run: prints the elements that are missing; exit status 1 and why where it is wrong."""
import sys

import gi
gi.require_version('Gst', '1.0')
from gi.repository import GLib, Gst  # noqa: E402

Gst.init(None)
context = Gst.ParseContext.new()
try:
    Gst.parse_launchv_full(sys.argv[1:], context, Gst.ParseFlags.NONE)
except GLib.Error as error:
    if not error.matches(Gst.parse_error_quark(), Gst.ParseError.NO_SUCH_ELEMENT):
        sys.exit(error.message)
print(*sorted(set(context.get_missing_elements() or [])))
