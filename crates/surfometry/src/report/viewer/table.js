// The table of all objects: sorted, searched and filtered.

const COLUMNS = [
  { key: "title", title: "object", text: row => row.title, sort: row => row.title },
  { key: "volume_mm3", title: "volume mm³" },
  { key: "surface_area_mm2", title: "area mm²" },
  { key: "total_mean_curvature_mm", title: "total H mm" },
  { key: "average_mean_curvature_per_mm", title: "mean H 1/mm" },
  { key: "euler_characteristic", title: "χ", text: row => digits(row.result.euler_characteristic) },
  { key: "voxels", title: "voxels", sort: row => row.result.voxels.count, text: row => digits(row.result.voxels.count, 12) },
  { key: "flags", title: "flags", sort: row => row.flags.length, text: row => row.flags.join(", ") },
];

// A text as it is searched: nobody knows whether names are joined by lines or spaces.
function searchable(text) {
  return text.trim().toLowerCase().replace(/[\s_-]+/g, " ");
}

class ObjectTable {
  constructor(page, onchange) {
    Object.assign(this, { page, onchange, sorted: null, search: "", chosen: new Set(), cells: new Map() });
    this.rows = page.objects.map((object, number) => ({ number, ...object, flags: object.result.flags.map(flag => flag.code) }));
    this.rows.forEach(row => { row.words = searchable([row.title, row.result.input, ...row.flags].join(" ")); });
    this.body = element("tbody", {});
    this.count = element("span", { class: "lead count", "aria-live": "polite" });
    this.header = element("tr", {}, ...COLUMNS.map(column => {
      const button = element("button", { type: "button", onclick: () => this.sortBy(column) }, column.title);
      return element("th", { "data-key": column.key, scope: "col" }, button);
    }));
    this.element = element("div", {}, this.filters(),
      element("div", { class: "wide small objects" }, element("table", {}, element("thead", {}, this.header), this.body)));
    this.trs = this.rows.map(row => this.tr(row));
    this.draw();
  }

  filters() {
    const codes = [...new Set(this.rows.flatMap(row => row.flags))].sort();
    const counts = Object.fromEntries(codes.map(code => [code, this.rows.filter(row => row.flags.includes(code)).length]));
    const chip = (code, text) => element("button", {
      type: "button", class: "chip", "data-flag": code, "aria-pressed": "false", onclick: () => this.choose(code),
      title: code ? "Shows objects that have this flag; of several that are pressed, those that have all of them" : "Shows objects without any flag",
    }, text);
    const none = this.rows.filter(row => !row.flags.length).length;
    return element("div", { class: "controls filters" },
      element("label", {}, "Search ", element("input", { type: "search", title: "Words, each of which is in a name, an input or a flag; a space stands for _ and - as well", oninput: event => { this.search = searchable(event.target.value); this.draw(); } })),
      this.count,
      this.chips = element("span", { class: "chips" }, ...codes.map(code => chip(code, `${code} ${counts[code]}`)), none > 0 && codes.length > 0 && chip("", `no flags ${none}`)));
  }

  // Presses a flag's button or lets it go. No object has a flag and none.
  choose(code) {
    if (this.chosen.has(code)) this.chosen.delete(code);
    else this.chosen = code && !this.chosen.has("") ? this.chosen.add(code) : new Set([code]);
    this.chips.querySelectorAll("button").forEach(chip => chip.setAttribute("aria-pressed", String(this.chosen.has(chip.dataset.flag))));
    this.draw();
  }

  tr(row) {
    const cells = COLUMNS.map(column => {
      if (column.key === "title") {
        const picture = row.thumbnail && element("img", { src: row.thumbnail, alt: "", width: 56, height: 56 });
        return element("td", {}, element("div", { class: "name" }, picture || element("span", { class: "no-picture" }), element("span", {}, colourSwatch(row), element("a", { href: `#object-${row.number + 1}`, title: row.title }, row.title))));
      }
      return element("td", {}, column.text ? column.text(row) : withError(row.result[column.key], row.result.standard_error[column.key]));
    });
    const tr = element("tr", { "data-row": row.number + 1, onpointerenter: () => this.onpoint?.(row.number), onpointerleave: () => this.onpoint?.(null) }, ...cells);
    tr.addEventListener("click", event => { if (!event.target.closest("a")) this.onpick?.(row.number); });
    tr.addEventListener("dblclick", () => { location.hash = `object-${row.number + 1}`; });
    return tr;
  }

  sortBy(column) {
    const descending = this.sorted?.column === column && !this.sorted.descending;
    this.sorted = { column, descending };
    this.header.querySelectorAll("th").forEach(th => {
      if (th.dataset.key === column.key) th.setAttribute("aria-sort", descending ? "descending" : "ascending"); else th.removeAttribute("aria-sort");
    });
    this.draw();
  }

  // The rows that are shown, in their order; what has no value is last.
  shown() {
    const hasAll = flags => [...this.chosen].every(code => code ? flags.includes(code) : !flags.length);
    const fits = row => this.search.split(" ").every(word => row.words.includes(word)) && hasAll(row.flags);
    const rows = this.rows.filter(fits);
    if (!this.sorted) return rows;
    const { column, descending } = this.sorted, value = column.sort ?? (row => row.result[column.key]);
    const order = (a, b) => typeof a === "string" ? a.localeCompare(b, undefined, { numeric: true }) : a - b;
    return rows.sort((a, b) => {
      const [p, q] = [value(a), value(b)], missing = [p, q].map(v => v === null || v === undefined);
      if (missing[0] || missing[1]) return missing[0] - missing[1];
      return descending ? order(q, p) : order(p, q);
    });
  }

  draw() {
    const rows = this.shown();
    this.body.replaceChildren(...rows.map(row => this.trs[row.number]));
    this.count.textContent = rows.length === this.rows.length ? `${rows.length} objects` : `${rows.length} of ${this.rows.length} objects`;
    this.onchange?.(rows);
  }

  // Marks a row, and brings it into sight.
  mark(number, scroll) {
    this.trs.forEach((tr, n) => tr.classList.toggle("marked", n === number));
    if (scroll && number !== null) this.trs[number].scrollIntoView({ block: "nearest" });
  }
}
