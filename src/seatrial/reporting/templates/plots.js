"use strict";
// Time series of the page, drawn by uPlot: every figure holds its data as JSON (seatrial/core/figures/time_plot.py).
{
  const LARGEST = 65534, GAP = 65535, HEIGHT = 150, TALL = 260, PRINT_WIDTH = 300, FULL_PRINT_WIDTH = 640;
  const INK = "#1d2226", SOFT = "#5d676f", GRID = "#ececec", BAND = "#1b4f7230";
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const NIGHT = JSON.parse(document.getElementById("night-colours").textContent);
  let isPrinting = false;
  const colour = name => (dark.matches && !isPrinting && NIGHT[name.slice(0, 7)] || name.slice(0, 7)) + name.slice(7);

  function unpacked({ range: [low, high], codes }) {
    const bytes = Uint8Array.from(atob(codes), letter => letter.charCodeAt(0));
    const view = new DataView(bytes.buffer);
    return Array.from({ length: bytes.length / 2 }, (_, k) => {
      const code = view.getUint16(2 * k, true);
      return code === GAP ? null : low + (high - low) * code / LARGEST;
    });
  }
  // values given at few even points, at `share` of the way
  function between(values, share) {
    const place = share * (values.length - 1), k = Math.min(Math.floor(place), values.length - 2);
    if (values.length < 2) return values[0];
    const a = values[k], b = values[k + 1];
    return a === null || b === null ? null : a + (b - a) * (place - k);
  }
  const spread = (values, count) => Array.from({ length: count }, (_, k) => between(values, k / Math.max(1, count - 1)));

  // digits that a thousandth of the range needs
  function text(value, [low, high]) {
    if (value === null || value === undefined) return "–";
    const decimals = Math.min(6, Math.max(0, 2 - Math.floor(Math.log10(high - low || 1))));
    return value.toFixed(decimals).replace("-", "−");
  }
  const line = ([name, width, dash]) => ({ stroke: () => colour(name), width, dash: dash.length ? dash : undefined, points: { show: false } });

  class Panel {
    constructor(figure, k) {
      this.figure = figure;
      this.data = figure.document.panels[k];
      this.node = document.createElement("div");
      this.node.className = "panel";
      this.node.tabIndex = 0;
      this.node.setAttribute("role", "group");
      this.node.setAttribute("aria-label", `${figure.document.about[k]}. Arrow keys move the cursor, plus and minus zoom, 0 shows all.`);
      this.head = document.createElement("p");
      this.head.className = "readout";
      this.node.append(this.head);
      figure.node.append(this.node);
      this.node.addEventListener("keydown", event => figure.key(event));
      this.curves = this.data.curves.map(unpacked);
      this.plot = new uPlot(this.options(), this.columns(), this.node);
      this.node.querySelector("canvas").setAttribute("aria-hidden", "true");
      this.read(null);
    }
    columns() {
      const { count, panels } = this.figure.document, rest = this.data.levels.map(level => Array(count).fill(level.value));
      return [this.figure.time, ...(this.data.band || []).map(edge => spread(unpacked(edge), count)), ...this.curves, ...rest];
    }
    options() {
      const { data, figure } = this, { time } = figure, full = [time[0], time.at(-1)];
      const edges = data.band ? [0, 1].map(() => ({ stroke: "transparent", points: { show: false } })) : [];
      const grid = { stroke: () => colour(GRID), width: 1 }, ticks = { show: false };
      const values = (u, ticks) => ticks.map(value => String(+value.toPrecision(6)).replace("-", "−"));
      const axis = { stroke: () => colour(SOFT), font: "10px Arial, sans-serif", grid, ticks, values };
      return {
        width: this.width(), height: this.figure.height, legend: { show: false }, pxAlign: 0,
        padding: [6, 14, 0, 0],  // px; right: half of a last label such as 10000
        cursor: { sync: { key: figure.id, scales: ["x", null] }, drag: { x: true, y: false }, y: false, points: { size: 5 } },
        scales: { x: { time: false }, y: { range: (u, low, high) => this.isWhole(u, full) || !(high > low) ? data.ends : [low, high] } },
        axes: [{ ...axis, size: 18, gap: 3, label: figure.document.x, labelSize: 14, labelGap: 0, labelFont: "10px Arial, sans-serif", space: 55 },
          { ...axis, size: 46, gap: 4, space: 24 }],
        series: [{}, ...edges, ...data.curves.map(curve => line(curve.stroke)), ...data.levels.map(level => line(level.stroke))],
        bands: data.band ? [{ series: [2, 1], fill: () => colour(BAND) }] : [],
        hooks: { setCursor: [u => figure.moved(u.cursor.idx)] },
      };
    }
    isWhole(u, [first, last]) { return u.scales.x.min <= first && u.scales.x.max >= last; }
    width() { return isPrinting ? this.figure.printWidth : Math.max(200, this.node.clientWidth); }
    fit() { this.plot.setSize({ width: this.width(), height: this.figure.height }); }
    read(k) {
      const values = this.data.curves.map((curve, j) => `${curve.name} ${text(this.curves[j][k], this.data.ends)}`);
      this.words = `${this.data.label} ${values.join(", ")}`;
      this.head.replaceChildren(Object.assign(document.createElement("b"), { textContent: this.data.label }),
        k === null || k === undefined ? "" : ` ${values.join(" · ")}`);
    }
  }

  class Figure {
    constructor(node, id) {
      this.node = node;
      this.id = id;
      this.document = JSON.parse(node.querySelector("script").textContent);
      const { start, stop, count } = this.document, isWide = node.closest(".first, .wide");
      this.time = Array.from({ length: count }, (_, k) => start + (stop - start) * k / Math.max(1, count - 1));
      this.panels = [];
      this.height = node.closest(".first .square") && this.document.panels.length === 1 ? TALL : HEIGHT;
      this.printWidth = this.height === HEIGHT && isWide && !node.closest(".square") ? FULL_PRINT_WIDTH : PRINT_WIDTH;
    }
    draw() {
      if (this.panels.length) return false;
      this.panels = this.document.panels.map((_, k) => new Panel(this, k));
      this.status = Object.assign(document.createElement("p"), { className: "hidden" });
      this.status.setAttribute("aria-live", "polite");
      this.node.append(this.status);
      this.node.classList.add("is-drawn");
      const picture = this.node.parentElement.querySelector(".track > svg");
      this.places = picture ? this.document.track.map(pair => pair.map(unpacked)) : [];
      this.marks = this.places.map((_, k) => {
        const mark = document.createElementNS("http://www.w3.org/2000/svg", "circle");
        mark.setAttribute("class", `place place${k}`);
        mark.setAttribute("r", "0");
        picture.append(mark);
        return mark;
      });
      new ResizeObserver(() => this.fit()).observe(this.node);
      return true;
    }
    fit() { for (const panel of this.panels) panel.fit(); }
    redraw() { for (const panel of this.panels) panel.plot.redraw(); }
    moved(k) {
      for (const panel of this.panels) panel.read(k);
      const isOn = k !== null && k !== undefined;
      this.marks?.forEach((mark, j) => {
        const share = isOn ? k / Math.max(1, this.time.length - 1) : 0, [x, y] = this.places[j].map(values => between(values, share));
        mark.setAttribute("r", isOn && x !== null && y !== null ? "4" : "0");
        if (isOn && x !== null && y !== null) { mark.setAttribute("cx", x); mark.setAttribute("cy", y); }
      });
      this.index = k;
    }
    place(k) {
      const { plot } = this.panels[0];
      plot.setCursor({ left: plot.valToPos(this.time[k], "x"), top: 10 }, true, true);
      this.moved(k);
      this.status.textContent = `${this.document.x.split(" ")[0]} ${text(this.time[k], [this.time[0], this.time.at(-1)])}: ${this.panels.map(p => p.words).join("; ")}`;
    }
    zoom(factor) {
      const { min, max } = this.panels[0].plot.scales.x, [first, last] = [this.time[0], this.time.at(-1)];
      const middle = this.index == null ? (min + max) / 2 : this.time[this.index], half = (max - min) * factor / 2;
      const ends = factor === 0 ? { min: first, max: last } : { min: Math.max(first, middle - half), max: Math.min(last, middle + half) };
      for (const panel of this.panels) panel.plot.setScale("x", ends);
    }
    key(event) {
      const step = { ArrowRight: 1, ArrowLeft: -1, PageDown: 25, PageUp: -25 }[event.key], last = this.time.length - 1;
      if (step) this.place(Math.min(last, Math.max(0, (this.index ?? (step > 0 ? -1 : last + 1)) + step)));
      else if (event.key === "Home" || event.key === "End") this.place(event.key === "Home" ? 0 : last);
      else if (event.key === "+" || event.key === "=") this.zoom(0.5);
      else if (event.key === "-") this.zoom(2);
      else if (event.key === "0" || event.key === "Escape") this.zoom(0);
      else return;
      event.preventDefault();
    }
  }

  const figures = [...document.querySelectorAll(".series")].map((node, k) => new Figure(node, `figure${k}`));
  const AHEAD = 600;  // px below the window from which on a figure is drawn
  const near = new IntersectionObserver(entries => {
    for (const entry of entries) if (entry.isIntersecting) figures.find(figure => figure.node === entry.target).draw();
  }, { rootMargin: `${AHEAD}px` });
  // what the first picture of the page shows is drawn before it
  for (const figure of figures) if (figure.node.checkVisibility() && figure.node.getBoundingClientRect().top < innerHeight + AHEAD) figure.draw();
  for (const figure of figures) near.observe(figure.node);
  // the others when there is time, so that none is empty in a picture of the whole page
  const later = window.requestIdleCallback ?? setTimeout;
  function drawNext() {
    const next = figures.find(figure => !figure.panels.length && figure.node.checkVisibility());
    if (next) { next.draw(); later(drawNext); }
  }
  later(drawNext);
  // a plot that is new has no scales to be drawn again with until its first drawing
  function resize() {
    for (const figure of figures) if (!figure.draw()) { figure.fit(); figure.redraw(); }
  }
  addEventListener("beforeprint", () => { isPrinting = true; resize(); });
  addEventListener("afterprint", () => { isPrinting = false; resize(); });
  dark.addEventListener("change", () => { for (const figure of figures) figure.redraw(); });
}
