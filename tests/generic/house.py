#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The rules of the house that a program can check: licences, the direction of dependencies, scripts that explain."""
import json
import os
import pathlib
import re
import subprocess
import sys

TOP = pathlib.Path(__file__).resolve().parents[2]
FOLDERS = ('lib', 'gst', 'plugins', 'pipelines', 'tests', 'docs', '.ci')
SOURCES = {'.h', '.hpp', '.hh', '.c', '.cc', '.cpp', '.py', '.in', '.txt', '.build', '.launch', ''}
complaints = []


def files():
    for folder in FOLDERS:
        for path in sorted((TOP / folder).rglob('*')):
            if path.is_file() and '__pycache__' not in path.parts:
                yield path
    yield TOP / 'meson.build'
    yield TOP / 'meson_options.txt'


def complain(path, text):
    complaints.append(f'{path.relative_to(TOP)}: {text}')


# Every file of ours says its licence in its first lines. Pictures and Markdown are prose.
def check_licence(path):
    if path.suffix in SOURCES:
        head = path.read_text('utf-8', errors='replace').splitlines()[:3]
        if not any('SPDX-License-Identifier: LGPL-2.1-or-later' in line for line in head):
            complain(path, 'no SPDX-License-Identifier: LGPL-2.1-or-later in its first lines')


# lib <- gst <- plugins <- pipelines: nobody includes what is further down the line. The private helpers of gst/ are for
# the plugins. What each folder must never include, as the beginning of the name between the brackets or quotes:
FORBIDDEN = {
    'lib': ('gst/', 'glib', 'gobject', 'gio/', 'cerberus/', 'plugins/', 'pipelines/', 'tests/', 'opencv'),
    'gst': ('plugins/', 'pipelines/', 'tests/', 'opencv'),
    'plugins': ('pipelines/', 'tests/', 'opencv'),  # but plugins/verify
    'pipelines': ('tests/', 'cerberus/private/', 'opencv'),
}
DEPENDENCIES = {  # words of a meson.build that would turn an arrow round
    'lib': ('gst_dep', 'gst_base_dep', 'gst_video_dep', 'cerberus_dep', 'glib', 'plugins', 'opencv'),
    'gst': ('all_plugins', 'opencv'),
    'plugins': ('opencv',),
    'pipelines': ('opencv',),
}


# The one module that may use OpenCV; the benches may, too.
def uses_opencv(path):
    return path.relative_to(TOP).parts[:2] == ('plugins', 'verify')


def check_direction(path):
    layer = path.relative_to(TOP).parts[0]
    text = path.read_text('utf-8', errors='replace')
    if path.suffix in {'.h', '.hpp', '.c', '.cpp'}:
        for name in re.findall(r'^\s*#\s*include\s*[<"]([^>"]+)', text, re.M):
            real = name
            if name.startswith('.'):
                target = os.path.relpath(os.path.normpath(path.parent / name), TOP)
                real = target if target.split('/')[0] != layer else ''
            if real.startswith(FORBIDDEN.get(layer, ())) and not (real.startswith('opencv') and uses_opencv(path)):
                complain(path, f'includes {name}: dependencies run lib <- gst <- plugins <- pipelines')
    elif path.name == 'meson.build':
        code = re.sub(r'#.*', '', text)
        for word in DEPENDENCIES.get(layer, ()):
            if re.search(rf'\b{word}\b', code) and not (word == 'opencv' and uses_opencv(path)):
                complain(path, f'names {word}: dependencies run lib <- gst <- plugins <- pipelines')


# The folders of lib/ and the arrows between them, as docs/manual/architecture.md draws them. Arrows are transitive: what
# a folder may use, it may use with all that stands below. `vision` itself is what stands above its folders.
VISION = {
    'vision/image': (),
    'vision/geometry': ('vision/image',),
    'vision/ego_motion': ('vision/geometry',),
    'vision/change': ('vision/ego_motion',),
    'vision/components': ('vision/change',),
    'vision/background': ('vision/components',),
    'vision/burnt_in': ('vision/change',),
    'vision/detection': ('vision/geometry',),
    'vision/persons': ('vision/geometry',),
    'vision/zones': ('vision/geometry',),
    'vision/tracking': ('vision/detection', 'vision/persons'),
}
ARROWS = VISION | {
    'text': (),
    'threads': (),
    'vision': tuple(VISION),
    'overlay': ('vision',),
    'sensing': (),
    'fusion': ('sensing',),
    'motion': (),
    'drivers': ('motion', 'sensing'),
    'control': ('drivers', 'fusion', 'vision'),
    'sim': ('vision', 'sensing', 'motion'),
    'record': ('vision',),
    'publish': (),
    'robot': ('record', 'publish', 'drivers'),
}
BELOW_ALL = ('text', 'threads')
FOR_ALL = {'sensing/angles.h'}  # degrees and radians
MOST_FILES = 24  # a folder of lib/: what is larger has lost its walls


def reachable(folder):
    found, waiting = {folder, *BELOW_ALL}, [folder]
    while waiting:
        for below in ARROWS[waiting.pop()]:
            if below not in found:
                found.add(below)
                waiting.append(below)
    return found


# A folder within one that is drawn belongs to it: drivers/gpio to drivers.
def drawn_folder(path):
    while path and path not in ARROWS:
        path = os.path.dirname(path)
    return path


files_of_folder = {}


def check_arrows(path):
    parts = path.relative_to(TOP).parts
    if parts[0] != 'lib' or path.suffix not in {'.h', '.cpp'}:
        return
    own = os.path.join(*parts[1:-1])
    files_of_folder.setdefault(own, []).append(path)
    folder = drawn_folder(own)
    if not folder:
        complain(path, 'stands in a folder of lib/ without arrows: draw them in ARROWS and in the architecture page')
        return
    for name in re.findall(r'^\s*#\s*include\s*"([^"]+)', path.read_text('utf-8'), re.M):
        target = drawn_folder(os.path.dirname(name))
        if name not in FOR_ALL and target not in reachable(folder):
            complain(path, f'includes {name}: no arrow runs from {folder} to {target or "there"}')


def check_folder_sizes():
    for folder, members in files_of_folder.items():
        if len(members) > MOST_FILES:
            complain(TOP / 'lib' / folder, f'has {len(members)} files: more than {MOST_FILES} are no folder any more')


# A plugin takes from no other plugin: what several need is in plugins/shared (or in lib, or in gst). And what only one
# needs, and no header there, is not there.
users_of_shared = {}


def check_plugin(path):
    parts = path.relative_to(TOP).parts
    if parts[0] != 'plugins' or path.suffix not in {'.hpp', '.cpp'}:
        return
    for name in re.findall(r'^\s*#\s*include\s*"([^"]+)', path.read_text('utf-8'), re.M):
        found = [folder / name for folder in (path.parent, TOP / 'plugins') if (folder / name).exists()]
        if not found:
            continue  # of lib or gst
        owner = found[0].resolve().relative_to(TOP / 'plugins').parts[0]
        if owner not in (parts[1], 'shared'):
            complain(path, f'includes {name} of another plugin: what both need belongs in plugins/shared')
        if owner == 'shared':
            users_of_shared.setdefault(found[0].resolve(), set()).add(parts[1])


def check_shared():
    for path in sorted((TOP / 'plugins' / 'shared').glob('*.hpp')):
        users = users_of_shared.get(path, set())
        if len(users - {'shared'}) < 2 and 'shared' not in users:
            complain(path, 'is needed by fewer than two plugins')


# What elements tell the application goes through one place, which makes the words of others printable.
BARE_MESSAGE = re.compile(r'\b(GST_ELEMENT_|gst_message_new_)(ERROR|WARNING|INFO)', re.I)


def check_messages(path):
    parts = path.relative_to(TOP).parts
    if parts[0] in {'gst', 'plugins'} and path.suffix in {'.h', '.hpp', '.cpp'}:
        if BARE_MESSAGE.search(path.read_text('utf-8')):
            complain(path, 'posts a message by itself: use CERBERUS_ELEMENT_... of cerberus/private/messages.hpp')


# An installed header must not lean on one that is not installed.
def check_installed_header(path):
    parts = path.relative_to(TOP).parts
    if parts[0] == 'gst' and path.suffix == '.h' and 'private' not in parts:
        text = path.read_text('utf-8')
        if re.search(r'#\s*include.*(private/|\.hpp|vision/)', text):
            complain(path, 'is installed and includes a header that is not')


def check_launch_file(path):
    if path.suffix == '.launch':
        lines = path.read_text('utf-8').splitlines()
        if not re.match(r'# [A-Z].*\.$', lines[0]):
            complain(path, 'its first line must be a comment that says in a sentence what it does')
        name = path.stem
        tested = (TOP / 'tests' / 'pipelines' / 'launch_files.py').read_text('utf-8')
        if f"start('{name}'" not in tested:
            complain(path, 'is run by no test')


# The text of a launch file, a source or a page in one line each, without comments' stars, quotes and line ends; pages are
# parted by their fences, so that no line runs into the next example.
def launch_lines(path):
    text = path.read_text('utf-8', errors='replace')
    if path.suffix == '.launch':
        text = '\n'.join(line for line in text.splitlines() if not line.startswith('#'))
    parts = text.split('```') if path.suffix == '.md' else [text]
    return [re.sub(r'[\'"\\\s]+(?:\*\s+)?', ' ', part) for part in parts]


# Parameter sets between the slices of a picture damage it for FFmpeg: payloaders.cpp says which interval puts them before.
def check_payloaders(path):
    if path.suffix in SOURCES | {'.md'} and path != TOP / 'tests' / 'generic' / 'house.py':
        for line in path.read_text('utf-8', errors='replace').splitlines():
            interval = re.search(r'rtph26[45]pay\b.*config-interval=(-?\d+)', line)
            if interval and interval[1] != PARAMETER_SETS:
                complain(path, f'config-interval={interval[1]} of a payloader: it is {PARAMETER_SETS} everywhere')
        for line in launch_lines(path):
            for payloader in re.findall(r'\brtph26[45]pay\b[^!]*(?:! udpsink\b)?', line):
                sends = 'udpsink' in payloader or 'name=pay0' in payloader
                if sends and 'config-interval' not in payloader:
                    complain(path, f'"{payloader.strip()}" without config-interval={PARAMETER_SETS}: '
                                   'a receiver that comes later plays nothing')


PARAMETER_SETS = re.search(r'rtph264pay config-interval=(\d+)',
                           (TOP / 'lib' / 'publish' / 'streams' / 'payloaders.cpp').read_text('utf-8'))[1]


# An encoder of our own lines gets what it can take: encoders.h says why, and encoders.list for JPEG. What a decoder of
# H.264 gives has even sizes already.
BEFORE_ENCODER = re.search(r'kBeforeEncoder =\s*"([^"]*)"',
                           (TOP / 'lib' / 'publish' / 'streams' / 'encoders.h').read_text('utf-8'))[1]

BEFORE_JPEG = re.search(r'gstreamer1.0-plugins-good +(.* ! )jpegenc\n',
                        (TOP / 'lib' / 'publish' / 'streams' / 'encoders.list').read_text('utf-8'))[1]


def check_encoders(path):
    text = path.read_text('utf-8', errors='replace')
    lines_of_ours = ((path.suffix == '.launch' and 'h264dec' not in text) or path.suffix == '.md' or
                     path.name == 'rtsp_mount.c' or
                     (path.suffix == '.cpp' and path.relative_to(TOP).parts[0] == 'plugins'))
    for line in launch_lines(path) if lines_of_ours else []:
        found = re.findall(r'(.{0,200})! (?:\$\{ENCODER\}|(?!jpegenc)\w+enc\b)', line)
        if not all(before.endswith(BEFORE_ENCODER + ' ') for before in found):
            complain(path, f'an encoder without "{BEFORE_ENCODER}" in front')
        if not all(before.endswith(BEFORE_JPEG) for before in re.findall(r'(.{0,200}! )jpegenc\b', line)):
            complain(path, f'jpegenc without "{BEFORE_JPEG}" in front')


# A video of a telephone may lie on its side and say so. Network cameras do not turn their pictures, nor do simulated ones.
def check_upright(path):
    lines = path.read_text('utf-8', errors='replace') if path.suffix in {'.launch', '.md', '.cpp'} else ''
    for line in [lines] if path.suffix == '.launch' else re.findall('.*location=walk.mp4.*', lines):
        text = re.sub(r'\s+', ' ', re.sub('^#.*', '', line, flags=re.M))
        first = re.search(r'(\S+ \S+ )! (?:motiondetect|virtualptz)', text)
        if first and first[1] != 'videoflip video-direction=auto ' and path.name not in ('record-streams.launch', 'patrol.launch'):
            complain(path, 'no "videoflip video-direction=auto" in front of what detects')


def check_commands():
    explained = ('pipelines/demo', 'pipelines/encoder', 'pipelines/rtsp', 'pipelines/run', 'pipelines/setup', 'tests/run')
    for command in (*explained, 'docs/generate', 'docs/patrol'):
        if not os.access(TOP / command, os.X_OK):
            complain(TOP / command, 'cannot be run')
    for command in explained:
        done = subprocess.run([TOP / command, '--help'], capture_output=True, text=True, timeout=20)
        if done.returncode != 0 or len(done.stdout) < 100:
            complain(TOP / command, 'does not explain itself when asked with --help')


def check_links(path):
    """Pictures and pages that a Markdown file points to are there."""
    if path.suffix == '.md':
        for target in re.findall(r'\]\(([^)#\s]+)(?:#[^)]*)?\)', path.read_text('utf-8')):
            if '://' not in target and not target.startswith('mailto:') and not (path.parent / target).exists():
                complain(path, f'points to {target}, which is not there')


def check_json(path):
    """Examples of configuration files are well formed."""
    if path.suffix == '.json':
        try:
            json.loads(path.read_text('utf-8'))
        except ValueError as error:
            complain(path, f'is no JSON: {error}')


def check_changelog():
    """The newest version of the changelog, below what is not released yet, is meson's, with a date; a user reads it to its end."""
    path = TOP / 'CHANGELOG.md'
    text = path.read_text('utf-8')
    built = re.search(r"^  version: '([^']+)'", (TOP / 'meson.build').read_text('utf-8'), re.MULTILINE).group(1)
    newest = next(heading for heading in re.findall(r'^## (.*)$', text, re.MULTILINE) if heading != '[Unreleased]')
    if not re.fullmatch(re.escape(f'[{built}]') + r' - \d{4}-\d\d-\d\d', newest):
        complain(path, f'begins with "{newest}" and not with "[{built}] - YYYY-MM-DD", the version of meson.build')
    for release in re.split(r'^## ', text, flags=re.MULTILINE)[1:]:
        if len(release.splitlines()) > 80:
            complain(path, f'{release.splitlines()[0]} has more than 80 lines')


PAGES = {page.name for page in TOP.glob('*.md')}
PAGES |= {page.name for folder in FOLDERS for page in (TOP / folder).rglob('*.md')}


def check_named_pages(path):
    """A page that a source names is one that its reader has, too."""
    if path.suffix in SOURCES:
        for name in re.findall(r'(?<![*<\w])\w[\w-]*\.md\b', path.read_text('utf-8', errors='replace')):
            if name not in PAGES:
                complain(path, f'names {name}, which is not in the project')


for each in files():
    check_licence(each)
    check_direction(each)
    check_arrows(each)
    check_plugin(each)
    check_messages(each)
    check_installed_header(each)
    check_launch_file(each)
    check_payloaders(each)
    check_encoders(each)
    check_upright(each)
    check_links(each)
    check_named_pages(each)
    check_json(each)
for each in TOP.glob('*.md'):
    check_links(each)
    check_payloaders(each)
    check_encoders(each)
    check_upright(each)
check_shared()
check_folder_sizes()
check_commands()
check_changelog()
print('\n'.join(complaints))
sys.exit(1 if complaints else 0)
