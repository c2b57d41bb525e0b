#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The page of cerberusd in Chromium: first password, log in, watch, steer, follow by tap, stop, two tabs of which one steers,
events (filter, open, delete), a page of another origin, privacy, a viewer who may not steer, a wrong password eleven
times. With a folder as second argument it leaves screenshots of a phone, an 800x480 touch screen and a desktop there.
Skipped where chromium, chromium-driver and python3-selenium are not installed."""
import http.server
import pathlib
import re
import shutil
import signal
import sqlite3
import subprocess
import sys
import tempfile
import threading
import time

from robot_page import CONFIGURATION, free_port

PATIENCE = 100  # seconds
LEAST_WAIT = 8  # seconds that the page still asks for when the right password is tried

try:
    from selenium import webdriver
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.support.ui import WebDriverWait
except ImportError:
    print('skipped: python3-selenium is not installed')
    sys.exit(77)
DRIVER = shutil.which('chromedriver')
if not DRIVER or not shutil.which('chromium'):
    print('skipped: chromium or chromium-driver is not installed')
    sys.exit(77)

# Buttons whose middle is on the screen, and that another element is in front of.
COVERED = """
const covered = [];
for (const button of document.querySelectorAll('button, select, summary, a')) {
  const box = button.getBoundingClientRect(), x = box.left + box.width / 2, y = box.top + box.height / 2;
  const rows = document.getElementById('scroller').getBoundingClientRect();
  if (!button.checkVisibility() || x < 0 || y < 0 || x > innerWidth || (button.closest('#room') && y > rows.bottom)) continue;
  if (y > innerHeight || button.closest('dialog, #strip, #entrance')) continue;
  const there = document.elementFromPoint(x, y);
  if (there !== button && !button.contains(there)) covered.push(button.id || button.textContent);
}
return covered.join()"""

SIZES = {'phone': (390, 844, True), 'touch-screen': (800, 480, False), 'desktop': (1280, 800, False)}


def browser():
    options = webdriver.ChromeOptions()
    # The timers of a tab that is not shown run as those of one that is.
    for argument in ('--headless=new', '--no-sandbox', '--disable-gpu', '--disable-dev-shm-usage', '--window-size=1280,800',
                     '--disable-background-timer-throttling', '--disable-renderer-backgrounding',
                     '--disable-backgrounding-occluded-windows'):
        options.add_argument(argument)
    options.set_capability('goog:loggingPrefs', {'browser': 'ALL'})
    return webdriver.Chrome(service=Service(DRIVER), options=options)


class Stranger(http.server.BaseHTTPRequestHandler):
    """A page of another origin that tries to use the robot with the browser's cookies."""
    port = 0

    def do_GET(self):
        self.send_response(200)
        self.send_header('Content-Type', 'text/html')
        self.end_headers()
        self.wfile.write(b'''<!doctype html><title>tries</title><link rel=icon href="data:,"><script>
const socket = new WebSocket('ws://ROBOT/socket');
const tried = new Promise((done) => { socket.onopen = () => done('opened'); socket.onerror = () => done('refused'); });
const posted = fetch('http://ROBOT/logout', {method: 'POST', mode: 'no-cors', credentials: 'include'}).catch(() => null);
Promise.all([tried, posted]).then((all) => { document.title = all[0]; });
</script>'''.replace(b'ROBOT', f'127.0.0.1:{Stranger.port}'.encode()))

    def log_message(self, *_):
        pass


class Visit:
    def __init__(self, driver, port, host='127.0.0.1', camera=''):
        self.driver = driver
        self.driver.get(f'http://{host}:{port}/#{camera}')

    def wait(self, what, question):
        WebDriverWait(self.driver, PATIENCE, ignored_exceptions=(Exception,)).until(lambda _: question(), what)

    def one(self, identity):
        return self.driver.find_element(By.ID, identity)

    def status(self):
        return self.one('status').text

    def log_in(self, user, password):
        self.wait('the entrance', lambda: self.one('password').is_displayed())
        self.one('user').send_keys(user)
        self.one('password').send_keys(password + Keys.ENTER)

    def has_picture(self):
        """Whether the canvas shows a picture and nothing covers it."""
        return self.one('veil').text == '' and self.driver.execute_script(
            "const c = document.getElementById('picture');"
            "return c.getContext('2d').getImageData(0, 0, c.width, c.height).data.some((v, k) => k % 4 < 3 && v > 60)")

    def screenshots(self, folder):
        for name, (width, height, mobile) in SIZES.items():
            self.driver.execute_cdp_cmd('Emulation.setDeviceMetricsOverride', {
                'width': width, 'height': height, 'deviceScaleFactor': 1, 'mobile': mobile})
            time.sleep(1)
            self.driver.save_screenshot(str(folder / f'{name}.png'))
            # Nothing is wider than the screen, and the way to stop is on it.
            assert self.driver.execute_script('return document.documentElement.scrollWidth') <= width, name
            box = self.one('stop').rect
            assert box['y'] + box['height'] <= height and box['width'] >= 90 and box['height'] >= 90, (name, box)
            self.covers_nothing(name, folder)

    def covers_nothing(self, name, folder):
        """Wherever the page is scrolled to, STOP is in sight and no button lies under another."""
        for place in (0, .3, .6, 1):
            self.driver.execute_script(
                "const all = document.getElementById('scroller'); all.scrollTop = arguments[0] * all.scrollHeight", place)
            self.wait('STOP is in sight', lambda: self.driver.execute_script("""
                return ['stop', 'stop-too'].some((id) => {
                  const box = document.getElementById(id).getBoundingClientRect();
                  return box.height > 0 && box.bottom > 8 && box.top < innerHeight - 8;
                })"""))
            end = time.monotonic() + 5  # the row of STOP comes and goes a frame after it is scrolled
            while (covered := self.driver.execute_script(COVERED)) and time.monotonic() < end:
                time.sleep(.1)
            assert not covered, f'{name}, scrolled to {place}: {covered} lie under something'
        self.driver.save_screenshot(str(folder / f'{name}-end.png'))
        self.driver.execute_script("document.getElementById('scroller').scrollTop = 0")


def owner_visits(driver, port, one_time, folder, robot, process):
    page = Visit(driver, port)
    page.wait('the entrance', lambda: page.one('password').is_displayed())
    assert not [one.text for one in driver.find_elements(By.TAG_NAME, 'button') if one.is_displayed() and one.text == 'STOP']
    driver.save_screenshot(str(folder / 'entrance.png'))
    page.log_in('owner', one_time)
    page.wait('the form for the first password', lambda: page.one('new').is_displayed())
    page.one('new').send_keys('long enough')
    page.one('again').send_keys('long enough' + Keys.ENTER)
    page.wait('a picture', page.has_picture)
    page.screenshots(folder)
    # An arrow key turns by hand, STOP keeps it so, Automatic gives the head back.
    driver.execute_cdp_cmd('Input.dispatchKeyEvent', {'type': 'keyDown', 'key': 'ArrowRight', 'code': 'ArrowRight'})
    page.wait('turned by hand', lambda: 'manual' in page.status() or 'limited' in page.status())
    assert not page.one('stopped').is_displayed()
    driver.execute_cdp_cmd('Input.dispatchKeyEvent', {'type': 'keyUp', 'key': 'ArrowRight', 'code': 'ArrowRight'})
    page.one('stop').click()
    page.wait('it says that it is stopped', lambda: page.one('stopped').is_displayed() and 'Head\nstopped' in page.status())
    driver.save_screenshot(str(folder / 'stopped.png'))
    page.one('auto').click()
    page.wait('automatic', lambda: 'manual' not in page.status() and not page.one('stopped').is_displayed())
    why_it_stands(driver)
    values_in_force(driver, page)
    lost_connection(driver, page)
    silent_robot(driver, page, process)
    two_cameras(driver, page, folder)
    drives_by_keys(driver, page, robot / 'drive')
    follows_by_tap(driver, page)
    driver.execute_script("document.getElementById('passwords').open = true")
    choose = lambda role: driver.execute_script("document.getElementById('whose').value = arguments[0]", role)
    for role in ('operator', 'viewer'):
        choose(role)
        page.one('theirs').send_keys('also long' + Keys.ENTER)
        choose('owner')  # before the answer comes
        page.wait('a password is set', lambda role=role: f'{role} is set' in page.one('word').text)
        assert 'good' in page.one('word').get_attribute('class')
    two_tabs(driver, page, port)
    events(driver, page, robot)
    many_events(driver, page, robot, folder)
    stranger(driver, page, port)
    driver.find_element(By.CSS_SELECTOR, '[data-mode=privacy]').click()
    page.wait('privacy', lambda: 'Privacy' in page.one('veil').text and 'off' in page.status())
    driver.save_screenshot(str(folder / 'privacy.png'))
    for button in driver.find_elements(By.CSS_SELECTOR, '#steering button, #speed, #drive-pad button'):
        assert not button.is_enabled(), button.text
    driver.find_element(By.CSS_SELECTOR, '[data-mode=armed]').click()
    page.wait('a picture again', page.has_picture)
    driver.find_element(By.CSS_SELECTOR, '[data-mode=armed]').click()
    page.one('logout').click()
    page.wait('logged out', lambda: page.one('password').is_displayed())


def values_in_force(driver, page):
    """The settings show what is in force, also after it was changed elsewhere."""
    value = lambda: driver.execute_script("return document.querySelector('#live-settings [name=quality]').value")
    page.wait('the quality of the file', lambda: value() == '75')
    driver.execute_script("send('set quality 60')")
    page.wait('the quality of now', lambda: value() == '60')


def lost_connection(driver, page):
    """What cannot be sent cannot be pressed; then the page comes back by itself."""
    enabled = driver.execute_async_script("""
        const done = arguments[0];
        socket.addEventListener('close', () => setTimeout(() => done(
          [...document.querySelectorAll('#steering button, [data-mode], #drive-pad button, #stop-too')]
            .filter((one) => !one.disabled && one.getClientRects().length).map((one) => one.textContent))));
        socket.close()""")
    assert enabled == [], enabled
    page.wait('connected again', lambda: page.one('stop').is_enabled() and page.has_picture())


def silent_robot(driver, page, process):
    """A robot that says no farewell is noticed: nothing can be pressed that would not arrive."""
    assert not severe(driver)
    process.send_signal(signal.SIGSTOP)
    try:
        page.wait('STOP cannot be pressed', lambda: not page.one('stop').is_enabled())
        assert 'lost' in page.one('veil').text and not page.has_picture()
    finally:
        process.send_signal(signal.SIGCONT)
    page.wait('connected again', lambda: page.one('stop').is_enabled() and page.has_picture())
    driver.get_log('browser')  # attempts to connect that failed


def two_cameras(driver, page, folder):
    """A camera that is down shows nothing of the one before, and a reload comes back to it."""
    objects = lambda: 'Objects' in page.status() or 'Looks at' in page.status()
    page.wait('facts of the first camera', objects)
    choose = lambda name: driver.execute_script("choose(arguments[0])", name)
    choose('broken')
    assert not objects() and not page.has_picture()
    page.wait('it says why', lambda: 'waiting' in page.one('veil').text)
    time.sleep(1.5)  # pictures that were on their way
    assert not objects() and driver.execute_script('return facts') is None
    driver.save_screenshot(str(folder / 'down.png'))
    driver.refresh()
    page.wait('the same camera', lambda: driver.execute_script('return cameraName') == 'broken'
              and page.one('camera').get_attribute('value') == 'broken')
    assert not objects()
    choose('front')
    page.wait('the first camera again', page.has_picture)


def kiosk(driver, port, program, folder, restart):
    """A screen without a keyboard is let in by its token, and comes back by itself after a restart."""
    made = subprocess.run([program, '--make-device-token', folder / 'robot.toml'], capture_output=True, text=True, check=True)
    driver.get('about:blank')
    driver.get(re.search(r'http://\S+#device=[0-9a-f]{64}', made.stdout)[0])
    page = Visit.__new__(Visit)
    page.driver = driver
    page.wait('a picture without a password', page.has_picture)
    assert 'device' not in driver.current_url and not page.one('logout').is_displayed()
    restart()
    page.wait('the connection is lost', lambda: 'lost' in page.one('veil').text)
    page.wait('a picture after the restart', page.has_picture)


def why_it_stands(driver):
    """What the watchdog stopped goes on by itself; everything else waits for an order, and says why."""
    says = lambda stopped, head, reason: driver.execute_script(
        'return whyStands({state: "running", stopped: arguments[0], head: arguments[1], "head-reason": arguments[2]})', stopped, head, reason)
    assert says(False, 'tracking', 'track 4') == '' == says(False, 'fault', 'no answer')
    by_itself = says(False, 'stopped', 'no frame came for 500 ms')
    assert 'no frame came for 500 ms' in by_itself and 'by itself' in by_itself and 'Stopped' not in by_itself, by_itself
    assert says(True, 'manual', 'manual command: stop').startswith('Stopped. '), says(True, 'manual', 'manual command: stop')
    waits = says(True, 'manual', 'its order was not repeated')
    assert 'its order was not repeated' in waits and 'until Automatic' in waits, waits
    assert 'until Automatic' in says(True, 'stopped', 'no frame came for 500 ms')


def follows_by_tap(driver, page):
    """A tap on an object gives its number to the head, which then is not turned by hand."""
    page.one('stop').click()
    page.wait('stopped', lambda: 'manual' in page.status() or 'stopped' in page.status())

    def tapped():
        if 'follows number' in page.one('word').text:
            return True
        where = driver.execute_script("""
            const one = facts && facts.objects && facts.objects.find((object) => object.id !== null);
            const box = picture.getBoundingClientRect();
            return one ? [box.left + (one.x + one.w / 2) / facts.width * box.width,
                          box.top + (one.y + one.h / 2) / facts.height * box.height] : null""")
        for kind in ('mousePressed', 'mouseReleased') if where else ():
            driver.execute_cdp_cmd('Input.dispatchMouseEvent', {
                'type': kind, 'x': where[0], 'y': where[1], 'button': 'left', 'clickCount': 1})
        return False
    driver.execute_script("document.getElementById('scroller').scrollTop = 0")
    page.wait('a tap follows', tapped)
    page.wait('the head follows', lambda: not re.search('manual|stopped', page.status()))
    page.wait('the frames say so', lambda: 'chosen (track' in page.status())
    # A person who is gone is followed by nobody, and the page says that.
    driver.execute_script("""
        const all = facts.objects;
        facts.objects = [{id: 4000, x: 0, y: 0, w: facts.width, h: facts.height}];
        const box = picture.getBoundingClientRect();
        follow({clientX: box.left + 5, clientY: box.top + 5});
        facts.objects = all;
        window.words = [];
        new MutationObserver(() => words.push(at('word').textContent)).observe(at('word'), {childList: true})""")
    page.wait('it says that 4000 is gone', lambda: 'number 4000 is gone' in driver.execute_script('return words'))
    assert 'follows number 4000' not in driver.execute_script('return words')


def two_tabs(driver, page, port):
    """Of two sessions one steers; the other one is refused, but it may stop."""
    driver.execute_script("window.holder = setInterval(() => send('turn 0.2 0'), 100)")
    first = driver.current_window_handle
    driver.switch_to.new_window('tab')
    # An address of its own, so that its session is another one; what it names is no encoding of a camera's name.
    other = Visit(driver, port, 'localhost', '50%')
    other.log_in('operator', 'also long')
    other.wait('a picture', other.has_picture)

    # Where the first tab was silent for too long the second one has the head: it gives it back before it tries again.
    def is_refused():
        driver.execute_script("send('turn -0.5 0'); send('auto')")
        return 'else is steering' in other.one('word').text
    other.wait('the second tab is refused', is_refused)
    driver.execute_script("document.getElementById('word').textContent = ''")
    other.one('stop').click()
    driver.switch_to.window(first)
    page.wait('the first tab is stopped', lambda: 'stopped from another page' in page.one('word').text)
    driver.execute_script("clearInterval(window.holder); send('turn 0 0')")
    driver.switch_to.window(driver.window_handles[-1])
    other.one('logout').click()
    other.wait('logged out', lambda: other.one('password').is_displayed())
    driver.close()
    driver.switch_to.window(first)


def events(driver, page, robot):
    """A recording is filtered, opened, and deleted with all that belongs to it."""
    items = lambda: driver.find_elements(By.CSS_SELECTOR, '#strip li')
    label = lambda words: [one for one in driver.find_elements(By.CSS_SELECTOR, '#strip button') if one.text == words]
    # The page may show its list anew between the search and the click.
    press = lambda words: page.wait(f'{words} is pressed', lambda: label(words)[0].click() or True)

    def has_ended():
        page.one('reload').click()
        time.sleep(.3)
        return label('Delete')
    page.wait('a recording that ended', has_ended)
    driver.find_element(By.CSS_SELECTOR, '[data-mode=disarmed]').click()  # no further one begins
    page.wait('disarmed', lambda: 'disarmed' in page.one('mode-now').text and page.one('recording').text == 'not recording')
    page.one('filter-kept').click()
    page.wait('no kept one', lambda: [one.text for one in items()] == ['No event is like that.'])
    page.one('filter-kept').click()
    page.wait('all of them', lambda: label('Keep'))
    press('Keep')
    page.wait('it is kept', lambda: label('Free'))
    page.one('filter-kept').click()
    page.wait('the kept one', lambda: len(items()) == 1 and label('Free'))
    driver.execute_script("arguments[0].value = 'track'; arguments[0].dispatchEvent(new Event('change'))", page.one('filter-reason'))
    page.wait('the kept one of this reason', lambda: len(items()) == 1 and label('Free'))
    identity = re.search('/events/front/([0-9]+)/video', driver.find_element(By.CSS_SELECTOR, '#strip a').get_attribute('href'))[1]
    press('Play')
    page.wait('it is opened', lambda: page.one('video').is_displayed() and driver.execute_script(
        "const video = document.getElementById('video'); return video.videoWidth > 0 || video.error"))
    page.one('shut').click()
    page.wait('it is shut', lambda: not page.one('video').is_displayed())
    with sqlite3.connect(f'file:{robot}/recordings/recordings.sqlite?mode=ro', uri=True) as database:
        rows = lambda: database.execute('select file, picture from recordings where id = ?', (identity,)).fetchall()
        stem = pathlib.Path(rows()[0][0]).stem
        files = lambda: sorted(one.suffix for one in (robot / 'recordings').rglob(stem + '.*'))
        # The last part of an event without an object has no picture.
        whole = 3 if rows()[0][1] else 2
        assert len(files()) == whole, files()
        press('Delete')
        driver.switch_to.alert.dismiss()
        assert len(files()) == whole and rows(), 'deleted without consent'
        press('Delete')
        driver.switch_to.alert.accept()
        page.wait('it is deleted', lambda: not label('Free'))
        assert not files() and not rows(), (files(), rows())
    page.one('filter-kept').click()


def many_events(driver, page, robot, folder):
    """The filters ask the index, of which the page shows a part; events appear and end by themselves."""
    items = lambda: [one.text for one in driver.find_elements(By.CSS_SELECTOR, '#strip li')]
    choose = lambda what, value: driver.execute_script(
        "arguments[0].value = arguments[1]; arguments[0].dispatchEvent(new Event('change'))", page.one(what), value)
    noon = lambda month, day: int(time.mktime((2026, month, day, 12, 0, 0, 0, 0, -1))) * 10**9
    with sqlite3.connect(robot / 'recordings' / 'recordings.sqlite', timeout=PATIENCE) as database:
        for number in range(600):
            old = number < 3
            begin = noon(1, 5) if old else noon(2, 6) + number * 10**9
            database.execute(
                'insert into recordings (file, camera, event, begin, end, reason, kinds, people, size, open, keep) values '
                "(?, 'front', ?, ?, ?, ?, ?, ?, 1000, 0, ?)",
                (f'many/{number}.mkv', number, begin, begin + 14 * 10**9, f'track {number}', 'person-like' if old else 'part',
                 2 if old else 0, number == 1))
    database.close()
    page.one('reload').click()
    page.wait('the newest 50', lambda: len(items()) == 50 and page.one('older').is_displayed())
    assert not any(re.search('track [0-9]', one) for one in items()) and items()[0].startswith('Movement, 14 s'), items()[0]
    page.one('older').click()
    page.wait('older ones', lambda: len(items()) == 100)
    choose('filter-day', '2026-01-05')
    page.wait('the events of a day', lambda: len(items()) == 3 and not page.one('older').is_displayed())
    assert all(one.startswith('2 people, 14 s') for one in items()), items()
    driver.execute_script("document.getElementById('strip').scrollIntoView()")
    driver.save_screenshot(str(folder / 'events.png'))
    save = driver.find_element(By.CSS_SELECTOR, '#strip a').get_attribute('download')
    assert save == 'front_2026-01-05_12-00-00.mkv', save
    page.one('filter-kept').click()
    page.wait('the kept one of that day', lambda: len(items()) == 1 and 'kept' in items()[0])
    choose('filter-day', '2026-01-06')
    page.wait('a day without events', lambda: items() == ['No event is like that.'])
    choose('filter-day', '')
    page.wait('the kept one of all', lambda: len(items()) == 1 and '2 people' in items()[0])
    page.one('filter-kept').click()
    driver.find_element(By.CSS_SELECTOR, '[data-mode=armed]').click()
    page.wait('an event that begins', lambda: 'being recorded' in items()[0])
    driver.find_element(By.CSS_SELECTOR, '[data-mode=disarmed]').click()
    page.wait('its end', lambda: items() and not any('being recorded' in one for one in items()))
    with sqlite3.connect(robot / 'recordings' / 'recordings.sqlite', timeout=PATIENCE) as database:
        database.execute("delete from recordings where file like 'many/%'")
    database.close()


def stranger(driver, page, port):
    """Cookies do not tell ports apart: only its origin tells that a page is none of the robot's."""
    Stranger.port = port
    server = http.server.ThreadingHTTPServer(('127.0.0.1', 0), Stranger)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    own = severe(driver)
    assert not own, own
    first = driver.current_window_handle
    driver.switch_to.new_window('tab')
    driver.get(f'http://127.0.0.1:{server.server_port}/')
    page.wait('the stranger has tried', lambda: driver.title in ('opened', 'refused'))
    assert driver.title == 'refused', driver.title
    assert any('/socket' in entry['message'] for entry in driver.get_log('browser'))
    driver.close()
    driver.switch_to.window(first)
    server.shutdown()
    server.server_close()
    assert driver.execute_script("return fetch('/session').then((answer) => answer.json())")['role'] == 'owner'


def severe(driver):
    return [entry for entry in driver.get_log('browser') if entry['level'] == 'SEVERE'
            and '/events' not in entry['message'] and '/reasons' not in entry['message'] and '/login' not in entry['message']]


def key(driver, kind, name, code, **more):
    driver.execute_cdp_cmd('Input.dispatchKeyEvent', {'type': kind, 'key': name, 'code': code} | more)


def drives_by_keys(driver, page, drive):
    """A key that is released with Shift is released; STOP holds while a key is still held."""
    def rests():
        earlier = drive.read_text()
        time.sleep(.6)
        return earlier.endswith('stop\n') and earlier == drive.read_text()
    driver.execute_script('document.activeElement.blur()')
    page.wait('the program of the base', drive.exists)
    key(driver, 'keyDown', 'w', 'KeyW')
    page.wait('driven', lambda: 'drive 0.5 0' in drive.read_text())
    key(driver, 'keyDown', 'Shift', 'ShiftLeft')
    key(driver, 'keyUp', 'W', 'KeyW')
    key(driver, 'keyUp', 'Shift', 'ShiftLeft')
    page.wait('the end of a drive', rests)
    key(driver, 'keyDown', 's', 'KeyS')
    page.wait('driven back', lambda: 'drive -0.5 0' in drive.read_text())
    key(driver, 'keyDown', 'Escape', 'Escape')
    for _ in range(3):
        key(driver, 'keyDown', 's', 'KeyS', autoRepeat=True)
    page.wait('STOP while a key is held', rests)
    key(driver, 'keyUp', 's', 'KeyS')


def viewer_visits(driver, port):
    page = Visit(driver, port)
    page.log_in('viewer', 'a guess')
    page.wait('refused', lambda: page.one('entrance-word').text == 'wrong password')
    page.log_in('viewer', 'also long')
    page.wait('a picture', page.has_picture)
    for button in driver.find_elements(By.CSS_SELECTOR, '#steering button, [data-mode]'):
        assert not button.is_enabled(), button.text
    assert not page.one('passwords').is_displayed()
    page.one('logout').click()
    page.wait('logged out', lambda: page.one('password').is_displayed())


def guesses(driver, port):
    """Eleven wrong passwords: after a few the page asks for patience, also for the right one. A slow machine may have
    waited before a guess, which then is judged; the wait doubles, until there is time enough for the right one."""
    page, words, seconds = Visit(driver, port), [], 0
    page.wait('the entrance', lambda: page.one('password').is_displayed())
    page.one('user').send_keys('operator')

    def answer(password):
        driver.execute_script("document.getElementById('entrance-word').textContent = ''")
        page.one('password').send_keys(password + Keys.ENTER)
        page.wait('an answer', lambda: page.one('entrance-word').text)
        return page.one('entrance-word').text
    while len(words) < 11 or seconds < LEAST_WAIT:
        words.append(answer('a guess'))
        found = re.search(r'too many wrong passwords: wait (\d+) s', words[-1])
        seconds = int(found[1]) if found else 0
    assert words[0] == 'wrong password', words
    last = answer('also long')
    assert 'too many wrong passwords' in last, (words, last)


def main():
    with tempfile.TemporaryDirectory() as name:
        folder, port = pathlib.Path(name), free_port()
        pictures = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else folder
        (folder / 'robot.toml').write_text(CONFIGURATION.replace('PORT', str(port)) + f'''
[base]
command = "sh -c 'cat >> {name}/drive'"
max-speed = 0.5
[[camera]]
name = "broken"
kind = "file"
file = "no-video.avi"
''')
        (folder / 'no-video.avi').write_text('this is no video')
        with open(folder / 'log', 'w+', encoding='utf-8') as log:
            start = lambda: subprocess.Popen([sys.argv[1], folder / 'robot.toml'], stdout=log, stderr=subprocess.STDOUT)
            process, driver = start(), None

            def restart():
                nonlocal process
                process.send_signal(signal.SIGTERM)
                process.wait(PATIENCE)
                process = start()
            try:
                driver = browser()
                end, one_time = time.monotonic() + PATIENCE, None
                while not one_time and time.monotonic() < end:
                    one_time = re.search(r'One-time password .*: ([0-9a-f]{16})\n', (folder / 'log').read_text())
                    time.sleep(.05)
                assert one_time, 'cerberusd printed no one-time password'
                owner_visits(driver, port, one_time[1], pictures, folder, process)
                viewer_visits(driver, port)
                guesses(driver, port)
                errors = severe(driver)
                assert not errors, errors
                kiosk(driver, port, sys.argv[1], folder, restart)
            except BaseException:
                print((folder / 'log').read_text(), file=sys.stderr)
                raise
            finally:
                try:
                    if driver:
                        driver.quit()
                    process.send_signal(signal.SIGTERM)
                    process.wait(PATIENCE)
                finally:
                    process.kill()


if __name__ == '__main__':
    main()
