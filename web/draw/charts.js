// @ts-check
// Curves over the true period and the spectrum, one design beside the other, zoomed together.

import uPlot from "../vendor/uplot.js";
import { button, h, s } from "./dom.js";
import { cellsOf, cssOf, faceOf, SCALE, scaleOf, wordsOfFace } from "./face.js";
import { figure, roomIn } from "./figure.js";
import { extent, fixed, number } from "../state/numbers.js";
import {
  linesOf,
  namesOf,
  ordersOf,
  PANELS,
  partialSpectrum,
  placedNames,
  wordsOf,
  wordsOfSpectrum,
} from "../state/series.js";

/** @import { FaceLoad } from "./face.js" */
/** @import { Parts } from "./figure.js" */
/** @import { NamedDesign } from "../state/documents.js" */
/** @import { Line, OrderName, Panel, Point } from "../state/series.js" */

/**
 * The file of uPlot has no types; those of its package are of the same version.
 *
 * @type {typeof import("uplot")}
 */
const Plot = /** @type {any} */ (uPlot);

/** @typedef {import("uplot")} UPlot */

/** @typedef {import("uplot").AlignedData} Data */

/** @typedef {ReturnType<typeof looks>} Looks */

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

/** @typedef {{ look?: number, part?: number }} Colored */

/**
 * @typedef {{ name: string, look: number, partial: boolean, orders: Point[],
 *   named: { order: number, label: string, transmission_error_um: number }[] }} DesignSpectrum
 */

/** Where a mesh period has fewer pixels the curve is shown by its envelope. */
const LEAST_PIXELS = 14;
/** Levels of the spectrum are above so many um. */
const REFERENCE = 0.001;
/** Lines below this part of the largest are too short to be named, unless levels are drawn. */
const SEEN = 0.02;
/** @type {Panel} */
const SPECTRUM = { id: "spectrum", question: "noise", title: "Spectrum of the transmission error", unit: "µm" };
const X_TITLE = "mesh position in mesh periods";
const ORDER_TITLE = "order per revolution of the driven gear";

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
const colorOf = ({ look, part }, colors) =>
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

export class Charts {
  /** @type {Map<string, Drawn>} */
  #panels = new Map();
  #position = 0;
  /** @type {[number, number] | null} */
  #range = null;
  /**
   * The designs that are shown, the live one first; none before there are results.
   *
   * @type {NamedDesign[]}
   */
  shown = [];
  /** The question whose charts are shown. */
  #question = "noise";
  /** Whether the spectrum has levels in place of amplitudes. */
  decibels = false;

  /**
   * Charts in `place`. `onPosition` is told where a pointer is, `onRange` which mesh periods are shown: two numbers, or
   * null for all; `onEveryPosition` that the load along the face is wanted at every position.
   *
   * @param {HTMLElement} place
   * @param {{ onPosition: (to: number) => void, onRange: (range: [number, number] | null) => void, onEveryPosition: ()
   *   => void }} hearers
   */
  constructor(place, { onPosition, onRange, onEveryPosition }) {
    this.place = place;
    this.onPosition = onPosition;
    this.onRange = onRange;
    this.onEveryPosition = onEveryPosition;
    // What stands in every chart is named once, above them.
    this.legend = h("p", { className: "legend shared", hidden: true });
    place.append(this.legend);
    // What some designs alone have stands last, so that it moves nothing when it comes.
    /** @type {(panel: Panel) => boolean} */
    const isRare = ({ rare }) => Boolean(rare);
    for (const panel of [...PANELS.filter((each) => !isRare(each)), SPECTRUM, ...PANELS.filter(isRare)]) {
      const canvas = h("div", { className: "canvas", aria: { hidden: "true" } });
      const legend = h("p", { className: "legend" });
      const words = h("p", { className: "visually-hidden", id: `words-${panel.id}` });
      const below = h("p", { className: "note", hidden: true });
      const element = h(
        "figure",
        {
          className: "chart",
          id: `chart-${panel.id}`,
          hidden: isRare(panel) || panel.question !== this.#question,
          aria: { label: panel.title, describedby: words.id },
        },
        h(
          "figcaption",
          {},
          h("strong", {}, panel.title),
          ...(panel === SPECTRUM ? [h("label", {}, "in ", this.#scale())] : [` in ${panel.unit}`]),
          legend,
        ),
        canvas,
        below,
        words,
      );
      place.append(element);
      this.#panels.set(panel.id, {
        ...panel,
        canvas,
        legend,
        words,
        below,
        figure: element,
        plot: null,
        now: null,
        span: 1,
        empty: false,
        face: null,
        names: [],
        levels: null,
        shape: "",
        width: null,
        seen: true,
        late: false,
        absent: isRare(panel),
      });
    }
    new ResizeObserver(() => this.#resize()).observe(place);
    const sight = new IntersectionObserver(
      (entries) => entries.forEach(({ target, isIntersecting }) => this.#sees(target, isIntersecting)),
      { rootMargin: "100px" },
    );
    for (const panel of this.#panels.values()) sight.observe(panel.figure);
  }

  /** The choice of the scale of the spectrum. */
  #scale() {
    /** @param {{ target: HTMLSelectElement }} event */
    const choose = ({ target }) => {
      this.decibels = target.value === "db";
      this.show(this.shown);
    };
    return h(
      "select",
      { id: "spectrum-scale", ariaLabel: "Scale of the spectrum", on: { change: choose } },
      h("option", { value: "um" }, "µm"),
      h("option", { value: "db" }, `dB re ${REFERENCE} µm`),
    );
  }

  /**
   * Shows the charts of a question, and hides the others.
   *
   * @param {string} question
   */
  ask(question) {
    this.#question = question;
    for (const panel of this.#panels.values()) this.#place(panel, panel.absent);
    this.#resize();
  }

  /** True if a chart of the question is shown. */
  get answers() {
    return [...this.#panels.values()].some(({ question, absent }) => question === this.#question && !absent);
  }

  /**
   * Shows a panel where it has something to show and answers the question.
   *
   * @param {Drawn} panel
   * @param {boolean} absent
   */
  #place(panel, absent) {
    panel.absent = absent;
    panel.figure.hidden = absent || panel.question !== this.#question;
  }

  /** Draws everything anew, because the page looks different. */
  restyle() {
    for (const panel of this.#panels.values()) panel.shape = "";
    this.show(this.shown);
  }

  /**
   * Shows designs: `{ name, results, look, teeth }`, the live one first. While a hand moves, curves out of sight wait
   * until they are looked at.
   *
   * @param {NamedDesign[]} designs
   */
  show(designs, moving = false) {
    this.shown = designs;
    if (!designs.length) return;
    const colors = looks();
    const shared = linesOf(PANELS[0], designs);
    this.legend.hidden = shared.length < 2;
    if (!moving) this.legend.replaceChildren(...shared.map((line) => sample(line, colors)));
    for (const panel of this.#panels.values()) {
      panel.late = moving && !panel.seen;
      if (!panel.late) this.#draw(panel, colors);
    }
    this.setPosition(this.#position);
    if (moving) return;
    for (const panel of this.#panels.values()) panel.words.textContent = this.#wordsOf(panel);
  }

  /** @param {Drawn} panel */
  #wordsOf(panel) {
    if (panel.absent) return "";
    if (panel.id === "spectrum") return wordsOfSpectrum(this.shown);
    const face = panel.along ? faceOf(this.shown[0].results.curves[0]) : null;
    return face ? wordsOfFace(face) : wordsOf(panel, this.shown);
  }

  /**
   * Shows the mesh periods from one position to another alone, or all of them.
   *
   * @param {[number, number] | null} range
   */
  zoom(range) {
    const whole = this.shown.length ? this.#whole() : 0;
    const [from, to] = range ?? [0, whole];
    this.#range = to - from >= whole * 0.999 || to - from < 1e-3 ? null : [Math.max(0, from), Math.min(whole, to)];
    this.show(this.shown);
    this.onRange(this.#range);
  }

  /**
   * Marks a mesh position in every curve.
   *
   * @param {number} position
   */
  setPosition(position) {
    this.#position = position;
    for (const { plot, now, id, span } of this.#panels.values()) {
      if (!plot || !now || id === "spectrum") continue;
      const x = ((position % span) + span) % span;
      const { min = 0, max = 0 } = plot.scales.x;
      now.hidden = x < min || x > max;
      now.style.transform = `translateX(${plot.valToPos(x, "x")}px)`;
    }
  }

  /**
   * The curves that are shown as drawings with titles, units and legends.
   *
   * @param {{ width?: number, height?: number }} [size]
   * @param {(id: string) => boolean} isWanted
   */
  figures({ width = 760, height = 300 } = {}, isWanted = () => true) {
    const colors = looks();
    const shown = [...this.#panels.values()].filter((panel) => !panel.absent && !panel.empty && isWanted(panel.id));
    return shown.map((panel) => {
      const common = { title: panel.title, y: `${panel.title} in ${panel.unit}`, colors, width, height, heading: true };
      if (panel.id === "spectrum") {
        const spectra = this.#spectra();
        const stems = spectra.map(({ name, look, orders }) => ({
          name,
          color: colors.series(look),
          x: orders.map(([order]) => order),
          y: orders.map(([, value]) => this.#level(value)),
        }));
        return figure({
          ...common,
          y: `${panel.title} in ${this.#unit()}`,
          yRange: this.decibels ? this.#levels(spectra) : null,
          x: ORDER_TITLE,
          stems,
          names: this.#names(spectra),
        });
      }
      const face = panel.along ? faceOf(this.shown[0].results.curves[0]) : null;
      if (face) return faceFigure(face, { ...common, xRange: this.#range, panel, color: colors.series(0) });
      const lines = linesOf(panel, this.shown, this.#crowded(panel, linesOf(panel, this.shown), width)).map((line) => ({
        ...line,
        color: colorOf(line, colors),
        x: closed(line),
        y: [...line.values, line.open ? null : line.values[0]],
      }));
      return figure({ ...common, x: X_TITLE, lines, xRange: this.#range });
    });
  }

  #whole() {
    return Math.max(...linesOf(PANELS[0], this.shown).map(({ span }) => span));
  }

  /**
   * @param {Drawn} panel
   * @param {Looks} colors
   */
  #draw(panel, colors) {
    if (panel.id === "spectrum") this.#spectrum(panel, colors);
    else if (panel.along) this.#face(panel, colors);
    else this.#curves(panel, colors);
  }

  /**
   * @param {Element} element
   * @param {boolean} seen
   */
  #sees(element, seen) {
    const panel = [...this.#panels.values()].find((each) => each.figure === element);
    if (!panel) return;
    panel.seen = seen;
    if (!seen || !panel.late) return;
    panel.late = false;
    this.#draw(panel, looks());
    this.setPosition(this.#position);
  }

  /**
   * @param {Drawn} panel
   * @param {Looks} colors
   */
  #curves(panel, colors) {
    const all = linesOf(panel, this.shown);
    const crowded = all.length > 0 && this.#crowded(panel, all);
    const wanted = crowded && panel.whole ? linesOf(panel, this.shown, true) : all;
    this.#place(panel, wanted.length === 0);
    if (!wanted.length) return;
    panel.empty = !wanted.some(({ values }) => values.some((value) => value !== null));
    panel.canvas.hidden = panel.empty;
    panel.below.hidden = !panel.gaps || !wanted.some(({ values }) => values.includes(null));
    panel.below.textContent = (panel.empty ? panel.none : panel.gaps) ?? "";
    if (panel.empty) {
      panel.plot?.destroy();
      Object.assign(panel, { plot: null, now: null, shape: "", width: null });
      return panel.legend.replaceChildren();
    }
    panel.span = Math.max(...wanted.map(({ span }) => span));
    const [from, end] = this.#range ?? [0, panel.span];
    const [many, to] = [crowded, end];
    const lines = many
      ? wanted.flatMap((line) => envelopeOf(line, from, to))
      : wanted.map((line) => ({
          ...line,
          at: closed(line),
          values: [...line.values, line.open ? null : line.values[0]],
        }));
    const tables = lines.map((line) => /** @type {Data} */ ([line.at, line.values]));
    const data = Plot.join(
      tables,
      tables.map(() => [2]),
    );
    const shape = JSON.stringify([many, lines.map(({ name, look, dash }) => [name, look, dash])]);
    if (panel.shape !== shape || !panel.plot) {
      this.#make(panel, data, lines, colors, many);
      panel.shape = shape;
    } else {
      panel.plot.setData(data, false);
    }
    panel.plot?.setScale("x", { min: from, max: to });
    const note = many ? (panel.whole ? "that of most load; zoom in for each" : "envelope; zoom in") : panel.note;
    panel.legend.replaceChildren(
      ...(note ? [h("span", {}, note)] : []),
      ...(wanted.length > 1 && panel.ofLive && !panel.note ? wanted.map((line) => sample(line, colors)) : []),
    );
  }

  /**
   * Whether so many mesh periods are shown that they cannot be told apart.
   *
   * @param {Drawn} panel
   * @param {Line[]} lines
   */
  #crowded(panel, lines, width = this.#width(panel)) {
    const [from, to] = this.#range ?? [0, Math.max(...lines.map(({ span }) => span))];
    return to - from > Math.floor(width / LEAST_PIXELS);
  }

  /**
   * @param {Drawn} panel
   * @param {Data} data
   * @param {(Colored & { name: string, dash: number[] })[]} lines
   * @param {Looks} colors
   * @param {boolean} many
   */
  #make(panel, data, lines, colors, many) {
    panel.plot?.destroy();
    /** @type {import("uplot").Options} */
    const options = {
      ...this.#common(panel, colors, X_TITLE),
      scales: { x: { time: false, auto: false }, y: { range: yRange } },
      series: [
        {},
        ...lines.map(({ name, dash, ...line }) => ({
          label: name,
          stroke: colorOf(line, colors),
          width: (many ? 0.05 : 0.1) * colors.rem,
          dash: many ? [] : dash,
          points: { show: false },
          spanGaps: false,
        })),
      ],
      bands: many
        ? lines.flatMap((line, i) =>
            i % 2
              ? []
              : [{ series: [i + 1, i + 2], fill: `color-mix(in srgb, ${colorOf(line, colors)} 35%, transparent)` }],
          )
        : [],
      hooks: { setCursor: [(plot) => this.#follow(plot)], setSelect: [(plot) => this.#select(plot)] },
    };
    panel.plot = new Plot(options, data, panel.canvas);
    panel.now = h("div", { className: "now" });
    panel.plot.over.append(panel.now);
    panel.plot.over.addEventListener("dblclick", () => this.zoom(null));
  }

  /**
   * What all plots have.
   *
   * @param {Drawn} panel
   * @param {Looks} colors
   * @param {string} title
   */
  #common(panel, colors, title) {
    const axis = {
      stroke: colors.ink,
      font: colors.font,
      grid: { stroke: colors.grid, width: 1 },
      ticks: { stroke: colors.grid, size: 4 },
      // As everywhere on the page, whichever language the browser has.
      values: (/** @type {unknown} */ _, /** @type {number[]} */ splits) => splits.map((value) => number(value, 6)),
    };
    /** @satisfies {Partial<import("uplot").Options>} */
    const common = {
      width: this.#width(panel),
      height: colors.height,
      legend: { show: false },
      padding: /** @type {[number, number, number, number]} */ ([10, 14, 0, 0]),
      cursor: { y: false, points: { size: 7 }, drag: { x: true, y: false, setScale: false, dist: 6 } },
      axes: [
        {
          ...axis,
          label: title,
          labelFont: colors.font,
          labelSize: 1.25 * colors.rem,
          size: 1.9 * colors.rem,
          space: 2.8 * colors.rem,
        },
        { ...axis, size: 3.6 * colors.rem, space: 2.1 * colors.rem },
      ],
    };
    return common;
  }

  /**
   * The pointer over a curve turns the gears.
   *
   * @param {UPlot} plot
   */
  #follow(plot) {
    const { left, event } = plot.cursor;
    if (left === undefined || left < 0 || !event || event.buttons) return;
    this.onPosition(plot.posToVal(left, "x"));
  }

  /**
   * A stretch of a curve that is drawn over with the pointer fills the plot.
   *
   * @param {UPlot} plot
   */
  #select(plot) {
    const { left, width } = plot.select;
    if (width < 6) return;
    const [from, to] = [plot.posToVal(left, "x"), plot.posToVal(left + width, "x")];
    plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    this.zoom([from, to]);
  }

  /**
   * The load of the live design along its face: a map over every position, or the mean.
   *
   * @param {Drawn} panel
   * @param {Looks} colors
   */
  #face(panel, colors) {
    const face = faceOf(this.shown[0].results.curves[0]);
    this.#place(panel, !face);
    if (!face) return;
    panel.below.hidden = face.every;
    panel.legend.replaceChildren(
      h("span", {}, `K_Hβ ${fixed(face.factor, 3)}`),
      face.every ? scaleOf(face.most) : h("span", {}, "mean over the positions"),
    );
    if (!face.every) {
      panel.plot?.destroy();
      Object.assign(panel, { plot: null, now: null, shape: "mean" });
      const { title, unit } = panel;
      panel.canvas.replaceChildren(
        faceFigure(face, { title, y: `${title} in ${unit}`, width: roomIn(panel.canvas), panel }),
      );
      panel.below.replaceChildren(
        "How it changes while the teeth pass is told where every position is asked for. ",
        button("Show every position", () => this.onEveryPosition()),
      );
      return;
    }
    panel.span = face.span;
    panel.face = face;
    const range = this.#range ?? [0, face.span];
    /** @type {Data} */
    const data = [[...face.positions, face.positions[0] + face.span], Array(face.positions.length + 1).fill(null)];
    const shape = `every ${face.edges[0]} ${face.edges.at(-1)}`;
    if (panel.shape !== shape || !panel.plot) {
      panel.canvas.replaceChildren();
      this.#makeFace(panel, data, colors);
      panel.shape = shape;
    } else {
      panel.plot.setData(data, false);
    }
    panel.plot?.setScale("x", { min: range[0], max: Math.min(range[1], face.span) });
  }

  /**
   * @param {Drawn} panel
   * @param {Data} data
   * @param {Looks} colors
   */
  #makeFace(panel, data, colors) {
    panel.plot?.destroy();
    const common = this.#common(panel, colors, X_TITLE);
    const [across, along] = common.axes;
    /** @type {import("uplot").Options} */
    const options = {
      ...common,
      scales: { x: { time: false, auto: false }, y: { range: () => rangeOf(panel.face) } },
      axes: [
        across,
        {
          ...along,
          label: "z in mm",
          labelFont: colors.font,
          labelSize: 1.25 * colors.rem,
          size: 2.6 * colors.rem,
          grid: { show: false },
        },
      ].map((axis) => ({ ...axis, grid: { show: false } })),
      series: [{}, { label: panel.title, paths: () => null, points: { show: false } }],
      hooks: {
        drawClear: [(plot) => panel.face && drawCells(plot, panel.face)],
        setCursor: [(plot) => this.#follow(plot)],
        setSelect: [(plot) => this.#select(plot)],
      },
    };
    panel.plot = new Plot(options, data, panel.canvas);
    panel.now = h("div", { className: "now on-map" });
    panel.plot.over.append(panel.now);
    panel.plot.over.addEventListener("dblclick", () => this.zoom(null));
  }

  /** As far as spectra are shown: four mesh orders of the live design. */
  #lastOrder() {
    return 4.4 * this.shown[0].teeth;
  }

  /**
   * The spectra of the designs, each with its orders out of the noise; of the live one an estimate where its span is
   * part of the true period.
   *
   * @returns {DesignSpectrum[]}
   */
  #spectra() {
    const last = this.#lastOrder();
    return this.shown.flatMap(({ name, results, look, teeth }, i) => {
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
   * @param {number} value
   */
  #level(value) {
    return this.decibels ? 20 * Math.log10(value / REFERENCE) : value;
  }

  #unit() {
    return this.decibels ? `dB re ${REFERENCE} µm` : "µm";
  }

  /**
   * From what is noise, or what is a thousandth of the largest, to the largest, in steps of 10 dB.
   *
   * @param {DesignSpectrum[]} spectra
   * @returns {[number, number]}
   */
  #levels(spectra) {
    const [least, most] = extent(spectra.flatMap(({ orders }) => orders.map(([, value]) => this.#level(value)))) ?? [
      0, 20,
    ];
    const top = 10 * Math.ceil(most / 10 + 0.3);
    return [Math.max(10 * Math.floor(least / 10), top - 80), top];
  }

  /** @param {DesignSpectrum[]} spectra */
  #names(spectra) {
    return namesOf(spectra, this.#lastOrder(), this.decibels ? 0 : SEEN).map((name) => ({
      ...name,
      value: this.#level(name.value),
    }));
  }

  /**
   * @param {Drawn} panel
   * @param {Looks} colors
   */
  #spectrum(panel, colors) {
    const wanted = this.#spectra();
    this.#place(panel, wanted.length === 0);
    if (!wanted.length) return;
    const last = this.#lastOrder();
    panel.names = this.#names(wanted);
    panel.levels = this.decibels ? this.#levels(wanted) : null;
    const data = Plot.join(
      wanted.map(
        ({ orders }) =>
          /** @type {Data} */ (
            orders.length
              ? [orders.map(([order]) => order), orders.map(([, value]) => this.#level(value))]
              : [[this.shown[0].teeth], [null]]
          ),
      ),
    );
    const shape = JSON.stringify([wanted.map(({ name, look }) => [name, look]), last, panel.levels]);
    if (panel.shape !== shape || !panel.plot) {
      this.#makeSpectrum(panel, data, wanted, colors, last);
      panel.shape = shape;
    } else {
      panel.plot.setData(data);
    }
    const part = wanted.some(({ partial }) => partial);
    // Of several torques it has the first alone.
    const several = this.shown.some(({ results }) => results.curves.length > 1);
    panel.legend.replaceChildren(
      ...(several
        ? this.shown.map(
            (
              {
                name,
                look,
                results: {
                  curves: [curve],
                },
              },
              i,
            ) => sample({ name: `${name}, ${number(curve.output_torque_n_m)} N m`, look: look ?? i, dash: [] }, colors),
          )
        : []),
    );
    panel.below.hidden = !part;
    if (part)
      panel.below.textContent =
        "Over the periods that were computed (Hann window): lines are wider than they are. For the whole spectrum clear Mesh periods under Load and method; a job computes it.";
  }

  /**
   * @param {Drawn} panel
   * @param {Data} data
   * @param {DesignSpectrum[]} wanted
   * @param {Looks} colors
   * @param {number} last
   */
  #makeSpectrum(panel, data, wanted, colors, last) {
    panel.plot?.destroy();
    /** @type {import("uplot").Options} */
    const options = {
      ...this.#common(panel, colors, ORDER_TITLE),
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
        ...wanted.map(({ name, look }) => ({
          label: name,
          stroke: colors.series(look),
          paths: () => null,
          points: { show: false },
        })),
      ],
      hooks: { draw: [(plot) => drawStems(plot, panel.names, colors, (i) => colors.series(wanted[i].look))] },
    };
    panel.plot = new Plot(options, data, panel.canvas);
  }

  /**
   * Measured once for each layout: to measure again while a hand drags would lay the page out anew for each curve.
   *
   * @param {Drawn} panel
   * @returns {number}
   */
  #width(panel) {
    panel.width ??= Math.max(200, Math.floor(panel.canvas.clientWidth || this.place.clientWidth / 2));
    return panel.width;
  }

  #resize() {
    for (const panel of this.#panels.values()) {
      panel.width = null;
      if (
        panel.plot &&
        !panel.figure.hidden &&
        (panel.plot.width !== this.#width(panel) || panel.plot.height !== looks().height)
      )
        panel.plot.setSize({ width: this.#width(panel), height: looks().height });
    }
    this.setPosition(this.#position);
  }
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
function faceFigure(face, { panel, xRange = null, color, ...common }) {
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

/**
 * The positions of a line with the end of its span, where the first comes again.
 *
 * @type {(line: Line) => number[]}
 */
function closed({ x, span }) {
  return [...x, x[0] + span];
}

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

/**
 * A piece of a line beside its name.
 *
 * @type {(line: Colored & { name: string, dash?: number[] }, colors: Looks) => HTMLElement}
 */
function sample({ name, dash, ...line }, colors) {
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
