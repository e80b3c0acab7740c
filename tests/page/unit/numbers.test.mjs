// Numbers as they are read, printed and estimated.

import assert from "node:assert/strict";
import { test } from "node:test";
import { allGiven, given, put } from "../../../web/draw/inputs.js";
import { extent, fixed, number, remaining, significant, timeOf, unit } from "../../../web/state/numbers.js";
import {
  chooseReading,
  inOtherUnit,
  numberOf,
  parsed,
  readingsOf,
  stepped,
  turned,
  unreadable,
  wordsOf,
} from "../../../web/state/typed.js";
import { changeOf } from "../../../web/views/headline.js";
import { api } from "./contract.mjs";

test("a number has a decimal point or a decimal comma, and thousands may stand apart", () => {
  for (const [text, value] of [
    ["1.5", 1.5],
    ["1,5", 1.5],
    [" -0,25 ", -0.25],
    ["\u22122", -2],
    ["1e-3", 0.001],
    [",5", 0.5],
    ["0,125", 0.125],
    ["0.125", 0.125],
    ["40,650", 40.65],
    ["23,319", 23.319],
    ["1234,567", 1234.567],
    ["1.234,5", 1234.5],
    ["1,234,567.25", 1234567.25],
    ["1,2,3", "1,2,3"],
    ["1.2.3", "1.2.3"],
    ["zwei", "zwei"],
  ])
    assert.equal(numberOf(text), value, text);
  assert.deepEqual(wordsOf("1,5 2;3, 4"), ["1,5", "2", "3", "4"]);
  assert.match(unreadable("1,2,3"), /no number: between two numbers/);
});

test("a point before three digits is read in two ways, until somebody has said that it is decimal", () => {
  for (const text of ["14.000", "206.000", "-1.410"]) assert.equal(numberOf(text), text);
  assert.deepEqual(readingsOf("14.000"), [14, 14000]);
  assert.deepEqual(["0.125", "14.0001", "1400.000", "14,000"].map(readingsOf), [null, null, null, null]);
  assert.match(unreadable("1.234"), /two ways: 1\.234 or 1234/);
  chooseReading(true);
  assert.equal(numberOf("14.000"), 14);
  chooseReading(false);
  assert.equal(numberOf("14.000"), "14.000");
});

test("what the page has written into a control has a decimal point", () => {
  const input = { value: "" };
  put(input, "60, 104.275");
  assert.deepEqual(allGiven(input), [60, 104.275]);
  input.value = "60, 104.275, 12.500";
  assert.throws(() => allGiven(input), /12\.5 or 12500/);
  put(input, "9.125");
  assert.equal(given(input), 9.125);
});

test("a density in g/cm3 and a modulus in MPa are known by the bounds of their fields", () => {
  const { properties } = api.components.schemas.Material;
  const meant = (name, value) => inOtherUnit(value, properties[name]);
  assert.deepEqual(meant("density_kg_m3", 1.41), { value: 1410, unit: "g/cm³" });
  assert.deepEqual(meant("youngs_modulus_gpa", 206000), { value: 206, unit: "MPa" });
  assert.equal(meant("density_kg_m3", 7850), null);
  assert.equal(meant("poisson_ratio", 30), null);
});

test("a text that may be JSON is read as such, and else stays a text", () => {
  assert.deepEqual(parsed('{"a":[1]}'), { a: [1] });
  assert.equal(parsed("{half"), "{half");
  assert.equal(parsed(" "), undefined);
});

const kindOf = (schema, whole = false) => ({ kind: "number", schema, optional: false, whole });

test("a number goes on by a tenth of its leading digit, within its bounds, and keeps its further digits", () => {
  assert.equal(stepped(7.5, 1, kindOf({})), 7.6);
  assert.equal(stepped(40.65, -1, kindOf({})), 39.65);
  assert.equal(stepped(50, 10, kindOf({}, true)), 60);
  assert.equal(stepped(0.95, 5, kindOf({ minimum: 0, maximum: 1 })), 1);
});

test("an arrow key turns the last digit that was typed, within the bounds of the number", () => {
  const up = (text, schema = {}) => turned(text, Number(text.replace(",", ".")), 1, kindOf(schema));
  assert.deepEqual(
    ["40.65", "40,650", "115", "-0.05"].map((text) => up(text)),
    ["40.66", "40.651", "116", "-0.04"],
  );
  assert.equal(turned("40.649", 40.649, 1, kindOf({})), "40.650", "the digit that was turned stays the last");
  assert.equal(turned("40.65", 40.65, -10, kindOf({})), "40.55");
  assert.equal(turned("", 0.05, 1, kindOf({})), "0.06", "a default has digits too");
  assert.equal(up("0.99", { maximum: 0.99 }), "0.99");
  assert.equal(turned("7", 7, 1, kindOf({}, true)), "8");
});

test("numbers are printed with the digits that they are asked for; what is none is a dash", () => {
  assert.deepEqual([number(13.8251), number(0.1, 8), number(1e-9), number(null)], ["13.83", "0.1", "1e-9", "–"]);
  assert.deepEqual([fixed(2, 2), fixed(NaN, 1), fixed(undefined, 1)], ["2.00", "–", "–"]);
  assert.deepEqual(
    [0.11, 0.0123, 12.34, 1234, 0].map((value) => significant(value, 3)),
    ["0.110", "0.0123", "12.3", "1234", "0.00"],
  );
  assert.deepEqual([unit("um"), unit("1"), unit("kg m^2"), unit(undefined)], ["µm", "", "kg m²", ""]);
  assert.deepEqual(
    [timeOf(200), timeOf(61_000), timeOf(600_000), timeOf(9_000_000)],
    ["1 s", "61 s", "10 min", "2.5 h"],
  );
  assert.deepEqual(extent([null, 3, NaN, -1, undefined]), [-1, 3]);
  assert.equal(extent([null]), null);
});

test("a change is told in percent, or not at all where it began at nothing", () => {
  assert.equal(changeOf(10.5, 10), "+5.0 %");
  assert.equal(changeOf(4, 10), "−60 %");
  assert.equal(changeOf(10.001, 10), "±0 %");
  assert.equal(changeOf(-5, -10), "+50 %");
  assert.equal(changeOf(0, 0), "±0 %");
  assert.equal(changeOf(1, 0), "");
});

test("the time that is left is that of the pace at which it goes now", () => {
  // 60 s for the gears, of which 3 % tell, then a percent each 0.65 s: 65 s before the end.
  let now = 0;
  const left = remaining(null, () => now);
  const all = [];
  const tell = (at, done) => {
    now = 1000 * at;
    all.push([at, done, left(done, 100)]);
  };
  for (const done of [1, 2, 3]) tell(20 * done, done);
  for (let done = 4; done <= 100; done += 1) tell(60 + 0.65 * (done - 3), done);
  for (const [at, done, words] of all.filter(([, done]) => done > 6 && done < 98)) {
    const told = Number(/about (\d+) s/.exec(words)?.[1]);
    const true_ = 60 + 0.65 * 97 - at;
    assert.ok(told > 0.7 * true_ - 1 && told < 1.4 * true_ + 1, `${done} %: ${words} for ${true_} s`);
  }
});

test("the time that is left never rises to more than twice what was said before", () => {
  for (const expected of [null, 20_000]) {
    let now = 0;
    const left = remaining(expected, () => now);
    // A second for each of ten, and then twenty for each.
    const told = [];
    for (let done = 1; done < 40; done += 1) {
      now += done <= 10 ? 1000 : 20_000;
      const words = left(done, 40);
      if (/about/.test(words)) told.push(Number(/about (\d+)/.exec(words)[1]) * (/min/.test(words) ? 60 : 1));
    }
    assert.ok(told.length > 10 && Math.max(...told) > 200, told.join());
    // What is told in minutes is rounded to them.
    const rounding = (value) => (value < 90 ? 1 : 60);
    told.forEach((value, i) => assert.ok(!i || value <= 2 * told[i - 1] + rounding(value), told.join()));
  }
});

test("of too few nothing is said, and what was expected counts before anything is known", () => {
  const of = (done, total, expected, after = 10_000) => {
    let at = 0;
    const words = remaining(expected, () => at);
    at = after;
    return words(done, total);
  };
  assert.deepEqual(
    [of(5, 15), of(2, 15), of(15, 15), of(5, 155), of(0, 100, 60_000), of(0, 100, 60_000, 70_000)],
    [", about 20 s more", "", "", ", about 5 min more", ", about 50 s more", ", longer than was thought"],
  );
});
