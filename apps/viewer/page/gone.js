// The page shows this without a connection: what is known, and what the user can do.

import { element } from "./elements.js";

/** @typedef {import("./link.js").LinkState} LinkState */

const kTitles = /** @type {Record<string, string>} */ ({
  trying: "The connection is lost", lost: "The viewer cannot be reached", ended: "The viewer has ended",
  refused: "The viewer has closed this page's connection",
});

/** @param {LinkState} now @param {string} reason @param {string} scene */
export function showGone(now, reason, scene) {
  document.body.dataset.gone = now;
  element("gone").hidden = now === "open";
  if (now === "open") return;
  element("gone-title").textContent = kTitles[now];
  element("gone-again").hidden = now === "ended" || now === "trying";
  const start = `pertev view ${scene || "SCENE"}, on the machine that has the scene, starts one. It prints the address to open.`;
  const texts = /** @type {Record<string, string>} */ ({
    trying: "The page tries again.",
    lost: `The network is down, or the viewer has ended: then ${start}`,
    ended: `It said: ${reason}. Its address is no longer valid. ${start}`,
    refused: `It said: ${reason}.`,
  });
  element("gone-text").textContent = texts[now];
  if (now === "lost") void lookForAnother(start);
}

/** Another viewer may listen at this address by now. It does not accept the old viewer's cookie.
 * @param {string} start */
async function lookForAnother(start) {
  try {
    const answer = await fetch(location.pathname, { cache: "no-store" });
    if (answer.status === 403) {
      element("gone-text").textContent = `The viewer of this page has ended, and another one is at its address: open the address that it printed. Or ${start}`;
    }
  } catch { // no viewer answers
  }
}
