// A program of a portal: what it may write is decided by the types that were made from the contract.
import type { components, paths } from "./meshwright.d.ts";

type Job = components["schemas"]["Job"];
type Submission = components["schemas"]["Submission"];
type Table = paths["/v1/studies/{id}/results"]["get"]["responses"]["200"]["content"]["application/json"];

const submission: Submission = {
  method: "flexible",
  pair: {
    center_distance_mm: 100.5,
    driving: { tooth_count: 50, module_mm: 2, face_width_mm: 20, blank: { bore_radius_mm: 16 } },
    driven: { tooth_count: 50, module_mm: 2, face_width_mm: 20, blank: { bore_radius_mm: 16 } },
  },
  output_torques_n_m: [115],
};

function told(job: Job): string {
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

export { submission, told };
