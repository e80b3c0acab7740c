// @ts-check
// The load along the face: as a map over mesh position and z, as a curve where only its mean is known, in words, and as
// a scale of colors.

import { h } from "./dom.js";
import { extent, fixed, number } from "../state/numbers.js";
import { spanOf } from "../state/series.js";

/** @import { Curve, Face, LeadModification } from "../state/documents.js" */

/** @typedef {NonNullable<ReturnType<typeof faceOf>>} FaceLoad */

/** @typedef {{ x: number, width: number, z: number, height: number, part: number }} FaceCell */

/** Colors from little to much: their lightness alone tells them apart, so that every eye and gray paper do. */
export const RAMP = ["#0d1b4c", "#28437f", "#5b6b8a", "#8f8f7f", "#c9b458", "#fff08a"];

const rgb = RAMP.map((color) => [1, 3, 5].map((i) => parseInt(color.slice(i, i + 2), 16)));

/**
 * The color of a part of the most, as three numbers up to 255.
 *
 * @type {(part: number) => number[]}
 */
export function rampAt(part) {
  const place = Math.min(Math.max(part, 0), 1) * (RAMP.length - 1);
  const i = Math.min(Math.floor(place), RAMP.length - 2);
  return rgb[i].map((value, k) => Math.round(value + (place - i) * (rgb[i + 1][k] - value)));
}

/** @type {(part: number) => string} */
export const cssOf = (part) => `rgb(${rampAt(part).join(" ")})`;

/** The colors from nothing to the most, for a scale. */
export const SCALE = Array.from({ length: 24 }, (_, i) => cssOf(i / 23));

/**
 * The edges of the strips whose middles are `z`.
 *
 * @type {(z: number[]) => number[]}
 */
function edgesOf(z) {
  const step = z.length > 1 ? z[1] - z[0] : 1;
  return [...z.map((middle) => middle - step / 2), z[z.length - 1] + step / 2];
}

/**
 * The load of a curve over its face; null where its method does not see faces. `rows` has a row for each position, or
 * one, their mean.
 *
 * @param {Pick<Curve, "face" | "mesh_position">} curve
 */
export function faceOf({ face, mesh_position: positions, ...curve }) {
  if (!face) return null;
  const { z_mm: z, load_n_per_mm: rows } = face;
  const most = Math.max(extent(rows.flat())?.[1] ?? 0, 1e-9);
  return {
    z,
    rows,
    most,
    edges: edgesOf(z),
    every: rows.length === positions.length && rows.length > 1,
    positions,
    span: spanOf({ mesh_position: positions, ...curve }),
    factor: face.face_load_factor,
    centroid: face.load_centroid_mm,
    cure: face.cure ?? null,
  };
}

/**
 * The rectangles of the map between two mesh positions, each at least so wide: `{ x, width, z, height, part }`. One
 * that several positions share tells the most of each z, so that no peak is lost.
 *
 * @type {(face: Pick<FaceLoad, "rows" | "positions" | "edges" | "most" | "span">, range: number[], least?: number) =>
 *   FaceCell[]}
 */
export function cellsOf({ rows, positions, edges, most, span }, [from, to], least = 0) {
  const step = span / positions.length;
  const taken = Math.max(1, Math.ceil(least / step));
  /** @type {FaceCell[]} */
  const cells = [];
  // A position stands for what is nearest to it; the first one for the end of the span too.
  for (let i = 0; i <= positions.length; i += taken) {
    const middle = positions[0] + i * step;
    const [x, end] = [Math.max(middle - step / 2, from), Math.min(middle + (taken - 0.5) * step, to)];
    if (end <= x) continue;
    const shared = Array.from({ length: taken }, (_, k) => rows[(i + k) % positions.length]);
    shared[0]
      .map((_, j) => Math.max(...shared.map((row) => row[j])))
      .forEach((load, j) =>
        cells.push({ x, width: end - x, z: edges[j], height: edges[j + 1] - edges[j], part: load / most }),
      );
  }
  return cells;
}

/**
 * What a listener should know of the load along the face.
 *
 * @type {(face: FaceLoad) => string}
 */
export function wordsOfFace({ z, rows, positions, most, every, factor, centroid, edges }) {
  const mean = z.map((_, j) => rows.reduce((sum, row) => sum + row[j], 0) / rows.length);
  const [least, heaviest] = extent(mean) ?? [0, 0];
  /** @type {(value: number) => string} */
  const where = (value) => `z = ${number(z[mean.indexOf(value)], 3)} mm`;
  const peak = rows.map((row) => Math.max(...row));
  const at = every
    ? ` The largest of all is ${number(most, 4)} N/mm, at position ${fixed(positions[peak.indexOf(most)], 2)}.`
    : "";
  const wander = `The middle of the load lies from z = ${(extent(centroid) ?? [])
    .map((each) => fixed(each, 2))
    .join(" to ")} mm.`;
  return `Load along the face from z = ${number(edges[0])} to ${number(edges.at(-1))} mm, in N/mm, the mean over the positions: most at ${where(heaviest)}, ${number(heaviest, 4)}; least at ${where(least)}, ${number(least, 4)}.${at} ${wander} The face load factor is ${fixed(factor, 3)}.`;
}

/**
 * What a slope and a crowning of the driving leads would make of the load, in words; null where nothing is told or won.
 *
 * @type {(face: Pick<Face, "cure" | "face_load_factor">) => string | null}
 */
export function wordsOfCure({ cure, face_load_factor: factor }) {
  if (!cure || !(cure.face_load_factor < 0.995 * factor)) return null;
  const parts = [
    { name: "a slope", amount: cure.lead_slope_um },
    { name: "a crowning", amount: cure.crowning_um },
  ].filter(({ amount }) => Math.abs(amount) >= 0.05);
  return `K_Hβ would be ${fixed(cure.face_load_factor, 2)} with ${parts.map(({ name, amount }) => `${name} of ${fixed(Math.abs(amount), 1)} µm ${amount < 0 ? "less" : "more"}`).join(" and ")} on the leads of the driving gear.`;
}

/**
 * `modifications` of a lead with what a cure adds: to the slope and the crowning that are there, or as new ones.
 *
 * @param {LeadModification[] | null | undefined} modifications
 * @param {NonNullable<Face["cure"]>} cure
 * @returns {LeadModification[]}
 */
export function cured(modifications, { lead_slope_um: slope, crowning_um: crowning }) {
  const leads = (modifications ?? []).map((each) => ({ ...each }));
  /** @type {(kind: "slope" | "crowning", more: number) => void} */
  const add = (kind, more) => {
    const there = leads.find((each) => each.kind === kind);
    const before = there && "amount_um" in there ? there : null;
    const amount = Number(((before?.amount_um ?? 0) + more).toFixed(2));
    if (before) before.amount_um = amount;
    else if (amount !== 0) leads.push({ kind, amount_um: amount });
  };
  add("slope", slope);
  add("crowning", crowning);
  return leads.filter((each) => (each.kind !== "slope" && each.kind !== "crowning") || each.amount_um !== 0);
}

/**
 * The scale of the colors, from nothing to `most`.
 *
 * @param {number} most
 */
export function scaleOf(most, unit = "N/mm") {
  return h("span", { className: "entry" }, "0", h("span", { className: "ramp" }), `${number(most, 3)} ${unit}`);
}
