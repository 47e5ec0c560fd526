// The explorer: numbers between those that were computed, each with its error. src/io/sparse_grid.c and
// src/model/reduced/reduced_core.c are the same in C.
(() => {
  // Barycentric basis of Floater and Hormann on points x; of degree x.length - 1 Lagrange's.
  const basis = (x, most) => {
    const d = Math.min(most, x.length - 1);
    const weights = x.map((at, k) => {
      let sum = 0;
      for (let i = Math.max(0, k - d); i <= k && i + d < x.length; i++) {
        let product = i % 2 === 0 ? 1 : -1;
        for (let j = i; j <= i + d; j++) {
          product /= j === k ? 1 : at - x[j];
        }
        sum += product;
      }
      return sum;
    });
    return (at) => {
      if (x.includes(at)) {
        return x.map((one) => (one === at ? 1 : 0));
      }
      const parts = weights.map((w, k) => w / (at - x[k]));
      const sum = parts.reduce((a, b) => a + b);
      return parts.map((part) => part / sum);
    };
  };

  // Smolyak's weights of the cases of a sparse grid, for shares of the ranges of its keys.
  const sparseGrid = ({ keys, nodes, level }) => {
    const d = keys.length;
    const fine = 2 ** level;
    const share = (k) => (1 - Math.cos((Math.PI * k) / fine)) / 2;
    const levelOf = (k) => {
      let first = level;
      for (let rest = k; first > 1 && rest % 2 === 0; rest /= 2) {
        first--;
      }
      return 2 * k === fine ? 0 : first;
    };
    const grids = Array.from({ length: level + 1 }, (_, l) => {
      const at = l === 0 ? [fine / 2] : Array.from({ length: 2 ** l + 1 }, (_, i) => i * (fine >> l));
      return { at, basis: basis(at.map(share), fine) };
    });
    const binomial = (n, k) => (k === 0 ? 1 : (binomial(n, k - 1) * (n - k + 1)) / k);
    // grids of each case: [factor, level by key]
    const combine = (from, sum, levels) => {
      if (levels.length < d) {
        const lists = [];
        for (let l = levelOf(from[levels.length]); sum + l <= level; l++) {
          lists.push(...combine(from, sum + l, [...levels, l]));
        }
        return lists;
      }
      return sum > level - d ? [[(-1) ** (level - sum) * binomial(d - 1, level - sum), levels]] : [];
    };
    const cases = Array.from({ length: nodes.length / d }, (_, c) => {
      const node = nodes.slice(c * d, (c + 1) * d);
      return { node, lists: combine(node, 0, []) };
    });
    return (shares) => {
      const tables = shares.map((s) => grids.map((grid) => {
        const table = [];
        grid.basis(s).forEach((value, i) => { table[grid.at[i]] = value; });
        return table;
      }));
      return cases.map(({ node, lists }) => lists.reduce((sum, [factor, levels]) =>
        sum + levels.reduce((product, l, j) => product * tables[j][l][node[j]], factor), 0));
    };
  };

  const axis = (key, unit, low, high, value) => {
    const most = Math.max(Math.abs(low), Math.abs(high));
    const [factor, prefix] = ['1', 'kg'].includes(unit) ? [1, ''] : [[1e-6, 'M'], [1e-3, 'k'], [1, ''], [1e3, 'm'], [1e6, 'µ']].find(([f]) => f * most >= 1) ?? [1e9, 'n'];
    const name = key === 'voltage_V' ? 'Voltage' : key === 'force' ? 'Force' : key;
    return { key, name, low, high, value: Math.min(high, Math.max(low, value)), factor, unit: unit === '1' ? '' : prefix + unit };
  };

  // What was computed at voltages, of one design or of those of a sparse grid.
  const emulator = (data, voltage_V) => {
    const { keys, voltages_V: volts, quantities } = data;
    const [n, Q] = [volts.length, quantities.length];
    const grid = keys.length > 0 ? sparseGrid(data) : () => [1];
    const bases = new Map();
    quantities.forEach(({ first, end }) => bases.set(`${first} ${end}`, end > first ? basis(volts.slice(first, end), 4) : null));
    let kept = { of: null };
    const lineAt = (values) => { // of the design, at all voltages
      const of = keys.map((key) => values[key.name]).join(' ');
      if (kept.of !== of) {
        const shares = keys.map((key) => (values[key.name] - key.low) / (key.high - key.low));
        const weights = grid(shares);
        const [line, error] = [new Float64Array(n * Q), new Float64Array(n * Q)];
        weights.forEach((w, c) => {
          for (let i = 0; i < n * Q; i++) {
            line[i] += w * (data.values[c * n * Q + i] ?? NaN);
            error[i] += Math.abs(w) * data.error[c * n * Q + i];
          }
        });
        const away = Array.from(weights, (_, c) => Math.hypot(...shares.map((s, j) => s - (1 - Math.cos((Math.PI * data.nodes[c * keys.length + j]) / 2 ** data.level)) / 2)));
        const reach = 2 * Math.min(...away) + 1e-12;
        const near = [...away.keys()].filter((c) => away[c] <= reach);
        kept = { of, near, line, error, inside: shares.every((s) => s >= -1e-12 && s <= 1 + 1e-12) };
      }
      return kept;
    };
    const wordsAt = ({ near }, low, high) => { // those of designs and voltages beside
      const all = near.reduce((sum, c) => sum | data.flags[c * n + low] | data.flags[c * n + high], 0);
      return data.flag_words.filter((_, f) => (all >> f) & 1);
    };
    return {
      title: keys.length > 0 ? `${data.model}, over ${keys.map((key) => key.name).join(', ')}` : `${data.model}, this design`,
      note: keys.length > 0 ? `Interpolated between ${data.nodes.length / keys.length} designs of model ${data.model}. Errors: differences to designs and voltages that were left out. The film in 3D is the run’s.` :
        `Interpolated between the run’s points of model ${data.model}. Errors: differences to points that were left out.`,
      axes: [axis('voltage_V', 'V', volts[0], volts[n - 1], voltage_V), ...keys.map((key) => axis(key.name, key.unit, key.low, key.high, key.value ?? (key.low + key.high) / 2))],
      quantities,
      at(values) {
        const V = values.voltage_V;
        const line = lineAt(values);
        const high = Math.max(0, volts.findIndex((v) => v >= V));
        const low = volts[high] > V && high > 0 ? high - 1 : high;
        const parts = new Map([...bases].map(([range, of]) => [range, of?.(V)]));
        const out = {};
        quantities.forEach(({ key, first, end }, q) => {
          const there = line.inside && end > first && V >= volts[first] && V <= volts[end - 1];
          let sum = there ? 0 : NaN;
          parts.get(`${first} ${end}`)?.forEach((b, k) => { sum += b === 0 ? 0 : b * line.line[(first + k) * Q + q]; });
          out[key] = [sum, there ? Math.max(line.error[low * Q + q], line.error[high * Q + q]) : NaN];
        });
        return { values: out, flags: wordsAt(line, low, high) };
      },
    };
  };

  // A spline of reduced_core.c at x, y: value, slopes by x and y, second slope by x.
  const splineAt = (s, x, y) => {
    const cell = (breaks, at) => {
      const i = Math.max(0, breaks.findLastIndex((b, k) => k < breaks.length - 1 && (k === 0 || at >= b)));
      return [i, (at - breaks[i]) / (breaks[i + 1] - breaks[i]), breaks[i + 1] - breaks[i]];
    };
    const horner = (c, t) => c.reduceRight(([f, d, dd], one) => [f * t + one, d * t + f, dd * t + d], [0, 0, 0]);
    const [i, u, width] = cell(s.force, x);
    const [j, v, height] = cell(s.voltage, y);
    const from = 36 * (i * (s.voltage.length - 1) + j);
    const rows = [0, 1, 2, 3, 4, 5].map((k) => horner(s.coefficients.slice(from + 6 * k, from + 6 * k + 6), v));
    const [f, d, dd] = horner(rows.map((row) => row[0]), u);
    return [f, d / width, horner(rows.map((row) => row[1]), u)[0] / height, (2 * dd) / width ** 2];
  };

  // The model that `dea reduce-order` has made: a voltage and a force along its coordinate.
  const reduced = (data, voltage_V) => {
    const [coordinate, ...outputs] = data.quantities;
    const y = (V) => (data.even ? V * V : V);
    const charge = (V, f) => -f[2] * (data.even ? 2 * V : 1);
    const [low, high] = [data.even ? 0 : data.range_voltage_V[0], data.range_voltage_V[1]];
    const full = Math.abs(charge(high, splineAt(data.energy, 0, y(high))));
    const inside = (x, [from, to]) => x >= from && x <= to;
    return {
      title: 'reduced, with a force',
      note: 'Model reduced, made from model 3d by dea reduce-order. Errors: largest differences to samples that were left out of its fit.',
      axes: [axis('voltage_V', 'V', low, high, voltage_V), axis('force', coordinate.unit === 'deg' ? 'N m' : 'N', ...data.range_force, 0)],
      quantities: [coordinate, { key: 'stiffness', title: 'stiffness', unit: coordinate.unit === 'deg' ? 'N m/rad' : 'N/mm', factor: coordinate.unit === 'deg' ? 1 : 1e-3 },
        { key: 'charge_C', title: 'charge', unit: 'nC', factor: 1e9 }, ...outputs.filter(({ key, factor }, i) => key !== coordinate.key && data.outputs[i].coefficients.some((c) => Math.abs(factor * c) > 1e-9))],
      line: { key: coordinate.key, axis: 'force', stiffness: data.finger_N_per_m },
      at({ voltage_V: V, force }) {
        if (!inside(V, data.range_voltage_V) || !inside(force, data.range_force)) {
          return { values: {}, flags: [] };
        }
        const f = splineAt(data.energy, force, y(V));
        const out = {};
        outputs.forEach(({ key }, i) => { out[key] = [splineAt(data.outputs[i], force, y(V))[0], NaN]; });
        Object.assign(out, { [coordinate.key]: [-f[1], data.error * Math.abs(data.stroke)], stiffness: [-1 / f[3], NaN], charge_C: [charge(V, f), data.charge_error * full] });
        return { values: out, flags: [] };
      },
    };
  };

  const unitOf = ({ unit }) => (unit === '1' ? '' : ` (${unit.replace(/u(?=m|[VANC])/, 'µ')})`);

  // Sliders, plots, table and map of one source.
  const dress = (host, source, share) => {
    const { axes, quantities } = source;
    const voltage = axes[0];
    const initial = Object.fromEntries(axes.map((a) => [a.key, a.value]));
    const chosen = { ...initial };
    const shown = quantities.filter(({ key }) => Number.isFinite(source.at(initial).values[key]?.[0])).slice(0, source.line ? 3 : 4);
    const plots = [...shown, ...(source.line ? [source.line] : [])].map(({ key }, i) => dea.element('div', { id: `${host.id}-${i}-${key}`, class: 'plot' }));
    const table = dea.element('div', { class: 'scroll', tabindex: '0', role: 'region', 'aria-label': 'Values at the sliders', 'aria-live': 'polite' });
    const problem = dea.element('p', { class: 'warning', hidden: '' });
    const map = dea.element('div', { id: `${host.id}-map`, class: 'map' });
    let pending = false;
    let operating = null;
    let own = null; // curves of the run's design

    const curve = (values, along = voltage) => Array.from({ length: 81 }, (_, i) => {
      const x = i === 80 ? along.high : along.low + ((along.high - along.low) * i) / 80;
      return { x, ...source.at({ ...values, [along.key]: x }) };
    });
    const doubted = (p) => p.flags.some((flag) => flag.doubt);
    const changed = () => axes.some(({ key }) => key !== 'voltage_V' && chosen[key] !== initial[key]);
    const drawQuantity = (host, quantity, points, own, now) => {
      const { key, title, factor } = quantity;
      const y = (p, sign = 0) => factor * ((p.values[key]?.[0] ?? NaN) + sign * (p.values[key]?.[1] || 0));
      const series = [false, true].map((doubt) => ({
        title: doubt ? (points.some(doubted) ? 'in doubt' : '') : source.title, c: 0, dashed: doubt,
        points: points.map((p, i) => [voltage.factor * p.x, doubted(p) === doubt || (points[i - 1] && doubted(points[i - 1]) === doubt) ? y(p) : NaN]),
      }));
      if (own !== null) {
        series.unshift({ title: 'the run’s design', c: 7, points: own.map((p) => [voltage.factor * p.x, y(p)]) });
      }
      dea.plot(host, {
        label: `${title} against the voltage`, xl: `Voltage V (${voltage.unit})`, yl: title + unitOf(quantity), series, height: 260,
        xRange: [voltage.factor * voltage.low, voltage.factor * voltage.high], cursor: voltage.factor * chosen.voltage_V,
        band: [...points.map((p) => [voltage.factor * p.x, y(p, 1)]), ...[...points].reverse().map((p) => [voltage.factor * p.x, y(p, -1)])],
        at: [{ y: y(now), c: 0 }].filter((p) => Number.isFinite(p.y)),
      });
    };
    // Force against the coordinate at this voltage, and a fingertip that is pushed from where it lies at 0 V.
    const drawLine = (host) => {
      const along = axes.find((a) => a.key === source.line.axis);
      const of = quantities.find((q) => q.key === source.line.key);
      const q = (p) => p.values[of.key][0];
      const points = curve(chosen, along);
      const rest = q(source.at({ voltage_V: Math.max(0, voltage.low), force: 0 }));
      const series = [{ title: 'device', c: 0, points: points.map((p) => [of.factor * q(p), -along.factor * p.x]) }];
      if (source.line.stiffness > 0 && of.unit !== 'deg') {
        series.push({ title: 'fingertip', c: 6, dashed: true, points: points.map((p) => [of.factor * q(p), along.factor * source.line.stiffness * (q(p) - rest)]) });
      }
      const forces = series[0].points.map((p) => p[1]);
      dea.plot(host, { label: 'Load line', xl: of.title + unitOf(of), yl: `Force on what it pushes (${along.unit})`, series, height: 260, yRange: [Math.min(...forces), Math.max(...forces)] });
    };
    const fill = (now) => {
      const rows = quantities.filter(({ key }) => now.values[key] !== undefined).map((quantity) => {
        const [value, error] = now.values[quantity.key];
        return dea.element('tr', {}, dea.element('th', { scope: 'row' }, quantity.title + unitOf(quantity)),
          dea.element('td', { class: 'n' }, dea.number(quantity.factor * value, 5)),
          dea.element('td', { class: 'n' }, Number.isFinite(error) ? `± ${dea.number(quantity.factor * error, 2)}` : ''));
      });
      const head = ['', `At ${dea.number(voltage.factor * chosen.voltage_V, 3)} ${voltage.unit}`, 'Error'].map((text) => dea.element('th', { scope: 'col', class: 'n' }, text));
      table.replaceChildren(dea.element('table', {}, dea.element('thead', {}, dea.element('tr', {}, ...head)), dea.element('tbody', {}, ...rows)));
      const missing = rows.length === 0 || quantities.some(({ key }) => Number.isNaN(now.values[key]?.[0]));
      const words = now.flags.map((flag) => flag.word).join(', ');
      problem.hidden = !missing && words === '';
      problem.textContent = [words && `${now.flags.some((flag) => flag.doubt) ? 'Not to be trusted' : 'Note'}: ${words}.`, missing && 'A dash: beyond what was computed.'].filter(Boolean).join(' ');
    };
    const draw = () => {
      pending = false;
      const points = curve(chosen);
      const now = source.at(chosen);
      own ??= curve(initial);
      shown.forEach((quantity, i) => drawQuantity(plots[i], quantity, points, changed() ? own : null, now));
      if (source.line) {
        drawLine(plots[shown.length]);
      }
      fill(now);
      operating?.follow();
    };
    const later = () => {
      if (!pending) {
        pending = true;
        requestAnimationFrame(draw);
      }
    };
    const sliders = {};
    for (const { key, name, low, high, factor, unit } of axes) {
      sliders[key] = dea.slider(name, factor * low, factor * high, 'any', factor * chosen[key], () => `${dea.number(factor * chosen[key], 4)} ${unit}`, (value) => {
        const near = Math.abs(value / factor - initial[key]) < (high - low) / 400 ? initial[key] : value / factor; // the run's value attracts
        chosen[key] = Math.min(high, Math.max(low, near));
        later();
        if (key === 'voltage_V') {
          dea.setVoltage(chosen.voltage_V / 1e3, share);
        }
      });
    }
    const reset = dea.button('Back to the run’s design', () => {
      Object.assign(chosen, initial);
      axes.forEach(({ key, factor }) => sliders[key].set(factor * chosen[key]));
      later();
    });
    const more = dea.element('details', {}, dea.element('summary', {}, 'Operating map of any two of these'), map);
    host.replaceChildren(
      dea.element('div', { class: 'controls' }, ...axes.map(({ key }) => sliders[key].node), dea.element('div', { class: 'buttons' }, reset)),
      problem, dea.element('div', { class: 'plots' }, ...plots), table, dea.element('p', { class: 'still' }, source.note), ...(axes.length > 1 ? [more] : []));
    if (axes.length > 1) {
      operating = dea.map(map, { source, axes: axes.map((a) => ({ ...a, label: a.unit === '' ? a.name : `${a.name} (${a.unit})` })), quantities: shown, unitOf, now: () => chosen });
      more.addEventListener('toggle', () => more.open && operating.compute());
    }
    draw();
    return {
      map: operating?.compute,
      voltage: (kV) => {
        chosen.voltage_V = Math.min(voltage.high, Math.max(voltage.low, 1e3 * kV));
        sliders.voltage_V.set(voltage.factor * chosen.voltage_V);
        later();
      },
    };
  };

  dea.explorers = [...document.querySelectorAll('section:has(script.sources)')].map((section, number) => {
    const given = JSON.parse(section.querySelector('script.sources').textContent);
    const sources = given.map((data) => (data.dea_emulator ? emulator : reduced)(data, data.voltage_V));
    const host = section.querySelector('.explorer');
    const body = dea.element('div', { id: `explorer-body-${number + 1}` });
    let shown = null;
    const show = (i) => { shown = dress(body, sources[i], host); };
    section.querySelector('p.still').hidden = true;
    host.hidden = false;
    host.append(...(sources.length > 1 ? [dea.choice('Numbers of', sources.map((s) => s.title), show).node] : []), body);
    show(0);
    dea.onVoltage(host, (kV) => shown.voltage(kV));
    // Quantities of a source for other values than the run's, in SI: for tests and the console.
    return { sources, map: () => shown.map(), at: (i, values) => sources[i].at({ ...Object.fromEntries(sources[i].axes.map((a) => [a.key, a.value])), ...values }) };
  });
  dea.ready = Promise.all(dea.waits);
})();
