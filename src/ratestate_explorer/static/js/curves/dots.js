// Dots on the lines of a plot, where the instant's line crosses them.

import { element } from "../common/dom.js";

export class Dots {
  /** roles: colours of the lines, as classes of the style sheet */
  constructor(plot, roles) {
    this.plot = plot;
    this.dots = roles.map((role) => element("span", { className: `dot ${role}`, hidden: true }));
    plot.over.append(...this.dots);
  }

  /** Put the dots at these values of the axes, or away where there are none or they are not shown. */
  put(time, values) {
    const x = values && this.plot.valToPos(time, "x");
    const isShown = values && x >= 0 && x <= this.plot.over.clientWidth;
    this.dots.forEach((dot, i) => {
      dot.hidden = !isShown;
      if (isShown) dot.style.transform = `translate(${x}px, ${this.plot.valToPos(values[i], "y")}px)`;
    });
  }
}
