// Shows the viewers, who of them steers, and what the others request: in the panel, and in a bar that needs no panel.

import { button, element, make } from "./elements.js";

/** @typedef {import("./link.js").Link} Link */
/** @typedef {{id: number, asks: boolean, request: string}} Person */

export class People {
  /** @param {Link} link */
  constructor(link) {
    this.link = link;
    this.you = 0;
    this.holder = 0;
    /** @type {Person[]} */
    this.all = [];
    this.declined = ""; // the request that was read and put away
  }

  steers() {
    return this.you !== 0 && this.holder === this.you;
  }

  /** @param {{you: number, steers: number, people: Person[]}} message */
  show(message) {
    this.you = message.you;
    this.holder = message.steers;
    this.all = message.people;
    document.body.dataset.steers = String(this.steers());
    this.showRows();
    this.showBar();
  }

  /** @param {number} to */
  hand(to) {
    this.link.send({ type: "hand", to });
  }

  askButton() {
    return button("request control", () => this.link.send({ type: "ask" }));
  }

  showRows() {
    const list = element("people");
    list.hidden = this.all.length < 2 && this.steers();
    list.replaceChildren(make("h2", "Viewers"));
    for (const person of this.all) {
      const row = make("div", "", "row");
      row.append(make("b", `viewer ${person.id}${person.id === this.you ? " (you)" : ""}`));
      if (person.id === this.holder) {
        row.append(make("span", "steers", "value"));
      } else if (this.steers()) {
        row.append(button(person.asks ? "hand over (requested)" : "hand over", () => this.hand(person.id)));
      } else if (person.id === this.you) {
        row.append(person.asks ? make("span", "requested", "value") : this.askButton());
      }
      list.append(row);
      if (person.request && person.id !== this.holder) list.append(make("p", `would like to ${person.request}`, "request"));
    }
  }

  /** The steering client sees the requests of others there. The others see that another client steers. */
  showBar() {
    const requester = this.all.find((person) => person.id !== this.you && (person.request || person.asks));
    const own = this.all.find((person) => person.id === this.you);
    const request = requester ? `${requester.id} ${requester.request} ${requester.asks}` : "";
    if (request !== this.declined) this.declined = "";
    let text = "";
    /** @type {HTMLElement[]} */
    let buttons = [];
    if (this.steers()) {
      if (requester && !this.declined) {
        text = `viewer ${requester.id} would like to ${requester.request || "steer"}`;
        buttons = [button("hand over", () => this.hand(requester.id)), button("decline", () => {
          this.declined = request;
          this.showBar();
        })];
      }
    } else if (own) {
      text = this.holder ? `viewer ${this.holder} steers` : "no viewer steers";
      if (own.asks) text += "; you have requested control";
      else buttons = [this.askButton()];
    }
    element("control").hidden = text === "";
    element("control-text").textContent = text;
    element("control-buttons").replaceChildren(...buttons);
  }
}
