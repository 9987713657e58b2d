// What the page says of itself, above everything else: of the connection, and of what cannot be used.

import { $ } from "../common/dom.js";
import { write } from "../common/words.js";

const PREPARING = "Preparing the solver for such a slider on this machine, up to a minute, once \u2026";

const DROPPED = "What was clicked last was not done, since the connection to ratestate was lost; click again when it is back.";
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
  say(`The connection to ratestate is lost${reason}; trying again in ${seconds} s. Is it still running?`, true);
}

/** Mark whether what is shown is old; and name what cannot be used, with the values shown in its place. */
export function sayStale(isOld, { wrong, valid, experiment }) {
  document.body.classList.toggle("stale", isOld || wrong.length > 0);
  const values = wrong.filter((name) => valid[name]).map((name) => `${name} = ${valid[name]}`);
  const without = wrong.filter((name) => experiment.includes(name));
  const shown = [`the last valid values${values.length ? ` (${values.join(", ")})` : ""}`, ...without.map((name) => `no ${name}`)];
  write($("stale"), wrong.length ? `Shown: ${shown.join(", ")}; correct ${wrong.join(", ")}.` : "");
  $("stale").hidden = !wrong.length;
}
