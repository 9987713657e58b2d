// Labels on canvases: symbols in italics, with subscripts.

import { FONT } from "./theme.js";

const SERIF = '"STIX Two Text", "Noto Serif", "DejaVu Serif", Georgia, serif';
const FONTS = { "": `12px ${FONT}`, i: `italic 13px ${SERIF}`, sub: `9px ${FONT}` };
const LOWER = { sub: 3 };

/** Write [[kind, text], ...] about a point of the baseline; kind is "", "i" or "sub". */
export function writeLabel(context, parts, x, y) {
  const widths = parts.map(([kind, text]) => {
    context.font = FONTS[kind];
    return context.measureText(text).width;
  });
  context.textAlign = "left";
  context.textBaseline = "alphabetic";
  let at = x - widths.reduce((sum, width) => sum + width, 0) / 2;
  parts.forEach(([kind, text], i) => {
    context.font = FONTS[kind];
    context.fillText(text, at, y + (LOWER[kind] ?? 0));
    at += widths[i];
  });
}
