// The phase of the holes: what turns them, and what a turn comes to.

import assert from "node:assert/strict";
import { test } from "node:test";
import { hasMoreThanHoles, OPENINGS } from "../../../web/state/openings.js";
import { amplitudeAt, phaseOf, pitchOf, turnedBy, within, wordsOf } from "../../../web/state/phase.js";
import { resolve } from "../../../web/state/schema.js";
import { api } from "./contract.mjs";

const phase = {
  output_torque_n_m: 115,
  order: 10,
  turn_of_driving_deg: 28,
  amplitude_um: 0.01,
  amplitude_now_um: 0.4,
  other_flanks_turn_deg: 8,
  over_turn: {
    turn_of_driving_deg: [0, 18, 27, 29, 36],
    amplitude_um: [0.4, 0.6, 0.1, 0.08, 0.4],
    peak_to_peak_um: [],
  },
};

test("one pattern, several, holes at angles and spokes turn together, and an outline does not", () => {
  const holes = { count: 10, circle_radius_mm: 34, radius_mm: 7.5 };
  assert.deepEqual(turnedBy({ holes: { ...holes, phase_deg: 3 } }, 28.25), {
    "/pair/driving/blank/holes/phase_deg": 31.25,
  });
  const several = { holes: [holes, { at_deg: [10, 190] }], spokes: { phase_deg: -5 } };
  assert.deepEqual(turnedBy(several, -1), {
    "/pair/driving/blank/holes/0/phase_deg": -1,
    "/pair/driving/blank/holes/1/at_deg": [9, 189],
    "/pair/driving/blank/spokes/phase_deg": -6,
  });
  assert.deepEqual([phaseOf(several), phaseOf({ holes: [{ at_deg: [7] }] }), phaseOf({})], [0, 7, null]);
  assert.equal(phaseOf({ holes, outline: [] }), null);
});

test("an amplitude is found between turns, over the end of a hole pitch too", () => {
  assert.equal(pitchOf(phase), 36);
  assert.deepEqual(
    [0, 9, 27, 28, 36].map((turn) => Number(amplitudeAt(phase, turn).toFixed(9))),
    [0.4, 0.5, 0.1, 0.09, 0.4],
  );
  assert.deepEqual(
    [-1, 36, 40, 35.99999].map((turn) => within(turn, 36)),
    [35, 0, 4, 0],
  );
});

test("words tell the turn that is left, what a degree costs, and the other flanks", () => {
  assert.match(
    wordsOf(phase, 8),
    /0.01 µm .* turned by 20° more; 1° off leaves 0.1 µm.*other flanks the best turn is 0°/,
  );
});

test("every shape of openings that the schema has begins with what it requires", () => {
  const blank = api.components.schemas.Blank;
  const shapes = Object.entries(blank.properties).flatMap(([name, { oneOf = [] }]) =>
    oneOf.map((each) => [name, resolve(api, each)]).filter(([, { properties }]) => properties?.phase_deg),
  );
  assert.deepEqual(shapes.map(([name]) => name).sort(), Object.keys(OPENINGS).sort());
  const room = { inner: 20, outer: 40, isWeb: false, whole: 20, ligament: 1 };
  for (const [name, { required, properties }] of shapes) {
    const begun = OPENINGS[name](room);
    assert.deepEqual(
      required.filter((field) => !(field in begun)),
      [],
      name,
    );
    for (const [field, value] of Object.entries(begun))
      assert.ok(value >= properties[field].minimum && value <= properties[field].maximum, `${name} ${field} ${value}`);
  }
  assert.deepEqual([{ holes: {} }, { spokes: {} }, { holes: {}, outline: [] }].map(hasMoreThanHoles), [
    false,
    true,
    true,
  ]);
});
