// SPDX-License-Identifier: LGPL-2.1-or-later
// The page of cerberusd. Messages: docs/manual/robot.md.
'use strict';

const at = (id) => document.getElementById(id);
const kRepeat = 150;  // ms between repetitions of a move, which ends 500 ms after the last one
let socket = null, hello = null, state = null, facts = null, cameraName = '';
let gone = false, silent = 0, shown = '';  // `shown`: the camera of which the socket's pictures are

// ---- log-in

async function post(path, fields) {
  const response = await fetch(path, {method: 'POST', body: new URLSearchParams(fields)});
  return {ok: response.ok, text: (await response.text()).trim()};
}

// The address may hold a device's token once, or the name of the camera that is shown: #device=TOKEN, #NAME.
async function useToken() {
  const token = /^#device=(.+)$/.exec(location.hash);
  if (!token) return;
  history.replaceState(null, '', location.pathname);
  const done = await post('/login', {device: token[1]});
  if (!done.ok) at('entrance-word').textContent = done.text;
}

async function enter() {
  await useToken();
  const session = await (await fetch('/session')).json();
  for (const name of document.querySelectorAll('.robot-name')) name.textContent = session.robot;
  document.title = session.robot;
  const inside = session.role && !session['must-set-password'];
  at('entrance').hidden = inside;
  at('room').hidden = !inside;
  document.body.classList.toggle('inside', Boolean(inside));
  at('logout').hidden = session.device;  // it would come back by itself, and has no keyboard for a password
  showStop();
  at('login').hidden = Boolean(session.role);
  at('first-hint').hidden = !session.first;
  at('new-password').hidden = !session['must-set-password'];
  if (inside) connect();
  else (session.role ? at('new') : at('password')).focus();
}

at('login').addEventListener('submit', async (event) => {
  event.preventDefault();
  const done = await post('/login', {user: at('user').value, password: at('password').value});
  at('password').value = '';
  at('entrance-word').textContent = done.ok ? '' : done.text;
  if (done.ok) enter();
});

at('new-password').addEventListener('submit', async (event) => {
  event.preventDefault();
  if (at('new').value !== at('again').value) {
    at('entrance-word').textContent = 'the two passwords differ';
    return;
  }
  const done = await post('/password', {user: 'owner', password: at('new').value});
  at('entrance-word').textContent = done.ok ? '' : done.text;
  if (done.ok) enter();
});

at('logout').addEventListener('click', async () => {
  gone = true;
  await post('/logout', {});
  location.reload();
});

// ---- the socket

function send(words) {
  if (socket && socket.readyState === WebSocket.OPEN) socket.send(words);
}

function connect() {
  socket = new WebSocket(`${location.protocol === 'https:' ? 'wss' : 'ws'}://${location.host}/socket`);
  socket.binaryType = 'arraybuffer';
  shown = '';
  silent = 0;
  socket.onopen = () => enableButtons();
  socket.onmessage = (event) => {
    if (event.target !== socket) return;
    silent = 0;
    if (typeof event.data === 'string') onReport(JSON.parse(event.data));
    else onPicture(event.data, event.target);
  };
  socket.onclose = (event) => event.target === socket && lose();
}

// Said at once: a socket whose robot is out of reach takes its time to close.
function lose() {
  const lost = socket;
  socket = null;
  lost.close();
  letGo();
  enableButtons();
  if (gone) return;
  forgetPicture();
  veil('The connection is lost. It is tried again.');
  setTimeout(async () => {
    try {
      const session = await (await fetch('/session', {signal: AbortSignal.timeout(kSilence)})).json();
      if (session.role) socket || connect();
      else location.reload();
    } catch {
      socket || setTimeout(() => socket || connect(), 2000);
    }
  }, 1000);
}

// A robot that is switched off, or whose network is gone, says no farewell. It reports every second.
const kSilence = 3000;  // ms
// Counted in looks, not by a clock: a page that is busy itself finds its messages before it has looked so often.
const kLook = 500;  // ms
setInterval(() => socket && ++silent * kLook > kSilence && lose(), kLook);

let wordTimer = 0;
function say(word, good = false) {
  at('word').textContent = word;
  at('word').className = good ? 'good' : '';
  clearTimeout(wordTimer);
  wordTimer = setTimeout(() => { at('word').textContent = ''; }, 4000);
}

function veil(text) {
  at('veil').textContent = text;
}

function may(role) {
  const roles = ['viewer', 'operator', 'owner'];
  return hello && roles.indexOf(hello.role) >= roles.indexOf(role);
}

const connected = () => Boolean(socket) && socket.readyState === WebSocket.OPEN;

// What was shown of one camera is no picture of another, nor of one that is down.
function forgetPicture() {
  pen.clearRect(0, 0, picture.width, picture.height);
  facts = null;
  drawRadar();
}

function onReport(report) {
  if (report.shows) shown = report.shows;
  if (report.done === 'stopped') say('Stopped.', true);
  if (report.refused) {
    say(report.refused);
    choice = null;
    letGo();
  }
  if (report.hello) {
    hello = report.hello;
    const wanted = cameraName || named();
    at('camera').replaceChildren(...hello.cameras.map((camera) => new Option(camera.name)));
    at('camera').hidden = hello.cameras.length < 2;
    at('base').hidden = !hello.base;
    choose(hello.cameras.some((camera) => camera.name === wanted) ? wanted : hello.cameras[0].name);
  }
  if (report.number) {
    send(`seen ${report.number}`);
    const before = state && state.mode;
    const recorded = state && state.events;
    state = report;
    showState();
    showFleet();
    if (before !== state.mode || recorded !== state.events) loadEvents();
  }
}

// By the address; what is no encoding of a name names none.
function named() {
  try {
    return decodeURIComponent(location.hash.slice(1));
  } catch {
    return '';
  }
}

function choose(name) {
  if (cameraName !== name) {
    cameraName = name;
    choice = null;
    forgetPicture();
    veil('The picture is on its way.');
  }
  // A reload, and a screen that starts by itself, come back to it.
  if (hello.cameras.length > 1) history.replaceState(null, '', `#${encodeURIComponent(name)}`);
  at('camera').value = name;
  showSettings();
  send(`camera ${name}`);
  enableButtons();
  if (state) showState();
  loadEvents(kPage);
}
at('camera').addEventListener('change', () => choose(at('camera').value));
window.addEventListener('hashchange', async () => {
  if (location.hash.startsWith('#device=')) return location.reload();
  const name = named();
  if (hello && name !== cameraName && hello.cameras.some((camera) => camera.name === name)) choose(name);
});

const mine = () => state && state.cameras.find((camera) => camera.name === cameraName);
const about = () => hello && hello.cameras.find((camera) => camera.name === cameraName);
const isRecording = () => state.cameras.some((camera) => camera.recording);

at('set-password').addEventListener('submit', async (event) => {
  event.preventDefault();
  const role = at('whose').value, password = at('theirs').value;  // the form may say another when the answer comes
  at('theirs').value = '';
  const done = await post('/password', {user: role, password});
  say(done.ok ? `The password of the ${role} is set.` : `The password of the ${role} is not set: ${done.text}`, done.ok);
});

function enableButtons() {
  at('passwords').hidden = !may('owner');
  for (const button of document.querySelectorAll('#steering button, #speed')) button.disabled = !steers();
  at('stop').disabled = !stops();
  for (const button of document.querySelectorAll('#drive-pad button')) button.disabled = !drives();
  at('stage').disabled = !may('operator') || !connected();
  for (const input of document.querySelectorAll('#live-settings input')) input.disabled = !connected();
  showStop();
  at('log-box').hidden = at('settings').hidden = !may('owner');
  for (const button of document.querySelectorAll('[data-mode]')) {
    const needsOwner = button.dataset.mode === 'privacy' || (state && state.mode === 'privacy');
    button.disabled = !connected() || !may(needsOwner ? 'owner' : 'operator');
    button.setAttribute('aria-pressed', String(Boolean(state) && state.mode === button.dataset.mode));
  }
}

// An empty text: the head does not stand, or the fault says why.
function whyStands(camera) {
  const until = 'The head stays so until it is steered, or until Automatic.';
  const why = camera['head-reason'];
  if (camera.stopped) return camera.head === 'fault' || !why || why.endsWith(': stop') ? `Stopped. ${until}` : `Stopped: ${why}. ${until}`;
  return camera.head === 'stopped' && camera.state === 'running' ? `The head stands: ${why}. It goes on by itself.` : '';
}

function showState() {
  enableButtons();
  at('mode-now').textContent = state.mode;
  const on = isRecording(), fails = state.cameras.some((camera) => camera['recording-fault']);
  at('recording').textContent = fails ? 'RECORDING FAILS' : on ? '\u25cf REC' : 'not recording';
  at('recording').className = fails ? 'fails' : on ? 'on' : '';
  const camera = mine();
  if (!camera) return;
  if (state.mode === 'privacy') {
    forgetPicture();
    veil('Privacy: nothing is shown or recorded.');
  } else if (camera.state !== 'running') {
    forgetPicture();
    veil(`The camera is ${camera.state}. ${camera.fault}`);
  }
  const stands = whyStands(camera);
  at('stopped').hidden = !stands;
  if (at('stopped').textContent !== stands) at('stopped').textContent = stands;
  showValues(camera);
  const rows = [['Camera', `${camera.state}, ${camera.rate} frames/s`]];
  if (camera.state === 'running' && camera.latency > 0) rows.push(['Latency', `${camera.latency.toFixed(0)} ms until it is analysed`]);
  if (document.activeElement !== at('stage')) at('stage').value = camera.stage;
  if (camera.fault && camera.fault !== camera['recording-fault']) rows.push(['Fault', camera.fault]);
  for (const one of state.cameras)
    if (one['recording-fault']) rows.push(['Recording', `${one.name}: ${one['recording-fault']}`]);
  if (about().head) {
    const is = camera.stopped && camera.head !== 'fault' ? 'stopped' : camera.head;
    rows.push(['Head', is === 'fault' ? `fault: ${camera['head-reason']}` : is || '\u2013']);
  }
  if (facts && facts.pose) rows.push(['Looks at', `${facts.pose.pan.toFixed(1)}\u00b0, ${facts.pose.tilt.toFixed(1)}\u00b0`]);
  if (facts && facts.fusion) {
    const target = facts.fusion.target === null ? '' : ` ${facts.fusion.target}`;
    rows.push(['Rule', `${facts.fusion.name} (${facts.fusion.action}${target})`]);
  }
  if (facts && facts.pir) {
    const words = facts.pir.map((reading) => ['quiet', 'detects', 'not ready'][reading] || 'unknown');
    rows.push(['Sensors', words.join(', ')]);
  }
  if (facts && facts.objects) rows.push(['Objects', String(facts.objects.length)]);
  if (camera.free !== undefined) rows.push(['Free disk', `${(camera.free / 1024).toFixed(1)} GiB`]);
  rows.push(['Processor', state.cpu === null ? '\u2013' : `${state.cpu} %`], ['Viewers', String(state.viewers)],
    ['You are', hello ? hello.role : '']);
  at('status').replaceChildren(...rows.flatMap(([name, value]) => {
    const term = document.createElement('dt'), detail = document.createElement('dd');
    term.textContent = name;
    detail.textContent = value;
    return [term, detail];
  }));
}

// ---- what an owner sees and sets

function showSettings() {
  const mine = (setting) => !setting.head || (about() && about().head);
  at('live-settings').replaceChildren(...hello.settings.filter(mine).map((setting) => {
    const label = document.createElement('label'), input = document.createElement('input');
    label.textContent = setting.words;
    Object.assign(input, {type: 'number', min: setting.least, max: setting.most, step: 'any', name: setting.name});
    input.addEventListener('change', () => {
      if (input.value !== '' && input.reportValidity()) send(`set ${setting.name} ${Number(input.value)}`);
    });
    label.append(input);
    return label;
  }));
}
// The values in force, but for one that is being written.
function showValues(camera) {
  for (const input of document.querySelectorAll('#live-settings input')) {
    const value = camera.settings[input.name];
    if (input !== document.activeElement) input.value = value === undefined ? '' : Number(value);
  }
}
at('live-settings').addEventListener('submit', (event) => event.preventDefault());

async function loadLog() {
  const response = await fetch('/log');
  at('log').textContent = await response.text();
  at('log').scrollTop = at('log').scrollHeight;
}
at('log-box').addEventListener('toggle', () => at('log-box').open && loadLog());
at('log-reload').addEventListener('click', loadLog);
at('stage').addEventListener('change', () => send(`stage ${at('stage').value}`));

// ---- other robots, which publish to the same broker

function parsed(text) {
  try {
    return JSON.parse(text);
  } catch {
    return null;
  }
}

function showFleet() {
  at('fleet').hidden = !state.fleet;
  if (!state.fleet) return;
  const list = at('fleet-list');
  const have = new Map([...list.children].map((item) => [item.dataset.name, item]));
  for (const [name, item] of have) if (!state.fleet.some((camera) => camera.name === name)) item.remove();
  for (const camera of state.fleet) {
    let item = have.get(camera.name);
    if (!item) {
      item = document.createElement('li');
      item.dataset.name = camera.name;
      const words = document.createElement('p'), image = document.createElement('img');
      image.hidden = true;
      image.alt = `Picture of ${camera.name}`;
      words.setAttribute('role', 'status');
      item.append(words, image, button('Picture', `Picture of ${camera.name}`, async () => {
        const done = await post('/picture', {camera: camera.name});
        if (!done.ok) say(done.text);
      }));
      list.append(item);
    }
    const [words, image] = item.children;
    const found = parsed(camera.state), event = parsed(camera.event);
    const parts = [camera.name, camera.status || 'unknown', camera.mode];
    if (camera.status === 'online' && found && found.motion) parts.push(`${found.objects} in sight`);
    if (event) parts.push(`last event ${new Date(event.begin).toLocaleString()}`);
    const text = parts.filter(Boolean).join(', ');
    if (words.textContent !== text) words.textContent = text;
    words.className = camera.status === 'offline' ? 'offline' : '';
    if (camera.picture > 0 && item.dataset.picture !== String(camera.picture)) {
      item.dataset.picture = camera.picture;
      image.src = `/picture/${encodeURIComponent(camera.name)}?${camera.picture}`;
      image.hidden = false;
    } else if (camera.picture === 0) {
      item.dataset.picture = '';
      image.removeAttribute('src');
      image.hidden = true;
    }
  }
}

// ---- picture: number (8 bytes), length of the facts (4 bytes), facts, JPEG

const picture = at('picture'), pen = picture.getContext('2d');

async function onPicture(data, from) {
  const view = new DataView(data);
  const number = view.getBigUint64(0), length = view.getUint32(8);
  const of = shown;  // which camera: it says so before its first picture
  try {
    const image = await createImageBitmap(new Blob([new Uint8Array(data, 12 + length)], {type: 'image/jpeg'}));
    const camera = mine();
    if (from !== socket || of !== cameraName || (state && state.mode === 'privacy') || (camera && camera.state !== 'running'))
      return image.close();
    if (picture.width !== image.width || picture.height !== image.height) {
      picture.width = image.width;
      picture.height = image.height;
      picture.style.setProperty('--shape', image.width / image.height);
    }
    pen.drawImage(image, 0, 0);
    image.close();
    veil('');
    facts = length ? JSON.parse(new TextDecoder().decode(new Uint8Array(data, 12, length))) : null;
    drawRadar();
    watchChoice();
  } finally {
    // Numbers are those of one socket.
    if (from.readyState === WebSocket.OPEN) from.send(`ack ${number}`);
  }
}

// ---- steering: a move is repeated while it lasts

let move = null, repeater = 0;

function turn(pan, tilt) {
  choice = null;
  const limit = (share) => Math.max(-1, Math.min(1, share)).toFixed(3);
  move = `turn ${limit(pan)} ${limit(tilt)}`;
  if (!repeater) {
    send(move);
    repeater = setInterval(() => move && send(move), kRepeat);
  }
}

function release() {
  if (!repeater) return;
  clearInterval(repeater);
  repeater = 0;
  move = null;
  send('turn 0 0');
}

const speed = () => at('speed').value / 100;
const runs = () => connected() && Boolean(state) && state.mode !== 'privacy';
const steers = () => runs() && may('operator') && Boolean(about() && about().head) && mine()?.state === 'running';
// Also while privacy parks the head: what moves can be stopped.
const stops = () => connected() && may('operator') && Boolean(state) && Boolean(
  (hello.base && state.mode !== 'privacy') || (about() && about().head && ['running', 'parking'].includes(mine()?.state)));

for (const button of document.querySelectorAll('#pad button')) {
  const pan = Number(button.dataset.pan), tilt = Number(button.dataset.tilt);
  button.addEventListener('pointerdown', (event) => {
    button.setPointerCapture(event.pointerId);
    turn(pan * speed(), tilt * speed());
  });
  for (const end of ['pointerup', 'pointercancel', 'lostpointercapture']) button.addEventListener(end, release);
  button.addEventListener('contextmenu', (event) => event.preventDefault());
  button.addEventListener('keydown', (event) => {
    if (event.key === 'Enter' && !event.repeat) turn(pan * speed(), tilt * speed());
  });
  button.addEventListener('keyup', release);
}

function stop() {
  choice = null;
  clearInterval(driver);
  driver = 0;
  drive = null;
  driving.clear();
  pressed.clear();
  drag = null;
  clearInterval(repeater);
  repeater = 0;
  move = null;
  send('stop');
}
for (const button of [at('stop'), at('stop-too')]) {
  // At the touch; a click that follows one is not a second stop, one of the keyboard is the first.
  button.addEventListener('pointerdown', () => { if (!button.disabled) stop(); });
  button.addEventListener('click', (event) => { if (event.detail === 0) stop(); });
}
// Another one comes up while the large one is scrolled out of sight, in a row of its own.
let stopInSight = true;
function showStop() {
  at('stop-row').hidden = at('room').hidden || at('stop').disabled || stopInSight;
}
new IntersectionObserver((seen) => {
  stopInSight = seen[seen.length - 1].isIntersecting;
  showStop();
}).observe(at('stop'));
for (const order of ['auto', 'home'])
  at(order).addEventListener('click', () => {
    choice = null;
    send(order);
  });
for (const button of document.querySelectorAll('[data-mode]'))
  button.addEventListener('click', () => send(`mode ${button.dataset.mode}`));

// The base: a key or a button that is held drives, as the head turns.
const drives = () => runs() && may('operator') && Boolean(hello.base);
let drive = null, driver = 0;

function driveTo(speed, yaw) {
  drive = `drive ${speed} ${yaw}`;
  if (!driver) {
    send(drive);
    driver = setInterval(() => drive && send(drive), kRepeat);
  }
}

function park() {
  if (!driver) return;
  clearInterval(driver);
  driver = 0;
  drive = null;
  send('drive 0 0');
}

for (const button of document.querySelectorAll('#drive-pad button')) {
  const speed = Number(button.dataset.speed), yaw = Number(button.dataset.yaw);
  button.addEventListener('pointerdown', (event) => {
    button.setPointerCapture(event.pointerId);
    driveTo(speed, yaw);
  });
  for (const end of ['pointerup', 'pointercancel', 'lostpointercapture']) button.addEventListener(end, park);
  button.addEventListener('contextmenu', (event) => event.preventDefault());
  button.addEventListener('keydown', (event) => {
    if (event.key === 'Enter' && !event.repeat) driveTo(speed, yaw);
  });
  button.addEventListener('keyup', park);
}

// By their places (event.code): a letter is another one while Shift is held, and its key would never be released.
const kDriveKeys = {KeyW: [1, 0], KeyS: [-1, 0], KeyA: [0, -1], KeyD: [0, 1]};
const driving = new Set();

function driveByKeys() {
  const sum = [...driving].reduce((all, key) => [all[0] + kDriveKeys[key][0], all[1] + kDriveKeys[key][1]], [0, 0]);
  if (driving.size) driveTo(...sum);
  else park();
}

const kArrows = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]};
const pressed = new Map();  // by event.code, what event.key was at first

function turnByKeys() {
  let pan = 0, tilt = 0;
  for (const [x, y] of pressed.values()) {
    pan += x;
    tilt += y;
  }
  if (pressed.size) turn(pan * speed(), tilt * speed());
  else release();
}

// A key that repeats itself begins nothing: STOP holds while one is still held.
document.addEventListener('keydown', (event) => {
  // The system may keep the release of a key that is held together with one of these.
  if (['Meta', 'Control', 'Alt', 'AltGraph'].includes(event.key)) letGo();
  if (at('room').hidden || at('player').open || event.ctrlKey || event.altKey || event.metaKey) return;
  const inField = event.target.closest('input, select, #strip');
  if (event.key === 'Escape' || (event.key === ' ' && !event.target.closest('button, input, select, a'))) {
    event.preventDefault();
    if (stops()) stop();
  } else if (kDriveKeys[event.code] && !inField && drives()) {
    event.preventDefault();
    if (event.repeat) return;
    driving.add(event.code);
    driveByKeys();
  } else if (kArrows[event.key] && !inField && steers()) {
    event.preventDefault();
    if (event.repeat) return;
    pressed.set(event.code, kArrows[event.key]);
    turnByKeys();
  } else if (event.key === 'Home' && !inField && steers()) {
    choice = null;
    send('home');
  } else if (event.key === 'a' && !inField && steers()) {
    choice = null;
    send('auto');
  }
});
document.addEventListener('keyup', (event) => {
  if (pressed.delete(event.code)) turnByKeys();
  if (driving.delete(event.code)) driveByKeys();
});
function letGo() {
  pressed.clear();
  driving.clear();
  drag = null;
  release();
  park();
}
window.addEventListener('blur', letGo);
document.addEventListener('visibilitychange', () => document.hidden && letGo());

// A drag turns as far from its start as it is, a tap follows the person under it.
let drag = null;
const kTap = 8;  // pixels

picture.addEventListener('pointerdown', (event) => {
  if (!steers()) return;
  picture.setPointerCapture(event.pointerId);
  drag = {x: event.clientX, y: event.clientY, far: false};
});
picture.addEventListener('pointermove', (event) => {
  if (!drag) return;
  const dx = event.clientX - drag.x, dy = event.clientY - drag.y;
  drag.far = drag.far || Math.hypot(dx, dy) > kTap;
  const half = picture.clientWidth / 3;
  if (drag.far) turn(dx / half * speed(), -dy / half * speed());
});
picture.addEventListener('pointerup', (event) => {
  if (drag && !drag.far) follow(event);
  drag = null;
  release();
});
picture.addEventListener('pointercancel', letGo);

function follow(event) {
  if (!facts || !facts.objects) return;
  const box = picture.getBoundingClientRect();
  const x = (event.clientX - box.left) / box.width * facts.width, y = (event.clientY - box.top) / box.height * facts.height;
  const hit = facts.objects.filter((one) => one.id !== null && x >= one.x && y >= one.y && x < one.x + one.w && y < one.y + one.h)
    .sort((a, b) => a.w * a.h - b.w * b.h)[0];
  if (hit) {
    send(`follow ${hit.id}`);
    choice = {id: hit.id, until: performance.now() + kChoice, follows: false};
  }
}

// What is said is what the frames carry: that a choice has begun, and that its person is gone.
const kChoice = 6000;  // ms; the robot gives a person up after 5 s
let choice = null;

function watchChoice() {
  if (!choice) return;
  const rule = facts && facts.fusion, chosen = rule && rule.name === 'chosen';
  if (chosen && rule.target === choice.id) {
    if (!choice.follows) say(`follows number ${choice.id}`, true);
    choice.follows = true;
  } else if (!chosen && (choice.follows || performance.now() > choice.until)) {
    if (!mine().stopped) say(`number ${choice.id} is gone`);
    choice = null;
  }
}

// ---- radar: the robot looks up; sensors, the head's view, people

function drawRadar() {
  const canvas = at('radar'), draw = canvas.getContext('2d'), middle = canvas.width / 2, radius = middle - 24;
  const style = getComputedStyle(document.body);
  const colour = (name) => style.getPropertyValue(name).trim();
  const angle = (degrees) => (degrees - 90) * Math.PI / 180;
  const sector = (bearing, width, size, fill) => {
    draw.beginPath();
    draw.moveTo(middle, middle);
    draw.arc(middle, middle, size, angle(bearing - width / 2), angle(bearing + width / 2));
    draw.closePath();
    draw.fillStyle = fill;
    draw.fill();
    draw.stroke();
  };
  const place = (bearing, share) => [middle + radius * share * Math.cos(angle(bearing)), middle + radius * share * Math.sin(angle(bearing))];
  draw.clearRect(0, 0, canvas.width, canvas.height);
  draw.strokeStyle = colour('--line');
  draw.lineWidth = 1;
  const words = [];
  const is = about() || {};
  const sensors = is.bearings ? is.bearings.split(',').map(Number) : [];
  const pir = facts && facts.pir || [];
  // As far as they see, where that is known; the circle is 12 m.
  const reach = radius * (is['sensor-range'] > 0 ? Math.min(1, is['sensor-range'] / 12) : 1);
  sensors.forEach((bearing, k) => {
    sector(bearing, is['sensor-fov'], reach, pir[k] === 1 ? 'rgb(216 38 44 / .35)' : 'rgb(108 140 200 / .12)');
    if (pir[k] === 1) words.push(`sensor ${k + 1} detects`);
  });
  draw.beginPath();
  draw.arc(middle, middle, radius, 0, 2 * Math.PI);
  draw.stroke();
  const pan = facts && facts.pose ? facts.pose.pan : 0;
  if (facts) sector(pan, is.fov || 60, radius * .92, 'rgb(80 160 90 / .35)');
  if (facts && facts.pose) words.push(`the head looks to ${pan.toFixed(0)} degrees`);
  sensors.forEach((bearing, k) => {
    const [x, y] = place(bearing, 1.08);
    draw.beginPath();
    draw.arc(x, y, 8, 0, 2 * Math.PI);
    draw.fillStyle = pir[k] === 1 ? '#e0262c' : pir[k] === 0 ? '#3b6fd4' : '#888';
    draw.fill();
  });
  draw.font = 'bold 15px system-ui, sans-serif';
  draw.textAlign = 'center';
  for (const one of facts && facts.objects || []) {
    // Without a known lens the place in the picture gives the bearing.
    const aside = one.bearing !== null ? one.bearing : ((one.x + one.w / 2) / facts.width - .5) * (is.fov || 60);
    // ... and the feet's height in the picture stands for the distance.
    const [x, y] = place(pan + aside, one.distance !== null ? Math.min(1, one.distance / 12)
      : .95 - .65 * Math.min(1, (one.y + one.h) / facts.height));
    draw.fillStyle = colour('--text');
    draw.beginPath();
    draw.arc(x, y, 5, 0, 2 * Math.PI);
    draw.fill();
    if (one.id !== null) draw.fillText(one.id, x, y - 9);
  }
  words.push(`${facts && facts.objects ? facts.objects.length : 'no'} objects`);
  const text = words.join(', ');
  if (canvas.getAttribute('aria-label') !== text) canvas.setAttribute('aria-label', text);
}

// ---- events

let events = [], eventsFault = '', moreEvents = false, loads = 0;
const kPage = 50;       // events that are shown at once
const kMostRows = 200;  // of one answer

function filterWords() {
  const words = {camera: cameraName}, day = at('filter-day').value;
  if (day) {
    const next = new Date(`${day}T00:00`);
    words.from = next.getTime();
    next.setDate(next.getDate() + 1);  // 23 or 25 hours where clocks change
    words.until = next.getTime();
  }
  if (at('filter-reason').value) words.reason = at('filter-reason').value;
  if (at('filter-kept').checked) words.kept = 1;
  return words;
}

// As many as are shown already, or so many.
async function loadEvents(most = Math.max(kPage, events.length)) {
  const load = ++loads, words = filterWords(), found = [];
  let fault = '', whole = false;
  while (!fault && !whole && found.length <= most) {
    const asked = Math.min(kMostRows, most + 1 - found.length);  // one more tells whether there are more
    const below = found.length ? {below: found[found.length - 1].id} : {};
    const response = await fetch(`/events?${new URLSearchParams({...words, ...below, most: asked})}`);
    const rows = response.ok ? await response.json() : [];
    if (!response.ok) fault = await response.text();
    found.push(...rows);
    whole = rows.length < asked;
  }
  const answer = fault ? null : await fetch(`/reasons?${new URLSearchParams({camera: cameraName})}`);
  const reasons = answer && answer.ok ? await answer.json() : [];
  if (load !== loads) return;  // another one began meanwhile
  events = found.slice(0, most);
  moreEvents = found.length > most;
  eventsFault = fault;
  showReasons(reasons);
  showEvents(Object.keys(words).length > 1);
}

const kReasons = {track: 'movement', motion: 'movement', pir: 'a sensor'};

function showReasons(reasons) {
  const select = at('filter-reason'), chosen = select.value;
  if (chosen && !reasons.includes(chosen)) reasons.push(chosen);
  if ([...select.options].slice(1).map((option) => option.value).join('\n') === reasons.join('\n')) return;
  select.replaceChildren(new Option('all', ''), ...reasons.map((reason) => new Option(kReasons[reason] || reason, reason)));
  select.value = chosen;
}

// Items that are as before stay where they are: the list keeps its place, and a button the focus.
function showEvents(filtered) {
  const list = at('strip'), before = new Map([...list.children].map((item) => [item.dataset.is, item]));
  const items = events.map((event) => {
    const is = JSON.stringify([event, hello.role]), item = before.get(is) || eventItem(event);
    item.dataset.is = is;
    return item;
  });
  if (!items.length) {
    const item = document.createElement('li');
    item.textContent = eventsFault || (filtered ? 'No event is like that.' : 'No event was recorded yet.');
    items.push(item);
  }
  const stay = new Set(items);
  for (const item of [...list.children]) if (!stay.has(item)) item.remove();
  items.forEach((item, k) => { if (list.children[k] !== item) list.insertBefore(item, list.children[k] || null); });
  at('older').hidden = !moreEvents;
}
for (const id of ['filter-day', 'filter-reason', 'filter-kept']) at(id).addEventListener('change', () => loadEvents(kPage));
at('older').addEventListener('click', () => loadEvents(events.length + kPage));

// What happened, and how long it took.
function nameOf(event) {
  const kinds = event.kinds ? event.kinds.split(',') : [], words = [];
  if (event.people > 0) {
    const people = event.people === 1 ? '1 person' : `${event.people} people`;
    words.push(kinds.includes('group') ? `${event.people} or more people` : people);
  }
  if (kinds.includes('thing')) words.push(words.length ? 'something else' : 'something that moves');
  if (!words.length && kinds.length) words.push('movement');
  const reason = event.reason.replace(/ *[0-9]+$/, '');
  if (!words.length) words.push(kReasons[reason] || reason || 'an event');
  if (event.part > 1) words.push(`part ${event.part}`);
  const seconds = Math.max(0, Math.round((event.end - event.begin) / 1000));
  const length = seconds < 60 ? `${seconds} s` : `${Math.floor(seconds / 60)} min ${seconds % 60} s`;
  const name = `${words.join(', ')}, ${event.open ? 'being recorded' : length}`;
  return name[0].toUpperCase() + name.slice(1);
}

function button(text, label, on) {
  const made = document.createElement('button');
  made.type = 'button';
  made.textContent = text;
  made.setAttribute('aria-label', label);
  made.addEventListener('click', on);
  return made;
}

function eventItem(event) {
  const item = document.createElement('li');
  const when = new Date(event.begin).toLocaleString(), name = nameOf(event);
  const address = `/events/${encodeURIComponent(event.camera)}/${event.id}`;
  if (event.picture && !event.open) {
    const image = document.createElement('img');
    image.loading = 'lazy';
    image.src = `${address}/picture`;
    image.alt = `${name}, ${when}`;
    item.append(image);
  } else {
    const blank = document.createElement('span');
    blank.className = 'blank';
    item.append(blank);
  }
  const title = document.createElement('strong'), text = document.createElement('div');
  title.textContent = name;
  text.textContent = `${when}${event.keep ? ', kept' : ''}`;
  const buttons = document.createElement('div');
  buttons.className = 'buttons';
  if (!event.open) {
    buttons.append(button('Play', `Play ${name}, ${when}`, () => play(address, event.name)));
    const save = document.createElement('a');
    save.href = `${address}/video`;
    save.download = event.name;
    save.textContent = 'Download';
    save.setAttribute('aria-label', `Download ${when}`);
    buttons.append(save);
    if (may('operator'))
      buttons.append(button(event.keep ? 'Free' : 'Keep', `${event.keep ? 'Do not keep' : 'Keep'} ${when}`, () =>
        change('/keep', event, {keep: event.keep ? '0' : '1'})));
    if (may('owner'))
      buttons.append(button('Delete', `Delete ${when}`, () =>
        confirm(`Delete the recording of ${when}?`) && change('/delete', event, {})));
  }
  item.append(title, text, buttons);
  return item;
}

async function change(path, event, more) {
  const done = await post(path, {camera: event.camera, id: event.id, ...more});
  if (!done.ok) say(done.text);
  loadEvents();
}

function play(address, name) {
  at('video').src = `${address}/video`;
  at('download').href = `${address}/video`;
  at('download').download = name;
  at('player').showModal();
}
at('shut').addEventListener('click', () => at('player').close());
at('player').addEventListener('close', () => {
  at('video').removeAttribute('src');
  at('video').load();
});
at('reload').addEventListener('click', () => loadEvents());

enter();
