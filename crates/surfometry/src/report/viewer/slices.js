// Slices through mask, embedding, smeared delta and curvature, with the contour phi = 0.

const SHOWN = [
  { value: "mask", text: "mask" }, { value: "phi", text: "embedding φ" },
  { value: "delta", text: "smeared delta of φ" }, { value: "curvature", text: "mean curvature H in the band (1/mm)" },
];
// Pixels of the longer side of a picture.
const PICTURE = 360;

class Slices {
  constructor(scene, page) {
    Object.assign(this, { scene, kind: "mask" });
    this.signed = page.scales.find(scale => scale.signed);
    this.unsigned = page.scales.find(scale => !scale.signed);
    this.panels = scene.head.slices.map(stack => this.panel(stack));
    this.legend = colorBar();
    this.element = element("div", {},
      element("div", { class: "controls" }, choice("Show", SHOWN, this.kind, kind => { this.kind = kind; this.draw(); }), this.legend),
      element("div", { class: "slices" }, ...this.panels.map(panel => panel.element)));
    this.draw();
  }

  panel(stack) {
    const { bytes } = this.scene, canvas = element("canvas", { tabindex: 0, role: "img", "aria-label": `${stack.name} slice` });
    const largest = Math.max(stack.size[0] * stack.spacing[0], stack.size[1] * stack.spacing[1]);
    [canvas.width, canvas.height] = stack.size.map((n, a) => Math.max(24, Math.round(n * stack.spacing[a] / largest * PICTURE)));
    const name = element("div", { class: "slice-name" });
    const slider = element("input", { type: "range", min: 0, max: stack.slices.length - 1, value: stack.first, "aria-label": `${stack.name} slice`, disabled: stack.slices.length < 2 });
    const letters = element("div", { class: "slice-letters", "aria-hidden": "true" }, ...stack.letters.map((letter, side) => element("span", { class: "side-" + side }, letter)));
    const panel = { stack, canvas, name, slider, number: stack.first, mark: null };
    panel.arrays = Object.fromEntries(["mask", "phi", "curvature"].map(key => [key, integers(bytes, stack[key])]));
    const to = number => { panel.number = Math.min(Math.max(number, 0), stack.slices.length - 1); slider.value = panel.number; this.drawPanel(panel); };
    panel.to = to;
    slider.addEventListener("input", () => to(Number(slider.value)));
    canvas.addEventListener("wheel", event => { event.preventDefault(); to(panel.number - Math.sign(event.deltaY)); }, { passive: false });
    canvas.addEventListener("keydown", event => {
      const step = { ArrowUp: 1, ArrowRight: 1, ArrowDown: -1, ArrowLeft: -1 }[event.key];
      if (step) { event.preventDefault(); to(panel.number + step); }
    });
    panel.element = element("figure", {}, name, element("div", { class: "slice" }, canvas, letters), slider);
    return panel;
  }

  draw() {
    this.panels.forEach(panel => this.drawPanel(panel));
    if (this.kind === "mask") this.legend.replaceChildren();
    else drawColorBar(this.legend, this.scale(), this.limits());
  }

  scale() {
    return this.kind === "delta" ? this.unsigned : this.signed;
  }

  limits() {
    const { phi_reach, delta, slices } = this.scene.head;
    if (this.kind === "delta") return [0, Math.max(...delta)];
    if (this.kind === "phi") return [-phi_reach, phi_reach];
    const most = Math.max(...slices.map(stack => stack.limit), 1e-9);
    return [-most, most];
  }

  // The colour of a pixel.
  color(panel, place) {
    const { mask, phi, curvature } = panel.arrays, [low, high] = this.limits();
    const colored = value => colorAt(this.scale(), (value - low) / (high - low));
    switch (this.kind) {
      case "mask": return mask[place] ? [176, 176, 176] : [246, 246, 246];
      case "phi": return colored(((phi[place] + 0.5) / 128 - 1) * this.scene.head.phi_reach);
      case "delta": return colored(this.scene.head.delta[phi[place]]);
      default: return curvature[place] ? colored((curvature[place] - 128) / 127 * panel.stack.limit) : [246, 246, 246];
    }
  }

  drawPanel(panel) {
    const { stack, canvas, number } = panel, [width, height] = stack.size, start = number * width * height;
    const image = new ImageData(width, height);
    for (let v = 0; v < height; v++) {
      for (let u = 0; u < width; u++) image.data.set([...this.color(panel, start + v * width + u), 255], 4 * ((height - 1 - v) * width + u));
    }
    const small = new OffscreenCanvas(width, height);
    small.getContext("2d").putImageData(image, 0, 0);
    const context = canvas.getContext("2d");
    context.imageSmoothingEnabled = false;
    context.drawImage(small, 0, 0, canvas.width, canvas.height);
    const phi = place => panel.arrays.phi[start + place] - 127.5;
    const [sx, sy] = [canvas.width / width, canvas.height / height];
    context.beginPath();
    for (const [[u, v], [s, t]] of contour(phi, stack.size)) {
      context.moveTo((u + 0.5) * sx, canvas.height - (v + 0.5) * sy);
      context.lineTo((s + 0.5) * sx, canvas.height - (t + 0.5) * sy);
    }
    context.lineWidth = 1.6;
    context.strokeStyle = this.kind === "mask" ? "#c1121f" : this.kind === "delta" ? "#ffffff" : "#000000";
    context.stroke();
    if (panel.mark) {
      context.beginPath();
      context.arc((panel.mark[0] + 0.5) * sx, canvas.height - (panel.mark[1] + 0.5) * sy, 6, 0, 2 * Math.PI);
      context.strokeStyle = "#000"; context.lineWidth = 3; context.stroke();
      context.strokeStyle = "#ffd60a"; context.lineWidth = 1.5; context.stroke();
    }
    const skipped = stack.every > 1 ? `, every ${ordinal(stack.every)} voxel` : "";
    panel.name.textContent = `${stack.name}, voxel ${stack.axis} = ${stack.slices[number]} (${number + 1} of ${stack.slices.length})${skipped}`;
  }

  // The slices nearest to a place in the world, which is marked.
  goTo(position) {
    const voxel = toVoxel(this.scene.head, position);
    for (const panel of this.panels) {
      const { stack } = panel, across = "xyz".indexOf(stack.axis);
      panel.mark = stack.along.map(step => {
        const axis = step.findIndex(n => n !== 0);
        return axis < 0 ? 0 : (voxel[axis] - stack.corner[axis]) / step[axis];
      });
      const away = stack.slices.map(slice => Math.abs(slice - voxel[across]));
      panel.to(away.indexOf(Math.min(...away)));
    }
  }
}

function ordinal(n) {
  return n === 2 ? "2nd" : n === 3 ? "3rd" : `${n}th`;
}

// Where a field is 0 between pixels, as segments; pixels at whole numbers.
function contour(field, [width, height]) {
  const segments = [];
  for (let v = 0; v + 1 < height; v++) {
    for (let u = 0; u + 1 < width; u++) {
      const corners = [[u, v], [u + 1, v], [u + 1, v + 1], [u, v + 1]].map(([x, y]) => [x, y, field(y * width + x)]);
      const crossings = [];
      corners.forEach(([x, y, from], n) => {
        const [s, t, to] = corners[(n + 1) % 4];
        if ((from < 0) !== (to < 0)) crossings.push([x + (s - x) * from / (from - to), y + (t - y) * from / (from - to)]);
      });
      for (let n = 0; n + 1 < crossings.length; n += 2) segments.push([crossings[n], crossings[n + 1]]);
    }
  }
  return segments;
}

// The voxel, with decimals, at a place in the world.
function toVoxel({ linear, origin }, position) {
  const [a, b, c] = [0, 1, 2].map(axis => linear.map(row => row[axis]));
  const away = position.map((v, w) => v - origin[w]), volume = dot(a, cross(b, c));
  return [dot(away, cross(b, c)), dot(away, cross(c, a)), dot(away, cross(a, b))].map(v => v / volume);
}
