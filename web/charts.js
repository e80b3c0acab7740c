// Curves over the true period and the spectrum, one design beside the other.

import uPlot from "./vendor/uplot.js";
import { h, number } from "./dom.js";

/** The height of a chart, in rem. */
const HEIGHT = 14.4;
const DASHES = [[], [6, 4], [2, 3], [10, 3, 2, 3]];
/** What lies below is noise of the solution, in um. */
const LEAST_AMPLITUDE = 1e-4;

const PANELS = [
  { id: "ste", title: "Transmission error", unit: "µm", of: (curve) => curve.transmission_error_um },
  { id: "stiffness", title: "Mesh stiffness, tangent", unit: "N/µm", of: (curve) => curve.mesh_stiffness_tangent_n_per_m.map((value) => value * 1e-6) },
  { id: "share", title: "Load share", unit: "%", ofLive: shares, note: "a color for each pair of teeth" },
  { id: "pressure", title: "Peak contact pressure", unit: "MPa", of: (curve) => curve.peak_contact_pressure_mpa },
  { id: "stress", title: "Largest stress", unit: "MPa", ofLive: stresses },
  { id: "spectrum", title: "Spectrum of the transmission error", unit: "µm" },
];

/** Pairs so far apart are never in contact together, and share a color. */
const COLORS_OF_PAIRS = 4;

/** The load shares of the live curve. A pair of teeth keeps its color from its first touch to its last. */
function shares(curve) {
  const offsets = curve.load_shares.map(({ pair_offset: offset }) => offset);
  return Array.from({ length: COLORS_OF_PAIRS }, (_, color) => {
    const carried = curve.mesh_position.map((position, i) => {
      const index = offsets.findIndex((offset) => (((Math.floor(position + 1e-9) + offset - color) % COLORS_OF_PAIRS) + COLORS_OF_PAIRS) % COLORS_OF_PAIRS === 0);
      return index < 0 ? 0 : 100 * curve.load_shares[index].share[i];
    });
    // Where nothing is carried there is no line, but a curve begins and ends at zero.
    return { name: "", open: true, values: carried.map((value, i) => (value > 0 || carried[i - 1] > 0 || carried[i + 1] > 0 ? Math.max(value, 0) : null)) };
  });
}

/** The stresses of the live curve, where they were asked for: at the roots of both gears, and at their holes. */
export function stresses({ stress }) {
  if (!stress) return [];
  return [["root_mpa", "root"], ["hole_mpa", "hole"]].flatMap(([field, place]) =>
    ["driving", "driven"].flatMap((gear) => (stress[gear][field] ? [{ name: `${place}, ${gear} gear`, values: stress[gear][field] }] : [])));
}

/** The colors and letters of the page as it looks now. */
export function looks() {
  const style = getComputedStyle(document.documentElement);
  const rem = parseFloat(style.fontSize);
  const of = (name) => style.getPropertyValue(name).trim();
  return {
    ink: of("--ink"), grid: of("--grid"), faint: of("--faint"), accent: of("--accent"),
    series: [1, 2, 3, 4, 5, 6, 7].map((i) => of(`--series-${i}`)),
    rem, font: `${0.75 * rem}px system-ui, sans-serif`,
  };
}

export class Charts {
  #panels = new Map();
  #position = 0;

  constructor(place, { onPosition }) {
    this.place = place;
    this.onPosition = onPosition;
    for (const panel of PANELS) {
      const canvas = h("div", { className: "canvas" });
      const legend = h("p", { className: "legend" });
      const figure = h("figure", { className: "chart", id: `chart-${panel.id}`, aria: { label: panel.title } },
        h("figcaption", {}, h("strong", {}, panel.title), ` in ${panel.unit}`, legend), canvas);
      place.append(figure);
      this.#panels.set(panel.id, { ...panel, canvas, legend, figure, plot: null, shape: "", width: null, seen: true, late: false });
    }
    new ResizeObserver(() => this.#resize()).observe(place);
    const sight = new IntersectionObserver((entries) => entries.forEach(({ target, isIntersecting }) => this.#sees(target, isIntersecting)), { rootMargin: "100px" });
    for (const { figure } of this.#panels.values()) sight.observe(figure);
  }

  /** Draws everything anew, because the page looks different. */
  restyle() {
    for (const panel of this.#panels.values()) panel.shape = "";
    if (this.shown) this.show(this.shown);
  }

  /** Shows designs: `{ name, results, color }`, the live one first. While a hand moves, curves out of sight wait until they are looked at. */
  show(designs, moving = false) {
    this.shown = designs;
    const colors = looks();
    for (const panel of this.#panels.values()) {
      panel.late = moving && !panel.seen;
      if (!panel.late) this.#draw(panel, colors);
    }
    this.setPosition(this.#position);
  }

  #draw(panel, colors) {
    if (panel.id === "spectrum") this.#spectrum(panel, this.shown, colors);
    else this.#curves(panel, this.shown, colors);
  }

  #sees(figure, seen) {
    const panel = [...this.#panels.values()].find((each) => each.figure === figure);
    panel.seen = seen;
    if (!seen || !panel.late) return;
    panel.late = false;
    this.#draw(panel, looks());
    this.setPosition(this.#position);
  }

  /** Marks a mesh position in every curve. */
  setPosition(position) {
    this.#position = position;
    for (const { plot, now, id } of this.#panels.values()) {
      if (!plot || !now || id === "spectrum") continue;
      const { max } = plot.scales.x;
      const period = plot.data[0]?.length ? (plot.period ?? max) : 1;
      const x = ((position % period) + period) % period;
      now.style.transform = `translateX(${plot.valToPos(x, "x")}px)`;
    }
  }

  canvasOf(id) {
    return this.#panels.get(id)?.plot?.root.querySelector("canvas") ?? null;
  }

  #curves(panel, designs, colors) {
    const wanted = designs.flatMap((design, i) => seriesOf(panel, design, i, colors));
    panel.figure.hidden = wanted.length === 0;
    if (!wanted.length) return;
    const tables = wanted.map((each) => [closed(each.x, each.period), [...each.values, each.open ? null : each.values[0]]]);
    const data = uPlot.join(tables, tables.map(() => [2]));
    const shape = JSON.stringify(wanted.map(({ name, color, dash }) => [name, color, dash]));
    const period = Math.max(...wanted.map((each) => each.period));
    if (panel.shape !== shape || !panel.plot) {
      this.#make(panel, data, wanted, colors);
      panel.shape = shape;
    } else {
      panel.plot.setData(data);
    }
    panel.plot.period = period;
    panel.legend.replaceChildren(...(panel.note ? [panel.note] : wanted.length > 1 ? wanted.map(sample) : []));
  }

  #make(panel, data, wanted, colors) {
    panel.plot?.destroy();
    const axis = { stroke: colors.ink, font: colors.font, grid: { stroke: colors.grid, width: 1 }, ticks: { stroke: colors.grid, size: 4 } };
    const options = {
      width: this.#width(panel), height: HEIGHT * colors.rem, legend: { show: false }, cursor: { y: false, points: { size: 7 }, drag: { x: false, y: false } },
      padding: [10, 14, 0, 0], scales: { x: { time: false }, y: { range: yRange } },
      axes: [{ ...axis, label: "mesh position in mesh periods", labelFont: colors.font, labelSize: 1.25 * colors.rem, size: 1.9 * colors.rem, space: 2.8 * colors.rem }, { ...axis, size: 3.6 * colors.rem, space: 2.1 * colors.rem, values: (_, splits) => splits.map((value) => number(value, 6)) }],
      series: [{}, ...wanted.map(({ name, color, dash }) => ({ label: name, stroke: color, width: 1.6, dash, points: { show: false }, spanGaps: false }))],
      hooks: { setCursor: [(plot) => this.#follow(plot)] },
    };
    panel.plot = new uPlot(options, data, panel.canvas);
    panel.now = h("div", { className: "now" });
    panel.plot.over.append(panel.now);
  }

  /** The pointer over a curve turns the gears. */
  #follow(plot) {
    const { left } = plot.cursor;
    if (left === undefined || left < 0 || !plot.cursor.event) return;
    this.onPosition(plot.posToVal(left, "x"));
  }

  #spectrum(panel, designs, colors) {
    const wanted = designs.flatMap(({ name, results, color }, i) => results.curves.flatMap((curve, j) => (curve.spectrum && j === 0 ? [{ name, color: color ?? colors.series[i % 7], spectrum: curve.spectrum }] : [])));
    panel.figure.hidden = wanted.length === 0;
    if (!wanted.length) return;
    const mesh = designs[0].teeth ?? Math.max(...wanted[0].spectrum.order);
    const last = 4.4 * mesh;
    const tables = wanted.map(({ spectrum }) => {
      const kept = spectrum.order.map((order, i) => [order, spectrum.transmission_error_um[i]]).filter(([order, value]) => order <= last && value > LEAST_AMPLITUDE);
      return [kept.map(([order]) => order), kept.map(([, value]) => value)];
    });
    panel.names = wanted[0].spectrum.named.filter(({ order, transmission_error_um: value }) => order <= last && value > LEAST_AMPLITUDE);
    const data = uPlot.join(tables.map((table) => (table[0].length ? table : [[mesh], [null]])));
    const shape = JSON.stringify([wanted.map(({ name, color }) => [name, color]), last]);
    if (panel.shape !== shape || !panel.plot) {
      this.#makeSpectrum(panel, data, wanted, colors, last);
      panel.shape = shape;
    } else {
      panel.plot.setData(data);
    }
    panel.legend.replaceChildren(...(wanted.length > 1 ? wanted.map(sample) : []));
  }

  #makeSpectrum(panel, data, wanted, colors, last) {
    panel.plot?.destroy();
    const axis = { stroke: colors.ink, font: colors.font, grid: { stroke: colors.grid, width: 1 }, ticks: { stroke: colors.grid, size: 4 } };
    const options = {
      width: this.#width(panel), height: HEIGHT * colors.rem, legend: { show: false }, cursor: { y: false, drag: { x: false, y: false } }, padding: [16, 14, 0, 0],
      scales: { x: { time: false, range: [0, last] }, y: { distr: 3, range: (_, __, most) => [LEAST_AMPLITUDE, Math.max(1e-2, (most ?? 1) * 4)] } },
      axes: [{ ...axis, label: "order, per revolution of the driven gear", labelFont: colors.font, labelSize: 1.25 * colors.rem, size: 1.9 * colors.rem }, { ...axis, size: 3.6 * colors.rem, values: (_, splits) => splits.map((value) => (value === null || Math.abs(Math.log10(value) % 1) > 1e-6 ? "" : number(value, 1))) }],
      series: [{}, ...wanted.map(({ name, color }) => ({ label: name, stroke: color, paths: () => null, points: { show: false } }))],
      hooks: { draw: [(plot) => drawStems(plot, panel.names, colors)] },
    };
    panel.plot = new uPlot(options, data, panel.canvas);
  }

  /** Kept until the page changes its size, because asking lays the page out. */
  #width(panel) {
    panel.width ??= Math.max(200, Math.floor(panel.canvas.clientWidth || 400));
    return panel.width;
  }

  #resize() {
    for (const panel of this.#panels.values()) {
      panel.width = null;
      if (panel.plot && !panel.figure.hidden && panel.plot.width !== this.#width(panel)) panel.plot.setSize({ width: this.#width(panel), height: HEIGHT * looks().rem });
    }
    this.setPosition(this.#position);
  }
}

function seriesOf(panel, { name, results, color }, i, colors) {
  const period = (curve) => curve.mesh_position.length * (curve.mesh_position[1] - curve.mesh_position[0]);
  if (panel.ofLive) {
    if (i > 0) return [];
    const curve = results.curves[0];
    return panel.ofLive(curve).map((each, j) => ({ ...each, x: curve.mesh_position, period: period(curve), color: colors.series[j % 7], dash: [] }));
  }
  const several = results.curves.length > 1;
  return results.curves.map((curve, j) => ({
    name: several ? `${name}, ${number(curve.output_torque_n_m)} N m` : name, values: panel.of(curve), x: curve.mesh_position,
    period: period(curve), color: color ?? colors.series[i % 7], dash: DASHES[j % DASHES.length],
  }));
}

/** The positions with the end of the period, where the first comes again. */
function closed(positions, period) {
  return [...positions, positions[0] + period];
}

function yRange(_, least, most) {
  if (least === null || most === null) return [0, 1];
  const room = Math.max((most - least) * 0.08, Math.abs(most) * 1e-4, 1e-9);
  return [least === 0 ? 0 : least - room, most + room];
}

function sample({ name, color, dash }) {
  const line = h("span", { className: dash?.length ? "swatch dashed" : "swatch" });
  line.style.borderColor = color;
  return h("span", { className: "entry" }, line, name);
}

function drawStems(plot, names, colors) {
  const { ctx } = plot;
  const ratio = devicePixelRatio || 1;
  const foot = plot.bbox.top + plot.bbox.height;
  ctx.save();
  ctx.beginPath();
  ctx.rect(plot.bbox.left, 0, plot.bbox.width, foot);
  ctx.clip();
  for (let i = 1; i < plot.series.length; i += 1) {
    ctx.strokeStyle = plot.series[i].stroke();
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
      ctx.beginPath();
      ctx.arc(x, y, 2.4 * ratio, 0, 2 * Math.PI);
      ctx.fill();
    });
  }
  drawNames(plot, names, colors, ratio);
  ctx.restore();
}

/** Names over their lines, the tallest first, none over another. */
function drawNames(plot, names, colors, ratio) {
  const { ctx } = plot;
  ctx.font = `${0.69 * colors.rem * ratio}px system-ui, sans-serif`;
  ctx.fillStyle = colors.ink;
  ctx.textAlign = "center";
  const taken = [];
  const rank = ({ label }) => (/^H_(N\d?|Z\d?)$/.test(label) ? 0 : 1);
  for (const line of [...names].sort((a, b) => rank(a) - rank(b) || b.transmission_error_um - a.transmission_error_um)) {
    const width = ctx.measureText(line.label).width;
    const x = Math.min(Math.max(plot.valToPos(line.order, "x", true), plot.bbox.left + width / 2), plot.bbox.left + plot.bbox.width - width / 2);
    const y = plot.valToPos(line.transmission_error_um, "y", true) - 6 * ratio;
    const box = [x - width / 2 - 2, y - 0.75 * colors.rem * ratio, x + width / 2 + 2, y + 2];
    if (taken.some((other) => box[0] < other[2] && other[0] < box[2] && box[1] < other[3] && other[1] < box[3])) continue;
    taken.push(box);
    ctx.fillText(line.label, x, y);
  }
}
