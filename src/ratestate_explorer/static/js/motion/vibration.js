// One period of a motion as a sound: at which pitch it is played, and its samples.

// Frequencies [Hz] that are played as they are, and the lowest, of an octave, to which others are brought.
const LOWEST = 30;
const HIGHEST = 8000;
const PITCH = 200;
const SHORTEST = 4096; // samples, of whole periods
const LOUDNESS = 0.25; // root mean square, unless the peaks are too high

/** By how many octaves a frequency [Hz] is raised to be heard well; 0 if it is played as it is. */
export function octaves(frequency) {
  if (frequency >= LOWEST && frequency <= HIGHEST) return 0;
  return Math.ceil(Math.log2(PITCH / frequency));
}

/**
 * A sound of whole periods of a motion: {samples, rate}, to be looped at `rate` times as many
 * samples a second as there are, `sampleRate`.
 *
 * time, values: one period, its first point repeated at its end; pitch: frequency to play it at [Hz]
 */
export function soundOf(time, values, pitch, sampleRate) {
  const periods = Math.ceil((SHORTEST * pitch) / sampleRate);
  const count = Math.max(2, Math.round((periods * sampleRate) / pitch));
  return { samples: levelled(means(time, values, periods, count)), rate: (pitch * count) / (periods * sampleRate) };
}

/** Means of a curve over `count` even pieces of so many periods: no peak falls between samples. */
export function means(time, values, periods, count) {
  const integral = new Float64Array(time.length);
  for (let i = 1; i < time.length; i += 1) integral[i] = integral[i - 1] + (time[i] - time[i - 1]) * 0.5 * (values[i] + values[i - 1]);
  const last = time.length - 1;
  const period = time[last] - time[0];
  let i = 0;
  /** The integral up to a part of a period. */
  const upTo = (part) => {
    const t = time[0] + part * period;
    if (t < time[i]) i = 0;
    while (i < last - 1 && time[i + 1] <= t) i += 1;
    const [dt, step] = [t - time[i], time[i + 1] - time[i]];
    const slope = step > 0 ? (values[i + 1] - values[i]) / step : 0;
    return integral[i] + dt * (values[i] + 0.5 * slope * dt);
  };
  const found = new Float64Array(count);
  let before = 0;
  for (let k = 0; k < count; k += 1) {
    const end = ((k + 1) * periods) / count;
    const whole = Math.floor(end);
    const now = whole * integral[last] + upTo(end - whole);
    found[k] = ((now - before) * count) / (periods * period);
    before = now;
  }
  return found;
}

/** Samples about 0, as loud as any others as far as the peaks allow. */
export function levelled(values) {
  const mean = values.reduce((sum, value) => sum + value, 0) / values.length;
  const peak = values.reduce((most, value) => Math.max(most, Math.abs(value - mean)), 0);
  if (!(peak > 0)) return new Float32Array(values.length);
  const size = Math.sqrt(values.reduce((sum, value) => sum + ((value - mean) / peak) ** 2, 0) / values.length);
  const scale = Math.min(1, LOUDNESS / size) / peak;
  return Float32Array.from(values, (value) => (value - mean) * scale);
}
