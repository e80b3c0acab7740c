// One page of paper: the drawing, the answers, the geometry, the curves, warnings and evidence. It is printed, and saved as a picture.

import { number, s } from "./dom.js";
import { drawingOf } from "./download.js";
import { rowsOf } from "./geometry.js";
import { ANSWERS } from "./headline.js";

/** A4, four units a millimeter. */
const [WIDTH, HEIGHT] = [840, 1188];
const MARGIN = 48;
const FONT = "system-ui, sans-serif";

const words = (text, x, y, more = {}) => Object.assign(s("text", { x, y, "font-family": FONT, "font-size": 11, fill: "#1d2229", ...more }), { textContent: text });

/** Text in lines of so many letters. */
function wrapped(text, most) {
  const lines = [""];
  for (const word of text.split(" ")) {
    if (lines.at(-1).length + word.length + 1 > most && lines.at(-1)) lines.push("");
    lines[lines.length - 1] = `${lines.at(-1)} ${word}`.trim();
  }
  return lines;
}

/** Does `work` while the page has its light colors, which paper has. */
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

/** The page of the live design: `drawing` is its element, `charts` give the curves. */
export function sheetOf({ live, drawing, charts }) {
  const { results, submission, name } = live;
  const [curve] = results.curves;
  const page = s("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, width: WIDTH, height: HEIGHT, role: "img", "aria-label": `Report of ${name}`, xmlns: "http://www.w3.org/2000/svg" }, s("rect", { width: WIDTH, height: HEIGHT, fill: "#fff" }));
  const right = WIDTH - MARGIN;
  page.append(words(name, MARGIN, 58, { "font-size": 18, "font-weight": 600 }), words(`${number(curve.output_torque_n_m)} N m, ${results.method.replace(/_/g, " ")}`, MARGIN, 76), words(new Date().toISOString().slice(0, 10), right, 58, { "text-anchor": "end" }), words(results.evidence.solver_version.replace(/^m/, "M"), right, 76, { "text-anchor": "end" }));

  const picture = inLight(() => drawingOf(drawing));
  const box = picture.viewBox.baseVal;
  const height = Math.min(230, (430 * box.height) / box.width);
  for (const [attribute, value] of Object.entries({ x: MARGIN, y: 90, width: 430, height })) picture.setAttribute(attribute, value);
  page.append(picture);

  let y = 104;
  for (const answer of ANSWERS) {
    const value = answer.of(curve);
    if (value === null) continue;
    page.append(words(answer.name, 510, y), words(`${answer.print(value)} ${answer.unit}`, right, y, { "text-anchor": "end", "font-weight": 600 }));
    y += 17;
  }
  const { gears, both } = rowsOf(live);
  y += 8;
  for (const [row, symbol, unit, value] of both) {
    page.append(words(`${row}${symbol ? `, ${symbol}` : ""}`, 510, y, { "font-size": 10 }), words(`${value} ${unit}`, right, y, { "text-anchor": "end", "font-size": 10 }));
    y += 13.5;
  }

  let told = Math.max(352, y + 14);
  y = 352;
  page.append(words("Driving", 330, y, { "text-anchor": "end", "font-weight": 600 }), words("Driven", 420, y, { "text-anchor": "end", "font-weight": 600 }));
  for (const [row, symbol, unit, driving, driven] of gears) {
    y += 14.5;
    page.append(words(`${row}${symbol ? `, ${symbol}` : ""}`, MARGIN, y, { "font-size": 10 }), words(driving, 330, y, { "text-anchor": "end", "font-size": 10 }), words(driven, 420, y, { "text-anchor": "end", "font-size": 10 }), words(unit, 428, y, { "font-size": 10, fill: "#5b6470" }));
  }

  page.append(words("Warnings", 510, told, { "font-weight": 600 }));
  const warnings = results.warnings.length ? results.warnings.map(({ detail }) => detail) : ["None."];
  for (const line of warnings.flatMap((warning) => wrapped(warning, 52)).slice(0, 14)) page.append(words(line, 510, (told += 13), { "font-size": 9.5 }));
  told += 22;
  page.append(words("Evidence", 510, told, { "font-weight": 600 }));
  const { evidence } = results;
  const lines = [
    `degrees of freedom ${evidence.degrees_of_freedom}`, `equilibrium residual ${number(evidence.equilibrium_residual, 2)}`,
    `largest penetration ${number(evidence.largest_penetration_um, 2)} µm`,
    ...wrapped(`input ${evidence.input_hash}`.replace(/([0-9a-f]{32})/g, "$1 "), 52),
    ...wrapped(`does not see: ${(evidence.does_not_see ?? []).join("; ")}`, 52).slice(0, 8),
  ];
  for (const line of lines) page.append(words(line, 510, (told += 13), { "font-size": 9.5 }));

  const top = Math.max(y, told) + 24;
  const [w, h] = [(WIDTH - 2 * MARGIN) / 2, (HEIGHT - top - 40) / 2];
  const figures = inLight(() => charts.figures({ width: 520, height: Math.round((520 * h) / w), ids: ["ste", curve.face ? "face" : "stiffness", "pressure", "spectrum"] }));
  figures.forEach((figure, i) => {
    for (const [attribute, value] of Object.entries({ x: MARGIN + (i % 2) * w, y: top + Math.floor(i / 2) * h, width: w - 8, height: h - 6 })) figure.setAttribute(attribute, value);
    page.append(figure);
  });
  page.append(words(`${submission.tags?.join(", ") ?? ""} ${location.origin}`.trim(), MARGIN, HEIGHT - 18, { "font-size": 9, fill: "#5b6470" }));
  return page;
}
