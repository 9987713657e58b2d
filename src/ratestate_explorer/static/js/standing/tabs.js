// Panels of which one is shown at a time, by tabs; where the page is wide, all of them side by side.

export class Tabs {
  /** list: element with a button per panel, whose aria-controls names it; wide: media query; changed: function () */
  constructor(list, wide, changed) {
    Object.assign(this, { list, changed, wide: matchMedia(wide) });
    this.tabs = [...list.querySelectorAll("[role=tab]")];
    this.chosen = this.tabs[0];
    for (const tab of this.tabs) tab.addEventListener("click", () => this.choose(tab));
    list.addEventListener("keydown", (event) => this.press(event));
    this.wide.addEventListener("change", () => this.lay());
    this.lay();
  }

  panel(tab) {
    return document.getElementById(tab.getAttribute("aria-controls"));
  }

  press(event) {
    const at = this.tabs.indexOf(this.chosen);
    const count = this.tabs.length;
    const next = { ArrowRight: at + 1, ArrowLeft: at + count - 1, Home: 0, End: count - 1 }[event.key];
    if (next === undefined) return;
    event.preventDefault();
    this.choose(this.tabs[next % count]);
    this.chosen.focus();
  }

  choose(tab) {
    this.chosen = tab;
    this.lay();
    this.changed();
  }

  lay() {
    const isWide = this.wide.matches;
    this.list.hidden = isWide;
    for (const tab of this.tabs) {
      const panel = this.panel(tab);
      const isChosen = tab === this.chosen;
      tab.setAttribute("aria-selected", isChosen);
      tab.tabIndex = isChosen ? 0 : -1;
      panel.hidden = !isWide && !isChosen;
      if (isWide) panel.removeAttribute("role");
      else panel.setAttribute("role", "tabpanel");
    }
  }
}
