'use strict';
(async () => {
  const byId = id => document.getElementById(id);
  const root = document.documentElement;
  const model = JSON.parse(byId('model').textContent);
  const { columns, rows, pixelAspect } = model;
  const count = columns * rows;
  // Of a standard error, where 95 % of normally distributed values lie.
  const CONFIDENCE = 1.96;
  const LARGEST_ZOOM = 64;

  // ---- values ----
  const halves = new Float32Array(65536);
  for (let code = 0; code < 65536; code++) {
    const exponent = code >> 10 & 31, fraction = code & 1023;
    const magnitude = exponent === 31 ? (fraction ? NaN : Infinity)
      : exponent ? 2 ** (exponent - 15) * (1 + fraction / 1024) : 2 ** -24 * fraction;
    halves[code] = code >> 15 ? -magnitude : magnitude;
  }

  async function decoded(layer, index) {
    const element = byId('layer-' + index);
    const text = atob(element.textContent);
    element.remove();
    const packed = new Uint8Array(text.length);
    for (let i = 0; i < text.length; i++) packed[i] = text.charCodeAt(i);
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
    const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
    const planes = [];
    for (let component = 0; component < layer.components; component++) {
      const codes = new Uint16Array(count), high = 2 * component * count, low = high + count;
      for (let i = 0; i < count; i++) {
        const before = i % columns ? codes[i - 1] : i >= columns ? codes[i - columns] : 0;
        codes[i] = before + (bytes[high + i] << 8 | bytes[low + i]);
      }
      planes.push(codes);
    }
    const factor = layer.factor;
    return { planes, value: factor === null ? code => code : code => halves[code] * factor };
  }

  let layers;
  try {
    layers = await Promise.all(model.layers.map(decoded));
  } catch (error) {
    byId('trouble').textContent = 'The picture cannot be shown at its full size here (' + error + '); still pictures follow.';
    byId('trouble').hidden = false;
    root.dataset.state = 'failed';
    return;
  }

  function plain(choice, i) {
    const { planes, value } = layers[choice.layer];
    let sum = 0;
    for (let c = 0; c < planes.length; c++) {
      if (choice.weights[c] !== 0) sum += choice.weights[c] * value(planes[c][i]);
    }
    return sum;
  }

  function valueOf(choice, i) {
    const own = plain(choice, i);
    if (!choice.isRatio) return own;
    const first = Math.abs(plain(model.choices[0], i));
    return first === 0 ? NaN : 100 * own / first;
  }

  // ---- colours ----
  const SEEN = 'as-seen';
  let shown = SEEN, stops = 0;
  const ranges = new Map(model.choices.map(c => [c.id, { low: c.low, high: c.high, log: c.isLogarithmic }]));
  const choiceOf = id => model.choices.find(choice => choice.id === id);

  function placeOf(range, value) {
    if (!range.log) return (value - range.low) / (range.high - range.low);
    return value > 0 ? Math.log(value / range.low) / Math.log(range.high / range.low) : value <= 0 ? -1 : NaN;
  }

  // The colours of a thousand places.
  function ramp(isGrey) {
    const steps = 1024, colors = new Uint8Array(3 * steps), last = model.palette.length - 1;
    for (let step = 0; step < steps; step++) {
      const place = step / (steps - 1), index = Math.min(Math.floor(place * last), last - 1), part = place * last - index;
      for (let c = 0; c < 3; c++) {
        const from = model.palette[index][c], to = model.palette[index + 1][c];
        colors[3 * step + c] = Math.round(isGrey ? 255 * place : from + part * (to - from));
      }
    }
    return colors;
  }
  const ramps = [ramp(false), ramp(true)];

  function srgb(linear) {
    const value = Math.min(Math.max(linear, 0), 1);
    return Math.round(255 * (value <= 0.0031308 ? 12.92 * value : 1.055 * value ** (1 / 2.4) - 0.055));
  }

  const whole = document.createElement('canvas');
  whole.width = columns;
  whole.height = rows;
  const wholeContext = whole.getContext('2d');

  function paint() {
    const image = wholeContext.createImageData(columns, rows), data = image.data;
    if (shown === SEEN) {
      const { planes, value } = layers[0];
      const sum = model.choices[0].weights.reduce((a, b) => a + b, 0);
      const gain = 2 ** stops * sum / model.white;
      const table = new Uint8Array(65536);
      for (let code = 0; code < 65536; code++) table[code] = srgb(gain * value(code));
      for (let i = 0; i < count; i++) {
        for (let c = 0; c < 3; c++) {
          const code = planes[Math.min(c, planes.length - 1)][i];
          data[4 * i + c] = (code & 0x7fff) > 0x7c00 ? model.noValue[c] : table[code];
        }
        data[4 * i + 3] = 255;
      }
    } else {
      const choice = choiceOf(shown), range = ranges.get(shown), colors = ramps[choice.isGrey ? 1 : 0];
      for (let i = 0; i < count; i++) {
        const place = placeOf(range, valueOf(choice, i));
        const step = 3 * Math.round(1023 * Math.min(Math.max(place, 0), 1));
        for (let c = 0; c < 3; c++) data[4 * i + c] = Number.isNaN(place) ? model.noValue[c] : colors[step + c];
        data[4 * i + 3] = 255;
      }
    }
    wholeContext.putImageData(image, 0, 0);
    draw();
  }

  // ---- where the picture stands on the canvas; lengths are CSS pixels ----
  const canvas = byId('picture'), context = canvas.getContext('2d');
  // A zoom of 0 is less than any that fits.
  let width = 1, height = 1, zoom = 0, left = 0, top = 0, probe = null;

  const fitting = () => Math.min(width / columns, height / (rows * pixelAspect));
  const isFitted = () => zoom <= fitting() * 1.001;

  function layout() {
    const wasFitted = isFitted();
    width = canvas.clientWidth || 1;
    height = Math.max(Math.min(width * rows * pixelAspect / columns, 0.75 * window.innerHeight), 120);
    canvas.style.height = height + 'px';
    const ratio = window.devicePixelRatio || 1;
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    if (wasFitted) fit(); else place(zoom, left, top);
    hideCrowded();
  }

  function clampedPlace(start, size, extent) {
    return extent <= size ? (size - extent) / 2 : Math.min(0, Math.max(size - extent, start));
  }

  function place(newZoom, newLeft, newTop) {
    zoom = Math.min(Math.max(newZoom, fitting()), Math.max(LARGEST_ZOOM, fitting()));
    left = clampedPlace(newLeft, width, columns * zoom);
    top = clampedPlace(newTop, height, rows * zoom * pixelAspect);
    canvas.style.touchAction = isFitted() ? 'pan-y' : 'none';
    draw();
  }

  function fit() { place(fitting(), 0, 0); }

  function zoomAt(factor, x, y) {
    const next = Math.min(Math.max(zoom * factor, fitting()), Math.max(LARGEST_ZOOM, fitting())), change = next / zoom;
    place(next, x - (x - left) * change, y - (y - top) * change);
  }

  function draw() {
    const ratio = canvas.width / width;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, canvas.width, canvas.height);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.imageSmoothingEnabled = zoom * ratio < 1;
    context.imageSmoothingQuality = 'high';
    context.drawImage(whole, left, top, columns * zoom, rows * zoom * pixelAspect);
    if (!probe) return;
    const side = Math.max(zoom, 7), tall = Math.max(zoom * pixelAspect, 7);
    const x = left + (probe[0] + 0.5) * zoom, y = top + (probe[1] + 0.5) * zoom * pixelAspect;
    for (const [color, line] of [['#000', 3], ['#fff', 1]]) {
      context.strokeStyle = color;
      context.lineWidth = line;
      context.strokeRect(x - side / 2, y - tall / 2, side, tall);
    }
  }

  // ---- the values under the pointer ----
  const cells = new Map();
  function row(name) {
    const line = byId('readout').tBodies[0].insertRow(), head = document.createElement('th');
    head.scope = 'row';
    head.textContent = name;
    line.append(head);
    const cell = line.insertCell();
    cell.textContent = '–';
    return cell;
  }
  cells.set('pixel', row(model.side > 1 ? 'square' : 'pixel'));
  for (const choice of model.choices) cells.set(choice.id, row(choice.name));
  const absolute = choiceOf('error'), relative = choiceOf('relative-error');
  const interval = absolute || relative ? row('95 % interval') : null;

  function text(value) {
    if (!Number.isFinite(value)) return 'none';
    const magnitude = Math.abs(value);
    return magnitude !== 0 && (magnitude < 1e-4 || magnitude >= 1e6) ? value.toExponential(3)
      : Number.isInteger(value) ? String(value) : value.toPrecision(4);
  }

  const withUnit = (value, choice) => text(value) + (choice.unit && Number.isFinite(value) ? ' ' + choice.unit : '');

  function read(x, y) {
    probe = [Math.min(Math.max(x, 0), columns - 1), Math.min(Math.max(y, 0), rows - 1)];
    const i = probe[1] * columns + probe[0];
    cells.get('pixel').textContent = probe[0] + ', ' + probe[1] + ' (from the top left)';
    for (const choice of model.choices) cells.get(choice.id).textContent = withUnit(valueOf(choice, i), choice);
    if (interval) {
      const first = model.choices[0], value = valueOf(first, i);
      const error = absolute ? plain(absolute, i) : Math.abs(value) * plain(relative, i) / 100;
      interval.textContent = text(value - CONFIDENCE * error) + ' to ' + withUnit(value + CONFIDENCE * error, first);
    }
    draw();
  }

  function readAt(event) {
    const box = canvas.getBoundingClientRect();
    const x = Math.floor((event.clientX - box.left - left) / zoom);
    const y = Math.floor((event.clientY - box.top - top) / (zoom * pixelAspect));
    if (x >= 0 && y >= 0 && x < columns && y < rows) read(x, y);
  }

  // ---- fingers, mouse, keys ----
  const pointers = new Map();
  let moved = 0;

  canvas.addEventListener('pointerdown', event => {
    pointers.set(event.pointerId, event);
    canvas.setPointerCapture(event.pointerId);
    moved = 0;
  });

  canvas.addEventListener('pointermove', event => {
    const before = pointers.get(event.pointerId);
    if (!before) {
      if (event.pointerType === 'mouse') readAt(event);
      return;
    }
    const box = canvas.getBoundingClientRect();
    const others = [...pointers.values()].filter(other => other.pointerId !== event.pointerId);
    moved += Math.hypot(event.clientX - before.clientX, event.clientY - before.clientY);
    if (others.length === 0) {
      if (!isFitted()) place(zoom, left + event.clientX - before.clientX, top + event.clientY - before.clientY);
    } else {
      const other = others[0];
      const apart = at => Math.max(Math.hypot(at.clientX - other.clientX, at.clientY - other.clientY), 1);
      const middle = at => [(at.clientX + other.clientX) / 2 - box.left, (at.clientY + other.clientY) / 2 - box.top];
      const [from, to] = [middle(before), middle(event)];
      place(zoom, left + to[0] - from[0], top + to[1] - from[1]);
      zoomAt(apart(event) / apart(before), to[0], to[1]);
    }
    pointers.set(event.pointerId, event);
  });

  const lifted = event => {
    if (pointers.delete(event.pointerId) && event.type === 'pointerup' && moved < 6) readAt(event);
  };
  canvas.addEventListener('pointerup', lifted);
  canvas.addEventListener('pointercancel', lifted);

  canvas.addEventListener('wheel', event => {
    // The page scrolls until the picture was clicked.
    if (!event.ctrlKey && document.activeElement !== canvas) return;
    event.preventDefault();
    const box = canvas.getBoundingClientRect();
    zoomAt(2 ** (-event.deltaY / 240), event.clientX - box.left, event.clientY - box.top);
  }, { passive: false });

  canvas.addEventListener('keydown', event => {
    const step = event.shiftKey ? 10 : 1;
    const [x, y] = probe || [Math.floor(columns / 2), Math.floor(rows / 2)];
    const actions = {
      ArrowLeft: () => read(x - step, y), ArrowRight: () => read(x + step, y),
      ArrowUp: () => read(x, y - step), ArrowDown: () => read(x, y + step),
      '+': () => zoomBy(1.5), '=': () => zoomBy(1.5), '-': () => zoomBy(1 / 1.5), '0': fit,
    };
    if (!actions[event.key] || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    actions[event.key]();
  });

  function zoomBy(factor) {
    const at = probe ? [left + (probe[0] + 0.5) * zoom, top + (probe[1] + 0.5) * zoom * pixelAspect] : [width / 2, height / 2];
    zoomAt(factor, at[0], at[1]);
  }
  byId('zoom-in').onclick = () => zoomBy(1.5);
  byId('zoom-out').onclick = () => zoomBy(1 / 1.5);
  byId('fit').onclick = fit;

  // ---- what is shown ----
  function ticksOf(range) {
    if (range.log) {
      const first = Math.floor(Math.log10(range.low)), last = Math.floor(Math.log10(range.high)), ticks = [];
      for (let power = first; power <= last; power++) {
        for (const factor of last - first < 3 ? [1, 2, 5] : [1]) ticks.push(factor * 10 ** power);
      }
      return ticks;
    }
    const rough = (range.high - range.low) / 5, power = 10 ** Math.floor(Math.log10(rough));
    const step = power * ([1, 2, 5].find(factor => factor * power >= rough) || 10);
    const ticks = [];
    for (let i = Math.ceil(range.low / step - 1e-9); ticks.length < 20 && i * step <= range.high + 1e-9 * step; i++) ticks.push(i * step);
    return ticks;
  }

  function label(value) {
    return String(Number(value.toPrecision(6)));
  }

  // Labels that would stand over others are not shown; those of the ends always are.
  function hideCrowded() {
    const spans = [...byId('ticks').children], boxes = spans.map(span => span.getBoundingClientRect());
    if (!spans.length) return;
    const gap = 6, end = boxes[boxes.length - 1].left - gap;
    let free = boxes[0].right + gap;
    for (let i = 1; i < spans.length - 1; i++) {
      const fits = boxes[i].left >= free && boxes[i].right <= end;
      spans[i].style.visibility = fits ? '' : 'hidden';
      if (fits) free = boxes[i].right + gap;
    }
  }

  function showScale() {
    const choice = choiceOf(shown);
    byId('scale').hidden = byId('range').hidden = !choice;
    byId('stops-label').hidden = Boolean(choice);
    if (!choice) return;
    const range = ranges.get(shown), colors = ramps[choice.isGrey ? 1 : 0];
    const bar = byId('bar').getContext('2d'), image = bar.createImageData(256, 1);
    for (let x = 0; x < 256; x++) {
      const step = 3 * Math.round(1023 * x / 255);
      image.data.set([colors[step], colors[step + 1], colors[step + 2], 255], 4 * x);
    }
    bar.putImageData(image, 0, 0);
    byId('ticks').replaceChildren(...[range.low, ...ticksOf(range), range.high].map((value, index, all) => {
      const span = document.createElement('span'), at = placeOf(range, value);
      span.style.left = 100 * at + '%';
      const isEnd = index === 0 || index === all.length - 1;
      span.textContent = isEnd ? text(value) + (index && choice.unit ? ' ' + choice.unit : '') : label(value);
      return span;
    }));
    hideCrowded();
    byId('low').value = text(range.low);
    byId('high').value = text(range.high);
    byId('log').checked = range.log;
  }

  function show(id) {
    shown = choiceOf(id) ? id : SEEN;
    byId('show').value = shown;
    showScale();
    paint();
  }

  for (const { id, name, unit } of [{ id: SEEN, name: 'as seen', unit: '' }, ...model.choices]) {
    byId('show').add(new Option(unit ? name + ', ' + unit : name, id));
  }
  byId('show').onchange = () => show(byId('show').value);
  byId('stops').oninput = () => {
    stops = Number(byId('stops').value);
    byId('stops-shown').textContent = stops;
    paint();
  };
  function rangeChanged() {
    const range = ranges.get(shown), choice = choiceOf(shown);
    const number = (id, usual) => {
      const value = Number(byId(id).value.replace(',', '.'));
      return byId(id).value.trim() !== '' && Number.isFinite(value) ? value : usual;
    };
    const next = { low: number('low', range.low), high: number('high', range.high), log: byId('log').checked };
    if (next.log && next.low <= 0) next.low = choice.isLogarithmic ? choice.low : next.high / 1000;
    if (next.high > next.low && (!next.log || next.low > 0)) ranges.set(shown, next);
    showScale();
    paint();
  }
  for (const id of ['low', 'high', 'log']) byId(id).onchange = rangeChanged;

  // A link can name what is shown and a pixel: #show=luminance&pixel=12,7
  function follow() {
    const asked = new URLSearchParams(location.hash.slice(1));
    show(asked.get('show') || shown);
    const pixel = (asked.get('pixel') || '').split(',').map(Number);
    if (pixel.length === 2 && pixel.every(Number.isInteger)) read(pixel[0], pixel[1]);
  }

  byId('viewer').hidden = false;
  root.classList.add('interactive');
  layout();
  new ResizeObserver(layout).observe(canvas.parentElement);
  window.addEventListener('hashchange', follow);
  follow();
  root.dataset.state = 'ready';
})();
