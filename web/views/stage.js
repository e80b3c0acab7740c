// @ts-check
// The gears on the screen: drawn in the plane or in space, deformed, with the forces at the position where they stand.

import { Deformation } from "../draw/deformed.js";
import { byId, within } from "../draw/dom.js";
import { Drawing, indexAt } from "../draw/drawing.js";
import { same } from "../state/design.js";
import { fixed } from "../state/numbers.js";
import { wordsAt } from "../state/series.js";

/** @import { Space } from "../draw/space.js" */
/** @import { NamedDesign, Pair, PairOutline } from "../state/documents.js" */
/** @import { Store } from "../state/store.js" */

/** A mesh period takes so long when the gears turn by themselves, in milliseconds. */
const PERIOD = 2000;

/** The panel of the drawing, with the position of the gears. */
export class Stage {
  /**
   * The pair in space, once it has been asked for: its modules are fetched then.
   *
   * @type {Space | null}
   */
  #space = null;
  /** @type {PairOutline | null} */
  #outline = null;
  /**
   * The pair that is drawn.
   *
   * @type {Pair | null}
   */
  #drawn = null;
  #slider = byId("position", HTMLInputElement);

  /**
   * The gears of `store`; `live` waits for the last results, and `current` for those of the design as it is, or gives
   * null; `onTurn` is told when the gears stand elsewhere.
   *
   * @param {Store} store
   * @param {{ live: () => Promise<NamedDesign | null>, current: () => Promise<NamedDesign | null>,
   *   onTurn: (position: number) => void }} page
   */
  constructor(store, { live, current, onTurn }) {
    this.store = store;
    this.current = current;
    this.onTurn = onTurn;
    this.drawing = new Drawing(byId("drawing"), store.design, { onTurn: (to) => this.turn(to) });
    const button = byId("deformed");
    this.deformation = new Deformation({
      drawing: this.drawing,
      button,
      note: byId("deformed-note"),
      position: () => store.position,
      live,
    });
    this.#slider.addEventListener("input", () => this.turn(Number(this.#slider.value)));
    const play = byId("play");
    play.addEventListener("click", () => this.#play(play));
    const views = /** @type {HTMLElement[]} */ ([...document.querySelectorAll("button[data-view]")]);
    for (const button of views) {
      button.addEventListener("click", () => {
        for (const other of views) other.setAttribute("aria-pressed", String(other === button));
        const { view = "pair" } = button.dataset;
        // What lies inside is drawn in the plane alone.
        if (view === "space") this.deformation.off();
        else this.drawing.setView(view);
        void this.#showSpace(view === "space");
      });
    }
    button.addEventListener("click", () => this.#space?.isShown && views[0].click());
  }

  /**
   * @param {PairOutline} outline
   * @param {Pair} pair
   */
  setOutline(outline, pair) {
    this.#outline = outline;
    this.drawing.setOutline(outline);
    this.draw(pair);
  }

  /**
   * Draws a pair with the loads that are shown, if they are its own, or if a hand moves it and the next ones come at
   * once.
   *
   * @param {Pair} pair
   */
  draw(pair) {
    this.#drawn = pair;
    const { answer, design } = this.store;
    const { shown } = answer;
    const isIts = shown && (design.by === "drag" || same(shown.submission.pair, pair));
    const curve = isIts ? shown.results.curves[0] : null;
    this.drawing.setCurve(curve);
    if (this.#outline) this.#space?.setPair(this.#outline, pair);
    this.#space?.setCurve(curve);
  }

  /**
   * Shows the pair in space in place of its drawing, or takes it away.
   *
   * @param {boolean} on
   */
  async #showSpace(on) {
    this.drawing.element.toggleAttribute("hidden", on);
    if (!on) return this.#space?.hide();
    const { Space } = await import("../draw/space.js");
    if (!this.#space) {
      this.#space = new Space(byId("drawing"), { live: this.current });
      if (this.#drawn) this.draw(this.#drawn);
      this.#space.setPosition(this.store.position);
    }
    const button = within(document, '[data-view="space"]', HTMLElement);
    if (button.getAttribute("aria-pressed") === "true") this.#space.show();
  }

  /**
   * Where the curves and the gears stand.
   *
   * @param {number} to
   */
  turn(to) {
    const { store } = this;
    const before = store.position;
    store.turn(to);
    const { position } = store;
    if (position !== before) this.deformation.moved();
    this.drawing.setPosition(position);
    this.#space?.setPosition(position);
    this.onTurn(position);
    this.#slider.value = String(position);
    byId("position-value").textContent = `${fixed(position, 3)} periods`;
    const curve = store.answer.shown?.results.curves[0];
    if (!curve) return;
    const i = indexAt(curve, position);
    byId("readout").textContent = wordsAt(curve, i);
    const error = `transmission error ${fixed(curve.transmission_error_um[i], 2)} micrometers`;
    this.#slider.setAttribute("aria-valuetext", `${fixed(position, 2)} mesh periods, ${error}`);
  }

  /** There are results with another true period. */
  renew() {
    const { shown } = this.store.answer;
    this.#slider.max = String(shown?.results.pair.period_mesh_periods ?? 1);
    this.turn(this.store.position);
  }

  restyle() {
    this.#space?.restyle();
  }

  /**
   * Turns the gears until it is told to stop; by steps where motion is unwanted.
   *
   * @param {HTMLElement} button
   */
  #play(button) {
    const isOn = () => button.getAttribute("aria-pressed") === "true";
    button.setAttribute("aria-pressed", String(!isOn()));
    const steps = matchMedia("(prefers-reduced-motion: reduce)").matches;
    let last = performance.now();
    /** @type {FrameRequestCallback} */
    const step = (now) => {
      if (!isOn()) return;
      if (!steps || now - last >= PERIOD / 4) {
        this.turn(this.store.position + (steps ? 0.1 : (now - last) / PERIOD));
        last = now;
      }
      requestAnimationFrame(step);
    };
    if (isOn()) requestAnimationFrame(step);
  }
}
