// Numbers over a range of blurs, and where the choice does not matter.

const LINE_COLORS = { original: "#0072b2", blurred: "#d55e00", voxels: "#666666" };

function sweepPart(sweep, sigma) {
  const { plateau } = sweep;
  const said = plateau
    ? `Plateau: from σ = ${digits(plateau.from_mm, 3)} to ${digits(plateau.to_mm, 3)} mm volume, area and total mean curvature of the original object stay within their 95 % intervals (at least 0.5 %, at most 2 %): the choice of blur does not matter there.`
    : "No plateau: at no four neighbouring blurs do volume, area and total mean curvature of the original object stay within their 95 % intervals (at least 0.5 %, at most 2 %).";
  const outside = plateau && (sigma < plateau.from_mm * 0.999 || sigma > plateau.to_mm * 1.001)
    && element("p", { class: "lead" }, `The numbers of this page are at σ = ${digits(sigma, 4)} mm, which lies outside it.`);
  const legend = Object.entries(LINE_COLORS).map(([name, color]) => {
    const swatch = element("span", { class: "swatch" });
    swatch.style.background = color;
    return element("span", { class: "key" }, swatch, name);
  });
  return part("What depends on the blur",
    element("p", { class: plateau ? "plateau" : "" }, said), outside,
    element("p", { class: "lead" }, "Detail that all of these blurs take away is in none of these numbers, however level a line is: the flags tell of it. ", ...legend, " bars: 95 %, cut off where they are much longer than what the values differ by."),
    element("div", { class: "sweep" }, ...sweep.panels.map(panel => sweepPanel(sweep, panel))));
}

function sweepPanel(sweep, panel) {
  const [width, height] = [380, 210], left = 66, right = 12, top = 24, floor = height - 36;
  const values = panel.lines.flatMap(line => line.values).filter(value => value !== null);
  if (!values.length) return null;
  // One long bar does not flatten all lines.
  const [lowest, highest] = [Math.min(...values), Math.max(...values)], longest = Math.max(highest - lowest, 0.02 * Math.abs(highest));
  const bar = (line, i) => Math.min(line.intervals[i] ?? 0, longest);
  const known = panel.lines.flatMap(line => line.values.flatMap((value, i) => value === null ? [] : [value - bar(line, i), value + bar(line, i)]));
  const least = Math.min(...known), most = Math.max(...known), room = Math.max((most - least) * 0.08, Math.abs(most) * 1e-4, 1e-9);
  const logs = sweep.sigma_mm.map(Math.log), span = logs.at(-1) - logs[0] || 1;
  const x = sigma => left + 10 + (Math.log(sigma) - logs[0]) / span * (width - left - right - 20);
  const y = value => floor - (value - least + room) / (most - least + 2 * room) * (floor - top);
  const shade = sweep.plateau && drawn("rect", { class: "plateau", x: x(sweep.plateau.from_mm) - 4, y: top, width: x(sweep.plateau.to_mm) - x(sweep.plateau.from_mm) + 8, height: floor - top });
  const lines = panel.lines.flatMap(line => {
    const color = LINE_COLORS[line.name] ?? "#000";
    const points = line.values.flatMap((value, i) => value === null ? [] : [[x(sweep.sigma_mm[i]), y(value), y(value - bar(line, i)), y(value + bar(line, i))]]);
    return [
      drawn("polyline", { points: points.map(([a, b]) => `${a},${b}`).join(" "), fill: "none", stroke: color, "stroke-width": 1.6 }),
      ...points.flatMap(([a, b, low, high]) => [
        drawn("circle", { cx: a, cy: b, r: 2.6, fill: color }),
        low !== high && drawn("line", { x1: a, x2: a, y1: low, y2: high, stroke: color, "stroke-width": 1.2 })].filter(Boolean)),
    ];
  });
  const marks = [
    ...sweep.sigma_mm.filter((_, i) => i % 2 === 0).map(sigma => drawn("text", { x: x(sigma), y: floor + 15, "text-anchor": "middle" }, digits(sigma, 3))),
    ...ticks([least - room, most + room], 4).map(value => drawn("text", { x: left - 6, y: y(value) + 4, "text-anchor": "end" }, digits(value, 5))),
  ];
  const used = drawn("line", { x1: x(sweep.used_mm), x2: x(sweep.used_mm), y1: top, y2: floor, class: "used" });
  return drawn("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": panel.name }, ...[shade, used,
    drawn("text", { x: left, y: 14, class: "panel-name" }, panel.name),
    drawn("path", { d: `M${left} ${top}V${floor}H${width - right}`, class: "axis", fill: "none" }), ...lines, ...marks,
    drawn("text", { x: (left + width - right) / 2, y: height - 4, "text-anchor": "middle" }, "σ (mm)")].filter(Boolean));
}
