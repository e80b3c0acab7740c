// @ts-check
// The spectrum of the transmission error: a stem for each order, in amplitudes or levels, the largest of them named.

import { figure } from "./figure.js";
import { sample } from "./looks.js";
import { common, draw, Plot } from "./plot.js";
import { extent, number } from "../state/numbers.js";
import { namesOf, ordersOf, partialSpectrum, placedNames } from "../state/series.js";

/** @import { Parts } from "./figure.js" */
/** @import { Looks } from "./looks.js" */
/** @import { Data, Drawn, Options, UPlot, View } from "./plot.js" */
/** @import { NamedDesign } from "../state/documents.js" */
/** @import { OrderName, Panel, Point } from "../state/series.js" */

/**
 * @typedef {{ name: string, look: number, partial: boolean, orders: Point[],
 *   named: { order: number, label: string, transmission_error_um: number }[] }} DesignSpectrum
 */

/** @type {Panel} */
export const SPECTRUM = { id: "spectrum", question: "noise", title: "Spectrum of the transmission error", unit: "µm" };
/** Levels are above so many um. */
const REFERENCE = 0.001;
export const LEVEL_UNIT = `dB re ${REFERENCE} µm`;
/** Lines below this part of the largest are too short to be named, unless levels are drawn. */
const SEEN = 0.02;
const ORDER_TITLE = "order per revolution of the driven gear";

/**
 * Draws the spectra of the designs.
 *
 * @param {Drawn} panel
 * @param {View} view
 */
export function drawSpectrum(panel, view) {
  const { designs, colors, decibels } = view;
  const spectra = spectraOf(designs);
  view.place(panel, spectra.length === 0);
  if (!spectra.length) return;
  panel.names = namesIn(spectra, view);
  panel.levels = decibels ? levelsOf(spectra) : null;
  const data = Plot.join(
    spectra.map(
      ({ orders }) =>
        /** @type {Data} */ (
          orders.length
            ? [orders.map(([order]) => order), orders.map(([, value]) => heightOf(value, decibels))]
            : [[designs[0].teeth], [null]]
        ),
    ),
  );
  const shape = JSON.stringify([spectra.map(({ name, look }) => [name, look]), lastOrder(designs), panel.levels]);
  const make = () => {
    const options = { ...common(panel, view, ORDER_TITLE), ...optionsOf(panel, spectra, view) };
    panel.plot = new Plot(/** @type {Options} */ (options), data, panel.canvas);
  };
  draw(panel, shape, make, (plot) => plot.setData(data));
  // Of several torques it has the first alone.
  const several = designs.some(({ results }) => results.curves.length > 1);
  panel.legend.replaceChildren(...(several ? designs : []).map((design, i) => entryOf(design, i, colors)));
  const part = spectra.some(({ partial }) => partial);
  panel.below.hidden = !part;
  if (part)
    panel.below.textContent =
      "Over the periods that were computed (Hann window): lines are wider than they are. For the whole spectrum clear Mesh periods under Load and method; a job computes it.";
}

/**
 * The spectra of the designs as a drawing.
 *
 * @param {Drawn} panel
 * @param {View} view
 * @param {Omit<Parts, "x">} parts
 */
export function figureOfSpectrum(panel, view, parts) {
  const { designs, colors, decibels } = view;
  const spectra = spectraOf(designs);
  const stems = spectra.map(({ name, look, orders }) => ({
    name,
    color: colors.series(look),
    x: orders.map(([order]) => order),
    y: orders.map(([, value]) => heightOf(value, decibels)),
  }));
  return figure({
    ...parts,
    y: `${panel.title} in ${decibels ? LEVEL_UNIT : panel.unit}`,
    yRange: decibels ? levelsOf(spectra) : null,
    x: ORDER_TITLE,
    stems,
    names: namesIn(spectra, view),
  });
}

/**
 * A design with the torque that its spectrum is of, in the legend.
 *
 * @type {(design: NamedDesign, index: number, colors: Looks) => HTMLElement}
 */
function entryOf({ name, look, results }, i, colors) {
  const torque = number(results.curves[0].output_torque_n_m);
  return sample({ name: `${name}, ${torque} N m`, look: look ?? i, dash: [] }, colors);
}

/**
 * What the plot of the spectra has.
 *
 * @param {Drawn} panel
 * @param {DesignSpectrum[]} spectra
 * @param {View} view
 * @returns {Partial<Options>}
 */
function optionsOf(panel, spectra, { designs, colors }) {
  const last = lastOrder(designs);
  return {
    padding: [16, 14, 0, 0],
    cursor: { y: false, drag: { x: true, y: false, dist: 6 } },
    scales: {
      x: {
        time: false,
        range: ({ data: [orders] }, least, most) =>
          least === orders[0] && most === orders.at(-1) ? [0, last] : [Math.max(0, least), Math.min(last, most)],
      },
      y: { range: (_, __, most) => panel.levels ?? [0, (most ?? 1) * 1.15] },
    },
    series: [
      {},
      ...spectra.map(({ name, look }) => ({
        label: name,
        stroke: colors.series(look),
        paths: () => null,
        points: { show: false },
      })),
    ],
    hooks: { draw: [(plot) => drawStems(plot, panel.names, colors, (i) => colors.series(spectra[i].look))] },
  };
}

/**
 * As far as spectra are shown: four mesh orders of the live design.
 *
 * @type {(designs: NamedDesign[]) => number}
 */
const lastOrder = ([live]) => 4.4 * live.teeth;

/**
 * The spectra of the designs, each with its orders out of the noise; of the live one an estimate where its span is part
 * of the true period.
 *
 * @type {(designs: NamedDesign[]) => DesignSpectrum[]}
 */
function spectraOf(designs) {
  const last = lastOrder(designs);
  return designs.flatMap(({ name, results, look, teeth }, i) => {
    const [curve] = results.curves;
    const partial = !curve.spectrum;
    if (partial && (i > 0 || curve.mesh_position.length < 16)) return [];
    const spectrum = curve.spectrum ?? partialSpectrum(curve, teeth, last);
    return [{ name, look: look ?? i, partial, named: spectrum.named, orders: ordersOf({ spectrum }, last) }];
  });
}

/**
 * An amplitude in um as it is drawn: as it is, or as a level.
 *
 * @type {(value: number, decibels: boolean) => number}
 */
const heightOf = (value, decibels) => (decibels ? 20 * Math.log10(value / REFERENCE) : value);

/**
 * From what is noise, or what is a thousandth of the largest, to the largest, in steps of 10 dB.
 *
 * @type {(spectra: DesignSpectrum[]) => [number, number]}
 */
function levelsOf(spectra) {
  const all = spectra.flatMap(({ orders }) => orders.map(([, value]) => heightOf(value, true)));
  const [least, most] = extent(all) ?? [0, 20];
  const top = 10 * Math.ceil(most / 10 + 0.3);
  return [Math.max(10 * Math.floor(least / 10), top - 80), top];
}

/**
 * The names of orders at the heights of their stems.
 *
 * @type {(spectra: DesignSpectrum[], view: View) => OrderName[]}
 */
const namesIn = (spectra, { designs, decibels }) =>
  namesOf(spectra, lastOrder(designs), decibels ? 0 : SEEN).map((name) => ({
    ...name,
    value: heightOf(name.value, decibels),
  }));

/**
 * @param {UPlot} plot
 * @param {OrderName[]} names
 * @param {Looks} colors
 * @param {(design: number) => string} colorAt
 */
function drawStems(plot, names, colors, colorAt) {
  const { ctx } = plot;
  const ratio = devicePixelRatio || 1;
  const foot = plot.bbox.top + plot.bbox.height;
  ctx.save();
  ctx.beginPath();
  ctx.rect(plot.bbox.left, 0, plot.bbox.width, foot);
  ctx.clip();
  for (let i = 1; i < plot.series.length; i += 1) {
    ctx.strokeStyle = colorAt(i - 1);
    ctx.fillStyle = ctx.strokeStyle;
    ctx.lineWidth = 1.5 * ratio;
    plot.data[0].forEach((order, j) => {
      const value = plot.data[i][j];
      if (value === null || value === undefined) return;
      const [x, y] = [plot.valToPos(order, "x", true) + (i - 1) * 2 * ratio, plot.valToPos(value, "y", true)];
      ctx.beginPath();
      ctx.moveTo(x, foot);
      ctx.lineTo(x, y);
      ctx.stroke();
      mark(ctx, i - 1, x, y, 2.6 * ratio);
    });
  }
  drawNames(plot, names, colors, ratio);
  ctx.restore();
}

/**
 * A mark that tells designs apart without color: disk, square, triangle, ring.
 *
 * @type {(ctx: CanvasRenderingContext2D, kind: number, x: number, y: number, r: number) => void}
 */
function mark(ctx, kind, x, y, r) {
  ctx.beginPath();
  if (kind % 4 === 1) ctx.rect(x - r, y - r, 2 * r, 2 * r);
  else if (kind % 4 === 2) {
    ctx.moveTo(x - 1.2 * r, y + r);
    ctx.lineTo(x + 1.2 * r, y + r);
    ctx.lineTo(x, y - 1.2 * r);
    ctx.closePath();
  } else ctx.arc(x, y, r, 0, 2 * Math.PI);
  if (kind % 4 === 3) ctx.stroke();
  else ctx.fill();
}

/**
 * @param {UPlot} plot
 * @param {OrderName[]} names
 * @param {Looks} colors
 * @param {number} ratio
 */
function drawNames(plot, names, colors, ratio) {
  const { ctx, bbox } = plot;
  const letter = 0.69 * colors.rem * ratio;
  ctx.font = `${letter}px system-ui, sans-serif`;
  ctx.fillStyle = colors.ink;
  ctx.textAlign = "center";
  const { min = 0, max = 0 } = plot.scales.x;
  const shown = names.filter(({ order }) => order >= min && order <= max);
  const stems = plot.data
    .slice(1)
    .flatMap((values, i) =>
      [...plot.data[0]].flatMap((order, j) =>
        values[j] === null || values[j] === undefined ? [] : [{ order, value: values[j], design: i }],
      ),
    );
  const placed = placedNames(shown, {
    stems,
    mark: 2.6 * ratio,
    px: (order) => plot.valToPos(order, "x", true),
    py: (value) => plot.valToPos(value, "y", true),
    left: bbox.left,
    right: bbox.left + bbox.width,
    letter,
    widthOf: (label) => ctx.measureText(label).width,
  });
  for (const { label, x, y } of placed) ctx.fillText(label, x, y);
}
