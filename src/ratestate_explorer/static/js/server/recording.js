// In place of the connection, in a page that was saved: the answers that it was saved with.

import { decode } from "../common/wire.js";

const LIVE = "[data-live], [data-file], #controls :is(input, select, button)"; // what needs a server

export class Recording {
  /**
   * text: JSON of [{ask, entries, along (of "branch"), answer in base64}, ...], the greeting first
   * on: {answer(object)}
   */
  constructor(text, on) {
    this.on = on;
    this.count = 0;
    [this.greeting, ...this.rows] = JSON.parse(text);
    this.play(this.greeting, null);
  }

  /** Ask; gives the question's id.  Where nothing was recorded for these entries, the first answer to such a question is given. */
  ask(what, entries, { along } = {}) {
    this.count += 1;
    const rows = this.rows.filter((row) => row.ask === what && row.along === along);
    const row = rows.find((same) => key(same.entries) === key(entries)) ?? rows[0];
    if (row) this.play(row, this.count);
    return this.count;
  }

  /** The runs that were pinned: [{picture, texts}, ...]. */
  get pinned() {
    const [, ...others] = this.rows.filter(({ ask }) => ask === "picture");
    return others.map((row) => ({ picture: read(row), texts: row.entries }));
  }

  play(row, id) {
    setTimeout(() => this.on.answer({ ...read(row), id }));
  }
}

function read({ answer }) {
  return decode(Uint8Array.from(atob(answer), (letter) => letter.charCodeAt(0)).buffer);
}

/** Show what needs a server as what cannot be used; again after each picture, since there may be more. */
export function disable() {
  document.body.classList.add("saved");
  for (const control of document.querySelectorAll(LIVE)) control.disabled = true;
}

/** Entries, in whatever order, as a text; those that are null are none. */
function key(entries) {
  return JSON.stringify(Object.entries(entries).filter(([, text]) => text != null).sort());
}
