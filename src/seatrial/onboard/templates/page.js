"use strict";
const SVG = "http://www.w3.org/2000/svg", PERIOD = 500, DRAWN = 400, QUIET = 5, LABELS = 16, Z95 = 1.96;
const seen = { epoch: "", points: [], isOver: false };
const at = id => document.getElementById(id);

// elements: text is only ever set as text
function node(name, attributes = {}, ...inside) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...inside.map(String));
  return made;
}
function nested(name, attributes, children) {
  const made = node(name, attributes);
  made.append(...children);
  return made;
}
function drawn(name, attributes, words = "") {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (words !== "") made.textContent = words;
  return made;
}
// what has not changed stays, so that it can be selected
function renew(place, key, children) {
  const signature = JSON.stringify(key);
  if (place.signature === signature) return;
  place.signature = signature;
  place.replaceChildren(...children());
}

// numbers on axes
function ticks(low, high, about) {
  if (!(high > low)) return [low];
  const power = 10 ** Math.floor(Math.log10((high - low) / about));
  const step = power * [1, 2, 5, 10].find(m => (high - low) / (m * power) <= about + 0.5);
  const made = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) made.push(k * step);
  return made;
}
function digits(value, step) {
  const decimals = Math.min(8, Math.max(0, -Math.floor(Math.log10(step) + 1e-9)));
  return (Math.abs(value) < 1e-9 * step ? 0 : value).toFixed(decimals).replace("-", "−");
}
function clock(longest) {
  if (longest < 180) return [1, "s"];
  if (longest < 3 * 3600) return [60, "min"];
  return longest < 3 * 86400 ? [3600, "h"] : [86400, "d"];
}
function thinned(points) {
  const step = Math.ceil(points.length / DRAWN);
  return points.filter((_, k) => k % step === 0 || k === points.length - 1);
}

// a path through points with gaps where something is not known
function path(xs, ys) {
  let words = "", pen = "M";
  xs.forEach((x, k) => {
    if (Number.isFinite(ys[k])) { words += `${pen}${x.toFixed(1)} ${ys[k].toFixed(1)}`; pen = "L"; } else pen = "M";
  });
  return words;
}
function bandPath(xs, lows, highs) {
  let words = "", from = -1;
  for (let k = 0; k <= xs.length; k++) {
    const known = k < xs.length && Number.isFinite(lows[k]) && Number.isFinite(highs[k]);
    if (known && from < 0) from = k;
    if (!known && from >= 0) {
      const up = xs.slice(from, k).map((x, j) => `${x.toFixed(1)} ${highs[from + j].toFixed(1)}`);
      const down = xs.slice(from, k).map((x, j) => `${x.toFixed(1)} ${lows[from + j].toFixed(1)}`).reverse();
      words += `M${up.concat(down).join("L")}Z`;
      from = -1;
    }
  }
  return words;
}

// axes of one panel; returns the places of x and y and what to draw into
function panel(width, height, box, xs, range, labels) {
  const svg = drawn("svg", { viewBox: `0 0 ${width} ${height}`, role: "img" });
  const [left, top, right, bottom] = box;
  const first = xs[0] ?? 0, last = Math.max(xs.at(-1) ?? 1, first + 1e-9), [size, unit] = clock(last);
  const X = x => left + (x - first) / (last - first) * (right - left);
  const Y = y => bottom - (y - range[0]) / (range[1] - range[0]) * (bottom - top);
  const onX = ticks(first / size, last / size, Math.max(3, (right - left) / 90));
  const stepX = onX.length > 1 ? onX[1] - onX[0] : 1;
  onX.forEach((value, k) => {
    const x = X(value * size), words = digits(value, stepX) + (k === onX.length - 1 ? ` ${unit}` : "");
    svg.append(drawn("path", { class: "gridline", d: `M${x} ${top}V${bottom}` }));
    svg.append(drawn("text", { class: "tick", x, y: bottom + 14, "text-anchor": "middle" }, words));
  });
  for (const [value, words] of labels) {
    svg.append(drawn("path", { class: "gridline", d: `M${left} ${Y(value)}H${right}` }));
    svg.append(drawn("text", { class: "tick", x: left - 5, y: Y(value) + 3.5, "text-anchor": "end" }, words));
  }
  svg.append(drawn("path", { class: "axis", d: `M${left} ${top}V${bottom}H${right}` }));
  const inside = drawn("svg", { x: left, y: top, width: right - left, height: bottom - top,
    viewBox: `${left} ${top} ${right - left} ${bottom - top}` });
  svg.append(inside);
  return { svg, inside, X, Y };
}
function linear(low, high) {
  const shown = ticks(low, high, 4), step = shown.length > 1 ? shown[1] - shown[0] : Math.abs(low) || 1;
  return shown.map(value => [value, digits(value, step)]);
}
function spread(low, high) {
  const room = high > low ? 0.06 * (high - low) : 0.05 * Math.abs(low) || 1;
  return [low - room, high + room];
}

// a value with its band; the axis covers the later values and the interval as it is now
function course(title, now, xs, values, halves, isTold) {
  const last = xs.at(-1) ?? 0, half = halves.at(-1), from = (xs[0] ?? 0) + 0.2 * (last - (xs[0] ?? 0));
  const later = values.filter((v, k) => Number.isFinite(v) && (xs[k] >= from || values.length < 5));
  const ends = Number.isFinite(half) && Number.isFinite(values.at(-1))
    ? [values.at(-1) - 1.5 * half, values.at(-1) + 1.5 * half] : [];
  const every = later.concat(ends);
  const range = every.length ? spread(Math.min(...every), Math.max(...every)) : [0, 1];
  const { svg, inside, X, Y } = panel(346, 180, [52, 26, 334, 162], xs, range, linear(...range));
  const places = xs.map(X), limit = y => Math.max(-1e4, Math.min(1e4, y));
  const high = values.map((v, k) => limit(Y(v + halves[k]))), low = values.map((v, k) => limit(Y(v - halves[k])));
  inside.append(drawn("path", { class: "band", d: bandPath(places, low, high) }));
  inside.append(drawn("path", { class: "course", d: path(places, values.map(v => limit(Y(v)))) }));
  svg.append(drawn("text", { class: isTold ? "name" : "name untold", x: 52, y: 15 }, title));
  svg.append(drawn("text", { class: "now", x: 334, y: 15, "text-anchor": "end" }, now));
  svg.setAttribute("aria-label", `${title}: ${now}`);
  return nested("figure", {}, [svg]);
}

// standard errors in per cent of values, logarithmic, named at their ends
function shares(width, rows, xs, values, halves) {
  const lines = rows.map((row, k) => ({ name: row.name, told: row.is_told,
    ys: xs.map((_, j) => Math.log10(100 * halves[j][k] / Z95 / Math.abs(values[j][k]))) }));
  const known = lines.flatMap(line => line.ys).filter(Number.isFinite);
  const low = known.length ? Math.floor(Math.min(...known.map(y => Math.max(y, -4))) + 1e-9) : 0;
  const high = known.length ? Math.min(3, Math.max(low + 1, Math.ceil(Math.max(...known)))) : 2;
  const decades = Array.from({ length: high - low + 1 }, (_, k) => [low + k, `${+(10 ** (low + k)).toPrecision(1)} %`]);
  const { svg, inside, X, Y } = panel(width, 292, [52, 10, width - 110, 270], xs, [low, high], decades);
  const ended = lines.filter(line => Number.isFinite(line.ys.at(-1))).sort((a, b) => b.ys.at(-1) - a.ys.at(-1));
  const places = xs.map(X);
  for (const line of [...lines].reverse()) {
    const kind = line === ended[0] ? "course worst" : "course thin";
    inside.append(drawn("path", { class: kind, d: path(places, line.ys.map(Y)) }));
  }
  let below = 4;
  const labelled = ended.slice(0, LABELS), room = (276 - 4) / Math.max(1, labelled.length);
  labelled.forEach((line, k) => {
    const end = Math.max(10, Math.min(270, Y(line.ys.at(-1))));
    const most = 276 - (labelled.length - 1 - k) * Math.min(12, room);
    const y = Math.min(Math.max(end, below + Math.min(12, room)), most);
    below = y;
    svg.append(drawn("path", { class: "leader", d: `M${width - 109} ${end}L${width - 94} ${y}` }));
    svg.append(drawn("text", { class: k ? "label" : "label worst", x: width - 91, y: y + 3.5 }, line.name));
  });
  svg.setAttribute("aria-label", "standard errors in per cent of the values");
  return svg;
}

// the sections
const listed = names => names.length < 2 ? names.join("") : `${names.slice(0, -1).join(", ")} and ${names.at(-1)}`;
function facts(told) {
  const fact = (what, value) => nested("div", {}, [node("dt", {}, what), node("dd", {}, value)]);
  return [fact("phase", `${told.phase}: ${told.meaning}`), fact("stream's clock", told.moment), fact("samples", told.samples),
    fact("runs", told.runs)];
}
function row(told) {
  const name = node("th", {}, told.name);
  if (!told.is_told) name.append(node("span", { class: "mark" }, "not told"));
  const interval = told.half === "–" ? "–" : `[${told.lower}, ${told.upper}]`;
  return nested("tr", { class: told.is_told ? "" : "untold" }, [name, node("td", { class: "num" }, told.value),
    node("td", { class: "num" }, interval), node("td", { class: "unit" }, told.unit), node("td", { class: "num" }, told.share)]);
}
function counts(told) {
  const line = ([what, number], kind) => nested("tr", { class: kind },
    [node("th", {}, what), node("td", { class: "num" }, number)]);
  return [line(["used", told.accepted], ""), ...told.troubles.map(item => line(item, item[1] ? "some" : "none"))];
}
function finding(told) {
  const first = nested("p", {}, [node("span", { class: `severity ${told.severity}` }, told.severity), told.text]);
  return nested("div", { class: "finding" }, told.advice ? [first, node("p", { class: "caption" }, told.advice)] : [first]);
}
function words(told) {
  renew(at("facts"), [told.phase, told.moment, told.samples, told.runs], () => facts(told));
  renew(at("rows"), told.rows, () => told.rows.map(row));
  renew(at("counts"), [told.accepted, told.troubles], () => counts(told));
  renew(at("findings"), told.findings, () => told.findings.map(finding));
  renew(at("change"), told.change, () => [node("p", {}, told.change)]);
  renew(at("untold"), [told.untold, told.advice], () => [
    node("p", {}, told.untold.length ? `The data so far do not tell ${listed(told.untold)}.` : "No estimate yet."),
    node("p", {}, told.advice)]);
  at("change").hidden = told.change === "";
  at("untold").hidden = told.untold.length === 0 && told.advice === "";
  at("told").hidden = told.findings.length === 0;
  at("residuals").hidden = told.noise.length === 0;
  at("last").textContent = told.last ? `The latest trouble: ${told.last}` : "";
  at("body").hidden = false;
}
function plots(told) {
  const shown = thinned(seen.points), xs = shown.map(p => p[1]);
  const values = shown.map(p => p[2].map(v => v ?? NaN)), halves = shown.map(p => p[3].map(h => h ?? NaN));
  const width = Math.max(340, at("shares").clientWidth);
  at("shares").replaceChildren(shares(width, told.rows, xs, values, halves));
  at("values").replaceChildren(...told.rows.map((row, k) => {
    const scale = 10 ** row.power, both = row.half === "–" ? row.value : `${row.value} ± ${row.half}`;
    const now = `${row.power ? `(${both})` : both} ${row.unit}`.trim();
    return course(row.is_told ? row.name : `${row.name}, not told`, now, xs, values.map(v => v[k] / scale),
      halves.map(h => h[k] / scale), row.is_told);
  }));
  at("noise").replaceChildren(...told.noise.map((channel, k) => course(
    channel.meaning ? `${channel.name}, ${channel.meaning}` : channel.name, `${channel.rms} ${channel.unit}`.trim(), xs,
    shown.map(p => p[4][k] ?? NaN), xs.map(() => NaN), true)));
}

function say(kind, text) {
  at("status").className = `sans ${kind}`;
  if (at("status").textContent !== text) at("status").textContent = text;
}
function status(state) {
  seen.isOver = state.is_over;
  if (state.is_over) return say("over", `the stream is over${state.why ? `: ${state.why}` : ""}`);
  if (!state.told) return say("", "nothing has come yet");
  return state.age > QUIET ? say("quiet", `no news for ${Math.round(state.age)} s`) : say("following", "following");
}
// keeps what the server keeps: every stride-th point and the newest
function merge(state) {
  seen.points.push(...state.points);
  const newest = seen.points.at(-1);
  seen.points = seen.points.filter(p => p[0] % state.stride === 0 || p === newest);
}
async function ask() {
  const since = seen.points.length ? seen.points.at(-1)[0] : -1;
  const answer = await fetch(`/state.json?since=${since}`, { cache: "no-store" });
  if (!answer.ok) throw new Error(`state ${answer.status}`);
  return answer.json();
}
async function turn() {
  let state = await ask();
  if (state.epoch !== seen.epoch) {
    seen.points = [];
    state = await ask();
    seen.epoch = state.epoch;
  }
  merge(state);
  status(state);
  if (state.title) at("title").textContent = state.title;
  document.title = state.title ? `${state.title} · seatrial` : "seatrial";
  if (state.told) {
    words(state.told);
    if (state.points.length) plots(state.told);
  }
}
async function follow() {
  try { await turn(); } catch { if (!seen.isOver) say("gone", "seatrial no longer answers; these are its last numbers"); }
  setTimeout(follow, PERIOD);
}
follow();
