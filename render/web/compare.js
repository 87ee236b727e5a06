// The viewer of `twopass compare --html`: two pictures and their difference, at any zoom, with the pixels' own values.
// The page holds the numbers; without this script it still shows pictures and tables.
'use strict';
(() => {
  const byId = (id) => document.getElementById(id);
  const info = JSON.parse(byId('report').textContent);
  const { width, height } = info;
  const screen = byId('screen'), context = screen.getContext('2d');
  const modes = ['test', 'reference', 'signed', 'magnitude', 'relative', 'flip', 'swipe', 'side'];
  const state = { layer: 0, mode: 'test', exposure: 0, stretch: 0, split: 0.5, zoom: 0, x: 0, y: 0, probe: null };

  // --- numbers ---------------------------------------------------------------------------------------------------

  const bytesOf = (id) => {
    const text = atob(byId(id).textContent.trim());
    const bytes = new Uint8Array(text.length);
    for (let i = 0; i < text.length; ++i) bytes[i] = text.charCodeAt(i);
    return bytes;
  };
  const floatsFromHalf = (bytes) => {
    const from = new Uint16Array(bytes.buffer), to = new Float32Array(from.length);
    for (let i = 0; i < from.length; ++i) {
      const exponent = (from[i] >> 10) & 31, mantissa = from[i] & 1023, sign = from[i] & 0x8000 ? -1 : 1;
      to[i] = exponent === 31 ? (mantissa ? NaN : sign * Infinity)
        : exponent === 0 ? sign * mantissa * 2 ** -24 : sign * (1024 + mantissa) * 2 ** (exponent - 25);
    }
    return to;
  };
  const floatsOf = (id, type) => (type === 'half' ? floatsFromHalf(bytesOf(id)) : new Float32Array(bytesOf(id).buffer));

  const loaded = [];
  const layer = () => {
    const i = state.layer;
    if (!loaded[i]) {
      const facts = info.layers[i];
      const test = floatsOf(`test${i}`, facts.type), reference = floatsOf(`reference${i}`, facts.type);
      loaded[i] = { facts, n: facts.channels, test, reference, flip: facts.flip ? bytesOf(`flip${i}`) : null };
    }
    return loaded[i];
  };
  const colors = { sequential: bytesOf('sequential'), diverging: bytesOf('diverging') };

  // The largest value that a map shows as such; `stretch` halves or doubles it.
  const reach = (mode) => {
    const facts = layer().facts, scale = 2 ** -state.stretch;
    if (mode === 'flip') return 1;
    return (mode === 'relative' ? facts.relativeReach : facts.reach) * scale || 1;
  };
  const epsilon = 0.01;
  const errorAt = (mode, p) => {
    const { n, test, reference, flip } = layer();
    if (mode === 'flip') return flip[p] / 255;
    let sum = 0;
    for (let c = 0; c < n; ++c) {
      const r = reference[n * p + c], d = test[n * p + c] - r;
      sum += mode === 'signed' ? d : mode === 'magnitude' ? Math.abs(d) : (d * d) / (r * r + epsilon);
    }
    return mode === 'relative' ? Math.sqrt(sum / n) : sum / n;
  };

  // --- pictures of numbers ---------------------------------------------------------------------------------------

  const encode = new Uint8Array(4097);  // the sRGB curve (IEC 61966-2-1) of [0, 1]
  for (let i = 0; i <= 4096; ++i) {
    const x = i / 4096;
    encode[i] = Math.round(255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055));
  }
  const cache = new Map();
  const paint = (mode) => {
    const isMap = mode !== 'test' && mode !== 'reference';
    const key = `${state.layer} ${mode} ${isMap ? state.stretch : state.exposure}`;
    if (cache.has(key)) return cache.get(key);
    if (cache.size > 12) cache.clear();
    const canvas = document.createElement('canvas');
    canvas.width = width; canvas.height = height;
    const to = canvas.getContext('2d'), image = to.createImageData(width, height), out = image.data;
    const data = layer(), n = data.n, values = mode === 'test' ? data.test : data.reference;
    const gain = 4096 * 2 ** state.exposure, most = isMap ? reach(mode) : 1;
    for (let p = 0, o = 0; p < width * height; ++p, o += 4) {
      out[o + 3] = 255;
      if (isMap) {
        const e = errorAt(mode, p);
        const at = mode === 'signed' ? 0.5 + (0.5 * e) / most : e / most;
        const map = mode === 'signed' ? colors.diverging : colors.sequential;
        const k = 3 * Math.round(255 * Math.min(1, Math.max(0, at)));
        if (Number.isNaN(e)) { out[o] = 255; out[o + 2] = 255; continue; }
        out[o] = map[k]; out[o + 1] = map[k + 1]; out[o + 2] = map[k + 2];
        continue;
      }
      for (let c = 0; c < 3; ++c) {
        const v = values[n === 3 ? 3 * p + c : p];
        if (!Number.isFinite(v)) { out[o] = 255; out[o + 1] = 0; out[o + 2] = 255; break; }
        out[o + c] = encode[Math.round(Math.min(4096, Math.max(0, v * gain)))];
      }
    }
    to.putImageData(image, 0, 0);
    cache.set(key, canvas);
    return canvas;
  };

  // --- the screen --------------------------------------------------------------------------------------------------

  const ratio = () => window.devicePixelRatio || 1;
  const paneWidth = () => (state.mode === 'side' ? screen.width / 2 : screen.width);
  const fit = () => Math.min(paneWidth() / width, screen.height / height);
  const zoom = () => state.zoom || fit();
  // Where the picture's upper left corner is in a pane.
  const origin = () => {
    const z = zoom();
    return { x: paneWidth() / 2 - (state.zoom ? state.x : width / 2) * z,
             y: screen.height / 2 - (state.zoom ? state.y : height / 2) * z };
  };
  const drawPane = (canvas, left, clipLeft, clipRight) => {
    const z = zoom(), at = origin();
    context.save();
    context.beginPath();
    context.rect(clipLeft, 0, clipRight - clipLeft, screen.height);
    context.clip();
    context.imageSmoothingEnabled = z < 1;  // enlarged pixels stay pixels
    context.drawImage(canvas, left + at.x, at.y, width * z, height * z);
    if (state.probe && z >= 4) {
      context.lineWidth = 2;
      context.strokeStyle = '#0f0';
      context.strokeRect(left + at.x + state.probe.x * z, at.y + state.probe.y * z, z, z);
    }
    context.restore();
  };
  const label = (text, x) => {
    context.font = `${13 * ratio()}px sans-serif`;
    const w = context.measureText(text).width + 12 * ratio();
    context.fillStyle = '#000b';
    context.fillRect(x, 0, w, 20 * ratio());
    context.fillStyle = '#fff';
    context.fillText(text, x + 6 * ratio(), 14 * ratio());
  };
  const draw = () => {
    const box = screen.getBoundingClientRect(), w = Math.round(box.width * ratio()), h = Math.round(box.height * ratio());
    if (screen.width !== w || screen.height !== h) { screen.width = w; screen.height = h; }
    context.fillStyle = '#222';
    context.fillRect(0, 0, screen.width, screen.height);
    if (state.mode === 'side') {
      const half = screen.width / 2;
      drawPane(paint('test'), 0, 0, half - 1);
      drawPane(paint('reference'), half, half + 1, screen.width);
      label('test', 0); label('reference', half + 1);
    } else if (state.mode === 'swipe') {
      const split = state.split * screen.width;
      drawPane(paint('test'), 0, 0, split);
      drawPane(paint('reference'), 0, split, screen.width);
      context.fillStyle = '#fff';
      context.fillRect(split - 1, 0, 2, screen.height);
      label('test', 0); label('reference', split + 2);
    } else {
      drawPane(paint(state.mode), 0, 0, screen.width);
      label(names[state.mode], 0);
    }
    legend(); readout(); controls();
  };

  const names = { test: 'test', reference: 'reference', signed: 'test - reference', magnitude: '|test - reference|',
                  relative: 'relative error', flip: 'FLIP', swipe: 'swipe', side: 'side by side' };
  const digits = (v) => (Number.isFinite(v) ? (v === 0 ? '0' : Math.abs(v) >= 1e-3 && Math.abs(v) < 1e5 ? v.toPrecision(6) : v.toExponential(5)) : String(v));
  const legend = () => {
    const isMap = ['signed', 'magnitude', 'relative', 'flip'].includes(state.mode);
    byId('legend').style.visibility = isMap ? 'visible' : 'hidden';
    if (!isMap) return;
    const most = reach(state.mode), map = state.mode === 'signed' ? colors.diverging : colors.sequential;
    byId('low').textContent = state.mode === 'signed' ? digits(-most) : '0';
    byId('high').textContent = digits(most);
    const bar = byId('colors'), to = bar.getContext('2d'), image = to.createImageData(256, 1);
    for (let i = 0; i < 256; ++i) image.data.set([map[3 * i], map[3 * i + 1], map[3 * i + 2], 255], 4 * i);
    to.putImageData(image, 0, 0);
  };
  const readout = () => {
    const probe = state.probe;
    if (!probe) { byId('readout').textContent = 'Point at a pixel, or move with the arrow keys.'; return; }
    const { n, test, reference, flip } = layer(), p = probe.y * width + probe.x;
    const row = (name, at) => `${name.padEnd(10)}${Array.from({ length: n }, (_, c) => digits(at(c)).padStart(14)).join('')}`;
    byId('readout').textContent = [
      `pixel ${probe.x}, ${probe.y}` + (flip ? `   FLIP ${(flip[p] / 255).toFixed(3)}` : '') +
        `   relative error ${digits(errorAt('relative', p))}`,
      row('test', (c) => test[n * p + c]), row('reference', (c) => reference[n * p + c]),
      row('difference', (c) => test[n * p + c] - reference[n * p + c])].join('\n');
  };
  const controls = () => {
    for (const button of document.querySelectorAll('#modes button')) {
      button.setAttribute('aria-pressed', button.dataset.mode === state.mode);
      if (button.dataset.mode === 'flip') button.disabled = !layer().flip;
    }
    byId('exposure').value = state.exposure;
    byId('stops').textContent = `${state.exposure > 0 ? '+' : ''}${state.exposure} stops`;
    byId('scale').textContent = `${(zoom() / ratio()).toFixed(2)}x`;
    byId('layer').value = state.layer;
  };

  // --- what the user does --------------------------------------------------------------------------------------------

  const setMode = (mode) => { if (mode !== 'flip' || layer().flip) { state.mode = mode; draw(); } };
  const setExposure = (stops) => { state.exposure = Math.max(-20, Math.min(20, stops)); draw(); };
  const at = (event) => {
    const box = screen.getBoundingClientRect();
    let x = (event.clientX - box.left) * ratio();
    const y = (event.clientY - box.top) * ratio(), screenX = x;
    if (state.mode === 'side' && x >= screen.width / 2) x -= screen.width / 2;
    const o = origin();
    return { x: (x - o.x) / zoom(), y: (y - o.y) / zoom(), paneX: x, paneY: y, screenX };
  };
  const freeze = () => { if (!state.zoom) { state.x = width / 2; state.y = height / 2; state.zoom = fit(); } };
  // Enlarges around a point of the pane, which stays where it is.
  const zoomBy = (factor, paneX = paneWidth() / 2, paneY = screen.height / 2) => {
    freeze();
    const o = origin(), x = (paneX - o.x) / state.zoom, y = (paneY - o.y) / state.zoom;
    state.zoom = Math.max(0.02, Math.min(256, state.zoom * factor));
    state.x = x - (paneX - paneWidth() / 2) / state.zoom;
    state.y = y - (paneY - screen.height / 2) / state.zoom;
    draw();
  };
  const moveProbe = (dx, dy) => {
    const from = state.probe || { x: Math.floor(width / 2), y: Math.floor(height / 2) };
    state.probe = { x: Math.min(width - 1, Math.max(0, from.x + dx)), y: Math.min(height - 1, Math.max(0, from.y + dy)) };
    if (state.zoom) {  // it stays in sight
      const spanX = paneWidth() / 2 / state.zoom, spanY = screen.height / 2 / state.zoom;
      state.x = Math.min(state.probe.x + spanX, Math.max(state.probe.x + 1 - spanX, state.x));
      state.y = Math.min(state.probe.y + spanY, Math.max(state.probe.y + 1 - spanY, state.y));
    }
    draw();
  };
  const show = (x, y, w, h) => {  // a part of the picture
    state.zoom = Math.min(paneWidth() / w, screen.height / h) / 3;
    state.x = x + w / 2; state.y = y + h / 2;
    state.probe = { x: Math.floor(state.x), y: Math.floor(state.y) };
    draw();
  };
  const reset = () => { Object.assign(state, { exposure: 0, stretch: 0, zoom: 0, split: 0.5 }); draw(); };

  let drag = null;
  screen.addEventListener('pointerdown', (event) => {
    screen.setPointerCapture(event.pointerId);
    const p = at(event);
    drag = { ...p, moved: false, swipe: state.mode === 'swipe' && Math.abs(p.screenX - state.split * screen.width) < 12 * ratio() };
  });
  screen.addEventListener('pointermove', (event) => {
    const p = at(event);
    if (drag && drag.swipe) state.split = Math.min(1, Math.max(0, p.screenX / screen.width));
    else if (drag && event.buttons) {
      freeze();
      state.x += drag.x - p.x; state.y += drag.y - p.y;
    }
    const x = Math.floor(p.x), y = Math.floor(p.y);
    if (!drag && x >= 0 && y >= 0 && x < width && y < height) state.probe = { x, y };
    draw();
  });
  screen.addEventListener('pointerup', () => { drag = null; });
  screen.addEventListener('pointercancel', () => { drag = null; });
  screen.addEventListener('wheel', (event) => {
    event.preventDefault();
    const p = at(event);
    zoomBy(2 ** (-event.deltaY / 300), p.paneX, p.paneY);
  }, { passive: false });

  const keys = {
    e: () => setExposure(state.exposure - 0.5), E: () => setExposure(state.exposure + 0.5),
    d: () => { --state.stretch; draw(); }, D: () => { ++state.stretch; draw(); },
    f: () => setMode(state.mode === 'test' ? 'reference' : 'test'),
    l: () => { state.layer = (state.layer + 1) % info.layers.length; if (state.mode === 'flip' && !layer().flip) state.mode = 'test'; draw(); },
    r: reset, 0: reset, '+': () => zoomBy(2), '=': () => zoomBy(2), '-': () => zoomBy(0.5),
    ArrowLeft: () => moveProbe(-1, 0), ArrowRight: () => moveProbe(1, 0),
    ArrowUp: () => moveProbe(0, -1), ArrowDown: () => moveProbe(0, 1),
    '[': () => { state.split = Math.max(0, state.split - 0.05); draw(); },
    ']': () => { state.split = Math.min(1, state.split + 0.05); draw(); },
  };
  modes.forEach((mode, i) => { keys[i + 1] = () => setMode(mode); });
  document.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || !keys[event.key]) return;
    if (event.key.startsWith('Arrow') && document.activeElement !== screen) return;
    if (event.target.matches('select')) return;
    event.preventDefault();
    keys[event.key]();
  });
  for (const button of document.querySelectorAll('#modes button'))
    button.addEventListener('click', () => setMode(button.dataset.mode));
  byId('exposure').addEventListener('input', (event) => setExposure(Number(event.target.value)));
  byId('reset').addEventListener('click', reset);
  byId('layer').addEventListener('change', (event) => {
    state.layer = Number(event.target.value);
    if (state.mode === 'flip' && !layer().flip) state.mode = 'test';
    draw();
  });
  for (const link of document.querySelectorAll('a[data-tile]'))
    link.addEventListener('click', (event) => {
      event.preventDefault();
      byId('viewer').scrollIntoView();
      screen.focus();
      show(...link.dataset.tile.split(',').map(Number));
    });
  window.addEventListener('resize', draw);

  byId('viewer').hidden = false;
  const wish = new URLSearchParams(location.hash.slice(1));  // page.html#mode=swipe&probe=3,4: a view to link to
  if (modes.includes(wish.get('mode'))) state.mode = wish.get('mode');
  if (wish.get('probe')) {
    const [x, y] = wish.get('probe').split(',').map(Number);
    if (x >= 0 && y >= 0 && x < width && y < height) state.probe = { x: Math.floor(x), y: Math.floor(y) };
  }
  draw();  // which finds out how large the screen is
  if (wish.get('tile')) show(...wish.get('tile').split(',').map(Number));
})();
