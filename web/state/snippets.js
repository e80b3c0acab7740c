// @ts-check
// What is on the screen as a program: the request that gives the same results elsewhere.

/** @import { Submission } from "./documents.js" */

/**
 * A submission as a literal of Python.
 *
 * @type {(value: unknown, indent?: string) => string}
 */
function python(value, indent = "") {
  if (value === null || value === undefined) return "None";
  if (typeof value === "boolean") return value ? "True" : "False";
  if (typeof value !== "object") return JSON.stringify(value);
  if (Array.isArray(value) && value.every((each) => typeof each !== "object"))
    return `[${value.map((each) => python(each)).join(", ")}]`;
  const inner = `${indent}    `;
  if (Array.isArray(value)) return `[\n${value.map((each) => inner + python(each, inner)).join(",\n")},\n${indent}]`;
  return `{\n${Object.entries(value)
    .map(([name, each]) => `${inner}${JSON.stringify(name)}: ${python(each, inner)}`)
    .join(",\n")},\n${indent}}`;
}

/**
 * `submission` to the service at `address`: with curl, from Python, from TypeScript. A key stays out of it, in the
 * environment.
 *
 * @type {(submission: Submission, address: string) => { curl: string, python: string, typescript: string }}
 */
export function snippets(submission, address) {
  const url = address.replace(/\/$/, "");
  const json = JSON.stringify(submission, null, 2);
  return {
    curl: `curl -s ${url}/v1/jobs \\\n  -H 'content-type: application/json' -H 'prefer: wait=10' \\\n  -H "authorization: Bearer $MESHWRIGHT_KEY" -d @- <<'JSON'\n${json}\nJSON\n`,
    python: `from meshwright import Client\n\nsubmission = ${python(submission)}\n\nwith Client(${JSON.stringify(url)}) as service:\n    results = service.solve(submission)\nprint(results.frame())\n`,
    typescript: `import { Client, type Submission } from "meshwright-client";\n\nconst submission: Submission = ${json};\n\nconst service = new Client({ url: ${JSON.stringify(url)}, key: process.env["MESHWRIGHT_KEY"] ?? "" });\nconst results = await service.solve(submission);\nconsole.log(results.curves[0]?.statistics.transmission_error_um);\n`,
  };
}
