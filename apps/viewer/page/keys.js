// Keys, mouse and touch to messages. Keys go by their position (`code`), so every layout works; never with Ctrl, which
// belongs to the browser.

/** @typedef {import("./link.js").Link} Link */
/** @typedef {{x: number, y: number, width: number, height: number}} Box of the picture in the window */

/** The actions of keys: one table for the help and the keyboard. */
export const kKeys = [
  { keys: ["W", "A", "S", "D"], text: "forward, left, back, right" },
  { keys: ["Q", "E"], text: "down, up" },
  { keys: ["Shift", "Z"], text: "held: fast, slow" },
  { keys: ["left drag"], text: "orbit the centre" },
  { keys: ["right drag"], text: "look around; the wheel then changes the speed" },
  { keys: ["middle drag"], text: "pan" },
  { keys: ["wheel"], text: "zoom" },
  { keys: ["click"], text: "show instance, mesh and material" },
  { keys: ["double click"], text: "set the orbit centre" },
  { keys: ["Alt", "click"], text: "focus on the surface (or the panel's Focus, then click)" },
  { keys: ["R"], text: "reset the camera" },
  { keys: ["Space"], text: "play or pause" },
  { keys: ["T"], text: "at rest: show the reference, or real time" },
  { keys: ["[", "]"], text: "exposure down, up" },
  { keys: ["0", "…", "9"], text: "max depth, at rest and in motion" },
  { keys: ["C"], text: "copy the camera as flags of pertev render" },
  { keys: ["F12"], text: "save PNG and EXR" },
  { keys: ["Tab"], text: "panel" },
  { keys: ["Enter"], text: "accept the number and steer again" },
  { keys: ["H"], text: "this help" },
  { keys: ["one finger, two"], text: "orbit; pan and zoom" },
];

const kAxes = /** @type {Record<string, [string, number]>} */ ({
  KeyW: ["forward", 1], KeyS: ["forward", -1], KeyD: ["right", 1], KeyA: ["right", -1], KeyE: ["up", 1], KeyQ: ["up", -1],
});

const kLeaving = ["Enter", "NumpadEnter", "Escape"]; // a field that a number is typed into
const kClickPixels = 4; // a drag is longer

export class Controls {
  /** @param {HTMLCanvasElement} canvas @param {Link} link @param {() => Box} box
   * @param {Record<string, (event: KeyboardEvent) => void>} actions by key code */
  constructor(canvas, link, box, actions) {
    this.canvas = canvas;
    this.link = link;
    this.box = box;
    this.actions = actions;
    /** @type {Set<string>} */
    this.held = new Set();
    this.lastTime = 0;
    /** @type {Map<number, {x: number, y: number}>} */
    this.pointers = new Map();
    this.button = -1;
    this.travelled = 0;
    this.drag = { kind: "", dx: 0, dy: 0 };
    this.nextUse = "show"; // use of the next click
    addEventListener("keydown", (event) => this.keyDown(event));
    addEventListener("keyup", (event) => this.held.delete(event.code));
    addEventListener("blur", () => this.held.clear());
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("pointerdown", (event) => this.pointerDown(event));
    canvas.addEventListener("pointermove", (event) => this.pointerMove(event));
    canvas.addEventListener("pointerup", (event) => this.pointerUp(event));
    canvas.addEventListener("pointercancel", (event) => this.pointerUp(event));
    canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    canvas.addEventListener("dblclick", (event) => this.pick(event, "orbit"));
    requestAnimationFrame((now) => this.step(now));
  }

  /** @param {KeyboardEvent} event */
  keyDown(event) {
    if (event.ctrlKey || event.metaKey) return;
    const target = event.target;
    const types = target instanceof HTMLInputElement && target.type === "number";
    if (types && kLeaving.includes(event.code)) return target.blur(); // the text is accepted, and keys steer again
    if (types && event.code !== "Tab" && event.code !== "F12") return;
    if (event.code === "Escape" && target instanceof HTMLElement) target.blur();
    if (event.code in kAxes || event.code.startsWith("Shift") || event.code === "KeyZ") {
      if (target instanceof HTMLSelectElement) target.blur();
      if (this.held.size === 0) this.lastTime = performance.now();
      this.held.add(event.code);
      return;
    }
    const action = this.actions[event.code];
    if (!action || event.altKey) return;
    event.preventDefault();
    if (!event.repeat || event.code.startsWith("Bracket")) action(event);
  }

  /** Once a frame of the browser.
   * @param {number} now */
  step(now) {
    requestAnimationFrame((next) => this.step(next));
    const ms = Math.min(Math.max(now - this.lastTime, 0), 250);
    this.lastTime = now;
    const move = /** @type {Record<string, number>} */ ({ right: 0, up: 0, forward: 0 });
    for (const code of this.held) {
      const axis = kAxes[code];
      if (axis) move[axis[0]] += axis[1];
    }
    if (ms > 0 && (move.right || move.up || move.forward)) {
      const fast = this.held.has("ShiftLeft") || this.held.has("ShiftRight");
      this.link.sendInput({ type: "move", ...move, ms, pace: fast ? "fast" : this.held.has("KeyZ") ? "slow" : "normal" });
    }
    if (this.drag.kind && (this.drag.dx || this.drag.dy)) { // many moves of a mouse, one message
      this.link.sendInput({ type: this.drag.kind, dx: clamp(this.drag.dx, 4), dy: clamp(this.drag.dy, 4) });
      this.drag.dx = this.drag.dy = 0;
    }
  }

  /** @param {PointerEvent} event */
  pointerDown(event) {
    this.canvas.focus();
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (this.pointers.size === 1) {
      this.button = event.button;
      this.travelled = 0;
    }
    this.canvas.classList.add("dragging");
    if (event.button === 1) event.preventDefault();
  }

  /** @param {PointerEvent} event */
  pointerMove(event) {
    const last = this.pointers.get(event.pointerId);
    if (!last) return;
    const before = [...this.pointers.values()].map((p) => ({ ...p }));
    const dx = event.clientX - last.x, dy = event.clientY - last.y;
    last.x = event.clientX;
    last.y = event.clientY;
    this.travelled += Math.abs(dx) + Math.abs(dy);
    if (this.travelled < kClickPixels) return;
    const height = Math.max(this.box().height, 1);
    const now = [...this.pointers.values()];
    if (now.length === 2) { // two fingers: both at once
      const span = (/** @type {{x: number, y: number}[]} */ p) => Math.hypot(p[0].x - p[1].x, p[0].y - p[1].y);
      const steps = Math.log(Math.max(span(now), 1) / Math.max(span(before), 1)) / Math.log(7 / 6);
      if (steps) this.link.sendInput({ type: "zoom", steps: clamp(steps, 20) });
      this.add("pan", dx / height / 2, dy / height / 2);
    } else {
      this.add(this.button === 2 ? "look" : this.button === 1 ? "pan" : "orbit", dx / height, dy / height);
    }
  }

  /** @param {string} kind @param {number} dx @param {number} dy */
  add(kind, dx, dy) {
    if (this.drag.kind !== kind) this.drag = { kind, dx: 0, dy: 0 };
    this.drag.dx += dx;
    this.drag.dy += dy;
  }

  /** @param {PointerEvent} event */
  pointerUp(event) {
    if (!this.pointers.delete(event.pointerId) || this.pointers.size > 0) return;
    this.canvas.classList.remove("dragging");
    if (event.type !== "pointerup" || this.travelled >= kClickPixels || this.button !== 0) return;
    this.pick(event, event.altKey ? "focus" : this.nextUse);
    this.nextUse = "show";
  }

  /** @param {MouseEvent} event @param {string} use */
  pick(event, use) {
    const box = this.box();
    const x = (event.clientX - box.x) / box.width, y = (event.clientY - box.y) / box.height;
    if (x < 0 || x > 1 || y < 0 || y > 1) return;
    this.link.sendInput({ type: "pick", x, y, use });
  }

  /** @param {WheelEvent} event */
  wheel(event) {
    event.preventDefault();
    const unit = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 1 / 3 : event.deltaMode === WheelEvent.DOM_DELTA_PAGE ? 1 : 1 / 100;
    const steps = clamp(-event.deltaY * unit, 20);
    if (!steps) return;
    const looks = this.pointers.size > 0 && this.button === 2;
    this.link.sendInput({ type: looks ? "speed" : "zoom", steps });
  }
}

/** @param {number} value @param {number} most */
function clamp(value, most) {
  return Math.max(-most, Math.min(most, value));
}
