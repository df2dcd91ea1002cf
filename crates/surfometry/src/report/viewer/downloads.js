// The numbers as files, made in the browser.

function save(name, type, text) {
  const link = element("a", { href: URL.createObjectURL(new Blob([text], { type })), download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

// Of some rows: the table of `measure --format csv`, and the records of `map -o FILE.json`.
function downloadButtons(page, rows) {
  const stem = page.title.replace(/[^\p{L}\p{N}._-]+/gu, "_") || "report";
  const csv = () => save(`${stem}.csv`, "text/csv", [page.csv[0], ...rows().map(row => page.csv[row.number + 1])].join(""));
  const json = () => save(`${stem}.json`, "application/json", JSON.stringify({
    schema: page.schema, ...page.made_by,
    results: rows().map(row => page.objects[row.number].result), failures: page.failures,
  }, null, 2) + "\n");
  return element("span", { class: "downloads" },
    element("button", { type: "button", onclick: csv }, "CSV"), element("button", { type: "button", onclick: json }, "JSON"));
}
