// @ts-check
// The holes of a gear: seen, dragged and moved by keys.

import { dress, s, within } from "./dom.js";
import { at } from "../state/design.js";
import { number } from "../state/numbers.js";
import { rootRadius } from "../state/tool.js";

/** @import { Design } from "../state/design.js" */
/** @import { Blank, GearName, GearOutline, Holes, Slot } from "../state/documents.js" */

const TURN = Math.PI / 180;
/** Corners of the outline of a round hole. */
const ROUND_OF_HOLE = 20;
/** @type {(value: number, step: number) => number} */
const round = (value, step) => Number((Math.round(value / step) * step).toFixed(6));

export class HoleHandles {
  /**
   * The holes of `member` in `design`; `inGear` gives where an event's pointer is in the gear's frame, in mm.
   *
   * @param {GearName} member
   * @param {Design} design
   * @param {(event: PointerEvent) => number[]} inGear
   */
  constructor(member, design, inGear) {
    this.member = member;
    this.design = design;
    this.inGear = inGear;
    this.element = s("g", { class: "holes" });
    this.drawn = "";
    /** @type {number[]} */
    this.bounds = [];
  }

  get pointer() {
    return `/pair/${this.member}/blank/holes`;
  }

  /**
   * The patterns with the pointer of each: one, or a list of them.
   *
   * @returns {[string, Holes][]}
   */
  patterns() {
    const given = this.design.get(this.pointer);
    if (!given) return [];
    return Array.isArray(given)
      ? given.map((pattern, i) => [`${this.pointer}/${i}`, pattern])
      : [[this.pointer, given]];
  }

  /** @param {string[]} wrong */
  refresh(wrong) {
    const patterns = this.patterns();
    this.#bounds();
    const isWrong = wrong.some((pointer) => pointer.startsWith(this.pointer));
    const shape = JSON.stringify(patterns.map(([, pattern]) => anglesOf(pattern).length + (pattern.slot ? "s" : "r")));
    if (shape !== this.drawn) {
      this.drawn = shape;
      this.element.replaceChildren(
        ...patterns.flatMap(([pointer, pattern]) => anglesOf(pattern).map((_, i) => this.#handle(pointer, i))),
      );
    }
    this.element.classList.toggle("wrong", isWrong);
    const handles = /** @type {SVGElement[]} */ ([...this.element.children]);
    for (const [, pattern] of patterns)
      for (const angle of anglesOf(pattern)) place(handles.shift(), pattern, angle, this.bounds);
  }

  /** Where circles of holes can lie: between the bore and the root circle. */
  #bounds() {
    const gear = this.design.get(`/pair/${this.member}`) ?? {};
    const root = rootRadius(gear);
    this.bounds = [gear.blank?.bore_radius_mm ?? 0, Number.isFinite(root) ? Number(root.toPrecision(6)) : 0];
  }

  /**
   * @param {string} pointer
   * @param {number} index
   */
  #handle(pointer, index) {
    const first = index === 0;
    const handle = s("path", {
      class: "hole",
      tabindex: first ? 0 : undefined,
      role: first ? "slider" : undefined,
      "aria-label": first
        ? `Holes ${/\d+$/.test(pointer) ? `${Number(/\d+$/.exec(pointer)?.[0]) + 1} ` : ""}of the ${this.member} gear: arrow keys up and down move the circle, left and right the phase, plus and minus change the radius, or the width of slots, brackets the number`
        : undefined,
    });
    handle.append(s("title"));
    handle.addEventListener("pointerdown", (event) => this.#drag(event, pointer, index));
    handle.addEventListener("keydown", (event) => this.#press(event, pointer));
    return handle;
  }

  /**
   * Dragged at its rim a hole changes its radius, elsewhere its circle and its phase.
   *
   * @param {PointerEvent} event
   * @param {string} pointer
   * @param {number} index
   */
  #drag(event, pointer, index) {
    if (event.button !== 0) return;
    event.preventDefault();
    event.stopPropagation();
    const handle = /** @type {SVGElement} */ (event.currentTarget);
    const pattern = this.design.get(pointer);
    const angle = anglesOf(pattern)[index];
    const center = [pattern.circle_radius_mm * Math.cos(angle), pattern.circle_radius_mm * Math.sin(angle)];
    const grip = this.inGear(event).map((value, i) => value - center[i]);
    const atRim = pattern.radius_mm && Math.hypot(...grip) > 0.78 * pattern.radius_mm;
    this.design.hold();
    /** @type {(moved: PointerEvent) => void} */
    const move = (moved) => {
      const place = this.inGear(moved);
      if (atRim)
        return this.design.set(
          `${pointer}/radius_mm`,
          Math.max(0.05, round(Math.hypot(place[0] - center[0], place[1] - center[1]), 0.05)),
          "drag",
        );
      const to = place.map((value, i) => value - grip[i]);
      const turned = wrap((Math.atan2(to[1], to[0]) - angle) / TURN);
      // A hand that means the circle is not to turn the holes.
      const phase =
        Math.abs(turned) < 2 ? (pattern.phase_deg ?? 0) : wrap(round((pattern.phase_deg ?? 0) + turned, 0.5));
      /** @type {Record<string, number>} */
      const values = { [`${pointer}/circle_radius_mm`]: Math.max(0.1, round(Math.hypot(...to), 0.05)) };
      if (pattern.count) values[`${pointer}/phase_deg`] = phase;
      this.design.setAll(values, "drag");
    };
    handle.setPointerCapture(event.pointerId);
    handle.classList.add("held");
    handle.addEventListener("pointermove", move);
    const end = () => {
      handle.classList.remove("held");
      handle.removeEventListener("pointermove", move);
      this.design.release();
    };
    for (const name of ["pointerup", "pointercancel"]) handle.addEventListener(name, end, { once: true });
  }

  /**
   * @param {KeyboardEvent} event
   * @param {string} pointer
   */
  #press(event, pointer) {
    const pattern = this.design.get(pointer);
    /** @type {(field: string, by: number, least: number) => void} */
    const add = (field, by, least) =>
      this.design.set(
        `${pointer}/${field}`,
        Math.max(least, Number(((at(pattern, `/${field}`) ?? 0) + by).toFixed(6))),
        "drag",
      );
    const size = pattern.slot ? "slot/width_mm" : "radius_mm";
    /** @type {Record<string, () => unknown>} */
    const actions = {
      ArrowUp: () => add("circle_radius_mm", 0.25, 0.1),
      ArrowDown: () => add("circle_radius_mm", -0.25, 0.1),
      ArrowRight: () => pattern.count && add("phase_deg", 1, -360),
      ArrowLeft: () => pattern.count && add("phase_deg", -1, -360),
      "+": () => add(size, 0.1, 0.05),
      "-": () => add(size, -0.1, 0.05),
      "]": () => pattern.count && add("count", 1, 1),
      "[": () => pattern.count && add("count", -1, 1),
    };
    if (!actions[event.key] || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    actions[event.key]();
    this.design.release();
    /** @type {SVGElement | null} */ (this.element.querySelector("[tabindex]"))?.focus();
  }
}

/**
 * The angles of the holes of a pattern in the frame of its gear, in radians.
 *
 * @type {(pattern: Holes) => number[]}
 */
export function anglesOf(pattern) {
  if (Array.isArray(pattern.at_deg)) return pattern.at_deg.map((angle) => angle * TURN);
  const count = Math.min(200, Math.max(0, Math.round(pattern.count ?? 0)));
  return Array.from({ length: count }, (_, i) => ((pattern.phase_deg ?? 0) + (360 * i) / count) * TURN);
}

/** @type {(degrees: number) => number} */
const wrap = (degrees) => ((((degrees + 180) % 360) + 360) % 360) - 180;

/** @type {(handle: SVGElement | undefined, pattern: Holes, angle: number, bounds: number[]) => void} */
function place(handle, pattern, angle, [least, most]) {
  if (!handle) return;
  const words = pattern.slot ? `slot ${number(pattern.slot.width_mm)} mm` : `r ${number(pattern.radius_mm)} mm`;
  handle.setAttribute(
    "d",
    pattern.slot ? slotPath({ ...pattern, slot: pattern.slot }, angle) : diskPath(pattern, angle),
  );
  within(handle, "title", SVGTitleElement).textContent = `${words}, R ${number(pattern.circle_radius_mm)} mm`;
  if (handle.getAttribute("role")) {
    dress(handle, {
      "aria-valuemin": least,
      "aria-valuemax": most,
      "aria-valuenow": pattern.circle_radius_mm,
      "aria-valuetext": `${pattern.count ?? pattern.at_deg?.length} holes, circle radius ${pattern.circle_radius_mm} mm, ${words}`,
    });
  }
}

/** @type {(pattern: Holes, angle: number) => string} */
function diskPath({ circle_radius_mm: R, radius_mm }, angle) {
  const r = radius_mm ?? 0;
  const [x, y] = [R * Math.cos(angle), R * Math.sin(angle)];
  return `M${x - r} ${y}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0Z`;
}

/**
 * A kidney along the circle, round at its ends.
 *
 * @type {(pattern: Holes & { slot: Slot }, angle: number) => string}
 */
function slotPath({ circle_radius_mm: R, slot }, angle) {
  const [r, half] = [slot.width_mm / 2, (slot.angle_deg * TURN) / 2];
  /** @type {(radius: number, turned: number) => string} */
  const at = (radius, turned) => `${radius * Math.cos(angle + turned)} ${radius * Math.sin(angle + turned)}`;
  const large = 2 * half > Math.PI ? 1 : 0;
  return `M${at(R + r, -half)}A${R + r} ${R + r} 0 ${large} 1 ${at(R + r, half)}A${r} ${r} 0 0 1 ${at(R - r, half)}A${R - r} ${R - r} 0 ${large} 0 ${at(R - r, -half)}A${r} ${r} 0 0 1 ${at(R + r, -half)}Z`;
}

/**
 * The outlines of the openings of a blank that are no holes of its patterns: the service tells them behind those, from
 * spokes and from an outline.
 *
 * @type {(outline: GearOutline, blank: Blank | undefined) => number[][][]}
 */
export function openingsOf({ holes = [] }, blank) {
  const patterns = blank?.holes ? [blank.holes].flat() : [];
  const known = patterns.reduce((count, pattern) => count + anglesOf(pattern).length, 0);
  return holes.slice(known).map(({ at_mm: [x, y], radius_mm: r, slot_angle_deg: angle, edge_mm: edge }) => {
    const slot = angle ? { width_mm: 2 * r, angle_deg: angle } : null;
    return edge ?? lineOf({ circle_radius_mm: Math.hypot(x, y), radius_mm: r, slot }, Math.atan2(y, x));
  });
}

/**
 * The outline of a hole of a pattern at an angle.
 *
 * @type {(pattern: Pick<Holes, "circle_radius_mm" | "radius_mm" | "slot">, angle: number) => number[][]}
 */
export function lineOf({ circle_radius_mm: R, radius_mm, slot }, angle) {
  const [x0, y0] = [R * Math.cos(angle), R * Math.sin(angle)];
  if (!slot) return circle(radius_mm ?? 0, ROUND_OF_HOLE).map(([x, y]) => [x + x0, y + y0]);
  const [r, half] = [slot.width_mm / 2, (slot.angle_deg * TURN) / 2];
  const along = Math.max(2, Math.ceil(half / 0.08));
  /** @type {(radius: number, from: number, to: number) => number[][]} */
  const arc = (radius, from, to) =>
    Array.from({ length: along + 1 }, (_, i) => from + ((to - from) * i) / along).map((turned) => [
      radius * Math.cos(turned),
      radius * Math.sin(turned),
    ]);
  /** @type {(at: number, from: number) => number[][]} */
  const end = (at, from) =>
    Array.from({ length: 7 }, (_, i) => from + (Math.PI * (i + 1)) / 8).map((turned) => [
      R * Math.cos(at) + r * Math.cos(turned),
      R * Math.sin(at) + r * Math.sin(turned),
    ]);
  return [
    ...arc(R + r, angle - half, angle + half),
    ...end(angle + half, angle + half),
    ...arc(R - r, angle + half, angle - half),
    ...end(angle - half, angle - half + Math.PI),
  ];
}

/**
 * A circle as a closed line.
 *
 * @type {(radius: number, corners: number) => number[][]}
 */
export const circle = (radius, corners) =>
  Array.from({ length: corners }, (_, i) => [
    radius * Math.cos((2 * Math.PI * i) / corners),
    radius * Math.sin((2 * Math.PI * i) / corners),
  ]);
