// Craft and model: each number with where it comes from, a drawing with what to measure, what is estimated.
import { ask } from "./api.js";
import { button, digits, field, h, input, s, section, select } from "./dom.js";

const SIZES = [["length", "Length between perpendiculars", "m", "L"], ["beam", "Beam at the waterline", "m", "B"], ["draught", "Draught", "m", "d"], ["mass", "Mass, displacement", "kg", "m"],
  ["rho", "Density of the water", "kg/m³", "rho"], ["propeller", "Diameter of the propeller", "m", "D_P"], ["rudder", "Area of the rudder", "m²", "A_R"], ["gm", "Metacentric height", "m", "GM"],
  ["gear", "Turns of the engine for one of the propeller", "", ""], ["scale", "Scale of a model, 40 for 1:40", "", "scale"]];
const TITLES = { ship: "Ship", model: "Model", "model.fixed": "Values held fixed", estimate: "How it is estimated", noise: "Noise of the sensors", sensors: "Sensors", excitation: "Forces of waves" };
const titleOf = place => TITLES[place.join(".")] || (place[0] === "thruster" ? `Thruster ${place[1] + 1}` : `Waves of block ${place[1] + 1}`);

export async function showCraft(node, app) {
  node.append(h("h1", {}, "Craft and model"));
  if (!app.state.exists) { node.append(h("p", {}, "First draft a trial file from logs, in the view Logs.")); return; }
  const { tables, model, parameters, models, problem } = await ask("craft");
  if (problem) node.append(h("p", { class: "message bad" }, problem));
  const ship = Object.fromEntries(tables[0].rows.map(row => [row.key, row]));
  const estimated = tables.flatMap(({ place, rows }) => rows.filter(row => ["estimated", "assumed"].includes(row.standing)).map(row => place[0] === "ship" ? row.key : `${row.key} of ${titleOf(place).toLowerCase()}`));
  node.append(h("p", {}, estimated.length ? `${estimated.length} numbers are estimated by a rule and marked: ${estimated.join(", ")}. Measured ones make the model better.` : "No number is a guess by a rule."));
  node.append(section("What to measure", h("div", { class: "measure" }, drawing(ship), sizeForm(app, ship))));
  for (const { place, rows } of tables) if (rows.length) node.append(section(titleOf(place), valueTable(app, place, rows, models, model)));
  if (parameters.length) node.append(section("Coefficients", parameterTable(app, parameters)));
}

function sizeForm(app, ship) {
  const controls = SIZES.map(([key, label, unit, symbol]) => {
    const row = ship[symbol], isKnown = row && !["estimated", "assumed"].includes(row.standing);
    const control = input("number", isKnown ? row.value : "", { min: 0, step: "any", name: key, placeholder: row && !isKnown ? `${digits(row.value)} estimated` : "" });
    return field(label, control, unit);
  });
  const status = h("p", { role: "status" });
  return h("form", { class: "sizes", onsubmit: async event => {
    event.preventDefault();
    const sizes = Object.fromEntries([...event.target.elements].filter(one => one.name && one.value !== "").map(one => [one.name, +one.value]));
    status.textContent = "Working out the rest …";
    await app.edit({ kind: "draft", sizes, name: typeof ship.name?.value === "string" ? ship.name.value : "" });
    status.textContent = "";
  } }, controls, h("p", { class: "tools-row" }, h("button", { type: "submit", class: "main" }, "Work out the rest from these")),
    h("p", { class: "note" }, "What is left empty is estimated again by published rules. Columns, runs and what you set by hand stay."), status);
}

function drawing(ship) {
  const guessed = key => !ship[key] || ["estimated", "assumed"].includes(ship[key].standing);
  const label = (key, x, y, anchor = "middle") => s("text", { x, y, "text-anchor": anchor, class: guessed(key) ? "guess" : "known" },
    `${key}${ship[key] && typeof ship[key].value === "number" ? ` ${digits(ship[key].value, 3)}` : ""}${guessed(key) ? (ship[key] ? " estimated" : "") : ""}`);
  const line = d => s("path", { d, class: "dimension" });
  return s("svg", { viewBox: "0 0 420 250", class: "drawing", role: "img", "aria-label": "side and plan of a ship with the dimensions to measure: length, beam, draught, rudder area, propeller, antenna" },
    s("path", { class: "hull", d: "M40 60 L60 100 H350 Q380 90 390 50 H330 L325 40 H250 V25 H200 V40 H120 V60 Z" }), s("path", { class: "water", d: "M20 75 H410" }),
    s("path", { class: "hull", d: "M38 78 h12 v22 h-12 z" }), s("circle", { class: "hull", cx: 58, cy: 92, r: 6 }),
    line("M45 118 H385 M45 113 v10 M385 113 v10"), label("L", 215, 132), line("M398 75 V100 M393 75 h10 M393 100 h10"), label("d", 388, 92, "end"),
    label("A_R", 10, 112, "start"), label("D_P", 70, 112, "start"), s("circle", { class: "antenna", cx: 225, cy: 20, r: 3 }), s("text", { x: 233, y: 16, class: "known" }, "antenna"),
    s("path", { class: "hull", d: "M45 190 Q45 165 75 165 H310 Q360 170 392 190 Q360 210 310 215 H75 Q45 215 45 190 Z" }), line("M150 165 V215 M145 165 h10 M145 215 h10"), label("B", 165, 194, "start"),
    s("path", { class: "water", d: "M218 160 V220" }), s("text", { x: 218, y: 234, "text-anchor": "middle", class: "known" }, "midship"), s("circle", { class: "antenna", cx: 250, cy: 190, r: 3 }), label("x_G", 258, 194, "start"));
}

function valueTable(app, place, rows, models, model) {
  return h("div", { class: "scroll" }, h("table", { class: "whole values" }, h("thead", {}, h("tr", {}, ["", "Value", "Standing", "From"].map(text => h("th", { scope: "col" }, text)))),
    h("tbody", {}, rows.map(row => h("tr", { class: row.standing === "by hand" ? "held" : "" }, h("th", { scope: "row" }, row.key), h("td", {}, valueControl(app, [...place, row.key], row, models, model)),
      h("td", {}, h("span", { class: `badge ${row.standing.replace(" ", "-")}` }, row.standing === "estimated" ? "ESTIMATED" : row.standing === "assumed" ? "ASSUMED" : row.standing)), h("td", { class: "because" }, row.reason))))));
}

function inWords(value) {
  if (Array.isArray(value)) return value.map(inWords).join("; ");
  return typeof value === "object" ? Object.entries(value).map(([key, one]) => `${key} ${inWords(one)}`).join(", ") : String(value);
}

function valueControl(app, place, row, models, model) {
  const { value } = row, name = place.join(".");
  const change = next => app.edit({ kind: "set", place, value: next });
  if (name === "model.name") return select(models.map(one => one.name), model, change, { "aria-label": "model" });
  if (typeof value === "number") return h("input", { type: "number", step: "any", value: String(value), "aria-label": name, id: `value-${name}`, onchange: event => event.target.value !== "" && change(+event.target.value) });
  if (typeof value === "boolean") return h("input", { type: "checkbox", checked: value, "aria-label": name, onchange: event => change(event.target.checked) });
  if (typeof value === "string") return h("input", { type: "text", value, "aria-label": name, onchange: event => change(event.target.value) });
  if (typeof value?.value === "number" && Object.keys(value).every(key => ["value", "unit"].includes(key))) {
    return [h("input", { type: "number", step: "any", value: String(value.value), "aria-label": name, id: `value-${name}`, onchange: event => event.target.value !== "" && change({ ...value, value: +event.target.value }) }), " ", h("span", { class: "u" }, value.unit)];
  }
  return h("span", {}, inWords(value));
}

function parameterTable(app, parameters) {
  const free = () => [...document.querySelectorAll(".is-free:checked")].map(box => box.value);
  const rows = which => h("div", { class: "scroll" }, h("table", { class: "whole" }, h("thead", {}, h("tr", {}, ["Estimated", "Coefficient", "Meaning", "Value", "From"].map(text => h("th", { scope: "col" }, text)))), h("tbody", {}, which.map(row))));
  const row = p => h("tr", {}, h("td", {}, h("input", { type: "checkbox", class: "is-free", value: p.name, checked: p.free, "aria-label": `estimate ${p.name}` })), h("th", { scope: "row" }, h("code", {}, p.name)), h("td", {}, p.meaning),
    h("td", { class: "num" }, p.value === null ? "missing" : digits(p.value), " ", h("span", { class: "u" }, p.unit)), h("td", { class: "because" }, p.source));
  const [estimated, held] = [parameters.filter(p => p.free), parameters.filter(p => !p.free)];
  return [h("p", { class: "note" }, "Ticked coefficients are estimated from the runs; the others are held at the value that stands here."),
    rows(estimated), h("details", {}, h("summary", {}, `${held.length} that are held, or have no part`), rows(held)),
    button("Estimate the ticked ones", () => app.edit({ kind: "set", place: ["model", "free"], value: free() }))];
}
