// How an attribute is distributed over the surface, by area; a range of it can be brushed.

const BINS = 72;

class Histogram {
  constructor(onbrush) {
    this.size = [420, 210];
    this.margin = { left: 46, right: 12, top: 10, bottom: 40 };
    this.onbrush = onbrush;
    this.svg = drawn("svg", { class: "histogram", viewBox: `0 0 ${this.size.join(" ")}`, role: "img", "aria-label": "Distribution over the surface; drag to choose a range" });
    this.element = element("div", {}, this.svg);
    this.listen();
  }

  // Shares of the area, the outer bins holding all that lies beyond the outer hundredths.
  setData(values, areas, attribute) {
    Object.assign(this, { values, areas, attribute, brush: null });
    const [low, high] = quantiles(values, areas, [0.01, 0.99]);
    const middle = (low + high) / 2, half = Math.max((high - low) / 2 * 1.04, 1e-6 * Math.abs(middle), 1e-12);
    this.range = Number.isNaN(low) ? [0, 1] : [middle - half, middle + half];
    this.all = this.shares(() => true);
    this.chosen = null;
    this.draw();
  }

  binOf(value) {
    const [low, high] = this.range;
    return Math.min(Math.max(Math.floor((value - low) / (high - low) * BINS), 0), BINS - 1);
  }

  shares(isIn) {
    const bins = new Float64Array(BINS);
    let total = 0;
    for (let i = 0; i < this.values.length; i++) {
      if (Number.isNaN(this.values[i])) continue;
      total += this.areas[i];
      if (isIn(i)) bins[this.binOf(this.values[i])] += this.areas[i];
    }
    return bins.map(sum => sum / (total || 1));
  }

  // Marks the vertices that are chosen; null for none.
  choose(marks) {
    this.chosen = marks && this.shares(i => marks[i]);
    this.draw();
  }

  setScale(scale, limits) {
    Object.assign(this, { scale, limits });
    this.draw();
  }

  x(value) {
    const [low, high] = this.range, { left, right } = this.margin;
    return left + (value - low) / (high - low) * (this.size[0] - left - right);
  }

  value(x) {
    const [low, high] = this.range, { left, right } = this.margin;
    return low + Math.min(Math.max((x - left) / (this.size[0] - left - right), 0), 1) * (high - low);
  }

  draw() {
    if (!this.all || !this.scale) return;
    const [width, height] = this.size, { left, right, top, bottom } = this.margin;
    const floor = height - bottom, most = Math.max(...this.all, 1e-9), step = (width - left - right) / BINS;
    const bars = (shares, style) => [...shares].map((share, n) => {
      const tall = share / most * (floor - top), value = this.range[0] + (n + 0.5) / BINS * (this.range[1] - this.range[0]);
      const fill = css(colorAt(this.scale, (value - this.limits[0]) / (this.limits[1] - this.limits[0])));
      return share > 0 && drawn("rect", { x: left + n * step, y: floor - tall, width: step * 0.92, height: tall, fill, ...style });
    });
    const marks = ticks(this.range, 5).flatMap(value => [
      drawn("line", { x1: this.x(value), x2: this.x(value), y1: floor, y2: floor + 4, class: "axis" }),
      drawn("text", { x: this.x(value), y: floor + 16, "text-anchor": "middle" }, digits(value))]);
    const percent = ticks([0, 100 * most], 3).map(value =>
      drawn("text", { x: left - 6, y: floor - value / 100 / most * (floor - top) + 4, "text-anchor": "end" }, digits(value)));
    const brush = this.brush && drawn("rect", { class: "brush", x: this.x(this.brush[0]), y: top, width: Math.max(1, this.x(this.brush[1]) - this.x(this.brush[0])), height: floor - top });
    this.svg.replaceChildren(...[
      ...bars(this.all, this.chosen ? { class: "faint" } : { class: "all" }),
      ...(this.chosen ? bars(this.chosen, { class: "chosen" }) : []),
      drawn("line", { x1: left, x2: width - right, y1: floor, y2: floor, class: "axis" }), ...marks, ...percent,
      drawn("text", { x: (left + width - right) / 2, y: height - 5, "text-anchor": "middle" }, titled(this.attribute)),
      drawn("text", { transform: `translate(11 ${(top + floor) / 2}) rotate(-90)`, "text-anchor": "middle" }, "area (%)"),
      brush,
    ].filter(Boolean));
  }

  setBrush(range) {
    this.brush = range;
    this.draw();
    this.onbrush(range);
  }

  listen() {
    const place = event => placeIn(this.svg, event)[0] * this.size[0] / this.svg.getBoundingClientRect().width;
    let from = null;
    this.svg.addEventListener("pointerdown", event => { this.svg.setPointerCapture(event.pointerId); from = place(event); });
    this.svg.addEventListener("pointermove", event => {
      if (from === null || Math.abs(place(event) - from) < 3) return;
      this.setBrush([from, place(event)].map(x => this.value(x)).sort((a, b) => a - b));
    });
    this.svg.addEventListener("pointerup", event => {
      if (from !== null && Math.abs(place(event) - from) < 3) this.setBrush(null);
      from = null;
    });
  }
}
