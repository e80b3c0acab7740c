// Limits of the sizes that decide the backlash, and the load by either gear or by power.

import assert from "node:assert/strict";
import { test } from "node:test";
import { drivingOf, outputOf, powerOf, sizesOf, torqueOf, valuesAt } from "../../../web/state/limits.js";

const pair = {
  center_distance_mm: 40.65,
  driving: { tooth_count: 18, span_measurement: { teeth: 3, length_mm: 6.29 } },
  driven: { tooth_count: 83 },
};

test("backlash grows with the center distance, and falls with the thickness by whichever measure a gear has", () => {
  const sizes = sizesOf(pair);
  assert.deepEqual(
    sizes.map(({ title, value }) => [title, value]),
    [
      ["Center distance", 40.65],
      ["W_k, driving gear", 6.29],
      ["A_sn, driven gear", 0],
    ],
  );
  const off = [
    [-0.0125, 0.0125],
    [-0.03, -0.01],
    [-60, -30],
  ];
  const nominal = sizes.map(({ value }) => value);
  const [distance, span, thickness] = sizes.map(({ pointer }) => pointer);
  assert.deepEqual(valuesAt(sizes, nominal, off, "least"), { [distance]: 40.6375, [span]: 6.28, [thickness]: -30 });
  assert.deepEqual(valuesAt(sizes, nominal, off, "most"), { [distance]: 40.6625, [span]: 6.26, [thickness]: -60 });
  assert.deepEqual(valuesAt(sizes, nominal, off, "nominal"), { [distance]: 40.65, [span]: 6.29, [thickness]: 0 });
  assert.deepEqual(valuesAt(sizes, nominal, [off[0], [0, 0], [0, 0]], "most"), { [distance]: 40.6625 });
});

test("torques go with the ratio, and power with the speed", () => {
  assert.equal(outputOf(18, pair), 83);
  assert.equal(drivingOf(83, pair), 18);
  // 1 kW at 9549.3 rpm is 1 N m.
  assert.ok(Math.abs(torqueOf(1, 9549.2966) - 1) < 1e-8);
  assert.ok(Math.abs(powerOf(torqueOf(3, 1450), 1450) - 3) < 1e-12);
});
