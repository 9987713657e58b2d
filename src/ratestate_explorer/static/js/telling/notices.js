// What the page says of itself, above everything else: of the connection, and of what cannot be used.

import { $ } from "../common/dom.js";
import { write } from "../common/words.js";

const PREPARING = "Compiling the solver for this kind of slider. This happens once and takes up to a minute \u2026";

const DROPPED = "The last click had no effect, because the connection to ratestate was lost. Click again when it is back.";
let said = "";
let isDropped = false;

/** Say something until something else is said; "" for nothing. */
export function say(text, isLost = false) {
  said = text;
  $("banner").classList.toggle("lost", isLost);
  show();
}

/** What was clicked will not be done, for want of a connection: say so until something else is clicked or typed. */
export function sayDropped() {
  isDropped = true;
  show();
}

for (const act of ["pointerdown", "keydown"]) {
  addEventListener(act, () => {
    isDropped = false;
    show();
  });
}

function show() {
  const text = [isDropped ? DROPPED : "", said].filter(Boolean).join(" ");
  $("banner").textContent = text;
  $("banner").hidden = !text;
}

export function sayPreparing() {
  say(PREPARING);
}

/** The connection is lost; seconds until it is tried again. */
export function sayLost(seconds, why) {
  const reason = why ? ` (${why})` : "";
  say(`The connection to ratestate is lost${reason}. Is it still running? The page tries again in ${seconds} s.`, true);
}

/** Mark whether what is shown is old; and name what cannot be used, with the values shown in its place. */
export function sayStale(isOld, { wrong, valid, experiment }) {
  document.body.classList.toggle("stale", isOld || wrong.length > 0);
  const values = wrong.filter((name) => valid[name]).map((name) => `${name} = ${valid[name]}`);
  const without = wrong.filter((name) => experiment.includes(name));
  const shown = [`the last valid values${values.length ? ` (${values.join(", ")})` : ""}`, ...without.map((name) => `no ${name}`)];
  write($("stale"), wrong.length ? `The page shows ${shown.join(", ")}. Correct ${wrong.join(", ")}.` : "");
  $("stale").hidden = !wrong.length;
}
