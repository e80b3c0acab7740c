// @ts-check
// The curves of a panel over the mesh position: one line for each design, or envelopes where many periods are shown.

import { h } from "./dom.js";
import { figure } from "./figure.js";
import { colorOf, sample } from "./looks.js";
import { clear, drawOverPositions, Plot, X_TITLE } from "./plot.js";
import { linesOf } from "../state/series.js";

/** @import { Parts } from "./figure.js" */
/** @import { Colored, Looks } from "./looks.js" */
/** @import { Data, Drawn, Options, View } from "./plot.js" */
/** @import { Line } from "../state/series.js" */

/** Where a mesh period has fewer pixels the curve is shown by its envelope. */
const LEAST_PIXELS = 14;

/**
 * Draws the curves of a panel.
 *
 * @param {Drawn} panel
 * @param {View} view
 */
export function drawCurves(panel, view) {
  const { designs, colors } = view;
  const all = linesOf(panel, designs);
  const crowded = all.length > 0 && isCrowded(all, view.range, view.widthOf(panel));
  const wanted = crowded && panel.whole ? linesOf(panel, designs, true) : all;
  view.place(panel, wanted.length === 0);
  if (!wanted.length) return;
  panel.empty = !wanted.some(({ values }) => values.some((value) => value !== null));
  panel.canvas.hidden = panel.empty;
  panel.below.hidden = !panel.gaps || !wanted.some(({ values }) => values.includes(null));
  panel.below.textContent = (panel.empty ? panel.none : panel.gaps) ?? "";
  if (panel.empty) {
    clear(panel);
    panel.width = null;
    return panel.legend.replaceChildren();
  }
  panel.span = Math.max(...wanted.map(({ span }) => span));
  const [from, to] = view.range ?? [0, panel.span];
  const lines = crowded
    ? wanted.flatMap((line) => envelopeOf(line, from, to))
    : wanted.map((line) => ({ ...line, at: closed(line), values: closedValues(line) }));
  const tables = lines.map((line) => /** @type {Data} */ ([line.at, line.values]));
  const data = Plot.join(
    tables,
    tables.map(() => [2]),
  );
  const shape = JSON.stringify([crowded, lines.map(({ name, look, dash }) => [name, look, dash])]);
  drawOverPositions(panel, view, { shape, data, from, to, options: () => optionsOf(lines, colors, crowded) });
  const note = crowded ? (panel.whole ? "that of most load; zoom in for each" : "envelope; zoom in") : panel.note;
  panel.legend.replaceChildren(
    ...(note ? [h("span", {}, note)] : []),
    ...(wanted.length > 1 && panel.ofLive && !panel.note ? wanted.map((line) => sample(line, colors)) : []),
  );
}

/**
 * The curves of a panel as a drawing.
 *
 * @param {Drawn} panel
 * @param {View} view
 * @param {Omit<Parts, "x"> & { width: number }} common
 */
export function figureOfCurves(panel, { designs, colors, range }, common) {
  const crowded = isCrowded(linesOf(panel, designs), range, common.width);
  const lines = linesOf(panel, designs, crowded).map((line) => ({
    ...line,
    color: colorOf(line, colors),
    x: closed(line),
    y: closedValues(line),
  }));
  return figure({ ...common, x: X_TITLE, lines, xRange: range });
}

/**
 * Whether so many mesh periods are shown that they cannot be told apart.
 *
 * @type {(lines: Line[], range: [number, number] | null, width: number) => boolean}
 */
function isCrowded(lines, range, width) {
  const [from, to] = range ?? [0, Math.max(...lines.map(({ span }) => span))];
  return to - from > Math.floor(width / LEAST_PIXELS);
}

/**
 * What a plot of lines has, or of the envelopes that they are where many periods are shown.
 *
 * @param {(Colored & { name: string, dash: number[] })[]} lines
 * @param {Looks} colors
 * @param {boolean} crowded
 * @returns {Partial<Options>}
 */
function optionsOf(lines, colors, crowded) {
  /** @type {(line: Colored) => string} */
  const between = (line) => `color-mix(in srgb, ${colorOf(line, colors)} 35%, transparent)`;
  const envelopes = crowded ? lines.filter((_, i) => i % 2 === 0) : [];
  return {
    scales: { x: { time: false, auto: false }, y: { range: yRange } },
    series: [
      {},
      ...lines.map(({ name, dash, ...line }) => ({
        label: name,
        stroke: colorOf(line, colors),
        width: (crowded ? 0.05 : 0.1) * colors.rem,
        dash: crowded ? [] : dash,
        points: { show: false },
        spanGaps: false,
      })),
    ],
    bands: envelopes.map((line, i) => ({ series: [2 * i + 1, 2 * i + 2], fill: between(line) })),
  };
}

/**
 * The positions of a line with the end of its span, where the first comes again.
 *
 * @type {(line: Line) => number[]}
 */
function closed({ x, span }) {
  return [...x, x[0] + span];
}

/** @type {(line: Line) => (number | null)[]} */
const closedValues = ({ values, open }) => [...values, open ? null : values[0]];

/**
 * The most and the least of each mesh period of a line: two lines.
 *
 * @type {(line: Line, from: number, to: number) => (Line & { at: number[] })[]}
 */
function envelopeOf(line, from, to) {
  /** @type {[number, number][]} */
  const periods = [];
  line.x.forEach((x, i) => {
    const value = line.values[i];
    const period = Math.floor(x + 1e-9);
    if (value === null || period < from - 1 || period > to) return;
    const known = periods[period] ?? [Infinity, -Infinity];
    periods[period] = [Math.min(known[0], value), Math.max(known[1], value)];
  });
  const at = Object.keys(periods).map((period) => Number(period) + 0.5);
  const bounds = Object.values(periods);
  return [1, 0].map((side) => ({ ...line, at, values: bounds.map((each) => each[side]) }));
}

/** @type {import("uplot").Range.Function} */
function yRange(_, least, most) {
  if (least === null || most === null) return [0, 1];
  const room = Math.max((most - least) * 0.08, Math.abs(most) * 1e-4, 1e-9);
  return [least === 0 ? 0 : least - room, most + room];
}
