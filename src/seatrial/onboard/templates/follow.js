"use strict";
const SVG = "http://www.w3.org/2000/svg", PERIOD = 500, DRAWN = 400, QUIET = 5, LABELS = 16, Z95 = 1.96;
const client = { epoch: "", points: [], isOver: false };
const byId = id => document.getElementById(id);

// elements: text is only ever set as text
function node(name, attributes = {}, ...inside) {
  const result = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) result.setAttribute(key, value);
  result.append(...inside.map(String));
  return result;
}
function nested(name, attributes, children) {
  const result = node(name, attributes);
  result.append(...children);
  return result;
}
function svgNode(name, attributes, words = "") {
  const result = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) result.setAttribute(key, value);
  if (words !== "") result.textContent = words;
  return result;
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
  const result = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) result.push(k * step);
  return result;
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
    if (!Number.isFinite(ys[k])) { pen = "M"; return; }
    words += `${pen}${x.toFixed(1)} ${ys[k].toFixed(1)}${pen === "M" ? "h0" : ""}`;  // h0: a single point is a dot
    pen = "L";
  });
  return words;
}
function bandPath(xs, lows, highs) {
  let words = "", from = -1;
  for (let k = 0; k <= xs.length; k++) {
    const isDefined = k < xs.length && Number.isFinite(lows[k]) && Number.isFinite(highs[k]);
    if (isDefined && from < 0) from = k;
    if (!isDefined && from >= 0) {
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
  const svg = svgNode("svg", { viewBox: `0 0 ${width} ${height}`, role: "img" });
  const [left, top, right, bottom] = box;
  const first = xs[0] ?? 0, end = xs.at(-1) ?? 1, last = end > first ? end : first + 1, [size, unit] = clock(last);
  const X = x => left + (x - first) / (last - first) * (right - left);
  const Y = y => bottom - (y - range[0]) / (range[1] - range[0]) * (bottom - top);
  const onX = ticks(first / size, last / size, Math.max(3, (right - left) / 90));
  const stepX = onX.length > 1 ? onX[1] - onX[0] : 1;
  onX.forEach((value, k) => {
    const x = X(value * size), words = digits(value, stepX) + (k === onX.length - 1 ? ` ${unit}` : "");
    svg.append(svgNode("path", { class: "gridline", d: `M${x} ${top}V${bottom}` }));
    svg.append(svgNode("text", { class: "tick", x, y: bottom + 14, "text-anchor": "middle" }, words));
  });
  for (const [value, words] of labels) {
    svg.append(svgNode("path", { class: "gridline", d: `M${left} ${Y(value)}H${right}` }));
    svg.append(svgNode("text", { class: "tick", x: left - 5, y: Y(value) + 3.5, "text-anchor": "end" }, words));
  }
  svg.append(svgNode("path", { class: "axis", d: `M${left} ${top}V${bottom}H${right}` }));
  const inside = svgNode("svg", { x: left, y: top, width: right - left, height: bottom - top,
    viewBox: `${left} ${top} ${right - left} ${bottom - top}` });
  svg.append(inside);
  return { svg, inside, X, Y };
}
function linear(low, high) {
  const marks = ticks(low, high, 4), step = marks.length > 1 ? marks[1] - marks[0] : Math.abs(low) || 1;
  return marks.map(value => [value, digits(value, step)]);
}
function spread(low, high) {
  const room = high > low ? 0.06 * (high - low) : 0.05 * Math.abs(low) || 1;
  return [low - room, high + room];
}

// a value with its band; the axis covers the later values and the interval as it is now
function course(title, now, xs, values, halves, isIdentified, forgotten = 0.2) {
  const last = xs.at(-1) ?? 0, half = halves.at(-1), from = (xs[0] ?? 0) + forgotten * (last - (xs[0] ?? 0));
  const later = values.filter((v, k) => Number.isFinite(v) && (xs[k] >= from || values.length < 5));
  const ends = Number.isFinite(half) && Number.isFinite(values.at(-1))
    ? [values.at(-1) - 1.5 * half, values.at(-1) + 1.5 * half] : [];
  const every = later.concat(ends);
  const range = every.length ? spread(Math.min(...every), Math.max(...every)) : [0, 1];
  const { svg, inside, X, Y } = panel(346, 180, [52, 26, 334, 162], xs, range, linear(...range));
  const places = xs.map(X), limit = y => Math.max(-1e4, Math.min(1e4, y));
  const high = values.map((v, k) => limit(Y(v + halves[k]))), low = values.map((v, k) => limit(Y(v - halves[k])));
  inside.append(svgNode("path", { class: "band", d: bandPath(places, low, high) }));
  inside.append(svgNode("path", { class: "course", d: path(places, values.map(v => limit(Y(v)))) }));
  svg.append(svgNode("text", { class: isIdentified ? "name" : "name unidentified", x: 52, y: 15 }, title));
  svg.append(svgNode("text", { class: "now", x: 334, y: 15, "text-anchor": "end" }, now));
  svg.setAttribute("aria-label", `${title}: ${now}`);
  return nested("figure", {}, [svg]);
}

// the track from above, north up, one scale; the ring is where the craft is
function track(north, east) {
  const svg = svgNode("svg", { viewBox: "0 0 346 260", role: "img", "aria-label": "track from above, north up" });
  const known = north.map((_, k) => k).filter(k => north[k] !== null && east[k] !== null);
  const ends = values => spread(Math.min(...values), Math.max(...values));
  const [x0, x1] = ends(known.map(k => east[k])), [y0, y1] = ends(known.map(k => north[k]));
  const [left, top, width, height] = [52, 26, 282, 206], scale = Math.max((x1 - x0) / width, (y1 - y0) / height);
  const X = x => left + width / 2 + (x - (x0 + x1) / 2) / scale, Y = y => top + height / 2 - (y - (y0 + y1) / 2) / scale;
  const across = [(x0 + x1 - width * scale) / 2, (x0 + x1 + width * scale) / 2], along = [(y0 + y1 - height * scale) / 2, (y0 + y1 + height * scale) / 2];
  for (const [value, words] of linear(...across)) svg.append(svgNode("path", { class: "gridline", d: `M${X(value)} ${top}v${height}` }),
    svgNode("text", { class: "tick", x: X(value), y: top + height + 14, "text-anchor": "middle" }, words));
  for (const [value, words] of linear(...along)) svg.append(svgNode("path", { class: "gridline", d: `M${left} ${Y(value)}h${width}` }),
    svgNode("text", { class: "tick", x: left - 5, y: Y(value) + 3.5, "text-anchor": "end" }, words));
  svg.append(svgNode("path", { class: "course", d: path(known.map(k => X(east[k])), known.map(k => Y(north[k]))) }));
  const last = known.at(-1);
  svg.append(svgNode("circle", { class: "craft", cx: X(east[last]), cy: Y(north[last]), r: 5 }));
  svg.append(svgNode("text", { class: "name", x: left, y: 15 }, "track, north up [m]"));
  return nested("figure", {}, [svg]);
}
function renderRecent({ track: places, channels }) {
  const figures = channels.map(({ label, time, values }) => {
    const numbers = values.map(v => v ?? NaN), latest = numbers.findLast(Number.isFinite);
    return course(label, latest === undefined ? "–" : latest.toPrecision(3).replace("-", "−"), time, numbers, numbers.map(() => NaN), true, 0);
  });
  const hasTrack = places && places.x0.some((x, k) => x !== null && places.y0[k] !== null);
  byId("recent").replaceChildren(...(hasTrack ? [track(places.x0, places.y0)] : []), ...figures);
  byId("recent").hidden = byId("recent").children.length === 0;
}

// standard errors in per cent of values, logarithmic, named at their ends
function shares(width, rows, xs, values, halves) {
  const lines = rows.map((row, k) => ({ name: row.name, isIdentified: row.is_identified,
    ys: xs.map((_, j) => Math.log10(100 * halves[j][k] / Z95 / Math.abs(values[j][k]))) }));
  const from = xs.findIndex(x => x >= 0.2 * (xs.at(-1) ?? 0));
  const finite = lines.flatMap(line => line.ys.slice(xs.length < 5 ? 0 : from)).filter(Number.isFinite);
  const low = finite.length ? Math.floor(Math.min(...finite.map(y => Math.max(y, -4))) + 1e-9) : 0;
  const high = finite.length ? Math.min(3, Math.max(low + 1, Math.ceil(Math.max(...finite)))) : 2;
  const decades = Array.from({ length: high - low + 1 }, (_, k) => [low + k, `${+(10 ** (low + k)).toPrecision(1)} %`]);
  const { svg, inside, X, Y } = panel(width, 292, [52, 10, width - 110, 270], xs, [low, high], decades);
  const ended = lines.filter(line => Number.isFinite(line.ys.at(-1))).sort((a, b) => b.ys.at(-1) - a.ys.at(-1));
  const places = xs.map(X);
  for (const line of [...lines].reverse()) {
    const kind = line === ended[0] ? "course worst" : "course thin";
    inside.append(svgNode("path", { class: kind, d: path(places, line.ys.map(Y)) }));
  }
  let below = 4;
  const labelled = ended.slice(0, LABELS), room = (276 - 4) / Math.max(1, labelled.length);
  labelled.forEach((line, k) => {
    const end = Math.max(10, Math.min(270, Y(line.ys.at(-1))));
    const most = 276 - (labelled.length - 1 - k) * Math.min(12, room);
    const y = Math.min(Math.max(end, below + Math.min(12, room)), most);
    below = y;
    svg.append(svgNode("path", { class: "leader", d: `M${width - 109} ${end}L${width - 94} ${y}` }));
    svg.append(svgNode("text", { class: k ? "label" : "label worst", x: width - 91, y: y + 3.5 }, line.name));
  });
  svg.setAttribute("aria-label", "standard errors in per cent of the values");
  return svg;
}

// the sections
const listed = names => names.length < 2 ? names.join("") : `${names.slice(0, -1).join(", ")} and ${names.at(-1)}`;
function facts(snapshot) {
  const fact = (label, value) => nested("div", {}, [node("dt", {}, label), node("dd", {}, value)]);
  return [fact("phase", `${snapshot.phase}: ${snapshot.meaning}`), fact("stream's clock", snapshot.time), fact("samples", snapshot.samples),
    fact("runs", snapshot.runs)];
}
function row(estimate) {
  const name = node("th", {}, estimate.name);
  if (!estimate.is_identified) name.append(node("span", { class: "mark" }, "not identified"));
  const interval = estimate.half_width === "–" ? "–" : `[${estimate.lower}, ${estimate.upper}]`;
  return nested("tr", { class: estimate.is_identified ? "" : "unidentified" }, [name, node("td", { class: "num" }, estimate.value),
    node("td", { class: "num" }, interval), node("td", { class: "unit" }, estimate.unit), node("td", { class: "num" }, estimate.error_percent)]);
}
function counts(snapshot) {
  const line = ([label, number], kind) => nested("tr", { class: kind },
    [node("th", {}, label), node("td", { class: "num" }, number)]);
  return [line(["used", snapshot.accepted], ""), ...snapshot.faults.map(item => line(item, item[1] ? "some" : "none"))];
}
function finding(item) {
  const first = nested("p", {}, [node("span", { class: `severity ${item.severity}` }, item.severity), item.text]);
  return nested("div", { class: "finding" }, item.advice ? [first, node("p", { class: "caption" }, item.advice)] : [first]);
}
function renderText(snapshot) {
  renew(byId("facts"), [snapshot.phase, snapshot.time, snapshot.samples, snapshot.runs], () => facts(snapshot));
  renew(byId("rows"), snapshot.rows, () => snapshot.rows.map(row));
  renew(byId("counts"), [snapshot.accepted, snapshot.faults], () => counts(snapshot));
  renew(byId("findings"), snapshot.findings, () => snapshot.findings.map(finding));
  renew(byId("change"), snapshot.change, () => [node("p", {}, snapshot.change)]);
  renew(byId("unidentified"), [snapshot.unidentified, snapshot.advice], () => [
    node("p", {}, snapshot.unidentified.length ? `The data so far do not identify ${listed(snapshot.unidentified)}.` : "No estimate yet."),
    node("p", {}, snapshot.advice)]);
  renew(byId("proposal"), snapshot.proposal, () => snapshot.proposal.flatMap(([label, text]) => [node("dt", {}, label), node("dd", {}, text)]));
  byId("change").hidden = snapshot.change === "";
  byId("proposal").hidden = snapshot.proposal.length === 0;
  byId("unidentified").hidden = snapshot.unidentified.length === 0 && snapshot.advice === "";
  byId("next").hidden = byId("unidentified").hidden && byId("proposal").hidden;
  byId("findings_section").hidden = snapshot.findings.length === 0;
  byId("residuals").hidden = snapshot.noise.length === 0;
  byId("last").textContent = snapshot.last ? `Latest fault: ${snapshot.last}` : "";
  byId("body").hidden = false;
}
function renderPlots(snapshot) {
  const points = thinned(client.points), xs = points.map(p => p[1]);
  const values = points.map(p => p[2].map(v => v ?? NaN)), halves = points.map(p => p[3].map(h => h ?? NaN));
  const width = Math.max(340, byId("shares").clientWidth);
  byId("shares").replaceChildren(shares(width, snapshot.rows, xs, values, halves));
  byId("values").replaceChildren(...snapshot.rows.map((row, k) => {
    const scale = 10 ** row.power, both = row.half_width === "–" ? row.value : `${row.value} ± ${row.half_width}`;
    const now = `${row.power ? `(${both})` : both} ${row.unit}`.trim();
    return course(row.is_identified ? row.name : `${row.name}, not identified`, now, xs, values.map(v => v[k] / scale),
      halves.map(h => h[k] / scale), row.is_identified);
  }));
  byId("noise").replaceChildren(...snapshot.noise.map((channel, k) => course(
    channel.meaning ? `${channel.name}, ${channel.meaning}` : channel.name, `${channel.rms} ${channel.unit}`.trim(), xs,
    points.map(p => p[4][k] ?? NaN), xs.map(() => NaN), true)));
}

function say(kind, text) {
  byId("status").className = `sans ${kind}`;
  if (byId("status").textContent !== text) byId("status").textContent = text;
}
function status(state) {
  client.isOver = state.is_over;
  if (state.is_over) return say("over", `the stream has ended${state.reason ? `: ${state.reason}` : ""}`);
  if (!state.snapshot) return say("", "no samples yet");
  return state.age > QUIET ? say("quiet", `no samples for ${Math.round(state.age)} s`) : say("following", "following");
}
// keeps what the server keeps: every stride-th point and the newest
function merge(state) {
  client.points.push(...state.points);
  const newest = client.points.at(-1);
  client.points = client.points.filter(p => p[0] % state.stride === 0 || p === newest);
}
async function ask() {
  const since = client.points.length ? client.points.at(-1)[0] : -1;
  const answer = await fetch(`/state.json?since=${since}`, { cache: "no-store" });
  if (!answer.ok) throw new Error(`state ${answer.status}`);
  return answer.json();
}
async function turn() {
  let state = await ask();
  if (state.epoch !== client.epoch) {
    client.points = [];
    state = await ask();
    client.epoch = state.epoch;
  }
  merge(state);
  status(state);
  if (state.title) byId("title").textContent = state.title;
  document.title = state.title ? `${state.title} · seatrial` : "seatrial";
  if (state.snapshot) {
    renderText(state.snapshot);
    if (state.points.length) { renderRecent(state.recent); renderPlots(state.snapshot); }
  }
}
async function follow() {
  try { await turn(); } catch { if (!client.isOver) say("gone", "seatrial no longer answers; these are its last numbers"); }
  setTimeout(follow, PERIOD);
}
follow();
