// Logs: dropped or found in the folder, their columns and what they are read as, runs, findings.
import { ask, upload } from "./api.js";
import { LogPicture } from "./charts.js";
import { button, digits, field, h, input, section, select } from "./dom.js";

const CHANNELS = [["", "not used"], ["time", "time"], ["lat", "latitude"], ["lon", "longitude"], ["x0", "north"], ["y0", "east"], ["psi", "heading"],
  ["r", "yaw rate"], ["u", "surge velocity"], ["v", "sway velocity"], ["sog", "speed over ground"], ["cog", "course over ground"], ["delta", "rudder"],
  ["n", "propeller rate"], ["phi", "roll"], ["theta", "pitch"], ["z", "heave"], ["zeta", "wave elevation"], ["wind_speed", "true wind speed"],
  ["wind_direction", "true wind direction"], ["command_1", "thruster 1"], ["command_2", "thruster 2"]];
const UNITS = { lat: "deg", lon: "deg", x0: "m", y0: "m", psi: "deg", r: "deg/s", u: "m/s", v: "m/s", sog: "kn", cog: "deg", delta: "deg", n: "rpm", phi: "deg",
  theta: "deg", z: "m", zeta: "m", wind_speed: "m/s", wind_direction: "deg", command_1: "1", command_2: "1" };
const ROLES = [["train", "fitted"], ["validate", "held out"], ["leave_out", "left out"]];
let chosenLog = "", isAdding = false;

export async function showLogs(node, app) {
  const { state } = app;
  if (!state.exists) {
    node.append(h("h1", {}, "Logs"), dropZone(app), await draftForm(app, true));
    return;
  }
  const { blocks, problem } = await ask("logs");
  node.append(h("h1", {}, "Logs"), dropZone(app));
  if (problem) node.append(h("p", { class: "message bad" }, problem));
  for (const block of blocks) {
    const title = blocks.length > 1 ? ` of block ${block.place + 1}` : "";
    if (block.open.length) node.append(section(`To decide${title}`, block.open.map(row => openCard(app, block, row))));
    node.append(section(`Columns${title}`, columnTable(app, block)));
    node.append(section(`Runs${title}`, runView(app, node, block)));
  }
  const list = h("div", { id: "finding-list" });
  node.append(section("Findings", list));
  const draw = content => list.replaceChildren(...findingList(app, content));
  draw(app.check);
  app.on("check", draw);
  node.append(h("details", {}, h("summary", {}, "Draft anew from other logs"), await draftForm(app, false)));
}

function dropZone(app) {
  const files = input("file", "", { multiple: true, class: "hidden-input", "aria-label": "Add log files" });
  const zone = h("div", { class: "drop" }, h("p", {}, "Drop logs here, or ", h("label", { class: "link" }, "choose files", files), ". They are copied into the folder."));
  async function take(list) {
    for (const file of list) {
      try {
        app.note(`${await upload(file)} is in the folder.`);
      } catch (error) {
        app.note(error.message, "bad");
      }
    }
    await app.refresh();
  }
  files.addEventListener("change", () => take(files.files));
  zone.addEventListener("dragover", event => { event.preventDefault(); zone.classList.add("is-over"); });
  zone.addEventListener("dragleave", () => zone.classList.remove("is-over"));
  zone.addEventListener("drop", event => { event.preventDefault(); zone.classList.remove("is-over"); take(event.dataTransfer.files); });
  return zone;
}

// the first draft: which logs, what is known of the craft, what columns are whose names say nothing
async function draftForm(app, isFirst) {
  const { logs, named } = app.state;
  if (!logs.length) return h("p", { class: "note" }, "The folder has no logs yet.");
  const boxes = logs.map(name => input("checkbox", name, { checked: isFirst ? !named.length || named.includes(name) : false }));
  const length = input("number", "", { min: 0, step: "any" }), name = input("text", "", { placeholder: "craft" });
  const stated = new Map(), columns = h("div"), status = h("p", { role: "status" });
  const chosen = () => boxes.filter(box => box.checked).map(box => box.value);
  const form = h("form", { class: "draft", onsubmit: async event => {
    event.preventDefault();
    status.textContent = "Reading the logs …";
    const sizes = length.value ? { length: +length.value } : {};
    const isDone = await app.edit({ kind: "draft", anew: true, logs: chosen(), sizes, name: name.value, columns: [...stated].map(pair => pair.join("=")) });
    status.textContent = isDone ? "" : "Nothing was written.";
    if (!isDone && chosen().length) await showColumns(chosen()[0], columns, stated);
  } },
    h("fieldset", {}, h("legend", {}, "Which logs?"), boxes.map(box => h("label", { class: "check" }, box, ` ${box.value}`))),
    h("div", { class: "fields" }, field("Length of the craft", length, "m; it may be left out"), field("Name", name)),
    columns,
    h("p", { class: "tools-row" }, h("button", { type: "submit", class: "main" }, "Draft the trial file"),
      button("Look at the columns first", () => chosen().length && showColumns(chosen()[0], columns, stated))),
    status);
  return form;
}

async function showColumns(log, node, stated) {
  node.replaceChildren(h("p", {}, "Reading …"));
  try {
    const { columns, notes } = await ask("candidates", { log });
    node.replaceChildren(h("h3", {}, `Columns of ${log}`), ...notes.map(note => h("p", { class: "note" }, note)),
      h("div", { class: "scroll" }, h("table", { class: "whole" }, h("thead", {}, h("tr", {}, ["Column", "From", "To", "Is"].map(text => h("th", {}, text)))),
        h("tbody", {}, columns.map(one => h("tr", {}, h("th", { class: "name" }, one.name), h("td", { class: "num" }, digits(one.low)), h("td", { class: "num" }, digits(one.high)),
          h("td", {}, select(CHANNELS, stated.get(one.name) || one.symbol, value => { if (value) stated.set(one.name, value); else stated.delete(one.name); }, { "aria-label": `what ${one.name} is` }))))))));
  } catch (error) {
    node.replaceChildren(h("p", { class: "bad" }, error.message));
  }
}

const NUMBERS = [["zero", 0], ["span", 1], ["scale", 1], ["offset", 0], ["reference_point", 0]];

function readingText(stated) {
  return ["unit", "frame", "positive", ...NUMBERS.map(pair => pair[0])].filter(key => stated[key]).map(key => `${key} ${stated[key]}`).join(", ");
}

// the numbers of a channel: (cell − zero) / span × scale + offset, and m forward of midship
function numberFields(row, change, keys = NUMBERS.map(pair => pair[0])) {
  return h("div", { class: "fields" }, NUMBERS.filter(([key]) => keys.includes(key)).map(([key, usual]) => field(key.replace("_", " "),
    h("input", { type: "number", step: "any", value: String(row.stated[key] ?? usual), "aria-label": `${key} of ${row.symbol}`, onchange: event => event.target.value !== "" && change(key, +event.target.value === usual ? null : +event.target.value) }))));
}

function openCard(app, block, row) {
  const choose = table => app.edit({ kind: "channel", block: block.place, symbol: row.symbol, table });
  const other = { ...row.stated };
  for (const [, key, text, number] of row.other.matchAll(/(\w+) = (?:"([^"]*)"|([-\d.e+]+))/g)) other[key] = text ?? +number;
  if (/span = the counts/.test(row.other)) other.span = 1;
  const hasOther = JSON.stringify(other) !== JSON.stringify(row.stated), numbers = Object.keys(other).filter(key => typeof other[key] === "number");
  return h("div", { class: "card" }, h("h3", {}, `${row.meaning} `, h("code", {}, row.symbol), " ", h("span", { class: "name" }, `column ${row.stated.column}`)),
    h("p", {}, row.reason, row.other && `; or ${row.other}`),
    numbers.length > 0 && numberFields({ ...row, stated: other }, (key, value) => { if (value === null) delete other[key]; else other[key] = value; }, numbers),
    h("p", { class: "tools-row" }, button(`Take it: ${readingText(row.stated)}`, () => choose(row.stated)),
      hasOther && button(numbers.length ? "The other, with these numbers" : `The other: ${readingText(other)}`, () => choose(other)),
      button("Do not use it", () => app.edit({ kind: "channel", block: block.place, symbol: row.symbol, table: null }), { class: "quiet" })));
}

function columnTable(app, block) {
  const keyed = row => (key, value) => app.edit({ kind: "set", value: value === "" ? null : value,
    place: ["records", block.place, ...(row.source < 0 ? [] : ["sources", row.source]), "channels", row.symbol, key] });
  const choice = (row, key, options, value, title) => options.length > 1 ? select(options, value, next => keyed(row)(key, next), { "aria-label": `${title} of ${row.symbol}`, id: `${key}-${block.place}-${row.symbol}` }) : value || null;
  const body = h("tbody");
  for (const row of block.channels) {
    const others = h("td", { class: "others" });
    const unit = row.stated.unit || "";
    body.append(h("tr", { class: row.by_hand ? "held" : "" },
      h("th", { scope: "row" }, row.meaning, " ", h("code", {}, row.symbol), row.by_hand && h("span", { class: "badge" }, "by hand")),
      h("td", { class: "name", "data-label": "column" }, row.column),
      h("td", { "data-label": "unit" }, choice(row, "unit", row.units.includes(unit) ? row.units : [unit, ...row.units], unit, "unit")),
      h("td", { "data-label": "frame" }, row.frames.length > 0 && choice(row, "frame", row.frames.length ? [["", "usual"], ...row.frames] : [], row.stated.frame || "", "frame")),
      h("td", { "data-label": "positive to" }, choice(row, "positive", row.sides, row.side, "positive side")),
      h("td", { class: "because", "data-label": "because" }, row.reason || "as stated", h("details", {}, h("summary", {}, "zero, span, scale"), numberFields(row, keyed(row)))),
      others));
    others.append(button("What else?", () => showCandidates(app, block, row, others), { "aria-label": `what else ${row.symbol} may be` }),
      button("Not used", () => app.edit({ kind: "channel", block: block.place, source: row.source, symbol: row.symbol, table: null }), { class: "quiet", "aria-label": `do not use ${row.symbol}` }));
  }
  const table = h("table", { class: "whole readings" }, h("thead", {}, h("tr", {}, ["Channel", "Column", "Unit", "Frame", "Positive to", "Because", ""].map(text => h("th", { scope: "col" }, text)))), body);
  const again = block.channels.some(row => row.by_hand) && !block.open.length && h("p", { class: "tools-row" }, button("Draft craft and model again", () => app.edit({ kind: "draft" })), h("span", { class: "note" }, "with the columns as they stand here; what you set by hand stays."));
  return [h("div", { class: "scroll" }, table), addChannel(app, block), again];
}

// what the file says of its columns, for headings that say nothing by themselves
function statedBy(block) {
  return [...block.channels.filter(one => !one.column.includes("/")).map(one => `${one.column}=${one.symbol}`), ...(block.time ? [`${block.time}=time`] : [])];
}

async function showCandidates(app, block, row, cell) {
  cell.replaceChildren("Comparing …");
  try {
    const { columns } = await ask("candidates", { log: block.files[0], columns: statedBy(block) });
    const column = columns.find(one => one.name === row.column || one.name.endsWith(`/${row.column}`));
    const list = (column?.candidates || []).slice(0, 6);
    cell.replaceChildren(list.length ? h("ul", { class: "candidates" }, list.map(one => h("li", {}, h("code", {}, one.reading), " ",
      h("span", { class: one.standing === "contradicted" ? "soft" : "warned" }, `${one.standing}, ${digits(one.nats, 2)} nats against it`))))
      : h("span", { class: "note" }, column ? "No other reading is possible." : "The judge does not know this column."));
    cell.append(h("p", { class: "note" }, column ? `${column.evidence.join("; ")}. From ${digits(column.low)} to ${digits(column.high)}.` : ""));
  } catch (error) {
    cell.replaceChildren(h("span", { class: "bad" }, error.message));
  }
}

// names that nothing explains, as the draft noted them, but for those that are used by now
function unexplained(app, block, used) {
  const [, names = ""] = app.state.text.split(/^\[\[records\]\]/m)[block.place + 1]?.match(/^# not used, names not recognised: (.*)$/m) || [];
  return names.split(", ").filter(name => name && !used.has(name));
}

function addChannel(app, block) {
  const used = new Set(block.channels.map(row => row.column)), left = unexplained(app, block, used);
  const box = h("details", { open: isAdding, ontoggle: async () => {
    isAdding = box.open;
    if (!box.open || box.dataset.filled) return;
    box.dataset.filled = "yes";
    try {
      const { columns } = await ask("candidates", { log: block.files[0] });
      const unused = columns.filter(one => !used.has(one.name) && one.low !== null);
      const column = select(unused.map(one => [one.name, `${one.name} (${digits(one.low, 3)} to ${digits(one.high, 3)} ${one.unit})`]), "");
      const symbol = select(CHANNELS.slice(2).filter(([key]) => !block.channels.some(row => row.symbol === key)), "");
      const unit = input("text", "", { size: 8 });
      const propose = () => { unit.value = unused.find(one => one.name === column.value)?.unit || UNITS[symbol.value] || "1"; };
      for (const one of [column, symbol]) one.addEventListener("change", propose);
      propose();
      box.append(h("div", { class: "fields" }, field("Column", column), field("is", symbol), field("in", unit)),
        button("Use it", () => app.edit({ kind: "channel", block: block.place, symbol: symbol.value, table: { column: column.value, unit: unit.value } })));
    } catch (error) {
      box.append(h("p", { class: "bad" }, error.message));
    }
  } }, h("summary", {}, "Use another column", left.length > 0 && h("span", { class: "note" }, `not used, as their names say nothing: ${left.join(", ")}`)));
  return box;
}

// runs: the picture of a log, a stretch chosen on it, and the list of all
function runView(app, page, block) {
  const logs = [...new Set(block.runs.map(run => run.log))];
  if (!logs.length) return h("p", { class: "note" }, "The runs show once the columns can be read.");
  if (!logs.includes(chosenLog)) chosenLog = logs[0];
  const picture = h("div", { class: "picture" }, h("p", {}, "Drawing …"));
  const start = input("number", "", { min: 0, step: "any" }), stop = input("number", "", { min: 0, step: "any" }), name = input("text", "");
  const role = select(ROLES.slice(0, 2), "train");
  let drawing = null;
  const moved = () => drawing?.choose(+start.value, +stop.value);
  for (const one of [start, stop]) one.addEventListener("input", moved);
  const cut = () => app.edit({ kind: "cut", block: block.place, log: chosenLog, start: +start.value, stop: +stop.value, name: name.value || `${chosenLog}_part`, role: role.value });
  async function draw() {
    try {
      const series = await ask("series", { block: block.place, log: chosenLog });
      picture.replaceChildren();
      drawing = new LogPicture(picture, series, (a, b) => {
        [start.value, stop.value] = [a.toFixed(1), b.toFixed(1)];
        if (!name.value) name.value = `${chosenLog}_${block.runs.length + 1}`;
      });
      picture.append(h("p", { class: "note" }, `${series.samples} samples over ${digits(series.duration)} s. Drag over a curve or along the track to choose a stretch, or type its ends.`));
    } catch (error) {
      picture.replaceChildren(h("p", { class: "bad" }, error.message));
    }
  }
  page.addEventListener("shown", draw, { once: true });
  const form = h("div", { class: "fields cut" }, field("from", start, "s"), field("to", stop, "s"), field("called", name), field("is", role), button("Make it a run", cut, { class: "main" }));
  return [logs.length > 1 && h("div", { class: "fields" }, field("Log", select(logs, chosenLog, log => { chosenLog = log; draw(); }))), picture, form, runTable(app, block)];
}

const isPart = run => Boolean(run.start || run.stop);

function runTable(app, block) {
  const names = block.runs.map(run => {
    const name = input("text", run.name, { "aria-label": `name of run ${run.name}`, disabled: false });
    name.addEventListener("change", async () => { if (!await app.edit({ kind: "rename", block: block.place, name: run.name, new_name: name.value })) name.value = run.name; });
    return h("tr", { class: run.role === "validate" ? "held" : "" }, h("td", {}, name), h("td", { class: "name" }, run.file), h("td", {}, isPart(run) ? `${run.start || "begin"} to ${run.stop || "end"}` : "whole"),
      h("td", {}, select(ROLES, run.role, role => app.edit({ kind: "role", block: block.place, name: run.name, role }), { "aria-label": `what ${run.name} is for`, id: `role-${block.place}-${run.name}` })),
      h("td", {}, isPart(run) && button("Remove", () => app.edit({ kind: "remove", block: block.place, name: run.name }), { class: "quiet", "aria-label": `remove ${run.name}` })));
  });
  const held = block.runs.filter(run => run.role === "validate").length;
  return [h("div", { class: "scroll" }, h("table", { class: "whole" }, h("thead", {}, h("tr", {}, ["Run", "File", "Part", "Is", ""].map(text => h("th", { scope: "col" }, text)))), h("tbody", {}, names))),
    h("p", { class: "note" }, held ? "The fit never sees a run that is held out: it judges the model." : "No run is held out: hold one out, so that the model can be judged.")];
}

export function findingList(app, { findings = [], complete, problem, version }) {
  const isOld = version !== app.state.version;
  const head = [isOld || !complete ? h("p", { class: "note" }, "Checking …") : null, problem ? h("p", { class: "message bad" }, problem) : null];
  if (complete && !isOld && !problem && !findings.length) head.push(h("p", { class: "good" }, "The records pass all checks."));
  const isNote = one => one.severity === "info" && one.code !== "model";
  const [notes, others] = [findings.filter(isNote), findings.filter(one => !isNote(one))];
  const card = one => h("div", { class: "finding" }, h("p", {}, h("span", { class: `severity ${one.severity}` }, one.severity), h("code", {}, one.code), " ", one.text),
    one.consequence && h("p", { class: "note" }, `What follows: ${one.consequence}.`), one.advice && h("p", { class: "note" }, `Advice: ${one.advice}.`),
    one.code === "model" && h("p", { class: "note" }, "On this page: name the columns that are missing above, then draft craft and model again; numbers of the craft stand in the view ", h("a", { href: "#craft" }, "Craft and model"), "."),
    !isOld && h("p", { class: "tools-row" }, one.edits.length > 0 && button(`Do it: ${one.edits.join("; ")}`, () => app.edit({ kind: "finding", place: one.place })),
      one.severity === "error" && button("It is right as it is", () => app.edit({ kind: "finding", place: one.place, accept: true }), { class: "quiet" })));
  return [...head, ...others.map(card), notes.length ? h("details", {}, h("summary", {}, `${notes.length} note${notes.length > 1 ? "s" : ""}`), notes.map(card)) : null].filter(Boolean);
}
