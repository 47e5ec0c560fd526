// The page of dea studio: a design as text and as values, its drawing, its runs. All that it does is a file in the folder
// or a command that it shows.
(() => {
  const $ = (id) => document.getElementById(id);
  if ($('desk') === null) {
    return;
  }
  const wait = (ms) => new Promise((done) => { setTimeout(done, ms); });
  const stem = (name) => name.replace(/^.*\//, '').replace(/\.[^.]*$/, '');
  const query = (values) => Object.entries(values).flatMap(([key, value]) => [].concat(value).map((one) => `${key}=${encodeURIComponent(one)}`)).join('&');
  const address = (path, values = {}) => `${path}?${query(values)}`;
  // { status, json or text }
  const call = async (method, path, values, body) => {
    const answer = await fetch(address(path, values), { method, body });
    const text = await answer.text();
    const json = (answer.headers.get('Content-Type') ?? '').startsWith('application/json') ? JSON.parse(text) : null;
    return { status: answer.status, text, json };
  };
  const tell = (text) => { $('saved').textContent = text; };
  const command = (text) => { $('command').textContent = text; };

  // The editor ---------------------------------------------------------------------------------------

  // What to replace of one text to make the other of it: from, to, by.
  const between = (a, b) => {
    let [from, back] = [0, 0];
    while (from < a.length && a[from] === b[from]) {
      from++;
    }
    while (back < Math.min(a.length, b.length) - from && a[a.length - 1 - back] === b[b.length - 1 - back]) {
      back++;
    }
    return [from, a.length - back, b.slice(from, b.length - back)];
  };
  const editor = (() => {
    const host = $('editor');
    const mirror = window.CodeMirror(host, {
      mode: 'yaml', lineNumbers: true, lineWrapping: false, indentUnit: 2, inputStyle: 'contenteditable',
      extraKeys: { Tab: false, 'Shift-Tab': false, 'Ctrl-Space': 'autocomplete', 'Ctrl-/': 'toggleComment' }, // Tab leaves
      hintOptions: { hint: (cm) => complete(cm), completeSingle: false },
    });
    mirror.getInputField().setAttribute('aria-label', 'Design');
    mirror.on('change', (_, change) => { if (change.origin !== 'setValue') { later(); } });
    mirror.on('inputRead', (_, change) => {
      if (/^[A-Za-z_]$/.test(change.text[0]) && !mirror.state.completionActive) {
        mirror.showHint();
      }
    });
    return {
      get: () => mirror.getValue(),
      read: (text) => { mirror.setValue(text); mirror.clearHistory(); },
      set: (text) => {
        const [from, to, by] = between(mirror.getValue(), text);
        mirror.replaceRange(by, mirror.posFromIndex(from), mirror.posFromIndex(to), '*read');
      },
      replace: (text, line, from, to) => mirror.replaceRange(text, { line, ch: from }, { line, ch: to }, '*form'),
      go: (line, column) => { mirror.focus(); mirror.setCursor(line, column); },
      mark: (findings) => {
        mirror.getAllMarks().forEach((one) => one.clear());
        for (const one of findings.filter((finding) => finding.line > 0 && finding.line <= mirror.lineCount())) {
          const line = one.line - 1;
          const end = scalarEnd(mirror.getLine(line), one.column - 1);
          mirror.markText({ line, ch: one.column - 1 }, { line, ch: Math.max(end, one.column) }, { className: `finding-${one.severity}`, attributes: { title: one.text } });
        }
      },
      refresh: () => mirror.refresh(),
    };
  })();

  // Places in the text ------------------------------------------------------------------------------

  // Where the value that begins at a column of a line ends.
  const scalarEnd = (line, from) => {
    const first = line[from];
    if (first === '"' || first === "'") {
      const end = line.indexOf(first, from + 1);
      return end < 0 ? line.length : end + 1;
    }
    const flow = (line.slice(0, from).match(/[[{]/g) ?? []).length > (line.slice(0, from).match(/[\]}]/g) ?? []).length;
    let depth = 0;
    let end = from;
    for (; end < line.length; end++) {
      const c = line[end];
      if (c === '#' && /\s/.test(line[end - 1] ?? ' ')) {
        break;
      }
      if ('[{'.includes(c)) {
        depth++;
      } else if (']}'.includes(c)) {
        if (depth === 0 && flow) {
          break;
        }
        depth--;
      } else if (c === ',' && depth === 0 && flow) {
        break;
      }
    }
    return from + line.slice(from, end).trimEnd().length;
  };
  const lineOf = (number) => editor.get().split('\n')[number] ?? '';
  const place = (value) => {
    const line = value.line - 1;
    const from = value.column - 1;
    return { line, from, to: scalarEnd(lineOf(line), from) };
  };
  const plain = (text) => text.replace(/^(["'])(.*)\1$/, '$2');

  // The schema: what keys there are, and what they mean ----------------------------------------------

  let schema = null; // of the file that is open
  const schemas = new Map();
  const readSchema = async () => {
    const { name, kind } = open;
    const text = editor.get();
    const fit = ['design', 'breakdown', 'life'].find((key) => new RegExp(`^${key}:`, 'm').test(text));
    const of = kind === 'fit' ? (fit === undefined ? 'fit' : `fit-${fit.replace('design', 'device')}`) : kind === 'sweep' || kind === 'optimise' ? 'explore' : '';
    if (!schemas.has(of)) {
      schemas.set(of, call('GET', 'schema', of !== '' ? { of } : {}));
    }
    const { json } = await schemas.get(of);
    if (name === open.name) {
      schema = json.schema ?? null;
      if (open.values.length > 0) {
        $('form').dataset.keys = '';
        showValues();
      }
    }
  };
  const flatten = (node) => {
    if (node === undefined || node === null || schema === null) {
      return [];
    }
    if (node.$ref !== undefined) {
      return flatten(schema.$defs[node.$ref.replace('#/$defs/', '')]);
    }
    return [node, ...['oneOf', 'anyOf', 'allOf'].flatMap((how) => (node[how] ?? []).flatMap(flatten))];
  };
  const root = () => (open.kind !== 'design' ? schema : /^plies:/m.test(editor.get()) ? schema?.then : schema?.else);
  const at = (path) => path.reduce((nodes, key) => nodes.flatMap((node) => (key === '[]'
    ? flatten(node.items) : flatten(node.properties?.[key]))), flatten(root()));
  const describe = (path) => at(path).map((node) => node.description).find((text) => text !== undefined) ?? '';
  const words = (path) => [...new Set(at(path).flatMap((node) => node.enum ?? (node.const !== undefined ? [node.const] : [])))].map(String);
  const parts = (key) => key.replace(/\[\d+\]/g, '.[]').split('.');

  // Path of the section around a place, by indentation and by braces on its line.
  const around = (lines, number, column) => {
    const path = [];
    let indent = Infinity;
    const before = lines[number].slice(0, column);
    const own = /^(\s*)((?:- )*)/.exec(before);
    let inner = before.slice(own[0].length);
    const opened = [];
    for (let i = 0; i < inner.length; i++) {
      if ('{['.includes(inner[i])) {
        opened.push(i);
      } else if ('}]'.includes(inner[i])) {
        opened.pop();
      }
    }
    for (const i of opened.reverse()) {
      const key = /([\w-]+):\s*$/.exec(inner.slice(0, i));
      if (inner[i] === '[') {
        path.unshift('[]');
      }
      if (key !== null) {
        path.unshift(key[1]);
      }
    }
    indent = own[1].length;
    if (own[2] !== '') {
      path.unshift('[]');
      indent += 1; // a list may stand as far left as its key
    }
    for (let i = number - 1; i >= 0 && indent > 0; i--) {
      const found = /^(\s*)((?:- )?)([\w-]+):\s*(#.*)?$/.exec(lines[i]);
      const item = /^(\s*)- /.exec(lines[i]);
      if (found !== null && found[1].length + found[2].length < indent) {
        path.unshift(found[3]);
        indent = found[1].length + found[2].length;
      }
      if (item !== null && item[1].length < indent) {
        path.unshift('[]');
        indent = item[1].length + 1;
      }
    }
    return path;
  };
  const complete = (cm) => {
    const cursor = cm.getCursor();
    const line = cm.getLine(cursor.line);
    const before = line.slice(0, cursor.ch);
    if (/#/.test(before) || schema === null) {
      return null;
    }
    const typed = /[\w-]*$/.exec(before)[0];
    const path = around(cm.getValue().split('\n'), cursor.line, cursor.ch);
    const value = /([\w-]+):\s*\[?[^,{}]*$/.exec(before);
    const asked = value !== null && /:\s/.test(before.slice(value.index));
    let list;
    if (asked) {
      const own = [...(path.at(-1) === '[]' && before.includes('[') ? path.slice(0, -2) : path), value[1]];
      list = [...words(own), ...words([...own, '[]'])].map((text) => ({ text, note: '' }));
    } else {
      const keys = Object.assign({}, ...at(path).map((node) => node.properties ?? {}).reverse());
      list = Object.keys(keys).map((key) => ({ text: `${key}: `, shown: key, note: describe([...path, key]) }));
    }
    list = list.filter((one) => (one.shown ?? one.text).startsWith(typed) && one.text !== typed);
    return {
      from: { line: cursor.line, ch: cursor.ch - typed.length }, to: cursor,
      list: list.map((one) => ({
        text: one.text,
        render: (node) => node.append(dea.element('b', {}, one.shown ?? one.text), ' ', dea.element('small', {}, one.note)),
      })),
    };
  };

  // One file: saved as it is typed, checked, drawn ---------------------------------------------------

  let state = { designs: [], runs: [], tables: [], folders: [], jobs: [] };
  const open = { name: '', version: '', saved: '', stamp: '', kind: 'design', busy: null, again: false, asked: false, values: [] };

  const freeName = (name) => {
    const taken = new Set(state.designs.map((one) => one.name));
    let to = name;
    for (let n = 2; taken.has(to); n++) {
      to = `${stem(name)}-${n}.yaml`;
    }
    return to;
  };
  const kindOf = (text) => (/^dea_fit:/m.test(text) ? 'fit' : /^dea_explore:/m.test(text)
    ? (/^objectives?:/m.test(text) ? 'optimise' : 'sweep') : /^dea:/m.test(text) ? 'design' : 'other');

  // Lines that differ, by the longest common ones: [{ from, to, lines }], from and to in the first list.
  const changes = (a, b) => {
    const common = Array.from({ length: a.length + 1 }, () => new Uint32Array(b.length + 1));
    for (let i = a.length - 1; i >= 0; i--) {
      for (let j = b.length - 1; j >= 0; j--) {
        common[i][j] = a[i] === b[j] ? common[i + 1][j + 1] + 1 : Math.max(common[i + 1][j], common[i][j + 1]);
      }
    }
    const list = [];
    for (let [i, j] = [0, 0]; i < a.length || j < b.length; i++, j++) {
      const [from, start] = [i, j];
      while (a[i] !== b[j]) {
        if (j === b.length || (i < a.length && common[i + 1][j] >= common[i][j + 1])) {
          i++;
        } else {
          j++;
        }
      }
      if (i > from || j > start) {
        list.push({ from, to: i, lines: b.slice(start, j) });
      }
    }
    return list;
  };
  // Both changes of a text; null: they touch each other.
  const merge = (base, mine, theirs) => {
    const lines = base.split('\n');
    const lists = [mine, theirs].map((text) => text.split('\n'));
    if (lists.some((list) => list.length * lines.length > 4e6)) {
      return null;
    }
    const all = lists.flatMap((list) => changes(lines, list)).sort((a, b) => a.from - b.from || a.to - b.to)
      .filter((one, i, list) => JSON.stringify(one) !== JSON.stringify(list[i - 1])); // the same in both
    if (all.some((one, i) => i > 0 && one.from <= all[i - 1].to)) {
      return null;
    }
    all.reverse().forEach((one) => lines.splice(one.from, one.to - one.from, ...one.lines));
    return lines.join('\n');
  };
  const unix = (text) => text.replace(/\r\n?/g, '\n'); // as the editor has it

  // What another program has written: with what was changed here where that is elsewhere in the text, else asked.
  const meet = (theirs) => {
    const both = theirs.text !== undefined ? merge(open.saved, editor.get(), unix(theirs.text)) : null;
    if (both === null) {
      askWhich(theirs);
      tell('not saved');
      return;
    }
    tell(editor.get() === open.saved ? 'read again: another program has changed it' : 'merged with what another program has changed');
    open.version = theirs.version;
    open.saved = unix(theirs.text);
    editor.set(both);
    touch();
  };
  const askWhich = (theirs) => {
    open.asked = true;
    $('asked-text').textContent = `${open.name} was changed by another program while you changed it here.`;
    $('asked-mine').textContent = 'Keep what is here';
    $('asked-theirs').textContent = 'Take what the file says';
    $('asked-other').textContent = theirs.text ?? '';
    $('asked').hidden = false;
    $('asked-mine').onclick = () => {
      open.version = theirs.version;
      open.asked = false;
      $('asked').hidden = true;
      touch();
    };
    $('asked-theirs').onclick = () => {
      open.version = theirs.version;
      open.saved = unix(theirs.text ?? '');
      open.asked = false;
      $('asked').hidden = true;
      editor.set(open.saved); // which can be undone
    };
  };

  const save = async () => {
    const text = editor.get();
    if (text === open.saved || open.asked || open.name === '') {
      return;
    }
    tell('saving');
    const name = open.name;
    const answer = await call('PUT', 'design', { name, version: open.version }, text);
    if (name !== open.name) {
      return;
    }
    if (answer.json?.changed) {
      meet(answer.json);
    } else if (answer.json?.version !== undefined) {
      open.version = answer.json.version;
      open.saved = text;
      tell('saved');
    } else {
      tell(`not saved: ${answer.json?.error ?? answer.status}`);
    }
  };

  const showFindings = (findings) => {
    $('findings').replaceChildren(...findings.map((one) => {
      const go = () => { if (one.line > 0) { editor.go(one.line - 1, Math.max(0, one.column - 1)); } };
      return dea.element('li', { class: `is-${one.severity}` }, dea.button(`${one.line > 0 ? `${one.line}:${one.column} ` : ''}${one.text}`, go));
    }));
    editor.mark(findings);
  };

  const check = async () => {
    const began = performance.now();
    const { name } = open;
    const { json } = await call('GET', 'check', { name });
    if (name !== open.name) {
      return;
    }
    const answer = json.check;
    command(json.command);
    if (answer === undefined) {
      showFindings([{ severity: 'error', text: json.error ?? '', line: 0, column: 0 }]);
      return;
    }
    showFindings(answer.findings);
    $('picture').classList.toggle('stale', !answer.good);
    if (json.svg !== undefined) {
      $('picture').innerHTML = json.svg; // of this program, which writes texts as texts
      $('drawn').textContent = `in ${Math.round(performance.now() - began)} ms`;
    }
    if (answer.values !== undefined) {
      open.values = answer.values;
      showValues();
    }
    if (answer.good) {
      showMesh();
    }
  };

  // The mesh of model 3d from above, while its panel is open: edges of elements by their corners.
  const edges = { 3: [[0, 1, 2, 3]], 10: [[0, 1, 2, 3]], 5: [[0, 1, 2, 3], [4, 5, 6, 7]], 12: [[0, 1, 2, 3], [4, 5, 6, 7]] }; // by kinds of Gmsh
  const drawMesh = (text) => {
    const part = (name) => text.slice(text.indexOf(`$${name}\n`), text.indexOf(`$End${name}`)).split('\n').slice(2, -1).map((line) => line.split(' ').map(Number));
    const nodes = new Map(part('Nodes').map(([number, x, y]) => [number, [1e3 * x, -1e3 * y]]));
    const lines = new Set();
    for (const [, kind, tags, ...rest] of part('Elements')) {
      const corners = rest.slice(tags).map((number) => nodes.get(number).map((one) => one.toFixed(3)).join(' '));
      for (const face of edges[kind] ?? []) {
        face.forEach((corner, i) => lines.add([corners[corner], corners[face[(i + 1) % 4]]].sort().join('L')));
      }
    }
    const all = [...nodes.values()];
    const [left, top, right, bottom] = [0, 1].map((k) => all.reduce((low, one) => Math.min(low, one[k]), Infinity)).concat([0, 1].map((k) => all.reduce((high, one) => Math.max(high, one[k]), -Infinity)));
    return dea.svg('svg', { viewBox: `${left} ${top} ${right - left} ${bottom - top}`, role: 'img', 'aria-label': 'Mesh from above' },
      dea.svg('path', { d: [...lines].map((line) => `M${line}`).join(''), fill: 'none', stroke: 'currentColor', 'vector-effect': 'non-scaling-stroke' }));
  };
  let meshOf = '';
  const showMesh = async () => {
    const { name, version } = open;
    if (!$('mesh').open || meshOf === `${name} ${version}`) {
      return;
    }
    meshOf = `${name} ${version}`;
    const { json } = await call('GET', 'mesh', { name });
    const { mesh, msh } = json ?? {};
    $('mesh').lastElementChild.replaceChildren(...(msh !== undefined && mesh !== undefined
      ? [dea.element('p', { class: 'still' }, `${mesh.elements} elements, ${mesh.unknowns} unknowns, from above`), drawMesh(msh)]
      : [dea.element('p', { class: 'still' }, json?.error ?? 'too large to be drawn')]));
    command(json?.command ?? '');
  };
  $('mesh').addEventListener('toggle', showMesh);

  // Whatever has changed: saves and checks, one after the other.
  const touch = async () => {
    if (open.busy !== null) {
      open.again = true;
      return open.busy;
    }
    open.busy = (async () => {
      do {
        open.again = false;
        try {
          await save();
          if (open.kind === 'design' && open.name !== '') {
            await check();
          }
        } catch (error) {
          tell(`not saved: ${error.message}`);
        }
      } while (open.again);
    })();
    await open.busy;
    open.busy = null;
    look();
    return null;
  };
  let soon = 0;
  const later = () => {
    clearTimeout(soon);
    soon = setTimeout(touch, 15);
  };

  // Values: a field for each that the file gives -----------------------------------------------------

  const hidden = /(^dea|^compute\.models\[\d+\]|\.(name|kind|shape|ply|body|channel|side|edge|within)|\.of\[\d+\]|\.free\[\d+\])$/;
  const edit = (value, text) => {
    const spot = place(value);
    const line = lineOf(spot.line);
    if (line.slice(spot.from, spot.to) !== text) {
      editor.replace(text, spot.line, spot.from, spot.to);
    }
  };
  // A number goes one step up or down in its second digit.
  const stepped = (text, way) => {
    const found = /^([+-]?[\d.]+)(.*)$/.exec(text);
    if (found === null || !Number.isFinite(Number(found[1]))) {
      return null;
    }
    const number = Number(found[1]);
    const step = number === 0 ? 1 : 10 ** (Math.floor(Math.log10(Math.abs(number))) - 1);
    return `${Number((number + way * step).toPrecision(6))}${found[2]}`;
  };
  const field = (value) => {
    const path = parts(value.key);
    const known = words(path);
    const input = dea.element('input', { type: 'text', value: value.text, 'data-key': value.key, title: describe(path), ...(known.length > 0 ? { list: `words-${value.key}` } : {}) });
    const here = () => open.values.find((one) => one.key === value.key && one.origin === 'given');
    input.addEventListener('input', async () => {
      const text = input.value.trim();
      await open.busy; // the place is that of the text as it was checked
      const now = here();
      if (now !== undefined && text !== '') {
        edit(now, text);
      }
    });
    input.addEventListener('keydown', (event) => {
      const way = { ArrowUp: 1, ArrowDown: -1 }[event.key];
      const next = way !== undefined && known.length === 0 ? stepped(input.value, way) : null;
      if (next !== null) {
        event.preventDefault();
        input.value = next;
        input.dispatchEvent(new Event('input'));
      }
    });
    const name = value.key.includes('.') ? value.key.slice(value.key.indexOf('.') + 1) : value.key;
    return dea.element('label', {}, dea.element('span', { title: describe(path) }, name), input,
      ...(known.length > 0 ? [dea.element('datalist', { id: `words-${value.key}` }, ...known.map((word) => dea.element('option', { value: word })))] : []));
  };
  // A part is named by its own name where it has one: "plies film".
  const partName = (part) => {
    const named = open.values.find((value) => value.key === `${part}.name` && value.origin === 'given');
    return named !== undefined ? `${part.replace(/\[\d+\]/, '')} ${named.text}` : part;
  };
  const showValues = () => {
    const given = open.values.filter((value) => value.origin === 'given' && !hidden.test(value.key)).sort((a, b) => a.line - b.line || a.column - b.column);
    const keys = given.map((value) => value.key).join('\n');
    if (keys === $('form').dataset.keys) { // the same fields: what is typed in one stays
      for (const value of given) {
        const input = $('form').querySelector(`[data-key="${CSS.escape(value.key)}"]`);
        if (input !== document.activeElement && input.value !== value.text) {
          input.value = value.text;
        }
      }
    } else {
      const groups = new Map();
      for (const value of given) {
        const part = value.key.includes('.') ? value.key.slice(0, value.key.indexOf('.')) : '';
        groups.set(part, [...(groups.get(part) ?? []), field(value)]);
      }
      const focus = document.activeElement?.dataset?.key;
      const typed = document.activeElement?.value;
      $('form').replaceChildren(...[...groups].map(([part, fields]) => dea.element('fieldset', {}, dea.element('legend', {}, part === '' ? 'design' : partName(part)), ...fields)));
      $('form').dataset.keys = keys;
      const again = focus !== undefined ? $('form').querySelector(`[data-key="${CSS.escape(focus)}"]`) : null;
      if (again !== null) {
        again.value = typed;
        again.focus();
      }
    }
    const absent = open.values.filter((value) => value.origin === 'default' || value.origin === 'absent');
    const sibling = (value) => open.values.findLast((one) => one.origin === 'given' && value.key.includes('.') && one.key.replace(/\.[^.]*$/, '') === value.key.replace(/\.[^.]*$/, ''));
    $('add').replaceChildren(dea.element('option', { value: '' }, ''), ...absent.filter((value) => sibling(value) !== undefined)
      .map((value) => dea.element('option', { value: value.key, title: describe(parts(value.key)) }, `${value.key} (${value.text})`)));
    $('add').onchange = () => {
      const value = absent.find((one) => one.key === $('add').value);
      if (value !== undefined) {
        addKey(value, sibling(value));
      }
    };
    showModels();
    fillStudy();
  };
  // A key goes after one of its section, the way that stands there.
  const addKey = (value, beside) => {
    const spot = place(beside);
    const line = lineOf(spot.line);
    const key = value.key.replace(/^.*\./, '');
    const text = value.origin === 'default' ? value.text : '';
    const flow = (line.slice(0, spot.from).match(/{/g) ?? []).length > (line.slice(0, spot.from).match(/}/g) ?? []).length;
    if (flow) {
      editor.replace(`, ${key}: ${text}`, spot.line, spot.to, spot.to);
    } else {
      const indent = /^\s*(- )?/.exec(line)[0].replace('-', ' ');
      editor.replace(`\n${indent}${key}: ${text}`, spot.line, line.length, line.length);
    }
    editor.go(spot.line + (flow ? 0 : 1), flow ? spot.to + key.length + 4 : lineOf(spot.line + 1).length);
  };
  $('form').addEventListener('submit', (event) => event.preventDefault());

  const models = ['lumped', 'axisymmetric', '3d', 'reduced'];
  const showModels = () => {
    const given = open.values.filter((value) => /^compute\.models\[/.test(value.key) && value.origin === 'given').map((value) => value.text);
    const any = open.values.some((value) => value.key.startsWith('plies['));
    if ($('models').dataset.for === `${open.name} ${given}`) {
      return;
    }
    $('models').dataset.for = `${open.name} ${given}`;
    $('models').replaceChildren(dea.element('legend', {}, 'Models'), ...models.filter((name) => !any || name === '3d' || name === 'reduced').map((name) => {
      const box = dea.element('input', { type: 'checkbox', value: name });
      box.checked = given.includes(name) || (given.length === 0 && name === '3d');
      box.dataset.given = box.checked ? '1' : '';
      return dea.element('label', {}, box, name);
    }));
  };

  // Runs ---------------------------------------------------------------------------------------------

  const chosen = new Set();
  let curvesOf = '';

  const run = async (beside) => {
    await touch();
    const { name, kind } = open;
    const own = `${stem(name)}.${kind === 'design' ? 'run' : kind}`;
    let output = own;
    const there = new Set([...state.runs.map((one) => one.name), ...state.folders]);
    for (let n = 2; beside && there.has(output); n++) {
      output = own.replace(/\.(\w+)$/, `-${n}.$1`);
    }
    const boxes = [...$('models').querySelectorAll('input')];
    const other = boxes.some((box) => box.checked !== (box.dataset.given === '1')); // than the design says
    const job = { action: kind === 'design' ? 'run' : kind, file: name, output, models: kind === 'design' && other ? boxes.filter((box) => box.checked).map((box) => box.value) : [] };
    await start(job);
  };
  const start = async (job) => {
    const answer = await call('POST', 'job', {}, JSON.stringify(job));
    if (answer.json?.id === undefined) {
      tell(answer.json?.error ?? `refused: ${answer.status}`);
      return;
    }
    if (job.action === 'run') {
      if (!job.resume && chosen.size > 0 && !$('shown').dataset.many) {
        chosen.clear();
      }
      chosen.add(job.output);
    }
    waiting.set(answer.json.id, job);
  };
  const waiting = new Map(); // jobs of this page that are not over

  const showFolder = async (name) => {
    const { json } = await call('GET', 'list', { name });
    if (!Array.isArray(json)) {
      return;
    }
    $('folder-view').hidden = false;
    $('folder-title').textContent = name;
    const href = (file) => address('file', { name: `${name}/${file}` });
    const own = (file) => dea.button('Open a copy', () => adopt(name, file));
    const links = json.map((file) => dea.element('li', {}, ...(file.endsWith('.yaml') && /\.(optimise|fit)$/.test(name) ? [own(file), ' '] : []), dea.element('a', { href: href(file), target: '_blank', rel: 'noopener', ...(/\.(svg|html|csv|yaml|json|png)$/.test(file) ? {} : { download: file }) }, file)));
    const pictures = json.filter((file) => file.endsWith('.svg')).map((file) => dea.element('img', { src: href(file), alt: file, loading: 'lazy' }));
    const cases = json.includes('cases.csv') ? [casesTable((await call('GET', 'file', { name: `${name}/cases.csv` })).text)] : [];
    $('files').replaceChildren(...cases, dea.element('ul', {}, ...links), ...pictures);
  };
  // The designs of a sweep or a search; the last of many.
  const casesTable = (text) => {
    const [head, ...rows] = text.trim().split('\n').map((line) => line.split(','));
    const kept = head.flatMap((title, i) => (/^(id|time)\b/.test(title) ? [] : [i]));
    const cell = (tag, row, i) => dea.element(tag, i < head.length - 2 ? { class: 'n' } : {}, tag === 'th' || row[i] === '' || !Number.isFinite(Number(row[i])) ? row[i] ?? '' : dea.number(Number(row[i])));
    const line = (tag) => (row) => dea.element('tr', {}, ...kept.map((i) => cell(tag, row, i)));
    return dea.element('div', { class: 'scroll', tabindex: '0' }, dea.element('table', {}, dea.element('thead', {}, line('th')(head)), dea.element('tbody', {}, ...rows.slice(-50).map(line('td')))));
  };
  // A design that a search or a fit has written, as one of this folder.
  const adopt = async (folder, file) => {
    const { text } = await call('GET', 'file', { name: `${folder}/${file}` });
    const to = freeName(`${stem(folder)}-${stem(file)}.yaml`);
    const { json } = kindOf(text) === 'design' ? await call('PUT', 'design', { name: to, version: '' }, text) : { json: { error: `${file} is no design` } };
    command(`cp ${folder}/${file} ${to}`);
    if (json?.version !== undefined && !json.changed) {
      window.location.hash = encodeURIComponent(to);
    } else {
      tell(json?.error ?? `${to} is there`);
    }
  };
  const showReport = (name) => {
    $('folder-view').hidden = false;
    $('folder-title').textContent = `Report of ${name}`;
    $('files').replaceChildren(dea.element('iframe', { src: address('file', { name: `${name}/report.html` }), title: `Report of ${name}`, sandbox: 'allow-scripts' }));
    $('folder-view').scrollIntoView();
  };

  // Whether a run has more to compute: it was killed before it could say how it ended, or interrupted.
  const ends = new Map();
  const unfinished = (one) => {
    const part = state.runs.find((other) => other.name === `${one?.name}.part`);
    if (one === undefined || part !== undefined || one.state === '' || one.summary === '') {
      return (part ?? one ?? { state: '' }).state !== '';
    }
    const key = `${one.name} ${one.summary}`;
    if (!ends.has(key)) {
      ends.set(key, false);
      call('GET', 'file', { name: `${one.name}/summary.json` }).then(({ json }) => {
        ends.set(key, [json, ...(json?.more_models ?? [])].some((model) => model?.status === 'DEA_E_INTERRUPTED'));
        showRuns();
        showJobs();
      });
    }
    return ends.get(key);
  };
  const goesOn = (job) => unfinished(state.runs.find((one) => one.name === job.output));

  const jobRow = (job, newest) => {
    const going = job.state === 'running' || job.state === 'waiting';
    const count = /(\d+)\/(\d+)/.exec(job.progress);
    const head = dea.element('span', { class: 'head' }, dea.element('b', {}, job.output), ` ${job.action}: ${job.state}${going && job.progress ? `, ${job.progress}` : ''}`);
    const row = dea.element('li', { 'data-id': job.id }, head);
    const button = (text, act) => head.append(dea.button(text, act));
    if (going) {
      button('Stop', () => call('POST', 'stop', {}, JSON.stringify({ id: job.id })));
      row.append(dea.element('progress', { 'aria-label': job.output, ...(count !== null && Number(count[2]) > 0 ? { value: count[1], max: count[2] } : {}) }));
    } else if (job.action === 'run' && job.state !== 'done') {
      if (goesOn(job)) {
        button('Go on', () => start({ action: 'run', file: job.subject, output: job.output, resume: true }));
      }
      button('Start anew', () => start({ action: 'run', file: job.subject, output: job.output, force: true }));
    } else if (!going && !['run', 'report'].includes(job.action)) {
      button('Files', () => showFolder(job.output));
    }
    const asked = newest && ['fit', 'sweep', 'optimise'].includes(job.action) && job.state === 'done'; // what it says is its result
    row.append(dea.element('details', job.state === 'failed' || asked ? { open: '' } : {}, dea.element('summary', {}, dea.element('span', { class: 'code' }, job.command)), dea.element('pre', { tabindex: '0' }, job.said)));
    return row;
  };
  const showJobs = () => {
    const opened = new Set([...$('jobs').querySelectorAll('li')].filter((row) => row.querySelector('details').open).map((row) => row.dataset.id));
    const focus = document.activeElement?.closest?.('#jobs li')?.dataset.id;
    const jobs = state.jobs.slice(-6).reverse();
    const text = JSON.stringify([jobs, jobs.map(goesOn)]);
    if ($('jobs').dataset.last !== text) {
      $('jobs').dataset.last = text;
      $('jobs').replaceChildren(...jobs.map((job, i) => {
        const row = jobRow(job, i === 0);
        row.querySelector('details').open ||= opened.has(String(job.id));
        return row;
      }));
      if (focus !== undefined) {
        $('jobs').querySelector(`li[data-id="${focus}"] button`)?.focus();
      }
    }
    for (const job of state.jobs) {
      if (waiting.has(job.id)) {
        command(job.command);
        if (job.state !== 'waiting' && job.state !== 'running') {
          waiting.delete(job.id);
          tell(`${job.output}: ${job.state}`);
          if (job.action === 'report' && job.state === 'done') {
            showReport(job.output);
          } else if (job.action !== 'run' && job.state === 'done') {
            showFolder(job.output);
          }
        }
      }
    }
  };
  const pick = (select, names, none) => {
    const was = select.value;
    select.replaceChildren(...(none !== null ? [dea.element('option', { value: '' }, none)] : []), ...names.map((name) => dea.element('option', { value: name }, name)));
    select.value = names.includes(was) ? was : '';
  };
  const showRuns = () => {
    const runs = state.runs.filter((one) => !one.name.endsWith('.part')); // those are halves of others
    const going = state.jobs.filter((job) => job.state === 'running' || job.state === 'waiting').map((job) => job.output);
    const text = JSON.stringify([open.name, going, [...chosen], runs.map((one) => [one.name, one.report, unfinished(one)])]);
    if ($('shown').dataset.last !== text) {
      $('shown').dataset.last = text;
      const focus = document.activeElement?.value;
      $('shown').replaceChildren(...runs.map((one) => {
        const box = dea.element('input', { type: 'checkbox', value: one.name });
        box.checked = chosen.has(one.name);
        box.addEventListener('change', () => {
          (box.checked ? (name) => chosen.add(name) : (name) => chosen.delete(name))(one.name);
          $('shown').dataset.many = chosen.size > 1 ? '1' : '';
          showRuns();
          showCurves();
          showPanels();
        });
        const row = dea.element('li', {}, dea.element('label', {}, box, one.name));
        const button = (text, title, act) => row.append(dea.button(text, act, { title }));
        if (one.report !== '') {
          button('Open report', `${one.name}/report.html`, () => showReport(one.name));
        }
        if (unfinished(one) && one.name.startsWith(stem(open.name)) && !going.includes(one.name)) {
          button('Go on', 'dea run --resume: from the state that the run has left', () => start({ action: 'run', file: open.name, output: one.name, resume: true }));
        }
        return row;
      }));
      [...$('shown').querySelectorAll('input')].find((box) => box.value === focus)?.focus();
    }
    if ($('measured').dataset.last !== JSON.stringify(state.tables)) {
      $('measured').dataset.last = JSON.stringify(state.tables);
      pick($('measured'), state.tables, 'none');
      pick($('study-table'), state.tables, 'none');
    }
    $('report').disabled = shown().length === 0;
  };
  // Runs that are drawn; one that goes on beside older results is in its own folder.
  const shown = () => [...chosen].flatMap((name) => {
    const going = state.jobs.some((job) => job.output === name && job.state === 'running');
    const found = state.runs.find((one) => going && one.name === `${name}.part`) ?? state.runs.find((one) => one.name === name);
    return found !== undefined ? [found] : [];
  }).slice(0, 6);
  let drawing = false;
  const showCurves = async () => {
    const runs = shown();
    const measured = $('measured').value;
    const text = JSON.stringify([runs.map((one) => [one.name, one.stamp]), measured, state.tables]);
    if (text === curvesOf || drawing) {
      return;
    }
    if (runs.length === 0) {
      curvesOf = text;
      $('curves').replaceChildren(dea.element('p', { class: 'still' }, 'Run the design, or choose a run.'));
      $('misfit').replaceChildren();
      return;
    }
    drawing = true;
    const names = { run: runs.map((one) => one.name), ...(measured !== '' ? { measured } : {}) };
    const answer = await call('GET', 'curves', names);
    drawing = false;
    if (answer.status === 200 && answer.json === null) {
      curvesOf = text;
      dea.listeners.length = 0;
      $('curves').innerHTML = answer.text; // as the report: texts are texts
      if (runs.length > 1) {
        $('curves').prepend(dea.element('p', { class: 'still' }, runs.map((one, i) => `${i + 1} ${one.name}`).join(', ')));
      }
      dea.dress($('curves'));
    } else if (measured !== '') {
      curvesOf = text;
      $('curves').replaceChildren(dea.element('p', { class: 'warning verdict' }, answer.json?.error ?? `refused: ${answer.status}`));
    } // else it is just being written
    await showMisfit(names);
    showCurves(); // what has come meanwhile
  };
  // Pages of the first run, while their panels are open; of one that goes on not more often than can be looked at.
  const panels = [['film', 4000], ['sliders', Infinity]].map(([path, every]) => ({ path, every, of: '', at: -Infinity }));
  const showPanels = () => {
    const [run] = shown();
    const going = state.jobs.some((job) => job.state === 'running' && run?.name.startsWith(job.output));
    for (const panel of panels) {
      const text = run === undefined ? '' : address(panel.path, { run: run.name, stamp: [run.stamp, ...(panel.path === 'sliders' ? state.sweeps.map((one) => one.stamp) : [])] });
      $(panel.path).hidden = run === undefined;
      if ($(panel.path).open && text !== '' && text !== panel.of && !(going && performance.now() - panel.at < panel.every)) {
        panel.of = text;
        panel.at = performance.now();
        $(panel.path).querySelector('iframe').src = text;
      }
    }
  };
  panels.forEach(({ path }) => $(path).addEventListener('toggle', showPanels));
  const showMisfit = async (names) => {
    if (names.measured === undefined && names.run.length < 2) {
      $('misfit').replaceChildren();
      return;
    }
    const { json } = await call('GET', 'compare', names);
    const rows = (json.compare?.comparisons ?? []).flatMap((pair) => pair.quantities.map((one) => [pair.a, one]));
    const table = dea.element('table', {}, dea.element('caption', {}, `Misfit to ${json.compare?.reference ?? ''}`),
      dea.element('thead', {}, dea.element('tr', {}, ...['Run', 'Quantity', 'rms', 'largest', 'of the range'].map((text, i) => dea.element('th', { scope: 'col', ...(i > 1 ? { class: 'n' } : {}) }, text)))),
      dea.element('tbody', {}, ...rows.map(([name, one]) => dea.element('tr', {}, dea.element('td', {}, name), dea.element('td', {}, `${one.quantity}${one.unit && one.unit !== '1' ? ` (${one.unit})` : ''}`),
        dea.element('td', { class: 'n' }, dea.number(one.rms)), dea.element('td', { class: 'n' }, dea.number(one.largest)), dea.element('td', { class: 'n' }, one.relative_rms !== undefined ? `${dea.number(100 * one.relative_rms, 3)} %` : '–')))));
    $('misfit').replaceChildren(rows.length > 0 ? dea.element('div', { class: 'scroll' }, table) : dea.element('p', { class: 'still' }, json.error ?? ''));
    command(json.command);
  };

  const takeTable = async (file) => {
    const name = file.name.replace(/^\.+/, '').replace(/[/\\]/g, '-');
    const body = await file.arrayBuffer();
    let answer = await call('PUT', 'design', { name, version: '' }, body);
    if (answer.json?.changed && window.confirm(`Replace ${name} in the folder?`)) {
      answer = await call('PUT', 'design', { name, version: answer.json.version }, body);
    }
    if (answer.json?.version === undefined || answer.json.changed) {
      tell(answer.json?.error ?? 'not taken');
      return;
    }
    state.tables = [...new Set([...state.tables, name])].sort();
    showRuns();
    $('measured').value = name;
    curvesOf = '';
    showCurves();
  };
  for (const target of [$('results'), $('runs')]) {
    target.addEventListener('dragover', (event) => { event.preventDefault(); target.classList.add('over'); });
    target.addEventListener('dragleave', () => target.classList.remove('over'));
    target.addEventListener('drop', (event) => {
      event.preventDefault();
      target.classList.remove('over');
      [...event.dataTransfer.files].slice(0, 1).forEach(takeTable);
    });
  }
  $('table').addEventListener('change', () => { [...$('table').files].slice(0, 1).forEach(takeTable); $('table').value = ''; });
  $('measured').addEventListener('change', showCurves);
  $('run').addEventListener('click', () => run(false));
  $('run-beside').addEventListener('click', () => { $('shown').dataset.many = '1'; run(true); });
  $('report').addEventListener('click', () => start({ action: 'report', runs: shown().map((one) => one.name), ...($('measured').value !== '' ? { measured: $('measured').value } : {}) }));
  $('fab').addEventListener('click', async () => { await touch(); start({ action: 'fab', file: open.name, output: `${stem(open.name)}.fab` }); });

  // Fit, sweep, optimise: a file with a few entries, written for the design that is open --------------

  const range = (text, factor) => text.replace(/^[+-]?[\d.]+(e[+-]?\d+)?/i, (number) => String(Number((number * factor).toPrecision(4))));
  const given = (pattern) => open.values.filter((value) => value.origin === 'given' && pattern.test(value.key));
  // Numbers that vary, by the names that the commands take: plies.film.thickness.
  const numbers = () => given(/^(?!dea|compute|report|monitors)/).filter((value) => value.si !== undefined).map((value) => {
    const [, list, rest] = /^(\w+\[\d+\])?(.*)$/.exec(value.key);
    const name = list !== undefined ? open.values.find((one) => one.key === `${list}.name` && one.origin === 'given') : undefined;
    return { name: name !== undefined ? `${list.replace(/\[.*/, '')}.${name.text}${rest}` : value.key, text: value.text };
  });
  const addRow = () => {
    const known = numbers();
    const free = known.find((one) => ![...$('study-keys').querySelectorAll('select')].some((select) => select.value === one.name)) ?? known[0];
    const select = dea.element('select', { 'aria-label': 'Key' }, ...known.map((one) => dea.element('option', { value: one.name }, `${one.name} (${one.text})`)));
    const ends = ['From', 'To'].map((label) => dea.element('input', { type: 'text', 'aria-label': label }));
    const less = dea.button('−', () => { row.remove(); showStudy(); }, { 'aria-label': 'Leave this key' });
    const row = dea.element('li', {}, select, ...ends, less);
    const fill = () => {
      const of = known.find((one) => one.name === select.value);
      [0.9, 1.1].forEach((factor, i) => { ends[i].value = range(of.text, factor); });
      showStudy();
    };
    $('study-keys').append(row);
    select.addEventListener('change', fill);
    if (free !== undefined) {
      select.value = free.name;
      fill();
    }
  };
  const study = () => {
    const kind = $('study-kind').value;
    const action = kind === 'sliders' ? 'sweep' : kind;
    const value = (id) => $(`study-${id}`).value.trim();
    const name = freeName(`${stem(open.name)}-${kind}.yaml`);
    const rows = [...$('study-keys').children].map((row) => {
      const [key, low, high] = [...row.querySelectorAll('select, input')].map((one) => one.value.trim());
      return `  - {name: ${/[[\]]/.test(key) ? `'${key}'` : key}, low: ${low}, high: ${high}${kind === 'sweep' ? `, steps: ${value('steps')}` : ''}}`;
    });
    const text = [`# Written by dea studio for ${open.name}.`, ...(kind === 'fit' ? ['dea_fit: 1'] : ['dea_explore: 1']), `name: ${stem(name)}`, `design: ${open.name}`, `model: ${value('model')}`,
      ...(kind === 'fit' ? ['parameters:', ...rows, 'curves:', `  - {name: ${stem(value('table'))}, file: ${value('table')}}`]
        : [`voltages: [${value('voltages')}]`, `quantities: [${value('quantities')}]`, 'variables:', ...rows]),
      ...(kind === 'sliders' ? ['plan: sparse-grid'] : []),
      ...(kind === 'optimise' ? [`objectives: [{quantity: ${value('objective')}, goal: ${value('goal')}}]`, ...(value('limit') !== '' ? [`limits: [{quantity: ${value('limit')}, above: ${value('above')}}]`] : []), 'starts: 1'] : []), ''].join('\n');
    return { action, name, text, output: `${stem(name)}.${action}` };
  };
  const showStudy = () => {
    const kind = $('study-kind').value;
    for (const label of $('study-form').querySelectorAll('[data-for]')) {
      label.hidden = !label.dataset.for.split(' ').includes(kind);
    }
    const { action, name, text, output } = study();
    $('study-text').textContent = text;
    command(`dea ${action} ${name} -o ${output}`);
    $('study-open').disabled = $('study-run').disabled = $('study-keys').children.length === 0 || (kind === 'fit' && $('study-table').value === '');
  };
  // Entries for the design, once it is checked; at the highest voltage that its run says is safe.
  const fillStudy = async () => {
    if (!$('study').open || open.values.length === 0 || $('study-keys').children.length > 0) {
      return;
    }
    addRow();
    const own = state.runs.find((one) => one.name === `${stem(open.name)}.run` && one.summary !== '');
    const safe_V = own !== undefined ? (await call('GET', 'file', { name: `${own.name}/summary.json` })).json?.trust?.safe_V : 0;
    const layout = given(/^plies\[/).length > 0;
    const highest = safe_V > 0 ? `${Math.floor(safe_V / 10) / 100} kV` : given(/^compute\.voltage\.(to|values\[\d+\])$/).at(-1)?.text ?? '1 kV';
    const moved = given(/^monitors\[\d+\]\.body$/).map((value) => `${open.values.find((one) => one.key === value.key.replace('body', 'name'))?.text.toLowerCase().replace(/\W/g, '_')}_z_m`);
    const known = [...(layout ? moved : ['electrode_edge_u_m']), 'true_field_V_per_m', 'breakdown_margin', 'min_tension_N_per_m', 'capacitance_F'];
    const few = Array.from({ length: 5 }, (_, i) => range(highest, i / 4));
    $('study-voltages').value = $('study-kind').value === 'sliders' ? few.join(', ') : highest;
    $('study-quantities').value = known.slice(0, 4).join(', ');
    $('study-objective').value = known[0];
    $('study-limit').value = 'breakdown_margin';
    $('study-known').replaceChildren(...known.map((text) => dea.element('option', { value: text })));
    pick($('study-model'), layout ? ['3d'] : ['lumped', 'axisymmetric', '3d'], null);
    $('study-model').selectedIndex = 0;
    $('study-kind').onchange = () => {
      $('study-voltages').value = $('study-kind').value === 'sliders' ? few.join(', ') : highest;
      showStudy();
    };
    showStudy();
  };
  const writeStudy = async (run) => {
    await touch();
    const { action, name, text, output } = study();
    const { json } = await call('PUT', 'design', { name, version: '' }, text);
    if (json?.version === undefined || json.changed) {
      tell(json?.error ?? `${name} is there`);
    } else if (run) {
      await start({ action, file: name, output });
    } else {
      window.location.hash = encodeURIComponent(name);
    }
  };
  $('study').addEventListener('toggle', fillStudy);
  $('study-form').addEventListener('submit', (event) => event.preventDefault());
  $('study-form').addEventListener('input', showStudy);
  $('study-more').addEventListener('click', addRow);
  $('study-open').addEventListener('click', () => writeStudy(false));
  $('study-run').addEventListener('click', () => writeStudy(true));

  // Files and the start page --------------------------------------------------------------------------

  // What is typed is saved before another file is shown; false: it cannot be, and the user stays with it.
  const leave = async () => {
    clearTimeout(soon);
    await touch();
    if (open.name === '' || editor.get() === open.saved || window.confirm(`${open.name} is not saved. Leave it so?`)) {
      return true;
    }
    window.history.replaceState(null, '', `#${encodeURIComponent(open.name)}`);
    return false;
  };
  window.addEventListener('beforeunload', (event) => {
    if (open.name !== '' && editor.get() !== open.saved) {
      event.preventDefault();
    }
  });
  const openFile = async (name) => {
    const answer = await call('GET', 'design', { name });
    if (answer.status !== 200) {
      tell(answer.json?.error ?? `not there: ${answer.status}`);
      window.location.hash = '';
      return;
    }
    const text = unix(answer.json.text);
    Object.assign(open, { name, version: answer.json.version, saved: text, kind: kindOf(text), stamp: '', asked: false, values: [] });
    $('asked').hidden = true;
    $('start').hidden = true;
    $('desk').hidden = false;
    $('folder-view').hidden = true;
    editor.read(text);
    editor.refresh();
    tell('saved');
    document.title = `${name} – dea studio`;
    $('edit-title').textContent = name;
    const design = open.kind === 'design';
    for (const id of ['values', 'drawing', 'models', 'study']) {
      $(id).hidden = !design;
    }
    $('picture').replaceChildren();
    $('findings').replaceChildren();
    $('form').dataset.keys = '';
    $('form').replaceChildren();
    $('study-keys').replaceChildren();
    readSchema();
    $('run').disabled = open.kind === 'other';
    $('run').textContent = { fit: 'Fit', sweep: 'Sweep', optimise: 'Optimise' }[open.kind] ?? 'Run';
    $('run-beside').disabled = $('fab').disabled = !design;
    chosen.clear();
    const own = state.runs.find((one) => one.name === `${stem(name)}.run`);
    if (design && own !== undefined) {
      chosen.add(own.name);
    }
    showFiles();
    showRuns();
    showCurves();
    showPanels();
    if (design) {
      await touch();
    } else if (state.folders.includes(`${stem(name)}.${open.kind}`)) {
      showFolder(`${stem(name)}.${open.kind}`);
    }
  };
  const showFiles = () => {
    const names = state.designs.map((one) => one.name);
    $('file').replaceChildren(dea.element('option', { value: '' }, 'Start page'), ...names.map((name) => dea.element('option', { value: name }, name)));
    $('file').value = names.includes(open.name) ? open.name : '';
    $('folder').textContent = state.folder ?? '';
    $('designs').replaceChildren(...names.map((name) => dea.element('li', {}, dea.element('a', { href: `#${encodeURIComponent(name)}` }, name))),
      ...(names.length === 0 ? [dea.element('li', { class: 'faint' }, 'none yet')] : []));
  };
  $('file').addEventListener('change', () => { window.location.hash = encodeURIComponent($('file').value); });

  const copy = async (example) => {
    const to = freeName(`${stem(example)}.yaml`);
    const answer = await call('POST', 'copy', { name: example, to });
    command(`dea examples ${example.replace(/\.yaml$/, '')} > ${to}`);
    if (answer.json?.name !== undefined) {
      window.location.hash = encodeURIComponent(to);
    } else {
      tell(answer.json?.error ?? `refused: ${answer.status}`);
    }
  };
  let gallery = null;
  const showStart = async () => {
    open.name = '';
    document.title = 'dea studio';
    $('start').hidden = false;
    $('desk').hidden = true;
    $('run').disabled = $('run-beside').disabled = $('fab').disabled = true;
    tell('');
    showFiles();
    if (gallery !== null) {
      return;
    }
    gallery = (await call('GET', 'examples')).json;
    const cards = gallery.map(({ name, title }) => {
      const shot = dea.element('span', { class: 'shot' });
      const card = dea.element('button', { type: 'button', 'data-example': name }, shot, dea.element('b', {}, title || stem(name)), dea.element('small', {}, `Copy and open ${stem(name)}.yaml`));
      card.addEventListener('click', () => copy(name));
      return { card, shot, name };
    });
    $('gallery').replaceChildren(...cards.map((one) => one.card));
    for (const { shot, name } of cards) { // one after the other, so that a click is not kept waiting
      const { json } = await call('GET', 'picture', { name });
      if (json?.svg !== undefined) {
        shot.innerHTML = json.svg;
        const svg = shot.querySelector('svg');
        svg.setAttribute('aria-hidden', 'true');
        svg.setAttribute('preserveAspectRatio', 'xMidYMin slice'); // the plan; section and key lie below
      }
    }
  };
  const route = async () => {
    const name = decodeURIComponent(window.location.hash.slice(1));
    if (await leave()) {
      await (name === '' ? showStart() : openFile(name));
    }
  };
  window.addEventListener('hashchange', route);

  document.addEventListener('keydown', (event) => {
    if (!(event.ctrlKey || event.metaKey)) {
      return;
    }
    if (event.key === 's') {
      event.preventDefault();
      touch();
    } else if (event.key === 'Enter' && !$('run').disabled) {
      event.preventDefault();
      (event.shiftKey ? $('run-beside') : $('run')).click();
    }
  });

  // What there is, as it changes ----------------------------------------------------------------------

  const take = async (next) => {
    const files = JSON.stringify(next.designs.map((one) => one.name)) !== JSON.stringify(state.designs.map((one) => one.name));
    state = next;
    if (files) {
      showFiles();
    }
    showJobs();
    showRuns();
    showCurves();
    showPanels();
    look();
  };
  // Whether the file was written, by us or by another program.
  const look = async () => {
    await open.busy;
    const own = state.designs.find((one) => one.name === open.name);
    if (own === undefined || own.stamp === open.stamp || open.asked) {
      return;
    }
    const { stamp, name } = own;
    const { version } = open;
    const answer = await call('GET', 'design', { name });
    if (answer.status !== 200 || name !== open.name || open.busy !== null || version !== open.version) {
      return; // what has saved meanwhile looks again
    }
    open.stamp = stamp;
    if (answer.json.version === open.version) {
      return;
    }
    meet(answer.json);
  };
  // What there is, as long as the studio answers.
  const follow = async () => {
    for (let last = ''; ; await wait(200)) {
      const answer = await call('GET', 'state').catch(() => null);
      $('lost').hidden = answer?.json !== undefined;
      if (answer?.json && answer.text !== last) {
        last = answer.text;
        take(answer.json);
      }
    }
  };
  const begin = async () => {
    state = (await call('GET', 'state')).json;
    follow();
    if (window.location.hash.length < 2 && state.open !== '') {
      window.location.replace(`#${encodeURIComponent(state.open)}`);
    }
    await route();
  };
  dea.ready = begin();
})();
