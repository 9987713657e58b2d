// Undo and redo: the browser's own history, whose entries are the addresses that the page has had.

import { $ } from "../common/dom.js";

const WAIT = 400; // ms without a change that make one step of all changes before

export class Past {
  /** fragment: function () that gives what the address holds of the present state; null if it holds nothing */
  constructor(fragment) {
    Object.assign(this, { fragment, timer: 0, adds: false, leaves: false, last: 0 });
    // An address that was typed, or opened by a link, has no state yet.
    if (history.state === null) history.replaceState({ step: 0 }, "");
    this.last = this.step;
    $("undo").addEventListener("click", () => this.go(-1));
    $("redo").addEventListener("click", () => this.go(1));
    addEventListener("popstate", () => (this.leaves = false));
    addEventListener("keydown", (event) => this.key(event));
    this.tell();
  }

  get step() {
    return history.state.step;
  }

  /** What is shown was changed by the user: once it rests, a step that can be undone. */
  add() {
    this.adds = true;
    this.keep();
  }

  /** Write what is shown into the address once it rests. */
  keep() {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.write(), WAIT);
  }

  write() {
    if (!this.fragment) return;
    const address = `#${this.fragment()}`;
    if (this.adds && address !== location.hash) {
      this.last = this.step + 1;
      history.pushState({ step: this.last }, "", address);
    } else history.replaceState(history.state, "", address);
    this.adds = false;
    this.tell();
  }

  /** Undo (-1) or redo (1) a step; what has not rested yet is one too. */
  go(way) {
    if (this.adds) {
      clearTimeout(this.timer);
      this.write();
    }
    // The browser goes there later: asked twice, it would leave the page.
    const there = this.step + way;
    if (this.leaves || there < 0 || there > this.last) return;
    this.leaves = true;
    history.go(way);
  }

  /** The address has changed, but not by `write`: by undo, by redo, or by hand. */
  moved() {
    clearTimeout(this.timer);
    this.adds = false;
    if (history.state === null) {
      this.last += 1;
      history.replaceState({ step: this.last }, "");
    }
    this.tell();
  }

  key(event) {
    // In a text field they undo typing.
    if (!(event.ctrlKey || event.metaKey) || event.target.matches?.("input[type=text]")) return;
    const key = event.key.toLowerCase();
    const button = key === "y" || (key === "z" && event.shiftKey) ? $("redo") : key === "z" ? $("undo") : null;
    if (!button) return;
    event.preventDefault();
    button.click();
  }

  tell() {
    $("undo").disabled = this.step === 0;
    $("redo").disabled = this.step >= this.last;
  }
}
