// Which column of a file is which quantity, and in which unit; and which times are read.

import { $, element } from "../common/dom.js";

export class RecordChoices {
  /** chosen: function, called when what is chosen shall be read */
  constructor(chosen) {
    this.rows = {}; // symbol -> {column: select, unit: input}
    $("record-form").addEventListener("submit", (event) => {
      event.preventDefault();
      chosen();
    });
  }

  /** Offer the columns of a file as the server found them; what was chosen by hand stays. */
  offer({ columns, chosen, quantities }) {
    $("record-choices").hidden = !columns.length;
    if (!columns.length) return;
    for (const { symbol, name, unit } of quantities) {
      const row = (this.rows[symbol] ??= rowOf(symbol, name));
      const { value } = row.column;
      const found = columns[chosen[symbol] - 1];
      const titles = columns.map(([title], i) => new Option(title, i + 1));
      row.column.replaceChildren(new Option(found && !value ? `found: ${found[0]}` : "by its name", ""), ...titles);
      row.column.value = value;
      row.unit.placeholder = found?.[1] || unit;
    }
  }

  /** Open them: something must be chosen. */
  show() {
    $("record-choices").open = true;
    $("record-choices").scrollIntoView({ block: "nearest" });
  }

  /** What is chosen, as the server reads it. */
  get choices() {
    const rows = Object.entries(this.rows);
    const given = (part, read) => Object.fromEntries(rows.filter(([, row]) => row[part].value).map(([symbol, row]) => [symbol, read(row[part].value.trim())]));
    const time = ["record-from", "record-to"].map((id) => $(id).value.trim() || null);
    const found = { columns: given("column", Number), units: given("unit", String) };
    return time.some(Boolean) ? { ...found, time } : found;
  }

  /** Choose nothing: another file is another table. */
  clear() {
    this.rows = {};
    $("record-columns").replaceChildren();
    for (const id of ["record-from", "record-to"]) $(id).value = "";
    $("record-choices").open = false;
  }
}

function rowOf(symbol, name) {
  const column = element("select", { id: `record-column-${symbol}`, ariaLabel: `column of ${name}` });
  const unit = element("input", { type: "text", id: `record-unit-${symbol}`, ariaLabel: `unit of ${name}` });
  $("record-columns").append(element("div", { className: "choice" }, element("span", {}, name), column, unit));
  return { column, unit };
}
