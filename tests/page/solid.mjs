// What has an extent along the axis: helical teeth in one step, the load along the face.

import assert from "node:assert/strict";
import {
  answer,
  answered,
  axe,
  changing,
  designOf,
  downloaded,
  drag,
  field,
  openDesign,
  settled,
  stepsOn,
  tab,
} from "./harness.mjs";

/** A small helical pair that stands askew, at few positions. */
export const HELICAL = {
  method: "three_dimensional",
  face_load: "positions",
  pair: {
    center_distance_mm: 63.9,
    helix_angle_deg: 20,
    misalignment_um: { in_plane_um: 12 },
    driving: { tooth_count: 24, module_mm: 2, face_width_mm: 16, blank: { bore_radius_mm: 10 } },
    driven: {
      tooth_count: 36,
      module_mm: 2,
      face_width_mm: 16,
      blank: {
        bore_radius_mm: 12,
        web: { inner_radius_mm: 17, outer_radius_mm: 30, thickness_mm: 6, offset_mm: 2 },
        holes: { count: 5, circle_radius_mm: 23.5, radius_mm: 4 },
        hub: { outer_radius_mm: 17, width_mm: 18 },
      },
    },
  },
  output_torques_n_m: [120],
  resolution: { positions_per_mesh_period: 8, grid: "coarse" },
};

/** A way to solve the contact that three dimensions do not have. */
const SOLVER = { augmented_lagrangian: {} };

/** The straight pair of few positions that a helical one is made of. */
const STRAIGHT = {
  method: "flexible",
  pair: {
    center_distance_mm: 60.1,
    driving: { tooth_count: 24, module_mm: 2, face_width_mm: 16, tip_diameter_mm: 52, blank: { bore_radius_mm: 10 } },
    driven: { tooth_count: 36, module_mm: 2, face_width_mm: 16, blank: { bore_radius_mm: 12 } },
  },
  output_torques_n_m: [100],
  resolution: { positions_per_mesh_period: 8, grid: "coarse", contact_solver: SOLVER },
};

/** @param service the service whose page is used */
export async function solidSteps(service) {
  const { step, daily, engine } = stepsOn(service);
  await daily.step("a pair becomes helical in one step, with its method, and straight again", async (page) => {
    await openDesign(page, service, STRAIGHT);
    await settled(page);
    assert.ok(await page.locator("#answer-face").isHidden(), "the plane has no load along the face");
    const teeth = page.locator("#field-teeth");
    await changing(page, () => teeth.selectOption("helical"));
    const helical = await designOf(page);
    assert.deepEqual(
      [helical.method, helical.pair.helix_angle_deg, helical.face_load, helical.resolution],
      ["three_dimensional", 15, "positions", { positions_per_mesh_period: 8, grid: "coarse" }],
    );
    // 2 (24 + 36)/2 (1/cos 15° - 1) more apart; a tip diameter that was given grows with its reference circle.
    assert.ok(
      Math.abs(helical.pair.center_distance_mm - (60.1 + 60 * (1 / Math.cos(Math.PI / 12) - 1))) < 1e-4,
      String(helical.pair.center_distance_mm),
    );
    assert.ok(Math.abs(helical.pair.driving.tip_diameter_mm - (52 + 48 * (1 / Math.cos(Math.PI / 12) - 1))) < 1e-4);
    assert.match(await page.locator("#notice").innerText(), /Center distance .*three dimensions.*active set/s);
    assert.ok(await page.locator("#problem").isHidden());
    const factor = await answer(page, "face");
    assert.ok(factor > 1 && factor < 2, `K_Hβ ${factor}`);
    // Typed like the module: what goes with the angle goes with every angle that is typed.
    await changing(page, async () => (await field(page, "/pair/helix_angle_deg")).fill("20"));
    assert.ok(
      Math.abs((await designOf(page)).pair.center_distance_mm - (60.1 + 60 * (1 / Math.cos(Math.PI / 9) - 1))) < 2e-4,
    );
    await changing(page, () => teeth.selectOption("straight"));
    const back = await designOf(page);
    assert.deepEqual([back.method, back.pair.helix_angle_deg, back.face_load], ["flexible", undefined, undefined]);
    assert.ok(
      Math.abs(back.pair.center_distance_mm - 60.1) < 3e-4 && Math.abs(back.pair.driving.tip_diameter_mm - 52) < 3e-4,
    );
    assert.ok(await page.locator("#answer-face").isHidden());
    await axe(page);
  });

  await step(
    "what a plane method does not know is marked, refused at its field, and cured by one button either way",
    async (page) => {
      await openDesign(page, service, { ...HELICAL, method: "flexible" });
      await page.locator("#problem button", { hasText: "in three dimensions" }).waitFor();
      for (const pointer of ["/pair/helix_angle_deg", "/pair/driven/blank/web/offset_mm"]) {
        const input = await field(page, pointer);
        assert.equal(await input.getAttribute("aria-invalid"), "true", pointer);
        assert.equal(
          await input.evaluate(
            (element) => getComputedStyle(element.closest(".field").querySelector("label"), "::after").content,
          ),
          '" 3D"',
        );
      }
      await axe(page);
      await changing(page, () => page.locator("#problem button", { hasText: "Leave out" }).click());
      const plane = await designOf(page);
      assert.equal(plane.method, "flexible");
      for (const left of [
        plane.pair.helix_angle_deg,
        plane.pair.misalignment_um,
        plane.pair.driven.blank.hub,
        plane.pair.driven.blank.web.offset_mm,
      ])
        assert.equal(left, undefined);
      assert.equal(plane.pair.driven.blank.web.thickness_mm, 6, "what the plane knows stays");
      assert.ok(await page.locator("#problem").isHidden());
      await changing(page, () => page.locator("#undo").click());
      await changing(page, () => page.locator("#problem button", { hasText: "in three dimensions" }).click());
      assert.equal((await designOf(page)).method, "three_dimensional");
      assert.ok(await page.locator("#problem").isHidden());
      assert.ok((await answer(page, "face")) > 1);
      // And the other way: what three dimensions do not tell.
      await openDesign(page, service, { ...HELICAL, resolution: { ...HELICAL.resolution, contact_solver: SOLVER } });
      await changing(page, () => page.locator("#problem button", { hasText: "do not know" }).click());
      const { resolution, method } = await designOf(page);
      assert.deepEqual([resolution, method], [HELICAL.resolution, "three_dimensional"]);
    },
  );

  await step("the load along the face is a map under the cursor of the curves", async (page) => {
    await openDesign(page, service, HELICAL);
    await answered(page);
    await settled(page);
    await tab(page, "contact");
    const map = page.locator("#chart-face");
    await map.scrollIntoViewIfNeeded();
    const words = await page.locator("#words-face").textContent();
    assert.match(words, /from z = -8 to 8 mm.*N\/mm.*face load factor is 1\.\d+/s);
    assert.match(await map.innerText(), /0\s+\d+ N\/mm/, "a scale with its unit");
    assert.ok(
      (await map.innerText()).includes(`K_Hβ ${(await answer(page, "face")).toFixed(3)}`),
      await map.innerText(),
    );
    // What is painted is what was computed: the heaviest cell has the color of the most, and cells differ.
    const colors = await map.locator("canvas").evaluate((canvas) => {
      const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      const seen = new Set();
      for (let i = 0; i < data.length; i += 4)
        if (data[i + 3] === 255) seen.add([data[i], data[i + 1], data[i + 2]].join());
      return [...seen];
    });
    assert.ok(colors.includes("255,240,138"), "the most");
    assert.ok(colors.length > 60, `${colors.length} colors`);
    // The pointer over the map turns the gears, and the mark stands in map and curve alike.
    const before = await page.locator("#position").inputValue();
    await map.locator(".u-over").hover({ position: { x: 100, y: 60 } });
    await page.waitForFunction((old) => document.querySelector("#position").value !== old, before);
    const marks = await page
      .locator("#chart-share .now, #chart-face .now")
      .evaluateAll((all) =>
        all.map((each) => new DOMMatrix(getComputedStyle(each).transform).e / each.parentElement.clientWidth),
      );
    assert.equal(marks.length, 2);
    assert.ok(Math.abs(marks[0] - marks[1]) < 0.01 && marks[0] > 0.05, marks.join());
    await axe(page);
    // The mean alone where no position is asked for, and the way to every position.
    await changing(page, async () => (await field(page, "/face_load")).selectOption("mean"));
    assert.match(await page.locator("#chart-face .scatter").innerHTML(), /z in mm/);
    await changing(page, () => page.locator("#chart-face button", { hasText: "every position" }).click());
    assert.equal((await designOf(page)).face_load, "positions");
    // It is exported with the curves.
    await tab(page, "export");
    const svg = (await downloaded(page, () => page.locator("[data-download=svg]").click())).bytes.toString();
    assert.match(svg, /Load along the face[\s\S]*\d+ N\/mm/);
    assert.ok(svg.includes("rgb(255 240 138)"));
    // No position of this pair leaves its sharp edges without load: there is no pressure to draw, which is said in
    // place of an empty plot.
    assert.doesNotMatch(svg, /Peak contact pressure/);
    // However long the period, it is drawn.
    const right = await page.evaluate(async () => {
      const { figure } = await import(new URL("web/draw/figure.js", document.baseURI).href);
      const cells = Array.from({ length: 60_000 }, (_, i) => ({
        x: i / 120,
        y: 0,
        width: 1 / 120,
        height: 1,
        color: "#000",
      }));
      return figure({ title: "", x: "", y: "", cells }).frame.x[1];
    });
    assert.equal(Math.round(right), 500);
    await tab(page, "contact");
    // The flanks, as the service tells them of a job of this design.
    await page.locator("#chart-pattern button").click();
    await page.locator("#chart-pattern svg").nth(1).waitFor();
    const flanks = await page
      .locator("#chart-pattern svg")
      .evaluateAll((all) =>
        all.map((svg) => [
          svg.getAttribute("aria-label"),
          svg.querySelectorAll("rect[fill^='url']").length,
          svg.querySelectorAll("rect[fill^=rgb]").length,
        ]),
      );
    const {
      curves: [computed],
      z_mm: z,
      driving,
    } = await page.evaluate(async (submission) => {
      const { solved, json } = await import(new URL("web/state/api.js", document.baseURI).href);
      return json(`v1/jobs/${(await solved(submission)).id}/results/contact-pattern.json`);
    }, HELICAL);
    const all = computed.driving.pressure_mpa.flat();
    const known = Math.max(...all.filter((value) => value !== null));
    assert.match(
      flanks[0][0],
      new RegExp(
        `^The driving flank carries over .* at most ${known.toFixed(0)} MPa, at z = -?[\\d.]+ mm and a diameter of \\d+`,
      ),
    );
    assert.deepEqual(flanks[0].slice(1), [
      all.filter((value) => value === null).length,
      all.filter((value) => value > 0).length,
    ]);
    assert.equal(all.length, z.length * driving.diameter_mm.length);
    // The whole flank is seen, from the form diameter to the tip, and what is computed lies where it is.
    const [top, bottom] = await page
      .locator("#chart-pattern svg")
      .first()
      .evaluate((svg) => [svg.frame.top, svg.frame.bottom]);
    const places = await page
      .locator("#chart-pattern svg")
      .first()
      .locator("rect[shape-rendering]")
      .evaluateAll((rects) =>
        rects.map((rect) => [
          Number(rect.getAttribute("y")),
          Number(rect.getAttribute("y")) + Number(rect.getAttribute("height")),
        ]),
      );
    const placeOf = (diameter) =>
      bottom -
      ((diameter - driving.form_diameter_mm) / (driving.tip_diameter_mm - driving.form_diameter_mm)) * (bottom - top);
    const first = computed.driving.pressure_mpa.findIndex((row) => row.some((value) => value !== 0));
    const half = (driving.diameter_mm[1] - driving.diameter_mm[0]) / 2;
    assert.ok(
      Math.abs(Math.max(...places.map(([, foot]) => foot)) - placeOf(driving.diameter_mm[first] - half)) < 1,
      "the lowest row that touches",
    );
    assert.match(await page.locator("#chart-pattern .note").first().innerText(), /Hatched/);
    assert.match(await page.locator("#chart-pattern .legend").innerText(), /^0\s+\d+ MPa$/);
    await axe(page);
    // Another design has other flanks.
    await changing(page, async () => (await field(page, "/output_torques_n_m")).fill("100"));
    assert.equal(await page.locator("#chart-pattern svg").count(), 0);
    assert.ok(await page.locator("#chart-pattern button").isVisible());
    await changing(page, () => page.locator("#undo").click());
    assert.match(await page.locator("#chart-pressure").innerText(), /at every position/);
    assert.ok(await page.locator("#chart-pressure .canvas").isHidden());
    await tab(page, "data");
    assert.match(await page.locator("#geometry").innerText(), /Overlap ratio ε_β\s+0\.\d{4}/);
  });

  await step(
    "a search begins with fields that the design has, each in the words of the form, and its lines stay lines",
    async (page) => {
      const pair = {
        ...HELICAL.pair,
        driving: { ...HELICAL.pair.driving, lead_modifications: [{ kind: "slope", amount_um: 8 }] },
      };
      await openDesign(page, service, { ...HELICAL, pair });
      await settled(page);
      await tab(page, "designs");
      await page.locator("#search summary").click();
      const [first, second, third] = await Promise.all(
        [0, 1, 2].map((i) =>
          page.locator(`#variable-${i}`).evaluate((select) => [select.value, select.selectedOptions[0].textContent]),
        ),
      );
      assert.deepEqual(first, [
        "/pair/driving/lead_modifications/0/amount_um",
        "Amount of the lead slope (1), driving gear (µm)",
      ]);
      assert.deepEqual([second[0], third[0]], ["/pair/driven/blank/holes/radius_mm", ""]);
      assert.deepEqual(
        await Promise.all(["low", "high"].map((end) => page.locator(`#variable-0-${end}`).inputValue())),
        ["3.2", "16"],
      );
      const words = await page.locator("#variable-0 option").allInnerTexts();
      assert.ok(
        words.includes("Misalignment in the plane of the axes (µm)") &&
          !words.some((each) => /\b(um|mm|deg)\b,/.test(each)),
        words.join("\n"),
      );
      assert.equal(await page.locator("#search-goal option[value=face_load_factor]").innerText(), "Face load factor");
      for (const line of await page.locator("#search .line:visible").all()) {
        const heights = await line.evaluate(
          (element) =>
            new Set(
              [...element.children]
                .filter((each) => !each.hidden)
                .map((each) => Math.round(each.getBoundingClientRect().top + each.getBoundingClientRect().height / 2)),
            ).size,
        );
        assert.equal(heights, 1, await line.innerText());
      }
      // Another design has other fields; what has been chosen stays where it can.
      await page.locator("#variable-1").selectOption("/pair/driven/blank/web/thickness_mm");
      await changing(page, async () => (await field(page, "/pair/driven/blank/holes")).selectOption({ index: 0 }));
      await tab(page, "noise");
      await tab(page, "designs");
      assert.equal(await page.locator("#variable-1").inputValue(), "/pair/driven/blank/web/thickness_mm");
    },
  );

  await step(
    "the pair is turned in space by mouse, keys and buttons, and its lines of contact carry what was computed",
    async (page) => {
      const fetched = [];
      page.on("request", (request) => fetched.push(new URL(request.url()).pathname));
      await openDesign(page, service, HELICAL);
      await answered(page);
      await settled(page);
      assert.ok(
        !fetched.includes("/web/draw/space.js") && !fetched.includes("/web/draw/raster.js"),
        "it costs nothing before it is asked for",
      );
      await page.locator("[data-view=space]").focus();
      await page.keyboard.press("Enter");
      const canvas = page.locator("canvas.space");
      const painted = () => canvas.getAttribute("data-painted");
      const next = async (work) => {
        const before = await painted();
        await work();
        await page.waitForFunction((old) => document.querySelector("canvas.space").dataset.painted !== old, before);
        await page.waitForFunction(() => /^fine/.test(document.querySelector("canvas.space").dataset.painted ?? ""));
        return painted();
      };
      await page.waitForFunction(() => /^fine/.test(document.querySelector("canvas.space")?.dataset.painted ?? ""));
      assert.ok(await page.locator("#drawing svg.gears").isHidden());
      // Both gears are there, the driving one on the left.
      const parts = await canvas.evaluate((element) => {
        const { width, height } = element;
        const { data } = element.getContext("2d").getImageData(0, 0, width, height);
        const seen = { blue: [], brown: [] };
        for (let i = 0; i < data.length; i += 4)
          if (data[i + 3] === 255 && data[i] + data[i + 1] + data[i + 2] > 200) {
            if (data[i + 2] > data[i] + 8) seen.blue.push((i / 4) % width);
            else if (data[i] > data[i + 2] + 4) seen.brown.push((i / 4) % width);
          }
        const mean = (list) => list.reduce((sum, value) => sum + value, 0) / list.length / width;
        return [
          seen.blue.length / (width * height),
          seen.brown.length / (width * height),
          mean(seen.blue),
          mean(seen.brown),
        ];
      });
      assert.ok(parts[0] > 0.02 && parts[1] > 0.04 && parts[2] < parts[3], parts.join());
      // Hand, keys and buttons.
      await canvas.scrollIntoViewIfNeeded();
      const box = await canvas.boundingBox();
      assert.match(
        await next(() => drag(page, [box.x + 100, box.y + 60], [box.x + 140, box.y + 80], 4)),
        / -12\.0 34\.0 /,
      );
      await canvas.focus();
      assert.match(await next(() => page.keyboard.press("ArrowLeft")), / -17\.0 34\.0 /);
      assert.match(await next(() => page.locator(".in-space [aria-label='Zoom in']").click()), / 1\.30$/);
      await canvas.focus();
      assert.match(await next(() => page.keyboard.press("0")), / -32\.0 24\.0 1\.00$/);
      await axe(page);
      // The cursor of curves and drawing moves it, and a listener is told what is seen.
      assert.match(await next(() => page.locator("#position").fill("0.5")), / 0\.500 /);
      await page.waitForFunction(() =>
        /position 0\.50 .*Colors are the load on each line/.test(document.querySelector("#space-words").textContent),
      );
      const words = await page.locator("#space-words").textContent();
      assert.match(words, /24 and 36 teeth, helical teeth of 20°, the driving gear right-handed/);
      // What the page finds for its lines is what the service computed: which pairs touch, and where along the face.
      const [drawn, told] = await page.evaluate(async (submission) => {
        const of = (name) => import(new URL(`web/${name}.js`, document.baseURI).href);
        const [{ solved, json, post }, { alongAxis, contactLines }] = await Promise.all([
          of("state/api"),
          of("draw/solid"),
        ]);
        const outline = await post("v1/outline", submission);
        const job = await solved(submission);
        const { curves } = await json(`v1/jobs/${job.id}/results/contact-pattern.json`);
        const { lines } = curves[0].positions.find(({ mesh_position: at }) => Math.abs(at - 0.5) < 1e-9);
        const found = contactLines(outline, alongAxis(submission.pair, outline), 0.5);
        return [
          found.map(({ pair, points }) => [pair, points[0].z, points.at(-1).z, Math.hypot(...points[0].at)]),
          lines.map(({ pair_offset: pair, z_mm: z, driving_diameter_mm: d }) => [pair, z[0], z.at(-1), d[0] / 2]),
        ];
      }, HELICAL);
      assert.ok(drawn.length >= 2);
      for (const [pair, from, to, radius] of drawn) {
        const other = told.find(([each]) => each === pair);
        // Under load a line reaches up to a module beyond its theoretical ends.
        if (to - from > 2)
          assert.ok(
            other &&
              Math.abs(other[1] - from) < 1.5 &&
              Math.abs(other[2] - to) < 1.5 &&
              Math.abs(other[3] - radius) < 0.3,
            JSON.stringify([drawn, told]),
          );
      }
      if (process.argv.includes("--screenshots")) {
        await page.setViewportSize({ width: 1180, height: 960 });
        await tab(page, "contact");
        await next(() => page.locator("#position").fill("0.3"));
        for (let i = 0; i < 4; i += 1) await page.locator(".brush [aria-label='Zoom in']").click();
        await page.locator("#chart-face").scrollIntoViewIfNeeded();
        await page.screenshot({ path: `${process.env.PICTURES}/page-helical.png` });
      }
      // Away with it: the drawing is back, and nothing is painted any more.
      await page.locator("button[data-view=pair]").click();
      assert.ok(await page.locator("#drawing svg.gears").isVisible());
      const before = await painted();
      await page.locator("#position").fill("0.2");
      await page.waitForTimeout(400);
      assert.equal(await painted(), before);
    },
  );

  await step("what is seen in space has the mass that was computed, with web, hub and holes", async (page) => {
    await openDesign(page, service, HELICAL);
    const ratios = await page.evaluate(async (submission) => {
      const of = (name) => import(new URL(`web/${name}.js`, document.baseURI).href);
      const [{ post }, { alongAxis, surfaceOf }] = await Promise.all([of("state/api"), of("draw/solid")]);
      const [outline, { pair }] = await Promise.all([post("v1/outline", submission), post("v1/validate", submission)]);
      const along = alongAxis(submission.pair, outline);
      return ["driving", "driven"].map((member) => {
        const { points: p, triangles: t } = surfaceOf(
          outline[member],
          submission.pair[member],
          along.twists[member],
          along.mid,
        );
        let six = 0;
        for (let i = 0; i < t.length; i += 3) {
          const [a, b, c] = [3 * t[i], 3 * t[i + 1], 3 * t[i + 2]];
          six +=
            p[a] * (p[b + 1] * p[c + 2] - p[b + 2] * p[c + 1]) +
            p[a + 1] * (p[b + 2] * p[c] - p[b] * p[c + 2]) +
            p[a + 2] * (p[b] * p[c + 1] - p[b + 1] * p[c]);
        }
        return pair[member].mass_kg / ((six / 6) * 1e-9);
      });
    }, HELICAL);
    for (const density of ratios)
      assert.ok(Math.abs(density / 7850 - 1) < 0.01, `steel of ${ratios.join(" and ")} kg/m3`);
  });

  await step(
    "what is seen in space or deformed is told while it is computed, can be stopped, and ends with its view",
    async (page) => {
      await openDesign(page, service, HELICAL);
      await settled(page);
      // Jobs go on until they are cancelled.
      await page.route(/\/v1\/jobs\/[^/]+\/events$/, () => {});
      const begun = () => page.waitForRequest(/\/v1\/jobs\/[^/]+\/events$/);
      const cancelled = () => page.waitForRequest(/\/v1\/jobs\/[^/]+\/cancel$/);
      let begins = begun();
      await page.locator("[data-view=space]").click();
      const told = page.locator("#space-job");
      await told.filter({ hasText: "Computing the load on each line" }).waitFor();
      await begins;
      await axe(page);
      let ends = cancelled();
      await page.locator("button[data-view=pair]").click();
      await ends;
      assert.equal(await told.textContent(), "");
      begins = begun();
      await page.locator("#deformed").click();
      const note = page.locator("#deformed-note");
      await note.filter({ hasText: "Computing the deformed pair" }).waitFor();
      await begins;
      ends = cancelled();
      await note.locator("button", { hasText: "Stop" }).click();
      await ends;
      await note.filter({ hasText: /^Stopped\.$/ }).waitFor();
    },
  );

  await step("a helical pair is seen deformed in the section through the middle of its face", async (page) => {
    await openDesign(page, service, HELICAL);
    await settled(page);
    await page.locator("#deformed").click();
    await page.locator(".deformation .strained.driven").waitFor({ state: "attached" });
    assert.match(
      await page.locator("#deformed-note").innerText(),
      /^In the section through the middle of the common face; .* At 120 N m and position 0, displacements \d+ times enlarged/,
    );
    // Every tooth, all holes and the bore are there, and something is stressed most.
    const moves = async (member) =>
      ((await page.locator(`.deformation .strained.${member}`).getAttribute("d")).match(/M/g) ?? []).length;
    assert.deepEqual([await moves("driving"), await moves("driven")], [2, 7]);
    assert.ok((await page.locator(".deformation .stress.level-5").first().getAttribute("d")).length > 20);
    if (process.argv.includes("--screenshots"))
      await page.locator(".drawing-panel").screenshot({ path: `${process.env.PICTURES}/page-deformed-helical.png` });
  });

  await step(
    "one finger turns the pair, and two zoom",
    async (page, context) => {
      await openDesign(page, service, HELICAL);
      await answered(page);
      await page.locator("[data-view=space]").click();
      await page.waitForFunction(() => /^fine/.test(document.querySelector("canvas.space")?.dataset.painted ?? ""));
      await page.locator("canvas.space").scrollIntoViewIfNeeded();
      const { x, y } = await page.locator("canvas.space").boundingBox();
      const fingers = await context.newCDPSession(page);
      const touch = (type, ...points) =>
        fingers.send("Input.dispatchTouchEvent", {
          type,
          touchPoints: points.map(([dx, dy], id) => ({ x: x + dx, y: y + dy, id })),
        });
      await touch("touchStart", [60, 60]);
      await touch("touchMove", [80, 60]);
      await touch("touchMove", [100, 60]);
      await touch("touchEnd");
      await page.waitForFunction(() =>
        / -12\.0 24\.0 1\.00$/.test(document.querySelector("canvas.space").dataset.painted),
      );
      await touch("touchStart", [60, 60], [120, 60]);
      await touch("touchMove", [50, 60], [130, 60]);
      await touch("touchMove", [30, 60], [150, 60]);
      await touch("touchEnd");
      await page.waitForFunction(() => / 2\.00$/.test(document.querySelector("canvas.space").dataset.painted));
    },
    { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true },
  );

  await engine.step(
    "a pair along its face follows the hand by projection, and is computed by a job when it rests",
    async (page) => {
      const asked = [];
      page.on("request", (request) => {
        if (/v1\/(preview|jobs)$/.test(request.url()) && request.method() === "POST")
          asked.push([request.url().split("/").pop(), JSON.parse(request.postData())]);
      });
      /** @type {any} */
      const fine = structuredClone(HELICAL);
      fine.resolution = { positions_per_mesh_period: 8, span_mesh_periods: 4, face_order: 12 };
      await openDesign(page, service, fine);
      await page.waitForFunction(
        () =>
          document.querySelector("#answer-p-p .value").textContent !== "–" && !document.body.classList.contains("busy"),
      );
      const solid = asked.filter(([, { method }]) => method !== "flexible");
      assert.deepEqual(
        solid.map(([kind]) => kind),
        ["jobs"],
        "no preview that takes longer than a hand waits",
      );
      const before = await answer(page, "p-p");
      asked.length = 0;
      const label = page.locator('label[for="field-/pair/driven/blank/holes/radius_mm"]');
      await field(page, "/pair/driven/blank/holes/radius_mm");
      await label.scrollIntoViewIfNeeded();
      const { x, y } = await label.boundingBox();
      await page.evaluate(() => {
        window.drawn = [];
        document.addEventListener("drawn", (/** @type {CustomEvent} */ { detail }) =>
          window.drawn.push([detail.draft, detail.submission.pair.driven.blank.holes.radius_mm]),
        );
      });
      await page.mouse.move(x + 8, y + 8);
      await page.mouse.down();
      await page.mouse.move(x - 12, y + 8, { steps: 4 });
      await page.waitForFunction(() => window.drawn.some(([draft]) => draft));
      await page.mouse.up();
      await settled(page);
      await page.waitForFunction(() => window.drawn.at(-1)[0] === false);
      const drafts = asked.filter(([kind]) => kind === "preview");
      assert.ok(
        drafts.length >= 1 && drafts.every(([, { method }]) => method === "three_dimensional_projected"),
        JSON.stringify(asked.map(([kind, { method }]) => [kind, method])),
      );
      const [kind, last] = asked.at(-1);
      const design = await designOf(page);
      assert.deepEqual([kind, last.method], ["jobs", "three_dimensional"]);
      assert.ok(design.pair.driven.blank.holes.radius_mm < 4);
      assert.deepEqual(last, design, "what is shown is the design itself");
      assert.notEqual(await answer(page, "p-p"), before);
    },
  );

  await step("the lead that evens the load is told, and given to the design by one press", async (page) => {
    const askew = structuredClone(HELICAL);
    askew.pair.driving.lead_modifications = [{ kind: "crowning", amount_um: 2 }];
    await openDesign(page, service, askew);
    await answered(page);
    await settled(page);
    const before = await answer(page, "face");
    const told = await page.locator("#cure").innerText();
    const [, promised] = /K_Hβ would be (\d\.\d+) with a slope of -?\d+\.\d µm/.exec(told);
    await axe(page);
    await changing(page, () => page.locator("#cure button").click());
    const now = await answer(page, "face");
    assert.ok(now < before - 0.1 && Math.abs(now / Number(promised) - 1) < 0.03, `${before} to ${now}: ${told}`);
    const leads = (await designOf(page)).pair.driving.lead_modifications;
    assert.ok(
      leads.filter(({ kind }) => kind === "crowning").length <= 1,
      "the crowning that is there is changed, not doubled",
    );
    assert.ok(leads.some(({ kind }) => kind === "slope"));
    // What has been cured needs no cure, and it can be taken back.
    await page.locator("#cure").waitFor({ state: "hidden" });
    await changing(page, () => page.locator("#undo").click());
    assert.equal(await answer(page, "face"), before);
    assert.ok(await page.locator("#cure").isVisible());
  });
}
