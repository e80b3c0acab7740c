// @ts-check
// The motion of the gears at a speed, step by step from the force table of the results: what turns the drawing. The
// numbers of a run-up are those of the service, which finds both branches; this goes on from where it was.

/** @import { Curve, Dynamics, ForceTable, Results } from "./documents.js" */

/** Steps in a period of the natural frequency, and in one of the mesh. */
const STEPS = 40;
/** What was at the beginning has died away after so many damped radians: exp(-7) is a thousandth. */
const DECAY = 7;
/** So many steps are taken at most; what has not settled then is shown as it is. */
const MOST_STEPS = 400_000;

/** @type {(row: number[], place: number) => number} */
const at = (row, place) => {
  const first = Math.floor(place) % row.length;
  const part = place - Math.floor(place);
  return row[first] + part * (row[(first + 1) % row.length] - row[first]);
};

/**
 * The force between the gears at a place of the table and an approach, in N and um: of the loaded flanks, zero in the
 * backlash, of the other flanks beyond it.
 *
 * @type {(table: ForceTable, place: number, approach: number) => number}
 */
export function forceAt(table, place, approach) {
  /** @type {(rows: number[][], sign: 1 | -1) => number} */
  const of = (rows, sign) => {
    if (sign * (approach - at(rows[0], place)) <= 0) return 0;
    let j = 0;
    while (j < rows.length - 2 && sign * (approach - at(rows[j + 1], place)) > 0) j += 1;
    const [low, high] = [at(rows[j], place), at(rows[j + 1], place)];
    return sign * (table.load_n[j] + ((approach - low) / (high - low)) * (table.load_n[j + 1] - table.load_n[j]));
  };
  return of(table.transmission_error_um, 1) || of(table.other_flank_transmission_error_um, -1);
}

/**
 * The motion that `results` have at a speed of the driving gear under the load of `curve`: `{ state, span, approach,
 * factor }` over one true period from position 0, the approach in um and the force over the static load. `from` is the
 * state that an earlier motion ended with.
 *
 * @param {Results & { force_table: ForceTable }} results
 * @param {Curve & { dynamics: Dynamics }} curve
 * @param {{ rpm: number, teeth: number, damping?: number, from?: [number, number] | null }} how
 */
export function motionAt(results, curve, { rpm, teeth, damping = 0.05, from = null }) {
  const table = results.force_table;
  const { natural_frequency_hz: natural, equivalent_mass_kg: mass } = curve.dynamics;
  const count = table.mesh_position.length;
  const span = results.pair.period_mesh_periods;
  const load = curve.output_torque_n_m / (results.pair.driven.base_radius_mm / 1000);
  const meshes = (teeth * rpm) / 60;
  const omega = 2 * Math.PI * natural;
  const perPeriod = Math.max(count / span, STEPS, Math.ceil((STEPS * natural) / meshes));
  const steps = Math.round(perPeriod * span);
  // Seconds, and places of the table, in a step.
  const [dt, forward] = [span / meshes / steps, count / steps];
  const rounds = Math.min(Math.ceil(DECAY / (damping * omega * dt * steps)), Math.floor(MOST_STEPS / steps)) + 1;
  /** @type {(place: number, x: number, v: number) => number} */
  const pull = (place, x, v) => (load - forceAt(table, place, x)) / mass - 2 * damping * omega * v;
  let [x, v] = from ?? [at(curve.transmission_error_um, 0), 0];
  /** @type {number[]} */
  const approach = [];
  /** @type {number[]} */
  const factor = [];
  for (let round = 0; round < rounds; round += 1) {
    for (let i = 0; i < steps; i += 1) {
      const place = i * forward;
      if (round === rounds - 1) {
        approach.push(x);
        factor.push(forceAt(table, place, x) / load);
      }
      // Velocities in m/s, approaches in um: Heun's method.
      const first = pull(place, x, v);
      const second = pull(place + forward, x + 1e6 * dt * v, v + dt * first);
      x += 1e6 * dt * (v + 0.5 * dt * first);
      v += 0.5 * dt * (first + second);
    }
  }
  /** @type {[number, number]} */
  const state = [x, v];
  return { state, span, approach, factor };
}
