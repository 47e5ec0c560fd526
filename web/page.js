'use strict';
// What the parts of the page share. Everything here adds to a page that is complete without it.
const dea = {
  waits: [], // what is still to come
  listeners: [],
  // Colours from low to high, and the parts of one from 0 to 255.
  rising: ['#1d2454', '#284a80', '#2a6f8e', '#2a918c', '#46b27f', '#84cb66', '#c3dc54', '#f1e45c', '#fdf3a7'],
  rgb: (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16)),
  // One voltage for curves, membrane and explorer; source: who says so, and is not told again.
  setVoltage(value, source) {
    for (const [listener, tell] of this.listeners) {
      if (listener !== source) {
        tell(value);
      }
    }
  },
  onVoltage(listener, tell) {
    this.listeners.push([listener, tell]);
  },
  number(value, digits = 4) {
    if (!Number.isFinite(value)) {
      return '–';
    }
    return String(Number(value.toPrecision(digits))).replace('-', '−');
  },
  fill(node, attributes, content) {
    for (const [name, value] of Object.entries(attributes)) {
      node.setAttribute(name, value);
    }
    node.append(...content);
    return node;
  },
  element(tag, attributes = {}, ...content) {
    return this.fill(document.createElement(tag), attributes, content);
  },
  svg(tag, attributes = {}, ...content) {
    return this.fill(document.createElementNS('http://www.w3.org/2000/svg', tag), attributes, content);
  },
  button(text, act, attributes = {}) {
    const node = this.element('button', { type: 'button', ...attributes }, text);
    node.addEventListener('click', act);
    return node;
  },
  // A labelled slider with its value beside it; show: value -> text.
  slider(label, low, high, step, value, show, change) {
    const output = this.element('output');
    const input = this.element('input', { type: 'range', min: low, max: high, step, value });
    const tell = () => {
      output.textContent = show(input.valueAsNumber);
      input.setAttribute('aria-valuetext', output.textContent); // the slider's own number may be of no unit
    };
    tell();
    input.addEventListener('input', () => {
      change(input.valueAsNumber);
      tell();
    });
    const node = this.element('label', { class: 'slider' }, this.element('span', {}, label), output, input);
    return {
      node,
      set(to) { input.value = to; tell(); },
    };
  },
  choice(label, options, change) {
    const select = this.element('select');
    options.forEach((text, i) => select.append(this.element('option', { value: i }, text)));
    select.addEventListener('change', () => change(Number(select.value)));
    return { node: this.element('label', { class: 'choice' }, this.element('span', {}, label), select), select };
  },
};
