// The WebSocket: it comes back by itself, waiting longer each time that it does not last.

import { decode } from "../common/wire.js";

const FIRST_WAIT = 500; // ms
const LONGEST_WAIT = 8000;
const LASTING = 10_000; // ms for which a connection must have been there, to begin with the first wait again

export class Connection {
  /** on: {answer(object), lost(seconds until the next try, why)} */
  constructor(on) {
    this.on = on;
    this.count = 0;
    this.wait = FIRST_WAIT;
    this.connect();
  }

  connect() {
    const socket = new WebSocket(`ws://${location.host}/socket`);
    this.socket = socket;
    socket.binaryType = "arraybuffer";
    let opened = Infinity;
    socket.onopen = () => (opened = performance.now());
    socket.onmessage = (event) => this.on.answer(decode(event.data));
    socket.onclose = (event) => {
      if (performance.now() - opened > LASTING) this.wait = FIRST_WAIT;
      this.on.lost(this.wait / 1000, event.reason);
      setTimeout(() => this.connect(), this.wait);
      this.wait = Math.min(2 * this.wait, LONGEST_WAIT);
    };
  }

  /** Ask, perhaps with more than entries; gives the question's id, or null while there is no connection. */
  ask(what, entries, more = {}) {
    if (this.socket.readyState !== WebSocket.OPEN) return null;
    this.count += 1;
    this.socket.send(JSON.stringify({ id: this.count, ask: what, entries, ...more }));
    return this.count;
  }
}
