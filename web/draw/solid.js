// @ts-check
// The surface of a gear in space: teeth along their helix, end faces, web, hub, holes. Points are in the frame of the
// gear, in mm; z is that of its face.

import { thinned } from "./drawing.js";
import { anglesOf, circle, lineOf, openingsOf } from "./holes.js";

/** @import { Blank, Gear, GearName, GearOutline, Pair, PairOutline } from "../state/documents.js" */

const TURN = Math.PI / 180;
/** @typedef {ReturnType<typeof alongAxis>} Along */

/** @typedef {{ pair: number, points: { z: number, at: number[] }[] }} ContactLine */

/** What a facet may lie beside the flank, in modules. */
const FINENESS = 0.008;
/** By so much a tooth turns in one piece of its length at most, in radians. */
const PIECE = 0.05;
const MOST_PIECES = 16;
/** Corners of a large circle. */
const ROUND = 72;

/** Points and triangles as they are gathered. */
class Surface {
  /** @type {number[]} */
  points = [];
  /** @type {number[]} */
  triangles = [];
  /** @type {number[]} */
  edges = [];

  /**
   * @param {number} x
   * @param {number} y
   * @param {number} z
   */
  point(x, y, z) {
    this.points.push(x, y, z);
    return this.points.length / 3 - 1;
  }

  /**
   * A facet of four corners, counter-clockwise from outside.
   *
   * @type {(a: number, b: number, c: number, d: number) => void}
   */
  facet(a, b, c, d) {
    this.triangles.push(a, b, c, a, c, d);
  }

  /**
   * A wall over a closed line from one z to another; `inward` is one that is seen from inside.
   *
   * @param {number[][]} line
   * @param {number[]} heights
   * @param {boolean} inward
   */
  wall(line, [from, to], inward) {
    const rows = line.map(([x, y]) => [this.point(x, y, from), this.point(x, y, to)]);
    rows.forEach(([a, d], i) => {
      const [b, c] = rows[(i + 1) % rows.length];
      if (inward) this.facet(b, a, d, c);
      else this.facet(a, b, c, d);
      this.edges.push(a, b, d, c);
    });
  }

  /**
   * A flat face at `z` between two heights, left and right of each; `up` is seen from +z.
   *
   * @param {number[]} heights
   * @param {number[]} corners
   * @param {number} z
   * @param {boolean} up
   */
  trapezoid([low, high], [lowLeft, lowRight, highLeft, highRight], z, up) {
    /** @type {[number, number, number, number]} */
    const corners = [
      this.point(lowLeft, low, z),
      this.point(lowRight, low, z),
      this.point(highRight, high, z),
      this.point(highLeft, high, z),
    ];
    if (up) this.facet(...corners);
    else this.facet(corners[3], corners[2], corners[1], corners[0]);
  }
}

/**
 * The outlines of the holes of a blank.
 *
 * @type {(blank: Blank) => number[][][]}
 */
export function holesOf(blank) {
  const patterns = blank.holes ? [blank.holes].flat() : [];
  return patterns.flatMap((pattern) => anglesOf(pattern).map((angle) => lineOf(pattern, angle)));
}

/**
 * The rings of a blank from its bore, or the axis of its shaft, to `rim`: `{ radii, heights }`, where the first of hub
 * and web that covers a radius decides, and else the face.
 *
 * @type {(blank: Blank, face: number, rim: number) => { radii: [number, number], heights: [number, number] }[]}
 */
export function ringsOf({ bore_radius_mm, web, hub }, face, rim) {
  const bore = bore_radius_mm ?? 0;
  /** @type {(offset: number | null | undefined, width: number) => [number, number]} */
  const around = (offset, width) => [(offset ?? 0) - width / 2, (offset ?? 0) + width / 2];
  /** @type {[number, number]} */
  const whole = [-face / 2, face / 2];
  /** @type {[number, number, [number, number]][]} */
  const parts = [];
  if (hub) parts.push([bore, hub.outer_radius_mm, around(hub.offset_mm, hub.width_mm)]);
  if (web) parts.push([web.inner_radius_mm, web.outer_radius_mm, around(web.offset_mm, web.thickness_mm)]);
  const ends = [...new Set([bore, ...parts.flatMap(([from, to]) => [from, to]), rim])]
    .filter((radius) => radius >= bore && radius <= rim)
    .sort((a, b) => a - b);
  return ends.slice(1).map((to, i) => {
    const middle = (ends[i] + to) / 2;
    return { radii: [ends[i], to], heights: parts.find(([low, high]) => middle > low && middle < high)?.[2] ?? whole };
  });
}

/**
 * A flat ring without its holes, as pieces between heights of y: each where the ring is, less where holes are.
 *
 * @type {(ring: number[][][], holes: number[][][]) => [number[], number[]][]}
 */
function pieces([inner, outer], holes) {
  const lines = [outer, inner, ...holes];
  const heights = [...new Set(lines.flatMap((line) => line.map(([, y]) => Number(y.toFixed(3)))))].sort(
    (a, b) => a - b,
  );
  const edges = lines.map((line) =>
    line.map(([x, y], i) => {
      const [x1, y1] = line[(i + 1) % line.length];
      return y < y1 ? [x, y, x1, y1] : [x1, y1, x, y];
    }),
  );
  /** @type {[number[], number[]][]} */
  const found = [];
  for (let i = 0; i + 1 < heights.length; i += 1) {
    const [low, high] = [heights[i], heights[i + 1]];
    const middle = (low + high) / 2;
    /** @type {(edge: number[], y: number) => number} */
    const at = ([x0, y0, x1, y1], y) => x0 + ((Math.min(Math.max(y, y0), y1) - y0) / (y1 - y0)) * (x1 - x0);
    const spans = edges.map((all) =>
      all.filter(([, y0, , y1]) => y0 < middle && y1 > middle).sort((a, b) => at(a, middle) - at(b, middle)),
    );
    const [[from, to], ...openings] = spans;
    if (!from) continue;
    const gaps = openings
      .flatMap((crossings) =>
        Array.from({ length: crossings.length >> 1 }, (_, k) => [crossings[2 * k], crossings[2 * k + 1]]),
      )
      .sort((a, b) => at(a[0], middle) - at(b[0], middle));
    let left = from;
    for (const [start, stop] of [...gaps, [to, to]]) {
      if (at(start, middle) > at(left, middle))
        found.push([
          [low, high],
          [at(left, low), at(start, low), at(left, high), at(start, high)],
        ]);
      if (at(stop, middle) > at(left, middle)) left = stop;
    }
  }
  return found;
}

/**
 * The surface of a gear whose `outline` is that of the service, of `gear` in the submission. `twist` is by how much its
 * sections turn with z, in radians a mm, from the section at `mid`. Gives points, triangles and edges as flat lists.
 *
 * @param {GearOutline} outline
 * @param {Gear} gear
 * @param {number} twist
 * @param {number} mid
 */
export function surfaceOf(outline, gear, twist, mid) {
  const surface = new Surface();
  const face = gear.face_width_mm;
  const blank = gear.blank;
  const module = gear.module_mm;
  const tooth = thinned(outline.tooth_mm, FINENESS * module);
  const count = outline.tooth_count;
  const holes = [...holesOf(blank), ...openingsOf(outline, blank)];
  const reach = Math.max(0, ...holes.flat().map(([x, y]) => Math.hypot(x, y)));
  const rim = Math.max(
    outline.circles.root_mm - 0.25 * module,
    Math.min(reach + 0.01 * module, 0.999 * outline.circles.root_mm),
  );
  const sections = Math.min(MOST_PIECES, Math.max(1, Math.ceil((Math.abs(twist) * face) / PIECE)));
  const line = Array.from({ length: count }, (_, i) => {
    const [cos, sin] = [Math.cos((2 * Math.PI * i) / count), Math.sin((2 * Math.PI * i) / count)];
    return tooth.slice(0, -1).map(([x, y]) => [x * cos - y * sin, x * sin + y * cos]);
  }).flat();
  const rows = Array.from({ length: sections + 1 }, (_, k) => {
    const z = -face / 2 + (face * k) / sections;
    const [cos, sin] = [Math.cos(twist * (z - mid)), Math.sin(twist * (z - mid))];
    return line.map(([x, y]) => surface.point(x * cos - y * sin, x * sin + y * cos, z));
  });
  for (let k = 0; k < sections; k += 1)
    line.forEach((_, i) =>
      surface.facet(rows[k][i], rows[k][(i + 1) % line.length], rows[k + 1][(i + 1) % line.length], rows[k + 1][i]),
    );
  // The end faces from the teeth to the rim.
  for (const k of [0, sections]) {
    const up = k > 0;
    const inner = rows[k].map((point) => {
      const [x, y, z] = surface.points.slice(3 * point, 3 * point + 3);
      const part = rim / Math.hypot(x, y);
      return surface.point(x * part, y * part, z);
    });
    rows[k].forEach((a, i) => {
      const next = (i + 1) % rows[k].length;
      if (up) surface.facet(a, rows[k][next], inner[next], inner[i]);
      else surface.facet(rows[k][next], a, inner[i], inner[next]);
      surface.edges.push(a, rows[k][next]);
    });
  }
  const rings = ringsOf(blank, face, rim);
  for (const [i, { radii, heights }] of rings.entries()) {
    const inside = holes.filter((hole) => {
      const far = hole.map(([x, y]) => Math.hypot(x, y));
      return Math.max(...far) > radii[0] && Math.min(...far) < radii[1];
    });
    // Corners of the last ring lie beyond the rim: it has other corners, and no gap stays between them.
    const beyond = i + 1 < rings.length ? 1 : 1 / Math.cos(Math.PI / ROUND);
    for (const [span, corners] of pieces([circle(radii[0], ROUND), circle(beyond * radii[1], ROUND)], inside))
      heights.forEach((z, end) => surface.trapezoid(span, corners, z, end === 1));
    for (const hole of inside) surface.wall(hole, heights, true);
    // Where a ring is wider than its neighbor its wall is seen.
    const before = rings[i - 1]?.heights;
    if (!before) {
      if (radii[0] > 0) surface.wall(circle(radii[0], ROUND), heights, true);
    } else {
      /** @type {(from: number, to: number, inward: boolean) => void} */
      const wall = (from, to, inward) => {
        if (to - from > 1e-6) surface.wall(circle(radii[0], ROUND), [from, to], inward);
      };
      wall(heights[0], Math.min(before[0], heights[1]), true);
      wall(Math.max(before[1], heights[0]), heights[1], true);
      wall(before[0], Math.min(heights[0], before[1]), false);
      wall(Math.max(heights[1], before[0]), before[1], false);
    }
  }
  return {
    points: Float64Array.from(surface.points),
    triangles: Uint32Array.from(surface.triangles),
    edges: Uint32Array.from(surface.edges),
  };
}

/**
 * By how much the sections of both gears turn with z, in radians a mm, and where the common face lies: `{ twists, mid,
 * half, offset, advance }`; `advance` is in mesh periods a mm.
 *
 * @param {Pair} pair
 * @param {PairOutline} outline
 */
export function alongAxis(pair, outline) {
  const angle = (pair.helix_angle_deg ?? 0) * TURN;
  const offset = pair.axial_offset_mm ?? 0;
  const [one, other] = [pair.driving.face_width_mm / 2, pair.driven.face_width_mm / 2];
  const [from, to] = [Math.max(-one, offset - other), Math.min(one, offset + other)];
  /** @type {(member: GearName) => number} */
  const twistOf = (member) => Math.tan(angle) / outline[member].circles.reference_mm;
  const twists = { driving: twistOf("driving"), driven: -twistOf("driven") };
  return {
    twists,
    mid: (from + to) / 2,
    half: Math.max(0, (to - from) / 2),
    offset,
    advance: (twists.driving * outline.driving.tooth_count) / (2 * Math.PI),
  };
}

/**
 * Where pair `pair` touches at a mesh position and a z from the middle of the common face, on the line of action of
 * that section or beyond its ends.
 *
 * @type {(outline: PairOutline, along: Along, position: number, pair: number, z: number) => number[]}
 */
export function contactAt(
  {
    line_of_action: {
      points: [a, , , , e],
    },
  },
  { advance },
  position,
  pair,
  z,
) {
  const phase = position - Math.floor(position) - pair + z * advance;
  const t = (phase - a.mesh_position) / (e.mesh_position - a.mesh_position);
  return [0, 1].map((i) => a.at_mm[i] + t * (e.at_mm[i] - a.at_mm[i]));
}

/**
 * The lines of contact at a mesh position, those on the path of contact: `{ pair, points }`, each point `{ z, at }`
 * with z from the middle of the common face and its place in the transverse section, in mm.
 *
 * @type {(outline: PairOutline, along: Along, position: number, steps?: number) => ContactLine[]}
 */
export function contactLines(outline, along, position, steps = 24) {
  const { half, advance } = along;
  const {
    points: [a, , , , e],
  } = outline.line_of_action;
  const period = position - Math.floor(position);
  const beside = half * Math.abs(advance);
  /** @type {ContactLine[]} */
  const lines = [];
  for (
    let pair = Math.ceil(period - e.mesh_position - beside - 1e-9);
    pair <= Math.floor(period - a.mesh_position + beside + 1e-9);
    pair += 1
  ) {
    const ends =
      Math.abs(advance) < 1e-12
        ? [-half, half]
        : [a, e]
            .map(({ mesh_position: phase }) => Math.min(half, Math.max(-half, (phase - period + pair) / advance)))
            .sort((x, y) => x - y);
    const middle = period - pair + ((ends[0] + ends[1]) / 2) * advance;
    if (!(ends[1] - ends[0] > 1e-9) || middle < a.mesh_position - 1e-9 || middle > e.mesh_position + 1e-9) continue;
    const points = Array.from({ length: steps + 1 }, (_, k) => {
      const z = ends[0] + ((ends[1] - ends[0]) * k) / steps;
      return { z, at: contactAt(outline, along, position, pair, z) };
    });
    lines.push({ pair, points });
  }
  return lines;
}
