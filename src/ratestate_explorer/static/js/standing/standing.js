// Where the slider stands: on the map of regimes and on the bifurcation diagram, and what the server is asked for them.

import { Bifurcation } from "./bifurcation.js";
import { $ } from "../common/dom.js";
import { StabilityMap } from "./map.js";
import { Resting } from "./resting.js";
import { Tabs } from "./tabs.js";
import { Zoom } from "./zoom.js";

const WIDE = "(min-width: 1900px)"; // as in standing.css

export class Standing {
  /**
   * on: {ask(what, texts, more) that gives the question's id; move(ratio, eta, digits, time stamp);
   * set(parameter, value, time stamp); whenRead(act); pins: Pins}
   */
  constructor(on) {
    const { whenRead } = on;
    this.map = new StabilityMap($("map-canvas"), $("dot"), $("regimes"), on.move, whenRead, on.pins);
    const page = { canvas: $("branch-canvas"), dot: $("branch-dot"), note: $("branch-note"), along: $("along"), measure: $("measure") };
    this.diagram = new Bifurcation(page, { set: on.set, chosen: () => this.rest(), whenRead });
    this.texts = null;
    this.ids = {}; // what was asked for -> id of the newest question
    const ask = (what, more) => (texts) => (this.ids[what] = on.ask(what, texts, more?.()));
    // (what goes wrong with an earlier one is told no more)
    this.atlas = new Resting(ask("chart"), () => {
      this.ids.chart = null;
      this.tellOfMap("");
      this.map.behind(null);
    });
    this.part = new Resting(ask("window", () => ({ window: this.wanted })), () => (this.ids.window = null));
    this.branch = new Resting(ask("branch", () => ({ along: this.diagram.along })), () => {
      this.ids.branch = null;
      this.diagram.age();
    });
    this.zoom = new Zoom(this.map, { closer: $("closer"), wider: $("wider"), whole: $("whole-map") }, () => this.rest());
    new Tabs($("standing-tabs"), WIDE, () => this.rest());
    for (const canvas of [$("map-canvas"), $("branch-canvas")]) new ResizeObserver(() => this.draw()).observe(canvas);
  }

  open({ span, fields }) {
    if (!this.map.view.whole) this.map.view.open(span);
    this.zoom.mark();
    this.diagram.open(fields);
    for (const resting of [this.atlas, this.part, this.branch]) resting.forget();
  }

  show(picture) {
    this.picture = picture;
    this.map.show(picture);
    this.diagram.show(picture);
  }

  draw() {
    this.map.draw();
    this.diagram.draw();
  }

  /** Another picture is asked for: the dots are where it says. */
  release() {
    this.map.target = this.diagram.target = null;
  }

  /** Ask for what rests; texts: those of the picture, or null while a newer one is on its way. */
  rest(texts = this.texts) {
    this.texts = texts;
    if (!this.picture) return;
    this.atlas.show(String(this.picture.chart ?? ""), texts);
    const { at, view } = this.map;
    const isOnMap = at && (!view.isWhole || view.holds(view.whole, at));
    this.wanted = this.map.atlas && isOnMap ? view.wanted(at) : null;
    this.part.show(this.wanted ? `${this.picture.chart} ${this.wanted}` : "", texts);
    if (!$("branch").hidden) this.branch.show(this.diagram.decisive(), texts);
  }

  chart(found) {
    if (String(found.key) !== this.atlas.key) return;
    this.map.behind(found);
    this.rest();
  }

  window(found) {
    if (found.id !== this.ids.window || String(found.key) !== this.atlas.key) return;
    if (!this.map.view.isWhole) this.tellOfMap(""); // what is shown is not coarse
    this.map.refine(found);
  }

  branched(found) {
    if (found.id === this.ids.branch) this.diagram.take(found);
  }

  /** What could not be shown is told beside it, unless something else was asked for since; whether that was about these charts. */
  refuse({ id, problems }) {
    const { chart, window, branch } = this.ids;
    if (problems.map && (id === chart || id === window)) {
      this.tellOfMap(problems.map);
      this.map.missing();
    }
    if (problems.branch && id === branch) this.diagram.tell(problems.branch);
    return Boolean(problems.map || problems.branch);
  }

  /** Beside the map, why it is missing or coarse. */
  tellOfMap(text) {
    $("map-note").textContent = text;
    $("map-note").hidden = !text;
  }
}
