// Files that the browser keeps: texts from the server, and a picture of the charts.

import { FONT, color } from "./theme.js";

const TYPES = { toml: "application/toml", py: "text/x-python", csv: "text/csv" };
const GAP = 16;

/** Have the browser save something under a name. */
export function save(name, blob) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}

export function saveText(name, text) {
  save(name, new Blob([text], { type: TYPES[name.split(".").at(-1)] ?? "text/plain" }));
}

/** All charts in one PNG, with the verdict above and the parameters below. */
export async function savePicture(charts, headline, parameters) {
  const ratio = devicePixelRatio || 1;
  const [left, right] = charts;
  const width = (column) => Math.max(...column.map((canvas) => canvas.width));
  const height = (column) => column.reduce((sum, canvas) => sum + canvas.height + GAP * ratio, 0);
  const top = 46 * ratio;
  const bottom = 30 * ratio;
  const sheet = document.createElement("canvas");
  sheet.width = width(left) + width(right) + 3 * GAP * ratio;
  sheet.height = Math.max(height(left), height(right)) + top + bottom;
  const c = sheet.getContext("2d");
  c.fillStyle = color("card");
  c.fillRect(0, 0, sheet.width, sheet.height);
  c.fillStyle = color("text");
  c.font = `600 ${15 * ratio}px ${FONT}`;
  c.fillText(headline, GAP * ratio, 28 * ratio, sheet.width - 2 * GAP * ratio);
  c.font = `${12 * ratio}px ${FONT}`;
  c.fillStyle = color("muted");
  c.fillText(parameters, GAP * ratio, sheet.height - 12 * ratio, sheet.width - 2 * GAP * ratio);
  let x = GAP * ratio;
  for (const column of charts) {
    let y = top;
    for (const canvas of column) {
      c.drawImage(canvas, x, y);
      y += canvas.height + GAP * ratio;
    }
    x += width(column) + GAP * ratio;
  }
  save("ratestate.png", await new Promise((done) => sheet.toBlob(done, "image/png")));
}
