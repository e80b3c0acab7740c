// Reports and tables as text: what is read of them, and what is left.

import assert from "node:assert/strict";
import { test } from "node:test";
import { read, valuesOfPasted } from "../../../web/state/pasted.js";
import { example } from "./contract.mjs";

const base = example("standard-pair");
const materialOf = (words) => ["16MnCr5", "POM"].find((name) => words.toLowerCase().includes(name.toLowerCase()));
const valuesOf = (text, decimal) => valuesOfPasted(read(text, decimal), base, materialOf);

test("a report in English is read, and what is no nominal size is left", () => {
  const report = `
                                            -------- Gear 1 -------- Gear 2 --
Number of teeth                        [z]               27               79
Normal module (mm)                     [mn]            2.0000
Pressure angle at normal section (°)   [alfn]         20.0000
Helix angle at reference circle (°)    [beta]         14.5000
Hand of gear                                        left            right
Centre distance (mm)                   [a]            109.500
Facewidth (mm)                         [b]            28.00            27.50
Profile shift coefficient              [x]            0.2000          -0.0530
Generating profile shift coefficient   [xE.e/i]       0.18/0.17     -0.08/-0.09
Tip diameter (mm)                      [da]           60.350          167.100
Tip form diameter (mm)                 [dFa]          60.1            167.0
Transverse module (mm)                 [mt]            2.0658
Working pressure angle (°)             [alfwt]        20.9
Torque (Nm)                            [T]           200.000          585.185
Speed (1/min)                          [n]          3000.0           1025.3
Material                               18CrNiMo7-6   16MnCr5`;
  const pasted = read(report);
  assert.deepEqual(valuesOfPasted(pasted, base, materialOf), {
    "/pair/driving/tooth_count": 27,
    "/pair/driving/module_mm": 2,
    "/pair/driving/pressure_angle_deg": 20,
    "/pair/driving/profile_shift": 0.2,
    "/pair/driving/face_width_mm": 28,
    "/pair/driving/tip_diameter_mm": 60.35,
    "/pair/driving/addendum_mm": undefined,
    "/pair/driven/tooth_count": 79,
    "/pair/driven/module_mm": 2,
    "/pair/driven/pressure_angle_deg": 20,
    "/pair/driven/profile_shift": -0.053,
    "/pair/driven/face_width_mm": 27.5,
    "/pair/driven/tip_diameter_mm": 167.1,
    "/pair/driven/addendum_mm": undefined,
    "/pair/driven/material/name": "16MnCr5",
    "/pair/center_distance_mm": 109.5,
    "/pair/helix_angle_deg": -14.5,
    "/method": "three_dimensional",
    "/driving_speed_rpm": 3000,
    "/output_torques_n_m": [585.185],
  });
  for (const words of ["Generating profile", "Tip form", "Transverse module", "Working pressure"])
    assert.ok(
      pasted.left.some((line) => line.startsWith(words)),
      words,
    );
});

test("a German table with decimal commas is read, columns the other way round too", () => {
  const rows = [
    "\tRad\tRitzel",
    "Zähnezahl\t83\t18",
    "Normalmodul [mm]\t0,8\t0,8",
    "Achsabstand a\t40,650",
    "Zahnbreite b (mm)\t7,5\t8",
    "Bohrungsdurchmesser (mm)\t12\t5",
    "Kopfhöhenfaktor\t1,0\t1,0",
    "E-Modul (N/mm²)\t2.850\t2850",
    "Dichte (g/cm³)\t1,41\t1,41",
    "Werkstoff\tPOM-C\tPOM-C",
    "Leistung (kW)\t0,1",
    "Drehzahl Ritzel (1/min)\t3.000",
  ];
  const values = valuesOf(rows.join("\n"));
  assert.equal(values["/pair/driving/tooth_count"], 18);
  assert.equal(values["/pair/driven/tooth_count"], 83);
  assert.equal(values["/pair/center_distance_mm"], 40.65);
  assert.equal(values["/pair/driving/face_width_mm"], 8);
  assert.equal(values["/pair/driven/blank/bore_radius_mm"], 6);
  assert.equal(values["/pair/driven/addendum_mm"], 0.8);
  assert.equal(values["/pair/driven/material/youngs_modulus_gpa"], 2.85);
  assert.equal(values["/pair/driving/material/youngs_modulus_gpa"], 2.85);
  assert.equal(values["/pair/driving/material/density_kg_m3"], 1410);
  assert.equal(values["/pair/driving/material/name"], "POM");
  // 100 W at 3000 rpm are 0.3183 N m, times 83/18.
  assert.ok(Math.abs(values["/output_torques_n_m"][0] - 1.46776) < 1e-5, String(values["/output_torques_n_m"]));
  assert.equal(values["/driving_speed_rpm"], 3000);
});

test("symbols alone, one gear a line and single spaces are read, and a mass is no module", () => {
  const text = "z1 18\nz2 83\nm 0.8\na = 40.65\nx1 0.25\nT1 2\nmass m 0.3\nGrade 7 8\nhello";
  const pasted = read(text);
  const values = valuesOfPasted(pasted, base, materialOf);
  assert.deepEqual(values, {
    "/pair/driving/tooth_count": 18,
    "/pair/driving/module_mm": 0.8,
    "/pair/driving/profile_shift": 0.25,
    "/pair/driven/tooth_count": 83,
    "/pair/driven/module_mm": 0.8,
    "/pair/center_distance_mm": 40.65,
    "/output_torques_n_m": [Number(((2 * 83) / 18).toPrecision(6))],
  });
  assert.deepEqual(pasted.left, ["mass m 0.3", "Grade 7 8", "hello"]);
});

test("the decimal sign of a text is that of its numbers, unless somebody says another one", () => {
  assert.equal(read("a 40,65").decimal, ",");
  assert.equal(read("a 1,234.5").decimal, ".");
  assert.equal(valuesOf("a 40.650")["/pair/center_distance_mm"], 40.65);
  assert.equal(valuesOf("a 40.650", ",")["/pair/center_distance_mm"], 40650);
  assert.deepEqual(read("").taken, []);
});
