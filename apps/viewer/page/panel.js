// The panel: rows of numbers and settings as the viewer describes them. Nothing here knows a single setting: a new one is
// a row of the program's own table (apps/viewer/view_state.cpp).

import { make } from "./elements.js";
import { makeGroup } from "./groups.js";

/** @typedef {{name: string, label: string, group: string, hint: string, kind: "choice" | "number" | "whole", choices: string[],
 *   low: number, high: number, step: number}} Setting */

/** Rows of [group, label, value] under headings. Elements stay while the rows are the same, so that text can be marked.
 * @param {HTMLElement} parent @param {[string, string, string][]} rows
 * @param {(name: string) => HTMLElement} [groupFor] makes what holds a group's rows; without it there are headings */
export function showRows(parent, rows, groupFor) {
  const shape = rows.map((row) => row[0] + "\n" + row[1]).join("\n\n");
  if (parent.dataset.shape !== shape) {
    parent.dataset.shape = shape;
    parent.replaceChildren();
    let group = "", holder = parent;
    for (const [name, label] of rows) {
      if (name !== group) {
        if (groupFor) parent.append((holder = groupFor(name)));
        else parent.append(make("h2", name));
      }
      group = name;
      const row = make("div", "", "row reading");
      row.append(make("span", label), make("span", "", kMarked[label] ?? "value"));
      holder.append(row);
    }
  }
  const values = parent.querySelectorAll(".value");
  rows.forEach((row, i) => {
    if (values[i].textContent !== row[2]) values[i].textContent = row[2];
  });
}

const kMarked = /** @type {Record<string, string>} */ ({ "film hash": "value hash", "flags for this picture": "value hash long" });

/** An input that was sent: older states that are still on their way do not count. */
export class PendingInput {
  constructor() {
    this.input = 0;
    this.at = -Infinity;
  }

  /** @param {number} input its number */
  sent(input) {
    this.input = input;
    this.at = performance.now();
  }

  /** @param {{input: number, steerer: number}} state @param {number} you this page's own number */
  isKnownTo(state, you) {
    if (performance.now() - this.at > kPatience) return true; // the viewer ignored it, because another client steers
    return state.steerer === you && state.input >= this.input;
  }
}

const kPatience = 4000; // milliseconds
const kOpenSettings = ["Picture", "Light"]; // at first

export class Settings {
  /** @param {HTMLElement} parent @param {(name: string, value: string | number) => void} onChange */
  constructor(parent, onChange) {
    this.parent = parent;
    this.onChange = onChange;
    /** @type {Map<string, HTMLInputElement | HTMLSelectElement>} */
    this.fields = new Map();
    /** @type {Map<string, {pending: PendingInput, value: string | number}>} */
    this.pending = new Map();
  }

  /** @param {Setting[]} settings */
  build(settings) {
    this.parent.replaceChildren();
    this.fields.clear();
    let group = "", holder = this.parent;
    for (const setting of settings) {
      if (setting.group !== group) {
        holder = makeGroup(setting.group, `settings-${setting.group}`, kOpenSettings.includes(setting.group));
        this.parent.append(holder);
      }
      group = setting.group;
      const field = setting.kind === "choice" ? choiceField(setting) : numberField(setting);
      field.id = `setting-${setting.name}`;
      field.addEventListener("change", () => {
        this.onChange(setting.name, setting.kind === "choice" ? field.value : Number(field.value));
        if (setting.kind === "choice") field.blur(); // keys steer again
      });
      const row = make("label", "", "row");
      row.title = setting.hint;
      row.append(make("span", setting.label), field);
      holder.append(row);
      this.fields.set(setting.name, field);
    }
  }

  /** Something was set, by input number `input`.
   * @param {string} name @param {string | number} value @param {number} input */
  expect(name, value, input) {
    const pending = new PendingInput();
    pending.sent(input);
    this.pending.set(name, { pending, value });
  }

  /** Values of a state, with what was set since.
   * @param {any} state @param {number} you */
  showState(state, you) {
    for (const [name, { pending, value }] of this.pending) {
      if (pending.isKnownTo(state, you)) this.pending.delete(name);
      else state.values[name] = value;
    }
    for (const [name, value] of Object.entries(state.values)) {
      const field = this.fields.get(name);
      if (!field || field === document.activeElement) continue;
      field.value = typeof value === "number" ? String(Number(value.toPrecision(6))) : value;
    }
  }

  /** @param {boolean} may */
  allow(may) {
    for (const field of this.fields.values()) field.disabled = !may;
  }
}

/** @param {Setting} setting */
function choiceField(setting) {
  const field = document.createElement("select");
  for (const choice of setting.choices) field.append(new Option(choice, choice));
  return field;
}

/** @param {Setting} setting */
function numberField(setting) {
  const field = document.createElement("input");
  field.type = "number";
  field.min = String(setting.low);
  field.max = String(setting.high);
  field.step = setting.kind === "whole" ? "1" : "any";
  return field;
}
