({
  // texts with too little contrast (W3C, Web Content Accessibility Guidelines 2.1, 1.4.3) with what is behind them
  faint() {
    const parts = colour => colour.match(/[\d.]+/g).map(Number);
    const light = c => c / 255 <= 0.03928 ? c / 255 / 12.92 : ((c / 255 + 0.055) / 1.055) ** 2.4;
    const luminance = ([r, g, b]) => 0.2126 * light(r) + 0.7152 * light(g) + 0.0722 * light(b);
    const over = ([r, g, b, a = 1], ground) => [r, g, b].map((c, k) => a * c + (1 - a) * ground[k]);
    const body = parts(getComputedStyle(document.body).backgroundColor);
    const ground = node => node === document.body ? body
      : over(parts(getComputedStyle(node).backgroundColor), ground(node.parentElement));
    const covers = (box, x, y) => box.left <= x && x <= box.right && box.top <= y && y <= box.bottom;
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT), faint = new Set();
    while (walker.nextNode()) {
      const node = walker.currentNode.parentElement, words = walker.currentNode.textContent.trim();
      if (!words || !node.checkVisibility() || node.closest("script, style, noscript")) continue;
      const svg = node.closest("svg"), style = getComputedStyle(node), box = node.getBoundingClientRect();
      let behind = ground((svg || node).closest("body *:not(svg, svg *)"));
      for (const cell of svg ? svg.querySelectorAll("rect") : [])
        if (covers(cell.getBoundingClientRect(), box.left + box.width / 2, box.top + box.height / 2))
          behind = over(parts(getComputedStyle(cell).fill), behind);
      const both = [over(parts(svg ? style.fill : style.color), behind), behind].map(luminance);
      const ratio = (Math.max(...both) + 0.05) / (Math.min(...both) + 0.05);
      if (ratio < 4.5) faint.add(`${words}: ${ratio.toFixed(2)}`);
    }
    return [...faint];
  },
  // tables cut at the right edge; that of other estimators has as many columns as the model has coefficients
  cut() {
    return [...document.querySelectorAll(".scroll")]
      .filter(box => box.scrollWidth > box.clientWidth + 1 && !box.querySelector(".baselines"))
      .map(box => box.textContent.trim().slice(0, 60));
  },
  unnamed() {
    return [...document.querySelectorAll("body svg, button, a, summary, input")]
      .filter(node => !node.closest("svg svg") && !node.textContent.trim())
      .filter(node => !node.getAttribute("aria-label") && !node.labels?.length)
      .map(node => node.outerHTML.slice(0, 80));
  },
})
