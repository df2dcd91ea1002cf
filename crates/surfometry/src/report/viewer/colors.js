// Colour scales, all of which the colour-blind can read.

const NO_VALUE = [96, 96, 96];

// A scale's colour at a share of its range.
function colorAt(scale, share) {
  const last = scale.colors.length - 1;
  const at = Math.min(Math.max(share, 0), 1) * last;
  const i = Math.min(Math.floor(at), last - 1);
  return [0, 1, 2].map(c => Math.round(scale.colors[i][c] + (at - i) * (scale.colors[i + 1][c] - scale.colors[i][c])));
}

function css([r, g, b]) {
  return `rgb(${r}, ${g}, ${b})`;
}

function rgbOf(hexadecimal) {
  return [1, 3, 5].map(i => parseInt(hexadecimal.slice(i, i + 2), 16));
}

function hexadecimalOf(rgb) {
  return "#" + rgb.map(part => part.toString(16).padStart(2, "0")).join("");
}

// 256 colours with an alpha of 255, as a texture takes them.
function colorTable(scale) {
  const table = new Uint8Array(4 * 256);
  for (let i = 0; i < 256; i++) table.set([...colorAt(scale, i / 255), 255], 4 * i);
  return table;
}

// A colour of its own for each of many objects that have none: hues a golden section apart.
function hueOf(number) {
  const hue = (number * 0.618034 + 0.55) % 1 * 6, light = [0.62, 0.5, 0.74][number % 3], chroma = 0.36;
  const part = n => {
    const k = (n + hue) % 6;
    return Math.round(255 * Math.min(1, light + chroma * (0.5 - Math.max(0, Math.min(k, 4 - k, 1)))));
  };
  return [part(5), part(3), part(1)];
}

// A bar of a scale's colours with its values.
function colorBar() {
  return drawn("svg", { class: "color-bar", viewBox: "0 0 420 36", "aria-hidden": "true" });
}

function drawColorBar(bar, scale, limits) {
  const [left, width, steps] = [46, 362, 64], x = value => left + (value - limits[0]) / (limits[1] - limits[0]) * width;
  const colors = Array.from({ length: steps }, (_, n) =>
    drawn("rect", { x: left + n * width / steps, y: 2, width: width / steps + 0.5, height: 12, fill: css(colorAt(scale, (n + 0.5) / steps)) }));
  const marks = ticks(limits, 5).flatMap(value => [
    drawn("line", { x1: x(value), x2: x(value), y1: 14, y2: 18, class: "axis" }),
    drawn("text", { x: x(value), y: 30, "text-anchor": "middle" }, digits(value))]);
  bar.replaceChildren(...colors, ...marks);
}
