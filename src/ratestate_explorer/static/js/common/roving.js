// A group of elements that is one stop of the Tab key: arrow keys go on within it.

const WAYS = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 };

export class Roving {
  /** selector: of the elements within the group that take the focus */
  constructor(group, selector) {
    this.all = [...group.querySelectorAll(selector)];
    group.addEventListener("focusin", ({ target }) => this.all.includes(target) && this.stop(target));
    group.addEventListener("keydown", (event) => this.go(event));
  }

  /** Those that are shown. */
  get there() {
    return this.all.filter((one) => !one.closest("[hidden]") && getComputedStyle(one).visibility === "visible");
  }

  /** Stop where one is shown, after that has changed. */
  refresh() {
    const { there } = this;
    this.stop(there.find(({ tabIndex }) => tabIndex === 0) ?? there[0]);
  }

  stop(chosen) {
    for (const one of this.all) one.tabIndex = one === chosen ? 0 : -1;
  }

  go(event) {
    if (!(event.key in WAYS) || !this.all.includes(event.target)) return;
    event.preventDefault();
    const { there } = this;
    there[(there.indexOf(event.target) + WAYS[event.key] + there.length) % there.length].focus();
  }
}
