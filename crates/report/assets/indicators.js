// Tables of indicators: sorted and filtered, as many rows as anyone reads.
"use strict";

const FIRST_ROWS = 50;
/** From this number of rows on there is a filter. */
const FILTERED = 12;

function showIndicator(value) {
  if (value === null) return "–";
  const size = Math.abs(value);
  if (size < 1e-9) return "0";
  const decimals = Math.max(0, Math.min(6, 3 - Math.floor(Math.log10(size))));
  const text = value.toFixed(decimals);
  return (decimals ? text.replace(/\.?0+$/, "") : text).replace("-", "−");
}

function startIndicators(data, plots) {
  for (const table of data.indicators) {
    const box = document.querySelector(`[data-indicators="${table.id}"]`);
    if (box) startTable(box, table, plots);
  }
}

function startTable(box, { id, columns, rows }, plots) {
  let [order, down, wanted, limit] = [-1, false, "", FIRST_ROWS];
  const scroll = make("div", "scroll");
  const element = scroll.appendChild(make("table", "wide"));
  element.dataset.table = id;
  const head = element.createTHead().insertRow();
  const body = element.createTBody();
  const more = make("button", "more");
  more.type = "button";

  function heading(name, unit, index) {
    const cell = make("th", index < 0 ? "" : "num");
    cell.scope = "col";
    const button = cell.appendChild(make("button", "sort", name));
    button.type = "button";
    if (unit) button.append(make("small", "", unit));
    button.addEventListener("click", () => {
      // Numbers from the largest, names from the first.
      down = order === index ? !down : index >= 0;
      order = index;
      fill();
    });
    head.append(cell);
    return cell;
  }
  const cells = [heading("name", "", -1), ...columns.map((c, i) => heading(c.name, c.unit, i))];

  function fill() {
    let found = rows.filter(([name]) => name.toLowerCase().includes(wanted));
    if (order >= 0 || down) {
      const key = (row) => (order < 0 ? row[0] : row[1][order]);
      found = [...found].sort((a, b) => {
        const [x, y] = [key(a), key(b)];
        if (x === null || y === null) return (x === null) - (y === null);
        return (x < y ? -1 : x > y ? 1 : 0) * (down ? -1 : 1);
      });
    }
    cells.forEach((cell, i) => {
      if (i - 1 === order) cell.setAttribute("aria-sort", down ? "descending" : "ascending");
      else cell.removeAttribute("aria-sort");
    });
    body.replaceChildren(
      ...found.slice(0, limit).map(([name, values]) => {
        const row = make("tr");
        const first = row.appendChild(make("th", "id"));
        first.scope = "row";
        const link = first.appendChild(make("button", "at", name));
        link.type = "button";
        link.title = "Add its curves to the plots";
        link.addEventListener("click", () => plots.addComponent(name));
        row.append(...values.map((value) => make("td", "num", showIndicator(value))));
        return row;
      }),
    );
    more.hidden = found.length <= limit;
    more.textContent = `Show all ${found.length} rows`;
    element.dataset.found = found.length;
  }
  if (rows.length >= FILTERED) {
    const label = make("label", "filter", "Filter ");
    const input = label.appendChild(make("input"));
    input.type = "search";
    input.placeholder = "part of a name";
    input.addEventListener("input", () => {
      wanted = input.value.trim().toLowerCase();
      limit = FIRST_ROWS;
      fill();
    });
    box.append(label);
  }
  more.addEventListener("click", () => {
    limit = Infinity;
    fill();
  });
  box.append(scroll, more);
  // Rows are made when the table is seen.
  let filled = false;
  box.addEventListener("toggle", () => {
    if (box.open && !filled) fill();
    filled ||= box.open;
  });
  if (rows.length < FILTERED) box.open = true;
}
