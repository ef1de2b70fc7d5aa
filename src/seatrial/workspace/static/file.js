// The trial file as text, and its changes.
import { button, diffView, h, section } from "./dom.js";

export function showFile(node, app) {
  const { text, changes, undoable, name } = app.state;
  const area = h("textarea", { spellcheck: false, "aria-label": `text of ${name}`, rows: 30 });
  area.value = text;
  node.append(h("h1", {}, name), h("p", { class: "note" }, "The file is all that the workspace knows. The command line and Python read the same."),
    area, h("p", { class: "tools-row" }, button("Save", () => app.edit({ kind: "text", text: area.value })),
      button("Undo the last change", () => app.undo(), { disabled: !undoable })));
  if (changes.length) node.append(section("Changes since it was opened", h("ol", { class: "changes", reversed: true },
    changes.map(one => h("li", {}, h("details", {}, h("summary", {}, one.summary), diffView(one.diff)))))));
}
