// A program of a portal, made from the contract by public tools: what it may write is decided by the types. It fills a form, reads a refusal, runs a job to its
// result, and takes the message that tells its end.
import { createServer } from "node:http";
import createClient from "openapi-fetch";
import type { components, paths } from "./meshwright.d.ts";
import { isSigned } from "./signed.ts";

type Code = components["schemas"]["Code"];
type EventKind = components["schemas"]["EventKind"];
type Job = components["schemas"]["Job"];
type Problem = components["schemas"]["Problem"];
type Submission = components["schemas"]["Submission"];
type Table = paths["/v1/studies/{id}/results"]["get"]["responses"]["200"]["content"]["application/json"];

const submission: Submission = {
  method: "flexible",
  pair: {
    center_distance_mm: 100.5,
    driving: { tooth_count: 50, module_mm: 2, face_width_mm: 20, blank: { bore_radius_mm: 16 } },
    driven: { tooth_count: 50, module_mm: 2, face_width_mm: 20, blank: { bore_radius_mm: 16, holes: { count: 10, circle_radius_mm: 34, radius_mm: 7.5 } } },
  },
  output_torques_n_m: [115],
};

// @ts-expect-error: there is no such field.
export const misspelled: Submission = { ...submission, output_torque: 115 };

export function told(job: Job): string {
  switch (job.status) {
    case "accepted":
    case "running":
      return `${job.progress_percent} %`;
    case "successful":
      return job.links.results;
    case "failed":
    case "dismissed":
      return job.problem?.detail ?? job.status;
  }
}

export function best(table: Table): string[] {
  return table.rows.filter((row) => row.pareto).map((row) => row.label);
}

/** What stands at each field of a form: why it is refused, and the nearest value that is not. */
export function atFields(problem: Problem): Map<string, { code: Code; detail: string; nearest?: number | null }> {
  return new Map((problem.errors ?? []).map(({ pointer, ...error }) => [pointer, error]));
}

// The list of codes is open: a later version may have more.
export const later: Code = "teeth_do_not_touch";

const check: (holds: unknown, what: unknown) => asserts holds = (holds, what) => {
  if (!holds) throw new Error(typeof what === "string" ? what : JSON.stringify(what));
};
const url = process.env["MESHWRIGHT_URL"]!;
const hookUrl = process.env["MESHWRIGHT_HOOK"]!;
const service = createClient<paths>({ baseUrl: url });

// A form: names, units and ranges of fields from the contract, as the service has it, what it fills in, and what the computation will cost.
const contract = await (await fetch(`${url}/openapi.json`)).json();
const { data: limits } = await service.GET("/v1/limits");
check(limits, "no limits");
for (const [name, unit, [least, most]] of [["module_mm", "mm", limits.module_mm], ["tooth_count", "1", limits.tooth_count]] as const) {
  const field = contract.components.schemas.Gear.properties[name];
  check(field.title && field["x-unit"] === unit && field.minimum === least && field.maximum === most, field);
}
const { data: checked } = await service.POST("/v1/validate", { body: submission });
check(checked && "submission" in checked && checked.estimate.positions <= limits.previews.positions && checked.estimate.seconds > 0, checked);
const filled = checked.submission.pair.driving.material?.youngs_modulus_gpa;
check(filled === 210 && filled === contract.components.schemas.Material.properties.youngs_modulus_gpa.default, checked.submission);

// What cannot be computed: the field, why, and what can be.
const apart: Submission = { ...submission, pair: { ...submission.pair, center_distance_mm: 120 } };
const refused = await service.POST("/v1/jobs", { body: apart });
check(!refused.data && refused.response.status === 422 && refused.error.code === "teeth_do_not_reach", refused.data ?? refused.error);
const at = atFields(refused.error).get("/pair/center_distance_mm");
check(at?.code === "teeth_do_not_reach" && at.nearest, refused.error);
const mended = await service.POST("/v1/validate", { body: { ...apart, pair: { ...apart.pair, center_distance_mm: at.nearest } } });
check(mended.data, mended.error);

// A job, and the message that it has ended.
const receiver = createServer();
const message = new Promise<{ headers: Record<string, string>; body: Buffer }>((told) => receiver.once("request", async (request, answer) => {
  const body = Buffer.concat(await request.toArray());
  answer.writeHead(204, { connection: "close" }).end();
  told({ headers: request.headers as Record<string, string>, body });
}));
setTimeout(() => { throw new Error("no message came"); }, 60_000).unref();
await new Promise<void>((listening) => receiver.listen(Number(new URL(hookUrl).port), "127.0.0.1", listening));
const elsewhere = await service.POST("/v1/webhooks", { body: { url: "https://hooks.example.com/" } });
check(elsewhere.error?.code === "webhook_refused", elsewhere.error);
const { data: hook } = await service.POST("/v1/webhooks", { body: { url: `${hookUrl}/ended`, events: ["job.ended"] } });
check(hook?.secret, "no webhook");
const made = await service.POST("/v1/jobs", { body: submission });
if (!made.data || !("id" in made.data)) throw new Error(made.error?.detail ?? "no job");
let job: Job = made.data;
const params = { path: { id: job.id } };
while (job.status === "accepted" || job.status === "running") {
  const seen = await service.GET("/v1/jobs/{id}", { params: { ...params, header: { Prefer: "wait=2" } } });
  if (!seen.data) throw new Error(seen.error.detail);
  job = seen.data;
}
const { headers, body } = await message;
check(isSigned(hook.secret, headers, body) && !isSigned(hook.secret, headers, Buffer.concat([body, Buffer.from(" ")])), headers);
const { type, data: ended }: { type: EventKind; data: Pick<Job, "id" | "status"> } = JSON.parse(body.toString());
check(type === "job.ended" && ended.id === job.id && ended.status === job.status, ended);
await service.DELETE("/v1/webhooks/{id}", { params: { path: { id: hook.id } } });
receiver.close();
const { data: results, error } = await service.GET("/v1/jobs/{id}/results", { params });
if (!results) throw new Error(error.detail);
const mean = results.curves[0]!.statistics.transmission_error_um.mean;
// As the README prints it.
if (Math.abs(mean - 11.56) > 0.005) throw new Error(`${mean} um`);
console.log(`clients: a program by openapi-typescript and openapi-fetch filled a form, read a refusal, ran a job and was told its end: ${mean.toFixed(3)} um.`);
