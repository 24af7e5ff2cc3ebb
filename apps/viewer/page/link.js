// The connection to the viewer: texts as objects, pictures as bytes with their header; acknowledgements; coming back
// after the connection is lost. docs/viewer.md has the protocol.

/** @typedef {{kind: number, isFinal: boolean, frame: number, input: number, samples: number, width: number,
 *   height: number, fullWidth: number, fullHeight: number, offset: number, total: number}} Header */

/** "open"; "trying": the connection is gone and is tried again; "lost": only the user can reconnect; "ended": the
 * viewer said that it ends; "refused": the viewer said why it takes this page no more.
 * @typedef {"open" | "trying" | "lost" | "ended" | "refused"} LinkState */

const kHeaderBytes = 32;
const kSilentTries = 3, kMaxTries = 12; // about 2 s, and half a minute
const kGoingAway = 1001; // the code with which a viewer ends

/** @param {ArrayBuffer} message @returns {Header | null} */
export function readHeader(message) {
  if (message.byteLength < kHeaderBytes) return null;
  const view = new DataView(message);
  if (view.getUint8(0) !== 1) return null;
  return {
    kind: view.getUint8(1), isFinal: (view.getUint16(2, true) & 1) !== 0, frame: view.getUint32(4, true),
    input: view.getUint32(8, true), samples: view.getUint32(12, true), width: view.getUint16(16, true),
    height: view.getUint16(18, true), fullWidth: view.getUint16(20, true), fullHeight: view.getUint16(22, true),
    offset: view.getUint32(24, true), total: view.getUint32(28, true),
  };
}

/** The key by which the viewer recognises a page after a reconnect. */
function pageKey() {
  let key = sessionStorage.getItem("pertev-key");
  if (!key) {
    key = Array.from(crypto.getRandomValues(new Uint8Array(12)), (b) => b.toString(16).padStart(2, "0")).join("");
    sessionStorage.setItem("pertev-key", key);
  }
  return key;
}

export class Link {
  /** @param {{onText: (message: any) => void, onPicture: (header: Header, picture: ImageBitmap) => void,
   *   onState: (state: LinkState, reason: string) => void}} events */
  constructor(events) {
    this.events = events;
    /** @type {WebSocket | null} */
    this.socket = null;
    this.tries = 0;
    this.newest = 0; // number of the newest message with a picture
    /** @type {{frame: number, parts: Uint8Array[], bytes: number} | null} */
    this.pieces = null;
    this.input = 0;
    /** @type {Map<number, number>} when each input was sent, until its picture comes */
    this.sentAt = new Map();
    this.open();
  }

  open() {
    const socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/socket`);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    socket.onopen = () => {
      this.tries = 0;
      this.pieces = null;
      this.send({ type: "hello", key: pageKey() });
      this.events.onState("open", "");
    };
    socket.onmessage = (event) => this.receive(event.data);
    socket.onclose = (event) => this.lost(event.code, event.reason);
  }

  /** Reconnects after a lost connection, silently at first, but not after the viewer has refused the page.
   * @param {number} code @param {string} reason */
  lost(code, reason) {
    this.socket = null;
    this.sentAt.clear();
    if (code === kGoingAway && reason) return this.events.onState("ended", reason);
    if (reason) return this.events.onState("refused", reason);
    this.tries += 1;
    if (this.tries > kMaxTries) return this.events.onState("lost", "");
    if (this.tries > kSilentTries) this.events.onState("trying", "");
    setTimeout(() => this.open(), Math.min(3000, 200 * 1.6 ** this.tries));
  }

  /** The user requests it. */
  tryAgain() {
    if (this.socket) return;
    this.tries = kSilentTries;
    this.open();
  }

  /** @param {object} message */
  send(message) {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  /** Something whose picture is to be waited for. Gives its number.
   * @param {object} message */
  sendInput(message) {
    this.input += 1;
    if (this.sentAt.size > 200) this.sentAt.clear();
    this.sentAt.set(this.input, performance.now());
    this.send({ ...message, n: this.input });
    return this.input;
  }

  /** Milliseconds from the input that this picture shows first; nothing where it shows none.
   * @param {number} input */
  latencyOf(input) {
    const at = this.sentAt.get(input);
    for (const n of this.sentAt.keys()) if (n <= input) this.sentAt.delete(n);
    return at === undefined ? undefined : performance.now() - at;
  }

  /** @param {string | ArrayBuffer} data */
  receive(data) {
    if (typeof data === "string") {
      this.events.onText(JSON.parse(data));
      return;
    }
    const header = readHeader(data);
    if (!header) return;
    const began = performance.now();
    const acknowledge = () => this.send({ type: "ack", frame: header.frame, ms: Math.min(performance.now() - began, 1e6) });
    const bytes = new Uint8Array(data, kHeaderBytes);
    if (header.kind === 1) {
      this.pieces = null;
      this.decode(header, [bytes], "image/jpeg").then(acknowledge);
    } else if (header.kind === 2) {
      if (header.offset === 0) this.pieces = { frame: header.frame, parts: [], bytes: 0 };
      const pieces = this.pieces;
      if (pieces && pieces.bytes === header.offset) {
        pieces.parts.push(bytes);
        pieces.bytes += bytes.length;
        if (pieces.bytes === header.total) {
          this.pieces = null;
          this.decode(header, pieces.parts, "image/png").then(acknowledge);
          return;
        }
      }
      acknowledge();
    }
  }

  /** @param {Header} header @param {Uint8Array[]} parts @param {string} type */
  async decode(header, parts, type) {
    try {
      const picture = await createImageBitmap(new Blob(/** @type {BlobPart[]} */ (parts), { type }));
      if (header.frame < this.newest) { // a later one was faster
        picture.close();
        return;
      }
      this.newest = header.frame;
      this.events.onPicture(header, picture);
    } catch (fault) {
      console.error("a picture could not be decoded", fault);
    }
  }
}
