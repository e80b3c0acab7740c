// @ts-check
// The colors and letters of charts as the page looks now, and the piece of a line beside its name.

import { h, s } from "./dom.js";

/** @typedef {ReturnType<typeof looks>} Looks */

/** @typedef {{ look?: number, part?: number }} Colored */

/**
 * So many colors of designs are chosen; further ones go around the circle of hues by the golden angle, so that no two
 * are the same.
 */
const CHOSEN = 7;
/** @type {(look: number, lightness: string) => string} */
const further = (look, lightness) => `oklch(${lightness} ${0.1 + 0.03 * (look % 3)} ${(look * 137.508) % 360})`;

/**
 * The color of a line: of its design, or of the part that it is of, which never has that of a design.
 *
 * @type {(line: Colored, colors: Looks) => string}
 */
export const colorOf = ({ look, part }, colors) =>
  part === undefined ? colors.series(look ?? 0) : colors.parts[part % colors.parts.length];

/** The colors and letters of the page as it looks now. */
export function looks() {
  const style = getComputedStyle(document.documentElement);
  const rem = parseFloat(style.fontSize);
  /** @type {(name: string) => string} */
  const of = (name) => style.getPropertyValue(name).trim();
  return {
    ink: of("--ink"),
    grid: of("--grid"),
    faint: of("--faint"),
    accent: of("--accent"),
    panel: of("--panel"),
    series: (/** @type {number} */ look) =>
      look < CHOSEN ? of(`--series-${look + 1}`) : further(look, of("--lightness")),
    parts: ["--line-of-action", "--faint", "--steel-2-edge", "--steel-edge"].map(of),
    rem,
    height: parseFloat(of("--chart-height")),
    font: `${0.75 * rem}px system-ui, sans-serif`,
  };
}

/**
 * A piece of a line beside its name.
 *
 * @type {(line: Colored & { name: string, dash?: number[] }, colors: Looks) => HTMLElement}
 */
export function sample({ name, dash, ...line }, colors) {
  const color = colorOf(line, colors);
  const stroke = s("line", {
    x1: 0,
    x2: 36,
    y1: 4,
    y2: 4,
    stroke: color,
    "stroke-width": 2.5,
    "stroke-dasharray": dash?.length ? dash.join(" ") : null,
  });
  return h(
    "span",
    { className: "entry" },
    s("svg", { viewBox: "0 0 36 8", width: "2.25rem", height: "0.5rem", "aria-hidden": "true" }, stroke),
    name,
  );
}
