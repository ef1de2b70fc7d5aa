{
const folds = () => document.querySelectorAll("details");
const button = document.getElementById("unfold");
if (!folds().length) button.hidden = true;
button.addEventListener("click", () => {
  const open = button.getAttribute("aria-pressed") !== "true";
  folds().forEach(fold => { fold.open = open; });
  button.setAttribute("aria-pressed", open);
  button.textContent = open ? "Fold all" : "Unfold all";
});
// what is wider than its box says so, and is reached and moved by the keyboard
const boxes = document.querySelectorAll(".scroll, figure, .track, .formula");
function mark(box) {
  const isWide = box.scrollWidth > box.clientWidth + 1;
  if (isWide) box.tabIndex = 0; else box.removeAttribute("tabindex");
  box.classList.toggle("is-wide", isWide && box.matches(".scroll, figure, .track"));
}
new ResizeObserver(() => boxes.forEach(mark)).observe(document.body);
addEventListener("beforeprint", () => folds().forEach(fold => { fold.open = true; }));
addEventListener("hashchange", () => { document.getElementById(decodeURIComponent(location.hash.slice(1)))?.closest("details")?.setAttribute("open", ""); });
}
