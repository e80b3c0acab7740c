// @ts-check
// The sensitivity of a design: the designs of one small study, each with one thing changed to one of its limits, and
// bars around the value of the design as it is.

import { isSolid } from "./dimensions.js";

/** @import { AskedStudy, Submission, TableRow } from "./documents.js" */

/** The label of the design as it is, in the study. */
export const AS_IT_IS = "as it is";
const TORQUE = "/output_torques_n_m";
const DISTANCE = "/pair/center_distance_mm";

/**
 * The limits: of the torque in percent, the center distance in mm, the misalignments in um.
 *
 * @typedef {{ torque: number, distance: number, misalignment: number }} Limits
 */

/**
 * A bar: what changes, by how much either way in words, and what the number is then; the reason stands in place of a
 * number that cannot be.
 *
 * @typedef {{ name: string, by: string, low: number | null, high: number | null, wrong: string | null }} Bar
 */

/**
 * A thing that may change: its name, its pointer and the values at both limits.
 *
 * @typedef {{ name: string, pointer: string, values: [low: unknown, high: unknown] }} Influence
 */

/** @type {(value: number) => number} */
const round = (value) => Number(value.toPrecision(9));

/**
 * The things that may change of a submission. Misalignment needs a method along the face.
 *
 * @type {(base: Submission, limits: Limits) => Influence[]}
 */
function influencesOf({ method, pair, output_torques_n_m: [torque] }, { torque: percent, distance, misalignment }) {
  /** @type {(name: string, pointer: string, value: number, by: number) => Influence} */
  const about = (name, pointer, value, by) => ({ name, pointer, values: [round(value - by), round(value + by)] });
  const ofTorque = about("torque", TORQUE, torque, (torque * percent) / 100);
  const { in_plane_um: inPlane = 0, out_of_plane_um: outOfPlane = 0 } = pair.misalignment_um ?? {};
  return [
    .../** @type {Influence[]} */ (
      percent > 0 ? [{ ...ofTorque, values: ofTorque.values.map((value) => [value]) }] : []
    ),
    ...(distance > 0 ? [about("center distance", DISTANCE, pair.center_distance_mm, distance)] : []),
    ...(misalignment > 0 && isSolid(method)
      ? [
          about("misalignment in plane", "/pair/misalignment_um/in_plane_um", inPlane, misalignment),
          about("misalignment out of plane", "/pair/misalignment_um/out_of_plane_um", outOfPlane, misalignment),
        ]
      : []),
  ];
}

/**
 * The study that tells it: of the first torque of `base`.
 *
 * @type {(base: Submission, limits: Limits, name: string) => AskedStudy}
 */
export function studyOf(base, limits, name) {
  const own = { ...base, output_torques_n_m: base.output_torques_n_m.slice(0, 1) };
  const changed = influencesOf(own, limits).flatMap(({ name: changes, pointer, values: [low, high] }) => [
    { label: `${changes} -`, changes: { [pointer]: low } },
    { label: `${changes} +`, changes: { [pointer]: high } },
  ]);
  return { base: own, name, keep: "statistics", designs: [{ label: AS_IT_IS, changes: {} }, ...changed] };
}

/** @type {(row: TableRow) => number | undefined} */
const changeOf = ({ changes }) => [Object.values(changes)[0]].flat().find((value) => typeof value === "number");

/**
 * Half of the distance between the two limits, in words.
 *
 * @type {(name: string, low: TableRow, high: TableRow) => string}
 */
function spanOf(name, low, high) {
  const [one = NaN, other = NaN] = [changeOf(low), changeOf(high)];
  const half = (other - one) / 2;
  if (name === "torque") return `± ${Number(((100 * half) / ((one + other) / 2)).toPrecision(3))} %`;
  return `± ${Number(half.toPrecision(3))} ${name === "center distance" ? "mm" : "µm"}`;
}

/**
 * The bars of the rows of such a study, the longest first, and the value of the design as it is; null while that is not
 * known. `read` gives the number of a row.
 *
 * @type {(rows: TableRow[], read: (row: TableRow) => number | null) => { value: number | null, bars: Bar[] }}
 */
export function barsOf(rows, read) {
  const of = (/** @type {string} */ label) => rows.find((row) => row.label === label);
  /** @type {(row: TableRow | undefined) => number | null} */
  const valueOf = (row) => {
    const value = row?.curves?.length ? read(row) : null;
    return value !== null && Number.isFinite(value) ? value : null;
  };
  const names = rows.flatMap(({ label }) => (label.endsWith(" -") ? [label.slice(0, -2)] : []));
  const value = valueOf(of(AS_IT_IS));
  const bars = names.flatMap((name) => {
    const [low, high] = [of(`${name} -`), of(`${name} +`)];
    if (!low || !high) return [];
    const wrong = [low, high].find(({ problem }) => problem)?.problem?.detail ?? null;
    return [{ name, by: spanOf(name, low, high), low: valueOf(low), high: valueOf(high), wrong }];
  });
  /** @type {(bar: Bar) => number} */
  const reach = ({ low, high }) =>
    Math.max(...[low, high].map((each) => Math.abs((each ?? value ?? 0) - (value ?? 0))));
  return { value, bars: bars.sort((one, other) => reach(other) - reach(one)) };
}

/**
 * Tolerance grade IT7 of ISO 286-1 in um, for sizes up to so many mm.
 */
const IT7 = [
  [3, 10],
  [6, 12],
  [10, 15],
  [18, 18],
  [30, 21],
  [50, 25],
  [80, 30],
  [120, 35],
  [180, 40],
  [250, 46],
  [315, 52],
  [400, 57],
  [500, 63],
];

/**
 * The limit js7 of ISO 286 of a center distance in mm: half of IT7, that of 500 mm for longer ones.
 *
 * @type {(distance: number) => number}
 */
export const js7 = (distance) => (IT7.find(([most]) => distance <= most) ?? IT7[IT7.length - 1])[1] / 2000;
