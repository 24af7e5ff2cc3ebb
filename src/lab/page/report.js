// Draws measurements (src/lab/measurement.h) that stand in this page as JSON: facts, plots, pictures, and sortable
// tables. What is drawn of which table stands in views.json, by the kind of measurement; of other kinds plain_tables.js
// draws what it finds. Nothing is fetched.
"use strict";

const COLORS = ["#3b78d8", "#d64545", "#2e9d5b", "#8e5bc9", "#e08a1e", "#17a2b8", "#8c564b", "#d6589f", "#7a8190", "#a3a61d"];
const SVG = "http://www.w3.org/2000/svg";
const VIEWS = JSON.parse(document.getElementById("views").textContent);

/** An element with attributes and children; a function as an attribute listens. */
function make(name, attributes = {}, ...children) {
  const isSvg = /^(svg|g|line|rect|path|text|title|circle|polygon|polyline)$/.test(name);
  const made = isSvg ? document.createElementNS(SVG, name) : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (typeof value === "function") made.addEventListener(key, value);
    else if (value !== undefined && value !== null) made.setAttribute(key, value);
  }
  made.append(...children.flat(Infinity).filter((child) => child !== null && child !== undefined));
  return made;
}

const isNumber = (value) => typeof value === "number";

function textOf(value) {
  if (value === null || value === undefined) return "";
  if (typeof value === "boolean") return value ? "yes" : "no";
  if (typeof value === "object") return Object.entries(value).map(([key, one]) => `${key} ${textOf(one)}`).join(", ");
  if (!isNumber(value)) return String(value);
  const size = Math.abs(value);
  if (Number.isInteger(value)) return size < 1e15 ? value.toLocaleString("en").replaceAll(",", "\u202f") : value.toExponential(3);
  const short = Number(value.toPrecision(4));
  return size >= 1e6 || size < 1e-3 ? short.toExponential() : String(short);
}

const tickOf = (value) => (Math.abs(value) >= 1e6 || (value !== 0 && Math.abs(value) < 1e-3) ? value.toExponential(0) : String(Number(value.toPrecision(4))));

/** Rows as objects by key. */
const records = (table) => table.rows.map((row) => Object.fromEntries(table.columns.map((column, i) => [column.key, row[i]])));
const distinct = (values) => [...new Set(values)];
const titleOf = (table, key) => {
  const column = table.columns.find((one) => one.key === key);
  return column ? column.title + (column.unit ? `, ${column.unit}` : "") : key;
};

function save(name, text, type) {
  const link = make("a", { href: URL.createObjectURL(new Blob([text], { type })), download: name });
  link.click();
}

/** A row by itself, as a list of facts. */
function showFacts(table) {
  const said = table.columns.map((column, i) => [column, table.rows[0][i]]).filter(([, value]) => value !== null);
  return make("section", {}, make("h3", {}, table.title || table.name), make("div", { class: "facts" }, said.map(([column, value]) => make("span", {}, `${column.title} `, make("b", {}, textOf(value)), column.unit ? ` ${column.unit}` : ""))));
}

/** A table whose columns sort; columns that say the same in all rows stand above it. */
function showTable(table, isOpen = true) {
  const varying = table.columns.map((column, i) => i).filter((i) => {
    const values = distinct(table.rows.map((row) => row[i]));
    return !(values.length === 1 && (values[0] === null || table.rows.length > 2));
  });
  const same = table.columns.map((column, i) => i).filter((i) => !varying.includes(i) && table.rows[0]?.[i] !== null);
  const isText = varying.map((i) => table.rows.every((row) => !isNumber(row[i]))), shadeOf = shadesOf(table);
  let order = table.rows.map((row, i) => i), by = -1, isDown = false, most = 200, wanted = "";
  const body = make("tbody"), count = make("span"), more = make("button", { click: () => { most = Infinity; draw(); } }, "show all");
  const units = distinct(varying.filter((i, k) => !isText[k]).map((i) => table.columns[i].unit)), shared = varying.length > 3 && units.length === 1 ? units[0] : null;
  const heads = varying.map((i, k) => make("th", { class: isText[k] ? "text" : null, title: table.columns[i].key, click: () => sort(k) },
    table.columns[i].title, table.columns[i].unit && !shared ? make("small", {}, " " + table.columns[i].unit) : null));
  function sort(k) {
    isDown = by === k ? !isDown : !isText[k];
    by = k;
    const i = varying[k];
    order.sort((a, b) => {
      const x = table.rows[a][i], y = table.rows[b][i];
      if (x === null || y === null) return (x === null) - (y === null);
      const less = isNumber(x) && isNumber(y) ? x - y : String(x).localeCompare(String(y), "en", { numeric: true });
      return isDown ? -less : less;
    });
    heads.forEach((head, at) => { head.classList.toggle("up", at === k && !isDown); head.classList.toggle("down", at === k && isDown); });
    draw();
  }
  function draw() {
    const words = wanted.toLowerCase().split(/\s+/).filter(Boolean);
    const shown = order.filter((i) => words.every((word) => table.rows[i].some((cell) => textOf(cell).toLowerCase().includes(word))));
    body.replaceChildren(...shown.slice(0, most).map((i) => make("tr", {}, varying.map((c, k) => {
      const text = textOf(table.rows[i][c]), shade = shadeOf(table.rows[i], c);
      return make("td", { class: text === "" ? "none" : text.length > 60 ? "text long" : isText[k] ? "text" : null, style: shade === null ? null : `--shade: ${Math.round(45 * shade)}%` }, text === "" ? "\u2013" : text);
    }))));
    count.textContent = shown.length === table.rows.length ? `${shown.length} rows` : `${shown.length} of ${table.rows.length} rows`;
    more.hidden = shown.length <= most;
  }
  const quote = (cell) => (cell === null ? "" : /[",\n]/.test(cell) ? `"${String(cell).replaceAll('"', '""')}"` : String(cell));
  const csv = () => [table.columns.map((column) => column.key), ...table.rows].map((row) => row.map(quote).join(",") + "\n").join("");
  draw();
  const bar = make("div", { class: "bar" }, count, shared ? make("span", {}, `in ${shared}`) : null,
    table.rows.length > 12 ? make("input", { placeholder: "only rows with \u2026", input: (event) => { wanted = event.target.value; draw(); } }) : null,
    more, make("button", { click: () => save(`${table.name}.csv`, csv(), "text/csv") }, "CSV"),
    same.map((i) => make("span", {}, `${table.columns[i].title}: ${textOf(table.rows[0][i])}`)));
  const scroll = make("div", { class: "scroll" }, make("table", {}, make("thead", {}, make("tr", {}, heads)), body));
  return make("details", isOpen ? { open: "" } : {}, make("summary", {}, make("b", {}, table.title || table.name)), bar, scroll);
}

/** An axis from `least` to `most`: where a value lies in [0, 1], and the values with a tick, or whole numbers with `isWhole`. */
function axis(least, most, isLog, isWhole) {
  if (isLog) {
    let [low, high] = [Math.floor(Math.log10(least) * 2) / 2, Math.ceil(Math.log10(most) * 2) / 2];
    if (high === low) high += 1;
    const ticks = [];
    for (let power = Math.floor(low); power <= high; ++power) {
      for (const digit of high - low < 2.5 ? [1, 2, 5] : [1]) {
        const at = digit * 10 ** power;
        if (Math.log10(at) >= low - 1e-9 && Math.log10(at) <= high + 1e-9) ticks.push(at);
      }
    }
    return { place: (value) => (Math.log10(value) - low) / (high - low), ticks };
  }
  const rough = (most - least || 1) / 6, power = 10 ** Math.floor(Math.log10(rough));
  const step = Math.max([1, 2, 5, 10].find((digit) => digit * power >= rough) * power, isWhole ? 1 : 0);
  const [low, high] = [Math.floor(least / step) * step, Math.ceil(most / step) * step || step];
  const ticks = Array.from({ length: Math.round((high - low) / step) + 1 }, (_, i) => low + i * step);
  return { place: (value) => (value - low) / (high - low), ticks };
}

function plotFrame(title, svg, ...rest) {
  const text = () => new XMLSerializer().serializeToString(svg);
  const button = make("button", { click: () => save(`${title}.svg`, text(), "image/svg+xml") }, "SVG");
  return make("div", { class: "plot" }, make("h3", {}, title, " ", button), svg, rest.length > 0 ? make("div", { class: "bar" }, rest) : null);
}

/** An entry of a plot's key; a click hides or shows what it names. */
function keyOf(group, x, y, color, text) {
  const key = make("g", { class: "key", click: () => group.setAttribute("visibility", key.classList.toggle("off") ? "hidden" : "visible") },
    make("rect", { x, y, width: 12, height: 12, rx: 2, fill: color }), make("text", { x: x + 18, y: y + 10 }, text));
  return key;
}

/** The slope of a straight line through the logarithms of points, by least squares. */
function slopeOf(points) {
  const logs = points.map((p) => [Math.log(p.x), Math.log(p.y)]), n = logs.length;
  const [mx, my] = [0, 1].map((i) => logs.reduce((sum, p) => sum + p[i], 0) / n);
  return logs.reduce((sum, [x, y]) => sum + (x - mx) * (y - my), 0) / logs.reduce((sum, [x]) => sum + (x - mx) ** 2, 0);
}

/** Curves of y over x, one a series. With `log` both axes are logarithmic, and dotted lines have the slopes named. */
function lines(table, view, rows, title) {
  const can = (value) => isNumber(value) && (!view.log || value > 0);
  const series = distinct(rows.map((row) => row[view.series])).map((name) => ({
    name, points: rows.filter((row) => row[view.series] === name && can(row[view.x]) && can(row[view.y]))
      .map((row) => ({ x: row[view.x], y: row[view.y], low: row[view.low], high: row[view.high] })).sort((a, b) => a.x - b.x),
  })).filter((one) => one.points.length > 0);
  if (!series.some((one) => distinct(one.points.map((p) => p.x)).length > 1)) return null;
  const names = distinct((table.rows.length > 0 ? records(table) : rows).map((row) => row[view.series]).filter((name) => name !== null)), end = (one) => one.points.at(-1).y;
  series.sort((a, b) => end(b) - end(a));
  if (!view.all) series.splice(10);
  const all = series.flatMap((one) => one.points), xs = all.map((p) => p.x), ys = all.map((p) => p.y);
  const level = view.level ? rows.map((row) => row[view.level]).find(can) : undefined;
  if (level !== undefined) ys.push(level);
  const across = axis(Math.min(...xs), Math.max(...xs), view.log, xs.every(Number.isInteger)), up = axis(view.log ? Math.min(...ys) : 0, Math.max(...ys), view.log);
  const [width, height, left, top] = [330, 270, 84, 12];
  const px = (x) => left + across.place(x) * width, py = (y) => top + (1 - up.place(y)) * height;
  const inside = (y) => Math.min(Math.max(y, top), top + height);
  const keys = 36 + 6.4 * Math.max(...series.map((one) => one.name.length + (view.log ? 14 : 0)));
  const svg = make("svg", { xmlns: SVG, width: left + width + keys, height: top + height + 48 });
  for (const x of across.ticks) {
    svg.append(make("line", { class: "grid", x1: px(x), x2: px(x), y1: top, y2: top + height, stroke: "#ddd" }),
      make("text", { x: px(x), y: top + height + 16, "text-anchor": "middle" }, tickOf(x)));
  }
  for (const y of up.ticks) {
    svg.append(make("line", { class: "grid", x1: left, x2: left + width, y1: py(y), y2: py(y), stroke: "#ddd" }),
      make("text", { x: left - 6, y: py(y) + 4, "text-anchor": "end" }, tickOf(y)));
  }
  svg.append(make("text", { x: left + width / 2, y: top + height + 38, "text-anchor": "middle" }, titleOf(table, view.x)),
    make("text", { x: 0, y: 0, transform: `translate(13 ${top + height / 2}) rotate(-90)`, "text-anchor": "middle" }, titleOf(table, view.y)));
  if (view.log && view.slopes) {
    const x0 = Math.min(...xs), x1 = Math.max(...xs), y0 = Math.max(...series.map((one) => one.points[0].y));
    for (const slope of view.slopes) {
      let xe = x1, ye = y0 * (x1 / x0) ** slope;
      const least = Math.min(...ys);
      if (ye < least) [xe, ye] = [x0 * (least / y0) ** (1 / slope), least];
      svg.append(make("line", { class: "guide", x1: px(x0), y1: py(y0), x2: px(xe), y2: py(ye), stroke: "#888", "stroke-dasharray": "2 4" }),
        make("text", { x: Math.min(px(xe) + 3, left + width - 44), y: Math.min(py(ye) + 4, top + height - 4), "font-size": 11 }, `slope ${slope}`));
    }
  }
  if (level !== undefined) {
    svg.append(make("line", { class: "guide", x1: left, x2: left + width, y1: py(level), y2: py(level), stroke: "#888", "stroke-dasharray": "6 4" }),
      make("text", { x: left + 4, y: py(level) - 4, "font-size": 11 }, view.levelTitle || view.level));
  }
  series.forEach((one, i) => {
    const color = COLORS[(view.all ? names.indexOf(one.name) : i) % COLORS.length], group = make("g");
    const band = one.points.filter((p) => isNumber(p.low) && isNumber(p.high));
    if (band.length > 1) {
      const low = view.log ? Math.min(...ys) : 0, edge = (p, y) => `${px(p.x)},${inside(py(Math.max(y, low)))}`;
      group.append(make("polygon", { points: [...band.map((p) => edge(p, p.high)), ...band.reverse().map((p) => edge(p, p.low))].join(" "), fill: color, "fill-opacity": 0.15 }));
    }
    group.append(make("polyline", { points: one.points.map((p) => `${px(p.x)},${py(p.y)}`).join(" "), fill: "none", stroke: color, "stroke-width": 2 }),
      ...one.points.map((p) => make("circle", { cx: px(p.x), cy: py(p.y), r: 3.5, fill: color }, make("title", {}, `${one.name}\n${titleOf(table, view.x)}: ${textOf(p.x)}\n${titleOf(table, view.y)}: ${textOf(p.y)}`))));
    const slope = view.log && distinct(one.points.map((p) => p.x)).length > 2 ? slopeOf(one.points) : null;
    if (slope !== null && view.fits) {
      const [first, last] = [one.points[0].x, one.points.at(-1).x], middle = one.points.reduce((sum, p) => sum + Math.log(p.y) - slope * Math.log(p.x), 0) / one.points.length;
      const fit = (x) => inside(py(Math.exp(middle) * x ** slope));
      group.append(make("line", { class: "guide", x1: px(first), y1: fit(first), x2: px(last), y2: fit(last), stroke: "#888", "stroke-dasharray": "2 4" }));
    }
    svg.append(group, keyOf(group, left + width + 14, top + 8 + 20 * i, color, one.name + (slope === null ? "" : `  (slope ${slope.toFixed(2)})`)));
  });
  return plotFrame(title, svg);
}

/** Horizontal bars, the longest first, with whiskers. */
function bars(table, view, rows, title) {
  const shown = rows.filter((row) => isNumber(row[view.y]) && row[view.y] > 0).sort((a, b) => b[view.y] - a[view.y]);
  if (shown.length === 0) return null;
  const kindOf = (row) => view.kinds?.[row[view.color]] ?? row[view.color];
  const holder = make("div"), kinds = view.kinds ? distinct(Object.values(view.kinds)) : distinct(shown.map(kindOf));
  const draw = (count) => {
    const some = shown.slice(0, count), most = Math.max(...some.map((row) => row[view.high] ?? row[view.y]));
    const left = 16 + 6.6 * Math.max(...some.map((row) => row[view.label].length)), width = 300, right = 60, down = 20;
    const px = (value) => left + (value / most) * width;
    const svg = make("svg", { xmlns: SVG, width: left + width + right, height: down * (some.length + kinds.length) + 16 });
    some.forEach((row, i) => {
      const color = COLORS[kinds.indexOf(kindOf(row)) % COLORS.length], y = down * i, isHollow = view.hollow && row[view.hollow[0]] !== view.hollow[1];
      svg.append(make("text", { x: left - 6, y: y + 14, "text-anchor": "end" }, row[view.label]),
        make("rect", { x: left, y: y + 3, width: px(row[view.y]) - left, height: 14, rx: 2, fill: isHollow ? "none" : color, stroke: color, "stroke-dasharray": isHollow ? "3 2" : null }),
        make("text", { x: px(row[view.high] ?? row[view.y]) + 6, y: y + 14 }, textOf(row[view.y])));
      if (isNumber(row[view.low]) && isNumber(row[view.high])) {
        svg.append(make("path", { d: `M${px(row[view.low])} ${y + 6}v8m0 -4H${px(row[view.high])}m0 -4v8`, class: "axis", stroke: "#444", fill: "none" }));
      }
    });
    if (view.color) kinds.forEach((kind, i) => {
      const y = down * (some.length + i) + 12;
      svg.append(make("rect", { x: left, y: y - 1, width: 12, height: 12, fill: COLORS[i % COLORS.length] }), make("text", { x: left + 18, y: y + 9 }, kind));
    });
    const rest = shown.length > count ? [make("button", { click: () => draw(shown.length) }, `all ${shown.length}`)] : [];
    holder.replaceChildren(plotFrame(title, svg, rest));
  };
  draw(30);
  return holder;
}

/** Values of y, or of several, by two columns. */
function matrix(table, view, rows, title) {
  const ys = [view.y].flat(), there = rows.filter((row) => ys.some((y) => isNumber(row[y])));
  if (there.length === 0) return null;
  const down = distinct(there.map((row) => row[view.row]));
  const across = distinct(there.map((row) => row[view.column])).flatMap((name) => ys.map((y) => [name, y]));
  const titles = across.map(([name, y]) => (ys.length > 1 ? `${name}, ${titleOf(table, y)}` : String(name)));
  const columns = [view.row, ...titles].map((key, i) => ({ key, title: i === 0 ? titleOf(table, key) : key, unit: "" }));
  const at = (one, [other, y]) => there.find((row) => row[view.row] === one && row[view.column] === other)?.[y] ?? null;
  return make("div", {}, showTable({ name: "matrix", title, columns, rows: down.map((one) => [one, ...across.map((other) => at(one, other))]) }));
}

/** Rows that differ in one column alone: the ratio of their times. */
function ratio(table, view, rows, title) {
  const keys = ["structure", "traversal", "rta", "near_first", "tests", "distribution"].filter((key) => key !== view.change);
  const alike = (a, b) => a.set === b.set && keys.every((key) => a[key] === b[key]);
  const timed = rows.filter((row) => isNumber(row.median_seconds) && row.is_copy === false);
  const found = timed.filter((row) => row[view.change] === view.of).flatMap((row) => {
    const other = timed.find((one) => one[view.change] === view.to && alike(one, row));
    return other ? [{ name: row.combination, set: row.set, value: view.is_price ? row.median_seconds / other.median_seconds : other.median_seconds / row.median_seconds }] : [];
  });
  const source = { columns: [{ key: "name", title: "combination", unit: "" }], rows: [] };
  return matrix(source, { row: "name", column: "set", y: "value" }, found, title);
}

const KINDS = { lines, bars, matrix, ratio };

/** Draws a view of a measurement: one thing, or one for each value of `split`. */
function show(measurement, view) {
  const table = measurement.tables.find((one) => one.name === view.table);
  if (!table) return null;
  const fits = (row) => Object.entries(view.where ?? {}).every(([key, value]) => (Array.isArray(value) ? value.includes(row[key]) : row[key] === value)) && !(view.skip && row[view.skip]);
  const rows = records(table).filter(fits), split = view.kind === "ratio" ? undefined : view.split;
  const parts = split ? distinct(rows.map((row) => row[split])).filter((value) => value !== null) : [null];
  const drawn = parts.map((part) => KINDS[view.kind](table, view, part === null ? rows : rows.filter((row) => row[split] === part), part === null ? view.title : `${view.title}: ${part}`)).filter(Boolean);
  if (drawn.length === 0) return view.missing ? make("p", { class: "notes wide" }, `${view.title}: ${view.missing}`) : null;
  return [view.about ? make("p", { class: "notes wide" }, view.about) : null, drawn];
}

/** Pictures of one group: errors beside them, and a magnified inset of the same place in all of them. */
function showGroup(name, pictures, isFirst) {
  const size = 180, insets = [], spots = [];
  let zoom = 8, pinned = false, place = null;
  const update = () => {
    for (const { inset, image } of insets) {
      const scale = zoom * (image.naturalWidth ? 1 : 0);
      inset.style.backgroundSize = `${image.naturalWidth * scale}px ${image.naturalHeight * scale}px`;
      inset.style.backgroundPosition = `${size / 2 - place[0] * image.naturalWidth * scale}px ${size / 2 - place[1] * image.naturalHeight * scale}px`;
    }
    for (const { spot, image } of spots) {
      const side = (size / zoom) * (image.clientWidth / image.naturalWidth);
      Object.assign(spot.style, { display: "block", width: `${side}px`, height: `${side}px`, left: `${place[0] * image.clientWidth - side / 2}px`, top: `${place[1] * image.clientHeight - side / 2}px` });
    }
  };
  const look = (event, image) => {
    const box = image.getBoundingClientRect();
    place = [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
    update();
  };
  const view = (source) => {
    const image = make("img", { src: source, alt: "", load: () => { place ??= [0.5, 0.5]; update(); } }), spot = make("div", { class: "spot" });
    const inset = make("div", { class: "inset", style: `width:${size}px;height:${size}px;background-image:url("${source}")` });
    insets.push({ inset, image });
    spots.push({ spot, image });
    const holder = make("div", { class: "view", mousemove: (event) => { if (!pinned) look(event, image); }, click: (event) => { pinned = !pinned; look(event, image); },
      wheel: (event) => { if (place) { event.preventDefault(); zoom = Math.min(32, Math.max(2, zoom * (event.deltaY < 0 ? 1.25 : 0.8))); update(); } } }, image, spot);
    return [holder, inset];
  };
  const figures = pictures.map((picture) => {
    const links = [["file", picture.file], ["EXR", picture.exr]].filter(([, file]) => file).map(([label, file]) => [" ", make("a", { href: encodeURI(file) }, label === "EXR" ? "EXR" : file)]);
    const drawn = make("div", { class: "pair" });
    if (picture.svg) drawn.append(new DOMParser().parseFromString(picture.svg, "image/svg+xml").documentElement);
    else if (picture.image) drawn.append(...view(picture.image), ...(picture.error ? view(picture.error) : []));
    else if (picture.file) drawn.append(...view(encodeURI(picture.file)));
    return make("figure", {}, drawn, make("figcaption", {}, make("b", {}, picture.title), picture.caption ? ` \u2014 ${picture.caption}` : "", links));
  });
  return make("section", {}, make("h3", {}, name),
    isFirst ? make("p", { class: "notes" }, "Point at a picture to magnify the same place in all beside it; click holds it, the wheel zooms.") : null, make("div", { class: "pictures" }, figures));
}

function showMeasurement(m, id, isAlone) {
  const facts = [["Device", m.device ?? "CPU"], ["Driver", m.driver], ["Processor", m.processor], ["Threads", m.threads], ["Date", m.date], ["Program", m.program]];
  const kind = VIEWS[m.kind] ?? { views: [] }, groups = distinct((m.pictures ?? []).map((picture) => picture.group));
  const isAlarm = (note) => /^(WRONG|Not made|interrupted)|interrupted;/i.test(note);
  const isLarge = (table) => table.rows.length > 20 || kind.views.some((view) => view.table === table.name);
  const tables = m.tables.filter((table) => table.rows.length > 0);
  const plots = (table) => (m.kind ? [] : [make("div", { class: "plots" }, plotsOf(table))]);
  const showAny = (table) => (table.rows.length === 1 ? showFacts(table) : [showTable(table, table.rows.length < 400), plots(table)]);
  return make("main", { id }, isAlone ? null : make("h2", {}, m.title ?? "Measurement"),
    make("div", { class: "facts" }, facts.filter(([, value]) => value).map(([name, value]) => make("span", {}, `${name} `, make("b", {}, String(value))))),
    m.command ? make("p", {}, make("code", {}, m.command)) : null,
    m.interrupted ? make("p", { class: "wrong" }, "Interrupted: the results are incomplete.") : null,
    (m.notes ?? []).filter(isAlarm).map((note) => make("p", { class: "wrong" }, note)),
    tables.filter((table) => !isLarge(table)).map(showAny),
    make("div", { class: "plots" }, kind.views.map((view) => show(m, view))),
    groups.map((group, i) => showGroup(group, m.pictures.filter((picture) => picture.group === group), i === 0)),
    tables.filter(isLarge).map(showAny),
    make("ul", { class: "notes" }, [...Object.entries(m.unknown ?? {}).map(([key, why]) => `The ${key} is not known. ${why}`), ...(m.notes ?? []).filter((note) => !isAlarm(note)), ...(kind.about ?? [])].map((note) => make("li", {}, note))));
}

const measurements = [...document.querySelectorAll("script.measurement")].map((script) => JSON.parse(script.textContent));
document.body.append(make("h1", {}, measurements.length === 1 ? measurements[0].title : "Pertev: measurements"));
if (measurements.length === 1) document.title = measurements[0].title;
else {
  document.body.append(make("ol", { class: "contents" }, measurements.map((m, i) => make("li", {}, make("a", { href: `#m${i}` }, m.title), ` \u2014 ${[m.device ?? m.processor, m.date?.slice(0, 10)].filter(Boolean).join(", ")}`))));
}
measurements.forEach((m, i) => document.body.append(showMeasurement(m, `m${i}`, measurements.length === 1)));
document.body.dataset.drawn = String(measurements.length);
