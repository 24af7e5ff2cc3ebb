// Plots of tables that views.json does not know: curves where a table goes over a column of numbers, else dots in the
// rows of the table. Columns of one quantity share a plot.
"use strict";

/** A cell as a number with its interval: 3, "3 %" or "3 ± 1"; null if it is none. */
function measuredOf(cell) {
  if (isNumber(cell)) return { y: cell };
  const [, y, spread] = /^([+-]?[\d.]+(?:e-?\d+)?)(?: %| \u00b1 ([\d.]+(?:e-?\d+)?))?$/.exec(cell ?? "") ?? [];
  if (y === undefined || Number.isNaN(Number(y))) return null;
  return spread === undefined ? { y: Number(y) } : { y: Number(y), low: Number(y) - Number(spread), high: Number(y) + Number(spread) };
}

const medianOf = (values) => values.toSorted((a, b) => a - b)[Math.floor(values.length / 2)];

/** Columns with numbers from `first` on, in groups of one quantity: its unit, or what its title says. */
function quantitiesOf(table, first) {
  const groups = new Map();
  table.columns.forEach((column, i) => {
    const values = table.rows.map((row) => measuredOf(row[i])).filter(Boolean).map((one) => Math.abs(one.y));
    if (i < first || /^(?:spp|samples|triangles|registers)$/.test(column.title) || values.length < Math.max(2, table.rows.length / 2)) return;
    const quantity = column.unit || (/times|ratio|share|\w+\/s$/.exec(column.title) ?? /relMSE|FLIP|flicker|mean|error|efficiency|lanes/.exec(column.title))?.[0] || "";
    groups.set(quantity, [...(groups.get(quantity) ?? []), { i, title: column.title, median: medianOf(values) }]);
  });
  return [...groups].flatMap(([quantity, columns]) => {
    const medians = columns.map((column) => column.median), hasIntervals = columns.every(({ i }) => table.rows.some((row) => measuredOf(row[i])?.low !== undefined));
    const isMixed = quantity === "" && !hasIntervals && (columns.length === 1 ? table.rows.length < 3 : Math.max(...medians) > 50 * Math.min(...medians));
    return isMixed ? [] : [{ quantity: columns.length === 1 ? columns[0].title + (table.columns[columns[0].i].unit ? `, ${quantity}` : "") : quantity, columns }];
  });
}

/** How many columns stand in front of the figures: the text that names a row. */
function namesOf(table) {
  const first = table.columns.findIndex((column, i) => table.rows.some((row) => measuredOf(row[i])));
  return first < 0 ? table.columns.length : first;
}

/** How a row is named: by as few of the first columns that vary as tell all rows apart. */
function labelOf(table, first) {
  const varying = [...Array(first).keys()].filter((i) => distinct(table.rows.map((row) => row[i])).length > 1);
  const by = (count) => (row) => varying.slice(0, count).map((i) => row[i]).filter((cell) => cell !== null).join(", ");
  const enough = varying.findIndex((_, k) => distinct(table.rows.map(by(k + 1))).length === table.rows.length);
  return by(enough < 0 ? varying.length : enough + 1);
}

/** Rows of the table as dots on one axis, a colour for each of the columns. */
function dots(table, { quantity, columns }, label, title) {
  const rows = table.rows.map((row) => ({ name: label(row), points: columns.map(({ i }) => measuredOf(row[i])) })).filter((row) => row.points.some(Boolean));
  const ys = rows.flatMap((row) => row.points).filter(Boolean).map((point) => point.y);
  const isLog = Math.min(...ys) > 0 && Math.max(...ys) > 20 * Math.min(...ys);
  const across = axis(isLog ? Math.min(...ys) : Math.min(0, ...ys), Math.max(...ys), isLog);
  const cut = (text, most) => (text.length > most ? text.slice(0, most - 1) + "\u2026" : text);
  const left = 16 + 7 * Math.min(48, Math.max(...rows.map((row) => row.name.length))), width = 270, down = 22, top = 8;
  const keys = columns.length > 1 ? 48 + 6.6 * Math.max(...columns.map((column) => column.title.length)) : 40;
  const px = (value) => left + Math.min(1, Math.max(0, across.place(Math.max(value, isLog ? 1e-300 : -Infinity)))) * width, bottom = top + down * rows.length;
  const svg = make("svg", { xmlns: SVG, width: left + width + keys, height: Math.max(bottom + (quantity ? 44 : 24), columns.length > 1 ? top + 20 * columns.length : 0) });
  for (const x of across.ticks) {
    svg.append(make("line", { class: "grid", x1: px(x), x2: px(x), y1: top, y2: bottom, stroke: "#ddd" }),
      make("text", { x: px(x), y: bottom + 16, "text-anchor": "middle" }, tickOf(x)));
  }
  svg.append(make("text", { x: left + width / 2, y: bottom + 36, "text-anchor": "middle" }, quantity));
  rows.forEach((row, k) => {
    const y = top + down * (k + 0.5), known = row.points.filter(Boolean).map((point) => px(point.y));
    svg.append(make("text", { x: left - 8, y: y + 4, "text-anchor": "end" }, make("title", {}, row.name), cut(row.name, 48)),
      make("line", { class: "grid", x1: Math.min(...known), x2: Math.max(...known), y1: y, y2: y, stroke: "#ddd", "stroke-width": 3 }));
  });
  columns.forEach((column, c) => {
    const color = COLORS[c % COLORS.length], group = make("g");
    rows.forEach((row, k) => {
      const point = row.points[c], y = top + down * (k + 0.5);
      if (!point) return;
      if (isNumber(point.low)) group.append(make("line", { x1: px(point.low), x2: px(point.high), y1: y, y2: y, stroke: color, "stroke-width": 1.5 }));
      group.append(make("circle", { cx: px(point.y), cy: y, r: 4.5, fill: color }, make("title", {}, `${row.name}\n${column.title}: ${textOf(point.y)} ${table.columns[column.i].unit ?? ""}`)));
    });
    svg.append(group);
    if (columns.length > 1) svg.append(keyOf(group, left + width + 20, top + 20 * c, color, column.title));
  });
  return plotFrame(title, svg);
}

/** Curves of the columns over the column `x`, one plot for each text in front of it. */
function curves(table, { quantity, columns }, x, label, title) {
  return distinct(table.rows.map(label)).map((name) => {
    const rows = table.rows.filter((row) => label(row) === name).flatMap((row) => columns.map((column) => ({ x: measuredOf(row[x])?.y, series: column.title, ...measuredOf(row[column.i]) })));
    const range = (key) => { const values = rows.map((row) => row[key]).filter(isNumber); return Math.min(...values) > 0 ? Math.max(...values) / Math.min(...values) : 0; };
    const long = { columns: [{ ...table.columns[x], key: "x" }, { key: "y", title: quantity }], rows: [] };
    const view = { x: "x", y: "y", low: "low", high: "high", series: "series", log: range("y") >= 3 && range("x") >= 3, all: true, fits: true };
    return lines(long, view, rows, [title, name].filter(Boolean).join(": "));
  });
}

/** All plots of a table. Where a group has more columns than there are colours, the table's own shades show it. */
function plotsOf(table) {
  const first = namesOf(table), label = labelOf(table, first);
  const groups = new Map(table.rows.map((row) => [label(row), []]));
  for (const row of table.rows) groups.get(label(row)).push(row[first]);
  const isOver = first < table.columns.length && table.rows.length > 2 && [...groups.values()].every((values) => values.length > 2 && values.every(measuredOf) && distinct(values).length === values.length);
  return quantitiesOf(table, isOver ? first + 1 : first).filter(({ columns }) => columns.length <= COLORS.length).flatMap((group) => {
    const title = [table.title || table.name, group.quantity].filter(Boolean).join(": ");
    return isOver ? curves(table, group, first, label, title) : first > 0 ? dots(table, group, label, title) : null;
  }).filter(Boolean);
}

/** How far a cell lies between the least and the most of a table whose columns all have one quantity; else null. */
function shadesOf(table) {
  const groups = quantitiesOf(table, namesOf(table)), columns = groups.length === 1 ? groups[0].columns.map(({ i }) => i) : [];
  const valueOf = (row, i) => Math.log(measuredOf(row[i])?.y ?? 0);
  const values = table.rows.flatMap((row) => columns.map((i) => valueOf(row, i))).filter(Number.isFinite), low = Math.min(...values), high = Math.max(...values);
  return (row, i) => (columns.length > 4 && columns.includes(i) && Number.isFinite(valueOf(row, i)) ? (valueOf(row, i) - low) / (high - low || 1) : null);
}
