// @ts-check
// The answers in a line: what a designer looks at first, each with its change against the design that it is compared
// with.

import { h } from "../draw/dom.js";
import { extent, fixed, number } from "../state/numbers.js";

const named = (curve, pattern) =>
  curve.spectrum?.named.find(({ label }) => pattern.test(label))?.transmission_error_um ?? null;
const mega = (value) => (value === null || value === undefined ? null : value * 1e-6);
const largest = (values) => extent(values)?.[1] ?? null;

/** The part of its span in which one pair of teeth carries alone, in percent. */
function alone(curve) {
  // Lines that cross a flank come and go by their ends: what tells then is the load along the face.
  if (curve.face) return null;
  return (100 * curve.pairs_in_contact.filter((pairs) => pairs === 1).length) / curve.pairs_in_contact.length;
}

/** The largest stress at a root or at a hole of either gear. */
function largestStress({ stress }) {
  if (!stress) return null;
  return largest(
    ["driving", "driven"].flatMap((gear) => [...(stress[gear].root_mpa ?? []), ...(stress[gear].hole_mpa ?? [])]),
  );
}

/** Where the largest stress at a root or at a hole of either gear stands. */
function largestStressWhere({ statistics: { stress } }) {
  const names = ["root_mpa", "hole_mpa"];
  const each = Object.values(stress ?? {}).flatMap((gear) =>
    names.map((name) => [gear[name] ?? 0, gear.largest_where?.[name]]),
  );
  return each.reduce((most, next) => (next[0] > most[0] ? next : most), [0, undefined])[1];
}

/** A place of a largest value in words. */
function placed({ mesh_position, pair_offset, driving_diameter_mm, driven_diameter_mm, z_mm }) {
  const of = (gear, diameter) => (diameter === undefined ? [] : [`⌀ ${fixed(diameter, 2)} mm of the ${gear} gear`]);
  const pair = pair_offset === undefined ? [] : [`pair ${pair_offset}`];
  const z = z_mm === undefined ? [] : [`z ${fixed(z_mm, 1)} mm`];
  return [
    `at mesh position ${number(mesh_position, 3)}`,
    ...pair,
    ...of("driving", driving_diameter_mm),
    ...of("driven", driven_diameter_mm),
    ...z,
  ].join(", ");
}

/**
 * What each answer is: its name, unit, how it is read from a curve, how it is printed, and what a visitor asks of it.
 * `less` says whether less is better, `some` that not every method tells it, `where` the place at which it stands.
 */
export const ANSWERS = [
  {
    id: "p-p",
    name: "STE p-p",
    unit: "µm",
    less: true,
    of: (curve) => curve.statistics.transmission_error_um.peak_to_peak,
    print: (value) => fixed(value, 3),
    about:
      "Peak-to-peak transmission error: how unevenly the driven gear lags. It excites gear whine; half of it is 6 dB less. As a rule of thumb below 1 µm is quiet and above 5 µm is heard.",
  },
  {
    id: "mean",
    name: "STE mean",
    unit: "µm",
    of: (curve) => curve.statistics.transmission_error_um.mean,
    print: (value) => fixed(value, 2),
    about:
      "How far the driven gear lags under load on average, along the line of action. A constant lag makes no noise.",
  },
  {
    id: "k",
    name: "k mean",
    unit: "N/µm",
    less: false,
    of: (curve) => mega(curve.statistics.mesh_stiffness_tangent_n_per_m.mean),
    print: (value) => fixed(value, 1),
    about: "Mesh stiffness: how much more load bends the teeth and blanks by how much more, on average.",
  },
  {
    id: "face",
    name: "K_Hβ",
    unit: "",
    less: true,
    some: true,
    of: (curve) => curve.face?.face_load_factor ?? null,
    print: (value) => fixed(value, 3),
    about:
      "Face load factor: of ten equal strips of the face, how much more the heaviest carries than all of them on average. 1 is even; at 2 one strip carries twice its part, and its teeth live accordingly shorter.",
  },
  {
    id: "h-n",
    name: "H_N",
    unit: "µm",
    less: true,
    of: (curve) => named(curve, /^H_N\d?$/),
    print: (value) => number(value, 3),
    about:
      "The part of the transmission error that repeats with the holes: its amplitude at as many waves in a revolution of the driven gear as there are holes. None without holes.",
  },
  {
    id: "h-z",
    name: "H_Z2",
    unit: "µm",
    less: true,
    of: (curve) => named(curve, /^H_Z2?$/),
    print: (value) => number(value, 3),
    about: "The part that repeats with every tooth: its amplitude at the mesh order.",
  },
  {
    id: "share",
    name: "One pair alone",
    unit: "%",
    less: true,
    some: true,
    of: alone,
    print: (value) => fixed(value, 0),
    about: "Load share: for this part of the time one pair of teeth carries all the load; else two or more share it.",
  },
  {
    id: "pressure",
    name: "Max pressure",
    unit: "MPa",
    less: true,
    of: (curve) => largest(curve.peak_contact_pressure_mpa),
    where: (curve) => curve.statistics.peak_contact_pressure_mpa?.largest_where,
    print: (value) => fixed(value, 0),
    about:
      "The largest contact pressure where it has a limit. A sharp tip corner that touches has none, and is left out.",
  },
  {
    id: "stress",
    name: "Max stress",
    unit: "MPa",
    less: true,
    of: largestStress,
    where: largestStressWhere,
    print: (value) => fixed(value, 1),
    about:
      "The largest von Mises stress at the roots and holes of both gears. Computed where Stress is on, under Load and method.",
  },
];

/** The answers in `place`. */
export class Headline {
  constructor(place) {
    this.tiles = new Map();
    for (const answer of ANSWERS) {
      const value = h("span", { className: "value" }, "–");
      const change = h("span", { className: "change" });
      const about = h("p", { className: "about-answer", id: `about-${answer.id}`, hidden: true }, answer.about);
      const name = h(
        "button",
        {
          type: "button",
          className: "name",
          aria: { expanded: "false", controls: about.id },
          title: answer.about,
          on: { click: () => this.#tell(answer.id) },
        },
        answer.name,
      );
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

  /** Shows the answers of `curve`, beside those of another design, if there is one: `{ name, curve }`. */
  show(curve, other = null, draft = false) {
    for (const answer of ANSWERS) {
      const { tile, value, change, about } = this.tiles.get(answer.id);
      const [now, before] = [answer.of(curve), other && answer.of(other.curve)];
      if (answer.some) tile.hidden = now === null;
      value.textContent = now === null ? "–" : answer.print(now);
      const where = now === null ? undefined : answer.where?.(curve);
      value.title = where ? placed(where) : "";
      about.textContent = where ? `${answer.about} It stands ${placed(where)}.` : answer.about;
      value.classList.toggle("draft", draft);
      const known = typeof now === "number" && typeof before === "number";
      change.textContent = known ? changeOf(now, before) : "";
      change.title = known ? `${other.name}: ${answer.print(before)} ${answer.unit}` : "";
      // At another torque less is not better: it is another question.
      const better =
        known &&
        other.curve.output_torque_n_m === curve.output_torque_n_m &&
        answer.less !== undefined &&
        Math.abs(now - before) > 1e-3 * Math.abs(before)
          ? now < before === answer.less
          : null;
      change.classList.toggle("better", better === true);
      change.classList.toggle("worse", better === false);
    }
  }

  #tell(id) {
    for (const [each, { about, name }] of this.tiles) {
      about.hidden = each !== id || !about.hidden;
      name.setAttribute("aria-expanded", String(!about.hidden));
    }
  }
}

/** A change in percent, or in its own unit where it began at nothing. */
function changeOf(now, before) {
  if (Math.abs(before) < 1e-9) return now === before ? "±0 %" : "";
  const percent = (100 * (now - before)) / Math.abs(before);
  if (Math.abs(percent) < 0.05) return "±0 %";
  return `${percent > 0 ? "+" : "−"}${Math.abs(percent) < 10 ? fixed(Math.abs(percent), 1) : fixed(Math.abs(percent), 0)} %`;
}
