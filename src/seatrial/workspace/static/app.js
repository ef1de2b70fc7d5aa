// The workspace's frame: views, the trial file's last change with undo, findings, conflicts, events.
import { ask, listen, Refused } from "./api.js";
import { button, diffView, h } from "./dom.js";
import { showCraft } from "./craft.js";
import { showFile } from "./file.js";
import { showFits } from "./fits.js";
import { showGains } from "./gains.js";
import { showLogs } from "./logs.js";
import { showOnBoard } from "./onboard.js";
import { showWhatIf } from "./whatif.js";

const VIEWS = { logs: ["Logs", showLogs], craft: ["Craft and model", showCraft], fit: ["Fit", showFits],
  whatif: ["What if", showWhatIf], gains: ["Gains", showGains], onboard: ["On board", showOnBoard], file: ["File", showFile] };
const $ = id => document.getElementById(id);

export const app = {
  state: null,
  jobs: new Map(),
  check: {},
  chosenFit: "",
  asked: 0,
  answered: 0,
  listeners: new Set(),

  // an edit of the trial file; a conflict is shown, and nothing is lost
  async edit(content) {
    try {
      const change = await ask("edit", { ...content, version: this.state.version });
      await this.changed(change);
      return true;
    } catch (error) {
      if (error.status === 409) await this.conflict(content, error);
      else this.note(error.message, "bad");
      return false;
    }
  },
  async undo() {
    try {
      await this.changed(await ask("undo", { version: this.state.version }));
    } catch (error) {
      if (error.status === 409) await this.conflict(null, error);
      else this.note(error.message, "bad");
    }
  },
  async changed(change) {
    await this.refresh();
    showEdit(change);
  },
  async refresh() {
    const turn = ++this.asked, state = await ask("state");
    if (turn < this.answered) return; // a later request was answered before
    this.answered = turn;
    this.state = state;
    if (this.state.check?.version) this.learn(this.state.check);
    for (const job of this.state.jobs) this.jobs.set(job.name, { ...job, at: performance.now() });
    $("where").textContent = `${this.state.name} in ${this.state.folder}`;
    document.title = `${this.state.name} – seatrial`;
    showFindingCount();
    await show();
  },
  // an answer that left before an event may arrive behind it: a check of this text that has ended stays
  learn(check) {
    const hasEnded = one => one.complete && one.version === this.state?.version;
    if (!hasEnded(this.check) || hasEnded(check)) this.check = check;
  },
  async conflict(content, error) {
    const { diff } = await ask("difference", { since: this.state.version });
    await this.refresh();
    const dialog = $("dialog");
    dialog.replaceChildren(h("h2", { id: "dialog-title" }, "The trial file has changed meanwhile"), h("p", {}, error.message),
      diff.length ? diffView(diff) : h("p", { class: "note" }, "The change is shown in the view File."),
      h("p", { class: "tools-row" }, content && button("Do mine on the newer file", () => { dialog.close(); this.edit(content); }),
        button("Leave it as it is now", () => dialog.close())));
    dialog.showModal();
  },
  note(text, kind = "") {
    const note = h("p", { class: `message ${kind}` }, text, " ", button("Close", () => note.remove(), { class: "quiet" }));
    $("notes").replaceChildren(note);
  },
  on(kind, handle) { this.listeners.add([kind, handle]); },
  tell(kind, content) {
    for (const [wanted, handle] of this.listeners) if (wanted === kind) handle(content);
  },
  go(view) { location.hash = view; },
};

function showEdit({ summary, diff }) {
  const box = $("edit");
  if (!diff?.length) {
    box.hidden = true;
    app.note("Nothing to change: the trial file stands so already.");
    return;
  }
  const details = h("details", {}, h("summary", {}, h("b", {}, "Edited: "), summary), diffView(diff));
  const undo = summary.startsWith("undo:") ? null : button("Undo", () => app.undo());
  box.replaceChildren(details, h("span", { class: "tools-row" }, undo, button("Hide", () => { box.hidden = true; }, { class: "quiet" })));
  box.hidden = false;
}

function showFindingCount() {
  const chip = $("findings"), { findings = [], complete, problem } = app.check;
  const count = kind => findings.filter(one => one.severity === kind).length;
  chip.hidden = !app.state?.exists;
  const parts = [[count("error"), "error"], [count("warning"), "warning"]].filter(([n]) => n).map(([n, word]) => `${n} ${word}${n > 1 ? "s" : ""}`);
  const isBlocked = findings.some(one => one.code === "model");
  if (isBlocked) parts.push("not ready to fit");
  chip.className = `chip ${count("error") || problem ? "bad" : count("warning") || isBlocked ? "warn" : "good"}`;
  chip.textContent = app.check.version !== app.state?.version || !complete ? `checking … ${parts.join(", ")}` : problem ? "to correct" : parts.join(", ") || "checks pass";
  chip.dataset.version = complete ? app.check.version : "";
}

let shown = "";
async function show() {
  const key = location.hash.slice(1).split("/")[0] in VIEWS ? location.hash.slice(1).split("/")[0] : "logs";
  const [, draw] = VIEWS[key], view = $("view"), top = scrollY, isSame = key === shown;
  const kept = document.activeElement?.id;
  app.listeners.clear();
  for (const link of $("steps").children) link.setAttribute("aria-current", link.dataset.view === key ? "page" : "false");
  const content = h("div", { class: `content ${key}` });
  try {
    await draw(content, app);
  } catch (error) {
    if (!(error instanceof Refused)) throw error;
    content.append(h("p", { class: "bad" }, error.message));
  }
  view.replaceChildren(content);
  content.dispatchEvent(new Event("shown"));
  shown = key;
  if (isSame) { scrollTo(0, top); if (kept) document.getElementById(kept)?.focus({ preventScroll: true }); }
  else { scrollTo(0, 0); }
}

$("steps").append(...Object.entries(VIEWS).map(([key, [title]]) => h("a", { href: `#${key}`, "data-view": key }, title)));
$("findings").addEventListener("click", () => { app.go("logs"); setTimeout(() => document.getElementById("finding-list")?.scrollIntoView(), 300); });
addEventListener("hashchange", () => show());
addEventListener("error", event => app.note(event.message, "bad"));
const heard = {
  async changed({ version }) {
    if (app.state && version !== app.state.version) await app.refresh().catch(error => app.note(error.message, "bad"));
  },
  check(content) {
    app.learn(content);
    showFindingCount();
    app.tell("check", content);
  },
  job(content) {
    app.jobs.set(content.name, { ...content, at: performance.now() });
    app.tell("job", content);
  },
  onboard(content) { app.tell("onboard", content); },
  gone(isOther) { app.tell("gone", isOther); },
  // the stream is open: a page that shows this text already is not drawn anew under the hand of its user
  async hello() {
    const state = await ask("state").catch(() => null);
    if (!state || !app.state) return;
    if (state.version !== app.state.version) await app.refresh().catch(() => {});
    else if (state.check?.version) heard.check(state.check);
    app.tell("hello");
  },
};
listen(heard);
await app.refresh().catch(error => { document.getElementById("view").replaceChildren(h("p", { class: "bad" }, error.message)); });
if (app.state?.exists) { app.learn(await ask("check")); showFindingCount(); app.tell("check", app.check); }
