// The time line of a scene that moves, and the recorder of the camera's path. Both show the viewer's state and send
// the user's changes; time and keys are kept by the viewer, so that all pages see the same.

import { button, element, make } from "./elements.js";
import { makeGroup } from "./groups.js";
import { PendingInput } from "./panel.js";

/** @typedef {import("./link.js").Link} Link */
/** @typedef {{at: number, end: number, on: boolean, loops: boolean, speed: number}} Clock */
/** @typedef {{time: number, eye: number[], target: number[], up: number[], fov: number}} Key */

const kSpeeds = /** @type {[string, number][]} */ ([["1/8", 0.125], ["1/4", 0.25], ["1/2", 0.5], ["1", 1], ["2", 2], ["4", 4]]);

/** @param {string} type @param {string} id */
function input(type, id) {
  const made = document.createElement("input");
  made.type = type;
  made.id = id;
  return made;
}

export class TimeLine {
  /** @param {Link} link */
  constructor(link) {
    this.link = link;
    /** @type {Clock} */
    this.clock = { at: 0, end: 0, on: false, loops: true, speed: 1 };
    this.receivedAt = 0; // when this state of the clock arrived
    this.pending = new PendingInput();
    this.button = button("", () => this.toggle(), "play", "Space");
    this.slider = input("range", "time-at");
    this.slider.min = "0";
    this.slider.step = "any";
    this.slider.setAttribute("aria-label", "Time, seconds");
    this.text = make("span", "", "value");
    this.text.id = "time-text";
    this.loops = input("checkbox", "time-loops");
    this.speed = document.createElement("select");
    this.speed.id = "time-speed";
    this.speed.append(...kSpeeds.map(([name, value]) => new Option(name, String(value))));
    this.slider.addEventListener("input", () => this.goTo(Number(this.slider.value)));
    this.slider.addEventListener("change", () => this.slider.blur());
    this.loops.addEventListener("change", () => this.play({ loops: this.loops.checked }));
    this.speed.addEventListener("change", () => {
      this.play({ speed: Number(this.speed.value) });
      this.speed.blur();
    });
    const line = make("div", "", "row");
    line.append(this.button, this.slider);
    const seconds = make("div", "", "row"), speed = make("label", "", "row"), loops = make("label", "", "row");
    seconds.append(make("span", "Seconds"), this.text);
    speed.append(make("span", "Speed"), this.speed);
    loops.append(make("span", "Repeat"), this.loops);
    const group = makeGroup("Time", "time", true);
    group.append(line, seconds, speed, loops);
    element("time").replaceChildren(group);
    requestAnimationFrame(() => this.step());
  }

  /** Plays or pauses. */
  toggle() {
    if (this.clock.end > 0 && !this.button.disabled) this.play({ on: !this.clock.on });
  }

  /** @param {Partial<Clock>} change */
  play(change) {
    const now = this.now();
    this.keep({ ...this.clock, at: change.on && now >= this.clock.end ? 0 : now, ...change });
    const { on, loops, speed } = this.clock;
    this.pending.sent(this.link.sendInput({ type: "play", on, loops, speed }));
  }

  /** @param {number} at */
  goTo(at) {
    this.keep({ ...this.clock, at });
    this.pending.sent(this.link.sendInput({ type: "time", at }));
  }

  /** Takes the state that the viewer sends.
   * @param {any} state @param {number} you */
  showState(state, you) {
    if (this.pending.isKnownTo(state, you)) this.keep(state.clock);
  }

  /** @param {Clock} clock */
  keep(clock) {
    this.clock = clock;
    this.receivedAt = performance.now();
    element("time").hidden = !(clock.end > 0);
    this.button.textContent = clock.on ? "❚❚" : "▶";
    this.button.setAttribute("aria-label", clock.on ? "Pause" : "Play");
    this.slider.max = String(clock.end);
    this.loops.checked = clock.loops;
    if (document.activeElement !== this.speed) this.speed.value = String(clock.speed);
    document.body.dataset.plays = String(clock.on && clock.end > 0);
    this.show();
  }

  /** Returns the current seconds: those of the last state plus what has passed since. */
  now() {
    const { at, end, on, loops, speed } = this.clock;
    const now = on ? at + ((performance.now() - this.receivedAt) / 1000) * speed : at;
    return loops && end > 0 ? now % end || Math.min(now, end) : Math.min(now, end);
  }

  show() {
    const at = this.now();
    if (document.activeElement !== this.slider || this.clock.on) this.slider.value = String(at);
    this.text.textContent = `${at.toFixed(2)} of ${this.clock.end.toFixed(2)}`;
    document.body.dataset.time = String(this.clock.at);
  }

  step() {
    requestAnimationFrame(() => this.step());
    if (this.clock.on && this.clock.end > 0) this.show();
  }

  /** @param {boolean} may */
  allow(may) {
    for (const field of [this.button, this.slider, this.loops, this.speed]) field.disabled = !may;
  }
}

export class Recorder {
  /** @param {Link} link */
  constructor(link) {
    this.link = link;
    this.may = true;
    /** @type {Key[]} */
    this.keys = [];
    this.list = make("div", "");
    this.list.id = "keys";
    this.time = input("number", "key-time");
    this.time.min = "0";
    this.time.step = "any";
    this.time.value = "0";
    this.time.setAttribute("aria-label", "Seconds of the next key");
    this.add = button("Add this view", () => this.addKey(), "key-add", "add a key of this view at that time");
    this.play = button("Play", () => link.sendInput({ type: "follow" }), "path-play", "play the camera path");
    this.download = button("Download", () => this.save(), "path-download", "save as JSON for --camera-path");
    const row = make("div", "", "row"), buttons = make("div", "", "pair");
    row.append(this.time, this.add);
    buttons.append(this.play, this.download);
    const group = makeGroup("Camera path", "recorder", false);
    group.append(this.list, row, buttons);
    element("recorder").replaceChildren(group);
    this.allow(true);
  }

  addKey() {
    const at = Math.fround(Number(this.time.value)); // rounded like the file reader's floats
    if (!(at >= 0 && at <= 1e9)) return;
    this.link.sendInput({ type: "key", at });
  }

  /** @param {Key[]} keys */
  show(keys) {
    if (JSON.stringify(keys) === JSON.stringify(this.keys)) return;
    this.keys = keys;
    this.list.replaceChildren(...keys.map((key, i) => {
      const row = make("div", "", "row key"), eye = key.eye.map((x) => Number(x.toPrecision(3))).join(", ");
      const seconds = make("b", `${Number(key.time.toPrecision(4))} s`), text = make("span", `from ${eye}`);
      row.title = `eye ${key.eye.join(", ")}; target ${key.target.join(", ")}; up ${key.up.join(", ")}; ${key.fov}°`;
      const remove = button("×", () => this.link.sendInput({ type: "unkey", index: i }), `key-remove-${i}`, "delete");
      remove.disabled = !this.may;
      row.append(seconds, text, remove);
      return row;
    }));
    const last = keys.length ? keys[keys.length - 1].time : 0;
    if (document.activeElement !== this.time) this.time.value = String(keys.length ? Math.round(100 * last) / 100 + 2 : 0);
    this.allow(this.may);
  }

  /** The path as pertev render --camera-path reads it. */
  text() {
    return `{"keys": [\n${this.keys.map((key) => "  " + JSON.stringify(key)).join(",\n")}\n]}\n`;
  }

  save() {
    const anchor = document.createElement("a");
    anchor.href = URL.createObjectURL(new Blob([this.text()], { type: "application/json" }));
    anchor.download = "camera-path.json";
    anchor.click();
    setTimeout(() => URL.revokeObjectURL(anchor.href), 10000);
  }

  /** @param {boolean} may */
  allow(may) {
    this.may = may;
    this.add.disabled = this.time.disabled = !may;
    this.play.disabled = !may || this.keys.length < 2;
    this.download.disabled = this.keys.length === 0;
    for (const remove of this.list.querySelectorAll("button")) remove.disabled = !may;
  }
}
