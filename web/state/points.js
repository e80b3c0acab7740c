// @ts-check
// Curves with their points between positions: events, extremes, and further positions at which the contact was solved.

/** @import { Curve } from "./documents.js" */

/** @type {WeakMap<Curve, Curve>} */
const known = new WeakMap();

/**
 * A curve whose lists have the points between its positions, rising; an event stands twice. That of results of an
 * earlier version has none.
 *
 * @type {(curve: Curve) => Curve}
 */
export function withPoints(curve) {
  const { between, ...own } = curve;
  if (!between) return curve;
  const made = known.get(curve) ?? joined(own, between, orderOf(curve.mesh_position, between.mesh_position));
  known.set(curve, made);
  return made;
}

/**
 * For each place whether it is a point; one at a position stands before it.
 *
 * @type {(positions: number[], points: number[]) => boolean[]}
 */
function orderOf(positions, points) {
  /** @type {boolean[]} */
  const order = [];
  let next = 0;
  for (const position of positions) {
    for (; next < points.length && points[next] <= position; next += 1) order.push(true);
    order.push(false);
  }
  return [...order, ...points.slice(next).map(() => true)];
}

/**
 * Lists with those of the points in `order`, in all that both objects have.
 *
 * @type {(own: any, points: any, order: boolean[]) => any}
 */
function joined(own, points, order) {
  if (Array.isArray(own)) {
    const isOfObjects = typeof own[0] === "object" && own[0] !== null && !Array.isArray(own[0]);
    if (isOfObjects) return own.map((each, i) => joined(each, points[i], order));
    if (own.length + points.length !== order.length) return own;
    const places = [0, 0];
    return order.map((isPoint) => (isPoint ? points[places[1]++] : own[places[0]++]));
  }
  if (typeof own !== "object" || own === null) return own;
  return Object.fromEntries(
    Object.entries(own).map(([name, value]) => [
      name,
      points?.[name] === undefined ? value : joined(value, points[name], order),
    ]),
  );
}

/**
 * Rising places of which no two are the same, for charts that draw one value at each.
 *
 * @type {(places: number[]) => number[]}
 */
export const apart = (places) => places.map((place, i) => (place === places[i - 1] ? place + 1e-9 : place));
