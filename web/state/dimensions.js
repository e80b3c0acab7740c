// @ts-check
// What has an extent along the axis: which fields need three dimensions, and the steps into the third one and back.

import { HELIX, MEMBERS } from "./design.js";
import { number } from "./numbers.js";

/** @import { Design } from "./design.js" */

/**
 * Changes that belong together, and what is said of them.
 *
 * @typedef {{ changes: Record<string, unknown>, told: string[] }} Step
 */

/** The method that a pair gets with its first extent along the axis, and the one that it goes back to. */
const SOLID = "three_dimensional";
const PLANE = "flexible";
/** A helix begins with so many degrees. */
const USUAL_HELIX = 15;

/**
 * The fields that plane methods refuse, once the schema has told them.
 *
 * @type {string[]}
 */
let beyondPlane = [];

/**
 * Takes the pointers of the fields that plane methods refuse.
 *
 * @param {string[]} pointers
 */
export function learnDimensions(pointers) {
  beyondPlane = pointers;
}

/** What the methods in three dimensions have no choice of. */
const CHOSEN_IN_PLANE = "contact_solver";

/**
 * Whether a method computes in three dimensions.
 *
 * @type {(method: string | undefined) => boolean}
 */
export const isSolid = (method) => String(method ?? "").startsWith(SOLID);

/**
 * Whether plane methods refuse the field at `pointer`.
 *
 * @type {(pointer: string) => boolean}
 */
export const needsThird = (pointer) => beyondPlane.includes(pointer);

/**
 * What a pair is called that has teeth like these.
 *
 * @type {(angle: number | undefined) => "helical" | "straight"}
 */
export const kindOfTeeth = (angle) => (angle ? "helical" : "straight");

/** @type {(angle: number | null | undefined) => number} */
const secant = (angle) => 1 / Math.cos(((angle ?? 0) * Math.PI) / 180);
/**
 * A torque that enters at both ends is what the plane has.
 *
 * @type {(value: unknown) => boolean}
 */
const isGiven = (value) =>
  value !== undefined &&
  value !== null &&
  value !== 0 &&
  value !== "both" &&
  !(Array.isArray(value) && value.length === 0);

/**
 * Lengths that go with the helix angle: how much by for each unit that its secant grows, and what each is called.
 *
 * @param {Design} design
 */
function withHelix(design) {
  const sizes = MEMBERS.map(
    (member) => design.get(`/pair/${member}/module_mm`) * design.get(`/pair/${member}/tooth_count`),
  );
  /** @type {[string, number, string][]} */
  const tips = MEMBERS.map((member, i) => [
    `/pair/${member}/tip_diameter_mm`,
    sizes[i],
    `Tip diameter of the ${member} gear`,
  ]);
  /** @type {[string, number, string][]} */
  const lengths = [["/pair/center_distance_mm", 0.5 * (sizes[0] + sizes[1]), "Center distance"], ...tips];
  return lengths
    .filter(([pointer, by]) => typeof design.get(pointer) === "number" && Number.isFinite(by))
    .map(([pointer, by, words]) => ({ pointer, by, words, typed: pointer in design.typed }));
}

/** @type {(value: number, by: number) => number} */
const moved = (value, by) => Number((value + by).toFixed(4));

/**
 * The changes that another helix angle than `before` brings with it, and what is said of them: diameters of the same
 * normal module grow, and the gears move apart. What somebody has typed stays.
 *
 * @type {(design: Design, angle: number, before?: number) => Step}
 */
export function helix(design, angle, before = design.get(HELIX)) {
  /** @type {Record<string, unknown>} */
  const changes = { [HELIX]: angle || undefined };
  /** @type {string[]} */
  const told = [];
  const wider = secant(angle) - secant(before);
  for (const { pointer, by, words, typed } of withHelix(design)) {
    if (typed || Math.abs(by * wider) < 1e-9) continue;
    changes[pointer] = moved(design.get(pointer), by * wider);
    told.push(`${words} ${number(changes[pointer], 7)} mm`);
  }
  if (!angle || isSolid(design.get("/method"))) return { changes, told };
  const solid = intoSolid(design);
  return { changes: { ...changes, ...solid.changes }, told: [...told, ...solid.told] };
}

/**
 * What typed lengths would be that were meant for another helix angle, where that suits the teeth better: `{ pointer,
 * value, angle }`.
 *
 * @type {(design: Design) => { pointer: string, value: number, angle: number }[]}
 */
export function offers(design) {
  const angle = design.get(HELIX) ?? 0;
  if (!(Math.abs(angle) < 60)) return [];
  /** @type {(pointer: string) => number} */
  const wider = (pointer) => secant(angle) - secant(design.typed[pointer]);
  return withHelix(design)
    .filter(({ pointer, typed, by }) => typed && Math.abs(by * wider(pointer)) > 1e-4)
    .flatMap(({ pointer, by }) => {
      const [value, usual] = [design.get(pointer), usualLength(design, pointer, angle)];
      const other = moved(value, by * wider(pointer));
      return Math.abs(other - usual) < Math.abs(value - usual)
        ? [{ pointer, value: other, angle: design.typed[pointer] }]
        : [];
    });
}

/**
 * The center distance without backlash, or the tip diameter of teeth of their usual height.
 *
 * @type {(design: Design, pointer: string, angle: number) => number}
 */
function usualLength(design, pointer, angle) {
  const member = /^\/pair\/(driving|driven)\//.exec(pointer)?.[1];
  /** @type {(gear: string, name: string, usual: number) => number} */
  const of = (gear, name, usual) => design.get(`/pair/${gear}/${name}`) ?? usual;
  const normal = (of("driving", "pressure_angle_deg", 20) * Math.PI) / 180;
  if (member)
    return (
      of(member, "module_mm", 1) *
      (of(member, "tooth_count", 0) * secant(angle) + 2 * (1 + of(member, "profile_shift", 0)))
    );
  const teeth = MEMBERS.reduce((sum, gear) => sum + of(gear, "tooth_count", 0), 0);
  const shifts = MEMBERS.reduce((sum, gear) => sum + of(gear, "profile_shift", 0), 0);
  const transverse = Math.atan(Math.tan(normal) * secant(angle));
  const involute = Math.tan(transverse) - transverse + (2 * shifts * Math.tan(normal)) / teeth;
  let working = transverse;
  for (let i = 0; i < 20; i += 1)
    working = Math.max(0.01, working - (Math.tan(working) - working - involute) / Math.tan(working) ** 2);
  return (0.5 * of("driving", "module_mm", 1) * teeth * secant(angle) * Math.cos(transverse)) / Math.cos(working);
}

/**
 * A pair of straight teeth gets a helix, or a helical one gets straight teeth, and its plane method back where nothing
 * else needs the third dimension.
 *
 * @type {(design: Design, kind: string) => Step}
 */
export function teeth(design, kind) {
  if (kind === "helical") return helix(design, USUAL_HELIX);
  const { changes, told } = helix(design, 0);
  const others = pointersNeeding(design).filter((pointer) => pointer !== HELIX);
  const back = isSolid(design.get("/method")) && others.length === 0 ? intoPlane(design) : { changes: {}, told: [] };
  return { changes: { ...back.changes, ...changes }, told: [...told, ...back.told] };
}

/**
 * The changes that compute the pair in three dimensions.
 *
 * @type {(design: Design) => Step}
 */
export function intoSolid(design) {
  const { [CHOSEN_IN_PLANE]: solver, ...resolution } = design.get("/resolution") ?? {};
  /** @type {Record<string, unknown>} */
  const left = solver === undefined || solver === "active_set" ? {} : { "/resolution": resolution };
  const method = design.get("/method");
  const changes = { "/method": isSolid(method) ? method : SOLID, "/face_load": "positions", ...left };
  return {
    changes,
    told: ["Computed in three dimensions", ...(left["/resolution"] ? ["The contact is solved by the active set"] : [])],
  };
}

/**
 * The changes that compute the pair in the plane: what has an extent along the axis goes.
 *
 * @type {(design: Design) => Step}
 */
export function intoPlane(design) {
  const left = pointersNeeding(design);
  const straight = left.includes(HELIX) ? helix(design, 0) : { changes: {}, told: [] };
  const { face_order: order, face_slices: slices, ...resolution } = design.get("/resolution") ?? {};
  const finer =
    order === undefined && slices === undefined
      ? {}
      : { "/resolution": Object.keys(resolution).length ? resolution : undefined };
  const changes = {
    ...Object.fromEntries(left.map((pointer) => [pointer, undefined])),
    ...straight.changes,
    "/method": PLANE,
    "/face_load": undefined,
    ...finer,
  };
  const words = left.map((pointer) =>
    pointer
      .split("/")
      .slice(-1)[0]
      .replace(/_(mm|um|deg)$/, "")
      .replace(/_/g, " "),
  );
  return {
    changes,
    told: [
      "Computed in the plane",
      ...(left.length ? [`Left out: ${[...new Set(words)].join(", ")}`] : []),
      ...straight.told,
    ],
  };
}

/**
 * Whether the design has something that plane methods refuse.
 *
 * @type {(design: Design) => boolean}
 */
export const needsSolid = (design) => pointersNeeding(design).length > 0;

/**
 * The fields of the design that plane methods refuse.
 *
 * @type {(design: Design) => string[]}
 */
const pointersNeeding = (design) => beyondPlane.filter((pointer) => isGiven(design.get(pointer)));
