// Elements of the page: found by their names, or made.

/** @param {string} id @returns {HTMLElement} */
export function element(id) {
  const found = document.getElementById(id);
  if (!found) throw new Error(`the page lacks #${id}`);
  return found;
}

/** @param {string} tag @param {string} text @param {string} [name] */
export function make(tag, text, name = "") {
  const made = document.createElement(tag);
  made.textContent = text;
  if (name) made.className = name;
  return made;
}

/** @param {string} text @param {() => void} onClick @param {string} [id] @param {string} [hint] */
export function button(text, onClick, id = "", hint = "") {
  const made = /** @type {HTMLButtonElement} */ (make("button", text));
  made.id = id;
  made.title = hint;
  made.addEventListener("click", () => {
    onClick();
    made.blur(); // keys steer again
  });
  return made;
}
