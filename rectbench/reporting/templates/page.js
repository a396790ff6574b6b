// Sorts a table by the column whose heading is clicked; rows without a value stay last either way.
for (const table of document.querySelectorAll("table.sortable")) {
  const heads = [...table.tHead.rows[0].cells];
  heads.forEach((head, column) => head.querySelector("button").addEventListener("click", () => {
    const order = head.getAttribute("aria-sort") === "ascending" ? "descending" : "ascending";
    heads.forEach((other) => other.removeAttribute("aria-sort"));
    head.setAttribute("aria-sort", order);
    const sign = order === "ascending" ? 1 : -1;
    const value = (row) => row.cells[column].dataset.value;
    const compare = (a, b) => {
      if (a === "" || b === "") return (a === "") - (b === "");
      const numeric = !isNaN(a) && !isNaN(b);
      return sign * (numeric ? a - b : a.localeCompare(b, "en", { numeric: true }));
    };
    for (const body of table.tBodies) {
      body.append(...[...body.rows].sort((a, b) => compare(value(a), value(b))));
    }
  }));
}
