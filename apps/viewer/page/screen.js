// The viewer is to know this of the screen: how often it shows a new picture, as the browser calls back once for each, and
// the shape of the window.

const kPictures = 60; // from which a rate is estimated

/** @param {(rate: number) => void} report pictures a second, once that is known, and again when it is another: a window may
 * be moved to another screen */
export function watchRate(report) {
  let last = 0, sent = 0;
  /** @type {number[]} */
  let steps = [];
  /** @param {number} now */
  const step = (now) => {
    requestAnimationFrame(step);
    const ms = now - last;
    last = now;
    if (ms > 0 && ms < 100) steps.push(ms); // longer: the page was hidden
    if (steps.length < kPictures) return;
    const rate = 1000 / steps.sort((a, b) => a - b)[kPictures / 4]; // a page that is busy misses some
    steps = [];
    if (Math.abs(rate - sent) < 0.1 * sent) return;
    sent = rate;
    report(rate);
  };
  requestAnimationFrame(step);
}

const kSettles = 250; // milliseconds without a change, after which a window has its shape: each shape is a new picture

/** Pixels of the screen that the window covers. */
export function windowShape() {
  const side = (/** @type {number} */ css) => Math.min(Math.max(Math.round(css * devicePixelRatio), 1), 65535);
  return { width: side(innerWidth), height: side(innerHeight) };
}

/** @param {() => void} report called when the window has got another shape */
export function watchShape(report) {
  let timer = 0;
  addEventListener("resize", () => {
    clearTimeout(timer);
    timer = setTimeout(report, kSettles);
  });
}
