// The page: what is changed goes to the server, what comes back is drawn.

import { Connection } from "./connection.js";
import { Controls } from "./controls.js";
import { $ } from "./dom.js";
import { savePicture, saveText } from "./downloads.js";
import { Entries } from "./entries.js";
import { StabilityMap } from "./map.js";
import { learnPrefixes } from "./numbers.js";
import { Phase } from "./phase.js";
import { describe } from "./spoken.js";
import { onTheme } from "./theme.js";
import { begin, drawn } from "./timing.js";
import { Traces } from "./traces.js";
import { tell } from "./verdict.js";
import { number } from "./wire.js";
import { write } from "./words.js";

const CHART_WAIT = 300; // ms for which law and b/a must rest before their atlas is asked for

let controls = null; // Controls, once the server has said what there is to control
let picture = null; // the newest answer drawn
let pending = 0; // id of the newest picture asked for
let frame = 0;
let chartTimer = 0;
let chartKey = ""; // of the atlas behind the map, as the server names it
let chartWanted = false;
let read = 0; // id of the newest picture asked for that was answered
let waiting = []; // what is done once that is the newest
const files = new Set(); // ids of the downloads asked for

const traces = new Traces($("stress-chart"), $("speed-chart"), $("readout"));
const phase = new Phase($("phase-canvas"));
const map = new StabilityMap($("map-canvas"), $("dot"), $("regimes"), (ratio, eta, stamp) => controls.move(ratio, eta, picture, stamp), (act) => (map.target ? act() : whenRead(act)));
const connection = new Connection({ answer, lost });
onTheme(redraw);
new ResizeObserver(redraw).observe($("map-canvas"));
listen();

function listen() {
  for (const button of document.querySelectorAll("[data-file]")) {
    button.addEventListener("click", () => take(() => files.add(connection.ask(button.id, controls.entries.texts))));
  }
  $("link").addEventListener("click", () => take(copyLink));
  $("png").addEventListener("click", () => take(png));
  $("whole").addEventListener("change", (event) => {
    phase.whole = event.target.checked;
    phase.draw();
  });
}

// ---- questions

function ask(stamp) {
  map.target = null;
  const id = connection.ask("picture", controls.entries.asked());
  pending = id ?? Infinity;
  if (id === null) {
    document.body.classList.add("stale"); // until there is a connection again
    return;
  }
  document.body.dataset.asked = id;
  begin(id, stamp);
}

/** Act once what was typed is read, so that it is reckoned from that. */
function whenRead(act) {
  if (read === pending) act();
  else waiting.push(act);
}

/** All that was asked for is answered, perhaps by a problem. */
function settle() {
  read = pending;
  const { wrong, valid } = controls.entries;
  document.body.classList.toggle("stale", picture?.id !== pending || wrong.length > 0);
  const values = wrong.filter((name) => valid[name]).map((name) => `${name} = ${valid[name]}`);
  write($("stale"), wrong.length ? `Shown: the last valid values${values.length ? ` (${values.join(", ")})` : ""}; correct ${wrong.join(", ")}.` : "");
  $("stale").hidden = !wrong.length;
  for (const act of waiting.splice(0)) whenRead(act);
}

function askChart() {
  const key = picture.chart && String(picture.chart);
  if (key !== chartKey) {
    chartKey = key;
    chartWanted = Boolean(key);
    clearTimeout(chartTimer);
    sayOfMap("");
    map.behind(null);
  }
  if (!chartWanted || picture.id !== pending) return;
  chartWanted = false;
  const texts = controls.entries.asked(); // those of the picture: they may be unusable later
  chartTimer = setTimeout(() => connection.ask("chart", texts), CHART_WAIT);
}

// ---- answers

function answer(found) {
  ({ hello, preparing, ready: () => say(""), picture: arrived, chart, file, problem })[found.kind](found);
}

function hello({ fields, laws, before, longest, prefixes, presets, span }) {
  learnPrefixes(prefixes);
  map.open(span);
  const names = [...fields.map((field) => field.symbol), "law"];
  const own = Object.fromEntries(fields.map(({ symbol, text }) => [symbol, text]));
  const entries = new Entries(names, ["friction", ...Object.keys(before)], { ...own, ...presets[0].entries }, longest);
  controls ??= new Controls(fields, laws, before, presets, entries, ask, whenRead);
  waiting = [];
  say("");
  chartKey = "";
  ask();
}

function preparing() {
  say("Preparing the solver for such a slider on this machine, up to a minute, once \u2026");
}

function arrived(found) {
  if (picture && found.id < picture.id) return;
  picture = found;
  frame ||= requestAnimationFrame(draw);
}

function chart(found) {
  if (String(found.key) === chartKey) map.behind(found);
}

function file({ name, text }) {
  saveText(name, text);
}

function problem({ id, problems, values }) {
  if (id === pending && controls.entries.refuse(problems)) {
    controls.explainAll();
    ask(); // for what can be used
    return;
  }
  if (problems.map) {
    sayOfMap(problems.map);
    map.missing();
  } else if (id === null || id === pending || files.has(id)) say(Object.values(problems).join("; "));
  if (id !== pending) return;
  if (values) controls.accept(values);
  settle();
}

/** Beside the map, why it is missing or coarse. */
function sayOfMap(text) {
  $("map-note").textContent = text;
  $("map-note").hidden = !text;
}

function lost(seconds, why) {
  waiting = [];
  const reason = why ? ` (${why})` : "";
  say(`The connection to ratestate is lost${reason}; trying again in ${seconds} s. Is it still running?`, true);
}

function say(text, isLost = false) {
  $("banner").textContent = text;
  $("banner").hidden = !text;
  $("banner").classList.toggle("lost", isLost);
}

// ---- drawing

function draw() {
  frame = 0;
  const { values, numbers, arrays, id } = picture;
  if (id === pending) {
    say("");
    controls.accept(values);
  }
  tell(picture, { headline: $("headline"), reasons: $("reasons"), notes: $("notes"), numbers: $("numbers") });
  traces.draw(picture);
  phase.draw(picture);
  $("cycle-key").style.visibility = picture.arrays.cycle_V ? "visible" : "hidden";
  map.draw(numbers.K_c_qs > 0 ? { ratio: number(values.K) / numbers.K_c_qs, eta: number(numbers.eta) } : null, arrays);
  describe(picture);
  document.body.dataset.drawn = id;
  drawn(id);
  askChart();
  if (id === pending) settle();
}

function redraw() {
  phase.draw();
  map.draw();
}

// ---- taking it along

/** Take something along, unless what is typed and what is shown are not the same. */
function take(act) {
  if (!controls) return;
  whenRead(() => {
    const { wrong } = controls.entries;
    if (wrong.length) say(`Nothing was taken along: correct ${wrong.join(", ")} first.`);
    else act();
  });
}

async function copyLink() {
  const link = controls.entries.link();
  try {
    await navigator.clipboard.writeText(link);
    say("The link is copied.");
  } catch {
    say(`The browser does not let it be copied; here it is: ${link}`);
  }
}

function png() {
  if (!picture) return;
  const shown = Object.entries(controls.entries.texts).map(([name, text]) => `${name} = ${text}`).join(",  ");
  const columns = [[traces.stress.ctx.canvas, traces.speed.ctx.canvas], [$("map-canvas"), $("phase-canvas")]];
  savePicture(columns, $("headline").textContent, shown);
}
