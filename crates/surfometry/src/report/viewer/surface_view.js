// A view of surfaces that can be turned, with what lies over it: scale bar, directions, marks, lasso.

const TURN_A_PIXEL = 0.009;
// Height of the scale bar with its length, which lies below the whole object.
const FOOT = 44;
const DIRECTIONS = [["R", [1, 0, 0]], ["L", [-1, 0, 0]], ["A", [0, 1, 0]], ["P", [0, -1, 0]], ["S", [0, 0, 1]], ["I", [0, 0, -1]]];

class SurfaceView {
  // `what` is told of by a click or a lasso: vertices or parts.
  constructor(views, what, hints) {
    this.views = views;
    this.what = what;
    this.meshes = [];
    this.marks = [];
    this.camera = new Camera(views.find(view => view.name === "oblique"));
    this.canvas = element("canvas", {
      tabindex: 0, role: "img",
      "aria-label": "The surface. Arrow keys turn it, with Shift they move it, + and − zoom, 0 shows the whole object.",
    });
    this.overlay = drawn("svg", { class: "overlay", "aria-hidden": "true" });
    this.note = element("div", { class: "tip", hidden: true });
    this.element = element("div", { class: "scene" }, this.canvas, this.overlay, this.note);
    this.lassoButton = element("button", { type: "button", "aria-pressed": "false", onclick: () => this.setLasso(!this.lasso) }, "lasso");
    this.toolbar = element("div", { class: "toolbar" },
      ...views.map(view => element("button", { type: "button", value: view.name, onclick: () => this.look(view) }, view.name)),
      element("button", { type: "button", value: "whole", onclick: () => this.whole() }, "whole"),
      what === "vertices" && this.lassoButton,
      element("span", { class: "lead" }, hints));
    this.drawing = new SurfaceDrawing(this.canvas);
    this.listen();
    new ResizeObserver(() => this.resize()).observe(this.element);
  }

  add(mesh, solid) {
    this.meshes.push(mesh);
    return this.drawing.addPart(mesh, solid);
  }

  look(view) {
    this.camera.look(view);
    this.whole();
  }

  whole() {
    this.camera.fit(this.meshes, FOOT / Math.max(this.element.clientHeight, 4 * FOOT));
    this.redraw();
  }

  // Turns a place to the front, and marks it.
  show(point, outward) {
    if (outward) {
      const up = Math.abs(outward[2]) > 0.9 ? [0, 1, 0] : [0, 0, 1];
      const toward = unitOf(outward), right = unitOf(cross(up, toward));
      this.camera.look({ right, up: cross(toward, right), toward });
    }
    this.camera.center = [...point];
    this.redraw();
  }

  setLasso(on) {
    this.lasso = on;
    this.lassoButton.setAttribute("aria-pressed", String(on));
    this.element.classList.toggle("lassoing", on);
  }

  resize() {
    const { clientWidth, clientHeight } = this.element, scale = Math.min(window.devicePixelRatio || 1, 2);
    if (!clientWidth || !clientHeight) return;
    this.canvas.width = Math.round(clientWidth * scale);
    this.canvas.height = Math.round(clientHeight * scale);
    const first = !this.sized;
    this.sized = true;
    this.camera.aspect = clientWidth / clientHeight;
    if (first) this.whole();
    this.draw();
  }

  // Soon, however often it is asked.
  redraw() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => { this.waiting = false; this.draw(); });
  }

  draw() {
    if (!this.sized || !this.meshes.length || !this.element.clientHeight) return;
    this.drawing.draw(this.camera);
    this.drawOverlay();
    this.element.dataset.drawn = Number(this.element.dataset.drawn ?? 0) + 1;
  }

  drawOverlay() {
    const { clientWidth: width, clientHeight: height } = this.element;
    const mm = 2 * this.camera.halfHeight / height, bar = roundedDown(0.2 * width * mm);
    const letters = DIRECTIONS.flatMap(([letter, way]) => {
      const x = dot(way, this.camera.right), y = dot(way, this.camera.up), length = Math.hypot(x, y);
      if (length < 0.35) return [];
      const at = [58 + 38 * x, height - 58 - 38 * y];
      return [drawn("line", { x1: 58, y1: height - 58, x2: 58 + 28 * x, y2: height - 58 - 28 * y, class: "axis" }),
        drawn("text", { x: at[0], y: at[1] + 4, "text-anchor": "middle" }, letter)];
    });
    const barEnds = { x1: width - 20 - bar / mm, x2: width - 20, y1: height - 20, y2: height - 20 };
    const scaleBar = [
      drawn("line", { ...barEnds, class: "bar-rim" }),
      drawn("line", { ...barEnds, class: "bar" }),
      drawn("text", { x: width - 20 - bar / mm / 2, y: height - 27, "text-anchor": "middle" }, `${digits(bar)} mm`),
    ];
    const marks = this.marks.filter(mark => mark.shown !== false).map(mark => {
      const [x, y] = this.camera.project(mark.position, width, height);
      return drawn("g", { class: "mark", transform: `translate(${x} ${y})` },
        drawn("circle", { r: 9, stroke: mark.color ?? "#000" }), drawn("text", { y: 4, "text-anchor": "middle" }, mark.text));
    });
    const outline = this.outline && drawn("polyline", { points: this.outline.map(place => place.join(",")).join(" "), class: "lasso" });
    this.overlay.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.overlay.replaceChildren(...letters, ...scaleBar, ...marks, ...(outline ? [outline] : []));
  }

  listen() {
    const canvas = this.canvas;
    canvas.addEventListener("pointerdown", event => {
      canvas.setPointerCapture(event.pointerId);
      this.dragged = { from: placeIn(canvas, event), last: placeIn(canvas, event), moved: 0, button: event.button };
      if (this.lasso || event.altKey) this.outline = [this.dragged.from];
    });
    canvas.addEventListener("pointermove", event => this.dragged ? this.drag(event) : this.hover(event));
    canvas.addEventListener("pointerup", event => this.drop(event));
    canvas.addEventListener("pointercancel", () => { this.dragged = this.outline = null; this.redraw(); });
    canvas.addEventListener("pointerleave", () => { this.note.hidden = true; this.onhover?.(null); });
    canvas.addEventListener("contextmenu", event => event.preventDefault());
    canvas.addEventListener("dblclick", event => { if (!this.ondouble?.(this.at(placeIn(canvas, event)))) this.whole(); });
    canvas.addEventListener("wheel", event => {
      event.preventDefault();
      const [x, y] = placeIn(canvas, event), half = canvas.clientHeight / 2;
      this.camera.zoom(Math.exp(Math.min(Math.max(event.deltaY, -200), 200) * 0.0016), [(x - canvas.clientWidth / 2) / half, (half - y) / half]);
      this.redraw();
    }, { passive: false });
    canvas.addEventListener("keydown", event => { if (this.key(event)) { event.preventDefault(); this.redraw(); } });
  }

  drag(event) {
    const [x, y] = placeIn(this.canvas, event), [dx, dy] = [x - this.dragged.last[0], y - this.dragged.last[1]];
    this.dragged.last = [x, y];
    this.dragged.moved += Math.abs(dx) + Math.abs(dy);
    const mm = 2 * this.camera.halfHeight / this.canvas.clientHeight;
    if (this.outline) this.outline.push([x, y]);
    else if (event.shiftKey || this.dragged.button === 2) this.camera.pan(dx * mm, -dy * mm);
    else this.camera.turn(dx * TURN_A_PIXEL, dy * TURN_A_PIXEL);
    this.redraw();
  }

  drop(event) {
    const { moved, from } = this.dragged ?? {};
    const outline = this.outline;
    this.dragged = this.outline = null;
    if (outline && outline.length > 2) this.onlasso?.(this.within(outline));
    else if (moved < 4) this.onpick?.(this.at(from), event);
    this.redraw();
  }

  hover(event) {
    if (!this.onhover || this.looking) return;
    const place = placeIn(this.canvas, event);
    // One look a frame.
    this.looking = true;
    requestAnimationFrame(() => {
      this.looking = false;
      const text = this.onhover?.(this.at(place));
      this.note.hidden = !text;
      if (!text) return;
      this.note.textContent = text;
      this.note.style.left = `${place[0] + 14}px`;
      this.note.style.top = `${place[1] + 14}px`;
    });
  }

  key({ key, shiftKey }) {
    const arrows = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    if (arrows[key]) {
      const [x, y] = arrows[key], step = 0.1 * this.camera.halfHeight;
      if (shiftKey) this.camera.pan(x * step, -y * step); else this.camera.turn(x * 0.15, y * 0.15);
    } else if (key === "+" || key === "=") this.camera.zoom(0.85);
    else if (key === "-" || key === "−") this.camera.zoom(1 / 0.85);
    else if (key === "0" || key === "Home") this.whole();
    else return false;
    return true;
  }

  // The number of what is seen at a place; null where nothing is.
  at([x, y]) {
    const scale = this.canvas.width / this.canvas.clientWidth;
    const pixel = [Math.round(x * scale), this.canvas.height - 1 - Math.round(y * scale), 1, 1];
    const [seen] = this.drawing.seen(this.camera, this.what, pixel);
    return seen ? seen - 1 : null;
  }

  // Numbers of all that is seen within an outline.
  within(outline) {
    const { width, height } = this.canvas, scale = width / this.canvas.clientWidth;
    const mask = new OffscreenCanvas(width, height).getContext("2d");
    mask.beginPath();
    outline.forEach(([x, y]) => mask.lineTo(x * scale, y * scale));
    mask.fill();
    const inside = mask.getImageData(0, 0, width, height).data;
    const seen = this.drawing.seen(this.camera, this.what, [0, 0, width, height]);
    const found = new Set();
    for (let y = 0; y < height; y++) {
      for (let x = 0; x < width; x++) {
        const number = seen[(height - 1 - y) * width + x];
        if (number && inside[4 * (y * width + x) + 3] > 127) found.add(number - 1);
      }
    }
    return found;
  }

  release() {
    this.drawing.release();
  }
}

function roundedDown(value) {
  const decade = 10 ** Math.floor(Math.log10(value));
  return decade * [5, 2, 1].find(factor => factor * decade <= value);
}
