// Answers of the server as objects; wire.py says how they are laid out.

const decoder = new TextDecoder();

/** {id, kind, ..., arrays: {name: Float64Array}, content: Uint8Array of a file} */
export function decode(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const header = JSON.parse(decoder.decode(new Uint8Array(buffer, 4, length)));
  let at = 4 + length;
  const arrays = {};
  for (const [name, size] of header.arrays) {
    arrays[name] = new Float64Array(buffer, at, size);
    at += 8 * size;
  }
  return { ...header, arrays, content: new Uint8Array(buffer, at) };
}

/** A number of a header, where "Infinity", "-Infinity" and "NaN" stand for what JSON cannot hold. */
export function number(value) {
  return typeof value === "string" ? Number(value) : value;
}
