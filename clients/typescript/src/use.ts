/** Uses every call against a running service (MESHWRIGHT_URL), as the tests do. */

import assert from "node:assert/strict";
import { Client, ProblemError } from "./meshwright.js";

const url = process.env["MESHWRIGHT_URL"];
const service = new Client(url ? { url } : {});

const submission = await service.example("test-case-2");
const told: number[] = [];
const results = await service.solve(submission, (done) => told.push(done));
const mean = results.curves[0]?.statistics.transmission_error_um.mean ?? NaN;
// Table 2 of the paper: 13.79 um.
assert.ok(Math.abs(mean - 13.79) < 0.05, `${mean} um`);
assert.equal(told.at(-1), 200);

assert.deepEqual(await service.preview(submission), results);
assert.ok((await service.validate(submission)).valid);
assert.equal((await service.outline(submission)).driven.holes.length, 10);

const bad = await service.example("bad-case-3-as-printed");
await assert.rejects(service.solve(bad), (error) => error instanceof ProblemError && error.problem.errors?.[0]?.nearest === 115.56);

const table = await service.study({ base: { ...submission }, axes: [{ path: "/pair/driven/blank/holes/count", values: [6, 8] }] });
assert.deepEqual(table.rows.map((row) => row.status), ["successful", "successful"]);

const job = await service.submit(submission);
assert.equal((await service.job(job.id)).id, job.id);
console.log(`clients: the TypeScript client solved case 2: ${mean.toFixed(3)} um.`);
