// A program of a portal, made from the contract by public tools: what it may write is decided by the types, and it runs a job to its result.
import createClient from "openapi-fetch";
import type { components, paths } from "./meshwright.d.ts";

type Job = components["schemas"]["Job"];
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

const service = createClient<paths>({ baseUrl: process.env["MESHWRIGHT_URL"]! });
const made = await service.POST("/v1/jobs", { body: submission });
if (!made.data || !("id" in made.data)) throw new Error(made.error?.detail ?? "no job");
let job: Job = made.data;
const params = { path: { id: job.id } };
while (job.status === "accepted" || job.status === "running") {
  const seen = await service.GET("/v1/jobs/{id}", { params: { ...params, header: { Prefer: "wait=2" } } });
  if (!seen.data) throw new Error(seen.error.detail);
  job = seen.data;
}
const { data: results, error } = await service.GET("/v1/jobs/{id}/results", { params });
if (!results) throw new Error(error.detail);
const mean = results.curves[0]!.statistics.transmission_error_um.mean;
// As the README prints it.
if (Math.abs(mean - 11.56) > 0.005) throw new Error(`${mean} um`);
console.log(`clients: a program by openapi-typescript and openapi-fetch ran a job: ${mean.toFixed(3)} um.`);
