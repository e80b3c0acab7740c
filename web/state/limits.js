// @ts-check
// The sizes of a pair that decide its backlash, and their limits; the load by the torque of either gear, or by power.

import { MEMBERS } from "./design.js";

/** @import { Pair } from "./documents.js" */

/**
 * A size between two limits: its pointer, what it is called, its unit, its value in the pair, and whether the backlash
 * grows with it.
 *
 * @typedef {{ pointer: string, title: string, unit: string, value: number, grows: boolean }} Size
 */

/** @typedef {"least" | "nominal" | "most"} Which */

/** Measures of the thickness by their places in a gear, of which a gear has one. */
const THICKNESS = [
  ["span_measurement/length_mm", "W_k", "mm"],
  ["ball_measurement/over_balls_mm", "M_dK", "mm"],
  ["tooth_thickness_deviation_um", "A_st", "µm"],
  ["tooth_thickness_deviation_normal_um", "A_sn", "µm"],
];

/** @type {(object: any, path: string) => any} */
const at = (object, path) => path.split("/").reduce((part, name) => part?.[name], object);

/**
 * The sizes that decide the backlash: the center distance, and the thickness of each gear by the measure that it has,
 * or by the normal deviation.
 *
 * @type {(pair: Pair) => Size[]}
 */
export function sizesOf(pair) {
  const thicknesses = MEMBERS.map((gear) => {
    const [path, name, unit] =
      THICKNESS.find(([each]) => typeof at(pair[gear], each) === "number") ?? THICKNESS[THICKNESS.length - 1];
    const value = at(pair[gear], path) ?? 0;
    return { pointer: `/pair/${gear}/${path}`, title: `${name}, ${gear} gear`, unit, value, grows: false };
  });
  const { center_distance_mm: value } = pair;
  return [
    { pointer: "/pair/center_distance_mm", title: "Center distance", unit: "mm", value, grows: true },
    ...thicknesses,
  ];
}

/**
 * The values of sizes at their least or most backlash, by their pointers: `nominal` has their values between, and
 * `off` how far the lower and the upper limit are from these.
 *
 * @type {(sizes: Size[], nominal: number[], off: [lower: number, upper: number][], which: Which) =>
 *   Record<string, number>}
 */
export const valuesAt = (sizes, nominal, off, which) =>
  Object.fromEntries(
    sizes.flatMap(({ pointer, grows }, i) => {
      const [lower, upper] = off[i];
      if (!lower && !upper) return [];
      const by = which === "nominal" ? 0 : (which === "most") === grows ? upper : lower;
      return [[pointer, Number((nominal[i] + by).toFixed(6))]];
    }),
  );

/** The number of rad/s in 1/min. */
const RPM = (2 * Math.PI) / 60;

/**
 * The output torque of a torque on the driving gear in N m, without losses.
 *
 * @type {(driving: number, pair: Pair) => number}
 */
export const outputOf = (driving, { driving: { tooth_count: z1 }, driven: { tooth_count: z2 } }) =>
  Number(((driving * z2) / z1).toPrecision(9));

/**
 * The torque on the driving gear of an output torque in N m.
 *
 * @type {(output: number, pair: Pair) => number}
 */
export const drivingOf = (output, { driving: { tooth_count: z1 }, driven: { tooth_count: z2 } }) =>
  Number(((output * z1) / z2).toPrecision(9));

/**
 * The torque in N m of a power in kW at a speed in 1/min.
 *
 * @type {(power: number, speed: number) => number}
 */
export const torqueOf = (power, speed) => (1000 * power) / (speed * RPM);

/**
 * The power in kW of a torque in N m at a speed in 1/min.
 *
 * @type {(torque: number, speed: number) => number}
 */
export const powerOf = (torque, speed) => (torque * speed * RPM) / 1000;
