// @ts-check
// A panel of the charts, and what all plots in panels have: size, axes, cursor, and the mark of the mesh position.

import uPlot from "../vendor/uplot.js";
import { h } from "./dom.js";
import { number } from "../state/numbers.js";

/** @import { FaceLoad } from "./face.js" */
/** @import { Looks } from "./looks.js" */
/** @import { NamedDesign } from "../state/documents.js" */
/** @import { OrderName, Panel } from "../state/series.js" */

/**
 * The file of uPlot has no types; those of its package are of the same version.
 *
 * @type {typeof import("uplot")}
 */
export const Plot = /** @type {any} */ (uPlot);

/** @typedef {import("uplot")} UPlot */

/** @typedef {import("uplot").AlignedData} Data */

/** @typedef {import("uplot").Options} Options */

/**
 * A panel with its elements and what is drawn in it: `shape` is what its plot was made for, `seen` says whether it is
 * in sight, and `late` whether it has to be drawn once it is. It is `absent` where no design has what it shows.
 *
 * @typedef {object} Own
 * @property {HTMLElement} canvas
 * @property {HTMLElement} legend
 * @property {HTMLElement} words
 * @property {HTMLElement} below
 * @property {HTMLElement} figure
 * @property {UPlot | null} plot
 * @property {HTMLElement | null} now
 * @property {string} shape
 * @property {number | null} width
 * @property {number} span
 * @property {boolean} seen
 * @property {boolean} late
 * @property {boolean} absent
 * @property {boolean} empty
 * @property {FaceLoad | null} face
 * @property {OrderName[]} names
 * @property {[number, number] | null} levels
 */

/** @typedef {Panel & Own} Drawn */

/**
 * What a panel is drawn from: the designs, the live one first; the mesh periods that are shown, or null for all; and
 * whether the spectrum has levels. `place` shows or hides a panel; `zoom` and `onPosition` hear what a pointer chooses.
 *
 * @typedef {object} View
 * @property {NamedDesign[]} designs
 * @property {Looks} colors
 * @property {[number, number] | null} range
 * @property {boolean} decibels
 * @property {(panel: Drawn, absent: boolean) => void} place
 * @property {(panel: Drawn) => number} widthOf
 * @property {(range: [number, number] | null) => void} zoom
 * @property {(position: number) => void} onPosition
 */

export const X_TITLE = "mesh position in mesh periods";

/**
 * The axes of all plots, that along the abscissa with its title.
 *
 * @param {Looks} colors
 * @param {string} title
 */
export function axesOf({ ink, grid, font, rem }, title) {
  const axis = {
    stroke: ink,
    font,
    grid: { stroke: grid, width: 1 },
    ticks: { stroke: grid, size: 4 },
    // As everywhere on the page, whichever language the browser has.
    values: (/** @type {unknown} */ _, /** @type {number[]} */ splits) => splits.map((value) => number(value, 6)),
  };
  return [
    { ...axis, label: title, labelFont: font, labelSize: 1.25 * rem, size: 1.9 * rem, space: 2.8 * rem },
    { ...axis, size: 3.6 * rem, space: 2.1 * rem },
  ];
}

/**
 * What all plots have.
 *
 * @param {Drawn} panel
 * @param {View} view
 * @param {string} title
 */
export const common = (panel, { colors, widthOf }, title) => ({
  width: widthOf(panel),
  height: colors.height,
  legend: { show: false },
  padding: /** @type {[number, number, number, number]} */ ([10, 14, 0, 0]),
  cursor: { y: false, points: { size: 7 }, drag: { x: true, y: false, setScale: false, dist: 6 } },
  axes: axesOf(colors, title),
});

/**
 * Shows data in a plot; one that was made for data of another shape is made anew by `make`.
 *
 * @param {Drawn} panel
 * @param {string} shape
 * @param {() => void} make
 * @param {(plot: UPlot) => void} renew
 */
export function draw(panel, shape, make, renew) {
  if (panel.shape === shape && panel.plot) return renew(panel.plot);
  clear(panel);
  make();
  panel.shape = shape;
}

/**
 * Takes the plot out of a panel.
 *
 * @param {Drawn} panel
 */
export function clear(panel) {
  panel.plot?.destroy();
  panel.canvas.replaceChildren();
  Object.assign(panel, { plot: null, now: null, shape: "" });
}

/**
 * Draws data over the mesh position, from one position to another: the pointer turns the gears and chooses what fills
 * the plot, and a mark shows where the gears are.
 *
 * @param {Drawn} panel
 * @param {View} view
 * @param {{ shape: string, data: Data, from: number, to: number, options: () => Partial<Options>, mark?: string }} how
 */
export function drawOverPositions(panel, view, { shape, data, from, to, options, mark = "now" }) {
  const make = () => {
    const own = options();
    const hooks = {
      ...own.hooks,
      setCursor: [(/** @type {UPlot} */ plot) => follow(plot, view.onPosition)],
      setSelect: [(/** @type {UPlot} */ plot) => select(plot, view.zoom)],
    };
    const made = { ...common(panel, view, X_TITLE), ...own, hooks };
    panel.plot = new Plot(/** @type {Options} */ (made), data, panel.canvas);
    panel.now = h("div", { className: mark });
    panel.plot.over.append(panel.now);
    panel.plot.over.addEventListener("dblclick", () => view.zoom(null));
  };
  draw(panel, shape, make, (plot) => plot.setData(data, false));
  panel.plot?.setScale("x", { min: from, max: to });
}

/**
 * The pointer over a curve turns the gears.
 *
 * @param {UPlot} plot
 * @param {View["onPosition"]} onPosition
 */
function follow(plot, onPosition) {
  const { left, event } = plot.cursor;
  if (left === undefined || left < 0 || !event || event.buttons) return;
  onPosition(plot.posToVal(left, "x"));
}

/**
 * A stretch of a curve that is drawn over with the pointer fills the plot.
 *
 * @param {UPlot} plot
 * @param {View["zoom"]} zoom
 */
function select(plot, zoom) {
  const { left, width } = plot.select;
  if (width < 6) return;
  const [from, to] = [plot.posToVal(left, "x"), plot.posToVal(left + width, "x")];
  plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
  zoom([from, to]);
}
