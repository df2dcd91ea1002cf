// How an object was measured, and what the page was made of.

function methodPart({ result, mapped }) {
  const { parameters, grid, mesh } = result, sigma = parameters.sigma_mm;
  const pairs = [
    ["Embedding", parameters.embedding, sigma ? `: φ = ${digits(parameters.level)} − G ∗ I, σ = ${digits(sigma)} mm` : ""],
    result.curvature_sigma_mm && ["Surface and local curvature", mapped],
    ["Derivatives", `${parameters.derivatives}; at vertices taken at the vertex`],
    ["Band", `${parameters.delta} delta, thickness ${digits(parameters.thickness_mm)} mm, ε = ${digits(parameters.epsilon)}; quadrature ${parameters.quadrature}`],
    ["Image", `${grid.dimensions.join(" × ")} voxels of ${grid.spacing_mm.map(h => digits(h)).join(" × ")} mm`],
    ["Mesh", `${digits(mesh.vertices)} vertices, ${digits(mesh.triangles)} triangles, topology of the trilinear interpolant`],
    ["Input", element("bdi", {}, result.input), ...(result.label === null ? [] : [`, label ${result.label}`])],
    result.input_sha256 && ["SHA-256", element("code", {}, result.input_sha256)],
  ];
  return part("Method", definitions(pairs.filter(Boolean)));
}

function provenanceSection({ provenance, made_by: made }) {
  const files = source => source.files.map(file => element("div", {}, element("bdi", {}, file.name), `: ${file.bytes} bytes, `, element("code", {}, `SHA-256 ${file.sha256}`)));
  return element("section", { class: "provenance" }, element("h2", {}, "How this was made"),
    element("p", {}, "surfometry measures the level set φ = 0 of a smooth embedding of the label image, after Besler et al., ",
      element("i", {}, "Local Morphometry of Closed, Implicit Surfaces"),
      ". ", element("b", {}, "Blurred"), " values describe that level set; ", element("b", {}, "original"),
      " ones undo the shift −σ²H of the blur and the band's own bias, to first order, and describe the object that was segmented. Tables and distributions of curvature are of the surface that Method names; the viewer has both sides of the blur, the other one at the vertices nearest to those that are drawn."),
    definitions([
      ["Command", element("code", {}, provenance.command)],
      ["Version", `surfometry ${made.version}${made.commit ? ", commit " + made.commit : ""}`],
      provenance.created && ["Made", provenance.created],
      ...provenance.sources.map(source => ["Input", element("bdi", {}, source.input), ...files(source)]),
    ].filter(Boolean)));
}
