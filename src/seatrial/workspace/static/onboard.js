// On board: a source that grows, and what its follower reports of it, drawn as it comes.
import { ask } from "./api.js";
import { panel, setPanel, track } from "./charts.js";
import { button, field, h, input, section } from "./dom.js";
import { jobList, reportFrame } from "./fits.js";

const QUIET = 5, DRAWN = 400, LABELS = 16, LABEL_PX = 12, Z95 = 1.96, SHARES_PX = 270, COURSE_PX = 130;

export async function showOnBoard(node, app) {
  node.append(h("h1", {}, "On board"));
  if (!app.state.exists) { node.append(h("p", {}, "First draft a trial file from logs, in the view Logs.")); return; }
  if (!/^\[follow\]/m.test(app.state.text)) { node.append(...sourceForm(app)); return; }
  const early = [];
  let view = null;
  app.on("onboard", content => {
    view?.find();
    view ? view.take(content) : early.push(content);
  });
  const stream = await ask("onboard"), isFollowed = "name" in stream && !stream.is_over;
  node.append(stream.name === "" ? h("p", { class: "note" }, "The command in the terminal follows the stream; Ctrl-C there ends it.") : controls(app, isFollowed), jobList(app, "follow"));
  if ("name" in stream) {
    view = new StreamView(node);
    for (const content of [stream, ...early]) view.take(content);
    app.on("hello", async () => {
      view.find();
      view.take(await ask("onboard"));
    });
    app.on("gone", isOther => view.lose(isOther));
  }
  const last = [...app.jobs.values()].filter(job => job.kind === "follow" && job.state === "done").at(-1);
  if (last && !isFollowed) {
    const { fits } = await ask("fits");
    if (fits.some(fit => fit.name === last.name && fit.has_report)) node.append(section(`Report of ${last.name}`, reportFrame(last.name)));
    else node.append(h("p", { class: "note" }, `The last estimate lies in ${last.name}/online.json.`));
  }
}

function sourceForm(app) {
  const file = input("text", "", { placeholder: "today.csv" });
  return [h("p", {}, "A table [follow] in the trial file says where samples come from: a file that grows, NMEA 0183 or 2000, MAVLink, UDP. The simplest is a file in the folder, with the columns of the records, read as its logger writes it."),
    h("div", { class: "fields" }, field("File that grows", file), button("Follow it", () => app.edit({ kind: "follow", block: 0, file: file.value }), { class: "main" }))];
}

function controls(app, isFollowed) {
  const once = input("checkbox", "1");
  const start = async () => {
    try { await ask("start-follow", { once: once.checked }); await app.refresh(); } catch (error) { app.note(error.message, "bad"); }
  };
  return h("p", { class: "tools-row" }, button("Follow", start, { class: "main", disabled: isFollowed }), h("label", { class: "check" }, once, " end with the input, with the fit of identify"));
}

// what has not changed stays, so that it can be selected
function renew(place, key, children) {
  const signature = JSON.stringify(key);
  if (place.signature === signature) return;
  place.signature = signature;
  place.replaceChildren(...[children()].flat(Infinity).filter(Boolean));
}

// a unit in which a time is short: [s, name]
function clock(longest) {
  if (longest < 180) return [1, "s"];
  if (longest < 3 * 3600) return [60, "min"];
  return longest < 3 * 86400 ? [3600, "h"] : [86400, "d"];
}
const named = unit => (_, splits) => splits.map((value, k) => `${+value.toFixed(6)}${k === splits.length - 1 ? ` ${unit}` : ""}`);
const listed = names => names.length < 2 ? names.join("") : `${names.slice(0, -1).join(", ")} and ${names.at(-1)}`;

// the newest report of a stream and all its points: words at once, curves beside one another
class StreamView {
  constructor(node) {
    const box = kind => h("div", { class: kind });
    Object.assign(this, { at: -1, points: [], report: {}, isLost: false, courses: new Map(), status: h("p", { class: "status sans", role: "status" }), title: h("h2"),
      facts: h("dl", { class: "facts" }), change: box("message bad change"), next: box("next"), recent: box("courses recent"), rows: h("tbody", { class: "rows" }), counts: h("tbody", { class: "counts" }),
      last: h("p", { class: "note last" }), shares: box("shares"), values: box("courses values"), noise: box("courses noise"), findings: box("stream-findings") });
    const head = ["coefficient", "value", "95 % interval", "unit", "std. error, %"].map((text, k) => h("th", { scope: "col", class: k % 2 || k === 2 || k === 4 ? "num" : "" }, text));
    this.body = h("div", { class: "stream-body" },
      h("div", { class: "bench" }, section("Coefficients", h("div", { class: "scroll" }, h("table", { class: "whole" }, h("thead", {}, h("tr", {}, head)), this.rows))),
        section("Samples", h("table", { class: "whole" }, this.counts), this.last)),
      section("Convergence", this.shares, h("p", { class: "note" }, "Standard error of each coefficient in per cent of its value."), this.values,
        h("p", { class: "note" }, "Value (line) and 95 % interval (band) over the time followed. Axes show where the values are now; what lies far outside is cut off.")),
      this.residuals = section("Measured minus simulated", this.noise, h("p", { class: "note" }, "Root mean square of the residuals of each channel.")),
      this.found = section("Findings", this.findings));
    this.node = h("div", { class: "stream" }, this.title, this.status, this.facts, this.change, this.next, this.recent, this.body);
    node.append(this.node);
    node.addEventListener("shown", () => {
      this.drawSoon();
      const watch = setInterval(() => this.node.isConnected ? this.say() : clearInterval(watch), 1000);
    });
  }
  // once a frame at most, and not in a window that nobody sees
  drawSoon() {
    if (this.isDue) return;
    this.isDue = true;
    requestAnimationFrame(() => {
      this.isDue = false;
      if (this.node.isConnected) this.draw();
    });
  }
  // a whole answer, or one report; what left before another one came changes nothing
  take({ points, point, ...content }) {
    if (content.at < this.at) return;
    const isSame = content.epoch === this.report.epoch, { stride } = content;
    if (points) this.points = points;
    else if (point) this.points = [...(isSame ? this.points.filter(one => one[0] % stride === 0 && one[0] < point[0]) : []), point];
    Object.assign(this, { at: content.at, report: { ...this.report, ...content }, since: performance.now() });
    this.say();
    this.drawSoon();
  }
  // only the line itself says that it stands: an answer may have left before it broke
  find() {
    this.isLost = false;
    this.say();
  }
  lose(isOther) {
    Object.assign(this, { isLost: true, isOther });
    this.say();
  }
  say() {
    const { is_over: isOver, reason, snapshot, age } = this.report, silence = age + (performance.now() - this.since) / 1000;
    const [kind, text] = isOver ? ["over", `the stream has ended${reason ? `: ${reason}` : ""}`]
      : this.isLost ? ["gone", this.isOther ? "seatrial was started again: open the address that the terminal shows; these are the last numbers" : "seatrial no longer answers; these are its last numbers"]
        : !snapshot ? ["", "no samples yet"] : silence > QUIET ? ["quiet", `no samples for ${Math.round(silence)} s`] : ["following", "following"];
    this.status.className = `status sans ${kind}`;
    if (this.status.textContent !== text) this.status.textContent = text;
  }
  draw() {
    const { snapshot, title = "" } = this.report;
    this.title.textContent = title;
    for (const part of [this.body, this.facts, this.change, this.next, this.recent]) part.hidden = !snapshot;
    if (!snapshot) return;
    this.drawWords(snapshot);
    this.drawRecent(this.report.recent);
    this.drawCourses(snapshot);
  }
  drawWords(snapshot) {
    const { phase, meaning, time, samples, runs, unidentified, advice, proposal } = snapshot;
    renew(this.facts, [phase, meaning, time, samples, runs], () => [["phase", `${phase}: ${meaning}`], ["stream's clock", time], ["samples", samples], ["runs", runs]].map(([label, value]) => [h("dt", {}, label), h("dd", {}, String(value))]));
    renew(this.change, snapshot.change, () => h("p", {}, snapshot.change));
    renew(this.next, [unidentified, advice, proposal], () => [h("h2", {}, "What to do next"),
      proposal.length > 0 && h("dl", { class: "message proposal" }, proposal.map(([label, text]) => [h("dt", {}, label), h("dd", {}, text)])),
      (unidentified.length > 0 || advice) && h("div", { class: "message unidentified" }, h("p", {}, unidentified.length ? `The data so far do not identify ${listed(unidentified)}.` : "No estimate yet."), h("p", {}, advice))]);
    renew(this.rows, snapshot.rows, () => snapshot.rows.map(row => h("tr", { class: row.is_identified ? "" : "warned" }, h("th", { scope: "row" }, row.name, !row.is_identified && h("span", { class: "badge" }, "not identified")),
      h("td", { class: "num" }, row.value), h("td", { class: "num" }, row.half_width === "–" ? "–" : `[${row.lower}, ${row.upper}]`), h("td", { class: "u" }, row.unit), h("td", { class: "num" }, row.error_percent))));
    renew(this.counts, [snapshot.accepted, snapshot.faults], () => [["used", snapshot.accepted], ...snapshot.faults].map(([label, count], k) => h("tr", { class: k === 0 ? "" : count ? "warned" : "soft" }, h("th", { scope: "row" }, label), h("td", { class: "num" }, String(count)))));
    renew(this.findings, snapshot.findings, () => snapshot.findings.map(one => h("div", { class: "finding" }, h("p", {}, h("span", { class: `severity ${one.severity}` }, one.severity), one.text), one.advice && h("p", { class: "note" }, one.advice))));
    this.last.textContent = snapshot.last ? `Latest fault: ${snapshot.last}` : "";
    this.change.hidden = snapshot.change === "";
    this.next.hidden = !(unidentified.length || advice || proposal.length);
    this.found.hidden = snapshot.findings.length === 0;
    this.residuals.hidden = snapshot.noise.length === 0;
  }
  // the run so far: its track, and rudder and heading or the first channels that move
  drawRecent({ track: places, channels }) {
    const hasTrack = places?.x0.some((x, k) => x !== null && places.y0[k] !== null);
    this.recent.hidden = !hasTrack && !channels.length;
    this.keep(this.recent, [hasTrack, channels.map(one => one.label)], () => [hasTrack && h("div", { class: "map" }), ...channels.map(() => h("div"))]);
    if (hasTrack) this.recent.querySelector(".map").replaceChildren(track([{ north: places.x0, east: places.y0 }], { title: "track from above, north up", hasCraft: true }));
    [...this.recent.children].slice(hasTrack ? 1 : 0).forEach((node, k) => {
      const { label, time, values } = channels[k], latest = values.findLast(value => value !== null);
      this.course(node, label, latest === undefined ? "–" : latest.toPrecision(3).replace("-", "−"), time, values);
    });
  }
  drawCourses({ rows, noise }) {
    const step = Math.ceil(this.points.length / DRAWN), points = this.points.filter((_, k) => k % step === 0 || k === this.points.length - 1), xs = points.map(point => point[1]);
    const scaled = (values, by) => values.map(value => value === null ? null : value / by);
    this.keep(this.values, rows.map(row => row.name), () => rows.map(() => h("div")));
    rows.forEach((row, k) => {
      const scale = 10 ** row.power, both = row.half_width === "–" ? row.value : `${row.value} ± ${row.half_width}`;
      this.course(this.values.children[k], row.is_identified ? row.name : `${row.name}, not identified`, `${row.power ? `(${both})` : both} ${row.unit}`.trim(), xs,
        scaled(points.map(point => point[2][k]), scale), scaled(points.map(point => point[3][k]), scale));
    });
    this.keep(this.noise, noise.map(one => one.name), () => noise.map(() => h("div")));
    noise.forEach((one, k) => this.course(this.noise.children[k], one.meaning ? `${one.name}, ${one.meaning}` : one.name, `${one.rms} ${one.unit}`.trim(), xs, points.map(point => point[4][k] ?? null), points.map(() => null)));
    this.drawShares(rows, points, xs);
  }
  // other curves than before: their panels are made anew
  keep(place, key, children) { renew(place, [this.report.epoch, key], children); }
  // a value with its band; the axis covers the later values and the interval as it is now
  course(node, title, now, time, values, halves = null) {
    const [size, unit] = clock(time.at(-1) ?? 0), xs = time.map(t => t / size), from = halves ? 0.2 * (xs.at(-1) ?? 0) : -Infinity;
    const last = values.at(-1), half = halves?.at(-1), every = values.filter((v, k) => v !== null && (xs[k] >= from || values.length < 5));
    if (last !== null && Number.isFinite(half)) every.push(last - 1.5 * half, last + 1.5 * half);
    const low = Math.min(...every), high = Math.max(...every), room = high > low ? 0.06 * (high - low) : 0.05 * Math.abs(low) || 1;
    const edge = sign => halves ? halves.map((one, k) => one === null || values[k] === null ? null : values[k] + sign * one) : values.map(() => null);
    const columns = [edge(1), edge(-1), values];
    node.range = every.length ? [low - room, high + room] : [0, 1];
    node.plot ||= panel(node, title, xs, [{ isEdge: true, values: columns[0] }, { isEdge: true, values: columns[1] }, { colour: "--accent", width: 1.5, values }],
      { height: COURSE_PX, range: () => node.range, bands: [[1, 2]] });
    setPanel(node.plot, { label: title, now, xAxis: named(unit), columns: [xs, ...columns] });
  }
  // standard errors in per cent of values, logarithmic, named at their ends
  drawShares(rows, points, time) {
    const place = this.shares, [size, unit] = clock(time.at(-1) ?? 0), xs = time.map(t => t / size);
    const lines = rows.map((_, k) => points.map(point => {
      const share = Math.log10(100 * point[3][k] / Z95 / Math.abs(point[2][k]));
      return point[3][k] === null || !Number.isFinite(share) ? null : share;
    }));
    const later = lines.flatMap(line => line.filter((y, k) => y !== null && (points.length < 5 || xs[k] >= 0.2 * xs.at(-1))));
    const low = later.length ? Math.floor(Math.min(...later.map(y => Math.max(y, -4))) + 1e-9) : 0, high = later.length ? Math.min(3, Math.max(low + 1, Math.ceil(Math.max(...later)))) : 2;
    const ended = rows.map((row, k) => ({ name: row.name, end: lines[k].at(-1), k })).filter(one => Number.isFinite(one.end)).sort((a, b) => b.end - a.end);
    Object.assign(place, { range: [low, high], decades: Array.from({ length: high - low + 1 }, (_, k) => low + k), labelled: ended.slice(0, LABELS), worst: ended[0]?.k });
    this.keep(place, rows.map(row => row.name), () => h("div"));
    const [node] = place.children;
    node.plot ||= panel(node, "", xs, lines.map((values, k) => ({ isEdge: true, colour: () => place.worst === k ? "--bad" : "--soft", width: 1.2, values })),
      { height: SHARES_PX, range: () => place.range, padding: [6, 110, 0, 0], drawn: u => drawNames(u, place.labelled), yAxis: { splits: () => place.decades, values: (_, splits) => splits.map(y => `${+(10 ** y).toPrecision(1)} %`) } });
    setPanel(node.plot, { label: "", now: "", xAxis: named(unit), columns: [xs, ...lines] });
    node.firstChild.setAttribute("aria-label", `standard errors in per cent of the values: ${rows.map(row => `${row.name} ${row.error_percent}`).join(", ")}`);
  }
}

// names at the ends of lines, apart from one another
function drawNames(u, labelled) {
  const { ctx, bbox } = u, ratio = devicePixelRatio, right = bbox.left + bbox.width, room = Math.min(LABEL_PX * ratio, bbox.height / Math.max(1, labelled.length));
  const style = getComputedStyle(document.documentElement);
  ctx.save();
  ctx.font = `${10.5 * ratio}px Arial, sans-serif`;
  ctx.textAlign = "left";
  ctx.textBaseline = "middle";
  let below = bbox.top - room;
  labelled.forEach(({ name, end }, k) => {
    const at = Math.max(bbox.top, Math.min(bbox.top + bbox.height, u.valToPos(end, "y", true)));
    const y = Math.min(Math.max(at, below + room), bbox.top + bbox.height - (labelled.length - 1 - k) * room);
    below = y;
    ctx.strokeStyle = style.getPropertyValue("--line");
    ctx.beginPath();
    ctx.moveTo(right + ratio, at);
    ctx.lineTo(right + 14 * ratio, y);
    ctx.stroke();
    ctx.fillStyle = style.getPropertyValue(k ? "--soft" : "--bad");
    ctx.fillText(name, right + 17 * ratio, y, 90 * ratio);
  });
  ctx.restore();
}
