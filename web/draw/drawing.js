// @ts-check
// The pair as it is cut: turned by hand, its holes dragged, contact forces at the position shown.

import { deformedShape } from "./deformed.js";
import { dress, s } from "./dom.js";
import { HoleHandles, openingsOf } from "./holes.js";
import { MEMBERS } from "../state/design.js";
import { number } from "../state/numbers.js";

/** @import { Design } from "../state/design.js" */
/** @import { Curve, GearName, GearOutline, LoadedEdges, PairOutline } from "../state/documents.js" */

const TURN = Math.PI / 180;
/** What a line may lie beside the profile where both gears are in view, in mm: a tenth of a pixel. */
const FROM_AFAR = 0.02;

/**
 * A gear in the drawing: `draw` paints its profile for the view, `show` takes another outline.
 *
 * @typedef {{ rotor: SVGGElement, holes: HoleHandles, readonly outline: GearOutline | null, draw: () => void,
 *   show: (outline: GearOutline) => void }} DrawnGear
 */

export class Drawing {
  /** @type {PairOutline | null} */
  #outline = null;
  /** @type {Curve | null} */
  #curve = null;
  /** @type {Record<GearName, DrawnGear>} */
  #gears;
  #view = "pair";
  #position = 0;
  /** @type {ReturnType<typeof deformedShape> | null} */
  #deformed = null;
  /** @type {((position: number) => number) | null} */
  #factorAt = null;

  /**
   * Draws in `place`. `onTurn` is told the mesh position that a hand turned to.
   *
   * @param {HTMLElement} place
   * @param {Design} design
   * @param {{ onTurn: (to: number) => void }} hearers
   */
  constructor(place, design, { onTurn }) {
    this.design = design;
    this.onTurn = onTurn;
    this.svg = s("svg", { class: "gears", role: "group", "aria-label": "The gear pair from its true geometry" });
    this.overlay = s("g", { class: "overlay", "aria-hidden": "true" });
    this.forces = s("g", { class: "forces", "aria-hidden": "true" });
    this.#gears = { driving: this.#gear("driving"), driven: this.#gear("driven") };
    this.world = s(
      "g",
      { transform: "scale(1 -1)" },
      ...MEMBERS.map((member) => this.#gears[member].rotor),
      this.overlay,
      this.forces,
    );
    this.svg.append(this.world);
    place.replaceChildren(this.svg);
    new ResizeObserver(() => this.#scale()).observe(this.svg);
    this.#turnByHand();
  }

  get element() {
    return this.svg;
  }

  /** @param {string} view */
  setView(view) {
    this.#view = view;
    for (const { draw } of Object.values(this.#gears)) draw();
    this.#frame();
  }

  /**
   * Shows another pair. What a hand holds stays in it: elements are changed, not made anew.
   *
   * @param {PairOutline} outline
   */
  setOutline(outline) {
    this.#outline = outline;
    for (const member of MEMBERS) this.#gears[member].show(outline[member]);
    this.#line();
    this.refreshHoles();
    this.#frame();
    this.setPosition(this.#position);
  }

  /**
   * Takes the forces from this curve; null: none are known yet.
   *
   * @param {Curve | null} curve
   */
  setCurve(curve) {
    this.#curve = curve;
    this.#drawForces();
  }

  /**
   * Shows the pair under load in place of the one without; null takes it away. Gives how it is drawn.
   *
   * @param {LoadedEdges | null} edges
   */
  setDeformed(edges) {
    this.#deformed?.element.remove();
    this.#deformed = edges && this.#outline && deformedShape(edges, this.#outline);
    if (this.#deformed) this.world.prepend(this.#deformed.element);
    this.svg.classList.toggle("under-load", Boolean(edges));
    return this.#deformed;
  }

  /**
   * Shows forces as they are in motion: `factorAt` gives them over the static ones at a mesh position; null shows the
   * static ones.
   *
   * @param {((position: number) => number) | null} factorAt
   */
  setMotion(factorAt) {
    this.#factorAt = factorAt;
    this.#drawForces();
  }

  /**
   * Turns both gears to a mesh position.
   *
   * @param {number} position
   */
  setPosition(position) {
    this.#position = position;
    if (!this.#outline) return;
    for (const { rotor, outline } of Object.values(this.#gears)) {
      if (!outline) continue;
      const angle = outline.angle_deg + position * outline.angle_per_mesh_period_deg;
      rotor.setAttribute("transform", `translate(${outline.center_mm.join(" ")}) rotate(${angle})`);
    }
    this.#drawForces();
  }

  /**
   * Draws the holes as the design has them, whether or not they can be made.
   *
   * @param {string[]} wrong pointers of what is wrong with the design
   */
  refreshHoles(wrong = []) {
    // Without its gears a hole has no place.
    if (this.#outline) for (const gear of Object.values(this.#gears)) gear.holes.refresh(wrong);
  }

  /**
   * @param {GearName} member
   * @returns {DrawnGear}
   */
  #gear(member) {
    const body = s("path", { class: `body ${member}` });
    const [pitch, base] = ["pitch", "base"].map((name) => s("circle", { class: name }));
    const bore = s("circle", { class: "opening" });
    const web = s("path", { class: "web" });
    const openings = s("path", { class: "opening" });
    const tooth0 = s("circle", { class: "tooth0" });
    const cross = s("path", { class: "cross" });
    const holes = new HoleHandles(member, this.design, (event) => this.#inGear(member, event));
    const marks = s("g", { class: "circles", "aria-hidden": "true" }, pitch, base);
    const rotor = s(
      "g",
      { class: `rotor ${member}`, "data-member": member },
      body,
      web,
      marks,
      bore,
      openings,
      holes.element,
      cross,
      tooth0,
    );
    /** @type {DrawnGear["outline"]} */
    let shown = null;
    /** @type {string | null} */
    let drawn = null;
    // All points of the profile are painted anew at every move of a hole, so that there are no more than can be seen.
    const draw = () => {
      if (!shown) return;
      const { tooth_count: count, tooth_mm: all } = shown;
      const tooth = this.#view === "pair" ? thinned(all, FROM_AFAR) : all;
      const path = outlinePath(tooth, count);
      if (path !== drawn) body.setAttribute("d", path);
      drawn = path;
    };
    /** @type {DrawnGear["show"]} */
    const show = (outline) => {
      const { tip_mm: tip, root_mm: root, pitch_mm, base_mm } = outline.circles;
      const same =
        JSON.stringify(outline.tooth_mm) === JSON.stringify(shown?.tooth_mm) &&
        outline.tooth_count === shown?.tooth_count;
      shown = outline;
      if (!same) draw();
      dress(pitch, { r: pitch_mm });
      dress(base, { r: base_mm });
      dress(bore, { r: outline.bore_radius_mm });
      dress(tooth0, { r: (tip - root) / 9, cx: (root + tip) / 2 });
      openings.setAttribute(
        "d",
        openingsOf(outline, this.design.get(`/pair/${member}/blank`))
          .map((line) => `M${line.map((point) => point.join(" ")).join("L")}Z`)
          .join(""),
      );
      web.setAttribute("d", outline.web ? ringPath(outline.web) : "");
      cross.setAttribute("d", `M${-0.12 * root} 0H${0.12 * root}M0 ${-0.12 * root}V${0.12 * root}`);
    };
    return {
      rotor,
      holes,
      draw,
      show,
      get outline() {
        return shown;
      },
    };
  }

  #line() {
    if (!this.#outline) return;
    const { line_of_action: line, driving, driven } = this.#outline;
    const size = driving.circles.tip_mm - driving.circles.root_mm;
    this.overlay.replaceChildren(
      s("path", { d: `M${line.from_mm.join(" ")}L${line.to_mm.join(" ")}`, class: "action" }),
      s("path", { d: `M${driving.center_mm.join(" ")}L${driven.center_mm.join(" ")}`, class: "centers" }),
      ...line.points.map((point) =>
        s("circle", { cx: point.at_mm[0], cy: point.at_mm[1], r: size / 16, class: "mark" }),
      ),
      ...line.points.map((point) =>
        text(point.name, [point.at_mm[0] + size * 0.12, point.at_mm[1] + size * 0.03], size / 4.5, "letter"),
      ),
      dimension(driving.circles, driven.circles, driven.center_mm[0]),
    );
  }

  /** An arrow for each pair of teeth that carries load, as long as its share. */
  #drawForces() {
    if (!this.#outline) return;
    const curve = this.#curve;
    if (!curve) return this.forces.replaceChildren();
    const { points, from_mm, to_mm } = this.#outline.line_of_action;
    const [a, e] = [points[0], points[4]];
    const along = [to_mm[0] - from_mm[0], to_mm[1] - from_mm[1]];
    const length = Math.hypot(...along);
    const unit = along.map((each) => each / length);
    const size = this.#outline.driving.circles.tip_mm - this.#outline.driving.circles.root_mm;
    const index = indexAt(curve, this.#position);
    const period = this.#position - Math.floor(this.#position);
    const factor = this.#factorAt?.(this.#position) ?? 1;
    this.svg.classList.toggle("parted", factor <= 0);
    const arrows = curve.load_shares.flatMap(({ pair_offset: offset, share }) => {
      const carried = share[index];
      if (!(carried > 1e-3) || factor <= 0) return [];
      const t = (period - offset - a.mesh_position) / (e.mesh_position - a.mesh_position);
      const at = [0, 1].map((i) => a.at_mm[i] + t * (e.at_mm[i] - a.at_mm[i]));
      const tip = [0, 1].map((i) => at[i] + unit[i] * size * 2.2 * carried * factor);
      return [arrow(at, tip, unit, size / 5), s("circle", { cx: at[0], cy: at[1], r: size / 14, class: "touch" })];
    });
    this.forces.replaceChildren(...arrows);
  }

  #frame() {
    if (!this.#outline) return;
    this.svg.setAttribute("data-view", this.#view);
    const { driving, driven, line_of_action: line } = this.#outline;
    const [r1, r2, a] = [driving.circles.tip_mm, driven.circles.tip_mm, driven.center_mm[0]];
    if (this.#view === "mesh") {
      const [x, y] = line.points[2].at_mm;
      const reach = 2.6 * (driving.circles.tip_mm - driving.circles.root_mm);
      this.svg.setAttribute("viewBox", `${x - 1.6 * reach} ${-y - reach} ${3.2 * reach} ${2 * reach}`);
      return this.#scale();
    }
    const margin = 0.03 * (r1 + r2);
    const height = Math.max(r1, r2) + margin;
    this.svg.setAttribute("viewBox", `${-r1 - margin} ${-height} ${r1 + a + r2 + 2 * margin} ${2 * height}`);
    return this.#scale();
  }

  /** Tells the style sheet how many mm of the drawing a pixel is, whose letters are those of the page. */
  #scale() {
    const { width, height } = this.svg.viewBox.baseVal;
    const { clientWidth, clientHeight } = this.svg;
    if (!width || !clientWidth || !clientHeight) return;
    this.svg.style.setProperty("--mm-per-px", String(Math.max(width / clientWidth, height / clientHeight)));
  }

  /**
   * Where a pointer is, in mm of the drawing.
   *
   * @param {PointerEvent} event
   */
  #inWorld(event) {
    const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(this.world.getScreenCTM()?.inverse());
    return [point.x, point.y];
  }

  /**
   * Where a pointer is in the frame of a gear, in mm.
   *
   * @param {GearName} member
   * @param {PointerEvent} event
   */
  #inGear(member, event) {
    const { outline } = this.#gears[member];
    const [x, y] = this.#inWorld(event);
    if (!outline) return [x, y];
    const angle = -TURN * (outline.angle_deg + this.#position * outline.angle_per_mesh_period_deg);
    const [dx, dy] = [x - outline.center_mm[0], y - outline.center_mm[1]];
    return [dx * Math.cos(angle) - dy * Math.sin(angle), dx * Math.sin(angle) + dy * Math.cos(angle)];
  }

  #turnByHand() {
    this.svg.addEventListener("pointerdown", (event) => {
      const target = /** @type {Element} */ (event.target);
      const member = MEMBERS.find((each) => each === target.closest("[data-member]")?.getAttribute("data-member"));
      if (!member || target.closest(".hole") || event.button !== 0) return;
      const { outline } = this.#gears[member];
      if (!outline) return;
      /** @type {(moved: PointerEvent) => number} */
      const angleOf = (moved) => {
        const [x, y] = this.#inWorld(moved);
        return Math.atan2(y - outline.center_mm[1], x - outline.center_mm[0]) / TURN;
      };
      let last = angleOf(event);
      /** @type {(moved: PointerEvent) => void} */
      const turn = (moved) => {
        const now = angleOf(moved);
        const by = ((now - last + 540) % 360) - 180;
        last = now;
        this.onTurn(this.#position + by / outline.angle_per_mesh_period_deg);
      };
      this.svg.setPointerCapture(event.pointerId);
      this.svg.addEventListener("pointermove", turn);
      const end = () => this.svg.removeEventListener("pointermove", turn);
      for (const name of ["pointerup", "pointercancel"]) this.svg.addEventListener(name, end, { once: true });
    });
  }
}

/**
 * The index of the computed position next to a mesh position.
 *
 * @type {(curve: Curve, position: number) => number}
 */
export function indexAt(curve, position) {
  const positions = curve.mesh_position;
  const count = positions.length;
  const step = count > 1 ? positions[1] - positions[0] : 1;
  return ((Math.round((position - positions[0]) / step) % count) + count) % count;
}

/**
 * Those of `points` that a line needs to stay within `tolerance` of all of them.
 *
 * @type {(points: number[][], tolerance: number) => number[][]}
 */
export function thinned(points, tolerance) {
  const [[x0, y0], [x1, y1]] = [points[0], points[points.length - 1]];
  const length = Math.hypot(x1 - x0, y1 - y0);
  const beside = points.map(([x, y]) => Math.abs((x - x0) * (y1 - y0) - (y - y0) * (x1 - x0)) / length);
  const farthest = beside.indexOf(Math.max(...beside));
  if (!(beside[farthest] > tolerance)) return [points[0], points[points.length - 1]];
  return [
    ...thinned(points.slice(0, farthest + 1), tolerance).slice(0, -1),
    ...thinned(points.slice(farthest), tolerance),
  ];
}

/** @type {(tooth: number[][], count: number) => string} */
function outlinePath(tooth, count) {
  /** @type {string[]} */
  const points = [];
  for (let i = 0; i < count; i += 1) {
    const [cos, sin] = [Math.cos((2 * Math.PI * i) / count), Math.sin((2 * Math.PI * i) / count)];
    // The last point of a tooth is the first of the next.
    for (const [x, y] of tooth.slice(0, -1))
      points.push(`${(x * cos - y * sin).toFixed(4)} ${(x * sin + y * cos).toFixed(4)}`);
  }
  return `M${points.join("L")}Z`;
}

/**
 * The ring between the edges of a web.
 *
 * @type {(web: { inner_radius_mm: number, outer_radius_mm: number }) => string}
 */
function ringPath({ inner_radius_mm: inner, outer_radius_mm: outer }) {
  /** @type {(r: number, way: number) => string} */
  const circle = (r, way) => `M${r} 0A${r} ${r} 0 0 ${way} ${-r} 0A${r} ${r} 0 0 ${way} ${r} 0Z`;
  return circle(outer, 1) + circle(inner, 0);
}

/** @type {(words: string, at: number[], size: number, name: string) => SVGTextElement} */
function text(words, [x, y], size, name) {
  const element = s("text", { transform: `translate(${x} ${y}) scale(1 -1)`, "font-size": size, class: name });
  element.textContent = words;
  return element;
}

/**
 * The center distance where it is over neither gear: below the smaller one, or between two that are about alike, at the
 * foot of the drawing, where they are farthest apart.
 *
 * @type {(driving: GearOutline["circles"], driven: GearOutline["circles"], a: number) => SVGTextElement}
 */
function dimension({ tip_mm: r1, pitch_mm: pitch }, { tip_mm: r2 }, a) {
  const [x, y, anchor] =
    r1 < 0.8 * r2
      ? [-r1, -0.94 * r2, "start"]
      : r2 < 0.8 * r1
        ? [a + r2, -0.94 * r1, "end"]
        : [pitch, -1.01 * Math.max(r1, r2), "middle"];
  const element = text(`a = ${number(a, 7)} mm`, [x, y], (r1 + r2) / 16, "dimension");
  element.setAttribute("text-anchor", anchor);
  return element;
}

/** @type {(from: number[], to: number[], unit: number[], head: number) => SVGGElement} */
function arrow(from, to, [ux, uy], head) {
  const base = [to[0] - head * ux, to[1] - head * uy];
  const side = [-uy * head * 0.4, ux * head * 0.4];
  const tip = `M${to.join(" ")}L${base[0] + side[0]} ${base[1] + side[1]}L${base[0] - side[0]} ${base[1] - side[1]}Z`;
  return s(
    "g",
    { class: "force" },
    s("path", { d: `M${from.join(" ")}L${base.join(" ")}`, class: "shaft" }),
    s("path", { d: tip, class: "head" }),
  );
}
