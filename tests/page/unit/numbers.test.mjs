// Numbers as they are read, printed and estimated.

import assert from "node:assert/strict";
import { test } from "node:test";
import { extent, fixed, number, remaining, timeOf, unit } from "../../../web/state/numbers.js";
import { numberOf, parsed, stepped, unreadable, wordsOf } from "../../../web/state/typed.js";
import { changeOf } from "../../../web/views/headline.js";

test("a number has a decimal point or a decimal comma; what can be read in two ways is neither", () => {
  for (const [text, value] of [
    ["1.5", 1.5],
    ["1,5", 1.5],
    [" -0,25 ", -0.25],
    ["\u22122", -2],
    ["1e-3", 0.001],
    [",5", 0.5],
    ["0,125", 0.125],
    ["1234,567", 1234.567],
    ["1,234", "1,234"],
    ["1,2,3", "1,2,3"],
    ["zwei", "zwei"],
  ])
    assert.equal(numberOf(text), value, text);
  assert.deepEqual(wordsOf("1,5 2;3, 4"), ["1,5", "2", "3", "4"]);
  assert.match(unreadable("1,234"), /write 1\.234, 1234, or/);
  assert.match(unreadable("1,2,3"), /no number: between two numbers/);
});

test("a text that may be JSON is read as such, and else stays a text", () => {
  assert.deepEqual(parsed('{"a":[1]}'), { a: [1] });
  assert.equal(parsed("{half"), "{half");
  assert.equal(parsed(" "), undefined);
});

test("a number goes on by a tenth of its leading digit, within its bounds", () => {
  const kind = (schema, whole = false) => ({ kind: "number", schema, optional: false, whole });
  assert.equal(stepped(7.5, 1, kind({})), 7.6);
  assert.equal(stepped(115, -1, kind({})), 110);
  assert.equal(stepped(50, 10, kind({}, true)), 60);
  assert.equal(stepped(0.95, 5, kind({ minimum: 0, maximum: 1 })), 1);
});

test("numbers are printed with the digits that they are asked for; what is none is a dash", () => {
  assert.deepEqual([number(13.8251), number(0.1, 8), number(1e-9), number(null)], ["13.83", "0.1", "1e-9", "–"]);
  assert.deepEqual([fixed(2, 2), fixed(NaN, 1), fixed(undefined, 1)], ["2.00", "–", "–"]);
  assert.deepEqual([unit("um"), unit("1"), unit("mm"), unit(undefined)], ["µm", "", "mm", ""]);
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
