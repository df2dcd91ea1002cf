// An object's numbers.

const MEASURES = ["volume_mm3", "surface_area_mm2", "total_mean_curvature_mm", "average_mean_curvature_per_mm"];

function flagList(result) {
  const { flags } = result;
  if (!flags.length) return element("p", { class: "lead" }, "No flags.");
  return element("ul", { class: "flags" }, ...flags.map(flag => element("li", {}, element("b", {}, flag.code), ": ", flag.message)));
}

function valuesTable(result) {
  const header = ["surface", "volume mm³", "area mm²", "total H mm", "mean H 1/mm", "Euler characteristic"];
  const values = (from, count) => MEASURES.map(measure => digits(from?.[measure], count));
  const rows = [];
  if (result.surface === "original") {
    const errors = result.standard_error;
    const known = MEASURES.map(measure => element("b", {}, toItsError(result[measure], errors[measure])));
    rows.push(["original", ...known, element("b", {}, digits(result.euler_characteristic))]);
    if (MEASURES.some(measure => errors[measure] !== null)) {
      rows.push(["its standard error", ...MEASURES.map(measure => errors[measure] === null ? "–" : "± " + toItsError(errors[measure], errors[measure])), ""]);
    }
  }
  const { topology, parameters } = result;
  // As the command line calls it.
  const field = parameters.sigma_mm && parameters.embedding !== "recovering" ? "blurred" : parameters.embedding;
  rows.push(
    [field, ...values(result.blurred), `${thousandths(result.blurred.euler_characteristic)} by Gauss and Bonnet`],
    [`mesh of the ${field}`, ...values(result.mesh).slice(0, 2), "", "", `${digits(topology.euler_characteristic_mesh)} as V − E + F`],
    ["voxels", digits(result.voxels.volume_mm3), "", "", "", `${digits(topology.euler_characteristic_voxels_26)} (26), ${digits(topology.euler_characteristic_voxels_6)} (6)`]);
  if (result.truth) rows.push(["exact", ...values(result.truth), digits(result.truth.euler_characteristic)]);
  return element("div", { class: "numbers" }, table(header, rows),
    element("p", { class: "lead" }, `Voxels: components ${topology.components}, cavities ${topology.cavities}, handles ${topology.handles}. H > 0 on a ball; the Euler characteristic is the surface's (ball 2, torus 0).`));
}

function distributionsTable(result) {
  if (!result.distributions.length) return null;
  const header = ["by area", "mean", "std. dev.", "skewness", ...result.quantiles.map(share => `${digits(100 * share)} %`), "mean by vertex"];
  const rows = result.distributions.map(({ name, by_area, by_vertex }) =>
    [name, ...[by_area.mean, by_area.standard_deviation, by_area.skewness, ...by_area.quantiles, by_vertex.mean].map(value => digits(value, 3))]);
  return part("Curvature over the surface", element("div", { class: "small" }, table(header, rows)), curvatureNumbers(result.curvature));
}

function definitions(pairs) {
  return element("dl", {}, ...pairs.flatMap(([term, ...text]) => [element("dt", {}, term), element("dd", {}, ...text)]));
}

function curvatureNumbers(curvature) {
  if (!curvature) return null;
  return definitions([
    ["Bending energy ∫ k₁² + k₂² dA (ball: 8π)", digits(curvature.bending_energy, 5)],
    ["Folding index (ball: 0)", digits(curvature.folding_index, 4)],
    ["Intrinsic curvature index (convex: 1)", digits(curvature.intrinsic_curvature_index, 4)],
    ["Sharpness ∫ (k₁ − k₂)² dA (ball: 0)", digits(curvature.sharpness, 4)],
    ["Mean shape index, mean curvedness", `${digits(curvature.mean_shape_index, 4)}, ${digits(curvature.mean_curvedness_per_mm, 4)} 1/mm`],
    ["Share of area with H > 0, with K < 0", `${digits(100 * curvature.convex_share, 3)} %, ${digits(100 * curvature.saddle_share, 3)} %`],
  ]);
}
