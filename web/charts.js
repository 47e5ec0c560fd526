// Values under the pointer, on the drawing that stands there. Curves may turn back (a path through pull-in), so the
// nearest point is looked for in the drawing and not along x.
(() => {
  const place = (axis, value) => {
    const [low, high, from, to, log] = axis;
    const share = log ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
    return from + share * (to - from);
  };
  const valueAt = (axis, at) => {
    const [low, high, from, to, log] = axis;
    const share = (at - from) / (to - from);
    return log ? low * (high / low) ** share : low + share * (high - low);
  };

  // Point of a series at x, on the branch that is nearest to y: interpolated, except of markers.
  const pointAt = (panel, series, x, y) => {
    const [xs, ys] = series.v;
    let best = null;
    const offer = (px, py, reach) => {
      const away = Math.abs(place(panel.y, py) - y) + reach;
      if (best === null || away < best.away) {
        best = { x: px, y: py, away };
      }
    };
    for (let i = 0; i < xs.length; i++) {
      if (xs[i] === null || ys[i] === null) {
        continue;
      }
      if (series.p) {
        const reach = Math.abs(place(panel.x, xs[i]) - place(panel.x, x));
        if (reach < 12) {
          offer(xs[i], ys[i], reach);
        }
      } else if (i > 0 && xs[i - 1] !== null && ys[i - 1] !== null && (xs[i] - x) * (xs[i - 1] - x) <= 0) {
        const t = xs[i] === xs[i - 1] ? 0 : (x - xs[i - 1]) / (xs[i] - xs[i - 1]);
        offer(x, ys[i - 1] + t * (ys[i] - ys[i - 1]), 0);
      }
    }
    return best;
  };

  const dress = (figure) => {
    const svg = figure.querySelector('svg.chart');
    const panels = JSON.parse(figure.querySelector('.numbers').textContent);
    const readout = dea.element('output', { class: 'readout interactive' });
    const layer = dea.svg('g', { class: 'cursor' });
    const voltage = panels[panels.length - 1].xl.startsWith('Voltage');
    svg.append(layer);
    svg.setAttribute('tabindex', '0');
    figure.querySelector('figcaption').before(readout);

    const clear = () => {
      layer.replaceChildren();
      readout.replaceChildren();
    };
    const show = (x, y) => {
      const [low, high] = panels[0].x;
      clear();
      if (!(x >= low && x <= high)) {
        return;
      }
      readout.append(dea.element('b', {}, `${panels[panels.length - 1].xl.replace(/ \(.*/, '')} ${dea.number(x)}`));
      for (const panel of panels) {
        const at = place(panel.x, x);
        layer.append(dea.svg('path', { d: `M${at} ${panel.y[2]}V${panel.y[3]}` }));
        for (const series of panel.series) {
          const found = pointAt(panel, series, x, y);
          if (found === null) {
            continue;
          }
          const up = place(panel.y, found.y);
          if (up <= panel.y[2] + 1 && up >= panel.y[3] - 1) {
            layer.append(dea.svg('circle', { cx: place(panel.x, found.x), cy: up, r: 4.5, class: `c${series.c}` }));
          }
          readout.append(dea.element('span', { class: `c${series.c}` }, `${series.t} `, dea.element('b', {}, dea.number(found.y))));
        }
      }
    };
    const point = (event) => {
      const box = svg.getBoundingClientRect();
      const scale = svg.viewBox.baseVal.width / box.width;
      const at = [(event.clientX - box.left) * scale, (event.clientY - box.top) * scale];
      const x = valueAt(panels[0].x, at[0]);
      show(x, at[1]);
      figure.value = x;
      if (voltage && x >= panels[0].x[0] && x <= panels[0].x[1]) {
        dea.setVoltage(x, figure);
      }
    };
    svg.addEventListener('pointermove', point);
    svg.addEventListener('pointerdown', point);
    svg.addEventListener('pointerleave', () => {
      if (!voltage) {
        clear();
      }
    });
    svg.addEventListener('keydown', (event) => {
      const [low, high] = panels[0].x;
      const step = { ArrowLeft: -1, ArrowRight: 1, PageDown: -10, PageUp: 10 }[event.key];
      if (step === undefined) {
        return;
      }
      event.preventDefault();
      const from = figure.value ?? low;
      figure.value = Math.min(high, Math.max(low, from + (step * (high - low)) / 100));
      show(figure.value, panels[0].y[2]);
      if (voltage) {
        dea.setVoltage(figure.value, figure);
      }
    });
    if (voltage) {
      dea.onVoltage(figure, (value) => {
        figure.value = value;
        show(value, panels[0].y[2]);
      });
    }
  };
  dea.dress = (root) => root.querySelectorAll('figure.plot').forEach(dress);
  dea.dress(document);
})();
