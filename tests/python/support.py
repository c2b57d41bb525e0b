# SPDX-License-Identifier: LGPL-2.1-or-later
"""What the tests of this folder share: the libraries through introspection, or a skip that says what is missing.

The test suite sets GI_TYPELIB_PATH and LD_LIBRARY_PATH to the build; an installed Cerberus needs neither.
"""
import sys

SKIPPED = 77

if sys.argv[1:] == ["no-introspection"]:
    print("skipped: built without introspection (option introspection, packages libgirepository1.0-dev and "
          "gobject-introspection; off in sanitizer builds)")
    sys.exit(SKIPPED)

try:
    import gi
    gi.require_version("Gst", "1.0")
    gi.require_version("GstApp", "1.0")
    gi.require_version("GstVideo", "1.0")
    from gi.repository import Gst, GstApp, GstVideo  # noqa: F401 (GstApp gives appsink its methods)
except (ImportError, ValueError) as missing:
    print(f"skipped: {missing} (packages python3-gi, gir1.2-gst-plugins-base-1.0)")
    sys.exit(SKIPPED)

gi.require_version("Cerberus", "1.0")  # built, so it must be found: no skip
from gi.repository import Cerberus  # noqa: E402

Gst.init(None)
TIMEOUT = 30 * Gst.SECOND

CAPS = "video/x-raw,format=GRAY8,width=320,height=240,framerate=30/1"
BALL = f"videotestsrc pattern=ball num-buffers=60 ! {CAPS}"


def region(**fields):
    """A Cerberus.Region with some fields set."""
    result = Cerberus.Region.new()
    for name, value in fields.items():
        setattr(result, name, value)
    return result


def frames(description, probe=None, messages=None):
    """Runs a pipeline that ends in `appsink name=sink`; yields each buffer. `probe` sees what leaves `mark`;
    the element messages go to `messages` after the last one. Ends when every sink has: a file is written whole then."""
    pipeline = Gst.parse_launch(description)
    if probe:
        def on_buffer(_pad, info):
            probe(info.get_buffer())
            return Gst.PadProbeReturn.OK
        pipeline.get_by_name("mark").get_static_pad("src").add_probe(Gst.PadProbeType.BUFFER, on_buffer)
    sink, bus = pipeline.get_by_name("sink"), pipeline.get_bus()
    pipeline.set_state(Gst.State.PLAYING)
    try:
        while sample := sink.try_pull_sample(TIMEOUT):
            yield sample.get_buffer()
        awaited = Gst.MessageType.ELEMENT | Gst.MessageType.ERROR | Gst.MessageType.EOS
        while (message := bus.timed_pop_filtered(TIMEOUT, awaited)) and message.type != Gst.MessageType.EOS:
            if message.type == Gst.MessageType.ERROR:
                raise RuntimeError(message.parse_error())
            if messages is not None:
                messages.append(message)
        if not message:
            raise RuntimeError("the pipeline does not go on")
    finally:
        pipeline.set_state(Gst.State.NULL)
