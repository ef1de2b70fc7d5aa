// Elements as values: text is always text, never markup.

export function h(tag, attributes = {}, ...children) {
  const node = document.createElement(tag);
  set(node, attributes);
  node.append(...children.flat(Infinity).filter(child => child !== null && child !== undefined && child !== false && child !== ""));
  return node;
}

const SVG = "http://www.w3.org/2000/svg";
export function s(tag, attributes = {}, ...children) {
  const node = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) if (value !== null) node.setAttribute(name, value);
  node.append(...children.flat(Infinity));
  return node;
}

function set(node, attributes) {
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
    else if (name in node && name !== "list" && typeof value !== "string") node[name] = value;
    else if (value !== null && value !== undefined && value !== false) node.setAttribute(name, value === true ? "" : value);
  }
}

export function button(text, act, attributes = {}) {
  return h("button", { type: "button", onclick: act, ...attributes }, text);
}

let fields = 0;
// a label with its control, tied by an id
export function field(label, control, note = "") {
  control.id ||= `field-${fields += 1}`;
  return h("div", { class: "field" }, h("label", { for: control.id }, label), control, note && h("span", { class: "u" }, note));
}

export function select(options, value, act, attributes = {}) {
  const node = h("select", { onchange: () => act?.(node.value), ...attributes },
    options.map(one => {
      const [key, text] = Array.isArray(one) ? one : [one, one];
      return h("option", { value: key, selected: key === value }, text);
    }));
  return node;
}

export function input(kind, value, attributes = {}) {
  return h("input", { type: kind, value: value ?? "", ...attributes });
}

// as many digits as a hand can set, a minus that is one, no exponent where none is needed
export function digits(value, count = 4) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  const size = Math.abs(value);
  const text = size !== 0 && (size < 1e-3 || size >= 1e6) ? value.toExponential(count - 1) : String(+value.toPrecision(count));
  return text.replaceAll("-", "−").replace("e+", "e");
}

export function duration(seconds) {
  const whole = Math.round(seconds);
  if (whole < 60) return `${whole} s`;
  return `${Math.floor(whole / 60)} min ${String(whole % 60).padStart(2, "0")} s`;
}

export function diffView(lines) {
  return h("pre", { class: "diff", tabindex: 0, "aria-label": "change of the trial file" }, lines.map(line =>
    h("span", { class: line.startsWith("+") ? "plus" : line.startsWith("-") ? "minus" : line.startsWith("@") ? "place" : "" }, `${line}\n`)));
}

export function section(title, ...content) {
  return h("section", {}, h("h2", {}, title), ...content);
}
