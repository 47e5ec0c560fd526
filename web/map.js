// Map of a quantity over any two axes of a source of the explorer (explorer.js).
// axes: its axes with labels; quantities: those to choose from; now: () -> chosen values.
dea.map = (host, { source, axes, quantities, unitOf, now }) => {
  const [NX, NY] = [40, 30];
  const colour = (share) => {
    const at = 8 * Math.min(1, Math.max(0, share));
    const i = Math.min(7, Math.floor(at));
    const [from, to] = [dea.rgb(dea.rising[i]), dea.rgb(dea.rising[i + 1])];
    return `rgb(${from.map((v, k) => Math.round(v + (at - i) * (to[k] - v))).join(',')})`;
  };
  const plot = dea.element('div', { id: `${host.id}-plot`, class: 'plot' });
  const words = dea.element('output', { class: 'readout' });
  let [x, y, quantity] = [axes[1], axes[0], quantities[0]];
  let drawn = null; // what the map shows: its points, and all but the ring that they depend on
  let timer = 0;
  const state = () => JSON.stringify({ ...now(), [x.key]: x.key, [y.key]: y.key, quantity: quantity.key });

  // Straight pieces of the line at which a quantity on the lattice has a level.
  const contour = (at, level, px, py) => {
    const pieces = [];
    for (let j = 0; j < NY; j++) {
      for (let i = 0; i < NX; i++) {
        const corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
        const values = corners.map(([a, b]) => at(a, b));
        if (!values.every(Number.isFinite)) {
          continue;
        }
        const ends = [];
        corners.forEach(([a, b], k) => {
          const [c, d] = corners[(k + 1) % 4];
          const [u, v] = [values[k], values[(k + 1) % 4]];
          if ((u < level) !== (v < level)) {
            const t = (level - u) / (v - u);
            ends.push([px(a + t * (c - a)), py(b + t * (d - b))]);
          }
        });
        for (let k = 0; k + 1 < ends.length; k += 2) {
          pieces.push(ends[k], ends[k + 1], [NaN, NaN]);
        }
      }
    }
    return pieces;
  };

  const draw = () => {
    const px = (i) => x.factor * (x.low + ((x.high - x.low) * i) / NX);
    const py = (j) => y.factor * (y.low + ((y.high - y.low) * j) / NY);
    const at = (i, j, key) => drawn.grid[j * (NX + 1) + i].values[key]?.[0] ?? NaN;
    const value = (i, j) => quantity.factor * at(i, j, quantity.key);
    const good = drawn.grid.map((p) => quantity.factor * (p.values[quantity.key]?.[0] ?? NaN)).filter(Number.isFinite);
    const [low, high] = [Math.min(...good), Math.max(...good)];
    const cells = [];
    for (let j = 0; j < NY; j++) {
      for (let i = 0; i < NX; i++) {
        const v = value(i, j);
        const faint = drawn.grid[j * (NX + 1) + i].flags.length > 0;
        cells.push({ x0: px(i), x1: px(i + 1), y0: py(j), y1: py(j + 1), fill: Number.isFinite(v) ? colour((v - low) / (high - low || 1)) : 'none', opacity: faint ? 0.4 : 1 });
      }
    }
    const series = [];
    const { step, low: first } = dea.axis(low, high, 5);
    for (let level = first; level < high; level += step) {
      series.push({ title: dea.number(Math.abs(level) < 1e-9 * step ? 0 : level), c: 6, thin: true, points: contour(value, level, px, py) });
    }
    [['breakdown', 'breakdown_margin', 1], ['film slack', 'min_tension_N_per_m', 5]].forEach(([title, key, c]) => series.push({ title, c, points: contour((i, j) => at(i, j, key), 0, px, py) }));
    dea.plot(plot, {
      label: `Map of ${y.label} and ${x.label}`, xl: x.label, yl: y.label, height: 320, cells,
      xRange: [px(0), px(NX)], yRange: [py(0), py(NY)], exact: true,
      series: series.filter((s) => s.points.length > 0),
      spot: [x.factor * now()[x.key], y.factor * now()[y.key]],
    });
    words.textContent = `Colours and black lines: ${quantity.title}${unitOf(quantity)}, ${source.title}; faint where it has a flag` +
      `${good.length < drawn.grid.length ? ', empty beyond what was computed' : ''}. The ring is the design of the sliders.`;
  };

  const compute = () => {
    clearTimeout(timer);
    if (x === y) {
      words.textContent = 'Choose two different axes.';
      return;
    }
    drawn = { state: state(), grid: [] };
    for (let j = 0; j <= NY; j++) {
      for (let i = 0; i <= NX; i++) {
        drawn.grid.push(source.at({ ...now(), [x.key]: x.low + ((x.high - x.low) * i) / NX, [y.key]: y.low + ((y.high - y.low) * j) / NY }));
      }
    }
    host.classList.remove('stale');
    draw();
  };
  // The sliders have moved: along the axes only the ring does, else the map is computed again.
  const follow = () => {
    if (drawn !== null && drawn.state === state()) {
      clearTimeout(timer);
      host.classList.remove('stale');
      draw();
    } else if (drawn !== null) {
      host.classList.add('stale');
      clearTimeout(timer);
      timer = setTimeout(compute, 150);
    }
  };
  const labels = axes.map((a) => a.label);
  const across = dea.choice('Across', labels, (i) => { x = axes[i]; compute(); });
  const up = dea.choice('Upwards', labels, (i) => { y = axes[i]; compute(); });
  const what = dea.choice('Of', quantities.map((q) => q.title), (i) => { quantity = quantities[i]; compute(); });
  across.select.value = 1;
  up.select.value = 0;
  host.append(dea.element('div', { class: 'controls' }, across.node, up.node, what.node), plot, words);
  return { compute, follow };
};
