// The page: what is changed goes to the server, what comes back is drawn.

import { Connection } from "./server/connection.js";
import { Controls } from "./controls/controls.js";
import { $ } from "./common/dom.js";
import { Entries } from "./controls/entries.js";
import { Explanations } from "./telling/explain.js";
import { Instant } from "./motion/instant.js";
import { Machine } from "./motion/machine.js";
import { learnPrefixes } from "./common/numbers.js";
import { say, sayDropped, sayLost, sayPreparing, sayStale } from "./telling/notices.js";
import { Phase } from "./curves/phase.js";
import { Pins } from "./curves/pins.js";
import { Playback } from "./motion/playback.js";
import { Questions } from "./server/questions.js";
import { LabRecord } from "./record/record.js";
import { RecordPanel } from "./record/record_panel.js";
import { Recording, disable } from "./server/recording.js";
import { Sharing } from "./server/sharing.js";
import { Sound } from "./motion/sound.js";
import { describe } from "./telling/spoken.js";
import { Standing } from "./standing/standing.js";
import { Tasks } from "./lessons/tasks.js";
import { TaskStrip } from "./lessons/taskstrip.js";
import { onTheme } from "./common/theme.js";
import { begin, drawn } from "./common/timing.js";
import { Traces } from "./curves/traces.js";
import { tell } from "./telling/verdict.js";

const LATE = 500; // ms

let controls = null; // Controls, once the server has said what there is to control
let tasks = null; // Tasks, likewise
let picture = null; // the newest answer drawn
let frame = 0;
let late = 0; // timer of the newest question
let holds = {}; // the newest question for rows of holds, and what is done with them

const instant = new Instant();
const pins = new Pins(redraw);
const record = new LabRecord(() => traces.draw());
const traces = new Traces($("stress-chart"), $("speed-chart"), $("readout"), $("unzoom"), instant, [record, pins], redraw);
const playback = new Playback({ button: $("play"), slider: $("played"), speed: $("playing-speed"), readout: $("pace") }, instant, () => traces.window.shown());
const moving = [playback, new Machine($("machine"), instant, playback)];
const phase = new Phase($("phase-canvas"), $("phase-point"), $("cycle-key"), $("whole"), instant, pins);
const standing = new Standing({
  ask: (...question) => connection.ask(...question),
  move: (ratio, eta, digits, stamp) => controls.move(ratio, eta, digits, picture, stamp),
  set: (name, value, stamp) => controls.set(name, value, stamp),
  whenRead,
  pins,
});
const verdict = { show: (found) => tell(found, { headline: $("headline"), reasons: $("reasons"), notes: $("notes"), numbers: $("numbers") }) };
const marks = { show: (found) => controls.mark(found) };
const sound = new Sound($("sound"), $("volume"), $("heard"));
const views = [verdict, traces, ...moving, phase, standing, sound, marks, { show: describe }, { show: (found) => tasks.show(found) }];
const explanations = new Explanations($("explanation"));
const recordPanel = new RecordPanel(record, () => traces.window.shown(), (conditions) => controls && whenRead(() => controls.experiments.takeConditions(conditions)), () => controls.entries.asked());
const saved = $("recording")?.textContent; // of a page that was saved
if (saved) views.push({ show: disable });
const connection = saved ? new Recording(saved, { answer }) : new Connection({ answer, lost });
const questions = new Questions((texts) => connection.ask("picture", texts), sayDropped);
const sharing = new Sharing({
  ready: take,
  link: () => controls.entries.link(),
  ask: (kind) => connection.ask(kind, controls.entries.texts, { pinned: pins.texts }),
  say,
  dropped: sayDropped,
});
onTheme(redraw);
new ResizeObserver(redraw).observe($("phase-canvas"));

// ---- questions

/** Ask for what the entries say; what is shown is old, and grey, once the answer takes more than LATE. */
function ask(stamp) {
  standing.release();
  clearTimeout(late);
  late = setTimeout(() => document.body.classList.add("stale"), LATE);
  const id = questions.ask(controls.entries.asked());
  if (id === null) {
    document.body.classList.add("stale"); // until there is a connection again
    return;
  }
  document.body.dataset.asked = id;
  begin(id, stamp);
}

/** Show what a task begins with; the id of the picture asked for, null without a connection. */
function beginTask(texts, stamp) {
  controls.begin(texts, stamp);
  return questions.isLost ? null : questions.pending;
}

/** Have the server make the rows of a slide-hold-slide test with such a hold. */
function askHolds(hold, act) {
  holds = { id: connection.ask("slide-hold-slide", controls.entries.asked(), { hold }), act };
}

function whenRead(act) {
  questions.whenRead(act);
}

/** All that was asked for is answered, perhaps by a problem. */
function settle() {
  clearTimeout(late);
  sayStale(!picture || !questions.isNewest(picture), controls.entries);
  questions.settle();
}

// ---- answers

function answer(found) {
  const kinds = {
    hello,
    preparing: sayPreparing,
    ready: () => say(""),
    picture: arrived,
    chart: (of) => standing.chart(of),
    window: (of) => standing.window(of),
    branch: (of) => standing.branched(of),
    file: (of) => sharing.save(of),
    rows: (of) => of.id === holds.id && holds.act(of.rows),
    problem,
  };
  kinds[found.kind](found);
}

function hello(greeting) {
  learnPrefixes(greeting.prefixes);
  explanations.learn(greeting.meanings);
  recordPanel.open(greeting);
  standing.open(greeting);
  if (!controls) build(greeting); // and not again, when a connection has come back
  say("");
  ask();
}

function build({ fields, laws, before, experiment, live, longest, presets }) {
  const names = [...fields.map((field) => field.symbol), "law"];
  const own = Object.fromEntries(fields.map(({ symbol, text }) => [symbol, text]));
  const entries = new Entries(names, experiment, { ...own, ...presets[0].entries }, longest, live);
  controls = new Controls(fields, laws, before, presets, entries, ask, whenRead, askHolds);
  tasks = new Tasks(new TaskStrip($("tasks"), $("tasks-open"), $("task-line")), fields, presets, beginTask);
  for (const pin of connection.pinned ?? []) pins.add(pin.picture, pin.texts);
}

function arrived(found) {
  if (picture && found.id < picture.id) return;
  picture = found;
  frame ||= requestAnimationFrame(draw);
}

function problem(found) {
  const { id, problems, values, protocol } = found;
  if (id !== null && id === holds.id) {
    for (const [name, why] of Object.entries(problems)) controls.explain(name, why);
    return;
  }
  const isNewest = questions.isNewest(found);
  if (isNewest && "protocol" in problems) controls.learnRows(protocol);
  if (isNewest && controls.entries.refuse(problems)) {
    controls.explainAll();
    ask(); // for what can be used
    return;
  }
  if (!standing.refuse(found) && (id === null || isNewest || sharing.concerns(found))) say(Object.values(problems).join("; "));
  if (!isNewest) return;
  if (values) controls.accept({ values });
  settle();
}

function lost(seconds, why) {
  sayLost(seconds, why);
  questions.lose();
  sharing.lose();
}

// ---- drawing

function draw() {
  frame = 0;
  const isNewest = questions.isNewest(picture);
  if (isNewest) {
    say("");
    controls.accept(picture);
  }
  pins.show(picture, questions.textsOf(picture));
  for (const view of views) view.show(picture);
  document.body.dataset.drawn = picture.id;
  drawn(picture.id);
  // With the texts of the picture: what is typed later may be unusable.
  standing.rest(isNewest ? controls.entries.asked() : null);
  if (isNewest) settle();
}

function redraw() {
  traces.draw();
  if (picture) for (const view of moving) view.show(picture);
  phase.draw();
  standing.draw();
}

// ---- taking it along

/** Take something along, unless what is typed and what is shown are not the same. */
function take(act) {
  if (!controls) return;
  whenRead(() => {
    const { wrong } = controls.entries;
    if (wrong.length) say(`Nothing was saved. Correct ${wrong.join(", ")} first.`);
    else act();
  });
}
