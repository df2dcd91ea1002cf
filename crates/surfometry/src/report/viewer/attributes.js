// What a surface can be coloured by.

// From both principal curvatures.
const DERIVED = {
  mean_curvature_per_mm: (k1, k2) => (k1 + k2) / 2,
  gaussian_curvature_per_mm2: (k1, k2) => k1 * k2,
  k1_per_mm: k1 => k1,
  k2_per_mm: (k1, k2) => k2,
  shape_index: (k1, k2) => 2 / Math.PI * Math.atan2(k1 + k2, Math.max(k1 - k2, 0)),
  curvedness_per_mm: (k1, k2) => Math.sqrt((k1 * k1 + k2 * k2) / 2),
};

function attributesOf(scene, quantities) {
  const { head, bytes } = scene;
  const found = [];
  const add = (key, group, what, values) => found.push({ key, group, ...what, values: remembered(values) });
  for (const layer of head.layers) {
    const group = { original: "Curvature of the original surface", blurred: "Curvature of the blurred surface" }[layer.of] ?? "Curvature";
    const k1 = remembered(() => numbers(bytes, layer.k1)), k2 = remembered(() => numbers(bytes, layer.k2));
    for (const quantity of quantities) {
      const derive = DERIVED[quantity.name];
      if (derive) add(`${layer.of}:${quantity.name}`, group, { ...quantity, of: layer.of }, () => k1().map((k, i) => derive(k, k2()[i])));
    }
    // Of both principal curvatures it is the same.
    const errors = layer.errors.flatMap(([name, packed]) => [name, ...(name === "k1_per_mm" ? ["k2_per_mm"] : [])].map(of => [of, packed]));
    for (const [name, packed] of errors) {
      const of = quantities.find(quantity => quantity.name === name);
      const what = { title: `${of.title}, standard error`, unit: of.unit, signed: false, name: name + "_standard_error", of: layer.of };
      add(`${layer.of}:${what.name}`, `Error bars of the ${layer.of} surface`, what, () => numbers(bytes, packed));
    }
  }
  const single = (packed, what) => packed && add(what.name, "What the blur did", what, () => numbers(bytes, packed));
  const displacement = quantities.find(quantity => quantity.name === "displacement_mm");
  single(head.displacement, displacement);
  if (head.distance) {
    single(head.distance.values, { name: "distance_mm", title: `Distance to the ${head.distance.to} surface`, unit: "mm", signed: true });
  }
  single(head.curvature_sigma, { name: "curvature_sigma_mm", title: "Blur at which curvature is taken", unit: "mm", signed: false });
  return found;
}

// A function that computes once.
function remembered(compute) {
  let value;
  return () => value ??= compute();
}

// Ends of a colour scale: what 98 % of the surface keeps within, so that a few spikes do not bleach the rest.
function robustLimits(attribute, values, areas) {
  if (attribute.name === "shape_index") return [-1, 1];
  const [most] = quantiles(values.map(Math.abs), areas, [0.98]);
  const limit = most > 0 ? roundedUp(most) : 1;
  return [attribute.signed ? -limit : 0, limit];
}
