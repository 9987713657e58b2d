// Taking along what is shown: the link, and files that the server makes.

import { $ } from "../common/dom.js";

export class Sharing {
  /**
   * ready: function (act) that acts once what is typed and what is shown are the same
   * link: function () that gives the link; ask: function (kind of file) that gives the question's id
   * say: function (text); dropped: function (), called when a file will not come
   */
  constructor({ ready, link, ask, say, dropped }) {
    Object.assign(this, { link, say, dropped, asked: new Set() });
    for (const button of document.querySelectorAll("[data-file]")) {
      button.addEventListener("click", () => ready(() => {
        const id = ask(button.id);
        if (id === null) dropped();
        else this.asked.add(id);
      }));
    }
    $("link").addEventListener("click", () => ready(() => this.copy()));
  }

  async copy() {
    const link = this.link();
    try {
      await navigator.clipboard.writeText(link);
      this.say("The link is copied.");
    } catch {
      this.say(`The browser does not allow copying. The link is ${link}`);
    }
  }

  /** Whether a problem is one of a file asked for, which will not come then. */
  concerns({ id }) {
    return this.asked.delete(id);
  }

  /** The connection is lost, and with it the files that were asked for. */
  lose() {
    if (this.asked.size) this.dropped();
    this.asked.clear();
  }

  /** Have the browser save a file that came. */
  save({ id, name, type, content }) {
    this.asked.delete(id);
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([content], { type }));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
  }
}
