// @ts-check
// The answers in a line: what a designer looks at first, each with its change against the design that it is compared
// with.

import { button, h } from "../draw/dom.js";
import { fixed, number } from "../state/numbers.js";
import { inCurve, quantityOf } from "../state/quantities.js";

/** @import { Curve, GearName } from "../state/documents.js" */

/** @typedef {import("../state/documents.js").Schemas["LargestWhere"]} Where */

/**
 * @typedef {object} HeadlineAnswer
 * @property {string} id
 * @property {string} name
 * @property {string} unit
 * @property {boolean} [some]
 * @property {string} [quantity] which of the service it is
 * @property {(curve: Curve) => number | null} [of] how it is read where it is none of the service: less is better then
 * @property {(curve: Curve) => Where | null | undefined} [where]
 * @property {(value: number) => string} print
 * @property {string} about
 */

/**
 * The part of its span in which one pair of teeth carries alone, in percent.
 *
 * @type {(curve: Curve) => number | null}
 */
function alone(curve) {
  // Lines that cross a flank come and go by their ends: what tells then is the load along the face.
  if (curve.face) return null;
  return (100 * curve.pairs_in_contact.filter((pairs) => pairs === 1).length) / curve.pairs_in_contact.length;
}

/**
 * The largest stress at a root or at a hole of either gear over the span, and where it stands.
 *
 * @type {(curve: Curve) => { value: number, where: Where | null | undefined }}
 */
function largestStress({ statistics: { stress } }) {
  const each = Object.values(stress ?? {}).flatMap((gear) =>
    /** @type {const} */ (["root_mpa", "hole_mpa"]).map((name) => ({
      value: gear[name] ?? 0,
      where: gear.largest_where?.[name],
    })),
  );
  const none = { value: 0, where: /** @type {Where | null | undefined} */ (undefined) };
  return each.reduce((most, next) => (next.value > most.value ? next : most), none);
}

/**
 * A place of a largest value in words.
 *
 * @type {(where: Where) => string}
 */
function placed({ mesh_position, pair_offset, driving_diameter_mm, driven_diameter_mm, z_mm }) {
  /** @type {(gear: GearName, diameter: number | null | undefined) => string[]} */
  const of = (gear, diameter) =>
    diameter === undefined || diameter === null ? [] : [`⌀ ${fixed(diameter, 2)} mm of the ${gear} gear`];
  const pair = pair_offset === undefined || pair_offset === null ? [] : [`pair ${pair_offset}`];
  const z = z_mm === undefined || z_mm === null ? [] : [`z ${fixed(z_mm, 1)} mm`];
  return [
    `at mesh position ${number(mesh_position, 3)}`,
    ...pair,
    ...of("driving", driving_diameter_mm),
    ...of("driven", driven_diameter_mm),
    ...z,
  ].join(", ");
}

/**
 * What each answer is: its name, unit, which quantity it is, how it is printed, and what a visitor asks of it.
 * `some` that not every method tells it, `where` the place at which it stands.
 *
 * @type {HeadlineAnswer[]}
 */
export const ANSWERS = [
  {
    id: "p-p",
    name: "STE p-p",
    unit: "µm",
    quantity: "transmission_error_um.peak_to_peak",
    print: (value) => fixed(value, 3),
    about:
      "Peak-to-peak transmission error: how unevenly the driven gear lags. It excites gear whine; half of it is 6 dB less. As a rule of thumb below 1 µm is quiet and above 5 µm is heard.",
  },
  {
    id: "mean",
    name: "STE mean",
    unit: "µm",
    quantity: "transmission_error_um.mean",
    print: (value) => fixed(value, 2),
    about:
      "How far the driven gear lags under load on average, along the line of action. A constant lag makes no noise.",
  },
  {
    id: "k",
    name: "k mean",
    unit: "N/µm",
    quantity: "mesh_stiffness_tangent_n_per_m.mean",
    print: (value) => fixed(value, 1),
    about: "Mesh stiffness: how much more load bends the teeth and blanks by how much more, on average.",
  },
  {
    id: "face",
    name: "K_Hβ",
    unit: "",
    some: true,
    quantity: "face_load_factor",
    print: (value) => fixed(value, 3),
    about:
      "Face load factor: of ten equal strips of the face, how much more the heaviest carries than all of them on average. 1 is even; at 2 one strip carries twice its part, and its teeth live accordingly shorter.",
  },
  {
    id: "h-n",
    name: "H_N",
    unit: "µm",
    quantity: "hole_order_um",
    print: (value) => number(value, 3),
    about:
      "The part of the transmission error that repeats with the holes: its amplitude at as many waves in a revolution of the driven gear as there are holes. None without holes.",
  },
  {
    id: "h-z",
    name: "H_Z2",
    unit: "µm",
    quantity: "mesh_order_um",
    print: (value) => number(value, 3),
    about: "The part that repeats with every tooth: its amplitude at the mesh order.",
  },
  {
    id: "share",
    name: "One pair alone",
    unit: "%",
    some: true,
    of: alone,
    print: (value) => fixed(value, 0),
    about: "Load share: for this part of the time one pair of teeth carries all the load; else two or more share it.",
  },
  {
    id: "pressure",
    name: "Max pressure",
    unit: "MPa",
    quantity: "peak_contact_pressure_mpa",
    where: (curve) => curve.statistics.peak_contact_pressure_mpa?.largest_where,
    print: (value) => fixed(value, 0),
    about:
      "The largest contact pressure. Where a sharp corner touches at any position there is none, because pressure has no limit there.",
  },
  {
    id: "stress",
    name: "Max stress",
    unit: "MPa",
    of: (curve) => (curve.statistics.stress ? largestStress(curve).value : null),
    where: (curve) => largestStress(curve).where,
    print: (value) => fixed(value, 1),
    about:
      "The largest von Mises stress at the roots and holes of both gears. Computed where Stress is on, under Load and method.",
  },
];

/**
 * An answer of a curve, in its unit; null where the method does not tell it.
 *
 * @type {(answer: HeadlineAnswer, curve: Curve) => number | null}
 */
export function valueOf({ quantity, of }, curve) {
  if (of || !quantity) return of?.(curve) ?? null;
  const known = quantityOf(quantity);
  const value = inCurve(known, curve) ?? null;
  return value === null ? null : known.factor * value;
}

/**
 * Whether less of an answer is better; null where that depends.
 *
 * @type {(answer: HeadlineAnswer) => boolean | null}
 */
function isLessBetter({ quantity }) {
  const better = quantity ? quantityOf(quantity).better : "smaller";
  return better ? better === "smaller" : null;
}

/**
 * @typedef {{ tile: HTMLElement, value: HTMLElement, change: HTMLElement, name: HTMLElement, about: HTMLElement }} Tile
 */

/** The answers in `place`. */
export class Headline {
  /** @param {HTMLElement} place */
  constructor(place) {
    /** @type {Map<string, Tile>} */
    this.tiles = new Map();
    for (const answer of ANSWERS) {
      const value = h("span", { className: "value" }, "–");
      const change = h("span", { className: "change" });
      const about = h("p", { className: "about-answer", id: `about-${answer.id}`, hidden: true }, answer.about);
      const name = button(answer.name, () => this.#tell(answer.id), {
        className: "name",
        aria: { expanded: "false", controls: about.id },
        title: answer.about,
      });
      const tile = h(
        "div",
        { className: "tile", hidden: answer.some === true, id: `answer-${answer.id}` },
        name,
        h("span", {}, value, h("small", {}, ` ${answer.unit}`)),
        change,
      );
      place.append(tile);
      this.tiles.set(answer.id, { tile, value, change, name, about });
    }
    place.append(...[...this.tiles.values()].map(({ about }) => about));
  }

  /**
   * Shows the answers of `curve`, beside those of another design, if there is one: `{ name, curve }`.
   *
   * @param {Curve} curve
   * @param {{ name: string, curve: Curve } | null} other
   */
  show(curve, other = null, draft = false) {
    for (const answer of ANSWERS) {
      const parts = this.tiles.get(answer.id);
      if (!parts) continue;
      const { tile, value, change, about } = parts;
      const [now, before] = [valueOf(answer, curve), other && valueOf(answer, other.curve)];
      if (answer.some) tile.hidden = now === null;
      value.textContent = now === null ? "–" : answer.print(now);
      const where = now === null ? undefined : answer.where?.(curve);
      value.title = where ? placed(where) : "";
      about.textContent = where ? `${answer.about} It stands ${placed(where)}.` : answer.about;
      value.classList.toggle("draft", draft);
      const known = other && now !== null && before !== null;
      change.textContent = known ? changeOf(now, before) : "";
      change.title = known ? `${other.name}: ${answer.print(before)} ${answer.unit}` : "";
      const less = isLessBetter(answer);
      // At another torque less is not better: it is another question.
      const better =
        known &&
        other.curve.output_torque_n_m === curve.output_torque_n_m &&
        less !== null &&
        Math.abs(now - before) > 1e-3 * Math.abs(before)
          ? now < before === less
          : null;
      change.classList.toggle("better", better === true);
      change.classList.toggle("worse", better === false);
    }
  }

  /** @param {string} id */
  #tell(id) {
    for (const [each, { about, name }] of this.tiles) {
      about.hidden = each !== id || !about.hidden;
      name.setAttribute("aria-expanded", String(!about.hidden));
    }
  }
}

/**
 * A change in percent, or in its own unit where it began at nothing.
 *
 * @type {(now: number, before: number) => string}
 */
export function changeOf(now, before) {
  if (Math.abs(before) < 1e-9) return now === before ? "±0 %" : "";
  const percent = (100 * (now - before)) / Math.abs(before);
  if (Math.abs(percent) < 0.05) return "±0 %";
  return `${percent > 0 ? "+" : "−"}${Math.abs(percent) < 10 ? fixed(Math.abs(percent), 1) : fixed(Math.abs(percent), 0)} %`;
}
