// Groups of the panel that fold, and what this browser remembers of them: which are open, and whether the panel is.

import { make } from "./elements.js";

/** @param {string} key @param {boolean} otherwise where nothing is remembered */
export function remembered(key, otherwise) {
  try {
    return (localStorage.getItem(`pertev-${key}`) ?? String(otherwise)) === "true";
  } catch { // a browser that keeps nothing
    return otherwise;
  }
}

/** @param {string} key @param {boolean} value */
export function remember(key, value) {
  try {
    localStorage.setItem(`pertev-${key}`, String(value));
  } catch { // without storage nothing is remembered
  }
}

/** A group under its name, which folds it.
 * @param {string} name @param {string} key by which it is remembered @param {boolean} open at first
 * @returns {HTMLDetailsElement} */
export function makeGroup(name, key, open) {
  const group = document.createElement("details");
  group.open = remembered(`open-${key}`, open);
  group.dataset.group = name;
  const title = make("summary", name);
  title.addEventListener("click", () => {
    remember(`open-${key}`, !group.open); // it is about to fold or to open
    title.blur(); // keys steer again
  });
  group.append(title);
  return group;
}
