// What a visitor does with the page, step by step.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createServer } from "node:http";
import { AxeBuilder } from "@axe-core/playwright";
import { chromium } from "playwright-core";
import { start } from "./service.mjs";

const PATIENCE = 20_000;
const DRAGS = 200;
const WIDTHS = [[400, 900], [1280, 900], [3840, 2160]];

const browser = await chromium.launch({ executablePath: process.env.BROWSER, args: ["--no-sandbox"] });
let passed = 0;
let failed = 0;

/** Runs a step in a page of its own, which must neither log an error nor ask another host. */
async function step(name, service, work, options = {}, others = []) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 1000 }, acceptDownloads: true, ...options });
  const page = await context.newPage();
  page.setDefaultTimeout(PATIENCE);
  const faults = [];
  page.on("console", (message) => {
    // The browser itself logs a refusal; the page shows it at its field.
    if (message.type() === "error" && !/status of 4(01|22)/.test(message.text())) faults.push(message.text());
  });
  page.on("pageerror", (error) => faults.push(error.stack));
  page.on("request", (request) => {
    if (![service.url, ...others].some((known) => request.url().startsWith(known)) && !/^(blob|data):/.test(request.url())) faults.push(`asks ${request.url()}`);
  });
  try {
    await work(page, context);
    assert.deepEqual(faults, []);
    passed += 1;
    console.log(`page: ok: ${name}`);
  } catch (error) {
    failed += 1;
    console.log(`page: FAILED: ${name}\n${error.stack}\n${faults.join("\n")}`);
  }
  await context.close();
}

/** A cell of the live row of the statistics, as a number. */
const cell = async (page, column) => Number(await page.locator("#table tbody tr.live td").nth(column).innerText());
const [MEAN, PEAK_TO_PEAK] = [1, 3];

async function open(page, service, fragment = "") {
  await page.goto(service.url + fragment);
  await page.locator("#table tbody tr.live").waitFor();
  await page.locator("#form .field").first().waitFor();
}

async function axe(page) {
  const { violations } = await new AxeBuilder({ page }).analyze();
  const serious = violations.filter(({ impact }) => ["serious", "critical"].includes(impact));
  assert.deepEqual(serious.map(({ id, nodes }) => `${id}: ${nodes.map(({ target }) => target).join(" ")}`), []);
}

/** Drags with the mouse from one place to another in steps. */
async function drag(page, from, to, steps = 12) {
  await page.mouse.move(...from);
  await page.mouse.down();
  await page.mouse.move(...to, { steps });
  await page.mouse.up();
}

const service = await start();

await step("case 2 is there at once, with the mean of the reference", service, async (page) => {
  const begun = Date.now();
  await page.goto(service.url);
  await page.locator("#table tbody tr.live").waitFor();
  console.log(`page: first curve ${Date.now() - begun} ms after the address was opened.`);
  assert.equal(await page.locator("#start").inputValue(), "test-case-2");
  // Table 2 of the paper: 13.79 um; ours 13.8.
  assert.ok(Math.abs((await cell(page, MEAN)) - 13.8) < 0.1, String(await cell(page, MEAN)));
  assert.match(await page.locator(".lead").innerText(), /spur gear pair/);
  await page.locator("#form .field").first().waitFor();
  await axe(page);
});

await step("a dragged hole changes the curve, and the hole stays where the hand left it", service, async (page) => {
  await open(page, service);
  const before = await cell(page, PEAK_TO_PEAK);
  const hole = page.locator(".rotor.driven .hole").nth(5);
  const box = await hole.boundingBox();
  const middle = [box.x + box.width / 2, box.y + box.height / 2];
  const gear = await page.locator(".rotor.driven .opening").boundingBox();
  const center = [gear.x + gear.width / 2, gear.y + gear.height / 2];
  const inward = middle.map((value, i) => value + (center[i] - value) * 0.1);
  await drag(page, middle, inward);
  await page.waitForFunction((old) => Number(document.querySelector("#table tr.live td:nth-child(5)").innerText) !== old, before);
  const circle = Number(await page.locator('[id="field-/pair/driven/blank/holes/circle_radius_mm"]').inputValue());
  assert.ok(circle > 29 && circle < 33, `the circle is ${circle} mm`);
  assert.equal(await page.locator("#start").inputValue(), "");
});

await step("a field that is wrong says so, keeps the curve, and is mended by its button", service, async (page) => {
  await open(page, service);
  const mean = await cell(page, MEAN);
  const field = page.locator('[id="field-/pair/driven/blank/holes/radius_mm"]');
  await field.fill("12");
  const mend = page.locator(".field-error .mend").first();
  await mend.waitFor();
  assert.equal(await field.getAttribute("aria-invalid"), "true");
  assert.equal(await cell(page, MEAN), mean, "the last good numbers stay");
  assert.match(await page.locator("#problem").innerText(), /last design that could be computed/);
  await axe(page);
  await mend.click();
  await page.locator("#problem").waitFor({ state: "hidden" });
  await page.waitForFunction((old) => Number(document.querySelector("#table tr.live td:nth-child(3)").innerText) !== old, mean);
  const radius = Number(await field.inputValue());
  assert.ok(radius > 9 && radius < 12, `mended to ${radius}`);
});

await step("a link opened again gives the same design", service, async (page, context) => {
  await open(page, service);
  await page.locator('[id="field-/pair/driven/blank/holes/count"]').fill("8");
  await page.waitForFunction(() => document.querySelector("#table tr.live th").innerText.includes("8×"));
  await page.locator("#share").click();
  await page.waitForFunction(() => location.hash.startsWith("#design="));
  await page.waitForTimeout(400);
  const again = await context.newPage();
  await again.goto(page.url());
  await again.locator("#table tbody tr.live").waitFor();
  assert.equal(await again.locator("#table tbody tr.live").innerText(), await page.locator("#table tbody tr.live").innerText());
});

await step("curves and gears stand at the same position, whichever is moved", service, async (page) => {
  await open(page, service);
  const angle = () => page.locator(".rotor.driving").getAttribute("transform");
  const before = await angle();
  await page.locator("#chart-ste .u-over").hover({ position: { x: 120, y: 60 } });
  await page.waitForFunction((old) => document.querySelector(".rotor.driving").getAttribute("transform") !== old, before);
  assert.match(await page.locator("#readout").innerText(), /Transmission error 1\d\.\d+ µm/);
  const byCurve = await page.locator("#position").inputValue();
  const gear = await page.locator(".rotor.driving .opening").boundingBox();
  await drag(page, [gear.x - 40, gear.y + 10], [gear.x - 40, gear.y + 50]);
  assert.notEqual(await page.locator("#position").inputValue(), byCurve);
  assert.ok((await page.locator(".forces .force").count()) >= 1);
});

await step("stresses are shown where they are asked for", service, async (page) => {
  await open(page, service);
  assert.ok(await page.locator("#chart-stress").isHidden());
  const field = page.locator('[id="field-/stress"]');
  await field.evaluate((element) => { for (let at = element; at; at = at.parentElement) if (at.tagName === "DETAILS") at.open = true; });
  await field.check();
  await page.locator("#chart-stress").waitFor();
  // The roots of both gears, and the holes of the driven one.
  assert.equal(await page.locator("#chart-stress .entry").count(), 3);
  await page.locator("#chart-ste .u-over").hover({ position: { x: 120, y: 60 } });
  assert.match(await page.locator("#readout").innerText(), /Stress in MPa: \d+\.\d at a root of the driving gear/);
  assert.match(await page.locator("#table thead").innerText(), /Stress at a root/i);
  await axe(page);
});

await step("lists of holes and slots are opened, changed and computed", service, async (page, context) => {
  const blank = "/pair/driven/blank/holes";
  const field = (name) => page.locator(`[id="field-${blank}${name}"]`);
  const named = (words) => page.waitForFunction((name) => document.querySelector("#table tr.live th").innerText.includes(name), words);
  await open(page, service);
  await page.locator("#start").selectOption("slots");
  await named("5×slot@34");
  assert.equal(await field("/slot/width_mm").inputValue(), "9");
  const slots = await cell(page, PEAK_TO_PEAK);
  await field("/slot/width_mm").fill("7");
  await page.waitForFunction((old) => Number(document.querySelector("#table tr.live td:nth-child(5)").innerText) !== old, slots);
  // A slot that is taken away leaves round holes as wide, and comes back in place of them.
  await field("/slot").uncheck();
  await named("5×r3.5@34");
  await field("/slot").check();
  await named("5×slot@34");
  assert.equal(await field("/radius_mm").inputValue(), "");
  await page.locator("#start").selectOption("unequal-holes");
  await named("4×r7.5@34+2×r6@34");
  await field("/1/radius_mm").fill("5");
  await named("4×r7.5@34+2×r5@34");
  await page.locator("#share").click();
  await page.waitForFunction(() => location.hash.startsWith("#design="));
  const again = await context.newPage();
  await again.goto(page.url());
  await again.locator("#table tbody tr.live").waitFor();
  assert.match(await again.locator("#table tr.live th").innerText(), /4×r7\.5@34\+2×r5@34/);
  assert.equal(await again.locator(`[id="field-${blank}/0/at_deg"]`).inputValue(), "0, 85, 185, 268");
  // One pattern becomes a list of them, and a further one stands between its holes.
  await page.locator("#start").selectOption("test-case-2");
  await field("/count").fill("5");
  await named("5×r7.5@34");
  await field("").selectOption({ index: 2 });
  await page.locator("#form button", { hasText: "Add to several patterns" }).click();
  await named("5×r7.5@34+5×r3@34");
  assert.ok(await page.locator("#problem").isHidden());
  await page.locator("#form .entry-of-list > button", { hasText: "Remove" }).first().click();
  await named("5×r3@34");
  await axe(page);
});

await step("several designs and methods stand in one plot", service, async (page) => {
  await open(page, service);
  await page.locator("#methods").click();
  await page.waitForFunction(() => document.querySelectorAll("#table tbody tr").length === 4);
  assert.equal(await page.locator("#chart-ste .entry").count(), 4);
  await page.locator("#table button", { hasText: "×" }).first().click();
  assert.equal(await page.locator("#table tbody tr").count(), 3);
});

await step("a sweep marks the torque of the least peak-to-peak", service, async (page) => {
  await open(page, service);
  await page.locator("#sweep button[type=submit]").click();
  await page.locator("#sweep .scatter .strong").waitFor();
  assert.match(await page.locator("#sweep .out").innerText(), /Least peak-to-peak of these torques: \d/);
});

await step("a study runs and shows its table and its front", service, async (page) => {
  await open(page, service);
  await page.locator("#tab-study").click();
  await page.locator("#axis-0-values").fill("6, 10, 40");
  await page.locator("#study button[type=submit]").click();
  await page.waitForFunction(() => /3 of 3 designs, successful/.test(document.querySelector("#study [role=status]").innerText));
  assert.equal(await page.locator("#study tbody tr").count(), 3);
  assert.match(await page.locator("#study tbody").innerText(), /yes/);
  assert.match(await page.locator("#study tbody tr").nth(2).innerText(), /40/, "the one that cannot be built stands there with its reason");
  await axe(page);
});

await step("a job is submitted, followed and opened", service, async (page) => {
  await open(page, service);
  await page.locator("#tab-jobs").click();
  await page.locator("#jobs button.primary").click();
  await page.locator("#jobs tbody tr", { hasText: "successful" }).first().waitFor();
  const waiting = page.waitForEvent("download");
  await page.locator("#jobs button", { hasText: "CSV" }).first().click();
  assert.match((await waiting).suggestedFilename(), /ste\.csv$/);
  const fields = page.waitForEvent("download");
  await page.locator("#jobs button", { hasText: "VTU" }).first().click();
  assert.match((await fields).suggestedFilename(), /fields\.vtu$/);
});

await step("the pair is seen deformed at the position shown, by keys too", service, async (page) => {
  await open(page, service);
  await page.locator("#position").fill("0.3");
  await page.locator("#deformed").focus();
  await page.keyboard.press("Enter");
  await page.locator(".deformation .strained.driven").waitFor({ state: "attached" });
  assert.match(await page.locator("#deformed-note").innerText(), /^At 115 N m and position 0.3, displacements \d+ times enlarged/);
  assert.ok((await page.locator(".deformation .stress.level-5").first().getAttribute("d")).length > 20, "something is stressed most");
  await axe(page);
  if (process.argv.includes("--screenshots")) await page.locator(".drawing-panel").screenshot({ path: `${process.env.PICTURES}/page-deformed.png` });
  // A position further the shape is another one.
  const shape = () => page.locator(".strained.driving").getAttribute("d");
  const before = await shape();
  await page.locator("#position").fill("0.6");
  await page.locator(".deformation").waitFor({ state: "detached" });
  await page.locator(".deformation").waitFor({ state: "attached" });
  assert.notEqual(await shape(), before);
  // Another design is shown without load until it is asked for.
  await page.locator('[id="field-/pair/driven/blank/holes/count"]').fill("8");
  await page.locator(".deformation").waitFor({ state: "detached" });
  assert.equal(await page.locator("#deformed").getAttribute("aria-pressed"), "false");
});

await step("what is shown is downloaded", service, async (page) => {
  await open(page, service);
  for (const [kind, least] of [["json", 20_000], ["csv", 10_000], ["svg", 20_000], ["png", 20_000]]) {
    const waiting = page.waitForEvent("download");
    await page.locator(`[data-download=${kind}]`).click();
    const chunks = [];
    for await (const chunk of await (await waiting).createReadStream()) chunks.push(chunk);
    const { length } = Buffer.concat(chunks);
    assert.ok(length > least, `${kind} has ${length} bytes`);
  }
});

await step("keys alone do: a hole moves by arrows", service, async (page) => {
  await open(page, service);
  await page.locator(".rotor.driven .hole[role=slider]").focus();
  for (let i = 0; i < 4; i += 1) await page.keyboard.press("ArrowDown");
  await page.waitForFunction(() => document.querySelector('[id="field-/pair/driven/blank/holes/circle_radius_mm"]').value === "33");
});

await step("200 drags are followed in order", service, async (page) => {
  await open(page, service);
  await page.evaluate(() => {
    window.drawn = [];
    document.addEventListener("drawn", ({ detail }) => window.drawn.push([detail.submission.pair.driven.blank.holes.circle_radius_mm, detail.milliseconds, detail.draft]));
  });
  const box = await page.locator(".rotor.driven .hole").nth(5).boundingBox();
  const gear = await page.locator(".rotor.driven .opening").boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  const [dx, dy] = [gear.x + gear.width / 2 - x, gear.y + gear.height / 2 - y];
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (let i = 1; i <= DRAGS; i += 1) {
    await page.mouse.move(x + (dx * 0.12 * i) / DRAGS, y + (dy * 0.12 * i) / DRAGS);
    await page.waitForTimeout(16);
  }
  await page.mouse.up();
  await page.waitForFunction(() => document.querySelector("body").className !== "busy");
  const drawn = await page.evaluate(() => window.drawn);
  const radii = drawn.map(([radius]) => radius);
  assert.deepEqual(radii, [...radii].sort((a, b) => b - a), "none out of order");
  assert.ok(drawn.length >= 10, `${drawn.length} curves were drawn`);
  assert.ok(!drawn.at(-1)[2], "a hand that rests gets the curve itself");
  const times = drawn.filter(([, , draft]) => draft).map(([, milliseconds]) => milliseconds).sort((a, b) => a - b);
  const at = (part) => times[Math.floor(part * (times.length - 1))].toFixed(0);
  console.log(`page: ${DRAGS} drags, ${drawn.length} curves drawn; from change to curve ${at(0.5)} ms median, ${at(0.95)} ms p95.`);
});

const locked = await start();
const key = locked.key("visitor");
await step("a key is asked for, and used", locked, async (page) => {
  await page.goto(locked.url);
  await page.locator("#key-dialog[open]").waitFor();
  await axe(page);
  await page.locator("#key").fill(key);
  await page.locator("#key-form button.primary").click();
  await page.locator("#table tbody tr.live").waitFor();
  assert.ok(Math.abs((await cell(page, MEAN)) - 13.8) < 0.1);
});
await locked.stop();

const portal = createServer((_, answer) => answer.setHeader("content-type", "text/html").end(readFileSync(process.env.PORTAL)));
await new Promise((resolve) => portal.listen(0, "127.0.0.1", resolve));
const origin = `http://127.0.0.1:${portal.address().port}`;
const shared = await start({ MESHWRIGHT_CORS_ORIGIN: origin });
await step("a portal on another origin submits, follows and draws", shared, async (page) => {
  await page.goto(`${origin}/?service=${shared.url.replace(/\/$/, "")}`);
  await page.locator("button").click();
  await page.locator("#curve polyline").waitFor();
  assert.match(await page.locator("#state").innerText(), /^Mean 11\.56 µm, peak-to-peak 3\.83 µm/);
}, {}, [origin]);
await shared.stop();
portal.close();

for (const [width, height] of WIDTHS) {
  for (const colorScheme of ["light", "dark"]) {
    await step(`nothing serious at ${width} px, ${colorScheme}`, service, async (page) => {
      await open(page, service);
      await axe(page);
      const wider = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
      assert.equal(wider, 0, "nothing is wider than the window");
      if (process.argv.includes("--screenshots") && (width < 3840 || colorScheme === "light")) {
        await page.locator("#position").fill("0.3");
        await page.screenshot({ path: `${process.env.PICTURES}/page-${width}-${colorScheme}.png` });
      }
    }, { viewport: { width, height }, colorScheme });
  }
}

await service.stop();
await browser.close();
console.log(`${passed} passed, ${failed} failed`);
process.exitCode = failed ? 1 : 0;
