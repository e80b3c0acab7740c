// @ts-check
// The load of the live design along its face: a map over every position, or the mean over them.

import { button, h } from "./dom.js";
import { cellsOf, cssOf, faceOf, SCALE, scaleOf } from "./face.js";
import { figure, roomIn } from "./figure.js";
import { axesOf, clear, drawOverPositions, X_TITLE } from "./plot.js";
import { fixed, number } from "../state/numbers.js";

/** @import { FaceLoad } from "./face.js" */
/** @import { Parts } from "./figure.js" */
/** @import { Looks } from "./looks.js" */
/** @import { Data, Drawn, Options, UPlot, View } from "./plot.js" */
/** @import { NamedDesign } from "../state/documents.js" */
/** @import { Panel } from "../state/series.js" */

/**
 * The load along the face of the live design, null where its method does not tell it.
 *
 * @type {(designs: NamedDesign[]) => FaceLoad | null}
 */
export const faceOfLive = ([live]) => faceOf(live.results.curves[0]);

/**
 * Draws the load along the face; `onEveryPosition` is told that it is wanted at every position.
 *
 * @param {Drawn} panel
 * @param {View} view
 * @param {() => void} onEveryPosition
 */
export function drawFace(panel, view, onEveryPosition) {
  const face = faceOfLive(view.designs);
  view.place(panel, !face);
  if (!face) return;
  panel.below.hidden = face.every;
  panel.legend.replaceChildren(
    h("span", {}, `K_Hβ ${fixed(face.factor, 3)}`),
    face.every ? scaleOf(face.most) : h("span", {}, "mean over the positions"),
  );
  if (!face.every) return drawMean(panel, face, onEveryPosition);
  panel.span = face.span;
  panel.face = face;
  const [from, to] = view.range ?? [0, face.span];
  /** @type {Data} */
  const data = [[...face.positions, face.positions[0] + face.span], Array(face.positions.length + 1).fill(null)];
  drawOverPositions(panel, view, {
    shape: `every ${face.edges[0]} ${face.edges.at(-1)}`,
    data,
    from,
    to: Math.min(to, face.span),
    options: () => optionsOf(panel, view.colors),
    mark: "now on-map",
  });
}

/**
 * @param {Drawn} panel
 * @param {FaceLoad} face
 * @param {() => void} onEveryPosition
 */
function drawMean(panel, face, onEveryPosition) {
  clear(panel);
  const { title, unit } = panel;
  panel.canvas.append(figureOfFace(face, { title, y: `${title} in ${unit}`, width: roomIn(panel.canvas), panel }));
  panel.below.replaceChildren(
    "How it changes while the teeth pass is told where every position is asked for. ",
    button("Show every position", onEveryPosition),
  );
}

/**
 * What the plot of a map has.
 *
 * @param {Drawn} panel
 * @param {Looks} colors
 * @returns {Partial<Options>}
 */
function optionsOf(panel, colors) {
  const [across, along] = axesOf(colors, X_TITLE);
  const named = { label: "z in mm", labelFont: colors.font, labelSize: 1.25 * colors.rem, size: 2.6 * colors.rem };
  return {
    scales: { x: { time: false, auto: false }, y: { range: () => rangeOf(panel.face) } },
    axes: [across, { ...along, ...named }].map((axis) => ({ ...axis, grid: { show: false } })),
    series: [{}, { label: panel.title, paths: () => null, points: { show: false } }],
    hooks: { drawClear: [(plot) => panel.face && drawCells(plot, panel.face)] },
  };
}

/**
 * The heights of a face.
 *
 * @type {(face: FaceLoad | null) => [number, number]}
 */
const rangeOf = (face) => (face ? [face.edges[0], face.edges[face.edges.length - 1]] : [0, 1]);

/**
 * Paints the map of the load along a face between the axes of `plot`.
 *
 * @param {UPlot} plot
 * @param {FaceLoad} face
 */
function drawCells(plot, face) {
  const { ctx, bbox } = plot;
  const { min = 0, max = 0 } = plot.scales.x;
  ctx.save();
  ctx.beginPath();
  ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
  ctx.clip();
  for (const { x, width, z, height, part } of cellsOf(face, [min, max], (max - min) / bbox.width)) {
    const [left, right, foot, top] = [
      plot.valToPos(x, "x", true),
      plot.valToPos(x + width, "x", true),
      plot.valToPos(z, "y", true),
      plot.valToPos(z + height, "y", true),
    ];
    ctx.fillStyle = cssOf(part);
    // No seams where edges lie between pixels.
    ctx.fillRect(left, top, right - left + 0.6, foot - top + 0.6);
  }
  ctx.restore();
}

/**
 * The load along a face as a drawing: the map, or the mean.
 *
 * @param {FaceLoad} face
 * @param {Omit<Parts, "x"> & { panel: Panel, color?: string }} how
 */
export function figureOfFace(face, { panel, xRange = null, color, ...common }) {
  if (!face.every) return figure({ ...common, x: "z in mm", lines: [{ x: face.z, y: face.rows[0], color }] });
  const [from, to] = xRange ?? [0, face.span];
  // As many cells as can be seen: each position of a long period would make a file of megabytes.
  const cells = cellsOf(face, [from, to], (to - from) / (common.width ?? 1)).map(({ z, part, ...cell }) => ({
    ...cell,
    y: z,
    color: cssOf(part),
  }));
  return figure({
    ...common,
    title: `${panel.title}, K_Hβ ${fixed(face.factor, 3)}`,
    x: X_TITLE,
    y: "z in mm",
    cells,
    scale: { colors: SCALE, words: ["0", `${number(face.most, 3)} ${panel.unit}`] },
  });
}
