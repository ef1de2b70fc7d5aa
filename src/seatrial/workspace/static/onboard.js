// On board: a source that grows, followed while it does; its page is a frame of the workspace.
import { ask } from "./api.js";
import { button, field, h, input, section } from "./dom.js";
import { jobList, reportFrame } from "./fits.js";

export async function showOnBoard(node, app) {
  node.append(h("h1", {}, "On board"));
  if (!app.state.exists) { node.append(h("p", {}, "First draft a trial file from logs, in the view Logs.")); return; }
  const file = input("text", "", { placeholder: "today.csv" });
  if (!/^\[follow\]/m.test(app.state.text)) {
    node.append(h("p", {}, "A table [follow] in the trial file says where samples come from: a file that grows, NMEA 0183 or 2000, MAVLink, UDP. The simplest is a file in the folder, with the columns of the records, read as its logger writes it."),
      h("div", { class: "fields" }, field("File that grows", file), button("Follow it", () => app.edit({ kind: "follow", block: 0, file: file.value }), { class: "main" })));
    return;
  }
  const once = input("checkbox", "1"), frame = h("iframe", { src: "/onboard", title: "what is followed", class: "report" });
  const following = () => [...app.jobs.values()].find(job => job.kind === "follow" && job.state === "running");
  const start = async () => {
    try { await ask("start-follow", { once: once.checked }); await app.refresh(); } catch (error) { app.note(error.message, "bad"); }
  };
  node.append(h("p", { class: "tools-row" }, button("Follow", start, { class: "main", disabled: Boolean(following()) }), h("label", { class: "check" }, once, " end with the input, with the fit of identify")),
    jobList(app, "follow"));
  if (following()) node.append(section("Now", frame));
  const last = [...app.jobs.values()].filter(job => job.kind === "follow" && job.state === "done").at(-1);
  if (last && !following()) {
    const { fits } = await ask("fits");
    if (fits.some(fit => fit.name === last.name && fit.has_report)) node.append(section(`Report of ${last.name}`, reportFrame(last.name)));
    else node.append(h("p", { class: "note" }, `The last estimate lies in ${last.name}/online.json.`));
  }
}
