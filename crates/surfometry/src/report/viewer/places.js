// Where something happened that is told of: changes of topology, voxels on the wrong side, cuts.

const CLOUDS = {
  lost: ["voxels of the object that lie outside the surface: lost to the blur", [230, 120, 0]],
  filled: ["background voxels inside the surface: gaps that the blur filled", [0, 114, 178]],
  cut: ["voxels at the image's edge, where it may cut the object", [120, 120, 120]],
};

// The flags that tell of a cloud.
const FLAGS_OF_CLOUDS = { lost: "detail-lost", filled: "detail-lost", cut: "touches-border" };

// Most changes of topology that are listed.
const LISTED = 40;

function changeText(change) {
  const stage = change.stage === "blur" ? "by the blur" : `in the band, at ${digits(100 * change.share, 3)} % of its levels`;
  return `${change.kind.replaceAll("-", " ")} ${stage}, ${digits(change.width_mm, 3)} mm wide`;
}

// A list of the places; each can be looked at in the viewer, if there is one.
function placesPart(result, viewer, slices) {
  const changes = [...(result.topology.changes ?? [])].sort((a, b) => b.width_mm - a.width_mm);
  const go = position => {
    viewer?.view.show(position);
    slices?.goTo(position);
  };
  const items = changes.slice(0, LISTED).map((change, n) => {
    const button = element("button", { type: "button", onclick: () => go(change.position_mm) }, String(n + 1));
    return element("li", {}, button, " ", changeText(change), `, at (${change.position_mm.map(v => digits(v, 5)).join(", ")}) mm`);
  });
  if (viewer) {
    viewer.view.marks = changes.slice(0, LISTED).map((change, n) =>
      ({ position: change.position_mm, text: String(n + 1), color: change.stage === "blur" ? "#b3261e" : "#5d6b7c" }));
  }
  const clouds = viewer ? viewer.scene.head.clouds.map(cloud => cloudItem(cloud, viewer, result.flags)) : [];
  if (!items.length && !clouds.length) return null;
  const rest = changes.length > LISTED && element("p", { class: "lead" }, `The ${LISTED} widest of ${changes.length} changes of topology.`);
  return part("Places",
    clouds.length > 0 && element("ul", { class: "clouds" }, ...clouds),
    items.length > 0 && element("p", { class: "lead" }, "Where the topology of what was measured is another than that of the voxels; numbers are marked on the surface."),
    items.length > 0 && element("ol", { class: "places" }, ...items), rest);
}

function cloudItem(cloud, viewer, flags) {
  const { head, bytes } = viewer.scene, [text, color] = CLOUDS[cloud.kind];
  const voxels = integers(bytes, cloud.voxels);
  const positions = new Float32Array(voxels.length);
  for (let i = 0; i < voxels.length; i += 3) positions.set(toWorld(head, voxels.subarray(i, i + 3)), i);
  const edge = Math.abs(head.linear[0][0] * (head.linear[1][1] * head.linear[2][2] - head.linear[1][2] * head.linear[2][1])
    - head.linear[0][1] * (head.linear[1][0] * head.linear[2][2] - head.linear[1][2] * head.linear[2][0])
    + head.linear[0][2] * (head.linear[1][0] * head.linear[2][1] - head.linear[1][1] * head.linear[2][0])) ** (1 / 3);
  const drawing = viewer.view.drawing.addCloud(positions, color, 0.6 * edge);
  drawing.shown = cloud.kind !== "cut";
  const toggle = event => { drawing.shown = event.target.checked; viewer.view.redraw(); };
  const swatch = element("span", { class: "swatch" });
  swatch.style.background = css(color);
  const shown = voxels.length / 3 < cloud.count ? `, ${voxels.length / 3} of them drawn` : "";
  // Of a few voxels no flag is raised.
  const raised = flags.some(flag => flag.code === FLAGS_OF_CLOUDS[cloud.kind]) ? ` (${FLAGS_OF_CLOUDS[cloud.kind]})` : "";
  return element("li", {}, element("label", {},
    element("input", { type: "checkbox", checked: drawing.shown, "data-cloud": cloud.kind, onchange: toggle }), " ", swatch,
    `${cloud.count} ${text}${raised}${shown}`));
}
