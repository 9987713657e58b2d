// The steps that undo and redo lead through: addresses that the page has had, each with its number.

import { keep, recall } from "../common/kept.js";

const KEY = "last step";

/** Those of the browser's own history, through which its button Back leads too. */
export class BrowserSteps {
  constructor() {
    Object.assign(this, { leaves: false, last: 0 });
    // An address that was typed, or opened by a link, has no state yet; one that is loaded again has.
    if (history.state === null) {
      history.replaceState({ step: 0 }, "");
      this.end(0);
    } else this.last = Math.max(recall(KEY) ?? 0, this.step);
    addEventListener("popstate", () => (this.leaves = false));
  }

  get step() {
    return history.state.step;
  }

  add(address) {
    this.end(this.step + 1);
    history.pushState({ step: this.last }, "", address);
  }

  replace(address) {
    history.replaceState(history.state, "", address);
  }

  go(way) {
    // The browser goes there later: asked twice, it would leave the page.
    if (this.leaves) return;
    this.leaves = true;
    history.go(way);
  }

  /** The address is another. */
  moved() {
    if (history.state !== null) return;
    this.end(this.last + 1);
    history.replaceState({ step: this.last }, "");
  }

  end(last) {
    this.last = last;
    keep(KEY, last);
  }
}

/** Those of a page in a frame: the browser's history is one for all frames of a notebook. */
export class OwnSteps {
  constructor() {
    Object.assign(this, { step: 0, addresses: [location.hash] });
  }

  get last() {
    return this.addresses.length - 1;
  }

  add(address) {
    this.step += 1;
    this.addresses.splice(this.step, Infinity);
    this.replace(address);
  }

  replace(address) {
    this.addresses[this.step] = address;
    history.replaceState(null, "", address);
  }

  go(way) {
    this.step += way;
    location.replace(this.addresses[this.step]);
  }

  moved() {
    if (location.hash !== this.addresses[this.step]) this.add(location.hash);
  }
}
