// Fits: started, watched, stopped, side by side, each restorable as its trial file.
import { ask } from "./api.js";
import { LogPicture, track, unpacked } from "./charts.js";
import { button, duration, field, h, input, section, select } from "./dom.js";
import { findingList } from "./logs.js";

const chosen = new Set(), seen = new Set();
let openReport = "";

export async function showFits(node, app) {
  node.append(h("h1", {}, "Fit"));
  if (!app.state.exists) { node.append(h("p", {}, "First draft a trial file from logs, in the view Logs.")); return; }
  const { fits } = await ask("fits");
  const blocked = (app.check.findings || []).find(one => one.code === "model");
  node.append(blocked ? h("p", { class: "message warn" }, `${blocked.text}. ${blocked.advice}.`) : "", startForm(app), jobList(app, "fit"));
  if (!fits.length) node.append(h("p", { class: "note" }, "No fit yet. The fit estimates the ticked coefficients from the runs that are fitted and predicts those that are held out."));
  else {
    const done = fits.filter(fit => fit.state === "done");
    for (const { name } of done) {
      if (seen.size && !seen.has(name)) chosen.add(name); // a fit that has just ended is shown
      seen.add(name);
    }
    if (![...chosen].some(name => done.some(fit => fit.name === name))) for (const fit of done.slice(-2)) chosen.add(fit.name);
    node.append(section("Fits", fitList(app, fits)));
    const compared = done.filter(fit => chosen.has(fit.name));
    if (compared.length) node.append(section(compared.length > 1 ? "Side by side" : "Result", sideBySide(compared), trackRow(compared)));
  }
  const report = fits.find(fit => fit.name === openReport && fit.has_report);
  if (report) node.append(section(`Report of ${report.name}`, reportFrame(report.name)));
}

export function reportFrame(name, page = "report") {
  const address = `/report/${name.split("/").map(encodeURIComponent).join("/")}/${page}.html`;
  return [h("p", {}, h("a", { href: address, target: "_blank", rel: "noopener" }, "Open it in a window of its own, to print or keep")),
    h("iframe", { src: address, title: `${page} of ${name}`, class: "report", sandbox: "allow-scripts allow-popups allow-modals", loading: "lazy" })];
}

function startForm(app) {
  const name = input("text", "", { placeholder: "by number" }), seed = input("number", 0, { min: 0, step: 1 });
  const intervals = select([["", "as it sees fit"], ["jackknife", "by leaving runs out"], ["bootstrap", "bootstrap"], ["profile", "profile"]], "");
  const choose = input("checkbox", "1"), compare = input("checkbox", "1");
  const start = async () => {
    try {
      await ask("start-fit", { name: name.value, seed: +seed.value, intervals: intervals.value, choose: choose.checked, compare: compare.checked });
      await app.refresh();
    } catch (error) { app.note(error.message, "bad"); }
  };
  return h("div", { class: "fields start" }, button("Start the fit", start, { class: "main" }), field("called", name),
    h("details", {}, h("summary", {}, "More"), field("Intervals", intervals), field("Seed", seed), h("label", { class: "check" }, choose, " compare models and take the one that predicts best"), h("label", { class: "check" }, compare, " compare with regressions")));
}

export function jobList(app, kind) {
  const box = h("div", { class: "jobs" });
  const draw = () => box.replaceChildren(...[...app.jobs.values()].filter(job => job.kind === kind && job.state !== "done").map(job => jobCard(app, job)));
  draw();
  // the time goes on between two reports
  const clock = setInterval(() => {
    if (!box.isConnected) clearInterval(clock);
    for (const text of box.querySelectorAll(".so-far")) text.textContent = duration(elapsed(app.jobs.get(text.dataset.job)));
  }, 1000);
  app.on("job", async job => {
    if (job.kind !== kind) return;
    draw();
    if (job.state !== "running") setTimeout(() => app.refresh().catch(() => {}), 100);
  });
  return box;
}

const elapsed = job => job.seconds + (performance.now() - job.at) / 1000;

function jobCard(app, job) {
  const last = job.phases.at(-1)?.name || "starting";
  const isRunning = job.state === "running";
  const left = job.left !== null && job.left > 1 ? `, about ${duration(job.left)} left in this phase` : "";
  const bar = job.total ? h("progress", { max: job.total, value: job.done, "aria-label": `${last} of ${job.name}` }) : isRunning ? h("progress", { "aria-label": `${last} of ${job.name}` }) : null;
  const card = h("div", { class: `card job ${job.state}` }, h("h3", {}, job.name, " ", h("span", { class: "badge" }, job.state)),
    isRunning && h("p", { role: "status" }, h("b", {}, last), job.detail ? `: ${job.detail}` : "", h("br"), h("span", { class: "so-far", "data-job": job.name }, duration(elapsed(job))), ` so far${left}`), bar,
    h("ol", { class: "phases" }, job.phases.slice(-8).map(one => h("li", {}, `${one.name} `, h("span", { class: "u" }, `from ${duration(one.at)}`)))),
    job.message && h("p", { class: "message bad" }, job.message));
  if (isRunning) card.append(button("Stop", async () => { try { await ask("stop", { name: job.name }); } catch (error) { app.note(error.message, "bad"); } }, { "aria-label": `stop ${job.name}` }));
  // when a fit fails, the reason and what the data show stand together
  if (job.state === "failed" && job.kind === "fit") card.append(recordPicture(app), h("details", { open: true }, h("summary", {}, "What the records show"), ...findingList(app, app.check), h("p", {}, h("a", { href: "#logs" }, "Look at columns and runs"))));
  return card;
}

function recordPicture(app) {
  const box = h("div", { class: "picture" });
  queueMicrotask(async () => {
    try {
      const { blocks } = await ask("logs"), run = blocks[0]?.runs[0];
      if (run) new LogPicture(box, await ask("series", { block: 0, log: run.log }), () => {});
    } catch (error) { box.append(h("p", { class: "note" }, error.message)); }
  });
  return box;
}

function fitList(app, fits) {
  return h("div", { class: "scroll" }, h("table", { class: "whole" }, h("thead", {}, h("tr", {}, ["Show", "Fit", "What it is worth", ""].map(text => h("th", { scope: "col" }, text)))),
    h("tbody", {}, fits.map(fit => h("tr", {}, h("td", {}, fit.state === "done" && h("input", { type: "checkbox", checked: chosen.has(fit.name), "aria-label": `show ${fit.name}`,
      onchange: event => { if (event.target.checked) chosen.add(fit.name); else chosen.delete(fit.name); app.refresh(); } })),
      h("th", { scope: "row" }, fit.name, h("span", { class: "under" }, fit.model || fit.state)), h("td", {}, fit.verdict || fit.message || ""),
      h("td", { class: "tools-row" }, fit.has_report && button("Report", () => { openReport = fit.name; app.refresh().then(() => document.querySelector("iframe.report")?.scrollIntoView()); }),
        fit.state === "done" && button("What if", () => { app.chosenFit = fit.name; app.go("whatif"); }),
        fit.has_trial && button("Its trial file", () => app.edit({ kind: "restore", name: fit.name }), { title: "make the trial file what it was for this fit" })))))));
}

function sideBySide(fits) {
  const names = [...new Set(fits.flatMap(fit => fit.facts.map(fact => fact.name)))];
  const free = [...new Set(fits.flatMap(fit => fit.coefficients.filter(one => !one.fixed).map(one => one.name)))];
  const fact = (fit, name) => fit.facts.find(one => one.name === name);
  const coefficient = (fit, name) => fit.coefficients.find(one => one.name === name);
  const cell = one => !one ? h("td", {}, "–") : h("td", { class: "num" }, one.shown, " ", h("span", { class: "u" }, one.unit),
    h("span", { class: `under ${one.sign_open ? "bad" : ""}` }, one.fixed ? "held" : one.low === null && one.high === null ? "no interval" : `${one.interval}${one.sign_open ? ", sign open" : ""}`));
  const meaning = name => fits.map(fit => coefficient(fit, name)?.meaning).find(Boolean) || "";
  return h("div", { class: "scroll" }, h("table", { class: "whole beside" }, h("thead", {}, h("tr", {}, h("th", {}), fits.map(fit => h("th", { scope: "col" }, fit.name)))),
    h("tbody", {}, h("tr", {}, h("th", { scope: "row" }, "Verdict"), fits.map(fit => h("td", {}, h("b", {}, fit.verdict)))),
      names.map(name => h("tr", {}, h("th", { scope: "row" }, name), fits.map(fit => h("td", { class: fact(fit, name)?.good === false ? "warned" : "" }, fact(fit, name)?.text || "–"))))),
    h("tbody", {}, h("tr", { class: "group" }, h("th", { colspan: fits.length + 1 }, "Coefficients with their 95 % intervals")),
      free.map(name => h("tr", {}, h("th", { scope: "row" }, h("code", {}, name), h("span", { class: "under" }, meaning(name))), fits.map(fit => cell(coefficient(fit, name))))))));
}

function trackRow(fits) {
  const boxes = fits.flatMap(fit => fit.tracks.filter(one => one.measured.track && one.simulated.track).map(one => h("figure", {}, track([line(one.measured, "measured"), line(one.simulated, "simulated")],
    { title: `held-out run ${one.run}, measured and predicted by ${fit.name}` }), h("figcaption", {}, `${fit.name}: ${one.run}, measured (broad) and predicted (dashed)`))));
  return h("div", { class: "tracks" }, boxes);
}

export const line = (curves, kind) => ({ north: unpacked(curves.track.north), east: unpacked(curves.track.east), kind });
