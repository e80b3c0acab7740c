// @ts-check
// The report of a project on paper: the data sheet with materials, the one page of the design, its kept designs beside
// it, curves, spectrum, contact pattern, run-up, robustness, warnings and evidence.

import { looks } from "../draw/looks.js";
import { h, table, tableRow } from "../draw/dom.js";
import { drawingOf } from "../draw/download.js";
import { figure } from "../draw/figure.js";
import { differences, flattened, MEMBERS, told } from "../state/design.js";
import { markOf } from "../state/marks.js";
import { fixed, number } from "../state/numbers.js";
import { calledOf, shown } from "../state/quantities.js";
import { DASHES } from "../state/series.js";
import { columnsOf, toldBy } from "./compare.js";
import { inLight, sheetOf } from "./sheet.js";

/** @import { Charts } from "../draw/charts.js" */
/** @import { NamedDesign, Submission } from "../state/documents.js" */
/** @import { Form } from "./form.js" */

/**
 * The words of the title block, as they were typed.
 *
 * @typedef {{ name: string, author: string, drawing: string, notes: string }} Title
 */

/**
 * An answer on the page that the report takes: what it is called, where it stands, and whether the design is another
 * one now.
 *
 * @typedef {{ title: string, place: Element, isOutdated: boolean }} Answer
 */

/**
 * The sources of a report: the live design and those beside it, their drawing and charts, the form, which knows the
 * fields, what a field is where a submission does not give it, and the answers on the page.
 *
 * @typedef {{ title: Title, live: NamedDesign, designs: NamedDesign[], drawing: SVGSVGElement, charts: Charts,
 *   form: Form, usual: (submission: Submission, pointer: string) => unknown, contact: Element,
 *   answers: Answer[] }} Parts
 */

/** The fields of a material in the data sheet, whether they are given or not. */
const OF_MATERIAL = ["name", "youngs_modulus_gpa", "poisson_ratio", "density_kg_m3"].map((name) => `material/${name}`);
/** Curves on the page of them; the face and the spectrum stand alone in a row. */
const [CURVE, WIDE] = [
  { width: 520, height: 300 },
  { width: 1060, height: 330 },
];
const IN_A_ROW = ["spectrum", "face"];
/** The number of resonances in the table: the largest. */
const RESONANCES = 15;

/** @type {(title: string, ...children: (string | Node | null)[]) => HTMLElement} */
const section = (title, ...children) => h("section", {}, h("h2", {}, title), ...children);

/**
 * The report, as what stands in the sheet one after another.
 *
 * @type {(parts: Parts) => Element[]}
 */
export function reportOf(parts) {
  const { live, designs } = parts;
  const seen = designs.filter(({ hidden }) => !hidden);
  return [
    titleOf(parts),
    section("Data sheet", dataOf(parts)),
    sheetOf(parts),
    ...(seen.length > 1 ? [section("Designs", designsOf(seen, parts))] : []),
    section("Curves and spectrum", curvesOf(parts.charts)),
    ...contactOf(parts.contact),
    ...runUpOf(seen),
    ...answersOf(parts.answers),
    section("Warnings", warningsOf(live, parts.form)),
    section("Evidence", evidenceOf(live)),
  ];
}

/**
 * The title block, with the drawing.
 *
 * @param {Parts} parts
 */
function titleOf({ title, live, drawing }) {
  const { curves, method, evidence } = live.results;
  const torques = curves.map(({ output_torque_n_m: torque }) => number(torque, 6)).join(", ");
  const rows = [
    ["Design", live.name],
    ["Drawing number", title.drawing || "–"],
    ["Author", title.author || "–"],
    ["Date", new Date().toISOString().slice(0, 10)],
    ["Output torque", `${torques} N m`],
    ["Method", method.replace(/_/g, " ")],
    ["Version", evidence.solver_version.replace(/^m/, "M")],
  ];
  return h(
    "section",
    { className: "title" },
    h("h1", {}, title.name || live.name),
    h(
      "div",
      { className: "title-block" },
      table(
        [],
        rows.map(([name, value]) => tableRow(name, value)),
      ),
      inLight(() => drawingOf(drawing)),
    ),
    ...(title.notes ? [h("p", { className: "typed" }, title.notes)] : []),
  );
}

/**
 * The fields of the submission: those of the gears side by side, then those of the pair and the load.
 *
 * @param {Parts} parts
 */
function dataOf({ live: { submission }, form, usual }) {
  const flat = flattened(submission);
  const names = new Set(OF_MATERIAL);
  for (const pointer of flat.keys()) {
    const name = /^\/pair\/(?:driving|driven)\/(.+)$/.exec(pointer)?.[1];
    if (name) names.add(name);
  }
  /** @type {(pointer: string) => string} */
  const valueOf = (pointer) => {
    const value = flat.get(pointer) ?? usual(submission, pointer) ?? null;
    return value === null ? "–" : told(value);
  };
  const isOfMaterial = (/** @type {string} */ name) => name.startsWith("material/");
  const all = [...names].filter((name) => !isOfMaterial(name)).concat([...names].filter(isOfMaterial));
  const ofGears = all.map((name) => {
    const pointer = `/pair/driving/${name}`;
    const title = form.names.named(pointer).replace(/, driving gear$/, "");
    return tableRow(title, ...MEMBERS.map((gear) => valueOf(`/pair/${gear}/${name}`)), form.names.unitOf(pointer));
  });
  const others = [...flat].filter(([pointer]) => !/^\/pair\/(driving|driven)\//.test(pointer));
  const ofPair = others.map(([pointer, value]) =>
    tableRow(form.names.named(pointer), told(value), form.names.unitOf(pointer)),
  );
  return h(
    "div",
    {},
    table(["", "Driving", "Driven", ""], ofGears, "Gears"),
    table(["", "", ""], ofPair, "Pair, load and method"),
  );
}

/**
 * The numbers of designs beside each other, and the fields in which they differ.
 *
 * @param {NamedDesign[]} designs
 * @param {Parts} parts
 */
function designsOf(designs, { form, usual }) {
  const columns = columnsOf(designs);
  const heads = columns.map(({ name, curve }) => `${name}, ${number(curve.output_torque_n_m, 6)} N m`);
  const numbers = toldBy(columns).map(({ quantity, values }) =>
    tableRow(
      `${calledOf(quantity)} ${quantity.printed}`,
      ...values.map((value, i) => {
        const mark = value === undefined ? undefined : markOf(quantity.name, columns[i].results.warnings);
        return mark ? `${shown(quantity, value)} (${mark.word})` : shown(quantity, value);
      }),
    ),
  );
  const differing = differences(designs.map(({ submission }) => submission))
    .map(({ pointer, values }) => ({
      pointer,
      values: values.map((value, i) => told(value ?? usual(designs[i].submission, pointer))),
    }))
    .filter(({ pointer, values }) => pointer !== "/tags" && values.some((value) => value !== values[0]))
    .map(({ pointer, values }) => tableRow(form.names.titled(pointer), ...values));
  return h(
    "div",
    {},
    table(["", ...heads], numbers, "Numbers"),
    table(["", ...designs.map(({ name }) => name)], differing, "Fields in which they differ"),
  );
}

/** @param {Charts} charts */
function curvesOf(charts) {
  return inLight(() => {
    const narrow = charts.figures(CURVE, (id) => !IN_A_ROW.includes(id));
    const wide = charts.figures(WIDE, (id) => IN_A_ROW.includes(id));
    for (const each of wide) each.classList.add("wide");
    return h("div", { className: "figures" }, ...narrow, ...wide);
  });
}

/**
 * A part of the page as it is printed: without what is pressed and typed, and without the names of its elements.
 *
 * @param {Element} place
 */
function printed(place) {
  const copy = /** @type {Element} */ (place.cloneNode(true));
  for (const each of copy.querySelectorAll("button, input, select, label, [hidden]")) each.remove();
  for (const each of [copy, ...copy.querySelectorAll("[id]")]) {
    // What a pattern is called is what fills ask for.
    if (!(each instanceof SVGPatternElement)) each.removeAttribute("id");
  }
  for (const each of copy.querySelectorAll("[tabindex]")) each.removeAttribute("tabindex");
  return copy;
}

/**
 * The contact pattern, where it is computed.
 *
 * @param {Element} place
 */
function contactOf(place) {
  return place.querySelector(".flank") ? [section("Contact pattern", printed(place))] : [];
}

/**
 * The run-ups: the peak-to-peak motion over speed, and the resonances of the live design.
 *
 * @param {NamedDesign[]} designs
 */
function runUpOf(designs) {
  const [live] = designs;
  const resonances = live.results.curves[0].dynamics?.resonances;
  if (!resonances) return [];
  const colors = inLight(looks);
  const lines = designs.flatMap(({ name, look, results }) => {
    const { dynamics } = results.curves[0];
    return /** @type {const} */ (["up", "down"]).flatMap((way) => {
      const branch = dynamics?.[way];
      if (!dynamics || !branch) return [];
      return {
        name: `${name}, running ${way}`,
        color: colors.series(look),
        dash: way === "down" ? DASHES[1] : [],
        x: dynamics.driving_speed_rpm,
        y: branch.dynamic_transmission_error_um.peak_to_peak,
      };
    });
  });
  const picture = figure({
    lines,
    x: "driving speed in rpm",
    y: "dynamic STE, peak-to-peak, in µm",
    title: "Run-up",
    colors,
    ...WIDE,
  });
  picture.classList.add("wide");
  const largest = resonances.toSorted((one, other) => other.amplitude_um - one.amplitude_um).slice(0, RESONANCES);
  const rows = largest.map(
    ({ label, order, excited, driving_speed_rpm: speed, frequency_hz: hertz, amplitude_um: most }) =>
      tableRow(label, number(order), excited, fixed(speed, 0), fixed(hertz, 0), number(most, 3)),
  );
  const left = resonances.length - rows.length;
  const rest = left > 0 ? h("p", {}, `${left} smaller ones are in the results.`) : null;
  const names = ["Resonance", "order", "excited", "rpm", "Hz", "amplitude in µm"];
  const found = rows.length ? table(names, rows) : null;
  return [section("Run-up", h("div", { className: "figures" }, picture), found, rest)];
}

/**
 * The answers about the robustness, as far as they are there.
 *
 * @param {Answer[]} answers
 */
function answersOf(answers) {
  const found = answers.filter(({ place }) => place.children.length);
  if (!found.length) return [];
  const parts = found.flatMap(({ title, place, isOutdated }) => [
    h("h3", {}, title),
    isOutdated ? h("p", {}, "Of the design as it was before its last changes.") : null,
    printed(place),
  ]);
  return [section("Robustness", ...parts)];
}

/**
 * @param {NamedDesign} live
 * @param {Form} form
 */
const warningsOf = ({ results: { warnings } }, form) =>
  warnings.length
    ? h("ul", {}, ...warnings.map(({ detail }) => h("li", {}, form.names.inWords(detail))))
    : h("p", {}, "None.");

/** @param {NamedDesign} live */
function evidenceOf({ results: { evidence } }) {
  const rows = [
    ["Degrees of freedom", String(evidence.degrees_of_freedom)],
    ["Equilibrium residual", number(evidence.equilibrium_residual, 2)],
    ["Largest penetration", `${number(evidence.largest_penetration_um, 2)} µm`],
    ["Input", evidence.input_hash],
    ["Does not see", (evidence.does_not_see ?? []).join("; ") || "–"],
    ["Computed at", location.origin],
  ];
  return table(
    [],
    rows.map(([name, value]) => tableRow(name, value)),
  );
}

/**
 * Words as a text of a style sheet.
 *
 * @type {(words: string) => string}
 */
const quoted = (words) => `"${words.replace(/[^\w ]/gu, (letter) => `\\${letter.codePointAt(0)?.toString(16)} `)}"`;

const footer = new CSSStyleSheet();
document.adoptedStyleSheets.push(footer);

/**
 * Puts the title into the foot of every page of paper.
 *
 * @param {Title} title
 */
export function nameFoot({ name, drawing, author }) {
  const words = [name, drawing, author].filter(Boolean).join(", ");
  footer.replaceSync(`@page { @bottom-left { content: ${quoted(words)}; font: 8pt system-ui, sans-serif; } }`);
}
