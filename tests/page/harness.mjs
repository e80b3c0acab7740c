// A browser, and steps in pages of their own; what every step needs to look at the page.

import assert from "node:assert/strict";
import { appendFileSync, readFileSync } from "node:fs";
import { AxeBuilder } from "@axe-core/playwright";
import { chromium } from "playwright-core";
import { recorded, tidy } from "./recording.mjs";
import { start } from "./service.mjs";

/**
 * What is run, the first argument: `daily`, the steps that are marked so; `recorded`, all that need no engine; `record`,
 * which records these anew; `all`, every step with the real service.
 */
export const mode = process.argv.slice(2).find((each) => !each.startsWith("--")) ?? "daily";
assert.ok(["daily", "recorded", "record", "all"].includes(mode), `there is no way to run that is called ${mode}`);

/** In milliseconds, for a machine that has much else to do. What is recorded comes at once. */
const PATIENCE = mode === "daily" || mode === "recorded" ? 60_000 : 300_000;
/** What is computed says something new at least once in so many milliseconds. */
const STANDSTILL = 180_000;
/** So many steps may hold at the second try alone. */
const MOST_FLAKY = 1;
const only = process.env.ONLY ? new RegExp(process.env.ONLY) : null;

const browser = await chromium.launch({ executablePath: process.env.BROWSER, args: ["--no-sandbox"] });
let passed = 0;
const failed = [];
const flaky = [];
// What a step that has failed still waits for ends with its page. What comes to nothing before is a failure, and the other steps go on.
process.on("unhandledRejection", (error) => {
  if (/has been closed/.test(String(error))) return;
  console.log(`page: FAILED beside its step: ${error instanceof Error ? error.stack : String(error)}`);
  failed.push("what nobody waited for any more");
});
const recordings = new Set();

/** The service that most steps use: before it stand recordings, unless every step is run with the real one. */
export const service = mode === "all" ? await start() : await recorded(start, process.env.RECORDED);

/**
 * What runs steps on a service, each in a page of its own, which must neither log an error nor ask another host.
 * `opened` opens the page first, and waits until it shows its first design. The steps of `daily` are run daily, and those
 * of `engine` with what the service computes instead of with recorded answers.
 */
export function stepsOn(on) {
  /** @param {...("daily" | "engine")} marks */
  const marked = (...marks) => {
    const step = (name, work, options = {}, others = []) => run({ name, on, work, options, others, marks });
    const opened = (name, work, options = {}) =>
      step(
        name,
        async (page, context) => {
          await open(page, on);
          await work(page, context);
        },
        options,
      );
    return { opened, step };
  };
  return { ...marked(), daily: marked("daily"), engine: marked("engine"), dailyEngine: marked("daily", "engine") };
}

/** Does `work` with a service of its own, before which no recordings stand, where every step is run. */
export async function withOwnService(env, work) {
  if (mode !== "all") return;
  const own = await start(env);
  await work(own, stepsOn(own).engine);
  await own.stop();
}

/** Whether steps with these marks are run. */
const isWanted = (marks) => mode === "all" || (mode === "daily" ? marks.includes("daily") : !marks.includes("engine"));

async function run({ name, on, work, options, others, marks }) {
  if ((only && !only.test(name)) || !isWanted(marks)) return;
  const begun = Date.now();
  const attempt = (beside) => inPage({ on, work, options, others, beside });
  let fault = null;
  if (mode === "record")
    fault = await faultOf(on.record(name, () => thrown(attempt(null))).then((file) => recordings.add(file)));
  else {
    const isRecorded = mode !== "all" && !marks.includes("engine");
    const once = () => {
      if (isRecorded) return attempt(on.replay(name));
      on.pass?.();
      return attempt(null);
    };
    fault = await once();
    if (fault) {
      console.log(`page: once more alone: ${name}\n${fault}`);
      const again = await once();
      if (!again) flaky.push(`${name}: ${fault.split("\n")[0]}`);
      fault = again;
    }
  }
  if (fault) failed.push(`${name}: ${fault.split("\n")[0]}`);
  else passed += 1;
  console.log(
    `page: ${fault ? "FAILED" : "ok"}: ${name} (${((Date.now() - begun) / 1000).toFixed(1)} s)${fault ? `\n${fault}` : ""}`,
  );
}

/** What is wrong with work that gives what is wrong, or throws it. */
const faultOf = (work) =>
  work.then(
    () => null,
    (error) => error.stack,
  );

const thrown = async (work) => {
  const fault = await work;
  if (fault) throw new Error(fault);
};

/** Does `work` in a new page, and gives what is wrong with it, or null. `beside` fails when something is missing. */
async function inPage({ on, work, options, others, beside }) {
  const context = await browser.newContext({
    viewport: { width: 1280, height: 1000 },
    acceptDownloads: true,
    ...options,
  });
  context.setDefaultTimeout(PATIENCE);
  const page = await context.newPage();
  if (process.env.WEB) await fromDisk(context, on);
  const faults = [];
  page.on("console", (message) => {
    // The browser itself logs a refusal, a service that is away, and one that is too busy for a preview; the page shows each.
    const logged = `${message.text()} ${message.location().url}`;
    if (
      message.type() === "error" &&
      !/status of 4(01|03|12|22)|ERR_INTERNET_DISCONNECTED|status of 503 .*\/v1\/preview$/.test(logged)
    )
      faults.push(logged);
  });
  page.on("pageerror", (error) => faults.push(error.stack));
  page.on("request", (request) => {
    if (![on.url, ...others].some((known) => request.url().startsWith(known)) && !/^(blob|data):/.test(request.url()))
      faults.push(`asks ${request.url()}`);
  });
  let fault = null;
  try {
    const done = work(page, context);
    // Once something is missing, nobody waits for the step any more.
    done.catch(() => {});
    await (beside ? Promise.race([done, beside]) : done);
    assert.deepEqual(faults, []);
  } catch (error) {
    const said = await page
      .locator("[role=status]:visible, [role=alert]:visible")
      .allInnerTexts()
      .catch(() => []);
    fault = [error.stack, ...faults, `The page says: ${said.filter(Boolean).join(" | ")}`].join("\n");
  }
  await context.close();
  return fault;
}

/** The page as it lies in the folder WEB, not as it is in the program: what is being changed needs no build. */
async function fromDisk(page, { url }) {
  const types = { html: "text/html", js: "text/javascript", css: "text/css", svg: "image/svg+xml" };
  await page.route(
    (address) => address.href.startsWith(`${url}web/`) || address.origin + address.pathname === url,
    async (route) => {
      const name = new URL(route.request().url()).pathname.replace(/^\/(web\/)?/, "") || "index.html";
      await route.fulfill({
        body: readFileSync(`${process.env.WEB}/${name}`),
        contentType: `${types[name.split(".").pop()]}; charset=utf-8`,
      });
    },
  );
}

/**
 * Ends the browser and tells how it went. A step that held at the second try is named in the file of FLAKY; one of them
 * fails nothing.
 */
export async function end() {
  await browser.close();
  await service.stop();
  if (mode === "record") tidy(process.env.RECORDED, only || failed.length ? null : recordings);
  if (process.env.FLAKY && flaky.length)
    appendFileSync(process.env.FLAKY, flaky.map((each) => `page: ${each}\n`).join(""));
  const told = flaky.length ? `, ${flaky.length} of them at the second try` : "";
  console.log(
    [
      `page: ${passed} passed${told}, ${failed.length} failed`,
      ...flaky.map((each) => `page: flaky: ${each}`),
      ...failed,
    ].join("\n"),
  );
  process.exitCode = failed.length || flaky.length > MOST_FLAKY ? 1 : 0;
}

/** An answer of the headline, as a number. */
export const answer = async (page, id) => Number(await page.locator(`#answer-${id} .value`).textContent());

/** Waits until an answer is another one than before, and no draft; gives it. */
export async function changed(page, id, before) {
  await page.waitForFunction(
    ([place, old]) => {
      const value = document.querySelector(`#answer-${place} .value`);
      return (
        !value.classList.contains("draft") &&
        !document.body.classList.contains("busy") &&
        Number(value.textContent) !== old
      );
    },
    [id, before],
  );
  return answer(page, id);
}

export async function open(page, service, fragment = "") {
  await page.goto(service.url + fragment);
  await answered(page);
  await page.locator("#form .field").first().waitFor();
  await idle(page);
}

/** The field at a pointer, in view whatever was folded. */
export async function field(page, pointer) {
  const found = page.locator(`[id="field-${pointer}"]`);
  await found.waitFor({ state: "attached" });
  await unfold(found);
  return found;
}

/** Chooses a tab of the results. */
export const tab = (page, name) => page.locator(`#tab-${name}`).click();

/** What the live design is called in the table, once it is called so. */
export const named = (page, words) =>
  page.waitForFunction(
    (name) =>
      document.querySelector("#table th.live")?.textContent.includes(name) && !document.body.classList.contains("busy"),
    words,
  );

/** Waits until the last change of the design has been answered, and the address carries it. */
export const settled = (page) =>
  page.waitForFunction(
    () => !document.body.classList.contains("busy") && history.state?.changes === Number(document.body.dataset.changes),
  );

/** Holds all previews until what it answers is called, which waits for what was asked last. */
export async function heldPreviews(page) {
  let go = (_ = null) => {};
  const waits = new Promise((resolve) => {
    go = resolve;
  });
  await page.route("**/v1/preview", async (route) => {
    await waits;
    await route.continue();
  });
  return async () => {
    go();
    await settled(page);
    await page.unroute("**/v1/preview");
  };
}

/** Waits until the headline has numbers. */
export const answered = (page) =>
  page.waitForFunction(() => document.querySelector("#answer-p-p .value").textContent !== "–");

/** Opens all that a place is folded away in. */
export const unfold = (place) =>
  place.evaluate((element) => {
    for (let at = element; at; at = at.parentElement) if (at.tagName === "DETAILS") at.open = true;
  });

/** Waits until nothing is computed any more. */
export const idle = (page) => page.waitForFunction(() => !document.body.classList.contains("busy"));

/** Waits until the design is computed, and can be. */
export const computed = (page) =>
  page.waitForFunction(() => !document.body.classList.contains("busy") && document.querySelector("#problem").hidden);

/** Does what changes the design sooner or later, and waits until it has, and is settled. */
export async function changing(page, work) {
  const before = await page.evaluate(() => document.body.dataset.changes);
  await work();
  await page.waitForFunction((known) => document.body.dataset.changes !== known, before);
  await settled(page);
}

/**
 * Waits until the place that says how far something is says that it has ended. However long that takes on a machine that
 * has much else to do, it is waited for as long as it goes on.
 */
export async function ends(page, place, words) {
  let [last, since] = ["", Date.now()];
  for (;;) {
    const said = await page.locator(place).innerText();
    if (words.test(said)) return;
    if (said !== last) [last, since] = [said, Date.now()];
    assert.ok(Date.now() - since < STANDSTILL, `for ${STANDSTILL} ms it has said: ${said}`);
    await page.waitForTimeout(100);
  }
}

/** The address that the page gives away. */
export async function linkOf(page) {
  await page.locator("#share").click();
  await page.waitForFunction(() => document.querySelector("#share").textContent !== "Copy link");
  return page.url();
}

/** The design as it is now, by the address that carries it. */
export async function designOf(page) {
  await page.waitForFunction(() => history.state?.changes === Number(document.body.dataset.changes));
  return page.evaluate(async () => {
    const text = location.hash.slice("#design=".length).replace(/-/g, "+").replace(/_/g, "/");
    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    return JSON.parse(
      await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw"))).text(),
    );
  });
}

/** Opens a design by its address. */
export async function openDesign(page, service, design) {
  await page.goto(service.url);
  const fragment = await page.evaluate(async (submission) => {
    const packed = new Uint8Array(
      await new Response(
        new Blob([JSON.stringify(submission)]).stream().pipeThrough(new CompressionStream("deflate-raw")),
      ).arrayBuffer(),
    );
    let letters = "";
    for (const byte of packed) letters += String.fromCharCode(byte);
    return `#design=${btoa(letters).replace(/\+/g, "-").replace(/\//g, "_").replace(/=+$/, "")}`;
  }, design);
  await page.goto("about:blank");
  await page.goto(service.url + fragment);
  await page.locator("#form .field").first().waitFor();
}

export async function axe(page) {
  const { violations } = await new AxeBuilder({ page }).analyze();
  const serious = violations.filter(({ impact }) => ["serious", "critical"].includes(impact));
  assert.deepEqual(
    serious.map(
      ({ id, nodes }) => `${id}: ${nodes.map(({ target, failureSummary }) => `${target} ${failureSummary}`).join(" ")}`,
    ),
    [],
  );
}

/** Drags with the mouse from one place to another in steps. */
export async function drag(page, from, to, steps = 12) {
  await page.mouse.move(...from);
  await page.mouse.down();
  await page.mouse.move(...to, { steps });
  await page.mouse.up();
}

/** Where a hole of the driven gear is on the screen, and the center of its gear. */
export async function holeAt(page, index) {
  const middle = async (locator) => {
    const box = await locator.boundingBox();
    return [box.x + box.width / 2, box.y + box.height / 2];
  };
  return [
    await middle(page.locator(".rotor.driven .hole").nth(index)),
    await middle(page.locator(".rotor.driven circle.opening")),
  ];
}

/** A file that `work` makes the page give, as text or bytes. */
export async function downloaded(page, work) {
  const waiting = page.waitForEvent("download");
  await work();
  const download = await waiting;
  const chunks = [];
  for await (const chunk of await download.createReadStream()) chunks.push(chunk);
  return { name: download.suggestedFilename(), bytes: Buffer.concat(chunks) };
}
