// Operating map of any two parameters of the explorer: each place is a design that the core solves.
// axes: [{ key, label, low, high, factor }]; solve: values -> point of model lumped or null; now: () -> chosen values.
dea.map = (host, { axes, solve, now, lift }) => {
  const [NX, NY] = [40, 30];
  const colour = (share) => {
    const at = 8 * Math.min(1, Math.max(0, share));
    const i = Math.min(7, Math.floor(at));
    const [from, to] = [dea.rgb(dea.rising[i]), dea.rgb(dea.rising[i + 1])];
    return `rgb(${from.map((v, k) => Math.round(v + (at - i) * (to[k] - v))).join(',')})`;
  };
  const value = (p) => (lift ? 1e6 * p.fibre_tip_z_m : 100 * (p.electrode_stretch - 1));
  const quantity = lift ? 'z of the fibre tip (µm)' : 'electrode strain (%)';
  const plot = dea.element('div', { id: `${host.id}-plot`, class: 'plot' });
  const words = dea.element('output', { class: 'readout' });
  const run = dea.element('button', { type: 'button' }, 'Compute the map');
  let [x, y] = [axes[1], axes[0]];
  let turn = 0;
  let drawn = null; // what the map shows: its points, axes, and the other values that they were computed for
  let timer = 0;
  const others = (x, y, values) => JSON.stringify({ ...values, [x.key]: 0, [y.key]: 0 });

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

  const draw = (grid, x, y) => {
    const px = (i) => x.factor * (x.low + ((x.high - x.low) * i) / NX);
    const py = (j) => y.factor * (y.low + ((y.high - y.low) * j) / NY);
    const at = (i, j) => grid[j * (NX + 1) + i];
    const good = grid.filter((p) => p !== null && Number.isFinite(value(p)));
    const sorted = good.map(value).sort((a, b) => a - b);
    const top = sorted.length > 0 ? sorted[Math.floor(0.98 * (sorted.length - 1))] : 1;
    const cells = [];
    for (let j = 0; j < NY; j++) {
      for (let i = 0; i < NX; i++) {
        const p = at(i, j);
        const lost = p !== null && (p.breakdown_margin < 0 || p.min_tension_N_per_m < 0);
        cells.push({ x0: px(i), x1: px(i + 1), y0: py(j), y1: py(j + 1), fill: p === null ? 'none' : colour(value(p) / (top || 1)), opacity: lost ? 0.4 : 1 });
      }
    }
    const levels = dea.axis(0, top, 5);
    const lines = (name, quantity, level, c, dashed) => ({ title: name, c, dashed, points: contour((i, j) => (at(i, j) === null ? NaN : quantity(at(i, j))), level, px, py) });
    const series = [];
    for (let level = levels.step; level < top; level += levels.step) {
      series.push({ ...lines(`${dea.number(level)}`, value, level, 6), thin: true });
    }
    series.push(lines('breakdown', (p) => p.breakdown_margin, 0, 1), lines('film slack', (p) => p.min_tension_N_per_m, 0, 5));
    const chosen = now();
    dea.plot(plot, {
      label: `Map of ${y.label} and ${x.label}`, xl: x.label, yl: y.label, height: 320, cells,
      xRange: [px(0), px(NX)], yRange: [py(0), py(NY)], exact: true,
      series: series.filter((s) => s.points.length > 0),
      spot: [x.factor * chosen[x.key], y.factor * chosen[y.key]],
    });
    const none = grid.length - good.length;
    words.textContent = `Colours and black lines: ${quantity}, model lumped; faint where the film breaks down or is slack. ` +
      `${none > 0 ? 'Empty: no stable equilibrium, or lengths that do not fit. ' : ''}` +
      `The ring is the design of the sliders${[x.key, y.key].includes('voltage_V') ? '' : `, all at ${dea.number(chosen.voltage_V / 1e3, 3)} kV`}.`;
  };

  const compute = async () => {
    const mine = ++turn;
    const [ax, ay] = [x, y];
    const kept = { ...now() };
    clearTimeout(timer);
    if (ax === ay) {
      words.textContent = 'Choose two different parameters.';
      return;
    }
    const grid = [];
    for (let j = 0; j <= NY; j++) {
      for (let i = 0; i <= NX; i++) {
        grid.push(solve({
          ...kept,
          [ax.key]: ax.low + ((ax.high - ax.low) * i) / NX,
          [ay.key]: ay.low + ((ay.high - ay.low) * j) / NY,
        }));
      }
      if (j % 6 === 5) { // the page stays awake
        words.textContent = `${Math.round((100 * j) / NY)} %`;
        await new Promise((done) => { setTimeout(done); });
        if (mine !== turn) {
          return;
        }
      }
    }
    drawn = { grid, x: ax, y: ay, others: others(ax, ay, kept) };
    host.classList.remove('stale');
    draw(grid, ax, ay);
  };
  // The sliders have moved: along the axes only the ring does, else the map is computed again.
  const follow = () => {
    if (drawn === null) {
      return;
    }
    clearTimeout(timer);
    if (drawn.x === x && drawn.y === y && drawn.others === others(x, y, now())) {
      host.classList.remove('stale');
      draw(drawn.grid, x, y);
    } else {
      host.classList.add('stale');
      timer = setTimeout(compute, 150);
    }
  };
  const labels = axes.map((a) => a.label);
  const across = dea.choice('Across', labels, (i) => { x = axes[i]; compute(); });
  const up = dea.choice('Upwards', labels, (i) => { y = axes[i]; compute(); });
  across.select.value = 1;
  up.select.value = 0;
  run.addEventListener('click', compute);
  host.append(dea.element('div', { class: 'controls' }, across.node, up.node, dea.element('div', { class: 'buttons' }, run)), plot, words);
  return { compute, follow };
};
