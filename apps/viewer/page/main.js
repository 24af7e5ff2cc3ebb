// The page of pertev view: draws the pictures that come, sends the input of keys and mouse, shows the panel.

import { button, element, make } from "./elements.js";
import { showGone } from "./gone.js";
import { makeGroup, remember, remembered } from "./groups.js";
import { Controls, kKeys } from "./keys.js";
import { Link } from "./link.js";
import { People } from "./people.js";
import { Settings, showRows } from "./panel.js";
import { watchRate, watchShape, windowShape } from "./screen.js";
import { Recorder, TimeLine } from "./time.js";

// The key is in a cookie now: it need not stand in the address, where others may read it.
history.replaceState(null, "", location.pathname);

const canvas = /** @type {HTMLCanvasElement} */ (element("picture"));
const context = /** @type {CanvasRenderingContext2D} */ (canvas.getContext("2d", { alpha: false }));
const help = /** @type {HTMLDialogElement} */ (element("help"));

/** @type {ImageBitmap | null} */
let picture = null;
let fullWidth = 16, fullHeight = 9;
/** @type {any} */
let state = null;
let sceneName = "";
/** @type {{x: number, y: number} | null} */
let mark = null;
const shown = { times: /** @type {number[]} */ ([]), latency: 0, lastInput: 0, final: false, samples: 0 };

const link = new Link({ onText: receive, onPicture: receivePicture, onState: (now, reason) => showGone(now, reason, sceneName) });
const people = new People(link);
const settings = new Settings(element("settings"), set);
const timeLine = new TimeLine(link);
const recorder = new Recorder(link);

/** Where the picture lies in the window, in CSS pixels. */
function pictureBox() {
  const scale = Math.min(innerWidth / fullWidth, innerHeight / fullHeight);
  const width = fullWidth * scale, height = fullHeight * scale;
  return { x: (innerWidth - width) / 2, y: (innerHeight - height) / 2, width, height };
}

function draw() {
  const ratio = devicePixelRatio, at = pictureBox();
  const width = Math.round(innerWidth * ratio), height = Math.round(innerHeight * ratio);
  if (canvas.width !== width || canvas.height !== height) {
    canvas.width = width;
    canvas.height = height;
  }
  context.fillStyle = "#0d0e11";
  context.fillRect(0, 0, width, height);
  if (picture) {
    context.imageSmoothingQuality = "high";
    context.drawImage(picture, at.x * ratio, at.y * ratio, at.width * ratio, at.height * ratio);
  }
  const ring = element("mark");
  ring.hidden = !mark;
  if (mark) {
    ring.style.left = `${at.x + mark.x * at.width}px`;
    ring.style.top = `${at.y + mark.y * at.height}px`;
  }
}

/** @param {import("./link.js").Header} header @param {ImageBitmap} next */
function receivePicture(header, next) {
  picture?.close();
  picture = next;
  fullWidth = header.fullWidth;
  fullHeight = header.fullHeight;
  draw();
  const now = performance.now();
  shown.times = [...shown.times.filter((time) => now - time < 2000), now];
  shown.final = header.isFinal;
  shown.samples = header.samples;
  if (header.input > shown.lastInput || header.input < shown.lastInput - 1000) shown.lastInput = header.input;
  const latency = link.latencyOf(header.input);
  if (latency !== undefined) shown.latency = latency;
  document.body.dataset.latency = latency === undefined ? "" : String(latency);
  document.body.dataset.frame = String(header.frame);
  document.body.dataset.samples = String(header.samples);
  document.body.dataset.kind = header.kind === 2 ? "png" : "jpeg";
}

/** Pictures a second that came here in the last two seconds. */
function pictureRate() {
  const times = shown.times;
  if (times.length < 3 || performance.now() - times[times.length - 1] > 1500) return 0;
  return (1000 * (times.length - 1)) / (times[times.length - 1] - times[0]);
}

/** @param {any} message */
function receive(message) {
  switch (message.type) {
    case "welcome":
      sceneName = message.scene;
      element("scene").textContent = message.scene;
      document.title = `${message.scene} – Pertev`;
      settings.build(message.settings);
      buildButtons(message.cameras);
      showRows(element("about"), message.about, (name) => makeGroup(name, `about-${name}`, false));
      if (state) receive(state);
      break;
    case "people":
      people.show(message);
      for (const part of [settings, timeLine, recorder]) part.allow(people.steers());
      tellRate();
      tellShape();
      break;
    case "state":
      state = message;
      if (message.phase === "moving" && mark) {
        mark = null; // the picked point lies elsewhere now
        draw();
      }
      settings.showState(message, people.you);
      timeLine.showState(message, people.you);
      recorder.show(message.keys);
      showReadings();
      break;
    case "notice":
      notify(message.text, message.kind);
      break;
    case "picked":
      mark = message.rows.length ? { x: message.x, y: message.y } : null;
      element("picked").hidden = message.rows.length === 0;
      showRows(element("picked"), message.rows);
      draw();
      break;
  }
}

/** The position of a row's group; rows of one group keep their order.
 * @param {string[]} row */
function order(row) {
  return ["Now", "Scene", "Frames", "Rays", "Stages"].indexOf(row[0]);
}

function showReadings() {
  if (!state) return;
  /** @type {[string, string, string][]} */
  const own = [];
  const rate = pictureRate();
  if (rate) own.push(["Frames", "shown here", `${rate.toFixed(1)} per second`]);
  if (shown.latency) own.push(["Frames", "input to picture", `${shown.latency.toFixed(0)} ms`]);
  const rows = [...state.rows];
  rows.push(...own);
  rows.sort((a, b) => order(a) - order(b));
  showRows(element("readings"), rows, (name) => makeGroup(name, `numbers-${name}`, name === "Now"));
  const words = /** @type {Record<string, string>} */ ({ moving: "moving", gathering: "gathering samples", done: "done" });
  element("phase").textContent = `${words[state.phase] ?? state.phase} · ${state.samples} of ${state.spp}`;
  element("done").style.width = `${Math.min(100, (100 * state.samples) / Math.max(state.spp, 1))}%`;
  document.body.dataset.phase = state.phase;
  document.body.dataset.hash = state.hash;
  document.body.dataset.flags = state.flags;
}

/** @param {string[]} cameras */
function buildButtons(cameras) {
  const box = element("buttons");
  box.replaceChildren(
    button("Home", () => link.sendInput({ type: "home" })), button("Meter", () => link.sendInput({ type: "meter" })),
    button("Focus", () => { controls.nextUse = "focus"; notify("click the surface to focus on"); }),
    button("Flags", copyFlags), button("PNG", () => save("png")), button("EXR", () => save("exr")),
    button("Keys", () => help.showModal()));
  if (cameras.length > 0) {
    const list = document.createElement("select");
    list.id = "cameras";
    list.append(new Option("Camera …", ""), ...cameras.map((name, i) => new Option(name, String(i))));
    list.addEventListener("change", () => {
      if (list.value) link.sendInput({ type: "camera", index: Number(list.value) });
      list.value = "";
      list.blur();
    });
    list.style.gridColumn = "1 / -1";
    list.style.width = "100%";
    box.prepend(list);
  }
}

let screenRate = 0; // pictures a second; 0: not known yet

/** Sends the screen's rate if this page steers, because the viewer follows it. */
function tellRate() {
  if (screenRate > 0 && people.steers()) link.send({ type: "rate", hz: Math.min(Math.max(screenRate, 1), 1000) });
}

/** Sends the window's shape if this page steers, because the picture takes it. */
function tellShape() {
  if (people.steers()) link.send({ type: "shape", ...windowShape() });
}

let noticeTimer = 0;
/** @param {string} text @param {string} [kind] */
function notify(text, kind = "note") {
  const box = element("notice");
  box.textContent = text;
  box.className = kind;
  box.hidden = false;
  clearTimeout(noticeTimer);
  noticeTimer = setTimeout(() => { box.hidden = true; }, kind === "error" ? 8000 : Math.max(2500, 60 * text.length));
}

async function copyFlags() {
  if (!state) return;
  try {
    await navigator.clipboard.writeText(state.flags);
    notify("copied: " + state.flags);
  } catch {
    notify(state.flags); // where the browser keeps its clipboard, they can be read at least
  }
}

/** @param {string} format */
function save(format) {
  const anchor = document.createElement("a");
  anchor.href = `save?format=${format}`;
  anchor.download = `pertev.${format}`;
  document.body.append(anchor);
  anchor.click();
  anchor.remove();
}

/** @param {string} name @param {string | number} value */
function set(name, value) {
  if (!people.steers()) return void link.sendInput({ type: "set", name, value }); // who steers sees the request
  if (state) state.values[name] = value; // so that a key pressed twice counts twice before the viewer answers
  settings.expect(name, value, link.sendInput({ type: "set", name, value }));
}

/** @param {boolean} open */
function showPanel(open) {
  element("panel").hidden = !open;
  element("panel-open").hidden = open;
  remember("panel", open);
}

function toggleHelp() {
  if (help.open) help.close();
  else help.showModal();
}

function buildHelp() {
  const table = document.createElement("table");
  for (const { keys, text } of kKeys) {
    const row = table.insertRow();
    const cell = row.insertCell();
    for (const key of keys) cell.append(make("kbd", key), " ");
    row.insertCell().textContent = text;
  }
  help.replaceChildren(make("h1", "Keys and mouse"), table);
  help.addEventListener("click", () => help.close());
}

/** @type {Record<string, (event: KeyboardEvent) => void>} */
const actions = {
  KeyR: () => link.sendInput({ type: "home" }),
  Space: () => timeLine.toggle(),
  KeyT: () => state && set("mode", state.values.mode === "reference" ? "real time" : "reference"),
  BracketLeft: () => state && set("exposure", state.values.exposure - 0.25),
  BracketRight: () => state && set("exposure", state.values.exposure + 0.25),
  KeyC: () => void copyFlags(),
  KeyH: toggleHelp,
  Tab: () => showPanel(element("panel").hidden),
  F12: () => { // some browsers take one download at a time
    save("png");
    setTimeout(() => save("exr"), 300);
  },
};
for (let depth = 0; depth <= 9; ++depth) actions[`Digit${depth}`] = () => set("max_depth", depth);

const controls = new Controls(canvas, link, pictureBox, actions);
buildHelp();
addEventListener("resize", draw);
watchShape(tellShape);
showPanel(remembered("panel", innerWidth > 640)); // a phone shows the picture first
element("panel-open").addEventListener("click", () => showPanel(true));
element("panel-close").addEventListener("click", () => showPanel(false));
element("gone-again").addEventListener("click", () => link.tryAgain());
setInterval(showReadings, 500);
watchRate((rate) => {
  screenRate = rate;
  tellRate();
});
canvas.focus();
