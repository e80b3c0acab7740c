// @ts-check
// The pair under load: how it deforms at the position shown, many times enlarged, its edges colored by stress.

import { debounced, h, s } from "./dom.js";
import { ViewJob } from "./viewjob.js";
import { json } from "../state/api.js";
import { MEMBERS } from "../state/design.js";
import { isSolid } from "../state/dimensions.js";
import { number } from "../state/numbers.js";

/** @import { Drawing } from "./drawing.js" */
/** @import { GearName, GearOutline, LoadedEdges, NamedDesign, PairOutline } from "../state/documents.js" */

/** @typedef {{ at: number[][], stress: number[], by: number[][] }} StrainedEdge */

/** Stresses are told apart in so many steps. */
const STEPS = 6;
/** The largest displacement is drawn at most this part of a tooth's height. */
const REACH = 0.4;
/**
 * Fillets lie below this part of a tooth's height; above, contacts press on the flanks, which the grid does not
 * resolve.
 */
const FILLETS = 0.2;
/** Milliseconds until a position counts as chosen. */
const REST = 200;

/** Shows the pair of the live design deformed, as long as `button` is pressed and the design stays. */
export class Deformation {
  #on = false;
  /** Counts what was asked, so that an answer that nobody waits for any more is left. */
  #asked = 0;

  /**
   * `live` waits for the results that are shown and gives them with their submission, `position` is the mesh position.
   *
   * @param {{ drawing: Drawing, button: HTMLElement, note: HTMLElement, live: () => Promise<NamedDesign | null>,
   *   position: () => number }} parts
   */
  constructor({ drawing, button, note, live, position }) {
    this.drawing = drawing;
    this.button = button;
    this.note = note;
    this.job = new ViewJob(note);
    this.live = live;
    this.position = position;
    this.later = debounced(REST, () => this.#show());
    button.addEventListener("click", () => (this.#on ? this.off() : this.#turnOn()));
  }

  /** The gears stand elsewhere. */
  moved() {
    if (!this.#on) return;
    this.#hide();
    this.later();
  }

  /** Shows the pair without load again. */
  off() {
    if (!this.#on) return;
    this.#on = false;
    this.button.setAttribute("aria-pressed", "false");
    this.#hide();
    this.note.replaceChildren();
  }

  #turnOn() {
    this.#on = true;
    this.button.setAttribute("aria-pressed", "true");
    this.#show();
  }

  #hide() {
    this.#asked += 1;
    this.job.end();
    this.drawing.setDeformed(null);
  }

  async #show() {
    if (!this.#on) return;
    this.#asked += 1;
    const asked = this.#asked;
    const wanted = () => this.#on && asked === this.#asked;
    const live = await this.live();
    if (!live || !wanted()) return;
    const edges = await this.job.of(live, "the deformed pair", ({ id }, signal) =>
      json(`v1/jobs/${id}/results/edges.json?mesh_position=${this.position().toFixed(4)}`, { signal }),
    );
    const drawn = edges && wanted() && this.drawing.setDeformed(edges);
    if (!drawn) return;
    const { scale, top } = drawn;
    const section = isSolid(live.asked.method)
      ? "In the section through the middle of the common face; parts that end before it, where they end. "
      : "";
    this.note.replaceChildren(section, ...words(edges, scale, top));
  }
}

/**
 * What is seen, in words and as a scale of colors.
 *
 * @type {(edges: LoadedEdges, scale: number, top: number) => (string | HTMLElement)[]}
 */
function words({ output_torque_n_m: torque, mesh_position: position, driving, driven }, scale, top) {
  /** @type {(gear: LoadedEdges["driving"]) => number} */
  const most = (gear) =>
    Math.max(...[...gear.teeth, ...gear.openings].flatMap((edge) => edge.displacement_um.map((u) => Math.hypot(...u))));
  const colors = Array.from({ length: STEPS }, (_, i) => h("span", { className: `stress-step level-${i}` }));
  return [
    `At ${number(torque)} N m and position ${number(position, 4)}, displacements ${scale} times enlarged, the driven gear turned back by the transmission error; dashed without load. `,
    `Against its hub the driving gear moves by ${number(most(driving), 3)} µm at most, the driven one by ${number(most(driven), 3)} µm. `,
    "Von Mises stress at the edges: ",
    h("span", { className: "stress-scale" }, "0 ", ...colors, ` ${number(top, 3)} MPa`),
    ", the most at fillets and holes. ",
    "Near a contact, where it is higher, the grid does not resolve it.",
  ];
}

/**
 * A drawing of `edges`: its element, how many times displacements are enlarged, and the stress at which the color ends.
 *
 * @type {(edges: LoadedEdges, outline: PairOutline) => { element: SVGGElement, scale: number, top: number }}
 */
export function deformedShape(edges, outline) {
  const gears = MEMBERS.map((member) => moved(edges, outline, member));
  const all = gears.flatMap(({ teeth, openings }) => [...teeth, ...openings]);
  const { tip_mm: tip, root_mm: root } = outline.driving.circles;
  const scale = rounded((REACH * (tip - root)) / Math.max(...all.flatMap(({ by }) => by.map((u) => Math.hypot(...u)))));
  const top = Math.max(
    ...gears.flatMap(({ member, teeth, openings }) => [
      ...openings.flatMap(({ stress }) => stress),
      ...teeth.flatMap((edge) => belowFlanks(edge, outline[member])),
    ]),
  );
  const shapes = gears.flatMap(({ member, teeth, openings, bore }) => {
    const ring = teeth.flatMap((edge) => placed(edge, scale));
    const holes = openings.map((edge) => pathOf(placed(edge, scale)));
    const body = s("path", {
      class: `strained ${member}`,
      "fill-rule": "evenodd",
      d: [pathOf(ring), ...holes, ...(openings.length ? [] : [bore])].map((path) => `${path}Z`).join(""),
    });
    return [body, ...colored([...teeth, ...openings], scale, top)];
  });
  return { element: s("g", { class: "deformation", "aria-hidden": "true" }, ...shapes), scale, top };
}

/**
 * The edges of a gear with the displacement of each node in mm, that of the driven gear with its turn by the
 * transmission error.
 *
 * @type {(edges: LoadedEdges, outline: PairOutline, member: GearName) => { member: GearName, teeth: StrainedEdge[],
 *   openings: StrainedEdge[], bore: string }}
 */
function moved(edges, outline, member) {
  const {
    center_mm: [x0, y0],
    circles,
    bore_radius_mm: bore,
  } = outline[member];
  const turn = member === "driven" ? (1e-3 * edges.transmission_error_um) / circles.base_mm : 0;
  /** @type {(edge: LoadedEdges["driving"]["teeth"][number]) => StrainedEdge} */
  const of = ({ at_mm: at, displacement_um: u, von_mises_mpa: stress }) => ({
    at,
    stress,
    by: at.map(([x, y], i) => [1e-3 * u[i][0] - turn * (y - y0), 1e-3 * u[i][1] + turn * (x - x0)]),
  });
  return {
    member,
    teeth: edges[member].teeth.map(of),
    openings: edges[member].openings.map(of),
    bore: `M${x0 - bore} ${y0}a${bore} ${bore} 0 1 0 ${2 * bore} 0a${bore} ${bore} 0 1 0 ${-2 * bore} 0`,
  };
}

/**
 * The stresses of a tooth at its fillets.
 *
 * @type {(edge: StrainedEdge, gear: GearOutline) => number[]}
 */
function belowFlanks({ at, stress }, { center_mm: [x0, y0], circles: { root_mm: root, tip_mm: tip } }) {
  const reach = root + FILLETS * (tip - root);
  return stress.filter((_, i) => Math.hypot(at[i][0] - x0, at[i][1] - y0) < reach);
}

/** @type {(edge: StrainedEdge, scale: number) => number[][]} */
const placed = ({ at, by }, scale) => at.map(([x, y], i) => [x + scale * by[i][0], y + scale * by[i][1]]);
/** @type {(points: number[][]) => string} */
const pathOf = (points) => `M${points.map(([x, y]) => `${x.toFixed(3)} ${y.toFixed(3)}`).join("L")}`;

/**
 * A path for each step of stress: all pieces of edge that have it.
 *
 * @type {(all: StrainedEdge[], scale: number, top: number) => SVGPathElement[]}
 */
function colored(all, scale, top) {
  const paths = Array.from({ length: STEPS }, () => /** @type {string[]} */ ([]));
  for (const edge of all) {
    const points = placed(edge, scale);
    let begun = 0;
    /** @type {(i: number) => number} */
    const step = (i) => Math.min(STEPS - 1, Math.floor((STEPS * (edge.stress[i] + edge.stress[i + 1])) / (2 * top)));
    for (let i = 1; i < points.length; i += 1) {
      if (i < points.length - 1 && step(i) === step(i - 1)) continue;
      paths[step(i - 1)].push(pathOf(points.slice(begun, i + 1)));
      begun = i;
    }
  }
  return paths.map((pieces, i) => s("path", { class: `stress level-${i}`, d: pieces.join("") }));
}

/**
 * The largest of 1, 2, 5, 10, 20 and so on that is not above `value`.
 *
 * @type {(value: number) => number}
 */
function rounded(value) {
  const decade = 10 ** Math.floor(Math.log10(value));
  return decade * ([5, 2, 1].find((digit) => digit * decade <= value) ?? 1);
}
