// @ts-check
// Where the tool stood that cut the root of a gear, and how deep it cut.

/** @import { Gear } from "./documents.js" */

/**
 * The generating profile shift x_E of straight teeth. A size over a span or over balls is not evaluated here: the
 * nominal shift stands for it.
 *
 * @type {(gear: Gear) => number}
 */
export function toolShift(gear) {
  const x = gear.profile_shift ?? 0;
  if (typeof gear.generating_profile_shift === "number") return gear.generating_profile_shift;
  if (gear.thinned_by === "flank_grinding") return x;
  const thicker = (gear.tooth_thickness_deviation_normal_um ?? gear.tooth_thickness_deviation_um ?? 0) / 1000;
  return x + thicker / (2 * gear.module_mm * Math.tan(((gear.pressure_angle_deg ?? 20) * Math.PI) / 180));
}

/**
 * The root radius of a gear with straight teeth, in mm, by its diameter or by the dedendum of the tool.
 *
 * @type {(gear: Gear) => number}
 */
export function rootRadius(gear) {
  if (gear.root_diameter_mm) return gear.root_diameter_mm / 2;
  const { module_mm: module, tooth_count: teeth, dedendum_mm: dedendum } = gear;
  return module * (teeth / 2 + toolShift(gear)) - (dedendum ?? 1.25 * module);
}

/**
 * The dedendum of the tool, in mm.
 *
 * @type {(gear: Gear) => number}
 */
export const dedendumOf = (gear) => gear.module_mm * (gear.tooth_count / 2 + toolShift(gear)) - rootRadius(gear);
