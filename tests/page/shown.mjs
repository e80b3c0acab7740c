// That what stands on the page is of the design in the form, as it was typed, and that nothing of it is lost.

import assert from "node:assert/strict";
import { answer, axe, changed, changing, designOf, downloaded, field, open, openDesign, settled, step, tab } from "./harness.mjs";
import { HELICAL } from "./solid.mjs";

const HOLES = "/pair/driven/blank/holes";

/** A stage of an electric drive, as a report gives it: a web with kidneys out of the middle, a hub, reliefs, a true period of 83 mesh periods. */
export const STAGE = {
  method: "three_dimensional",
  "pair": {
    "center_distance_mm": 104.2,
    "driving": {
      "tooth_count": 27,
      "module_mm": 1.75,
      "face_width_mm": 26,
      "blank": {
        "bore_radius_mm": 10
      },
      "profile_shift": 0.25,
      "tip_relief": {
        "amount_um": 12,
        "shape": "linear",
        "start": {
          "radial_length_mm": 0.88
        }
      },
      "lead_modifications": [
        {
          "kind": "crowning",
          "amount_um": 5
        }
      ]
    },
    "driven": {
      "tooth_count": 83,
      "module_mm": 1.75,
      "face_width_mm": 24,
      "blank": {
        "bore_radius_mm": 25,
        "web": {
          "inner_radius_mm": 36,
          "outer_radius_mm": 69,
          "thickness_mm": 7,
          "offset_mm": 3
        },
        "hub": {
          "outer_radius_mm": 36,
          "width_mm": 32
        },
        "holes": {
          "count": 6,
          "circle_radius_mm": 52.5,
          "phase_deg": 0,
          "slot": {
            "width_mm": 12,
            "angle_deg": 30
          }
        }
      },
      "profile_shift": -0.05,
      "tip_relief": {
        "amount_um": 12,
        "shape": "linear",
        "start": {
          "radial_length_mm": 0.88
        }
      }
    },
    "helix_angle_deg": 22
  },
  "output_torques_n_m": [
    180
  ],
  "face_load": "positions"
};

/** The numbers of the headline, and whether they stand as those of another design. */
const standing = (page) => page.evaluate(() => ({ other: document.body.classList.contains("other"), color: getComputedStyle(document.querySelector("#answer-p-p .value")).color, faint: getComputedStyle(document.querySelector("#state")).color, state: document.querySelector("#state").innerText }));

/** Remembers the torques and methods of all that is drawn. */
const watch = (page) => page.evaluate(() => {
  window.drawn = [];
  document.addEventListener("drawn", ({ detail }) => window.drawn.push(detail.submission.output_torques_n_m[0]));
});

/** @param service the service whose page is used */
export async function shownSteps(service) {
  await step("a decimal comma is a decimal point, in a field, in a list and in a panel, and what can be read in two ways says so", service, async (page) => {
    await open(page, service);
    const type = async (pointer, text) => {
      const input = await field(page, pointer);
      await input.click();
      await input.press("Control+a");
      await input.pressSequentially(text);
      await settled(page);
    };
    await type("/pair/center_distance_mm", "100,7");
    assert.equal((await designOf(page)).pair.center_distance_mm, 100.7);
    await type(`${HOLES}/radius_mm`, "6,5");
    assert.equal((await designOf(page)).pair.driven.blank.holes.radius_mm, 6.5);
    await type("/output_torques_n_m", "115,5");
    assert.deepEqual((await designOf(page)).output_torques_n_m, [115.5]);
    await type("/output_torques_n_m", "60; 115,5 120.25");
    assert.deepEqual((await designOf(page)).output_torques_n_m, [60, 115.5, 120.25]);
    await type("/output_torques_n_m", "60, 80");
    assert.deepEqual((await designOf(page)).output_torques_n_m, [60, 80]);
    assert.ok(await page.locator("#problem").isHidden());
    await type("/output_torques_n_m", "100,200");
    await page.locator("#form .field-error", { hasText: "two ways" }).waitFor();
    await type("/output_torques_n_m", "60,80,100");
    await page.locator("#form .field-error", { hasText: "stands a space or a semicolon" }).waitFor();
    await type("/output_torques_n_m", "100");
    await type("/pair/center_distance_mm", "100 mm");
    await page.locator("#form .field-error", { hasText: "“100 mm” is no number" }).waitFor();
    await axe(page);
    await type("/pair/center_distance_mm", "100.5");
    await page.locator("#problem").waitFor({ state: "hidden" });
    await tab(page, "sweep");
    await page.locator("#sweep-from").fill("12,5");
    await page.locator("#sweep-to").fill("1,500");
    await page.locator("#sweep-run").click();
    await page.locator("#sweep-state", { hasText: "two ways" }).waitFor();
    await page.locator("#sweep-to").fill("112,5");
    await page.locator("#sweep-run").click();
    await page.locator("#sweep .scatter .strong").waitFor();
    assert.match(await page.locator("#sweep .scatter circle title").first().textContent(), /12\.5/);
  });

  await step("numbers of another design are gray with a clock, and no half-typed design is computed that takes long", service, async (page) => {
    await openDesign(page, service, HELICAL);
    await page.waitForFunction(() => document.querySelector("#answer-p-p .value").textContent !== "–");
    await settled(page);
    await watch(page);
    const asked = [];
    page.on("request", (request) => { if (/v1\/(preview|jobs)$/.test(request.url()) && request.method() === "POST") asked.push(JSON.parse(request.postData()).output_torques_n_m[0]); });
    const before = await standing(page);
    assert.ok(!before.other && before.color !== before.faint);
    // A design that takes more than a second: full computations of it.
    const torque = await field(page, "/output_torques_n_m");
    await torque.click();
    await torque.press("Control+a");
    for (const key of "210") {
      await torque.press(key);
      await page.waitForTimeout(250);
    }
    await page.waitForTimeout(200);
    const meanwhile = await standing(page);
    assert.ok(meanwhile.other, "another design is in the form");
    assert.equal(meanwhile.color, meanwhile.faint);
    await settled(page);
    assert.deepEqual(asked, [210]);
    assert.deepEqual(await page.evaluate(() => window.drawn), [210]);
    assert.ok(!(await standing(page)).other);
  });

  await step("what takes over a second is computed at rest or at Enter, says how long it will take, and is stopped when it is overtaken", service, async (page) => {
    await openDesign(page, service, HELICAL);
    await settled(page);
    const asked = [];
    const stopped = [];
    const torqueOf = (request) => JSON.parse(request.postData()).output_torques_n_m[0];
    page.on("request", (request) => { if (/v1\/preview$/.test(request.url())) asked.push(torqueOf(request)); });
    page.on("requestfailed", (request) => { if (/v1\/preview$/.test(request.url())) stopped.push(torqueOf(request)); });
    // The method as a whole, which takes longer.
    const torque = await field(page, "/output_torques_n_m");
    await page.evaluate(async () => {
      window.states = [];
      new MutationObserver(() => window.states.push(document.querySelector("#state").innerText)).observe(document.querySelector("#state"), { childList: true, characterData: true, subtree: true });
    });
    await torque.fill("150");
    await settled(page);
    await page.locator("#projected #whole").click();
    await page.waitForFunction(() => window.states.some((words) => /^Computing, about \d+ s more$/.test(words)));
    // Overtaken while it is computed.
    await torque.fill("160");
    await page.waitForFunction(() => document.body.classList.contains("other"));
    await settled(page);
    assert.ok(stopped.includes(150), `stopped ${stopped}, asked ${asked}`);
    assert.equal(asked.at(-1), 160);
  });

  await step("a mistake that is mended is red no more, however long the design takes", service, async (page) => {
    await openDesign(page, service, HELICAL);
    await settled(page);
    const width = await field(page, "/pair/driven/face_width_mm");
    await width.fill("-1");
    await page.locator("#form .field.wrong").waitFor();
    await page.locator("#problem").waitFor();
    await width.fill("17");
    await page.waitForFunction(() => document.querySelector("#problem").hidden && !document.querySelector("#form .wrong"), null, { timeout: 900 });
    assert.ok(await page.evaluate(() => document.body.classList.contains("busy")), "it is still being computed");
    await settled(page);
  });

  await step("a center distance that was typed stays when the helix angle changes, until its user takes the offer, over a reload too", service, async (page) => {
    await open(page, service);
    await page.locator("#start").selectOption("new pair");
    await settled(page);
    const type = async (pointer, text) => {
      await (await field(page, pointer)).fill(text);
      await settled(page);
    };
    await type("/pair/center_distance_mm", "75.4");
    await type("/pair/helix_angle_deg", "20");
    assert.equal((await designOf(page)).pair.center_distance_mm, 75.4);
    // (25 + 50) (1/cos 20° - 1) more.
    const offered = 75.4 + 75 * (1 / Math.cos(Math.PI / 9) - 1);
    const offer = page.locator("#form .field-offer", { hasText: offered.toFixed(3).slice(0, -1) });
    await offer.waitFor();
    await page.reload();
    await offer.waitFor();
    await settled(page);
    assert.equal((await designOf(page)).pair.center_distance_mm, 75.4);
    await axe(page);
    await changing(page, () => offer.locator("button", { hasText: "Use" }).click());
    assert.ok(Math.abs((await designOf(page)).pair.center_distance_mm - offered) < 1e-3);
    assert.equal(await page.locator("#form .field-offer").count(), 0);
    // As a report gives it, in whichever order it is typed, it is offered nothing else.
    await page.locator("#start").selectOption("new pair");
    for (const [pointer, text] of [["driving/module_mm", "1.75"], ["driving/tooth_count", "27"], ["driven/tooth_count", "83"], ["driving/profile_shift", "0.25"], ["driven/profile_shift", "-0.05"], ["center_distance_mm", "104.2"], ["helix_angle_deg", "22"]]) await type(`/pair/${pointer}`, text);
    assert.equal((await designOf(page)).pair.center_distance_mm, 104.2);
    assert.equal(await page.locator("#form .field-offer").count(), 0);
  });
}
