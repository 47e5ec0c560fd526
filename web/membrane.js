// The film in space: the part that was computed and its mirrored copies, drawn by WebGL.
(() => {
  const vertexShader = `#version 300 es
    in vec2 X; in vec3 u0; in vec3 u1; in float s0; in float s1; in float mark;
    uniform mat2 copy; uniform mat3 view; uniform vec2 scale; uniform float part, times, radius, lift;
    uniform vec2 range;
    out float share; out vec3 place; out float tint;
    void main() {
      vec3 u = mix(u0, u1, part);
      vec3 p = vec3(copy * (X + u.xy), times * u.z) / radius;
      vec3 q = view * p;
      place = q;
      share = (mix(s0, s1, part) - range.x) / (range.y - range.x);
      tint = mark;
      float w = 1.0 - 0.16 * q.z;
      gl_Position = vec4(q.xy * scale, (-0.35 * q.z - lift) * w, w);
    }`;
  const fragmentShader = `#version 300 es
    precision highp float;
    in float share; in vec3 place; in float tint;
    uniform vec3 palette[9]; uniform vec4 line;
    out vec4 colour;
    void main() {
      if (line.a > 0.0) { colour = line; return; }
      float at = clamp(share, 0.0, 1.0) * 8.0;
      int i = int(min(floor(at), 7.0));
      vec3 base = mix(palette[i], palette[i + 1], at - float(i));
      vec3 n = normalize(cross(dFdx(place), dFdy(place)));
      float light = 0.62 + 0.38 * abs(dot(n, normalize(vec3(-0.35, 0.45, 0.82))));
      colour = vec4(base * light * (tint > 1.5 ? 0.9 : 1.0), 1.0);
    }`;
  const palettes = { // even steps in lightness: there in grey, and for the colour-blind
    signed: ['#06193a', '#093768', '#225a92', '#527da8', '#95989a', '#caa66d', '#e8bc5b', '#f8d870', '#fff7b8'],
    rising: dea.rising,
  };

  const words = (text) => {
    const raw = atob(text);
    const bytes = new Uint8Array(raw.length);
    for (let i = 0; i < raw.length; i++) {
      bytes[i] = raw.charCodeAt(i);
    }
    const view = new DataView(bytes.buffer);
    return Float64Array.from({ length: raw.length / 2 }, (_, i) => view.getUint16(2 * i, true) / 65535);
  };

  // Numbers back from their 16 bits.
  const unpack = (data) => {
    const R = data.radius;
    const [x, y] = data.X.map((text) => words(text).map((v) => (2 * v - 1) * R));
    const channels = data.channels.map((c) => ({
      ...c, steps: c.steps.map((text) => words(text).map((v) => c.low + v * (c.high - c.low))),
    }));
    return { ...data, x, y, channels };
  };

  const copies = (film) => {
    if (film.fold === 0) {
      return [[1, 0, 0, 1]];
    }
    return Array.from({ length: 2 * film.fold }, (_, k) => {
      const turn = (2 * Math.PI * Math.floor(k / 2)) / film.fold;
      const sign = k % 2 === 1 ? -1 : 1;
      const angle = k % 2 === 1 ? 2 * film.angle + turn : turn;
      const [c, s] = [Math.cos(angle), Math.sin(angle)];
      return [c, s, -sign * s, sign * c]; // columns
    });
  };

  // Triangles of all elements; edges where electrode or fibre end, and the frame; a mark for each point.
  const faces = (film) => {
    const triangles = [];
    const marks = new Float32Array(film.points);
    const edges = new Map();
    for (const block of film.blocks) {
      const n = block.order + 1;
      for (let e = 0; e < block.flags.length; e++) {
        const at = (i, j) => block.nodes[e * n * n + j * n + i];
        for (let j = 0; j < n; j++) {
          for (let i = 0; i < n; i++) {
            marks[at(i, j)] = block.flags[e];
            if (i + 1 < n && j + 1 < n) {
              triangles.push(at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1));
            }
          }
        }
        for (let k = 0; k + 1 < n; k++) {
          for (const [p, q] of [[at(k, 0), at(k + 1, 0)], [at(k, n - 1), at(k + 1, n - 1)], [at(0, k), at(0, k + 1)], [at(n - 1, k), at(n - 1, k + 1)]]) {
            const name = (i) => `${Math.round((film.x[i] / film.radius) * 2e4)},${Math.round((film.y[i] / film.radius) * 2e4)}`;
            const key = [name(p), name(q)].sort().join(' ');
            if (!edges.has(key)) {
              edges.set(key, { p, q, flags: [] });
            }
            edges.get(key).flags.push(block.flags[e]);
          }
        }
      }
    }
    const lines = [];
    for (const { p, q, flags } of edges.values()) {
      const far = Math.min(Math.hypot(film.x[p], film.y[p]), Math.hypot(film.x[q], film.y[q])) > 0.999 * film.radius;
      if (flags.length > 1 ? flags[0] !== flags[1] : far) {
        lines.push(p, q);
      }
    }
    return { triangles: new Uint32Array(triangles), lines: new Uint32Array(lines), marks };
  };

  // Points on a ray, from the centre outwards: [radius, index].
  const ray = (film, angle) => {
    const [c, s] = [Math.cos(angle), Math.sin(angle)];
    const found = [];
    for (let i = 0; i < film.points; i++) {
      const along = film.x[i] * c + film.y[i] * s;
      if (Math.abs(film.y[i] * c - film.x[i] * s) < 2e-4 * film.radius && along > -1e-4 * film.radius) {
        found.push([Math.max(0, along), i]);
      }
    }
    return found.sort((a, b) => a[0] - b[0]);
  };

  const program = (gl) => {
    const made = gl.createProgram();
    for (const [type, source] of [[gl.VERTEX_SHADER, vertexShader], [gl.FRAGMENT_SHADER, fragmentShader]]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(made, shader);
    }
    gl.linkProgram(made);
    if (!gl.getProgramParameter(made, gl.LINK_STATUS)) {
      throw new Error(gl.getProgramInfoLog(made));
    }
    return made;
  };

  // What draws the film with a state { at, times, channel, turn, tilt, zoom }.
  const painter = (canvas, film) => {
    const gl = canvas.getContext('webgl2', { antialias: true, preserveDrawingBuffer: true, alpha: true });
    if (gl === null) {
      return null;
    }
    const made = program(gl);
    const { triangles, lines, marks } = faces(film);
    const buffer = (target, data) => {
      const one = gl.createBuffer();
      gl.bindBuffer(target, one);
      gl.bufferData(target, data, gl.STATIC_DRAW);
      return one;
    };
    const pack = (parts) => {
      const out = new Float32Array(parts.length * film.points);
      parts.forEach((part, k) => part.forEach((v, i) => { out[i * parts.length + k] = v; }));
      return buffer(gl.ARRAY_BUFFER, out);
    };
    const places = pack([film.x, film.y]);
    const moved = film.voltages.map((_, s) => pack(film.channels.slice(0, 3).map((c) => c.steps[s])));
    const shown = film.channels.map((c) => c.steps.map((step) => pack([step])));
    const mark = pack([marks]);
    const indices = [triangles, lines].map((data) => buffer(gl.ELEMENT_ARRAY_BUFFER, data));
    const where = (name) => gl.getUniformLocation(made, name);
    const attach = (name, from, size) => {
      const at = gl.getAttribLocation(made, name);
      gl.bindBuffer(gl.ARRAY_BUFFER, from);
      gl.enableVertexAttribArray(at);
      gl.vertexAttribPointer(at, size, gl.FLOAT, false, 0, 0);
    };
    const all = copies(film);
    return (state) => {
      const ratio = Math.min(2, window.devicePixelRatio || 1);
      const [w, h] = [canvas.clientWidth * ratio, canvas.clientHeight * ratio].map((v) => Math.max(1, Math.round(v)));
      if (canvas.width !== w || canvas.height !== h) {
        canvas.width = w;
        canvas.height = h;
      }
      const step = Math.min(Math.floor(state.at), film.voltages.length - 1);
      const next = Math.min(step + 1, film.voltages.length - 1);
      gl.viewport(0, 0, w, h);
      gl.clearColor(0, 0, 0, 0);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      gl.enable(gl.DEPTH_TEST);
      gl.useProgram(made);
      attach('X', places, 2);
      attach('u0', moved[step], 3);
      attach('u1', moved[next], 3);
      attach('s0', shown[state.channel][step], 1);
      attach('s1', shown[state.channel][next], 1);
      attach('mark', mark, 1);
      const [ct, st, ce, se] = [Math.cos(state.turn), Math.sin(state.turn), Math.cos(state.tilt), Math.sin(state.tilt)];
      // turned about the axis of the disc, then tilted towards the eye; columns
      gl.uniformMatrix3fv(where('view'), false, [ct, st * se, -st * ce, -st, ct * se, -ct * ce, 0, ce, se]);
      const size = 0.88 * state.zoom;
      gl.uniform2f(where('scale'), w > h ? (size * h) / w * 1.25 : size, w > h ? size * 1.25 : (size * w) / h);
      gl.uniform1f(where('part'), state.at - step);
      gl.uniform1f(where('times'), state.times);
      gl.uniform1f(where('radius'), film.radius);
      gl.uniform2f(where('range'), ...state.range);
      gl.uniform3fv(where('palette'), palettes[state.palette].flatMap((hex) => dea.rgb(hex).map((v) => v / 255)));
      for (const copy of all) {
        gl.uniformMatrix2fv(where('copy'), false, copy);
        gl.uniform1f(where('lift'), 0);
        gl.uniform4f(where('line'), 0, 0, 0, 0);
        gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, indices[0]);
        gl.drawElements(gl.TRIANGLES, triangles.length, gl.UNSIGNED_INT, 0);
        gl.uniform1f(where('lift'), 0.004);
        gl.uniform4f(where('line'), 0.1, 0.12, 0.15, 1);
        gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, indices[1]);
        gl.drawElements(gl.LINES, lines.length, gl.UNSIGNED_INT, 0);
      }
    };
  };

  const legend = (host, channel, state) => {
    const svg = dea.svg('svg', { viewBox: '0 0 300 34', class: 'legend', role: 'img', 'aria-label': `${channel.label}, ${channel.unit}` });
    const colours = palettes[state.palette];
    const gradient = dea.svg('linearGradient', { id: `${host.id}-colours` },
      ...colours.map((colour, i) => dea.svg('stop', { offset: i / 8, 'stop-color': colour })));
    svg.append(gradient, dea.svg('rect', { x: 10, y: 2, width: 280, height: 11, rx: 2, fill: `url(#${host.id}-colours)` }));
    for (const share of [0, 0.25, 0.5, 0.75, 1]) {
      svg.append(dea.svg('text', { x: 10 + 280 * share, y: 28, 'text-anchor': share === 0 ? 'start' : share === 1 ? 'end' : 'middle' },
        dea.number(channel.factor * (state.range[0] + share * (state.range[1] - state.range[0])), 3)));
    }
    host.replaceChildren(svg);
  };

  const dress = (section, number) => {
    const film = unpack(JSON.parse(section.querySelector('.surface').textContent));
    const host = section.querySelector('.membrane');
    const last = film.voltages.length - 1;
    const z = film.channels[2];
    const largest = Math.max(Math.abs(z.low), Math.abs(z.high));
    const usual = largest > 0 ? Math.min(200, Math.max(1, Math.round((0.3 * film.radius) / largest))) : 1;
    const state = { at: last, times: usual, channel: 2, turn: -0.6, tilt: 0.55, zoom: 1, palette: 'signed', range: [0, 1] };
    const canvas = dea.element('canvas', { tabindex: '0', role: 'img', 'aria-label': 'Deformed membrane; arrow keys turn it, plus and minus change its size' });
    const colours = dea.element('div', { id: `legend-${number}`, class: 'legend-host' });
    const facts = dea.element('output', { class: 'readout' });
    const profile = dea.element('div', { id: `profile-${number}` });
    host.hidden = false;
    section.querySelector('.still').hidden = true;
    let paint = null;

    const voltage = () => {
      const step = Math.min(Math.floor(state.at), last);
      const next = Math.min(step + 1, last);
      return film.voltages[step] + (state.at - step) * (film.voltages[next] - film.voltages[step]);
    };
    const valueAt = (channel, i) => {
      const step = Math.min(Math.floor(state.at), last);
      const part = state.at - step;
      return channel.steps[step][i] * (1 - part) + (part > 0 ? channel.steps[step + 1][i] * part : 0);
    };
    const rays = film.fold > 0
      ? [['along a fibre', film.angle, 0], ['halfway between', film.angle + Math.PI / film.fold, 1]]
      : [['along x', 0, 0], ['along y', Math.PI / 2, 1]];
    const points = rays.map(([title, angle, c]) => ({ title, c, ray: ray(film, angle) }));
    const extent = [1e6 * Math.min(0, z.low), 1e6 * Math.max(0, z.high)];
    const drawProfile = () => dea.plot(profile, {
      label: 'Displacement along the radius',
      xl: 'Radius in the stretched flat film (mm)', yl: 'Displacement z (µm)', height: 200, yRange: extent, xRange: [0, 1e3 * film.radius],
      series: points.map(({ title, c, ray: on }) => ({ title, c, points: on.map(([r, i]) => [1e3 * r, 1e6 * valueAt(z, i)]) })),
    });
    const choose = () => {
      const channel = film.channels[state.channel];
      const both = channel.low < 0 && channel.high > 0;
      const most = Math.max(-channel.low, channel.high);
      state.palette = both ? 'signed' : 'rising';
      state.range = both ? [-most, most] : [channel.low, channel.high];
      if (!(state.range[1] > state.range[0])) { // one value everywhere
        const margin = 0.1 * Math.abs(state.range[0]) || 1 / channel.factor;
        state.range = [state.range[0] - margin, state.range[0] + margin];
      }
      legend(colours, channel, state);
    };
    const draw = () => {
      const channel = film.channels[state.channel];
      let [low, high] = [Infinity, -Infinity];
      for (let i = 0; i < film.points; i++) {
        const value = valueAt(channel, i);
        low = Math.min(low, value);
        high = Math.max(high, value);
      }
      const between = state.at % 1 > 0.01 && state.at % 1 < 0.99;
      const doubt = [Math.floor(state.at), Math.ceil(state.at)].map((at) => film.doubts[at]).find((words) => words);
      facts.textContent = `${dea.number(voltage() / 1e3, 3)} kV${between ? ' (between two computed points)' : ''}` +
        `${doubt ? ` – not to be trusted: ${doubt}` : ''}: ` +
        `${channel.label} from ${dea.number(channel.factor * low, 4)} to ${dea.number(channel.factor * high, 4)} ${channel.unit}`;
      paint?.(state);
      drawProfile();
    };
    const voltageSlider = dea.slider('Voltage', 0, last, 0.01, last, () => `${dea.number(voltage() / 1e3, 3)} kV`, (at) => {
      state.at = Math.abs(at - Math.round(at)) < 0.06 ? Math.round(at) : at; // computed points attract
      draw();
      dea.setVoltage(voltage() / 1e3, section);
    });
    const times = dea.slider('z drawn larger', 1, Math.max(50, 3 * usual), 1, usual, (v) => `${v} times`, (v) => {
      state.times = v;
      draw();
    });
    const names = film.channels.slice(2).map((c) => `${c.label} (${c.unit})`);
    const quantity = dea.choice('Colours', names, (i) => {
      state.channel = i + 2;
      choose();
      draw();
    });
    const reset = dea.button('Reset view', () => {
      Object.assign(state, { turn: -0.6, tilt: 0.55, zoom: 1 });
      draw();
    });
    const top = dea.button('From above', () => {
      Object.assign(state, { turn: 0, tilt: Math.PI / 2, zoom: 1 });
      draw();
    });
    canvas.addEventListener('pointermove', (event) => {
      if (event.buttons & 1) {
        state.turn += 0.008 * event.movementX;
        state.tilt = Math.min(Math.PI / 2, Math.max(-Math.PI / 2, state.tilt + 0.008 * event.movementY));
        draw();
      }
    });
    canvas.addEventListener('pointerdown', (event) => canvas.setPointerCapture(event.pointerId));
    const zoom = (by) => {
      state.zoom = Math.min(5, Math.max(0.5, state.zoom * by));
      draw();
    };
    canvas.addEventListener('wheel', (event) => {
      if (event.ctrlKey || document.activeElement === canvas) { // else the page scrolls
        event.preventDefault();
        zoom(Math.exp(-0.002 * event.deltaY));
      }
    }, { passive: false });
    canvas.addEventListener('keydown', (event) => {
      const turns = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.08], ArrowDown: [0, -0.08] }[event.key];
      if (turns !== undefined) {
        state.turn += turns[0];
        state.tilt = Math.min(Math.PI / 2, Math.max(-Math.PI / 2, state.tilt + turns[1]));
        draw();
      } else if (event.key === '+' || event.key === '-') {
        zoom(event.key === '+' ? 1.15 : 1 / 1.15);
      } else {
        return;
      }
      event.preventDefault();
    });
    host.append(
      dea.element('div', { class: 'stage' }, canvas, colours),
      dea.element('div', { class: 'side' },
        dea.element('div', { class: 'controls' }, voltageSlider.node, times.node, quantity.node, dea.element('div', { class: 'buttons' }, reset, top)),
        facts, profile),
    );
    choose();
    draw();
    // WebGL may take its time to start: the page is there before it
    dea.waits.push(new Promise((done) => {
      setTimeout(() => {
        paint = painter(canvas, film);
        if (paint === null) {
          canvas.replaceWith(dea.element('p', { class: 'note' }, 'This browser has no WebGL: the film in space is not shown.'));
        }
        draw();
        new ResizeObserver(draw).observe(canvas);
        done();
      });
    }));
    dea.onVoltage(section, (kV) => {
      for (let s = 0; s < last; s++) {
        const [a, b] = [film.voltages[s] / 1e3, film.voltages[s + 1] / 1e3];
        if ((kV - a) * (kV - b) <= 0 && a !== b) {
          state.at = s + (kV - a) / (b - a);
          voltageSlider.set(state.at);
          draw();
          return;
        }
      }
    });
    dea.films = [...(dea.films ?? []), { film, state, canvas }];
  };
  document.querySelectorAll('section:has(.surface)').forEach((section, i) => dress(section, i + 1));
})();
