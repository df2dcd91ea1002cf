// The page of one object, built when it is opened.

class ObjectPage {
  constructor(number, page) {
    Object.assign(this, { number, page, object: page.objects[number] });
    this.element = element("article", { class: "object", "data-object": number + 1 });
    this.stage = element("div", { class: "stage" }, element("p", { class: "lead" }, "Unpacking the surface …"));
    const { object } = this, { result } = object, many = page.objects.length > 1;
    const title = element("h2", {}, colourSwatch(object), object.title);
    this.after = element("div", {});
    this.element.append(...[
      many && this.navigation(),
      element("section", {}, title, valuesTable(result), flagList(result)),
      element("section", { class: "surface" }, element("h3", {}, "Surface"), this.stage),
      this.after,
      element("section", {}, ...[distributionsTable(result), object.sweep && sweepPart(object.sweep, result.parameters.sigma_mm),
        !object.sweep && result.parameters.sigma_mm && element("p", { class: "lead" }, "A page of many objects has no sweep over blurs: surfometry sweep makes it."), methodPart(object)].filter(Boolean)),
    ].filter(Boolean));
  }

  navigation() {
    const last = this.page.objects.length - 1;
    const to = (text, number) => number >= 0 && number <= last && element("a", { href: `#object-${number + 1}` }, text);
    return element("nav", {}, ...[element("a", { href: "#overview" }, "← all objects"), to("previous", this.number - 1), to("next", this.number + 1)].filter(Boolean));
  }

  async fill() {
    const scene = await unpackedScene(this.number);
    if (this.left) return;
    if (!scene) return this.stage.replaceChildren(element("p", {}, this.object.scene_note));
    let viewer = null;
    try {
      viewer = this.viewer = new SurfaceViewer(scene, this.page);
      this.stage.replaceChildren(viewer.element());
    } catch (error) {
      this.stage.replaceChildren(element("p", {}, error.message), element("img", { src: this.object.thumbnail, alt: "" }));
    }
    const slices = scene.head.slices.length ? new Slices(scene, this.page) : null;
    if (viewer && slices) viewer.onplace = position => slices.goTo(position);
    const parts = [placesPart(this.object.result, viewer, slices), slices && part("Slices", slices.element)].filter(Boolean);
    if (parts.length) this.after.replaceChildren(element("section", {}, ...parts));
    this.element.dataset.ready = "yes";
  }

  leave() {
    this.left = true;
    this.viewer?.view.release();
  }
}

function colourSwatch({ colour }) {
  if (!colour) return null;
  const swatch = element("span", { class: "swatch" });
  swatch.style.background = colour;
  return swatch;
}
