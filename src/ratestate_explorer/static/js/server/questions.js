// Which picture was asked for last, whether it is here, and what waits for it.

export class Questions {
  /**
   * send: function (texts) that asks for a picture and gives the question's id, null without a connection
   * dropped: function (), called when what waits will not be done
   */
  constructor(send, dropped) {
    Object.assign(this, { send, dropped, pending: 0, read: 0, waiting: [], asked: new Map() });
  }

  /** Ask for a picture; its id, or null. */
  ask(texts) {
    const id = this.send(texts);
    this.pending = id ?? Infinity;
    if (id !== null) this.asked.set(id, texts);
    return id;
  }

  /** The texts that a picture was asked for with. */
  textsOf({ id }) {
    for (const earlier of this.asked.keys()) if (earlier < id) this.asked.delete(earlier);
    return this.asked.get(id);
  }

  /** Whether the newest question could not be asked, or will not be answered, for want of a connection. */
  get isLost() {
    return this.pending === Infinity;
  }

  /** Whether an answer is the one to the newest question. */
  isNewest({ id }) {
    return id === this.pending;
  }

  /** Act once what was typed is read, so that it is reckoned from that. */
  whenRead(act) {
    if (this.read === this.pending) act();
    else if (this.isLost) this.dropped();
    else this.waiting.push(act);
  }

  /** The newest question is answered, perhaps by a problem. */
  settle() {
    this.read = this.pending;
    for (const act of this.waiting.splice(0)) this.whenRead(act);
  }

  /** The connection is lost, and with it the answer to the newest question, if that is not here. */
  lose() {
    if (this.read === this.pending) return;
    this.pending = Infinity;
    if (this.waiting.splice(0).length) this.dropped();
  }
}
