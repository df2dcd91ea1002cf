// Elements of the page. Strings only ever become text.

const SVG = "http://www.w3.org/2000/svg";

function filled(made, attributes, children) {
  for (const [key, value] of Object.entries(attributes ?? {})) {
    if (value === null || value === undefined || value === false) continue;
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else made.setAttribute(key, value === true ? "" : value);
  }
  made.append(...children.flat().filter(child => child !== null && child !== undefined && child !== false));
  return made;
}

function element(name, attributes, ...children) {
  return filled(document.createElement(name), attributes, children);
}

function drawn(name, attributes, ...children) {
  return filled(document.createElementNS(SVG, name), attributes, children);
}

function part(title, ...children) {
  return element("div", { class: "part" }, element("h3", {}, title), ...children);
}

function choice(label, options, chosen, onchange) {
  const select = element("select", { onchange: event => onchange(event.target.value), "aria-label": label });
  let group = null;
  for (const option of options) {
    if (option.group !== group?.label) group = option.group ? element("optgroup", { label: option.group }) : null;
    if (group && !group.parentNode) select.append(group);
    (group ?? select).append(element("option", { value: option.value, selected: option.value === chosen }, option.text));
  }
  return element("label", {}, label, " ", select);
}

function table(header, rows) {
  const row = (cells, kind) => element("tr", {}, ...cells.map(cell => element(kind, {}, cell)));
  return element("div", { class: "wide" },
    element("table", {}, element("thead", {}, row(header, "th")), element("tbody", {}, ...rows.map(cells => row(cells, "td")))));
}

// Where a pointer is, from the upper left corner of an element, in CSS pixels.
function placeIn(target, event) {
  const box = target.getBoundingClientRect();
  return [event.clientX - box.left, event.clientY - box.top];
}
