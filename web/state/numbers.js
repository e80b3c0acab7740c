// @ts-check
// Numbers, units and times as readers want them.

/**
 * A number with so many significant digits, without trailing zeros.
 *
 * @type {(value: unknown, digits?: number) => string}
 */
export function number(value, digits = 4) {
  if (typeof value !== "number" || !Number.isFinite(value)) return "–";
  return String(Number(value.toPrecision(digits)));
}

/**
 * A number with so many decimals.
 *
 * @type {(value: unknown, decimals: number) => string}
 */
export function fixed(value, decimals) {
  return typeof value === "number" && Number.isFinite(value) ? value.toFixed(decimals) : "–";
}

/**
 * A number with so many significant digits, zeros at its end among them, and none that stands for a power of ten.
 *
 * @type {(value: number, digits: number) => string}
 */
export const significant = (value, digits) =>
  fixed(value, Math.min(6, Math.max(0, digits - 1 - Math.floor(Math.log10(Math.abs(value) || 1)))));

/**
 * The least and the most of any number of values; those that are no numbers are left out. Null where none is left.
 *
 * @param {Iterable<number | null | undefined>} values
 * @returns {[number, number] | null}
 */
export function extent(values) {
  /** @type {[number, number] | null} */
  let found = null;
  for (const value of values) {
    if (typeof value !== "number" || !Number.isFinite(value)) continue;
    if (!found) found = [value, value];
    else if (value < found[0]) found[0] = value;
    else if (value > found[1]) found[1] = value;
  }
  return found;
}

/** @type {Record<string, string>} */
const UNITS = {
  1: "",
  um: "µm",
  deg: "°",
  "N m": "N m",
  "1/min": "rpm",
  "kg/m3": "kg/m³",
  "kg m^2": "kg m²",
  "%": "%",
};

/**
 * A unit of the schema as it is printed.
 *
 * @type {(name: string | undefined) => string}
 */
export function unit(name) {
  return name === undefined ? "" : (UNITS[name] ?? name);
}

/**
 * A time in milliseconds as somebody who waits wants it.
 *
 * @type {(milliseconds: number) => string}
 */
export function timeOf(milliseconds) {
  if (milliseconds < 90_000) return `${Math.max(1, Math.round(milliseconds / 1000))} s`;
  return milliseconds < 5_400_000
    ? `${Math.round(milliseconds / 60_000)} min`
    : `${fixed(milliseconds / 3_600_000, 1)} h`;
}

/** From one time that is told to the next, it rises to so many times at most. */
const MOST_LEAP = 2;

/**
 * Says how long the rest takes, in words that go on from others, of how much is done of a total; `expected`
 * milliseconds were thought to be needed before anything was known. The pace is that of the last tenth that has been
 * done: what is made once, as a gear is for all of its positions, says nothing of what follows.
 *
 * @type {(expected?: number | null, now?: () => number) => (done: number, total: number) => string}
 */
export function remaining(expected = null, now = () => performance.now()) {
  const begun = now();
  const seen = [{ at: begun, done: 0 }];
  /** @type {number | null} */
  let said = null;
  return (done, total) => {
    const at = now();
    const elapsed = at - begun;
    const from = seen.findLast((each) => done - each.done >= Math.max(3, done / 10)) ?? seen[0];
    seen.push({ at, done });
    if (done >= total) return "";
    const linear = done > from.done ? ((at - from.at) * (total - done)) / (done - from.done) : null;
    if (expected === null) {
      if (done <= 2 || linear === null) return "";
      said = said === null ? linear : Math.min(linear, MOST_LEAP * said);
      return `, about ${timeOf(said)} more`;
    }
    // What was thought counts until as much has been done, or as much time has passed.
    const known = linear === null ? 0 : Math.min(1, Math.max(done / total, elapsed / expected));
    const found = known * (linear ?? 0) + (1 - known) * (expected - elapsed);
    // What takes longer than all before it is told in steps.
    const left = said === null ? found : Math.min(found, MOST_LEAP * said);
    if (left > 0) said = left;
    return left > 0 ? `, about ${timeOf(left)} more` : ", longer than was thought";
  };
}
