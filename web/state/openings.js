// @ts-check
// The openings of a blank, by the field that each stands in: what it begins with, and where it stands.

/** @import { Blank, Holes } from "./documents.js" */

/**
 * Where openings of a gear fit, in mm: between two radii, those of its web where it has one; `whole` is what lies
 * between bore and root circle, and `ligament` how much material stays between openings.
 *
 * @typedef {{ inner: number, outer: number, isWeb: boolean, whole: number, ligament: number }} Room
 */

const TURN = Math.PI / 180;

/** @type {(value: number, digits?: number) => number} */
export const rounded = (value, digits = 3) => Number(value.toPrecision(digits));

/**
 * What openings of each shape begin with. A shape stands at the angle `phase_deg`, or each of its openings at one of
 * `at_deg`.
 *
 * @type {Record<string, (room: Room) => Record<string, number>>}
 */
export const OPENINGS = {
  // Within the web, where there is one: no hole crosses its edges.
  holes({ inner, outer, isWeb, whole }) {
    const circle = rounded((outer + inner) / 2);
    const radius = Math.min((isWeb ? 0.4 : 0.27) * (outer - inner), 0.27 * whole, 0.3 * circle);
    return { count: 6, circle_radius_mm: circle, radius_mm: rounded(radius, 2), phase_deg: 0 };
  },
  spokes({ inner, outer, ligament }) {
    /** @type {(part: number) => number} */
    const at = (part) => rounded(inner + part * (outer - inner));
    return {
      count: 5,
      width_mm: rounded(Math.max(0.15 * at(0.2), ligament)),
      fillet_radius_mm: rounded(0.06 * (outer - inner), 2),
      inner_radius_mm: at(0.2),
      outer_radius_mm: at(0.75),
      phase_deg: 0,
    };
  },
};

/**
 * Whether a blank has openings that are drawn as the service tells them, and not from the design as holes are.
 *
 * @type {(blank: Record<string, unknown>) => boolean}
 */
export const hasMoreThanHoles = (blank) =>
  ["outline", ...Object.keys(OPENINGS)].some((name) => name !== "holes" && Boolean(blank[name]));

/**
 * The angles at which the openings of a blank stand, by their pointers within it; null where they do not say it all: an
 * outline stands as it is drawn.
 *
 * @type {(blank: Blank | undefined) => Record<string, number | number[]> | null}
 */
export function anglesOf(blank) {
  if (!blank || blank.outline) return null;
  /** @type {Record<string, any>} */
  const fields = blank;
  const angles = Object.keys(OPENINGS).flatMap((name) =>
    (fields[name] ? [fields[name]].flat() : []).map(({ at_deg: at, phase_deg: phase = 0 }, i) => {
      const place = Array.isArray(fields[name]) ? `${name}/${i}` : name;
      return at ? [`${place}/at_deg`, at] : [`${place}/phase_deg`, phase ?? 0];
    }),
  );
  return Object.fromEntries(angles);
}

/**
 * Between which radii the holes of a blank lie, in mm.
 *
 * @type {(holes: Blank["holes"]) => [number, number]}
 */
export function reachOf(holes) {
  const patterns = [holes ?? []]
    .flat()
    .map(({ circle_radius_mm: circle, radius_mm: radius, slot }) => [circle, radius ?? (slot?.width_mm ?? NaN) / 2]);
  return [
    Math.min(...patterns.map(([circle, half]) => circle - half)),
    Math.max(0, ...patterns.map(([circle, half]) => circle + half)),
  ];
}

/** @type {(pattern: Holes) => number} */
const numberOf = (pattern) => pattern.count ?? pattern.at_deg?.length ?? 1;

/**
 * Slots in place of the round holes of a pattern, with material left between them.
 *
 * @param {Holes} pattern
 */
export function slotOf(pattern) {
  return {
    width_mm: rounded(pattern.radius_mm ?? pattern.circle_radius_mm / 10, 2),
    angle_deg: rounded(180 / Math.max(numberOf(pattern), 3), 2),
  };
}

/**
 * A further pattern: small round holes midway between those of `pattern`, so small that `left` mm of material stay
 * between them.
 *
 * @param {Holes} pattern
 * @param {number} left
 */
export function between(pattern, left) {
  const half = 180 / numberOf(pattern);
  const places = pattern.at_deg
    ? { at_deg: pattern.at_deg.map((angle) => angle + half) }
    : { count: pattern.count, phase_deg: (pattern.phase_deg ?? 0) + half };
  const radius = pattern.radius_mm ?? (pattern.slot?.width_mm ?? NaN) / 2;
  const room =
    2 * pattern.circle_radius_mm * Math.sin((0.5 * half - 0.25 * (pattern.slot?.angle_deg ?? 0)) * TURN) - radius;
  return {
    ...places,
    circle_radius_mm: pattern.circle_radius_mm,
    radius_mm: rounded(Math.max(0.1, Math.min(0.4 * radius, room - left)), 2),
  };
}
