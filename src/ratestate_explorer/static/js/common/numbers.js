// Numbers as text.

/** A number as typed, perhaps a fraction such as 1/3; NaN of anything else. */
export function factor(text) {
  const [above, below = "1", ...more] = text.split("/").map((part) => part.trim());
  return more.length || !above || !below ? NaN : Number(above) / Number(below);
}

/** 0.00123 to so many digits, without zeros at the end. */
export function round(value, digits = 4) {
  if (value === 0) return "0";
  return String(Number(value.toPrecision(digits)));
}

const NONE = [[0, ""]];
let prefixes = {};

/** Take the server's table: unit -> [[power of ten, prefix], ...]. */
export function learnPrefixes(table) {
  prefixes = table;
}

/** The power of ten and the prefix that bring a value in SI to 1 or more. */
export function prefixOf(value, unit) {
  const all = prefixes[unit] ?? NONE;
  const size = Math.abs(value) * (1 + 1e-9);
  if (!Number.isFinite(size) || size === 0) return all.find(([power]) => power === 0);
  return all.find(([power]) => size >= 10 ** power) ?? all.at(-1);
}

/** A value in SI as the text of a field, which the server reads: "3.2 mm/s". */
export function entry(value, unit, digits = 4) {
  const [power, prefix] = prefixOf(value, unit);
  const text = Number.isFinite(value) ? round(value / 10 ** power, digits) : "inf";
  return unit === "1" ? text : `${text} ${prefix}${unit}`;
}

/** A value in SI to be read: "3.2 \u00b5m/s". */
export function shown(value, unit, digits = 4) {
  return display(entry(value, unit, digits)).replace(/e([+-]?\d+)/, (_, power) => `\u00b7${powerOfTen(Number(power))}`);
}

/** The letter u of a prefix as it is written. */
export function micro(text) {
  return text.replace(/(^| )u(?=m|s|Hz)/, "$1\u00b5");
}

/** A text of a field as it is shown. */
export function display(text) {
  return micro(text).replace("^2", "\u00b2");
}

/** The same as links and files have it, in ASCII: \u00b5, or the Greek letter, is u. */
export function ascii(text) {
  return text.replace(/[\u00b5\u03bc]/g, "u").replaceAll("\u00b2", "^2");
}

/** Digits, and perhaps a minus before them, as an exponent. */
export function superscript(text) {
  return [...text].map((c) => "\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079"[c] ?? "\u207b").join("");
}

/** 10 to a whole power, as "10\u207b\u2076". */
export function powerOfTen(power) {
  return power === 0 ? "1" : power === 1 ? "10" : `10${superscript(String(power))}`;
}

/** A number for a table: plain where it is readable, else as a product with a power of ten. */
export function plain(value, digits = 3) {
  if (!Number.isFinite(value)) return value > 0 ? "\u221e" : "\u2013";
  const size = Math.abs(value);
  if (size === 0 || (size >= 1e-3 && size < 1e5)) return round(value, digits);
  const power = Math.floor(Math.log10(size) + 1e-12);
  return `${round(value / 10 ** power, digits)}\u00b7${powerOfTen(power)}`;
}

const TIMES = [
  [31557600, "years"],
  [86400, "days"],
  [3600, "h"],
  [1, "s"],
  [1e-3, "ms"],
  [1e-6, "\u00b5s"],
];

/** Seconds in, and name of, the unit in which so long a time is read. */
export function timeUnit(seconds) {
  return TIMES.find(([size, name]) => seconds >= (name === "s" || size < 1 ? size : 2 * size)) ?? TIMES.at(-1);
}
