// The study of what a design is sensitive to, and its bars.

import assert from "node:assert/strict";
import { test } from "node:test";
import { barsOf, js7, studyOf } from "../../../web/state/sensitivity.js";
import { kindOf } from "../../../web/state/work.js";
import { example } from "./contract.mjs";

const base = example("standard-pair");
const limits = { torque: 20, distance: 0.0175, misalignment: 10 };

test("every limit is one design, and misalignment is asked of methods along the face alone", () => {
  const study = studyOf({ ...base, output_torques_n_m: [100, 50] }, limits, "s");
  assert.deepEqual(study.base.output_torques_n_m, [100]);
  assert.deepEqual(
    study.designs.map(({ label, changes }) => [label, changes]),
    [
      ["as it is", {}],
      ["torque -", { "/output_torques_n_m": [80] }],
      ["torque +", { "/output_torques_n_m": [120] }],
      ["center distance -", { "/pair/center_distance_mm": base.pair.center_distance_mm - 0.0175 }],
      ["center distance +", { "/pair/center_distance_mm": base.pair.center_distance_mm + 0.0175 }],
    ],
  );
  assert.equal(kindOf(study), "sensitivity");
  const misaligned = { ...base.pair, misalignment_um: { in_plane_um: 3 } };
  const { designs } = studyOf({ ...base, pair: misaligned, method: "three_dimensional" }, limits, "s");
  assert.deepEqual(
    designs.slice(5).map(({ changes }) => changes),
    [
      { "/pair/misalignment_um/in_plane_um": -7 },
      { "/pair/misalignment_um/in_plane_um": 13 },
      { "/pair/misalignment_um/out_of_plane_um": -10 },
      { "/pair/misalignment_um/out_of_plane_um": 10 },
    ],
  );
  assert.equal(studyOf(base, { ...limits, torque: 0 }, "s").designs.length, 3);
});

test("bars stand around the value as it is, the longest first, and one that cannot be has its reason", () => {
  const row = (label, changes, value, problem = null) => ({
    label,
    changes,
    curves: value === null ? [] : [{ value }],
    problem: problem && { detail: problem },
  });
  const { value, bars } = barsOf(
    [
      row("as it is", {}, 2),
      row("torque -", { "/output_torques_n_m": [80] }, 1.9),
      row("torque +", { "/output_torques_n_m": [120] }, 2.2),
      row("center distance -", { "/pair/center_distance_mm": 99.9 }, null, "no backlash"),
      row("center distance +", { "/pair/center_distance_mm": 100.1 }, 3),
    ],
    ({ curves: [curve] }) => curve.value,
  );
  assert.equal(value, 2);
  assert.deepEqual(bars, [
    { name: "center distance", by: "± 0.1 mm", low: null, high: 3, wrong: "no backlash" },
    { name: "torque", by: "± 20 %", low: 1.9, high: 2.2, wrong: null },
  ]);
  assert.deepEqual(
    barsOf([row("as it is", {}, null)], () => NaN),
    { value: null, bars: [] },
  );
});

test("the limit of a center distance is js7 as ISO 286-2 prints it", () => {
  assert.deepEqual([50, 80, 100.5, 120, 250, 400].map(js7), [0.0125, 0.015, 0.0175, 0.0175, 0.023, 0.0285]);
});
