// @ts-check
// The dial that turns the holes of the driving gear under its teeth, where the holes of both gears excite one order
// together.

import { button, dress, h, inLine, note, s } from "../draw/dom.js";
import { figure } from "../draw/figure.js";
import { number } from "../state/numbers.js";
import { amplitudeAt, phaseOf, pitchOf, turnedBy, within, wordsOf } from "../state/phase.js";

/** @import { Design } from "../state/design.js" */
/** @import { NamedDesign } from "../state/documents.js" */
/** @import { HolePhase } from "../state/phase.js" */

/** Radius of the dial, and of its curve at no amplitude, in px. */
const [RADIUS, NONE] = [62, 16];
/** A key turns by so many degrees; with Shift, and a page key, by others. */
const [STEP, FINE, COARSE] = [0.5, 0.1, 5];
/** A hand turns to a tenth of a degree. */
const HAND = 0.1;
const WORKSHOP =
  "Assembled in phase: the workshop drills the holes of both gears at their angles to a marked tooth, and the assembly brings marked teeth together.";

export class Dial {
  /** @type {HolePhase | null} */
  #phase = null;
  /** Where the driving blank stood in the design that the phase is of, in degrees. */
  #origin = 0;
  /** True while the numbers are those of the design as it is. */
  #isLive = false;
  #summary = h("summary", {});
  #words = h("p", {});
  #take = button("", () => this.#turnTo(this.#phase?.turn_of_driving_deg ?? 0, "mend"), {
    id: "dial-take",
    className: "primary",
  });
  #curve = s("path", { class: "curve" });
  #needle = s("line", { class: "needle" });
  #mark = s("path", { class: "best" });
  #knob = s(
    "svg",
    {
      viewBox: `${-RADIUS - 12} ${-RADIUS - 12} ${2 * RADIUS + 24} ${2 * RADIUS + 24}`,
      class: "knob",
      role: "slider",
      tabindex: 0,
      id: "dial-knob",
      "aria-label": "Turn of the driving gear's holes",
    },
    s("circle", { r: RADIUS, class: "rim" }),
    this.#curve,
    this.#mark,
    this.#needle,
    s("circle", { r: 4, class: "hub" }),
  );
  #picture = h("div", {});

  /**
   * @param {HTMLElement} place
   * @param {Design} design
   */
  constructor(place, design) {
    this.place = place;
    this.design = design;
    place.append(
      this.#summary,
      h(
        "div",
        { className: "dial" },
        this.#knob,
        h("div", {}, this.#words, inLine(this.#take), note(WORKSHOP)),
        this.#picture,
      ),
    );
    this.#knob.addEventListener("pointerdown", (event) => this.#grab(event));
    this.#knob.addEventListener("keydown", (event) => this.#press(event));
    design.onChange(() => {
      this.#isLive = false;
      this.#point();
    });
  }

  /**
   * Shows what the results of a design tell of the phase.
   *
   * @param {NamedDesign} design
   */
  show({ results, submission }) {
    const { blank } = submission.pair.driving;
    const origin = phaseOf(blank);
    this.#phase = origin === null ? null : (results.hole_phase ?? null);
    this.place.hidden = !this.#phase;
    if (!this.#phase) return;
    this.#origin = origin ?? 0;
    this.#isLive = true;
    this.#draw(this.#phase);
    this.#point();
  }

  /** The turn of the holes from where the results have them, within a hole pitch. */
  get #turn() {
    const now = phaseOf(this.design.submission.pair?.driving?.blank);
    return this.#phase && now !== null ? within(now - this.#origin, pitchOf(this.#phase)) : 0;
  }

  /** @param {HolePhase} phase */
  #draw(phase) {
    const { turn_of_driving_deg: turns, amplitude_um: amplitudes, peak_to_peak_um: ranges } = phase.over_turn;
    const most = Math.max(...amplitudes);
    const points = turns.map((turn, i) => {
      const [x, y] = this.#at(turn, NONE + ((RADIUS - NONE - 6) * amplitudes[i]) / (most || 1));
      return `${x.toFixed(2)} ${y.toFixed(2)}`;
    });
    this.#curve.setAttribute("d", `M${points.join("L")}Z`);
    const [tip, left, right] = [
      this.#at(phase.turn_of_driving_deg, RADIUS),
      ...[-1, 1].map((side) => this.#at(phase.turn_of_driving_deg + (side * pitchOf(phase)) / 60, RADIUS + 11)),
    ];
    this.#mark.setAttribute("d", `M${tip.join(" ")}L${left.join(" ")}L${right.join(" ")}Z`);
    this.#picture.replaceChildren(
      figure({
        lines: [
          { name: `order ${phase.order}`, color: "var(--series-1)", x: turns, y: amplitudes },
          { name: "peak-to-peak", color: "var(--series-2)", dash: [5, 4], x: turns, y: ranges },
        ],
        x: "turn of the driving gear's holes in °",
        y: "STE in µm",
        title: "Transmission error over the turn of the driving gear's holes, at first order",
        yRange: [0, 1.05 * Math.max(...ranges)],
        height: 220,
      }),
    );
  }

  /**
   * Where a turn is on the dial, so far from its middle: a hole pitch goes once around, from the top.
   *
   * @param {number} turn
   * @param {number} radius
   */
  #at(turn, radius) {
    const angle = (2 * Math.PI * turn) / (this.#phase ? pitchOf(this.#phase) : 360);
    return [radius * Math.sin(angle), -radius * Math.cos(angle)];
  }

  /** Points to where the holes stand, and says what that comes to. */
  #point() {
    const phase = this.#phase;
    if (!phase) return;
    const turn = this.#turn;
    const [x2, y2] = this.#at(turn, RADIUS - 4);
    dress(this.#needle, { x1: 0, y1: 0, x2, y2 });
    const now = this.#isLive ? phase.amplitude_now_um : amplitudeAt(phase, turn);
    const [told, best] = [now, phase.amplitude_um].map((each) => number(each, 2));
    this.#summary.textContent = `Holes in phase: ${told} µm now, ${best} µm at best`;
    this.#words.textContent = wordsOf(phase, turn);
    const rest = within(phase.turn_of_driving_deg - turn, pitchOf(phase));
    this.#take.textContent = `Turn them by ${number(rest, 3)}°`;
    this.#take.disabled = rest === 0;
    dress(this.#knob, {
      "aria-valuemin": 0,
      "aria-valuemax": pitchOf(phase),
      "aria-valuenow": turn,
      "aria-valuetext": `turned by ${number(turn, 3)} degrees, ${told} micrometers; the best turn is ${number(phase.turn_of_driving_deg, 3)} degrees`,
    });
  }

  /**
   * @param {number} turn from where the results have the holes, in degrees
   * @param {"drag" | "mend"} by
   */
  #turnTo(turn, by) {
    const { blank } = this.design.submission.pair.driving;
    this.design.setAll(turnedBy(blank, turn - this.#turn), by);
  }

  /** @param {PointerEvent} event */
  #grab(event) {
    const phase = this.#phase;
    if (event.button !== 0 || !phase) return;
    event.preventDefault();
    this.#knob.focus();
    this.design.hold();
    /** @type {(moved: PointerEvent) => void} */
    const move = (moved) => {
      const box = this.#knob.getBoundingClientRect();
      const [x, y] = [moved.clientX - box.x - box.width / 2, moved.clientY - box.y - box.height / 2];
      const turn = (Math.atan2(x, -y) / (2 * Math.PI)) * pitchOf(phase);
      this.#turnTo(within(Math.round(turn / HAND) * HAND, pitchOf(phase)), "drag");
    };
    this.#knob.setPointerCapture(event.pointerId);
    this.#knob.addEventListener("pointermove", move);
    move(event);
    const end = () => {
      this.#knob.removeEventListener("pointermove", move);
      this.design.release();
    };
    for (const name of ["pointerup", "pointercancel"]) this.#knob.addEventListener(name, end, { once: true });
  }

  /** @param {KeyboardEvent} event */
  #press(event) {
    const phase = this.#phase;
    if (!phase || event.ctrlKey || event.metaKey) return;
    const step = event.shiftKey ? FINE : STEP;
    /** @type {Record<string, number>} */
    const steps = {
      ArrowRight: step,
      ArrowUp: step,
      ArrowLeft: -step,
      ArrowDown: -step,
      PageUp: COARSE,
      PageDown: -COARSE,
      Home: -this.#turn,
    };
    if (!(event.key in steps)) return;
    event.preventDefault();
    this.#turnTo(within(this.#turn + steps[event.key], pitchOf(phase)), "drag");
    this.design.release();
  }
}
