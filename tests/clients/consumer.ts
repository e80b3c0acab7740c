// A program that has only what the package of the TypeScript client gives away: types that are not there are no types, and allow everything.
import { Client, type Results, type Submission } from "./dist/meshwright.js";

const gear = { tooth_count: 50, module_mm: 2, face_width_mm: 20, blank: { bore_radius_mm: 16 } };
export const submission: Submission = { method: "flexible", pair: { center_distance_mm: 100.5, driving: gear, driven: gear }, output_torques_n_m: [115] };

// @ts-expect-error: there is no such field.
export const misspelled: Submission = { ...submission, output_torque: 115 };
// @ts-expect-error: there is no such method.
export const unknown: Submission = { ...submission, method: "guess" };
// @ts-expect-error: there is no such answer.
export const wrong = (results: Results): number => results.curves[0]!.nonsense;

export const mean = async (): Promise<number> => (await new Client().solve(submission)).curves[0]!.statistics.transmission_error_um.mean;
