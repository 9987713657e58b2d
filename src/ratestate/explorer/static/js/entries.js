// What the page shows, as texts: kept here, and in the address, so that a link holds it all.

const WAIT = 150; // ms: browsers mind more than a hundred changes of the address in half a minute

export class Entries {
  constructor(names) {
    this.names = names;
    this.texts = {};
    this.timer = 0;
  }

  /** Take new texts; those not named stay. */
  set(texts) {
    Object.assign(this.texts, texts);
    for (const name of Object.keys(this.texts)) if (this.texts[name] == null) delete this.texts[name];
    clearTimeout(this.timer);
    this.timer = setTimeout(() => history.replaceState(null, "", `#${this.fragment()}`), WAIT);
  }

  fragment() {
    const known = this.names.filter((name) => name in this.texts);
    return new URLSearchParams(known.map((name) => [name, this.texts[name]])).toString();
  }

  link() {
    return `${location.origin}${location.pathname}#${this.fragment()}`;
  }

  /** The texts that the address holds, of names that are known; null if it holds none. */
  linked() {
    const given = [...new URLSearchParams(location.hash.slice(1))].filter(([name]) => this.names.includes(name));
    return given.length ? Object.fromEntries(given) : null;
  }
}
