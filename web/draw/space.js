// @ts-check
// The pair in space: turned by hand, touch and keys, with its lines of contact at the position shown. Made when it is
// first asked for, painted when something changes.

import { debounced, h, inLine, labelled, signButton } from "./dom.js";
import { indexAt } from "./drawing.js";
import { faceOf, rampAt, scaleOf } from "./face.js";
import { pixelOf, Raster } from "./raster.js";
import { alongAxis, contactAt, contactLines, surfaceOf } from "./solid.js";
import { ViewJob } from "./viewjob.js";
import { json } from "../state/api.js";
import { MEMBERS } from "../state/design.js";
import { extent, fixed, number } from "../state/numbers.js";

/** @import { Along } from "./solid.js" */
/** @import { Curve, GearName, NamedDesign, Pair, PairOutline, PatternCurve } from "../state/documents.js" */

const TURN = Math.PI / 180;
/** The view that it begins with: from the side of +z, a little from above and from the right. */
const VIEW = { yaw: -32, pitch: 24, zoom: 1 };
/** How much a place beside the middle rises in it. */
const RISE = Math.sin(VIEW.pitch * TURN) * Math.abs(Math.sin(VIEW.yaw * TURN));
const MOST_ZOOM = 12;
/** Pixels that are painted while something moves, and when it rests. */
const MOVING = 260_000;
const RESTING = 2_400_000;
/** Milliseconds until it rests. */
const REST = 180;
/** Where light comes from, and how much is everywhere. */
const LIGHT = [-0.35, 0.55, 0.76];
const AMBIENT = 0.42;

/**
 * How points of the drawing come to pixels and a depth: `size` is that of a millimeter.
 *
 * @typedef {{ size: number, point: (x: number, y: number, z: number) => [number, number, number] }} Projection
 */

/** @typedef {{ pair: number, points: { z: number, at: number[], load: number, part: number }[] }} LoadedLine */

export class Space {
  #view = { ...VIEW };
  #members = new Set(MEMBERS);
  /** @type {PairOutline | null} */
  #outline = null;
  /** @type {Pair | null} */
  #pair = null;
  /** @type {Curve | null} */
  #curve = null;
  /** @type {(PatternCurve & { most?: number }) | null} */
  #pattern = null;
  #position = 0;
  /** @type {Partial<Record<GearName, ReturnType<typeof surfaceOf>>>} */
  #surfaces = {};
  #wanted = false;
  #shown = false;
  #asked = 0;

  /**
   * In `place`; `live` waits for the results of the design and gives them, or null.
   *
   * @param {HTMLElement} place
   * @param {{ live: () => Promise<NamedDesign | null> }} parts
   */
  constructor(place, { live }) {
    this.live = live;
    this.canvas = h("canvas", {
      className: "space",
      tabIndex: 0,
      role: "application",
      aria: {
        label: "The pair in space: arrows turn it, plus and minus zoom, 0 goes back to the beginning",
        describedby: "space-words",
      },
    });
    this.words = h("p", { className: "visually-hidden", id: "space-words" });
    this.legend = h("p", { className: "legend" });
    const told = h("p", { className: "note", id: "space-job", role: "status" });
    this.job = new ViewJob(told);
    const gears = h(
      "select",
      { id: "space-gears", on: { change: ({ target }) => this.#choose(target.value) } },
      ...[
        ["both", "both gears"],
        ["driving", "driving gear"],
        ["driven", "driven gear"],
      ].map(([value, name]) => h("option", { value }, name)),
    );
    this.element = h(
      "div",
      { className: "in-space", hidden: true },
      this.canvas,
      inLine(
        signButton("◀", "Turn to the left", () => this.#turn(-15, 0)),
        signButton("▶", "Turn to the right", () => this.#turn(15, 0)),
        signButton("▲", "Turn up", () => this.#turn(0, 15)),
        signButton("▼", "Turn down", () => this.#turn(0, -15)),
        signButton("+", "Zoom in", () => this.#zoom(1.3)),
        signButton("−", "Zoom out", () => this.#zoom(1 / 1.3)),
        signButton("Reset", "Reset the view", () => this.#reset()),
        ...labelled("Show", gears),
        this.legend,
      ),
      told,
      this.words,
    );
    place.append(this.element);
    this.raster = new Raster(this.canvas);
    this.settle = debounced(REST, () => this.#paint(true));
    this.tell = debounced(REST, () => this.#tell());
    new ResizeObserver(() => this.#ask()).observe(this.canvas);
    this.#hands();
    this.canvas.addEventListener("keydown", (event) => this.#press(event));
  }

  get isShown() {
    return this.#shown;
  }

  show() {
    this.#shown = true;
    this.element.hidden = false;
    this.#fetch();
    this.#ask();
  }

  hide() {
    this.#shown = false;
    this.element.hidden = true;
    this.job.end();
  }

  /**
   * Another pair, or the same one with other holes: `pair` is that of the submission.
   *
   * @param {PairOutline} outline
   * @param {Pair} pair
   */
  setPair(outline, pair) {
    [this.#outline, this.#pair, this.#surfaces] = [outline, pair, {}];
    this.#ask();
  }

  /**
   * The curve whose loads are shown; null: none are known yet.
   *
   * @param {Curve | null} curve
   */
  setCurve(curve) {
    [this.#curve, this.#pattern] = [curve, null];
    this.#fetch();
    this.#ask();
  }

  /** @param {number} position */
  setPosition(position) {
    this.#position = position;
    this.#ask();
  }

  /** The page looks different. */
  restyle() {
    this.#ask();
  }

  /**
   * The loads on each line by themselves, which a job tells; until then, and without it, the load on the face stands
   * for them.
   */
  async #fetch() {
    this.#asked += 1;
    const asked = this.#asked;
    this.job.end();
    if (!this.#shown || !this.#curve?.face || this.#pattern) return;
    const live = await this.live();
    if (!live || asked !== this.#asked || !this.#shown) return;
    const torque = live.results.curves[0].output_torque_n_m;
    const told = await this.job.of(live, "the load on each line", ({ id }, signal) =>
      json(`v1/jobs/${id}/results/contact-pattern.json?torque=${torque}`, { signal }),
    );
    if (!told || asked !== this.#asked) return;
    this.#pattern = told.curves[0] ?? null;
    this.#ask();
  }

  /** @param {string} which */
  #choose(which) {
    this.#members = new Set(MEMBERS.filter((each) => which === "both" || which === each));
    this.#ask();
  }

  /**
   * @param {number} yaw
   * @param {number} pitch
   */
  #turn(yaw, pitch) {
    this.#view.yaw += yaw;
    this.#view.pitch = Math.min(90, Math.max(-90, this.#view.pitch + pitch));
    this.#ask();
  }

  /** @param {number} by */
  #zoom(by) {
    this.#view.zoom = Math.min(MOST_ZOOM, Math.max(0.5, this.#view.zoom * by));
    this.#ask();
  }

  #reset() {
    this.#view = { ...VIEW };
    this.#ask();
  }

  /** @param {KeyboardEvent} event */
  #press(event) {
    const by = event.shiftKey ? 15 : 5;
    const work = {
      ArrowLeft: () => this.#turn(-by, 0),
      ArrowRight: () => this.#turn(by, 0),
      ArrowUp: () => this.#turn(0, by),
      ArrowDown: () => this.#turn(0, -by),
      "+": () => this.#zoom(1.2),
      "-": () => this.#zoom(1 / 1.2),
      0: () => this.#reset(),
    }[event.key];
    if (!work || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    work();
  }

  /** One pointer turns, two zoom; a wheel zooms with the control key, as a pinch on a pad does. */
  #hands() {
    /** @type {Map<number, number[]>} */
    const held = new Map();
    const apart = () => {
      const [one, other] = [...held.values()];
      return Math.hypot(one[0] - other[0], one[1] - other[1]);
    };
    this.canvas.addEventListener("pointerdown", (event) => {
      if (event.button !== 0) return;
      this.canvas.setPointerCapture(event.pointerId);
      held.set(event.pointerId, [event.clientX, event.clientY]);
    });
    this.canvas.addEventListener("pointermove", (event) => {
      const last = held.get(event.pointerId);
      if (!last) return;
      const before = held.size > 1 ? apart() : null;
      held.set(event.pointerId, [event.clientX, event.clientY]);
      if (before) this.#zoom(apart() / before);
      else this.#turn((event.clientX - last[0]) * 0.5, (event.clientY - last[1]) * 0.5);
    });
    for (const name of /** @type {const} */ (["pointerup", "pointercancel"]))
      this.canvas.addEventListener(name, (event) => held.delete(event.pointerId));
    this.canvas.addEventListener(
      "wheel",
      (event) => {
        if (!event.ctrlKey) return;
        event.preventDefault();
        this.#zoom(Math.exp(-event.deltaY / 200));
      },
      { passive: false },
    );
  }

  /** Paints with the next frame: coarse while something moves, and fine when it rests. */
  #ask() {
    if (!this.#shown || this.#wanted) return;
    this.#wanted = true;
    requestAnimationFrame(() => {
      this.#wanted = false;
      this.#paint(false);
      this.settle();
      this.tell();
    });
  }

  /** @param {boolean} fine */
  #paint(fine) {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!this.#shown || !this.#outline || !this.#pair || !width || !height) return;
    const most = Math.min(2, devicePixelRatio * (fine ? 2 : 1));
    const scale = Math.min(fine ? Math.max(most, 1.5) : most, Math.sqrt((fine ? RESTING : MOVING) / (width * height)));
    const [w, hgt] = [Math.round(width * scale), Math.round(height * scale)];
    const begun = performance.now();
    this.raster.clear(w, hgt);
    const along = alongAxis(this.#pair, this.#outline);
    const project = this.#projection(this.#outline, w, hgt);
    const style = getComputedStyle(document.documentElement);
    for (const member of MEMBERS.filter((each) => this.#members.has(each)))
      this.#paintGear(this.#outline, member, along, project, style, scale);
    this.#paintLines(this.#loaded(this.#outline, along), along, project, scale);
    this.raster.done();
    // For those who test: what was painted last.
    this.canvas.dataset.milliseconds = fixed(performance.now() - begun, 1);
    this.canvas.dataset.painted = `${fine ? "fine" : "coarse"} ${fixed(this.#position, 3)} ${fixed(this.#view.yaw, 1)} ${fixed(this.#view.pitch, 1)} ${fixed(this.#view.zoom, 2)}`;
  }

  /**
   * How points of the drawing, with z from the middle of the driving face, come to pixels and a depth.
   *
   * @param {PairOutline} outline
   * @param {number} width
   * @param {number} height
   * @returns {Projection}
   */
  #projection({ driving, driven, line_of_action: line }, width, height) {
    const [r1, r2, a] = [driving.circles.tip_mm, driven.circles.tip_mm, driven.center_mm[0]];
    const [yaw, pitch] = [this.#view.yaw * TURN, this.#view.pitch * TURN];
    const [cy, sy, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
    // Nearer is nearer to where the teeth meet.
    const pitchPoint = line.points[2].at_mm;
    const part = 1 - 1 / Math.max(1, this.#view.zoom) ** 2;
    const center = (a + r2 - r1) / 2;
    const middle = [center, 0].map((value, i) => value + part * (pitchPoint[i] - value));
    // As it is seen first one gear stands higher than the other.
    const tall = Math.max(r1 + RISE * Math.abs(center), r2 + RISE * Math.abs(a - center));
    const size = this.#view.zoom * Math.min(width / (1.04 * (r1 + a + r2)), height / (2.08 * tall));
    return {
      size,
      point: (x, y, z) => {
        const [u, v] = [x - middle[0], y - middle[1]];
        const [right, toward] = [cy * u + sy * z, -sy * u + cy * z];
        return [width / 2 + size * right, height / 2 - size * (cp * v - sp * toward), size * (sp * v + cp * toward)];
      },
    };
  }

  /**
   * @param {PairOutline} pair
   * @param {GearName} member
   * @param {Along} along
   * @param {Projection} project
   * @param {CSSStyleDeclaration} style
   * @param {number} scale
   */
  #paintGear(pair, member, { twists, mid, offset }, project, style, scale) {
    const outline = pair[member];
    const gear = this.#pair?.[member];
    if (!gear) return;
    const shift = member === "driven" ? offset : 0;
    const surface = (this.#surfaces[member] ??= surfaceOf(outline, gear, twists[member], mid - shift));
    const { points, triangles, edges } = surface;
    const angle = (outline.angle_deg + this.#position * outline.angle_per_mesh_period_deg) * TURN;
    const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
    const count = points.length / 3;
    const seen = new Float32Array(points.length);
    for (let i = 0; i < count; i += 1) {
      const [x, y, z] = [points[3 * i], points[3 * i + 1], points[3 * i + 2]];
      const [px, py, pz] = project.point(
        outline.center_mm[0] + x * cos - y * sin,
        outline.center_mm[1] + x * sin + y * cos,
        z + shift,
      );
      seen[3 * i] = px;
      seen[3 * i + 1] = py;
      seen[3 * i + 2] = pz;
    }
    /** @type {(name: string) => number[]} */
    const colorOf = (name) => {
      const text = style.getPropertyValue(name).trim();
      return [1, 3, 5].map((i) => parseInt(text.length > 4 ? text.slice(i, i + 2) : text[(i + 1) / 2].repeat(2), 16));
    };
    const base = colorOf(member === "driving" ? "--steel" : "--steel-2");
    const shades = Array.from({ length: 65 }, (_, i) =>
      pixelOf(base.map((value) => Math.min(255, Math.round(value * (AMBIENT + (1.12 - AMBIENT) * (i / 64)))))),
    );
    for (let t = 0; t < triangles.length; t += 3) {
      const [a, b, c] = [3 * triangles[t], 3 * triangles[t + 1], 3 * triangles[t + 2]];
      // Two sides in the view, whose y points down there.
      const [ux, uy, uz] = [seen[b] - seen[a], seen[a + 1] - seen[b + 1], seen[b + 2] - seen[a + 2]];
      const [vx, vy, vz] = [seen[c] - seen[a], seen[a + 1] - seen[c + 1], seen[c + 2] - seen[a + 2]];
      const nz = ux * vy - uy * vx;
      if (nz <= 0) continue;
      const [nx, ny] = [uy * vz - uz * vy, uz * vx - ux * vz];
      const light = Math.max(0, (nx * LIGHT[0] + ny * LIGHT[1] + nz * LIGHT[2]) / Math.hypot(nx, ny, nz));
      this.raster.triangle(
        seen[a],
        seen[a + 1],
        seen[a + 2],
        seen[b],
        seen[b + 1],
        seen[b + 2],
        seen[c],
        seen[c + 1],
        seen[c + 2],
        shades[Math.round(light * 64)],
      );
    }
    const edge = pixelOf(colorOf(member === "driving" ? "--steel-edge" : "--steel-2-edge"));
    const lift = 0.002 * project.size * pair.driven.circles.tip_mm;
    for (let i = 0; i < edges.length; i += 2) {
      const [a, b] = [3 * edges[i], 3 * edges[i + 1]];
      this.raster.line(
        seen[a],
        seen[a + 1],
        seen[a + 2],
        seen[b],
        seen[b + 1],
        seen[b + 2],
        Math.max(1, 0.7 * scale),
        lift,
        edge,
      );
    }
  }

  /**
   * The lines of contact over both gears, which hide them: by color what they carry.
   *
   * @param {LoadedLine[]} lines
   * @param {Along} along
   * @param {Projection} project
   * @param {number} scale
   */
  #paintLines(lines, along, project, scale) {
    // Each after the one below it, however their depths are rounded.
    /** @type {(line: LoadedLine, wide: number, lift: number, colorOf: (part: number) => number) => void} */
    const paint = ({ points }, wide, lift, colorOf) =>
      points.slice(1).forEach((to, i) => {
        const from = points[i];
        this.raster.line(
          ...project.point(from.at[0], from.at[1], from.z + along.mid),
          ...project.point(to.at[0], to.at[1], to.z + along.mid),
          wide,
          lift,
          colorOf((from.part + to.part) / 2),
        );
      });
    const dark = pixelOf([16, 16, 20]);
    for (const line of lines) paint(line, 6 * scale, 1e6, () => dark);
    for (const line of lines) paint(line, 4 * scale, 2e6, (part) => pixelOf(rampAt(part)));
  }

  /**
   * The lines at the position shown, each point with its part of the largest load.
   *
   * @param {PairOutline} outline
   * @param {Along} along
   * @returns {LoadedLine[]}
   */
  #loaded(outline, along) {
    if (this.#pattern) {
      // As they were computed: under load they reach a little beyond the line of action.
      const [{ lines }, most] = [this.#nearestPosition(this.#pattern), this.#mostOfPattern(this.#pattern)];
      return lines.map(({ pair_offset: pair, z_mm: z, load_n_per_mm: loads }) => ({
        pair,
        points: z.map((each, i) => ({
          z: each,
          at: contactAt(outline, along, this.#position, pair, each),
          load: loads[i],
          part: loads[i] / most,
        })),
      }));
    }
    const face = this.#curve && faceOf(this.#curve);
    const row = this.#curve && face?.rows[face.every ? indexAt(this.#curve, this.#position) : 0];
    /** @type {(z: number) => number} */
    const loadAt = (z) => (face && row ? at(face.z, row, z) : 0);
    return contactLines(outline, along, this.#position).map((line) => ({
      ...line,
      points: line.points.map((point) => ({
        ...point,
        load: loadAt(point.z),
        part: face ? loadAt(point.z) / face.most : 0,
      })),
    }));
  }

  /** @param {PatternCurve} pattern */
  #nearestPosition({ positions }) {
    const span =
      positions.length > 1 ? positions.length * (positions[1].mesh_position - positions[0].mesh_position) : 1;
    /** @type {(position: { mesh_position: number }) => number} */
    const apart = ({ mesh_position: each }) =>
      Math.abs(((((each - this.#position) % span) + 1.5 * span) % span) - span / 2);
    return positions.reduce((best, each) => (apart(each) < apart(best) ? each : best));
  }

  /** @param {PatternCurve & { most?: number }} pattern */
  #mostOfPattern(pattern) {
    pattern.most ??= Math.max(
      extent(pattern.positions.flatMap(({ lines }) => lines.flatMap(({ load_n_per_mm: loads }) => loads)))?.[1] ?? 0,
      1e-9,
    );
    return pattern.most;
  }

  /** What is seen, for those who do not see it, and the scale of the colors. */
  #tell() {
    if (!this.#shown || !this.#outline || !this.#pair) return;
    const along = alongAxis(this.#pair, this.#outline);
    const lines = this.#loaded(this.#outline, along);
    const angle = this.#pair.helix_angle_deg ?? 0;
    const teeth = angle
      ? `helical teeth of ${number(Math.abs(angle))}°, the driving gear ${angle > 0 ? "right" : "left"}-handed`
      : "straight teeth";
    const face = this.#curve && faceOf(this.#curve);
    const each = lines.map(({ points }, i) => {
      const most = points.reduce((best, point) => (point.load > best.load ? point : best));
      const ends = `from z = ${fixed(points[0].z, 1)} to ${fixed(points[points.length - 1].z, 1)} mm`;
      return `line ${i + 1} ${ends}${face ? `, most at z = ${fixed(most.z, 1)} mm with ${number(most.load, 3)} N/mm` : ""}`;
    });
    const loads = !this.#curve
      ? "Loads are not computed yet."
      : !face
        ? "The method tells no load along the face."
        : this.#pattern
          ? "Colors are the load on each line."
          : `Colors are the load on the face at that z${face.every ? "" : ", the mean over the positions"}, all lines together.`;
    this.words.textContent = `${this.#outline.driving.tooth_count} and ${this.#outline.driven.tooth_count} teeth, ${teeth}. At position ${fixed(this.#position, 2)} ${lines.length === 1 ? "one line of contact" : `${lines.length} lines of contact`}: ${each.join("; ")}. ${loads}`;
    this.legend.replaceChildren(
      ...(face
        ? ["Load", scaleOf(this.#pattern ? this.#mostOfPattern(this.#pattern) : face.most)]
        : [`${lines.length} ${lines.length === 1 ? "line" : "lines"} of contact`]),
    );
    this.legend.title = loads;
  }
}

/**
 * The value of a line through points at a place, its ends beyond them.
 *
 * @type {(places: number[], values: number[], place: number) => number}
 */
function at(places, values, place) {
  const next = places.findIndex((each) => each >= place);
  if (next <= 0) return values[next < 0 ? values.length - 1 : 0];
  const part = (place - places[next - 1]) / (places[next] - places[next - 1]);
  return values[next - 1] + part * (values[next] - values[next - 1]);
}
