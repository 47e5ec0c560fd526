// The explorer: the models lumped and axisymmetric of the C core, computed in the page.
(() => {
  const stored = document.getElementById('core');
  if (stored === null) {
    dea.ready = Promise.all(dea.waits);
    return;
  }

  const start = async () => {
    const bytes = Uint8Array.from(atob(stored.textContent), (c) => c.charCodeAt(0));
    // the core calls nothing of the system but, in vain, a message on standard error
    const wasi = new Proxy({}, { get: () => () => 0 });
    const { instance } = await WebAssembly.instantiate(bytes, { wasi_snapshot_preview1: wasi });
    const core = instance.exports;
    core._initialize();
    const memory = () => core.memory.buffer;
    const text = (at) => {
      const all = new Uint8Array(memory());
      let end = at;
      while (all[end] !== 0) {
        end++;
      }
      return new TextDecoder().decode(all.subarray(at, end));
    };
    const [inputs, columns] = text(core.explorer_names()).split('\n').map((line) => line.trim().split(' '));
    const params = inputs.indexOf('film_param');
    const events = ['pull-in', 'snap-back', 'loss of tension', 'breakdown'];
    const row = (at, offset) => {
      const values = new Float64Array(memory(), at + 8 * offset, columns.length);
      const point = {};
      columns.forEach((name, i) => { point[name] = values[i]; });
      point.stable = point.stable === 1;
      return point;
    };
    const law = (ofElectrode, name) => {
      const at = new Uint8Array(memory(), core.explorer_law(ofElectrode), 64);
      at.fill(0);
      at.set(new TextEncoder().encode(name).subarray(0, 63));
    };
    return {
      // device: inputs by name, film and electrode: { law, param }; null or what went wrong
      make(axisymmetric, device, film, electrode) {
        const values = new Float64Array(memory(), core.explorer_inputs(), params + 16);
        values.fill(0);
        for (const [name, value] of Object.entries(device)) {
          values[inputs.indexOf(name)] = value;
        }
        values.set(film.param, params);
        values.set(electrode?.param ?? [], params + 8);
        law(0, film.law);
        law(1, electrode?.law ?? '');
        return core.explorer_make(axisymmetric ? 1 : 0) === 0 ? null : text(core.explorer_message());
      },
      path(voltage, stretch) {
        const count = core.explorer_path(voltage, stretch);
        const at = core.explorer_points();
        const from = core.explorer_events();
        return {
          points: Array.from({ length: count }, (_, i) => row(at, i * columns.length)),
          events: Array.from({ length: core.explorer_event_count() }, (_, i) => ({
            kind: events[new Float64Array(memory(), from + 8 * i * (columns.length + 1), 1)[0]],
            point: row(from, i * (columns.length + 1) + 1),
          })),
        };
      },
      solve(voltage) {
        return core.explorer_solve(voltage) === 0 ? row(core.explorer_points(), 0) : null;
      },
    };
  };

  // Numbers of the device for a choice of the sliders: lengths given in the unstretched film move with it.
  const deviceOf = (base, chosen) => {
    const stretched = (length, m) => (length.unstretched ? chosen.pre_stretch : 1) * m;
    const electrode = stretched(base.electrode_radius, chosen.electrode_radius_m);
    const tip = base.fibres === 0 ? 0 : stretched(base.tip, base.tip.m);
    const ratio = electrode / chosen.frame_radius_m;
    const film = base.materials[chosen.material];
    return {
      film_thickness_unstretched_m: chosen.thickness_m,
      pre_stretch: chosen.pre_stretch,
      frame_radius_m: chosen.frame_radius_m,
      electrode_radius_m: electrode,
      coverage: { value: base.coverage, area: ratio * ratio, radius: ratio }[base.coverage_by],
      fibre_count: base.fibres,
      fibre_tip_radius_m: { length: chosen.frame_radius_m - tip, radius: tip, overlap: electrode - tip }[base.tip_by] ?? 0,
      electrode_thickness_m: base.electrode_thickness_m,
      permittivity: film.permittivity,
      permittivity_slope: film.permittivity_slope,
      breakdown_V_per_m: film.breakdown_V_per_m,
      breakdown_exponent: film.breakdown_exponent,
      breakdown_thickness_exponent: film.breakdown_thickness_exponent,
      breakdown_thickness_m: film.breakdown_thickness_m,
      breakdown_shape: film.breakdown_shape,
      breakdown_area_m2: film.breakdown_area_m2,
      fibre_angle_rad: film.fibre_angle_rad,
    };
  };
  const models = [{ name: 'lumped', c: 0 }, { name: 'axisymmetric', c: 1 }];

  // A stable and an unstable series, in that order along the path; where they meet both have the point.
  const split = (points, x, y, model) => [true, false].map((stable) => ({
    title: stable ? model.name : '', c: model.c, dashed: !stable,
    points: points.map((p, i) => [x(p), p.stable === stable || points[i - 1]?.stable === stable ? y(p) : NaN]),
  }));

  const dress = (section, number, core) => {
    const base = JSON.parse(section.querySelector('script.device').textContent);
    const host = section.querySelector('.explorer');
    const initial = {
      voltage_V: base.voltage_V, pre_stretch: base.pre_stretch, thickness_m: base.thickness_m,
      electrode_radius_m: base.electrode_radius.m, frame_radius_m: base.frame_radius_m, material: 0,
    };
    const chosen = { ...initial };
    section.querySelector('.still').hidden = true;
    host.hidden = false;
    const plots = ['strain', 'z', 'field'].map((name) => dea.element('div', { id: `explorer-${number}-${name}`, class: 'plot' }));
    const table = dea.element('div', { class: 'scroll', tabindex: '0', role: 'region', 'aria-label': 'Values at this voltage', 'aria-live': 'polite' });
    const problem = dea.element('p', { class: 'warning', hidden: '' });
    let pending = false;
    let operating = null;
    let first = null; // paths of the run's own design, for comparison

    const film = () => base.materials[chosen.material];
    const make = (i) => core.make(i === 1, deviceOf(base, chosen), film(), base.electrode_material);
    // Voltages to show: the run's range and some more, or to beyond breakdown where that is earlier known.
    const most = () => 1.25 * Math.max(base.voltage_V, chosen.voltage_V);
    const compute = () => models.map((model, i) => {
      const wrong = make(i);
      if (wrong !== null) {
        return { ...model, wrong };
      }
      const path = core.path(most(), 4 * chosen.pre_stretch);
      return { ...model, ...path, at: core.solve(chosen.voltage_V) };
    });
    const draw = () => {
      pending = false;
      const now = compute();
      first ??= now;
      const good = now.filter((m) => m.wrong === undefined);
      problem.hidden = good.length === now.length;
      problem.textContent = now.filter((m) => m.wrong !== undefined).map((m) => `${m.name}: ${m.wrong}`).join('; ');
      const V = (p) => p.voltage_V / 1e3;
      const kV = chosen.voltage_V / 1e3;
      const changed = Object.keys(initial).some((key) => key !== 'voltage_V' && chosen[key] !== initial[key]);
      const spec = (index, label, yl, y, only) => {
        const models = good.filter((m) => only === undefined || m.name === only);
        const series = models.flatMap((m) => split(m.points, V, y, m));
        if (changed) {
          first.filter((m) => m.points !== undefined && (only === undefined || m.name === only)).forEach((m, i) => series.unshift({
            title: i === 0 ? 'the run’s design' : '', c: 7, dashed: false, points: m.points.filter((p) => p.stable).map((p) => [V(p), y(p)]),
          }));
        }
        dea.plot(plots[index], {
          label, xl: 'Voltage V (kV)', yl, series, xRange: [0, most() / 1e3], cursor: kV, height: 260,
          at: models.filter((m) => m.at !== null && Number.isFinite(y(m.at))).map((m) => ({ y: y(m.at), c: m.c })),
        });
      };
      spec(0, 'Electrode strain against the voltage', 'Radial strain of the electrode (%)', (p) => 100 * (p.electrode_stretch - 1));
      if (base.fibres > 0) {
        spec(1, 'Displacement of the fibre tip against the voltage, an upper bound', 'z of the fibre tip, lumped (mm)', (p) => 1e3 * p.fibre_tip_z_m, 'lumped');
      } else {
        spec(1, 'Smallest tension against the voltage', 'Smallest tension (N/m)', (p) => p.min_tension_N_per_m);
      }
      spec(2, 'True field against the voltage', 'True field (V/µm)', (p) => 1e-6 * p.true_field_V_per_m);
      fill(good, kV);
      operating?.follow();
    };
    const event = (m, kind) => m.events.find((e) => e.kind === kind)?.point.voltage_V / 1e3;
    const fill = (good, kV) => {
      const rows = [
        ['electrode strain (%)', (m) => 100 * (m.at?.electrode_stretch - 1)],
        ['fibre tip z (µm)', (m) => 1e6 * m.at?.fibre_tip_z_m],
        ['force, largest of the load line (mN)', (m) => 1e3 * m.at?.force_N],
        ['true field (V/µm)', (m) => 1e-6 * m.at?.true_field_V_per_m],
        ['breakdown margin (%)', (m) => 100 * m.at?.breakdown_margin],
        ['smallest tension (N/m)', (m) => m.at?.min_tension_N_per_m],
        ['capacitance (pF)', (m) => 1e12 * m.at?.capacitance_F],
        ['loss of tension at (kV)', (m) => event(m, 'loss of tension')],
        ['breakdown at (kV)', (m) => event(m, 'breakdown')],
        ['pull-in at (kV)', (m) => event(m, 'pull-in')],
      ];
      const head = dea.element('tr', {}, dea.element('th', { scope: 'col' }, `At ${dea.number(kV, 3)} kV`), ...good.map((m) => dea.element('th', { scope: 'col', class: 'n' }, m.name)));
      const body = rows.filter(([, value]) => good.some((m) => Number.isFinite(value(m)))).map(([label, value]) => dea.element('tr', {},
        dea.element('th', { scope: 'row' }, label), ...good.map((m) => dea.element('td', { class: 'n' }, dea.number(value(m), 5)))));
      const lost = good.filter((m) => m.at === null).map((m) => m.name);
      table.replaceChildren(dea.element('table', {}, dea.element('thead', {}, head), dea.element('tbody', {}, ...body)));
      if (lost.length > 0) {
        table.append(dea.element('p', { class: 'warning' }, `No stable equilibrium at this voltage: ${lost.join(', ')}.`));
      }
    };
    const later = () => {
      if (!pending) {
        pending = true;
        requestAnimationFrame(draw);
      }
    };
    const sliders = {};
    const axes = [];
    const add = (key, label, low, high, factor, unit) => {
      axes.push({ key, label: unit === '' ? label : `${label} (${unit})`, low, high, factor });
      const step = (high - low) / 400;
      sliders[key] = dea.slider(label, factor * low, factor * high, 'any', factor * chosen[key], () => `${dea.number(factor * chosen[key], 4)} ${unit}`, (value) => {
        const near = Math.abs(value / factor - initial[key]) < step ? initial[key] : value / factor; // the run's value attracts
        chosen[key] = near === initial[key] ? near : Number(near.toPrecision(4));
        later();
        if (key === 'voltage_V') {
          dea.setVoltage(chosen.voltage_V / 1e3, host);
        }
      });
      return sliders[key].node;
    };
    const film_state = base.electrode_radius.unstretched ? 'unstretched' : 'stretched';
    const material = dea.choice('Film', base.materials.map((m) => m.label), (i) => {
      chosen.material = i;
      later();
    });
    const reset = dea.element('button', { type: 'button' }, 'Back to the run’s design');
    reset.addEventListener('click', () => {
      Object.assign(chosen, initial);
      for (const { key, factor } of axes) {
        sliders[key].set(factor * chosen[key]);
      }
      material.select.value = chosen.material;
      later();
    });
    host.append(
      dea.element('div', { class: 'controls' },
        add('voltage_V', 'Voltage', 0, 1.5 * base.voltage_V, 1e-3, 'kV'),
        add('pre_stretch', 'Pre-stretch', 1, Math.max(3, 1.5 * base.pre_stretch), 1, ''),
        add('thickness_m', 'Thickness, unstretched', 0.25 * base.thickness_m, 4 * base.thickness_m, 1e6, 'µm'),
        add('electrode_radius_m', `Electrode radius, ${film_state}`, 0.2 * base.electrode_radius.m, Math.min(3 * base.electrode_radius.m, base.frame_radius_m), 1e3, 'mm'),
        add('frame_radius_m', 'Frame radius', 0.4 * base.frame_radius_m, 2 * base.frame_radius_m, 1e3, 'mm'),
        material.node, dea.element('div', { class: 'buttons' }, reset)),
      problem, dea.element('div', { class: 'plots' }, ...plots, table));
    const more = dea.element('details', {}, dea.element('summary', {}, 'Operating map of any two of these'));
    const map = dea.element('div', { id: `explorer-${number}-map`, class: 'map' });
    // A point of a model for other values than those of the sliders; null: there is none.
    const solve = (values, model = 0) => {
      const kept = { ...chosen };
      Object.assign(chosen, values);
      const point = make(model) === null ? core.solve(chosen.voltage_V) : null;
      Object.assign(chosen, kept);
      return point;
    };
    more.append(map);
    host.append(more);
    operating = dea.map(map, { axes, solve, now: () => chosen, lift: base.fibres > 0 });
    more.addEventListener('toggle', () => more.open && operating.compute());
    draw();
    dea.onVoltage(host, (kV) => {
      chosen.voltage_V = 1e3 * kV;
      sliders.voltage_V.set(kV);
      later();
    });
    dea.explorers = [...(dea.explorers ?? []), {
      map: operating.compute,
      // A point of a model for other values than the run's, in SI: for tests and the console.
      solve: (model, values) => solve({ ...initial, ...values }, model === 'axisymmetric' ? 1 : 0),
    }];
  };

  dea.waits.push(start().then((core) => {
    document.querySelectorAll('section:has(script.device)').forEach((section, i) => dress(section, i + 1, core));
  }).catch((error) => {
    document.querySelectorAll('section:has(script.device) .still').forEach((still) => {
      still.textContent = `The explorer does not work in this browser: ${error.message}`;
    });
  }));
  dea.ready = Promise.all(dea.waits);
})();
