// @ts-check
// The panels of charts: which of them answer the question, drawn when they are seen, and zoomed and marked together.

import { h } from "./dom.js";
import { drawCurves, figureOfCurves } from "./curves.js";
import { wordsOfFace } from "./face.js";
import { drawFace, faceOfLive, figureOfFace } from "./facemap.js";
import { looks, sample } from "./looks.js";
import { drawSpectrum, figureOfSpectrum, LEVEL_UNIT, SPECTRUM } from "./spectrum.js";
import { linesOf, PANELS, wordsOf, wordsOfSpectrum } from "../state/series.js";

/** @import { Drawn, View } from "./plot.js" */
/** @import { NamedDesign } from "../state/documents.js" */
/** @import { Panel } from "../state/series.js" */

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
    const common = PANELS.filter(({ rare }) => !rare);
    for (const panel of [...common, SPECTRUM, ...PANELS.filter(({ rare }) => rare)]) this.#add(panel);
    new ResizeObserver(() => this.#resize()).observe(place);
    const sight = new IntersectionObserver(
      (entries) => entries.forEach(({ target, isIntersecting }) => this.#sees(target, isIntersecting)),
      { rootMargin: "100px" },
    );
    for (const panel of this.#panels.values()) sight.observe(panel.figure);
  }

  /**
   * Puts a panel with nothing in it into the place.
   *
   * @param {Panel} panel
   */
  #add(panel) {
    const canvas = h("div", { className: "canvas", aria: { hidden: "true" } });
    const legend = h("p", { className: "legend" });
    const words = h("p", { className: "visually-hidden", id: `words-${panel.id}` });
    const below = h("p", { className: "note", hidden: true });
    const absent = Boolean(panel.rare);
    const title = h("strong", {}, panel.title);
    const unit = panel === SPECTRUM ? h("label", {}, "in ", this.#scale()) : ` in ${panel.unit}`;
    const properties = {
      className: "chart",
      id: `chart-${panel.id}`,
      hidden: absent || panel.question !== this.#question,
      aria: { label: panel.title, describedby: words.id },
    };
    const figure = h("figure", properties, h("figcaption", {}, title, unit, legend), canvas, below, words);
    this.place.append(figure);
    const none = { plot: null, now: null, span: 1, empty: false, face: null, names: [], levels: null };
    const state = { shape: "", width: null, seen: true, late: false, absent };
    this.#panels.set(panel.id, { ...panel, canvas, legend, words, below, figure, ...none, ...state });
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
      h("option", { value: "db" }, LEVEL_UNIT),
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
    const view = this.#view();
    const shared = linesOf(PANELS[0], designs);
    this.legend.hidden = shared.length < 2;
    if (!moving) this.legend.replaceChildren(...shared.map((line) => sample(line, view.colors)));
    for (const panel of this.#panels.values()) {
      panel.late = moving && !panel.seen;
      if (!panel.late) this.#draw(panel, view);
    }
    this.setPosition(this.#position);
    if (moving) return;
    for (const panel of this.#panels.values()) panel.words.textContent = this.#wordsOf(panel);
  }

  /** @param {Drawn} panel */
  #wordsOf(panel) {
    if (panel.absent) return "";
    if (panel.id === SPECTRUM.id) return wordsOfSpectrum(this.shown);
    const face = panel.along ? faceOfLive(this.shown) : null;
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
      if (!plot || !now || id === SPECTRUM.id) continue;
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
    const view = this.#view();
    const shown = [...this.#panels.values()].filter((panel) => !panel.absent && !panel.empty && isWanted(panel.id));
    return shown.map((panel) => {
      const { title, unit } = panel;
      const common = { title, y: `${title} in ${unit}`, colors: view.colors, width, height, heading: true };
      if (panel.id === SPECTRUM.id) return figureOfSpectrum(panel, view, common);
      const face = panel.along ? faceOfLive(this.shown) : null;
      if (face) return figureOfFace(face, { ...common, xRange: this.#range, panel, color: view.colors.series(0) });
      return figureOfCurves(panel, view, common);
    });
  }

  #whole() {
    return Math.max(...linesOf(PANELS[0], this.shown).map(({ span }) => span));
  }

  /**
   * What panels are drawn from.
   *
   * @returns {View}
   */
  #view() {
    return {
      designs: this.shown,
      colors: looks(),
      range: this.#range,
      decibels: this.decibels,
      place: (panel, absent) => this.#place(panel, absent),
      widthOf: (panel) => this.#width(panel),
      zoom: (range) => this.zoom(range),
      onPosition: this.onPosition,
    };
  }

  /**
   * @param {Drawn} panel
   * @param {View} view
   */
  #draw(panel, view) {
    if (panel.id === SPECTRUM.id) drawSpectrum(panel, view);
    else if (panel.along) drawFace(panel, view, this.onEveryPosition);
    else drawCurves(panel, view);
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
    this.#draw(panel, this.#view());
    this.setPosition(this.#position);
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
