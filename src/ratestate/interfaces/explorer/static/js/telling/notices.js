// What the page says of itself, above everything else: of the connection, and of what cannot be used.

import { $ } from "../common/dom.js";
import { write } from "../common/words.js";

const PREPARING = "Preparing the solver for such a slider on this machine, up to a minute, once \u2026";

/** Say something until something else is said; "" for nothing. */
export function say(text, isLost = false) {
  $("banner").textContent = text;
  $("banner").hidden = !text;
  $("banner").classList.toggle("lost", isLost);
}

export function sayPreparing() {
  say(PREPARING);
}

/** The connection is lost; seconds until it is tried again. */
export function sayLost(seconds, why) {
  const reason = why ? ` (${why})` : "";
  say(`The connection to ratestate is lost${reason}; trying again in ${seconds} s. Is it still running?`, true);
}

/** What was just clicked is not done, for want of a connection. */
export function sayDropped() {
  say("That was not done, since there is no connection to ratestate; try again when it is back.", true);
}

/** Mark whether what is shown is old; and name what cannot be used, with the values shown in its place. */
export function sayStale(isOld, { wrong, valid }) {
  document.body.classList.toggle("stale", isOld || wrong.length > 0);
  const values = wrong.filter((name) => valid[name]).map((name) => `${name} = ${valid[name]}`);
  write($("stale"), wrong.length ? `Shown: the last valid values${values.length ? ` (${values.join(", ")})` : ""}; correct ${wrong.join(", ")}.` : "");
  $("stale").hidden = !wrong.length;
}
