// @ts-check
// One page of paper: the drawing, the answers, the geometry, the curves, warnings and evidence. It is printed, and
// saved as a picture.

import { dress, s } from "../draw/dom.js";
import { drawingOf } from "../draw/download.js";
import { flattened, told } from "../state/design.js";
import { number } from "../state/numbers.js";
import { rowsOf } from "./geometry.js";
import { ANSWERS, valueOf } from "./headline.js";

/** @import { Charts } from "../draw/charts.js" */
/** @import { NamedDesign, Submission } from "../state/documents.js" */
/** @import { Form } from "./form.js" */

/** A4, four units a millimeter. */
const [WIDTH, HEIGHT] = [840, 1188];
const MARGIN = 48;
const FONT = "system-ui, sans-serif";
/** Fields that stand in the tables, and names of what stands beside them. */
const IN_TABLES =
  /\/(tooth_count|module_mm|profile_shift|face_width_mm|center_distance_mm|helix_angle_deg|method|kind|tags)$/;
/** So many letters have room in a line of the right column, and of the left one. */
const [SIDE, LEFT] = [60, 92];

/** @type {(text: string, x: number, y: number, more?: Record<string, string | number>) => SVGTextElement} */
const words = (text, x, y, more = {}) =>
  Object.assign(s("text", { x, y, "font-family": FONT, "font-size": 11, fill: "#1d2229", ...more }), {
    textContent: text,
  });

/**
 * Text in lines of so many letters.
 *
 * @type {(text: string, most: number) => string[]}
 */
function wrapped(text, most) {
  const lines = [""];
  for (const word of text.split(" ")) {
    const last = lines[lines.length - 1];
    if (last && last.length + word.length + 1 > most) lines.push(word);
    else lines[lines.length - 1] = `${last} ${word}`.trim();
  }
  return lines;
}

/**
 * As many of `lines` as there is room for; that some were left out is said in place of the last.
 *
 * @type {(lines: string[], most: number) => string[]}
 */
const fitting = (lines, most) =>
  lines.length > most
    ? [...lines.slice(0, most - 1), `… and ${lines.length - most + 1} lines more, in the results`]
    : lines;

/**
 * What a submission gives that no table of the sheet has, a text for each gear and one for the rest.
 *
 * @type {(submission: Submission, form: Form) => string[]}
 */
function givenOf(submission, form) {
  const fields = [...flattened(submission)].filter(([pointer]) => !IN_TABLES.test(pointer));
  const parts = [
    ["Driving gear", ", driving gear"],
    ["Driven gear", ", driven gear"],
    ["Pair and method", ""],
  ];
  /** @type {(pointer: string) => number} */
  const partOf = (pointer) => parts.findIndex(([, end]) => form.names.named(pointer).endsWith(end));
  return parts.flatMap(([title, end], i) => {
    const own = fields
      .filter(([pointer]) => partOf(pointer) === i)
      .map(([pointer, value]) =>
        `${form.names.named(pointer).slice(0, -end.length || undefined)} ${told(value)} ${form.names.unitOf(pointer)}`.trim(),
      );
    return own.length ? [`${title}: ${own.join("; ")}.`] : [];
  });
}

/**
 * Does `work` while the page has its light colors, which paper has.
 *
 * @template T
 * @param {() => T} work
 */
export function inLight(work) {
  const root = document.documentElement;
  const before = root.dataset.theme;
  root.dataset.theme = "light";
  try {
    return work();
  } finally {
    if (before) root.dataset.theme = before;
    else delete root.dataset.theme;
  }
}

/**
 * The page of the live design: `drawing` is its element, `charts` give the curves, `form` knows the fields by their
 * names.
 *
 * @type {(parts: { live: NamedDesign, drawing: SVGSVGElement, charts: Charts, form: Form }) => SVGSVGElement}
 */
export function sheetOf({ live, drawing, charts, form }) {
  const { results, submission, name } = live;
  const [curve] = results.curves;
  const page = s(
    "svg",
    {
      viewBox: `0 0 ${WIDTH} ${HEIGHT}`,
      width: WIDTH,
      height: HEIGHT,
      role: "img",
      "aria-label": `Report of ${name}`,
      xmlns: "http://www.w3.org/2000/svg",
    },
    s("rect", { width: WIDTH, height: HEIGHT, fill: "#fff" }),
  );
  const right = WIDTH - MARGIN;
  page.append(
    words(name, MARGIN, 58, { "font-size": 18, "font-weight": 600 }),
    words(`${number(curve.output_torque_n_m)} N m, ${results.method.replace(/_/g, " ")}`, MARGIN, 76),
    words(new Date().toISOString().slice(0, 10), right, 58, { "text-anchor": "end" }),
    words(results.evidence.solver_version.replace(/^m/, "M"), right, 76, { "text-anchor": "end" }),
  );

  const picture = inLight(() => drawingOf(drawing));
  const box = picture.viewBox.baseVal;
  const height = Math.min(230, (430 * box.height) / box.width);
  dress(picture, { x: MARGIN, y: 90, width: 430, height });
  page.append(picture);

  let y = 104;
  for (const answer of ANSWERS) {
    const value = valueOf(answer, curve);
    if (value === null) continue;
    page.append(
      words(answer.name, 510, y),
      words(`${answer.print(value)} ${answer.unit}`, right, y, { "text-anchor": "end", "font-weight": 600 }),
    );
    y += 17;
  }
  const { gears, both } = rowsOf(live);
  y += 8;
  for (const [row, symbol, unit, value] of both) {
    page.append(
      words(`${row}${symbol ? `, ${symbol}` : ""}`, 510, y, { "font-size": 10 }),
      words(`${value} ${unit}`, right, y, { "text-anchor": "end", "font-size": 10 }),
    );
    y += 13.5;
  }

  let down = Math.max(352, y + 14);
  y = 352;
  page.append(
    words("Driving", 330, y, { "text-anchor": "end", "font-weight": 600 }),
    words("Driven", 420, y, { "text-anchor": "end", "font-weight": 600 }),
  );
  for (const [row, symbol, unit, driving, driven] of gears) {
    y += 14.5;
    page.append(
      words(`${row}${symbol ? `, ${symbol}` : ""}`, MARGIN, y, { "font-size": 10 }),
      words(driving, 330, y, { "text-anchor": "end", "font-size": 10 }),
      words(driven, 420, y, { "text-anchor": "end", "font-size": 10 }),
      words(unit, 428, y, { "font-size": 10, fill: "#5b6470" }),
    );
  }

  page.append(words("Warnings", 510, down, { "font-weight": 600 }));
  const warnings = results.warnings.length
    ? results.warnings.map(({ detail }) => form.names.inWords(detail))
    : ["None."];
  for (const line of fitting(
    warnings.flatMap((warning) => wrapped(warning, SIDE)),
    18,
  ))
    page.append(words(line, 510, (down += 11.5), { "font-size": 8.5 }));
  down += 20;
  page.append(words("Evidence", 510, down, { "font-weight": 600 }));
  const { evidence } = results;
  const lines = [
    `degrees of freedom ${evidence.degrees_of_freedom}`,
    `equilibrium residual ${number(evidence.equilibrium_residual, 2)}`,
    `largest penetration ${number(evidence.largest_penetration_um, 2)} µm`,
    ...wrapped(`input ${evidence.input_hash}`.replace(/([0-9a-f]{32})/g, "$1 "), SIDE),
    ...fitting(wrapped(`does not see: ${(evidence.does_not_see ?? []).join("; ")}`, SIDE), 16),
  ];
  for (const line of lines) page.append(words(line, 510, (down += 11.5), { "font-size": 8.5 }));

  y += 20;
  page.append(words("Given besides", MARGIN, y, { "font-weight": 600 }));
  for (const line of fitting(
    givenOf(submission, form).flatMap((part) => wrapped(part, LEFT)),
    10,
  ))
    page.append(words(line, MARGIN, (y += 11.5), { "font-size": 8.5 }));

  const top = Math.max(y, down) + 20;
  const [w, h] = [(WIDTH - 2 * MARGIN) / 2, (HEIGHT - top - 40) / 2];
  const pressed = curve.peak_contact_pressure_mpa.some((value) => value !== null);
  const ids = [
    "ste",
    curve.face ? "face" : "stiffness",
    pressed ? "pressure" : curve.face ? "stiffness" : "share",
    "spectrum",
  ];
  const figures = inLight(() =>
    charts.figures({ width: 520, height: Math.round((520 * h) / w) }, (id) => ids.includes(id)),
  );
  figures.forEach((figure, i) => {
    dress(figure, { x: MARGIN + (i % 2) * w, y: top + Math.floor(i / 2) * h, width: w - 8, height: h - 6 });
    page.append(figure);
  });
  page.append(
    words(`${submission.tags?.join(", ") ?? ""} ${location.origin}`.trim(), MARGIN, HEIGHT - 18, {
      "font-size": 9,
      fill: "#5b6470",
    }),
  );
  return page;
}
