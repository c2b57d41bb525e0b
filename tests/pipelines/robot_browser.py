#!/usr/bin/env python3
# SPDX-License-Identifier: LGPL-2.1-or-later
"""The page of cerberusd in Chromium: first password, log in, watch, steer, stop, privacy, a viewer who may not steer. With
a folder as second argument it leaves screenshots of a phone, an 800x480 touch screen and a desktop there. Skipped where
chromium, chromium-driver and python3-selenium are not installed."""
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from robot_page import CONFIGURATION, free_port

PATIENCE = 100  # seconds

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

SIZES = {'phone': (390, 844, True), 'touch-screen': (800, 480, False), 'desktop': (1280, 800, False)}


def browser():
    options = webdriver.ChromeOptions()
    for argument in ('--headless=new', '--no-sandbox', '--disable-gpu', '--disable-dev-shm-usage', '--window-size=1280,800'):
        options.add_argument(argument)
    options.set_capability('goog:loggingPrefs', {'browser': 'ALL'})
    return webdriver.Chrome(service=Service(DRIVER), options=options)


class Visit:
    def __init__(self, driver, port):
        self.driver = driver
        self.driver.get(f'http://127.0.0.1:{port}/')

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


def owner_visits(driver, port, one_time, folder, robot):
    page = Visit(driver, port)
    page.log_in('owner', one_time)
    page.wait('the form for the first password', lambda: page.one('new').is_displayed())
    page.one('new').send_keys('long enough')
    page.one('again').send_keys('long enough' + Keys.ENTER)
    page.wait('a picture', page.has_picture)
    page.screenshots(folder)
    # An arrow key turns by hand, STOP keeps it so, Automatic gives the head back.
    driver.execute_cdp_cmd('Input.dispatchKeyEvent', {'type': 'keyDown', 'key': 'ArrowRight', 'code': 'ArrowRight'})
    page.wait('turned by hand', lambda: 'manual' in page.status() or 'limited' in page.status())
    driver.execute_cdp_cmd('Input.dispatchKeyEvent', {'type': 'keyUp', 'key': 'ArrowRight', 'code': 'ArrowRight'})
    page.one('stop').click()
    page.one('auto').click()
    page.wait('automatic', lambda: 'manual' not in page.status())
    drives_by_keys(driver, page, robot / 'drive')
    driver.execute_script("document.getElementById('passwords').open = true")
    page.one('whose').send_keys('viewer')
    page.one('theirs').send_keys('also long' + Keys.ENTER)
    page.wait('a password is set', lambda: 'is set' in page.one('word').text)
    driver.find_element(By.CSS_SELECTOR, '[data-mode=privacy]').click()
    page.wait('privacy', lambda: 'Privacy' in page.one('veil').text and 'off' in page.status())
    driver.find_element(By.CSS_SELECTOR, '[data-mode=armed]').click()
    page.wait('a picture again', page.has_picture)
    driver.find_element(By.CSS_SELECTOR, '[data-mode=armed]').click()
    page.one('logout').click()
    page.wait('logged out', lambda: page.one('password').is_displayed())


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


def main():
    with tempfile.TemporaryDirectory() as name:
        folder, port = pathlib.Path(name), free_port()
        pictures = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else folder
        (folder / 'robot.toml').write_text(CONFIGURATION.replace('PORT', str(port)) + f'''
[base]
command = "sh -c 'cat >> {name}/drive'"
max-speed = 0.5
''')
        with open(folder / 'log', 'w+', encoding='utf-8') as log:
            process = subprocess.Popen([sys.argv[1], folder / 'robot.toml'], stdout=log, stderr=subprocess.STDOUT)
            driver = None
            try:
                driver = browser()
                end, one_time = time.monotonic() + PATIENCE, None
                while not one_time and time.monotonic() < end:
                    one_time = re.search(r'One-time password .*: ([0-9a-f]{16})\n', (folder / 'log').read_text())
                    time.sleep(.05)
                assert one_time, 'cerberusd printed no one-time password'
                owner_visits(driver, port, one_time[1], pictures, folder)
                viewer_visits(driver, port)
                errors = [entry for entry in driver.get_log('browser') if entry['level'] == 'SEVERE'
                          and '/events' not in entry['message'] and '/login' not in entry['message']]
                assert not errors, errors
            except BaseException:
                print((folder / 'log').read_text(), file=sys.stderr)
                raise
            finally:
                if driver:
                    driver.quit()
                process.send_signal(signal.SIGTERM)
                process.wait(PATIENCE)


if __name__ == '__main__':
    main()
