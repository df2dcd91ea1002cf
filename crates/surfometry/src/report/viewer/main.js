// Which page is shown, and what is printed.

const page = JSON.parse(document.getElementById("report").textContent);
const main = element("main", {});
let current = null;

function failuresSection() {
  if (!page.failures.length) return null;
  return element("section", {}, element("h2", {}, "Not measured"),
    element("ul", { class: "flags" }, ...page.failures.map(({ input, error }) => element("li", {}, element("b", {}, element("bdi", {}, input)), ": ", element("bdi", {}, error)))));
}

function show() {
  const opened = /^#object-(\d+)$/.exec(location.hash), number = opened ? Number(opened[1]) - 1 : null;
  const single = page.objects.length === 1 ? 0 : null;
  current?.leave();
  current = page.objects[number ?? -1] || single !== null ? new ObjectPage(single ?? number, page)
    : page.objects.length ? new Overview(page) : null;
  main.replaceChildren(...[number === null && failuresSection(), current?.element, provenanceSection(page)].filter(Boolean));
  window.scrollTo(0, 0);
  const shown = current;
  shown?.fill().then(() => document.body.dataset.ready = "yes", error => main.prepend(element("p", { class: "trouble" }, String(error))));
}

// What stands on paper for an object that is not open.
function sheet(object) {
  const picture = object.thumbnail ? element("img", { src: object.thumbnail, alt: "" }) : element("p", {}, object.scene_note);
  return element("section", { class: "sheet" }, ...[element("h2", {}, colourSwatch(object), object.title), picture, valuesTable(object.result),
    flagList(object.result), distributionsTable(object.result), methodPart(object)].filter(Boolean));
}

let sheets = null;
window.addEventListener("beforeprint", () => {
  if (!(current instanceof Overview)) return;
  sheets = element("div", { class: "sheets" }, ...current.table.shown().map(sheet));
  main.append(sheets);
});
window.addEventListener("afterprint", () => { sheets?.remove(); sheets = null; });
window.addEventListener("hashchange", show);

document.body.append(
  element("header", {}, element("h1", {}, page.title),
    element("p", { class: "lead" }, ["surfometry " + page.provenance.version, page.provenance.created].filter(Boolean).join(" · "))),
  main);
show();
