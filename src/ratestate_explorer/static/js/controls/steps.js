// The steps that undo and redo lead through: addresses that the page has had, each with its number.

/** Those of the browser's own history, through which its button Back leads too. */
export class BrowserSteps {
  constructor() {
    this.leaves = false;
    // An address that was typed, or opened by a link, has no state yet; one that is loaded again has.
    if (history.state === null) history.replaceState({ step: 0 }, "");
    this.last = this.step + ahead();
    addEventListener("popstate", () => (this.leaves = false));
  }

  get step() {
    return history.state.step;
  }

  add(address) {
    this.last = this.step + 1;
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
    this.last += 1;
    history.replaceState({ step: this.last }, "");
  }
}

/** How many entries of the browser's history this page can go forward to; 0 where it does not say. */
function ahead() {
  const { navigation } = window;
  if (!navigation?.currentEntry) return 0;
  return navigation.entries().slice(navigation.currentEntry.index + 1).filter((entry) => entry.sameDocument).length;
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
