// @ts-check
// Results as tables, and the names of files.

import { MEMBERS } from "./design.js";
import { withPoints } from "./points.js";

/** @import { Curve, Results } from "./documents.js" */

/**
 * The name of a file of the design or study that is called `name`: what file systems do not take is left out.
 *
 * @type {(name: string, rest: string) => string}
 */
export function fileOfDesign(name, rest) {
  const plain = name
    .replace(/×/g, "x")
    .replace(/°/g, "deg")
    .replace(/[^\p{Alphabetic}\p{Number}.]+/gu, "-")
    .replace(/^[-.]+|[-.]+$/g, "")
    .slice(0, 80);
  return `meshwright-${plain ? `${plain}-` : ""}${rest}`;
}

/**
 * The names of the lists of `curves` that run over their positions, in the order in which a curve has them.
 *
 * @type {(curves: Curve[]) => string[]}
 */
export function columnsOf(curves) {
  /** @type {(curve: Curve) => string[]} */
  const own = (curve) =>
    Object.entries(curve).flatMap(([name, list]) => {
      const runs = Array.isArray(list) && list.length === curve.mesh_position.length;
      return runs && name !== "load_shares" && name !== "mesh_orders_um" ? [name] : [];
    });
  return [...new Set(curves.flatMap(own))];
}

const PLACES = ["root", "root_tension", "root_compression", "hole"];
const STRESSES = MEMBERS.flatMap((gear) =>
  PLACES.flatMap((place) => ["mpa", "angle_deg", "z_mm"].map((unit) => `stress.${gear}.${place}_${unit}`)),
);

// What may not be seen before the sign that makes a formula, as in the tables of the service: whatever is neither a
// letter or figure (fillers stand for none) nor a sign of ASCII.
const UNSEEN = /^(?:(?![!-~＝＋－＠])[^\p{Alphabetic}\p{Number}]|[\u115f\u1160\u3164\uffa0])+/u;
const FORMULA = /^[=+\-@＝＋－＠]/;

/**
 * Lines of values as CSV; texts with commas in quotes, and none that a spreadsheet takes for a formula.
 *
 * @type {(lines: unknown[][]) => string}
 */
export function csvOf(lines) {
  /** @type {(value: unknown) => string} */
  const cell = (value) => {
    if (typeof value !== "string") return String(value ?? "");
    const safe = FORMULA.test(value.replace(UNSEEN, "")) || /^[\t\r\n]/.test(value) ? `'${value}` : value;
    return /[",\r\n]/.test(safe) ? `"${safe.replace(/"/g, '""')}"` : safe;
  };
  return `${lines.map((line) => line.map(cell).join(",")).join("\r\n")}\r\n`;
}

/** A value of a line of CSV, and what stands behind it. */
const CELL = /("(?:[^"]|"")*"|[^,\r\n]*)(,|\r?\n|$)/g;
const DECIMAL = /^[+-]?\d*\.\d+(e[+-]?\d+)?$/i;

/**
 * A table as CSV with decimal commas, and with semicolons between its values: as spreadsheets read it whose language
 * has decimal commas.
 *
 * @type {(csv: string) => string}
 */
export const withCommas = (csv) =>
  csv.replace(CELL, (_, cell, end) => {
    const value = DECIMAL.test(cell) ? cell.replace(".", ",") : cell;
    return `${!cell.startsWith('"') && cell.includes(";") ? `"${value}"` : value}${end === "," ? ";" : end}`;
  });

/**
 * Every curve of the results as one table: a line for each torque and position, and for each point between them.
 *
 * @type {(results: Results) => string}
 */
export function csv(results) {
  const curves = results.curves.map(withPoints);
  const offsets = [
    ...new Set(curves.flatMap((curve) => curve.load_shares.map(({ pair_offset: offset }) => offset))),
  ].sort((a, b) => a - b);
  /** @type {(curve: Curve, name: string) => unknown[] | undefined} */
  const within = (curve, name) => name.split(".").reduce((/** @type {any} */ value, part) => value?.[part], curve);
  // Heights are told along faces alone.
  const stressed = curves.some(({ stress }) => stress)
    ? STRESSES.filter((name) => !name.endsWith("_z_mm") || curves.some((curve) => within(curve, name)))
    : [];
  const columns = columnsOf(curves);
  /** @type {unknown[][]} */
  const lines = [["output_torque_n_m", ...columns, ...stressed, ...offsets.map((offset) => `load_share.${offset}`)]];
  for (const curve of curves) {
    /** @type {(offset: number) => number[] | undefined} */
    const share = (offset) => curve.load_shares.find((each) => each.pair_offset === offset)?.share;
    curve.mesh_position.forEach((_, i) => {
      lines.push([
        curve.output_torque_n_m,
        ...columns.map((name) => within(curve, name)?.[i]),
        ...stressed.map((name) => within(curve, name)?.[i]),
        ...offsets.map((offset) => share(offset)?.[i] ?? 0),
      ]);
    });
  }
  return csvOf(lines);
}

/**
 * The spectra of the results as one table: a line for each torque and order.
 *
 * @type {(results: Results) => string}
 */
export function ordersCsv(results) {
  const names = /** @type {const} */ ([
    "order",
    "transmission_error_um",
    "transmission_error_phase_deg",
    "mesh_stiffness_tangent_n_per_m",
    "mesh_stiffness_tangent_phase_deg",
  ]);
  /** @type {unknown[][]} */
  const lines = [["output_torque_n_m", ...names, "label"]];
  for (const { output_torque_n_m: torque, spectrum } of results.curves) {
    spectrum?.order.forEach((order, i) => {
      const label = spectrum.named
        .filter((each) => each.order === order)
        .map((each) => each.label)
        .join(" ");
      lines.push([torque, ...names.map((name) => spectrum[name]?.[i]), label]);
    });
  }
  return csvOf(lines);
}
