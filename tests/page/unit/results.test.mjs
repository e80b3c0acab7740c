// What is made of results: tables, lines, names of orders, quantities, and programs that ask for them again.

import assert from "node:assert/strict";
import { test } from "node:test";
import { cellsOf, cured, faceOf, rampAt, wordsOfCure } from "../../../web/draw/face.js";
import { forceAt } from "../../../web/state/motion.js";
import { wordsOf } from "../../../web/state/orders.js";
import { withPoints } from "../../../web/state/points.js";
import { calledOf, inRow, inUnit, inWords, quantityOf, shown, worstInRow } from "../../../web/state/quantities.js";
import { linesOf, namesOf, ordersOf, PANELS, partialSpectrum, placedNames, spanOf } from "../../../web/state/series.js";
import { snippets } from "../../../web/state/snippets.js";
import { csv, csvOf, fileOfDesign, ordersCsv, withCommas } from "../../../web/state/tables.js";
import { measured, tableOf } from "../../../web/views/deviations.js";
import { ANSWERS, valueOf } from "../../../web/views/headline.js";
import { seenByDeuteranopia } from "../colors.mjs";
import { example } from "./contract.mjs";

/** A curve over so many mesh periods, with two pairs that share the load. */
function curveOver(periods, perPeriod = 40) {
  const mesh_position = Array.from({ length: periods * perPeriod }, (_, i) => i / perPeriod);
  return {
    output_torque_n_m: 115,
    mesh_position,
    transmission_error_um: mesh_position.map((at) => 10 + Math.cos(2 * Math.PI * at)),
    load_shares: [0, -1].map((pair_offset) => ({
      pair_offset,
      share: mesh_position.map((at) => (pair_offset === 0 ? at % 1 : 1 - (at % 1))),
    })),
    statistics: { partial: false },
  };
}

test("charts and tables have the points between positions, an event twice", () => {
  const curve = {
    ...curveOver(1, 4),
    between: {
      mesh_position: [0.3, 0.3, 0.6],
      transmission_error_um: [12, 12, 8],
      load_shares: [0, -1].map((pair_offset) => ({ pair_offset, share: [0.3, 0.3, 0.6] })),
    },
  };
  const merged = withPoints(curve);
  assert.deepEqual(merged.mesh_position, [0, 0.25, 0.3, 0.3, 0.5, 0.6, 0.75]);
  assert.deepEqual(merged.load_shares[0].share, [0, 0.25, 0.3, 0.3, 0.5, 0.6, 0.75]);
  const [line] = linesOf(PANELS[0], [{ name: "a", results: { curves: [curve] } }]);
  assert.equal(Math.max(...line.values) - Math.min(...line.values), 4);
  assert.equal(new Set(line.x).size, 7);
  assert.equal(line.span, 1);
  assert.equal(
    csv({ curves: [curve] })
      .trimEnd()
      .split("\r\n").length,
    8,
  );
  const earlier = curveOver(1);
  assert.equal(withPoints(earlier), earlier);
});

test("no text of a table becomes a formula, also behind what cannot be seen", () => {
  const texts = ["=1", "\u00a0=1", "\u3164@x", "\u061c＝1", "\tx", "a=1", "10°-20°"];
  const cells = texts.map((text) => csvOf([[text]]).replace(/\r\n$/, ""));
  assert.deepEqual(cells, ["'=1", "'\u00a0=1", "'\u3164@x", "'\u061c＝1", "'\tx", "a=1", "10°-20°"]);
  assert.equal(csvOf([["a,b", 'say "so"', null, 1.5]]), '"a,b","say ""so""",,1.5\r\n');
});

test("curves and orders come as tables with a line for each position and order", () => {
  const spectrum = { order: [0, 50], transmission_error_um: [10, 1], named: [{ order: 50, label: "H_Z2" }] };
  const results = { curves: [{ ...curveOver(1, 4), spectrum }] };
  const lines = csv(results).trimEnd().split("\r\n");
  assert.equal(lines.length, 5);
  assert.match(lines[0], /^output_torque_n_m,mesh_position,.*load_share\.-1,load_share\.0$/);
  assert.match(lines[2], /^115,0\.25,/);
  assert.match(ordersCsv(results), /\r\n115,50,1,,,,H_Z2\r\n$/);
  assert.equal(fileOfDesign("50/50, 10×r7.5@34", "curves.csv"), "meshwright-50-50-10xr7.5-34-curves.csv");
});

test("the lines of a panel span their periods, and crowded pairs of teeth are one line", () => {
  const share = PANELS.find(({ id }) => id === "share");
  const design = { results: { curves: [curveOver(83)] }, name: "", look: 0 };
  const [most] = linesOf(share, [design], true);
  assert.deepEqual([Math.round(most.span), Math.min(...most.values), Math.max(...most.values)], [83, 50, 100]);
  assert.equal(linesOf(share, [design]).length, 4);
  const [long, short] = linesOf(PANELS[0], [design, { ...design, results: { curves: [curveOver(2)] }, look: 1 }]);
  assert.equal(spanOf(curveOver(2)), 2);
  assert.equal(short.values.length, long.values.length, "the shorter period goes on repeating itself");
});

test("the names of orders cross no mark, and the most that any design has there is where they stand", () => {
  // A name of a low order between tall neighbors.
  const stems = [
    [40, 0.5],
    [50, 0.1],
    [60, 0.6],
    [100, 0.3],
  ].map(([order, value]) => ({ order, value }));
  const names = stems.map(({ order, value }) => ({ order, value, label: `H_${order}` }));
  const widthOf = (label) => 7 * label.length;
  const place = { px: (order) => 2 * order, py: (value) => 300 - 300 * value, left: 0, right: 400 };
  const placed = placedNames(names, { stems, mark: 3, letter: 11, widthOf, ...place });
  const crosses = ({ x, y, label }) =>
    stems.some(({ order, value }) => Math.abs(2 * order - x) < 3.5 * label.length + 3 && 300 - 300 * value - 3 < y);
  assert.ok(placed.length >= 3);
  assert.deepEqual(placed.filter(crosses), []);
  // A low line beside a high one has its name beside it, not above the high one.
  const [high, low] = [
    { order: 50, value: 0.7, label: "H_N" },
    { order: 56, value: 0.05, label: "H_2N" },
  ];
  const [, beside] = placedNames([high, low], { stems: [high, low], mark: 3, letter: 11, widthOf, ...place });
  assert.equal(beside.label, "H_2N");
  assert.ok(place.py(low.value) - beside.y < 2 * 11, `${place.py(low.value) - beside.y} px above its mark`);
  const spectra = [0.2, 0.4].map((value) => ({
    named: [{ order: 50, label: "H_Z2", transmission_error_um: value }],
    orders: [[50, value]],
  }));
  assert.deepEqual(namesOf(spectra, 100), [{ order: 50, label: "H_Z2", value: 0.4 }]);
  // Of two lines at 1 and 3 % of the largest the one is too short to be named.
  const short = {
    named: [
      [60, 0.004],
      [70, 0.012],
    ].map(([order, value]) => ({ order, label: `H_${order}`, transmission_error_um: value })),
    orders: [
      [60, 0.004],
      [70, 0.012],
    ],
  };
  assert.deepEqual(
    namesOf([...spectra, short], 100, 0.02).map(({ label }) => label),
    ["H_Z2", "H_70"],
  );
});

test("an order of one amplitude is found in a part of the true period", () => {
  const spectrum = partialSpectrum(curveOver(8), 50, 220);
  const orders = ordersOf({ spectrum }).filter(([, value]) => value > 0.9);
  assert.deepEqual(
    orders.map(([order, value]) => [order, Number(value.toFixed(3))]),
    [[50, 1]],
  );
});

test("orders are told in words", () => {
  const order = (rest) => ({ gears: [], label: "", ...rest });
  assert.equal(wordsOf(order({ kind: "mesh", mesh_harmonic: 2 })), "mesh, second order");
  assert.equal(wordsOf(order({ kind: "holes", multiple: 1 })), "holes");
  assert.equal(wordsOf(order({ kind: "hole_sideband", mesh_harmonic: 1, multiple: -2 })), "mesh less 2 times holes");
  const revolution = order({ kind: "revolution", multiple: 1, gears: ["driven"] });
  assert.equal(wordsOf(revolution), "revolution of the driven gear");
});

test("a quantity that the page does not know is called by its name, and values are printed in its unit", () => {
  const unknown = quantityOf("later_um");
  assert.deepEqual([inUnit(unknown), calledOf(unknown)], ["later_um", "later_um"]);
  const stiffness = { ...unknown, title: "Mesh stiffness", of: "curve", symbol: "k", printed: "N/µm", factor: 1e-6 };
  assert.deepEqual(
    [inUnit(stiffness), inWords(stiffness), calledOf(stiffness)],
    ["Mesh stiffness in N/µm", "mesh stiffness", "k"],
  );
  assert.deepEqual(
    [shown(stiffness, 3.25e8), shown(stiffness, 12), shown(stiffness, null)],
    ["325.00", "0.000012", "–"],
  );
});

test("a row tells the numbers of its own gear, and the worst over its torques", () => {
  const mass = { ...quantityOf("mass_kg.driven"), of: "pair", gear: "driven" };
  const error = { ...quantityOf("transmission_error_um.rms"), of: "curve", better: "smaller" };
  const curve = (rms) => ({ statistics: { transmission_error_um: { rms } } });
  const row = { mass_kg: 2, curves: [curve(1), curve(3)] };
  assert.equal(inRow(mass, row, row.curves[0], "driven"), 2);
  assert.equal(inRow(mass, row, row.curves[0], "driving"), undefined);
  assert.equal(worstInRow(error, row, "driven"), 3);
  assert.equal(worstInRow({ ...error, better: "larger" }, row, "driven"), 1);
  assert.ok(Number.isNaN(worstInRow(error, { curves: [{ statistics: null }] }, "driven")), "nothing is told");
});

test("however long the period, the load along the face is drawn with no more cells than are seen, and no peak is lost", () => {
  const positions = Array.from({ length: 20_000 }, (_, i) => i / 40);
  const face = faceOf({
    mesh_position: positions,
    face: {
      z_mm: [-1, 0, 1],
      load_n_per_mm: positions.map((_, i) => [i === 4321 ? 9 : 1, 1, 1]),
      face_load_factor: 1,
      load_centroid_mm: [],
    },
  });
  const cells = cellsOf(face, [0, 500], 500 / 700);
  assert.ok(cells.length > 1500 && cells.length < 2200, `${cells.length} cells`);
  assert.equal(Math.max(...cells.map(({ part }) => part)), 1);
});

test("the colors of loads are told apart by lightness alone, with deuteranopia too", () => {
  const ramp = Array.from({ length: 11 }, (_, i) => rampAt(i / 10));
  const lightness = ramp.map((color) => seenByDeuteranopia(color)[0]);
  for (let i = 1; i < lightness.length; i += 1)
    assert.ok(lightness[i] - lightness[i - 1] > 4, `${ramp[i]}: ${lightness}`);
});

test("a cure adds to the slope and the crowning that are there, and is told where it wins something", () => {
  const cure = { lead_slope_um: 3, crowning_um: -5, face_load_factor: 1.1 };
  const leads = cured([{ kind: "crowning", amount_um: 5 }, { kind: "table" }], cure);
  assert.deepEqual(leads, [{ kind: "table" }, { kind: "slope", amount_um: 3 }]);
  assert.match(
    wordsOfCure({ cure, face_load_factor: 1.5 }),
    /^K_Hβ would be 1\.10 with a slope of 3\.0 µm more and a crowning of 5\.0 µm less on/,
  );
  assert.equal(wordsOfCure({ cure, face_load_factor: 1.1 }), null);
});

test("the force is that of the table, nothing in the backlash, and against the gears behind it", () => {
  const table = {
    load_n: [0, 100, 200],
    transmission_error_um: [[0], [1], [2]],
    other_flank_transmission_error_um: [[-5], [-6], [-7]],
  };
  assert.deepEqual(
    [1.5, 0.5, -2, -5.5].map((at) => forceAt(table, 0, at)),
    [150, 50, 0, -50],
  );
});

test("measured teeth are read from spreadsheets, by the names of their columns or as a single one", () => {
  assert.deepEqual(tableOf("1,5\n2,5").rows, [[1.5], [2.5]]);
  assert.deepEqual(tableOf("f_pt;slope\n1,5;2\n-1,5;0").rows, [
    [1.5, 2],
    [-1.5, 0],
  ]);
  assert.deepEqual(measured("pitch_single_um\n1\n2\n3", 3, "").pitch_single_um, [-1, 0, 1], "they sum to zero");
  assert.deepEqual(measured("1\n2\n3", 3, "profile_slope_um"), { profile_slope_um: [1, 2, 3] });
  assert.throws(() => measured("1\n2", 3, ""), /There are 2 numbers; 3 are needed/);
  assert.throws(() => measured("1\nx\n3", 3, ""), /Line 2 has something that is no number/);
});

test("programs ask for the same results: with curl, from Python and from TypeScript", () => {
  const submission = { ...example("test-case-2"), stress: true, force_table: null };
  const { curl, python, typescript } = snippets(submission, "http://here.example/");
  assert.ok(curl.startsWith("curl -s http://here.example/v1/jobs "));
  const sent = /<<'JSON'\n([\s\S]*)\nJSON\n$/.exec(curl)?.[1] ?? "";
  assert.deepEqual(JSON.parse(sent), submission);
  assert.match(python, /"stress": True,\n {4}"force_table": None/);
  assert.match(python, /with Client\("http:\/\/here\.example"\)/);
  assert.match(typescript, /const submission: Submission = \{/);
  for (const program of [curl, python, typescript]) assert.doesNotMatch(program, /mw_/);
});

test("answers are quantities of the service, in their printed unit, or the page's own", () => {
  const curve = {
    ...curveOver(1),
    pairs_in_contact: [1, 1, 2, 2],
    quantities: { "transmission_error_um.peak_to_peak": 2, mesh_order_um: 0.5, hole_order_um: null },
  };
  const value = (id) =>
    valueOf(
      ANSWERS.find((answer) => answer.id === id),
      curve,
    );
  assert.deepEqual(["p-p", "h-z", "h-n", "share", "stress"].map(value), [2, 0.5, null, 50, null]);
});

test("a quantity that results do not come to, or do not tell, is no number to compare designs by", () => {
  const answer = ANSWERS.find(({ id }) => id === "pressure");
  assert.equal(valueOf(answer, curveOver(1)), null);
  const curve = (largest) => ({ ...curveOver(1), quantities: { peak_contact_pressure_mpa: largest } });
  assert.equal(valueOf(answer, curve(null)), null);
  assert.equal(valueOf(answer, curve(81)), 81);
});

test("a table has decimal commas and semicolons where that is chosen, and its texts stay", () => {
  const lines = [
    ["name", "a, b", "a;b"],
    ["10×r7.5@34", 0.25, -1.5e-7],
    [115, null, 'say "1.5"'],
  ];
  assert.equal(withCommas(csvOf(lines)), 'name;"a, b";"a;b"\r\n10×r7.5@34;0,25;-1,5e-7\r\n115;;"say ""1.5"""\r\n');
});
