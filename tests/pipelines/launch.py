#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""A line of gst-launch, run to its end: exit status 0 at the end of the stream, 1 and the message at an error."""
import sys

import gi
gi.require_version('Gst', '1.0')
from gi.repository import Gst  # noqa: E402

Gst.init(None)
pipeline = Gst.parse_launchv(sys.argv[1:])
pipeline.set_state(Gst.State.PLAYING)
message = pipeline.bus.timed_pop_filtered(Gst.CLOCK_TIME_NONE, Gst.MessageType.EOS | Gst.MessageType.ERROR)
if message.type == Gst.MessageType.ERROR:
    error, debug = message.parse_error()
    print(f'ERROR from {message.src.get_name()}: {error.message}\n{debug}')
pipeline.set_state(Gst.State.NULL)
sys.exit(message.type == Gst.MessageType.ERROR)
