// What if: coefficients moved within their intervals, and any manoeuvre simulated at once.
import { ask, latest } from "./api.js";
import { evenly, panel, track, unpacked } from "./charts.js";
import { button, digits, field, h, input, section, select } from "./dom.js";
import { jobList, line } from "./fits.js";

const STEPS = 400;
const NAMES = { advance_L: "advance, L", transfer_L: "transfer, L", tactical_diameter_L: "tactical diameter, L", steady_diameter_L: "steady diameter, L", overshoot_1_deg: "1st overshoot, °", overshoot_2_deg: "2nd overshoot, °",
  approach_speed: "approach speed, m/s", time_90_s: "time to 90°, s", steady_yaw_rate_deg_s: "steady yaw rate, °/s", steady_drift_deg: "steady drift, °", speed_loss: "share of speed lost", rudder_deg: "rudder, °", period_s: "period, s",
  initial_turning_L: "initial turning, L", initial_turning_time_s: "initial turning time, s" };

export async function showWhatIf(node, app) {
  node.append(h("h1", {}, "What if"));
  const { fits } = await ask("fits");
  const done = fits.filter(fit => fit.state === "done" && fit.manoeuvres.length);
  if (!done.length) { node.append(h("p", {}, "There is no fit of a craft that is manoeuvred yet; start one in the view Fit.")); return; }
  const fit = done.find(one => one.name === app.chosenFit) || done.at(-1);
  app.chosenFit = fit.name;
  const values = new Map(), picture = h("div", { class: "whatif-picture", "aria-live": "off" }), status = h("p", { role: "status", class: "note" });
  const known = [...fit.manoeuvres, "other"];
  const other = input("text", "turning-circle:20", { "aria-label": "manoeuvre as seatrial simulate takes it", hidden: true });
  const manoeuvre = select(known.map(one => [one, one === "other" ? "another …" : one.replaceAll(":", " ")]), fit.manoeuvres[0], value => { other.hidden = value !== "other"; draw(); });
  const speed = input("number", "", { min: 0, step: "any", placeholder: fit.speed === null ? "" : `${digits(fit.speed, 3)} of the trials` });
  const draw = latest(async () => {
    const chosen = manoeuvre.value === "other" ? other.value : manoeuvre.value;
    try {
      const began = performance.now();
      const answer = await ask("simulate", { fit: fit.name, manoeuvre: chosen, values: Object.fromEntries(values), speed: speed.value === "" ? null : +speed.value });
      status.textContent = `${chosen}, simulated in ${Math.round(performance.now() - began)} ms`;
      status.className = "note";
      show(picture, answer);
    } catch (error) { status.textContent = error.message; status.className = "bad"; }
  });
  other.addEventListener("change", draw);
  speed.addEventListener("change", draw);
  const rows = fit.coefficients.filter(one => !one.fixed && one.low !== null && one.high !== null && one.high > one.low).map(one => slider(one, values, draw));
  const reset = button("All at their estimates", () => { values.clear(); for (const row of rows) row.reset(); draw(); });
  node.append(h("div", { class: "fields" }, field("Fit", select(done.map(one => one.name), fit.name, name => { app.chosenFit = name; app.refresh(); })), field("Manoeuvre", manoeuvre), other, field("Approach speed", speed, "m/s")),
    h("div", { class: "bench" }, h("div", {}, status, picture), h("div", { class: "sliders" }, h("h2", {}, "Coefficients"), rows.length ? [h("p", { class: "note" }, "Each moves within its 95 % interval. Coefficients that depend on one another would move together; single ones show what each does."), rows.map(row => row.node), reset] : h("p", { class: "note" }, "No coefficient has an interval."))),
    section("Poster and report", h("p", { class: "tools-row" }, button("Make the wheelhouse poster", async () => { try { await ask("start-poster", { fit: fit.name }); await app.refresh(); } catch (error) { app.note(error.message, "bad"); } }),
      h("a", { href: `/report/${fit.name}/report.html`, target: "_blank", rel: "noopener" }, "Report of the fit"), fit.has_poster && h("a", { href: `/report/${fit.name}/poster.html`, target: "_blank", rel: "noopener" }, "Poster")), jobList(app, "poster")));
  node.addEventListener("shown", draw, { once: true });
}

function slider(one, values, draw) {
  const control = input("range", "", { min: 0, max: STEPS, step: 1 }), output = h("output", {});
  const place = value => Math.round(STEPS * (value - one.low) / (one.high - one.low));
  const say = value => { output.textContent = `${digits(value)} ${one.unit}`; control.setAttribute("aria-valuetext", digits(value)); };
  const reset = () => { control.value = place(one.value); say(one.value); };
  control.addEventListener("input", () => {
    const value = one.low + (one.high - one.low) * control.value / STEPS;
    values.set(one.name, value);
    say(value);
    draw();
  });
  const node = field(`${one.name} ${one.meaning}`, control);
  node.classList.add("slider");
  control.setAttribute("value", place(one.value));
  reset();
  node.append(output, h("span", { class: "u" }, `95 %: ${one.interval}`));
  return { node, reset };
}

function show(node, { estimate, moved }) {
  const lines = [], measures = [...new Set([...Object.keys(estimate.measures), ...Object.keys(moved?.measures || {})])];
  if (estimate.track) lines.push(line(estimate, moved ? "measured" : "simulated"));
  if (moved?.track) lines.push(line(moved, "simulated"));
  const plots = h("div", { class: "plots" });
  node.replaceChildren(...[lines.length ? track(lines, { title: "track of the manoeuvre" }) : null, plots, measures.length ? measureTable(measures, estimate, moved) : null].filter(Boolean));
  estimate.curves.slice(0, 3).forEach((curve, k) => {
    const longer = moved && moved.time[1] > estimate.time[1] ? moved : estimate;
    const time = evenly(...longer.time, longer.count), on = (from, j) => resampled(evenly(...from.time, from.count), unpacked(from.curves[j].values), time);
    panel(plots, curve.label, time, [{ values: on(estimate, k), name: "estimate", colour: moved ? "--soft" : "--accent", width: moved ? 2.4 : 1.4 },
      ...(moved && moved.curves[k] ? [{ values: on(moved, k), name: "moved", colour: "--accent", dash: [5, 2.5] }] : [])]);
  });
}

function resampled(time, values, onto) {
  let k = 0;
  return onto.map(t => {
    while (k < time.length - 2 && time[k + 1] < t) k++;
    if (t > time.at(-1) || values[k] === null || values[k + 1] === null) return null;
    return values[k] + (values[k + 1] - values[k]) * (t - time[k]) / ((time[k + 1] - time[k]) || 1);
  });
}

function measureTable(names, estimate, moved) {
  return h("div", { class: "scroll" }, h("table", {}, h("thead", {}, h("tr", {}, ["Measure", "Estimate", ...(moved ? ["Moved"] : [])].map(text => h("th", { scope: "col" }, text)))),
    h("tbody", {}, names.map(name => h("tr", {}, h("th", { scope: "row" }, NAMES[name] || name.replaceAll("_", " ")), h("td", { class: "num" }, digits(estimate.measures[name])), moved && h("td", { class: "num" }, digits(moved.measures[name])))))));
}

