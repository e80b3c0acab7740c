// @ts-check
// What the curves of designs are made of: their points, names, units and what a listener should know of them.

import { MEMBERS } from "./design.js";
import { fixed, number } from "./numbers.js";
import { apart, withPoints } from "./points.js";
import { shown } from "./quantities.js";

/** @import { Curve, NamedDesign, Spectrum } from "./documents.js" */

/** @typedef {{ name: string, values: (number | null)[], open?: boolean }} Part */

/**
 * A line of a panel over mesh positions: of a design by its `look`, or of a `part` of the live one. One that is `open`
 * does not go on behind its end as it begins.
 *
 * @typedef {Part & { x: number[], span: number, dash: number[], look?: number, part?: number }} Line
 */

/**
 * What a chart shows: a curve of each design by `of`, or parts of the live one by `ofLive`, in place of which `whole`
 * stands where there are too many.
 *
 * @typedef {object} Panel
 * @property {string} id
 * @property {"noise" | "contact" | "strength"} question the question that it answers
 * @property {string} title
 * @property {string} unit
 * @property {(curve: Curve) => (number | null)[]} [of]
 * @property {(curve: Curve) => Part[]} [ofLive]
 * @property {(curve: Curve) => Part[]} [whole]
 * @property {string} [note]
 * @property {string} [gaps] what its gaps mean
 * @property {string} [none] what it means that there is no line
 * @property {string} [along] what it is drawn over in place of the position
 * @property {boolean} [rare] whether it is shown only where there is something to show
 */

/** @typedef {[number, number]} Point */
/** @typedef {[number, number, number, number]} Box */
/** @typedef {{ order: number, label: string, value: number }} OrderName */

/** What lies below is noise of the solution, in um. */
export const LEAST_AMPLITUDE = 1e-4;
/**
 * Told apart without color: full, dashed, dotted, and both.
 *
 * @type {number[][]}
 */
export const DASHES = [[], [7, 4], [2, 3], [10, 3, 2, 3], [12, 4], [4, 2, 1, 2], [1, 2]];

/** @type {(values: number[]) => number[]} */
const micro = (values) => values.map((value) => value * 1e-6);

/** @type {Panel[]} */
export const PANELS = [
  { id: "ste", question: "noise", title: "Transmission error", unit: "µm", of: (curve) => curve.transmission_error_um },
  {
    id: "stiffness",
    question: "noise",
    title: "Mesh stiffness, tangent",
    unit: "N/µm",
    of: (curve) => micro(curve.mesh_stiffness_tangent_n_per_m),
  },
  {
    id: "share",
    question: "contact",
    title: "Load share",
    unit: "%",
    ofLive: shares,
    note: "a line for each pair of teeth",
    whole: largestShare,
  },
  {
    id: "pressure",
    question: "contact",
    title: "Peak contact pressure",
    unit: "MPa",
    of: (curve) => curve.peak_contact_pressure_mpa,
    gaps: "No line where a sharp tip corner carries: the pressure has no limit there. More tip relief avoids it.",
    none: "No line: a sharp tip corner carries at every position, and the pressure has no limit there. A rounding of the tip edges or more tip relief gives it one.",
  },
  { id: "face", question: "contact", title: "Load along the face", unit: "N/mm", along: "z", rare: true },
  { id: "stress", question: "strength", title: "Largest stress", unit: "MPa", ofLive: stresses, rare: true },
];

/** Pairs so far apart are never in contact together, and share a look. */
const LOOKS_OF_PAIRS = 4;

/**
 * The load shares of the live curve. A pair of teeth keeps its look from its first touch to its last.
 *
 * @type {(curve: Curve) => Part[]}
 */
function shares(curve) {
  const offsets = curve.load_shares.map(({ pair_offset: offset }) => offset);
  return Array.from({ length: LOOKS_OF_PAIRS }, (_, look) => {
    const carried = curve.mesh_position.map((position, i) => {
      const index = offsets.findIndex(
        (offset) =>
          (((Math.floor(position + 1e-9) + offset - look) % LOOKS_OF_PAIRS) + LOOKS_OF_PAIRS) % LOOKS_OF_PAIRS === 0,
      );
      return index < 0 ? 0 : 100 * curve.load_shares[index].share[i];
    });
    // Where nothing is carried there is no line, but a curve begins and ends at zero.
    return {
      name: `pair ${look + 1}`,
      open: true,
      values: carried.map((value, i) =>
        value > 0 || carried[i - 1] > 0 || carried[i + 1] > 0 ? Math.max(value, 0) : null,
      ),
    };
  });
}

/**
 * The share of the pair that carries most, at each position: what can be seen of a long period.
 *
 * @type {(curve: Curve) => Part[]}
 */
function largestShare(curve) {
  return [
    {
      name: "the pair that carries most",
      values: curve.mesh_position.map((_, i) => 100 * Math.max(...curve.load_shares.map(({ share }) => share[i]))),
    },
  ];
}

/**
 * The stresses of the live curve, where they were asked for: at the roots of both gears, and at their holes.
 *
 * @type {(curve: Curve) => { name: string, values: number[] }[]}
 */
export function stresses({ stress }) {
  if (!stress) return [];
  return /** @type {const} */ (["root", "hole"]).flatMap((place) =>
    MEMBERS.flatMap((gear) => {
      const values = stress[gear][`${place}_mpa`];
      return values ? [{ name: `${place}, ${gear} gear`, values }] : [];
    }),
  );
}

/**
 * How many mesh periods a curve spans.
 *
 * @type {(curve: { mesh_position: number[] }) => number}
 */
export function spanOf({ mesh_position: positions }) {
  return positions.length > 1 ? positions.length * (positions[1] - positions[0]) : 1;
}

/**
 * A line over `longest` mesh periods: what has a shorter true period goes on repeating it.
 *
 * @type {(line: Line, longest: number, partial: boolean) => Line}
 */
function repeated(line, longest, partial) {
  if (partial || !(longest > line.span * (1 + 1e-9))) return line;
  const turns = Math.ceil(longest / line.span - 1e-9);
  const last = longest - 1e-9;
  const x = Array.from({ length: turns }, (_, turn) => line.x.map((place) => place + turn * line.span)).flat();
  const values = Array.from({ length: turns }, () => line.values).flat();
  const count = x.filter((place) => place < last).length;
  const whole = Math.abs(turns * line.span - longest) < 1e-6;
  return { ...line, x: x.slice(0, count), values: values.slice(0, count), span: longest, open: line.open || !whole };
}

/**
 * The lines of a panel: `{ name, look, dash, x, values, span, open }`. Designs have looks, torques have dashes; where
 * there is one torque designs have both. Lines of parts of the live design have a `part` in place of a look. Where they
 * are `crowded` pairs of teeth are no lines.
 *
 * @type {(panel: Panel, designs: NamedDesign[], crowded?: boolean) => Line[]}
 */
export function linesOf(panel, designs, crowded = false) {
  if (panel.ofLive) {
    const [curve] = designs[0].results.curves;
    const drawn = withPoints(curve);
    return (crowded && panel.whole ? panel.whole : panel.ofLive)(drawn).map((each, i) => ({
      ...each,
      part: i,
      dash: DASHES[i % DASHES.length],
      x: apart(drawn.mesh_position),
      span: spanOf(curve),
    }));
  }
  const several = designs.some(({ results }) => results.curves.length > 1);
  const longest = Math.max(...designs.flatMap(({ results }) => results.curves.map(spanOf)));
  return designs.flatMap(({ name, results, look }, i) =>
    results.curves.map((curve, j) =>
      repeated(
        {
          name: several ? `${name}, ${number(curve.output_torque_n_m)} N m` : name,
          values: panel.of?.(withPoints(curve)) ?? [],
          x: apart(withPoints(curve).mesh_position),
          span: spanOf(curve),
          look: look ?? i,
          dash: DASHES[(several ? j : (look ?? i)) % DASHES.length],
        },
        longest,
        curve.statistics.partial,
      ),
    ),
  );
}

/**
 * The names of orders up to `last` that spectra have, each at the most that any of them has there: a name stands above
 * every line of its order. Those that have less than `part` of the largest amplitude are left out.
 *
 * @type {(spectra: { named: { order: number, label: string, transmission_error_um: number }[], orders: Point[] }[],
 *   last: number, part?: number) => OrderName[]}
 */
export function namesOf(spectra, last, part = 0) {
  /** @type {Map<string, OrderName>} */
  const names = new Map();
  for (const { named, orders } of spectra) {
    for (const { order, label, transmission_error_um: value } of named) {
      if (order > last || !(value > LEAST_AMPLITUDE) || names.has(`${label} ${order}`)) continue;
      const most = Math.max(
        value,
        ...spectra.flatMap((other) =>
          other.orders.filter(([each]) => each === order).map(([, amplitude]) => amplitude),
        ),
      );
      names.set(`${label} ${order}`, { order, label, value: most });
    }
  }
  const largest = Math.max(0, ...spectra.flatMap(({ orders }) => orders.map(([, amplitude]) => amplitude)));
  return [...names.values()].filter(({ value }) => value >= part * largest);
}

/**
 * The names of orders where there is room for them, the tallest first and those of holes and mesh before all: none over
 * another, nor over one of the `stems` `{ order, value }`, of which a mark stands on top; a name rises above the stems
 * and names beside it. `{ label, x, y }`, centered over their lines.
 *
 * @type {(names: OrderName[], how: { stems?: { order: number, value: number }[], mark?: number, px: (order: number) =>
 *   number, py: (value: number) => number, left: number, right: number, top?: number, letter: number, widthOf: (label:
 *   string) => number }) => { label: string, x: number, y: number }[]}
 */
export function placedNames(names, { stems = [], mark = 0, px, py, left, right, top = 0, letter, widthOf }) {
  /** @type {Box[]} */
  const taken = [];
  /** @type {(name: OrderName) => number} */
  const rank = ({ label }) => (/^H_(N\d?|Z\d?)$/.test(label) ? 0 : 1);
  const marks = stems.map(({ order, value }) => [px(order), py(value)]);
  return [...names]
    .sort((a, b) => rank(a) - rank(b) || b.value - a.value)
    .flatMap(({ label, order, value }) => {
      const width = widthOf(label);
      // Stems reach from their mark to the foot: above the highest of those below the name there is room.
      const places = [0, width / 2, -width / 2].map((aside) => {
        const x = Math.min(Math.max(px(order) + aside, left + width / 2), right - width / 2);
        const below = marks.filter(([at]) => Math.abs(at - x) < width / 2 + 2 + mark).map(([, level]) => level);
        return { x, foot: Math.min(py(value), ...below) };
      });
      // Beside its line, where it would stand above a much higher one.
      const { x, foot } = places.find(({ foot }) => py(value) - foot < letter) ?? places[0];
      let y = foot - 0.5 * letter - mark;
      /** @type {(level: number) => Box} */
      const boxAt = (level) => [x - width / 2 - 2, level - letter, x + width / 2 + 2, level + 2];
      /** @type {(box: Box) => Box | undefined} */
      const under = (box) =>
        taken.find((other) => box[0] < other[2] && other[0] < box[2] && box[1] < other[3] && other[1] < box[3]);
      // Above another name, but no farther from its line than two of them.
      for (let i = 0; i < 2; i += 1) y = (under(boxAt(y))?.[1] ?? y + 2) - 2;
      const box = boxAt(y);
      if (box[1] < top || under(box)) return [];
      taken.push(box);
      return [{ label, x, y }];
    });
}

/**
 * The orders of the transmission error of `curve` that stand out of the noise, up to `last`.
 *
 * @type {(curve: { spectrum?: Pick<Spectrum, "order" | "transmission_error_um"> | null }, last?: number) => Point[]}
 */
export function ordersOf({ spectrum }, last = Infinity) {
  if (!spectrum) return [];
  const all = spectrum.order.map((order, i) => /** @type {Point} */ ([order, spectrum.transmission_error_um[i]]));
  return all.filter(([order, value]) => order > 0 && order <= last && value > LEAST_AMPLITUDE);
}

/**
 * The spectrum of a curve over the periods that were computed, where they are no whole true period: amplitudes of a
 * Hann window, whose lines are wider than those of the true spectrum, at orders per revolution of a driven gear of so
 * many teeth.
 *
 * @param {Curve} curve
 * @param {number} teeth
 * @param {number} last
 */
export function partialSpectrum(curve, teeth, last) {
  const values = curve.transmission_error_um;
  const count = values.length;
  const span = spanOf(curve);
  const window = values.map((_, i) => 0.5 - 0.5 * Math.cos((2 * Math.PI * i) / count));
  const weight = window.reduce((sum, w) => sum + w, 0);
  const mean = values.reduce((sum, value, i) => sum + window[i] * value, 0) / weight;
  /** @type {number[]} */
  const order = [];
  /** @type {number[]} */
  const amplitude = [];
  const most = Math.min(Math.floor(count / 2), Math.floor((last * span) / teeth), 4000);
  for (let k = 1; k <= most; k += 1) {
    // Each angle from the last one by a turn: as many cosines as there are points would take seconds.
    const [c, s] = [Math.cos((2 * Math.PI * k) / count), Math.sin((2 * Math.PI * k) / count)];
    let [x, y, re, im] = [1, 0, 0, 0];
    for (let i = 0; i < count; i += 1) {
      const value = window[i] * (values[i] - mean);
      re += value * x;
      im += value * y;
      [x, y] = [x * c - y * s, x * s + y * c];
    }
    order.push((k * teeth) / span);
    amplitude.push((2 * Math.hypot(re, im)) / weight);
  }
  return {
    order,
    transmission_error_um: amplitude,
    named: [{ order: teeth, label: "H_Z2", transmission_error_um: amplitude[Math.round(span) - 1] ?? 0 }],
  };
}

/** @type {(values: (number | null | undefined)[]) => [Point, Point] | null} */
const extremes = (values) => {
  const known = values.flatMap((value, i) =>
    value === null || value === undefined ? [] : [/** @type {Point} */ ([value, i])],
  );
  if (!known.length) return null;
  return [known.reduce((a, b) => (b[0] < a[0] ? b : a)), known.reduce((a, b) => (b[0] > a[0] ? b : a))];
};

/**
 * What a listener should know of a panel: how much, where, and how designs differ.
 *
 * @type {(panel: Panel, designs: NamedDesign[]) => string}
 */
export function wordsOf(panel, designs) {
  const told = linesOf(panel, designs).flatMap((line) => {
    const found = extremes(line.values);
    if (!found) return [];
    const [[least, i], [most, j]] = found;
    const range = `from ${number(least)} at position ${fixed(line.x[i], 2)} to ${number(most)} at ${fixed(line.x[j], 2)}, peak-to-peak ${shown({ printed: panel.unit, factor: 1 }, most - least)} ${panel.unit}`;
    return [`${line.name}: ${range}.`];
  });
  const gaps =
    panel.gaps && linesOf(panel, designs).some(({ values }) => values.includes(null))
      ? ` ${told.length ? panel.gaps : panel.none}`
      : "";
  return `${panel.title} over ${number(Math.max(...designs.map(({ results }) => spanOf(results.curves[0]))))} mesh periods, in ${panel.unit}. ${told.join(" ")}${gaps}`;
}

/**
 * The strongest orders of each design, in words.
 *
 * @type {(designs: NamedDesign[]) => string}
 */
export function wordsOfSpectrum(designs) {
  /** @type {(design: NamedDesign) => string} */
  const of = ({ name, results }) => {
    const [curve] = results.curves;
    if (!curve.spectrum) return `${name}: a part of the true period has no spectrum.`;
    const strongest = ordersOf(curve)
      .sort((a, b) => b[1] - a[1])
      .slice(0, 3);
    return `${name}: ${strongest.map(([order, value]) => `${number(value, 3)} µm at order ${number(order)}`).join(", ")}.`;
  };
  return `Strongest orders of the transmission error, per revolution of the driven gear. ${designs.map(of).join(" ")}`;
}

/**
 * What a curve has at its position `i`.
 *
 * @type {(curve: Curve, i: number) => string}
 */
export function wordsAt(curve, i) {
  const [pairs, pressure] = [curve.pairs_in_contact[i], curve.peak_contact_pressure_mpa[i]];
  const stressed = stresses(curve).map(
    ({ name, values }) => `${fixed(values[i], 1)} at a ${name.replace(",", " of the")}`,
  );
  const parts = [
    `Transmission error ${fixed(curve.transmission_error_um[i], 3)} µm`,
    `stiffness ${fixed(curve.mesh_stiffness_tangent_n_per_m[i] * 1e-6, 1)} N/µm`,
    `${pairs} ${pairs === 1 ? "pair" : "pairs"} in contact`,
    pressure === null ? "a tip corner carries" : `pressure ${fixed(pressure, 0)} MPa`,
  ];
  return `${parts.join(", ")}.${curve.stress ? ` Stress in MPa: ${stressed.join(", ")}.` : ""}`;
}
