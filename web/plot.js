// A drawing like those of the page (plot_svg.c), made anew whenever numbers change.
dea.axis = (low, high, most) => {
  if (!(high - low > 1e-9 * Math.max(Math.abs(low), Math.abs(high)))) { // one value, but for its last digits
    const room = high !== 0 ? 0.1 * Math.abs(high) || 1 : 1;
    [low, high] = Number.isFinite(low) ? [low - room, high + room] : [0, 1];
  }
  const least = (high - low) / most;
  const power = 10 ** Math.floor(Math.log10(least));
  const step = power * ([1, 2, 5, 10].find((n) => n * power >= 0.999 * least) ?? 10);
  return { low: step * Math.floor(low / step + 1e-9), high: step * Math.ceil(high / step - 1e-9), step };
};
// spec: { cells, spot, band, exact, label, xl, yl, series: [{ title, c, dashed, points: [[x, y], ...] }], cursor, yRange, xRange, height }
dea.plot = (host, spec) => {
  const [W, H, L, R, T, B] = [640, spec.height ?? 330, 66, 18, 12, 46];
  const all = spec.series.flatMap((s) => s.points).filter(([x, y]) => Number.isFinite(x) && Number.isFinite(y));
  const [lowX, highX] = spec.xRange ?? [Math.min(...all.map((p) => p[0])), Math.max(...all.map((p) => p[0]))];
  const seen = all.filter((p) => p[0] >= lowX && p[0] <= highX);
  const [lowY, highY] = spec.yRange ?? [Math.min(...seen.map((p) => p[1])), Math.max(...seen.map((p) => p[1]))];
  const x = { ...dea.axis(lowX, highX, 9), ...(highX > lowX ? { low: lowX, high: highX } : {}) };
  const y = { ...dea.axis(lowY, highY, 7), ...(spec.exact ? { low: lowY, high: highY } : {}) };
  const px = (v) => L + ((v - x.low) / (x.high - x.low)) * (W - L - R);
  const py = (v) => T + H - ((v - y.low) / (y.high - y.low)) * H;
  const svg = dea.svg('svg', { viewBox: `0 0 ${W} ${H + T + B}`, class: 'chart', role: 'img', 'aria-label': spec.label });
  const text = (at, anchor, content, extra = {}) => dea.svg('text', { x: at[0], y: at[1], 'text-anchor': anchor, ...extra }, content);
  let grid = '';
  const tics = dea.svg('g', { class: 'tics' });
  const tic = (v, step) => dea.number(Math.abs(v) < 1e-9 * step ? 0 : v, 6);
  for (let v = x.step * Math.ceil(x.low / x.step - 1e-9); v <= x.high + 1e-9 * x.step; v += x.step) {
    grid += `M${px(v)} ${T + H}V${T}`;
    tics.append(text([px(v), T + H + 18], 'middle', tic(v, x.step)));
  }
  for (let v = y.step * Math.ceil(y.low / y.step - 1e-9); v <= y.high + 1e-9 * y.step; v += y.step) {
    grid += `M${L} ${py(v)}H${W - R}`;
    tics.append(text([L - 8, py(v) + 4], 'end', tic(v, y.step)));
  }
  const id = `clip-${host.id}`;
  const clip = dea.svg('clipPath', { id }, dea.svg('rect', { x: L, y: T, width: W - L - R, height: H }));
  const lines = dea.svg('g', { 'clip-path': `url(#${id})` });
  const lineGroup = dea.svg('g', { class: 'grid' }, dea.svg('path', { d: grid }));
  for (const c of spec.cells ?? []) {
    lines.append(dea.svg('rect', { x: px(c.x0), y: py(c.y1), width: px(c.x1) - px(c.x0), height: py(c.y0) - py(c.y1), 'shape-rendering': 'crispEdges', fill: c.fill, opacity: c.opacity }));
  }
  const band = (spec.band ?? []).filter(([vx, vy]) => Number.isFinite(vx) && Number.isFinite(vy));
  if (band.length > 0) {
    lines.append(dea.svg('path', { class: 'b0', d: `M${band.map(([vx, vy]) => `${px(vx).toFixed(2)} ${py(vy).toFixed(2)}`).join('L')}Z` }));
  }
  for (const s of spec.series) {
    let d = '';
    let pen = false;
    for (const [vx, vy] of s.points) {
      const there = Number.isFinite(vx) && Number.isFinite(vy);
      if (there) {
        d += `${pen ? 'L' : 'M'}${px(vx).toFixed(2)} ${py(vy).toFixed(2)}`;
      }
      pen = there;
    }
    lines.append(dea.svg('path', { class: `line c${s.c}${s.dashed ? ' dashed' : ''}${s.thin ? ' thin' : ''}`, d }));
  }
  for (const s of spec.series.filter((one) => one.thin)) { // a thin line says its level on itself
    const on = s.points.filter(([vx]) => Number.isFinite(vx));
    const [vx, vy] = on[Math.floor(on.length / 2)];
    lines.append(text([px(vx), py(vy) + 4], 'middle', s.title, { class: 'level' }));
  }
  if (spec.spot !== undefined) {
    lines.append(dea.svg('circle', { class: 'spot', cx: px(spec.spot[0]), cy: py(spec.spot[1]), r: 6 }));
  }
  if (spec.cursor !== undefined) {
    const cursor = dea.svg('g', { class: 'cursor' }, dea.svg('path', { d: `M${px(spec.cursor)} ${T + H}V${T}` }));
    for (const at of spec.at ?? []) {
      cursor.append(dea.svg('circle', { cx: px(spec.cursor), cy: py(at.y), r: 4.5, class: `c${at.c}` }));
    }
    lines.append(cursor);
  }
  const labels = dea.svg('g', { class: 'labels' },
    text([(L + W - R) / 2, T + H + 38], 'middle', spec.xl),
    text([0, 0], 'middle', spec.yl, { transform: `translate(16 ${T + H / 2}) rotate(-90)` }),
  );
  svg.append(clip, lineGroup, tics, labels, lines, dea.svg('path', { class: 'frame', d: `M${L} ${T}V${T + H}H${W - R}` }));
  const key = dea.element('ul', { class: 'key' });
  for (const s of spec.series.filter((one) => one.title && !one.thin)) {
    const sample = dea.svg('svg', { class: 'sample', viewBox: '0 0 28 14', 'aria-hidden': 'true' },
      dea.svg('path', { class: `line c${s.c}${s.dashed ? ' dashed' : ''}`, d: 'M1 7H27' }));
    key.append(dea.element('li', {}, sample, s.title));
  }
  host.replaceChildren(svg, key);
};
