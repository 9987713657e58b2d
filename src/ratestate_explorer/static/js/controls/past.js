// Undo and redo of what is changed on the page, by steps through the addresses that it has had.

import { $ } from "../common/dom.js";
import { BrowserSteps, OwnSteps } from "./steps.js";

const WAIT = 400; // ms without a change that make one step of all changes before

export class Past {
  /** fragment: function () that gives what the address holds of the present state; null if it holds nothing */
  constructor(fragment) {
    Object.assign(this, { fragment, timer: 0, adds: false });
    this.steps = window === top ? new BrowserSteps() : new OwnSteps();
    $("undo").addEventListener("click", () => this.go(-1));
    $("redo").addEventListener("click", () => this.go(1));
    addEventListener("keydown", (event) => this.key(event));
    addEventListener("pointerdown", () => this.hold(true), true);
    for (const end of ["pointerup", "pointercancel"]) addEventListener(end, () => this.hold(false), true);
    this.tell();
  }

  /** While a pointer is down, as in a drag, nothing rests: one drag is one step. */
  hold(isHeld) {
    this.isHeld = isHeld;
    if (!isHeld && this.waits) this.keep();
  }

  /** What is shown was changed by the user: once it rests, a step that can be undone. */
  add() {
    this.adds = true;
    this.keep();
  }

  /** Write what is shown into the address once it rests. */
  keep() {
    clearTimeout(this.timer);
    this.waits = true;
    if (!this.isHeld) this.timer = setTimeout(() => this.write(), WAIT);
  }

  write() {
    clearTimeout(this.timer);
    this.waits = false;
    if (!this.fragment) return;
    const address = `#${this.fragment()}`;
    if (this.adds && address !== location.hash) this.steps.add(address);
    else this.steps.replace(address);
    this.adds = false;
    this.tell();
  }

  /** Undo (-1) or redo (1) a step; what has not rested yet is one too. */
  go(way) {
    if (this.adds) this.write();
    const there = this.steps.step + way;
    if (there < 0 || there > this.steps.last) return;
    clearTimeout(this.timer); // an address written on the way would hold the browser back
    this.steps.go(way);
  }

  /** The address has changed, but not by `write`: by undo, by redo, or by hand. */
  moved() {
    clearTimeout(this.timer);
    this.waits = false;
    this.adds = false;
    this.steps.moved();
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
    const { step, last } = this.steps;
    $("undo").disabled = step === 0;
    $("redo").disabled = step >= last;
  }
}
