// @ts-check
// The answers in a line: four numbers for each question, each with its change against the design that it is compared
// with, and with a mark where a warning limits what it says.

import { button, h } from "../draw/dom.js";
import { markOf } from "../state/marks.js";
import { fixed, number, significant } from "../state/numbers.js";
import { inCurve, quantityOf } from "../state/quantities.js";

/** @import { Curve, GearName, Warning } from "../state/documents.js" */

/** @typedef {import("../state/documents.js").Schemas["LargestWhere"]} Where */

/**
 * @typedef {object} HeadlineAnswer
 * @property {string} id
 * @property {string[]} questions the tabs under which it stands
 * @property {string} name
 * @property {string} unit
 * @property {boolean} [some] not every method computes it
 * @property {string} [quantity] its name in the service
 * @property {(curve: Curve) => number | null} [of] its value where the service has no name for it: less is better then
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
 * The largest stress of one kind of place over the span, of the given gears; null where no stress is computed.
 *
 * @type {(curve: Curve, place: "root_mpa" | "hole_mpa", gears: GearName[]) => number | null}
 */
const stressAt = ({ statistics: { stress } }, place, gears) => {
  const values = gears.flatMap((gear) => stress?.[gear][place] ?? []);
  return values.length ? Math.max(...values) : null;
};

/**
 * The answers: name, unit, quantity, print, and a sentence for who asks.
 *
 * @type {HeadlineAnswer[]}
 */
export const ANSWERS = [
  {
    id: "p-p",
    questions: ["noise", "robustness", "designs"],
    name: "STE p-p",
    unit: "µm",
    quantity: "transmission_error_um.peak_to_peak",
    print: (value) => fixed(value, 3),
    about:
      "Peak-to-peak transmission error: how unevenly the driven gear lags. It excites gear whine; half of it is 6 dB less. As a rule of thumb below 1 µm is quiet and above 5 µm is heard.",
  },
  {
    id: "mean",
    questions: ["contact", "designs"],
    name: "STE mean",
    unit: "µm",
    quantity: "transmission_error_um.mean",
    print: (value) => fixed(value, 2),
    about:
      "How far the driven gear lags under load on average, along the line of action. A constant lag makes no noise.",
  },
  {
    id: "k",
    questions: ["noise", "speed", "designs"],
    name: "k mean",
    unit: "N/µm",
    quantity: "mesh_stiffness_tangent_n_per_m.mean",
    print: (value) => fixed(value, 1),
    about: "Mesh stiffness: how much more load bends the teeth and blanks by how much more, on average.",
  },
  {
    id: "face",
    questions: ["contact"],
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
    questions: ["noise", "robustness"],
    name: "H_N",
    unit: "µm",
    quantity: "hole_order_um",
    print: (value) => significant(value, 3),
    about:
      "The part of the transmission error that repeats with the holes: its amplitude at as many waves in a revolution of the driven gear as there are holes. None without holes.",
  },
  {
    id: "h-z",
    questions: ["noise", "speed", "robustness"],
    name: "H_Z2",
    unit: "µm",
    quantity: "mesh_order_um",
    print: (value) => significant(value, 3),
    about: "The part that repeats with every tooth: its amplitude at the mesh order.",
  },
  {
    id: "tooth-to-tooth",
    questions: ["robustness"],
    name: "Tooth to tooth",
    unit: "µm",
    quantity: "transmission_error_um.tooth_to_tooth",
    print: (value) => fixed(value, 3),
    about:
      "The largest change of the transmission error within any one mesh period: what single-flank testing calls f_i′.",
  },
  {
    id: "share",
    questions: ["contact"],
    name: "One pair alone",
    unit: "%",
    some: true,
    of: alone,
    print: (value) => fixed(value, 0),
    about: "Load share: for this part of the time one pair of teeth carries all the load; else two or more share it.",
  },
  {
    id: "pressure",
    questions: ["contact", "strength", "designs"],
    name: "Max pressure",
    unit: "MPa",
    quantity: "peak_contact_pressure_mpa",
    where: (curve) => curve.statistics.peak_contact_pressure_mpa?.largest_where,
    print: (value) => fixed(value, 0),
    about:
      "The largest contact pressure. Where a sharp corner touches at any position there is none, because pressure has no limit there.",
  },
  {
    id: "pitch-pressure",
    questions: ["contact"],
    name: "At the pitch point",
    unit: "MPa",
    quantity: "pitch_point_pressure_mpa",
    print: (value) => fixed(value, 0),
    about:
      "Hertz's pressure at the working pitch point, the full load on the common face and on one pair of teeth. None where the pitch point lies outside the path of contact.",
  },
  {
    id: "stress",
    questions: ["strength"],
    name: "Max stress",
    unit: "MPa",
    of: (curve) => (curve.statistics.stress ? largestStress(curve).value : null),
    where: (curve) => largestStress(curve).where,
    print: (value) => fixed(value, 1),
    about:
      "The largest von Mises stress at the roots and holes of both gears. Computed where Stress is on, under Load and method.",
  },
  ...[
    {
      id: "root-driving",
      name: "Root, driving",
      of: (/** @type {Curve} */ curve) => stressAt(curve, "root_mpa", ["driving"]),
    },
    {
      id: "root-driven",
      name: "Root, driven",
      of: (/** @type {Curve} */ curve) => stressAt(curve, "root_mpa", ["driven"]),
    },
    {
      id: "hole-edge",
      name: "Edges of holes",
      of: (/** @type {Curve} */ curve) => stressAt(curve, "hole_mpa", ["driving", "driven"]),
      some: true,
    },
  ].map((each) => ({
    ...each,
    questions: ["strength"],
    unit: "MPa",
    print: (/** @type {number} */ value) => fixed(value, 1),
    about: "The largest von Mises stress there over the span.",
  })),
  {
    id: "natural-frequency",
    questions: ["speed"],
    name: "Natural frequency",
    unit: "Hz",
    of: ({ dynamics }) => dynamics?.natural_frequency_hz ?? null,
    print: (value) => fixed(value, 0),
    about: "The lowest natural frequency of the pair on its mesh. A run-up computes it.",
  },
  {
    id: "motion",
    questions: ["speed"],
    name: "Largest motion",
    unit: "µm",
    quantity: "dynamic_transmission_error_um.peak_to_peak",
    print: (value) => fixed(value, 2),
    about: "The largest peak-to-peak dynamic transmission error over the speeds of the run-up.",
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
function isLessBetter({ id, quantity }) {
  if (id === "natural-frequency") return null;
  const better = quantity ? quantityOf(quantity).better : "smaller";
  return better ? better === "smaller" : null;
}

/** @typedef {{ curve: Curve, warnings: Warning[] }} Shown */

/**
 * @typedef {Record<"tile" | "value" | "unit" | "change" | "mark" | "name" | "about", HTMLElement>} Tile
 */

/** The answers in `place`. */
export class Headline {
  #question = "noise";

  /**
   * @param {HTMLElement} place
   * @param {(detail: string) => string} inWords the sentence of a warning with the fields named as in the form
   */
  constructor(place, inWords) {
    this.inWords = inWords;
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
      const unit = h("small", {}, ` ${answer.unit}`);
      const mark = button("", () => this.#tell(answer.id), { className: "mark", aria: { controls: about.id } });
      unit.hidden = mark.hidden = true;
      const tile = h(
        "div",
        { className: "tile", hidden: true, id: `answer-${answer.id}` },
        name,
        h("span", {}, value, unit, " ", mark),
        change,
      );
      place.append(tile);
      this.tiles.set(answer.id, { tile, value, unit, change, mark, name, about });
    }
    place.append(...[...this.tiles.values()].map(({ about }) => about));
    this.ask(this.#question);
  }

  /**
   * Shows the answers to a question; under the tabs of data, jobs and files those of the question before.
   *
   * @param {string} question
   */
  ask(question) {
    if (ANSWERS.some(({ questions }) => questions.includes(question))) this.#question = question;
    for (const answer of ANSWERS) {
      const parts = this.tiles.get(answer.id);
      if (!parts) continue;
      const isIts = answer.questions.includes(this.#question);
      parts.tile.hidden = !isIts || (answer.some === true && parts.value.textContent === "–");
      if (!isIts) this.#close(parts);
    }
  }

  /**
   * Shows the answers of `curve`, beside those of another design, if there is one.
   *
   * @param {Shown & { other: (Shown & { name: string }) | null, draft: boolean }} design
   */
  show({ curve, warnings, other, draft }) {
    for (const answer of ANSWERS) {
      const parts = this.tiles.get(answer.id);
      if (!parts) continue;
      const { value, unit, change, mark, about } = parts;
      const [now, before] = [valueOf(answer, curve), other && valueOf(answer, other.curve)];
      value.textContent = now === null ? "–" : answer.print(now);
      unit.hidden = now === null;
      const where = now === null ? undefined : answer.where?.(curve);
      value.title = where ? placed(where) : "";
      const name = answer.quantity ?? answer.id;
      const marked = markOf(name, warnings);
      mark.hidden = draft || !marked;
      const sentence = marked && this.inWords(marked.detail);
      mark.textContent = marked?.word ?? "";
      mark.title = sentence ?? "";
      const sentences = [sentence, answer.about, where && `It stands ${placed(where)}.`];
      about.textContent = sentences.filter(Boolean).join(" ");
      value.classList.toggle("draft", draft);
      const known = other && now !== null && before !== null;
      change.textContent = known ? changeOf(now, before) : "";
      change.title = known ? `${other.name}: ${answer.print(before)} ${answer.unit}` : "";
      const less = isLessBetter(answer);
      // At another torque less is not better: it is another question.
      const better =
        known &&
        !marked &&
        !markOf(name, other.warnings) &&
        other.curve.output_torque_n_m === curve.output_torque_n_m &&
        less !== null &&
        Math.abs(now - before) > 1e-3 * Math.abs(before)
          ? now < before === less
          : null;
      change.classList.toggle("better", better === true);
      change.classList.toggle("worse", better === false);
    }
    this.ask(this.#question);
  }

  /** @param {string} id */
  #tell(id) {
    for (const [each, parts] of this.tiles) {
      if (each !== id || !parts.about.hidden) this.#close(parts);
      else {
        parts.about.hidden = false;
        parts.name.setAttribute("aria-expanded", "true");
      }
    }
  }

  /** @param {Tile} tile */
  #close({ about, name }) {
    about.hidden = true;
    name.setAttribute("aria-expanded", "false");
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
