// Curves over time and tracks: drawn from the workspace's numbers, dragged over to choose a stretch.
import { button, digits, h, s } from "./dom.js";

const LARGEST = 65534, GAP = 65535, HEIGHT = 112, TRACK = 300;
const style = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const dark = matchMedia("(prefers-color-scheme: dark)");
const drawn = new Set();
dark.addEventListener("change", () => { for (const plot of drawn) if (plot.root.isConnected) plot.redraw(false); else drawn.delete(plot); });
const ROLES = { train: "--accent", validate: "--warn", leave_out: "--soft" };

export function unpacked({ range: [low, high], codes }) {
  const bytes = Uint8Array.from(atob(codes), letter => letter.charCodeAt(0));
  const view = new DataView(bytes.buffer);
  return Array.from({ length: bytes.length / 2 }, (_, k) => {
    const code = view.getUint16(2 * k, true);
    return code === GAP ? null : low + (high - low) * code / LARGEST;
  });
}

export const evenly = (start, stop, count) => Array.from({ length: count }, (_, k) => start + (stop - start) * k / Math.max(1, count - 1));

// one panel: series = [{ name, values, colour, dash, isEdge }]; edges bound a band and are not read out
export function panel(node, label, time, series, { sync, spans = () => [], onSelect, height = HEIGHT, range, bands = [], padding = [6, 14, 0, 0], yAxis = {}, drawn: draw } = {}) {
  const readout = h("p", { class: "readout" }, h("b", {}, label), " ", h("span"));
  const box = h("div", { class: "plot", role: "img", "aria-label": `${label} from ${digits(time[0])} to ${digits(time.at(-1))} s` }, readout);
  node.append(box);
  const values = (u, k) => series.flatMap((one, place) => one.isEdge ? [] : `${one.name ? `${one.name} ` : ""}${digits(u.data[place + 1][k])}`).join(" · ");
  const colour = one => style((typeof one.colour === "function" ? one.colour() : one.colour) || "--ink");
  const grid = { stroke: () => style("--grid"), width: 1 };
  const axis = { stroke: () => style("--soft"), font: "10px Arial, sans-serif", grid, ticks: { show: false } };
  const plot = new uPlot({
    width: Math.max(200, box.clientWidth), height, legend: { show: false }, pxAlign: 0, padding,
    cursor: { sync: sync ? { key: sync, scales: ["x", null] } : undefined, drag: { x: true, y: false, setScale: !onSelect }, y: false, points: { size: 5 } },
    select: { show: true },
    scales: { x: { time: false }, y: range ? { range } : {} },
    axes: [{ ...axis, size: 18, gap: 3, values: (u, splits) => (u.named || plainly)(u, splits) }, { ...axis, size: 46, gap: 4, space: 24, ...yAxis }],
    bands: bands.map(pair => ({ series: pair, fill: () => style("--band") })),
    series: [{}, ...series.map(one => ({ stroke: () => one.isEdge && !one.colour ? "transparent" : colour(one), width: one.width || 1.2, dash: one.dash, points: { show: u => !one.isEdge && u.data[0].length < 3 } }))],
    hooks: {
      drawClear: [u => drawSpans(u, spans())],
      draw: draw ? [draw] : [],
      setCursor: [u => { readout.lastChild.textContent = u.cursor.idx == null ? u.now || "" : values(u, u.cursor.idx); }],
      setSelect: onSelect ? [u => u.select.width > 2 && onSelect(u.posToVal(u.select.left, "x"), u.posToVal(u.select.left + u.select.width, "x"))] : [],
    },
  }, [time, ...series.map(one => one.values)], box);
  plot.root.querySelector("canvas").setAttribute("aria-hidden", "true");
  new ResizeObserver(() => box.clientWidth && plot.setSize({ width: Math.max(200, box.clientWidth), height })).observe(box);
  drawn.add(plot);
  return plot;
}

const plainly = (_, splits) => splits.map(value => String(+value.toPrecision(12)));

// other numbers in a panel: columns = [time, ...values]; now: what is read out where no cursor is
export function setPanel(plot, { label, now, columns, xAxis }) {
  const [readout] = plot.root.parentNode.children, [title, text] = readout.children;
  Object.assign(plot, { now, named: xAxis });
  title.textContent = label;
  if (plot.cursor.idx == null) text.textContent = now;
  plot.root.parentNode.setAttribute("aria-label", now ? `${label}: ${now}` : label);
  plot.setData(columns);
}

function drawSpans(u, spans) {
  const { ctx, bbox } = u;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  for (const { start, stop, role, name } of spans) {
    const left = u.valToPos(start, "x", true), right = u.valToPos(stop, "x", true);
    ctx.globalAlpha = 0.14;
    ctx.fillStyle = style(ROLES[role]);
    ctx.fillRect(left, bbox.top, right - left, bbox.height);
    ctx.globalAlpha = 1;
    ctx.fillRect(left, bbox.top, devicePixelRatio, bbox.height);
    if (name && spans.length > 1 && ctx.measureText(name).width + 6 < right - left) ctx.fillText(name, left + 4, bbox.top + 11 * devicePixelRatio);
  }
  ctx.restore();
}

// tracks to scale, north up: lines = [{ north, east, colour, dash, width }]
export function track(lines, { onSelect, title = "track", hasCraft = false } = {}) {
  const points = lines.flatMap(one => one.east.map((x, k) => [x, one.north[k]])).filter(([x, y]) => x !== null && y !== null);
  if (!points.length) return h("p", { class: "note" }, "no track");
  const xs = points.map(p => p[0]), ys = points.map(p => p[1]);
  const [left, right, low, high] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  const size = Math.max(right - left, high - low) || 1, room = 0.06 * size, view = size + 2 * room;
  const x0 = (left + right) / 2 - view / 2, y0 = (low + high) / 2 + view / 2;
  const place = (x, y) => [(x - x0) / view * TRACK, (y0 - y) / view * TRACK];
  const path = (one, from = 0, to = one.east.length) => {
    let text = "", isUp = true;
    for (let k = from; k < to; k++) {
      if (one.east[k] === null || one.north[k] === null) { isUp = true; continue; }
      const [px, py] = place(one.east[k], one.north[k]);
      text += `${isUp ? "M" : "L"}${px.toFixed(1)} ${py.toFixed(1)}`;
      isUp = false;
    }
    return text;
  };
  const step = 10 ** Math.floor(Math.log10(view / 2)), scale = step * (view / step > 5 ? 2 : 1);
  const node = s("svg", { viewBox: `0 0 ${TRACK} ${TRACK}`, class: "track-map", role: "img", "aria-label": title });
  node.append(...lines.map(one => s("path", { d: path(one), class: `line ${one.kind || ""}` })));
  const picked = s("path", { class: "line picked" });
  node.append(picked, s("path", { class: "scale", d: `M10 ${TRACK - 10}h${(scale / view * TRACK).toFixed(1)}` }),
    s("text", { x: 10, y: TRACK - 15, class: "scale-text" }, `${digits(scale, 2)} m`), s("text", { x: TRACK - 24, y: 14, class: "scale-text" }, "N ↑"));
  if (hasCraft) {
    const [x, y] = place(...points.at(-1));
    node.append(s("circle", { class: "craft", cx: x.toFixed(1), cy: y.toFixed(1), r: 4 }));
  }
  node.pick = (from, to) => picked.setAttribute("d", to > from ? path(lines[0], from, to + 1) : "");
  if (onSelect) dragOver(node, lines[0], place, onSelect);
  return node;
}

function dragOver(node, line, place, onSelect) {
  let first = null;
  const nearest = event => {
    const box = node.getBoundingClientRect();
    const at = [(event.clientX - box.left) / box.width * TRACK, (event.clientY - box.top) / box.height * TRACK];
    let best = 0, least = Infinity;
    line.east.forEach((x, k) => {
      if (x === null) return;
      const [px, py] = place(x, line.north[k]), far = (px - at[0]) ** 2 + (py - at[1]) ** 2;
      if (far < least) [best, least] = [k, far];
    });
    return best;
  };
  const chosen = event => [first, nearest(event)].sort((a, b) => a - b);
  node.addEventListener("pointerdown", event => { first = nearest(event); node.setPointerCapture(event.pointerId); event.preventDefault(); });
  node.addEventListener("pointermove", event => first !== null && node.pick(...chosen(event)));
  node.addEventListener("pointerup", event => {
    const [from, to] = chosen(event);
    first = null;
    if (to > from) onSelect(from, to);
  });
}

// panels of a log with its runs, and its track; a stretch is chosen on either
export class LogPicture {
  constructor(node, series, onSelect) {
    this.series = series;
    this.time = evenly(series.start, series.stop, series.count);
    this.onSelect = onSelect;
    this.runs = series.runs;
    const plots = h("div", { class: "plots" });
    this.node = h("div", { class: "log-picture" }, plots);
    node.append(this.node);
    const spans = () => this.runs.filter(run => run.ends).map(run => ({ ...run, start: series.start + run.ends[0], stop: series.start + run.ends[1] }));
    this.plots = [];
    const draw = which => which.forEach(one => this.plots.push(panel(plots, one.label, this.time,
      one.curves.map(curve => ({ name: curve.name, values: unpacked(curve) })),
      { sync: `log-${series.log}`, spans, onSelect: (a, b) => this.choose(a - series.start, b - series.start, true) })));
    draw(series.panels.slice(0, 4));
    if (series.panels.length > 4) {
      const more = button(`All ${series.panels.length} channels`, () => { more.remove(); draw(series.panels.slice(4)); });
      this.node.append(more);
    }
    if (series.track) {
      this.line = { north: unpacked(series.track.north), east: unpacked(series.track.east) };
      const share = series.duration / Math.max(1, this.line.east.length - 1);
      this.map = track([this.line], { onSelect: (from, to) => this.choose(from * share, to * share, true), title: `track of ${series.log}; drag along it to choose a stretch` });
      this.node.prepend(h("div", { class: "map" }, this.map));
      this.share = share;
    }
  }
  choose(start, stop, isDragged = false) {
    const { series } = this;
    [start, stop] = [Math.max(0, start), Math.min(series.duration, stop)];
    this.map?.pick?.(Math.round(start / this.share), Math.round(stop / this.share));
    for (const plot of this.plots) {
      const left = plot.valToPos(series.start + start, "x"), right = plot.valToPos(series.start + stop, "x");
      plot.setSelect({ left, width: right - left, top: 0, height: plot.over.clientHeight }, false);
    }
    if (isDragged) this.onSelect(start, stop);
  }
}
