// Tables that can be sorted by a click on a heading.

function cellKey(row, column) {
  const text = row.cells[column].dataset.sort || row.cells[column].textContent.trim();
  const number = Number(text.replace("−", "-").replace(/\s?%$/, ""));
  return text !== "" && !Number.isNaN(number) ? number : text;
}

function compareKeys(a, b) {
  if (typeof a === typeof b) return typeof a === "number" ? a - b : a.localeCompare(b, "en");
  return typeof a === "number" ? -1 : 1;
}

function makeSortable(table) {
  const heads = [...table.tHead.rows[0].cells], body = table.tBodies[0];
  heads.forEach((head, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      const order = head.getAttribute("aria-sort") === "ascending" ? "descending" : "ascending";
      heads.forEach((other) => other.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", order);
      const sign = order === "ascending" ? 1 : -1;
      body.append(...[...body.rows].sort(
        (a, b) => sign * compareKeys(cellKey(a, column), cellKey(b, column))
      ));
    });
  });
}

document.querySelectorAll("table.sortable").forEach((table) => {
  const holder = table.closest("details");
  if (holder) holder.addEventListener("toggle", () => makeSortable(table), { once: true });
  else makeSortable(table);
});
