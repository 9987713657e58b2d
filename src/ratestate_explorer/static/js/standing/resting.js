// Asking for what takes longer than a picture, once what decides it has rested.

const WAIT = 300; // ms

export class Resting {
  /** ask: function (texts); changed: function (), called when what was asked for is no longer what is shown */
  constructor(ask, changed) {
    Object.assign(this, { ask, changed, key: "", wanted: false, timer: 0 });
  }

  /**
   * key: what decides the answer, as text; "" for none
   * texts: what to ask with; null while a newer picture is on its way
   */
  show(key, texts) {
    if (key !== this.key) {
      this.key = key;
      this.wanted = Boolean(key);
      clearTimeout(this.timer);
      this.changed();
    }
    if (!this.wanted || !texts) return;
    this.wanted = false;
    this.timer = setTimeout(() => this.ask(texts), WAIT);
  }

  /** Ask again: the answer may never come. */
  forget() {
    this.key = "";
  }
}
