// The viewer of one object: the surface, its colours, and its distribution, each of which lights up in the other.

class SurfaceViewer {
  constructor(scene, page) {
    Object.assign(this, { scene, page });
    this.attributes = attributesOf(scene, page.quantities);
    this.scales = { true: page.scales.find(scale => scale.signed), false: page.scales.find(scale => !scale.signed) };
    this.view = new SurfaceView(page.views, "vertices", "drag turns, Shift-drag moves, wheel zooms; click or lasso chooses");
    this.part = this.view.add(scene.mesh);
    this.histogram = new Histogram(range => this.brush(range));
    this.view.onpick = vertex => this.pick(vertex);
    this.view.onlasso = vertices => this.choose(vertices.size ? this.cornersAround(vertices) : null);
    this.view.onhover = vertex => vertex === null ? "" : this.valueText(vertex);
    this.chosenText = element("p", { class: "lead chosen-text", "aria-live": "polite" });
    this.controls = element("div", { class: "controls" });
    this.colorBar = colorBar();
    const first = this.attributes.find(attribute => attribute.name === "mean_curvature_per_mm");
    this.setAttribute(first.key);
    this.choose(null);
  }

  element() {
    const { of_triangles, of_vertices } = this.scene.head, shown = this.scene.mesh.triangles.length / 3;
    const simplified = shown < of_triangles &&
      element("p", { class: "lead" }, `For display ${shown} of the surface's ${of_triangles} triangles are drawn, between ${this.scene.count} of its ${of_vertices} vertices; the numbers of the tables are those of all.`);
    return element("div", {}, this.view.toolbar,
      element("div", { class: "viewer" }, this.view.element,
        element("div", { class: "side" }, this.controls, this.histogram.element, this.colorBar, this.chosenText)),
      simplified,
      element("p", { class: "lead" }, "Coordinates are RAS, mm. Dark grey: no value there. Colours and histogram are of the vertices that are drawn, by area, rounded to a few thousandths of their range."));
  }

  setAttribute(key) {
    this.attribute = this.attributes.find(attribute => attribute.key === key);
    this.values = this.attribute.values();
    this.limits = this.typed = this.fullLimits = robustLimits(this.attribute, this.values, this.scene.areas);
    this.view.drawing.setValues(this.part, this.values);
    this.histogram.setData(this.values, this.scene.areas, this.attribute);
    this.setScale(this.scales[this.attribute.signed]);
    this.drawControls();
    this.choose(null);
  }

  setScale(scale) {
    this.scale = this.scales[this.attribute.signed] = scale;
    this.view.drawing.setScale(scale, this.limits);
    this.histogram.setScale(scale, this.limits);
    drawColorBar(this.colorBar, scale, this.limits);
    this.view.redraw();
  }

  setLimits(limits) {
    const fits = limits[1] > limits[0];
    this.typed = limits;
    this.controls.querySelectorAll("input").forEach(input => {
      const limit = limits[input.dataset.end];
      if (document.activeElement !== input && Number.isFinite(limit)) input.value = shortened(limit);
      input.setAttribute("aria-invalid", String(!fits));
      input.title = fits ? "" : "The range must rise: what is drawn keeps the one before.";
    });
    if (!fits) return;
    this.limits = limits;
    this.setScale(this.scale);
  }

  drawControls() {
    const options = this.attributes.map(({ key, group, title, unit }) => ({ value: key, group, text: titled({ title, unit }) }));
    const suitable = this.page.scales.filter(scale => scale.signed === this.attribute.signed);
    const [low, high] = this.fullLimits, room = (high - low) / 2;
    const ends = ["from", "to"].map((name, end) => {
      const set = event => this.setLimits(this.typed.map((limit, n) => n === end ? event.target.valueAsNumber : limit));
      // A range without its step rounds its value.
      const slide = { min: this.attribute.signed ? low - room : 0, max: high + room, step: (high - low) / 400 };
      const common = { "data-end": end, value: shortened(this.limits[end]) };
      return element("span", { class: "end" },
        element("label", {}, name + " ", element("input", { type: "number", class: "limit", step: "any", ...common, onchange: set })),
        element("input", { type: "range", class: "slide", "aria-label": `Colours ${name}`, ...slide, ...common, oninput: set }));
    });
    this.controls.replaceChildren(
      choice("Colour by", options, this.attribute.key, key => this.setAttribute(key)),
      choice("Colours", suitable.map(scale => ({ value: scale.name, text: scale.name })), this.scale.name,
        name => this.setScale(this.page.scales.find(scale => scale.name === name))),
      element("span", { class: "ends" }, ...ends,
        element("button", { type: "button", onclick: () => { this.setLimits(this.fullLimits); this.drawControls(); } }, "reset")));
  }

  // Lights up where values lie in a range.
  brush(range) {
    this.chooseMarks(range && this.marksOf(value => value >= range[0] && value <= range[1]));
  }

  marksOf(test) {
    return Uint8Array.from(this.values, value => test(value) ? 1 : 0);
  }

  // Marks of the corners of all triangles that have one of some vertices: a triangle is seen by its last corner.
  cornersAround(vertices) {
    const { triangles } = this.scene.mesh, marks = new Uint8Array(this.scene.count);
    for (let t = 0; t < triangles.length; t += 3) {
      const corners = [triangles[t], triangles[t + 1], triangles[t + 2]];
      if (corners.some(corner => vertices.has(corner))) corners.forEach(corner => { marks[corner] = 1; });
    }
    return marks;
  }

  // A vertex and those around it.
  pick(vertex) {
    if (vertex === null) return this.choose(null);
    this.choose(this.cornersAround(new Set([vertex])));
    this.chosenText.textContent = this.valueText(vertex) + ", at " + this.placeText(vertex);
    this.onplace?.([0, 1, 2].map(a => this.scene.mesh.positions[3 * vertex + a]));
  }

  // Marks of vertices, which the histogram shows too; null lets go.
  choose(marks) {
    this.histogram.brush = null;
    this.chooseMarks(marks);
    this.histogram.choose(marks);
  }

  chooseMarks(marks) {
    this.marks = marks;
    this.view.drawing.dimmed = Boolean(marks);
    this.view.drawing.setMarks(this.part, marks ?? new Uint8Array(this.scene.count));
    this.view.redraw();
    this.chosenText.textContent = marks ? this.summary(marks) : "Drag over the histogram to light up where on the surface its values are.";
  }

  summary(marks) {
    let area = 0, all = 0, sum = 0, squares = 0, least = Infinity, most = -Infinity;
    this.values.forEach((value, i) => {
      if (Number.isNaN(value)) return;
      const weight = this.scene.areas[i];
      all += weight;
      if (!marks[i]) return;
      area += weight; sum += weight * value; squares += weight * value * value;
      least = Math.min(least, value); most = Math.max(most, value);
    });
    if (!area) return "Nothing of the surface has such values.";
    const mean = sum / area, deviation = Math.sqrt(Math.max(0, squares / area - mean * mean));
    return `Chosen: ${digits(100 * area / all, 3)} % of the area, ${digits(area, 4)} mm²; mean ${digits(mean, 4)}, s.d. ${digits(deviation, 3)}, from ${digits(least, 4)} to ${digits(most, 4)} ${unitText(this.attribute.unit)}`;
  }

  valueText(vertex) {
    const error = this.attributes.find(other => other.of === this.attribute.of && other.name === this.attribute.name + "_standard_error");
    const value = this.values[vertex];
    if (Number.isNaN(value)) return `${this.attribute.title}: no value`;
    return `${this.attribute.title} ${error ? withError(value, error.values()[vertex]) : digits(value, 4)} ${unitText(this.attribute.unit)}`;
  }

  placeText(vertex) {
    return `(${[0, 1, 2].map(a => digits(this.scene.mesh.positions[3 * vertex + a], 5)).join(", ")}) mm`;
  }
}

function shortened(value) {
  return Number(value.toPrecision(6));
}
