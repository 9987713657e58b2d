// A file of a laboratory record on its way to the server, which reads it and keeps nothing.

import { decode } from "../common/wire.js";

const LOST = "The file could not be sent. Is ratestate still running?";

export class RecordFile {
  /** progressed: function (fraction) of the file that is sent; null while the server reads it */
  constructor(progressed) {
    Object.assign(this, { progressed, page: "", largest: Infinity, tooLarge: "", request: null });
  }

  /** Take what the server says of pages: the token of this one, and the largest file [bytes]. */
  open({ page, largest_file: largest, too_large: tooLarge }) {
    Object.assign(this, { page, largest, tooLarge });
  }

  /**
   * Have a File read, an earlier one no longer: {problem} or what lab_record.py answers; null if it is
   * given up for a newer one.  choices: {columns, units, time}, as for read_lab
   */
  send(file, choices) {
    this.stop();
    if (file.size > this.largest) return Promise.resolve({ problem: this.tooLarge, columns: [] });
    const request = (this.request = new XMLHttpRequest());
    const query = new URLSearchParams({ page: this.page, name: file.name, choices: JSON.stringify(choices) });
    request.open("POST", `record?${query}`);
    request.responseType = "arraybuffer";
    request.setRequestHeader("Content-Type", "application/octet-stream");
    request.upload.onprogress = ({ loaded, total }) => this.progressed(loaded / total);
    request.upload.onload = () => this.progressed(null);
    return new Promise((done) => {
      request.onload = () => done(answerOf(request));
      request.onerror = () => done({ problem: LOST, columns: [] });
      request.onabort = () => done(null);
      request.send(file);
    });
  }

  /** Give up what is on its way. */
  stop() {
    this.request?.abort();
    this.request = null;
  }
}

/** What came back: of another server, or of one that refuses the page altogether, a problem. */
function answerOf(request) {
  const isOurs = request.getResponseHeader("Content-Type") === "application/octet-stream";
  return isOurs ? { columns: [], ...decode(request.response) } : { problem: LOST, columns: [] };
}
