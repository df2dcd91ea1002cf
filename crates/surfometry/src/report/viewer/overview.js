// The page of many objects: their table, their distributions, and all of one image together.

const SPREAD = COLUMNS.filter(column => !column.text).map(({ key, title }) => ({ value: key, text: title }));

const TINTS = [{ value: "own", text: "own colours" }, ...SPREAD];

class Overview {
  constructor(page) {
    this.page = page;
    this.images = this.imagesOfMany();
    this.table = new ObjectTable(page, rows => this.drawSpread(rows));
    this.spread = drawn("svg", { viewBox: "0 0 420 150", class: "histogram", role: "img", "aria-label": "Distribution over the objects" });
    this.measure = SPREAD[0].value;
    this.tint = TINTS[0].value;
    this.stage = element("div", {});
    this.element = element("article", { class: "overview" },
      this.images.length > 0 && element("section", { class: "together" }, element("h2", {}, "Together"), this.stage),
      element("section", {}, element("h2", {}, "Objects"),
        element("div", { class: "controls" }, choice("Distribution of", SPREAD, this.measure, key => { this.measure = key; this.drawSpread(this.table.shown()); }),
          "Save what is shown: ", downloadButtons(page, () => this.table.shown())),
        this.spread, this.table.element,
        element("p", { class: "lead" }, "Volume, area and curvature are the original object's, where they are defined, with standard errors; a dash stands for what could not be had. Click a row to find it in the scene, its name to open it.")));
    this.drawSpread(this.table.shown());
    this.table.onpick = number => this.pick(number, false);
    this.table.onpoint = number => this.point(number);
    this.marked = null;
  }

  // Inputs of several objects, with the numbers of those that have surfaces, each of which has a colour then.
  imagesOfMany() {
    const images = new Map();
    this.page.objects.forEach((object, number) => {
      if (!object.scene_note) images.set(object.result.input, [...(images.get(object.result.input) ?? []), number]);
    });
    const several = [...images].filter(([, numbers]) => numbers.length > 1).map(([input, numbers]) => ({ input, numbers }));
    several.flatMap(image => image.numbers).forEach(number => { this.page.objects[number].colour ??= hexadecimalOf(hueOf(number)); });
    return several;
  }

  async fill() {
    if (this.images.length) await this.showTogether(this.images[0]);
  }

  async showTogether(image) {
    this.leave();
    const turn = this.turn = {};
    let view;
    try {
      view = this.view = new SurfaceView(this.page.views, "parts", "click chooses, double-click opens");
    } catch (error) {
      return this.stage.replaceChildren(element("p", {}, error.message));
    }
    this.parts = [];
    const options = this.images.map(({ input }) => ({ value: input, text: input }));
    const others = options.length > 1 && choice("Image", options, image.input, input => this.showTogether(this.images.find(other => other.input === input)));
    this.legend = colorBar();
    const tint = choice("Colour by", TINTS, this.tint, key => { this.tint = key; this.recolour(); });
    this.stage.replaceChildren(element("div", { class: "controls" }, ...[others, tint, this.legend].filter(Boolean)), view.toolbar, view.element);
    const numberOf = part => part === null ? null : this.parts[part].number;
    view.onpick = part => this.pick(numberOf(part), true);
    view.ondouble = part => part !== null && (location.hash = `object-${numberOf(part) + 1}`);
    view.onhover = part => { this.table.mark(numberOf(part) ?? this.marked, false); return part === null ? "" : this.page.objects[numberOf(part)].title; };
    for (const number of image.numbers) {
      const scene = await unpackedScene(number);
      if (turn !== this.turn) return;
      const own = rgbOf(this.page.objects[number].colour);
      this.parts.push({ number, own, solid: own, part: view.add(scene.mesh, own) });
    }
    this.recolour();
    view.whole();
    view.element.dataset.ready = "yes";
  }

  // Own colours, or those of a measure, from its least to its largest value.
  recolour() {
    const value = ({ number }) => this.page.objects[number].result[this.tint] ?? NaN;
    const known = this.tint === "own" ? [] : this.parts.map(value).filter(Number.isFinite);
    const limits = [Math.min(...known), Math.max(...known)], scale = this.page.scales.find(scale => !scale.signed);
    const shown = limits[1] > limits[0];
    for (const part of this.parts) {
      part.solid = !shown ? part.own : Number.isFinite(value(part)) ? colorAt(scale, (value(part) - limits[0]) / (limits[1] - limits[0])) : NO_VALUE;
    }
    if (shown) drawColorBar(this.legend, scale, limits); else this.legend.replaceChildren();
    this.light(this.marked);
  }

  // Chooses an object in the table and the scene alike; null for none.
  pick(number, scroll) {
    this.marked = number === this.marked ? null : number;
    this.table.mark(this.marked, scroll);
    this.light(this.marked);
  }

  point(number) {
    this.light(number ?? this.marked);
  }

  // Dims all others.
  light(number) {
    if (!this.view) return;
    const lit = this.parts.find(part => part.number === number);
    for (const { part, solid } of this.parts) part.solid = !lit || part === lit.part ? solid : solid.map(c => Math.round(0.2 * c + 0.8 * 236));
    this.view.redraw();
  }

  // A dot an object, one above the other where they would hide each other.
  drawSpread(rows) {
    if (!this.spread) return;
    const values = rows.flatMap(row => row.result[this.measure] === null ? [] : [{ value: row.result[this.measure], row }]).sort((a, b) => a.value - b.value);
    if (!values.length) return this.spread.replaceChildren();
    const [low, high] = [values[0].value, values.at(-1).value], room = Math.max((high - low) * 0.03, Math.abs(high) * 1e-6, 1e-12);
    const x = value => 14 + (value - low + room) / (high - low + 2 * room) * 392, floor = 118;
    const radius = Math.min(4, Math.max(1.2, 60 / Math.sqrt(values.length))), heights = new Map();
    const places = values.map(({ value }) => {
      const column = Math.round(x(value) / (2 * radius)), tall = heights.get(column) ?? 0;
      heights.set(column, tall + 1);
      return tall;
    });
    // The tallest stack fits.
    const step = Math.min(2 * radius, (floor - 6 - 2 * radius) / Math.max(1, ...places));
    const dots = values.map(({ value, row }, n) =>
      drawn("circle", { cx: x(value), cy: floor - radius - places[n] * step, r: radius, class: "dot", onclick: () => this.pick(row.number, true) }, drawn("title", {}, `${row.title}: ${digits(value)}`)));
    const median = (values[(values.length - 1) >> 1].value + values[values.length >> 1].value) / 2;
    this.spread.replaceChildren(...dots,
      drawn("line", { x1: 10, x2: 410, y1: floor, y2: floor, class: "axis" }),
      drawn("line", { x1: x(median), x2: x(median), y1: 8, y2: floor, class: "used" }),
      ...ticks([low, high], 5).map(value => drawn("text", { x: x(value), y: floor + 14, "text-anchor": "middle" }, digits(value, 4))),
      drawn("text", { x: 210, y: 146, "text-anchor": "middle" }, `${SPREAD.find(({ value }) => value === this.measure).text} of ${values.length} objects; the line is their median`));
  }

  leave() {
    this.turn = null;
    this.view?.release();
    this.view = null;
  }
}
