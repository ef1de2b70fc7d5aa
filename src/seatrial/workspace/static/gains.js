// Gains: those under the hand with margins, step and sea at once; a tuning started, watched, its gains taken.
import { ask, latest } from "./api.js";
import { evenly, panel, unpacked } from "./charts.js";
import { button, digits, field, h, input, section, select } from "./dom.js";
import { jobList, reportFrame } from "./fits.js";

const STEPS = 400;
let chosenLoop = "", openTuning = "";
const kept = new Map();

export async function showGains(node, app) {
  node.append(h("h1", {}, "Gains"));
  const [{ loops }, { fits }] = await Promise.all([ask("loops"), ask("fits")]);
  const done = fits.filter(fit => fit.state === "done");
  const fit = done.find(one => one.name === app.chosenFit) || done.at(-1);
  const speed = input("number", "", { min: 0, step: "any", placeholder: "m/s", "aria-label": "speed of the craft in m/s, which its model does not state" });
  if (fit && !loops.includes("autopilot.toml")) node.append(h("p", { class: "tools-row" }, button(`Begin an autopilot for ${fit.name}`, async () => {
    try {
      chosenLoop = (await ask("autopilot", { fit: fit.name, speed: speed.value === "" ? null : +speed.value })).loop;
      await app.refresh();
    } catch (error) { app.note(error.message, "bad"); }
  }), fit.speed === null && h("label", {}, "at a speed of ", speed)));
  if (!loops.length) { node.append(h("p", {}, "There is no loop file in the folder: it says what is controlled, by what, and what must be kept. Begin an autopilot for a fit, or write one.")); return; }
  if (!loops.includes(chosenLoop)) chosenLoop = loops[0];
  const models = [["", "that of the loop file"], ...done.map(one => [one.name, one.name])];
  const model = select(models, app.loopFit || "", name => { app.loopFit = name; app.refresh(); });
  node.append(h("div", { class: "fields" }, field("Loop", select(loops, chosenLoop, name => { chosenLoop = name; app.refresh(); })), field("Model", model)));
  let loop;
  try { loop = await ask("loop", { loop: chosenLoop, fit: app.loopFit || "" }); } catch (error) { node.append(h("p", { class: "message bad" }, error.message)); return; }
  const key = `${chosenLoop} ${app.loopFit || ""}`, gains = kept.get(key) || Object.fromEntries(loop.gains.map(one => [one.name, one.value]));
  kept.set(key, gains);
  const picture = h("div", { class: "gains-picture" });
  const draw = latest(async () => {
    try {
      const began = performance.now(), answer = await ask("gains", { loop: chosenLoop, fit: app.loopFit || "", gains });
      show(picture, answer, Math.round(performance.now() - began));
    } catch (error) { picture.replaceChildren(h("p", { class: "bad" }, error.message)); }
  });
  const rows = loop.gains.map(one => slider(one, gains, draw));
  const take = values => { Object.assign(gains, values); for (const row of rows) row.reset(); draw(); };
  node.append(h("div", { class: "bench" }, picture, h("div", { class: "sliders" }, h("h2", {}, loop.name), rows.map(row => row.node),
    h("p", { class: "tools-row" }, button("As the loop file begins", () => take(Object.fromEntries(loop.gains.map(one => [one.name, one.value])))), loop.tuned.map(one => button(`As ${one.name} chose`, () => take(one.gains)))))));
  const start = async () => { try { await ask("start-tuning", { loop: chosenLoop, fit: app.loopFit || "" }); await app.refresh(); } catch (error) { app.note(error.message, "bad"); } };
  node.append(section("Tune", h("p", {}, button("Start the tuning", start, { class: "main" }), " finds the gains that keep every limit, and says why."), jobList(app, "tuning")));
  if (loop.tuned.length) node.append(h("p", { class: "tools-row" }, loop.tuned.map(one => button(`Report of ${one.name}`, () => { openTuning = one.name; app.refresh(); }))));
  if (loop.tuned.some(one => one.name === openTuning)) node.append(section(`Report of ${openTuning}`, reportFrame(openTuning)));
  node.addEventListener("shown", draw, { once: true });
}

// the slider's way is the square root of the gain: small gains need the finer hand
function slider(one, gains, draw) {
  const control = input("range", "", { min: 0, max: STEPS, step: 1 }), output = h("output", {});
  const value = () => one.low + (one.high - one.low) * (control.value / STEPS) ** 2;
  const say = () => { output.textContent = `${digits(gains[one.name], 3)} ${one.unit}`; control.setAttribute("aria-valuetext", output.textContent); };
  control.addEventListener("input", () => { gains[one.name] = value(); say(); draw(); });
  const node = field(`${one.name} ${one.meaning}`, control);
  node.classList.add("slider");
  const reset = () => { control.value = Math.round(STEPS * Math.sqrt(Math.max(0, (gains[one.name] - one.low) / (one.high - one.low)))); say(); };
  reset();
  node.append(output, h("span", { class: "u" }, `${digits(one.low, 3)} to ${digits(one.high, 3)}`));
  return { node, reset };
}

function show(node, { facts, violated, stable, step, sea }, time) {
  const curves = (title, one) => {
    const box = h("div", { class: "plots" });
    const at = evenly(...one.time, one.count);
    const [output, ...rest] = one.curves, beside = rest.filter(curve => curve.label === output.label);
    queueMicrotask(() => {
      panel(box, output.label, at, [...beside.map(curve => ({ values: unpacked(curve.values), name: curve.name, colour: "--soft", width: 2 })), { values: unpacked(output.values), colour: "--accent", width: 1.4 }]);
      for (const curve of rest.filter(curve => !beside.includes(curve))) panel(box, curve.label, at, [{ values: unpacked(curve.values), colour: "--ink" }]);
    });
    return section(title, h("p", { class: "note" }, one.text), box);
  };
  node.replaceChildren(h("p", { class: "note", role: "status" }, `computed in ${time} ms`), ...violated.map(text => h("p", { class: "message bad" }, text)),
    stable ? h("dl", { class: "facts" }, facts.flatMap(fact => [h("dt", {}, fact.name), h("dd", { class: fact.good === false ? "bad" : fact.good ? "good" : "" }, fact.text)])) : "",
    ...[step && curves("Step", step), sea && curves("In the sea", sea)].filter(Boolean));
}
