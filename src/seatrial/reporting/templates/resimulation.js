"use strict";
// Sliders that simulate a run again (seatrial/reporting/resimulation.py holds the data, replay and rates the model).
{
  const POINTS = 500, HALVINGS = 12, STEPS = 1000, WIDTH = 430, HEIGHT = 250, EDGE = { left: 46, right: 8, top: 18, bottom: 26 };
  const SVG = "http://www.w3.org/2000/svg";
  const digits = (value, count = 4) => String(Number(value.toPrecision(count))).replace("-", "−").replace(/e([+-])/, " × 10^$1");

  function unpacked(data, Kind, count) {
    if (typeof data === "number") return new Kind(count).fill(data);
    if (data.index !== undefined) {
      const table = unpacked(data.table, Kind, 1), places = unpacked(data.index, data.wide ? Uint16Array : Uint8Array, count);
      return Kind.from(places, place => table[place]);
    }
    return new Kind(Uint8Array.from(atob(data), letter => letter.charCodeAt(0)).buffer);
  }
  const node = (name, attributes, parent, text) => {
    const made = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    if (text !== undefined) made.textContent = text;
    parent.append(made);
    return made;
  };
  function rms(channel, states) {
    let sum = 0, count = 0;
    channel.measured.forEach((value, k) => {
      const error = states[channel.state][k] - value;
      if (Number.isFinite(error)) { sum += error * error; count++; }
    });
    return Math.sqrt(sum / count);
  }

  // one picture: a curve over another, with the record and the run at the estimates behind the present one
  class View {
    constructor(parent, about, across, along, isTrack) {
      this.across = across; this.along = along; this.isTrack = isTrack;
      this.svg = node("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img", "aria-label": about }, parent);
      this.curves = ["record", "estimate", "now"].map(name => node("polyline", { class: name }, this.svg));
    }
    frame(series) {
      const [x, y] = [this.across, this.along].map(pick => span(series.flatMap(one => ends(pick(one)))));
      const wide = WIDTH - EDGE.left - EDGE.right, tall = HEIGHT - EDGE.top - EDGE.bottom;
      let [sx, sy] = [wide / (x.high - x.low), tall / (y.high - y.low)];
      if (this.isTrack) sx = sy = Math.min(sx, sy);
      const mx = (x.high + x.low) / 2, my = (y.high + y.low) / 2;
      this.px = value => EDGE.left + wide / 2 + (value - mx) * sx;
      this.py = value => EDGE.top + tall / 2 - (value - my) * sy;
      this.axes({ low: mx - wide / 2 / sx, high: mx + wide / 2 / sx }, { low: my - tall / 2 / sy, high: my + tall / 2 / sy });
      series.forEach((one, k) => this.draw(k, one));
    }
    axes(x, y) {
      this.svg.querySelectorAll(".axis").forEach(old => old.remove());
      const group = node("g", { class: "axis" }, this.svg), bottom = HEIGHT - EDGE.bottom;
      for (const value of ticks(x)) {
        node("line", { x1: this.px(value), x2: this.px(value), y1: EDGE.top, y2: bottom }, group);
        node("text", { x: this.px(value), y: bottom + 12, "text-anchor": "middle" }, group, digits(value));
      }
      for (const value of ticks(y)) {
        node("line", { x1: EDGE.left, x2: WIDTH - EDGE.right, y1: this.py(value), y2: this.py(value) }, group);
        node("text", { x: EDGE.left - 4, y: this.py(value) + 3, "text-anchor": "end" }, group, digits(value));
      }
      node("text", { x: WIDTH - EDGE.right, y: HEIGHT - 3, "text-anchor": "end" }, group, this.xLabel);
      node("text", { x: 2, y: 11 }, group, this.yLabel);
      this.svg.prepend(group);
    }
    draw(k, one) {
      const x = this.across(one), y = this.along(one), step = Math.max(1, Math.ceil(x.length / POINTS)), points = [];
      for (let i = 0; i < x.length; i += step)
        if (Number.isFinite(x[i]) && Number.isFinite(y[i])) points.push(`${this.px(x[i]).toFixed(1)},${this.py(y[i]).toFixed(1)}`);
      this.curves[k].setAttribute("points", points.join(" "));
    }
  }
  const ends = values => values.reduce(([low, high], v) => Number.isFinite(v) ? [Math.min(low, v), Math.max(high, v)] : [low, high], [Infinity, -Infinity]);
  function span(values) {
    const low = Math.min(...values), high = Math.max(...values), room = 0.05 * (high - low) || 1;
    return { low: low - room, high: high + room };
  }
  function ticks({ low, high }) {
    const raw = (high - low) / 5, power = 10 ** Math.floor(Math.log10(raw)), step = [1, 2, 5, 10].find(f => f * power >= raw) * power;
    const first = Math.ceil(low / step);
    return Array.from({ length: Math.floor(high / step) - first + 1 }, (_, k) => Number(((first + k) * step).toPrecision(12)));
  }

  class Resimulation {
    constructor(root) {
      this.root = root;
      this.state = root.querySelector(".state");
      this.document = JSON.parse(root.querySelector("script").textContent);
      this.values = [];
      this.controls = [...root.querySelectorAll(".slider")].map((box, k) => new Control(this, box, this.document.sliders[k]));
      root.querySelector(".reset").addEventListener("click", () => { this.controls.forEach(one => one.reset()); this.refresh(); });
      this.choice = root.querySelector("select");
      this.choice?.addEventListener("change", () => this.load(this.choice.selectedIndex));
    }
    open() { if (!this.data) this.load(this.choice?.selectedIndex ?? 0); }
    // sliders stay where they are
    load(k) {
      const data = this.document.runs[k], { count } = data;
      this.data = data;
      this.run = { ...data, inputs: data.inputs.map(one => typeof one === "number" ? [one] : unpacked(one, Float64Array, count)) };
      this.channels = data.channels.map(one => ({ ...one, measured: unpacked(one.measured, Float32Array, count) }));
      this.time = Float64Array.from({ length: count }, (_, k) => k * data.dt);
      this.estimate = replay(rates, this.run, data.parameters);
      this.values = [...data.parameters];
      this.views = null;
      this.root.querySelectorAll(".views, .legend").forEach(place => place.replaceChildren());
      const away = this.deviation(), isAble = away <= this.document.agreement;
      this.controls.forEach(one => one.begin(isAble));
      this.root.querySelectorAll(".sliders, .reset").forEach(part => { part.hidden = !isAble; });
      if (!isAble) {
        this.state.textContent = `This run cannot be simulated here: it would differ from the prediction above by ${digits(away, 2)} of its range.`;
        return;
      }
      this.build();
      this.refresh();
      delete this.root.dataset.examined;
      this.examine(0, data);
    }
    // largest difference from the prediction of the fit, as a share of each channel's range
    deviation() {
      return Math.max(...this.channels.map(({ predicted, state, stride }) => {
        const [low, high] = ends(predicted);
        let largest = 0;
        predicted.forEach((value, k) => {
          const error = Math.abs(this.estimate.states[state][k * stride] - value);
          if (Number.isFinite(value)) largest = error > largest || Number.isNaN(error) ? error : largest;
        });
        return largest / (high - low || 1);
      }));
    }
    build() {
      const place = this.root.querySelector(".views"), [east, north] = this.channels.filter(one => one.is_position);
      const scaled = channel => one => (one.values ? one.values(channel) : channel.measured).map(v => v * channel.factor);
      this.views = [];
      if (north) {
        const view = new View(place, "Track: record, run at the estimates, run with the present coefficients", scaled(east), scaled(north), true);
        [view.xLabel, view.yLabel] = ["east [m]", "north [m]"];
        this.views.push(view);
      }
      const channel = this.channels.find(one => !one.is_position);
      if (channel) {
        const view = new View(place, `${channel.meaning} over time: record, run at the estimates, run with the present coefficients`, () => this.time, scaled(channel), false);
        [view.xLabel, view.yLabel] = ["t [s]", channel.label];
        this.views.push(view);
      }
      const legend = this.root.querySelector(".legend");
      for (const [name, words] of [["record", this.data.reference], ["estimate", "at the estimates"], ["now", "with these coefficients"]]) {
        const key = Object.assign(document.createElement("span"), { className: name, textContent: `— ${words}` });
        legend.append(key, " ");
      }
    }
    refresh() {
      if (!this.views) return;
      this.now = replay(rates, this.run, this.values);
      const series = [{}, this.estimate, this.now].map(run => run.states ? { values: channel => run.states[channel.state] } : {});
      this.views.forEach(view => view.frame(series));
      const { failed } = this.now;
      this.state.textContent = failed >= 0
        ? `With these coefficients the simulation diverges after ${digits(failed * this.data.dt, 3)} s of ${digits(this.time.at(-1), 3)} s.`
        : `Error (rms) with these coefficients, at the estimates in brackets: ${this.errors()}.`;
    }
    errors() {
      const position = this.channels.filter(one => one.is_position), texts = [];
      for (const channel of this.channels.filter(one => !one.is_position))
        texts.push(`${channel.meaning} ${this.pair([channel], channel.factor)} ${channel.unit}`);
      if (position.length) texts.push(`position ${this.pair(position, 1)} m`);
      return texts.join(", ");
    }
    pair(channels, factor) {
      const size = run => factor * Math.hypot(...channels.map(one => rms(one, run.states)));
      return `${digits(size(this.now), 3)} (${digits(size(this.estimate), 3)})`;
    }
    isStable(place, value) {
      const values = [...this.data.parameters];
      values[place] = value;
      return replay(rates, this.run, values).failed < 0;
    }
    // one coefficient after the other, so that the page answers in between, until another run is chosen
    examine(k, data) {
      if (data !== this.data) return;
      if (k === this.controls.length) return void (this.root.dataset.examined = "yes");
      this.controls[k].examine();
      setTimeout(() => this.examine(k + 1, data), 0);
    }
  }

  class Control {
    constructor(owner, box, { place, value, low, high }) {
      Object.assign(this, { owner, place, value, low, high });
      this.input = box.querySelector("input");
      this.output = box.querySelector("output");
      this.limits = box.querySelector(".range").appendChild(document.createElement("span"));
      this.input.addEventListener("input", () => {
        this.moveTo(this.low + (this.high - this.low) * this.input.value / STEPS);
        cancelAnimationFrame(owner.frame);
        owner.frame = requestAnimationFrame(() => owner.refresh());
      });
      this.reset();
    }
    moveTo(value) {
      this.present = value;
      this.owner.values[this.place] = value;
      this.output.textContent = digits(value);
      this.input.setAttribute("aria-valuetext", digits(value));
    }
    reset() {
      this.input.value = Math.round(STEPS * (this.value - this.low) / (this.high - this.low));
      this.moveTo(this.value);
    }
    // of a run that was chosen
    begin(isAble) {
      this.input.disabled = !isAble;
      this.limits.textContent = "";
      this.owner.values[this.place] = this.present;
    }
    // where between the estimate and an end of the slider the run begins to diverge
    edge(end) {
      if (this.owner.isStable(this.place, end)) return null;
      let [inside, outside] = [this.value, end];
      for (let k = 0; k < HALVINGS; k++) {
        const middle = (inside + outside) / 2;
        if (this.owner.isStable(this.place, middle)) inside = middle; else outside = middle;
      }
      return inside;
    }
    examine() {
      const [below, above] = [this.edge(this.low), this.edge(this.high)], texts = [];
      if (below !== null) texts.push(`below ${digits(below, 3)}`);
      if (above !== null) texts.push(`above ${digits(above, 3)}`);
      if (texts.length) this.limits.textContent = ` · the run diverges ${texts.join(" and ")}`;
    }
  }

  for (const root of document.querySelectorAll(".resimulation")) {
    const one = new Resimulation(root);
    root.addEventListener("toggle", () => root.open && one.open());
  }
}
