// Tables inside .sortable are sorted by a click on a heading: numbers with units by their size, the rest as words.
"use strict";
const UNITS = { ns: 1e-9, "µs": 1e-6, ms: 1e-3, s: 1 };
function sortKey(text) {
  const found = text.trim().match(/^[!<>~]*\s*(-?[\d.]+(?:e[+-]?\d+)?)\s*(ns|µs|ms|s)?\b/);
  if (found) return Number(found[1]) * (UNITS[found[2]] || 1);
  return /^(–|none|never)/.test(text.trim()) ? Infinity : text.trim().toLowerCase();
}
function compare(a, b) {
  if (typeof a === typeof b) return a < b ? -1 : a > b ? 1 : 0;
  return typeof a === "number" ? -1 : 1;
}
for (const table of document.querySelectorAll(".sortable table")) {
  const heads = [...table.tHead.rows[0].cells], body = table.tBodies[0];
  heads.forEach((head, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      const down = head.getAttribute("aria-sort") === "ascending";
      heads.forEach((other) => other.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", down ? "descending" : "ascending");
      const rows = [...body.rows].map((row) => [sortKey(row.cells[column].textContent), row]);
      rows.sort((a, b) => (down ? -1 : 1) * compare(a[0], b[0]));
      body.append(...rows.map((pair) => pair[1]));
    });
  });
}
