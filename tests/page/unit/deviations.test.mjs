// Measured teeth as they are pasted or dropped.

import assert from "node:assert/strict";
import { test } from "node:test";
import { measured, traced } from "../../../web/views/deviations.js";

test("a machine's traces become one row a tooth of the flank that carries, material turned to what is taken off", () => {
  const file = [
    "tooth;flank;12,5;14;16,25",
    "2;right;1,5;-2;0",
    "1;left;9;9;9",
    "1;right;0,25;1;-0,5",
    "2;left;9;9;9",
  ].join("\n");
  assert.deepEqual(traced(file, 2, "profiles_by_roll_length", "right"), {
    profiles: {
      roll_length_mm: [12.5, 14, 16.25],
      removed_um: [
        [-0.25, -1, 0.5],
        [-1.5, 2, 0],
      ],
    },
  });
  assert.deepEqual(traced("tooth,-9,9\n0,1,2\n1,3,4", 2, "leads", "right"), {
    leads: {
      z_mm: [-9, 9],
      removed_um: [
        [-1, -2],
        [-3, -4],
      ],
    },
  });
});

test("traces that cannot be read say why", () => {
  /** @type {(text: string) => () => object} */
  const read = (text) => () => traced(text, 2, "profiles_by_diameter", "left");
  assert.throws(read("1;2;3\n4;5;6"), /name the columns/);
  assert.throws(read("tooth;flank;97;99\n1;left;0;0"), /1 traces of the left flank; 2 are needed/);
  assert.throws(read("tooth;97;99\n1;0;0\n1;0;0"), /each once/);
  assert.throws(read("tooth;97;99\n1;0;0\n2;0"), /tooth 2 has not 2 numbers/);
});

test("columns of single numbers are read as before", () => {
  assert.deepEqual(measured("fp\n1\n-1", 2, "profile_slope_um"), { pitch_single_um: [1, -1] });
});
