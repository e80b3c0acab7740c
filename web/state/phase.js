// @ts-check
// The phase of the holes of the driving gear against those of the driven one.

import { number } from "./numbers.js";
import { anglesOf } from "./openings.js";

/** @import { Blank, Schemas } from "./documents.js" */

/** @typedef {Schemas["HolePhase"]} HolePhase */

const BLANK = "/pair/driving/blank";
/** The digits of an angle in degrees. */
const DIGITS = 4;

/** @type {(degrees: number) => number} */
const round = (degrees) => Number(degrees.toFixed(DIGITS));

/**
 * Where the blank of the driving gear stands, in degrees from any place of its own; null where no field says it.
 *
 * @type {(blank: Blank | undefined) => number | null}
 */
export function phaseOf(blank) {
  const [first] = Object.values(anglesOf(blank) ?? {});
  return first === undefined ? null : [first].flat()[0];
}

/**
 * The values that turn the blank of the driving gear under its teeth, by their pointers.
 *
 * @type {(blank: Blank, by: number) => Record<string, number | number[]>}
 */
export const turnedBy = (blank, by) =>
  Object.fromEntries(
    Object.entries(anglesOf(blank) ?? {}).map(([pointer, angle]) => [
      `${BLANK}/${pointer}`,
      Array.isArray(angle) ? angle.map((each) => round(each + by)) : round(angle + by),
    ]),
  );

/**
 * A turn within a hole pitch.
 *
 * @type {(turn: number, pitch: number) => number}
 */
export const within = (turn, pitch) => {
  const rest = round(((turn % pitch) + pitch) % pitch);
  return rest === round(pitch) ? 0 : rest;
};

/** @type {(phase: HolePhase) => number} */
export const pitchOf = ({ over_turn: { turn_of_driving_deg: turns } }) => turns[turns.length - 1];

/**
 * The amplitude at a turn, in um, between the turns that are told.
 *
 * @type {(phase: HolePhase, turn: number) => number}
 */
export function amplitudeAt({ over_turn: { turn_of_driving_deg: turns, amplitude_um: amplitudes } }, turn) {
  const after = Math.max(
    1,
    turns.findIndex((each) => each >= turn),
  );
  const [from, to] = [turns[after - 1], turns[after]];
  const part = (turn - from) / (to - from);
  return amplitudes[after - 1] + part * (amplitudes[after] - amplitudes[after - 1]);
}

/**
 * The best turn and its gain, in words; `turn` is how far the holes are turned since.
 *
 * @type {(phase: HolePhase, turn: number) => string}
 */
export function wordsOf(phase, turn) {
  const pitch = pitchOf(phase);
  const { turn_of_driving_deg: best, other_flanks_turn_deg: other, output_torque_n_m: torque, order } = phase;
  const [left, right] = [-1, 1].map((off) => amplitudeAt(phase, within(best + off, pitch)));
  const [mine, others] = [best, other].map((each) => within(each - turn, pitch));
  return `Order ${order} of the driven gear at ${number(torque)} N m: ${number(phase.amplitude_um, 2)} µm with the driving gear's holes turned by ${number(mine, 3)}° more; 1° off leaves ${number(Math.max(left, right), 2)} µm. For the other flanks the best turn is ${number(others, 3)}°.`;
}
