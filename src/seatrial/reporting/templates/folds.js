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
addEventListener("beforeprint", () => folds().forEach(fold => { fold.open = true; }));
addEventListener("hashchange", () => { document.getElementById(decodeURIComponent(location.hash.slice(1)))?.closest("details")?.setAttribute("open", ""); });
}
